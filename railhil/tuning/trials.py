"""The training runs: scores of many candidates at once, each on the same perturbed runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from railhil.batch import Case
from railhil.judge.score import Score
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.tuning.objective import Scale, objective

#: The search computes in double precision.
ARITHMETIC = "float64"


class Trials:
    """Training runs of one law. The system's default law, with its own parameters, sets the scale of the objective.

    :param scenario: of a system with the part ``parameter_batch``.
    :param law: its arithmetic is :data:`ARITHMETIC`, its parameters come from the candidates.
    :param seeds: of the perturbed runs.
    """

    def __init__(self, scenario: AnyScenario, law: LawSpec, seeds: Sequence[int]) -> None:
        system = scenario.installed_system
        self._run = system.part("parameter_batch")
        self._case = Case(scenario, law)
        self._seeds = list(seeds)
        #: Count of each reason with which the law refused parameters.
        self.refusals: Counter[str] = Counter()
        reference = Case(scenario, replace(law, controller=system.law))
        self.scale = Scale.of(scenario, self._run(reference, [None], self._seeds)[0])

    def of_defaults(self) -> float | None:
        """Objective of the law's own parameters, None when the law cannot be made with them for this scenario."""
        return self._objectives([None])[0]

    def of(self, candidates: Sequence[Mapping[str, float]]) -> list[float | None]:
        """Objective of each candidate, None if the law cannot be made with it.

        :raises InputError: the law refuses the names or types of the parameters.
        """
        law = self._case.law.controller
        return self._objectives([ParameterSet(law, values, Path("search")) for values in candidates])

    def _objectives(self, sets: Sequence[ParameterSet | None]) -> list[float | None]:
        found: list[Sequence[Score] | str] = self._run(self._case, sets, self._seeds)
        self.refusals.update(reason for reason in found if isinstance(reason, str))
        return [None if isinstance(scores, str) else objective(self.scale, scores) for scores in found]
