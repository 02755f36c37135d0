"""The training runs: scores of many candidates, each on the same perturbed runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from railhil.batch import Case
from railhil.common.errors import InputError, Words
from railhil.controller_node.law_controller import maker_of
from railhil.judge.score import Score
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import System
from railhil.study.perturbed_runs import run_seeds
from railhil.tuning.objective import Scale, objective

#: The search computes in double precision.
ARITHMETIC = "float64"
#: Source of the candidates, in errors.
_SEARCH = Path("search")


def run_each_set(case: Case, sets: Sequence[ParameterSet | None], seeds: Sequence[int]) -> list[Sequence[Score] | str]:
    """Runs of a case with each set of parameters of its law, one set after another; for every system.

    :param case: the parameters of its law are ignored.
    :param sets: None: the law's own parameters.
    :returns: for each set the score of each seed, or the reason for which the law cannot be made with this set.
    :raises InputError: the law refuses the names or types of the parameters.
    """
    make = maker_of(case.scenario.installed_system, case.scenario)
    found: list[Sequence[Score] | str] = []
    for parameters in sets:
        law = replace(case.law, parameters=parameters)
        try:
            make(case.scenario, law)
        except InputError as error:
            if error.file == str(_SEARCH):
                raise
            found.append(str(error.__cause__ or error.difference))
        else:
            found.append(run_seeds(case.scenario, law, seeds).scores)
    return found


@dataclass(frozen=True, slots=True)
class Tuning:
    """The part ``tuning`` of a system.

    ``reference``: the law whose runs scale the criteria without a limit. ``scale_of``: the divisors in words, for the
    parameter file. ``run_sets``: makes the runs, as :func:`run_each_set`.
    """

    reference: str
    scale_of: str
    run_sets: Callable[[Case, Sequence[ParameterSet | None], Sequence[int]], Sequence[Sequence[Score] | str]] = (
        run_each_set
    )

    @classmethod
    def of(cls, system: System) -> Tuning:
        """That of a system; one without the part has its default law as the reference.

        :raises InputError: the part cannot be imported.
        """
        declared: Tuning | None = system.optional_part("tuning")
        return declared or cls(system.law, f"limits of the scenario; medians of {system.law} with its own parameters")


class Trials:
    """Training runs of one law. The reference law, with its own parameters, sets the scale of the objective.

    :param law: its arithmetic is :data:`ARITHMETIC`, its parameters come from the candidates.
    :param seeds: of the perturbed runs.
    :raises InputError: the reference law cannot be made for the scenario, or its runs give no scale.
    """

    def __init__(self, scenario: AnyScenario, law: LawSpec, seeds: Sequence[int]) -> None:
        system = scenario.installed_system
        tuning = Tuning.of(system)
        known = replace(law, controller=tuning.reference)
        # As on the bench: it refuses an indexing that the system does not have.
        system.part("controller")(scenario, known)
        self._run = tuning.run_sets
        self._case = Case(scenario, law)
        self._seeds = list(seeds)
        #: Count of each reason with which the law refused parameters.
        self.refusals: Counter[str] = Counter()
        reference = self._run(Case(scenario, known), [None], self._seeds)[0]
        if isinstance(reference, str):
            found = Words(f"{tuning.reference}, the reference of the objective: {reference}")
            raise InputError("tune", scenario.name, found, "a scenario for which it can be made")
        self.scale = Scale.of(scenario, reference)

    def of_defaults(self) -> float | None:
        """Objective of the law's own parameters, None when the law cannot be made with them for this scenario."""
        return self._objectives([None])[0]

    def of(self, candidates: Sequence[Mapping[str, float]]) -> list[float | None]:
        """Objective of each candidate, None if the law cannot be made with it.

        :raises InputError: the law refuses the names or types of the parameters.
        """
        law = self._case.law.controller
        return self._objectives([ParameterSet(law, values, _SEARCH) for values in candidates])

    def _objectives(self, sets: Sequence[ParameterSet | None]) -> list[float | None]:
        found = self._run(self._case, sets, self._seeds)
        self.refusals.update(reason for reason in found if isinstance(reason, str))
        return [None if isinstance(scores, str) else objective(self.scale, scores) for scores in found]
