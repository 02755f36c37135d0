"""The training runs: scores of many candidates at once, each on the same perturbed runs."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from railhil.batch import Case
from railhil.common.errors import InputError
from railhil.controller_node.program.model import LawProgram
from railhil.controller_node.program.tracer import record
from railhil.judge.score import Score
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.batch import CHUNK
from railhil.systems.ato.batch.engine import Engine
from railhil.systems.ato.scenario.model import Scenario
from railhil.tuning.objective import Scale, objective
from railhil.tuning.stacked import StackedLoop, shape

#: Law whose published parameters set the scale of the objective.
REFERENCE = "ipfc"
#: The search computes in double precision.
ARITHMETIC = "float64"


class Trials:
    """Training runs of one law.

    :param law: its arithmetic is :data:`ARITHMETIC`, its parameters are those of the candidates.
    :param seeds: of the perturbed runs.
    """

    def __init__(self, scenario: Scenario, law: LawSpec, seeds: Sequence[int]) -> None:
        self._scenario = scenario
        self._law = law
        self._seeds = list(seeds)
        #: Count of each reason with which the law refused parameters.
        self.refusals: Counter[str] = Counter()
        reference = replace(law, controller=REFERENCE)
        published = record(scenario, reference, wide=True)
        self.scale = Scale.of(scenario, self._runs(reference, [published])[0])

    def of_defaults(self) -> float | None:
        """Objective of the law's own parameters, None when the law cannot be made with them for this scenario."""
        programs = self._programs(None)
        return None if programs is None else objective(self.scale, self._runs(self._law, [programs])[0])

    def of(self, candidates: Sequence[Mapping[str, float]]) -> list[float | None]:
        """Objective of each candidate, None if the law cannot be made with it.

        :raises InputError: the law refuses the names or types of the parameters.
        """
        alike: dict[str, list[tuple[int, LawProgram]]] = defaultdict(list)
        for i, values in enumerate(candidates):
            programs = self._programs(values)
            if programs is not None:
                alike[shape(programs)].append((i, programs))
        found: list[float | None] = [None] * len(candidates)
        # As many trains together as is optimal for the batch engine.
        most = max(1, CHUNK // len(self._seeds))
        for group in alike.values():
            for first in range(0, len(group), most):
                part = group[first : first + most]
                for (i, _), scores in zip(part, self._runs(self._law, [one for _, one in part]), strict=True):
                    found[i] = objective(self.scale, scores)
        return found

    def _programs(self, values: Mapping[str, float] | None) -> LawProgram | None:
        law = self._law
        given = None if values is None else ParameterSet(law.controller, values, Path("search"))
        try:
            return record(self._scenario, replace(law, parameters=given), wide=True)
        except InputError as error:
            # Raised by a law for inconsistent parameters.
            if isinstance(error.__cause__, ValueError):
                self.refusals[str(error.__cause__)] += 1
                return None
            raise

    def _runs(self, law: LawSpec, programs: Sequence[LawProgram]) -> list[list[Score]]:
        count = len(self._seeds)
        case = Case(self._scenario, law)
        scores = Engine(case, StackedLoop(programs, count)).run(self._seeds * len(programs)).scores
        return [scores[i : i + count] for i in range(0, len(scores), count)]
