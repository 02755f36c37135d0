"""Input and result of a batch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.charts.notebook import html_cell, html_table, text_table
from railhil.common.digits import count_of
from railhil.judge.judging import judging_of
from railhil.judge.result import COUNTS, Result
from railhil.judge.score import Score
from railhil.record.telemetry import Kept, kept_of
from railhil.record.trace import Trace
from railhil.run.memory import record_after
from railhil.scenarios.memory import Memory, MemoryRecord
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]

#: Hexadecimal digits of a digest.
_DIGITS = 16


@dataclass(frozen=True, slots=True)
class Case:
    """The input of a batch: a scenario and a law, as for the controller.

    ``perturbed``: each seed draws the scenario's perturbations; else only the noise of the sensors differs.
    """

    #: Criteria of the system whose batch runs it.
    scenario: Any
    law: LawSpec = field(default_factory=lambda: LawSpec(arithmetic="float64"))
    perturbed: bool = True

    def run(self, seed: int) -> RunSpec:
        """One of its runs, for benches that make runs one by one."""
        return RunSpec(self.scenario.name, law=self.law, seed=seed, perturbed=self.perturbed)


@dataclass(frozen=True, slots=True)
class SequenceRun:
    """One run of a sequence: a row without telegrams, unless it was made by itself.

    :param scenario, spec: of the run; the law of ``spec`` has the memory that it began with.
    :param missed: the reason why it says nothing about the controller; empty: there is none.
    :param digest: of its commands, or of its frames where the system has no digest.
    :param kept: the values that the law keeps.
    :param trace: its telegrams; None of a run that was made together with others.
    """

    scenario: AnyScenario
    spec: RunSpec
    score: Score
    counts: dict[str, int]
    missed: str
    digest: str
    kept: Kept | None
    trace: Trace | None = field(default=None, repr=False, compare=False)

    @classmethod
    def of(cls, run: Result, digest: str, kept: Mapping[str, Any] | None) -> SequenceRun:
        """A run that was made by itself.

        :param kept: the memory that its law keeps, as :func:`railhil.controller_node.laws.memory.kept` makes it.
        """
        memory = None if kept is None else kept_of(kept)
        return cls(run.scenario, run.spec, run.score, run.counts, run.missed, digest, memory, run.trace)

    @property
    def began(self) -> Memory:
        """The memory that it began with."""
        assert self.spec.law.memory is not None
        return self.spec.law.memory

    @property
    def record(self) -> MemoryRecord | None:
        """The record that it leaves; None if it cannot be trusted, or was learned from before."""
        if self.kept is None or self.missed or self.score.verdict not in ("PASS", "FAIL"):
            return None
        return record_after(self.scenario, self.spec, self.kept)

    @property
    def left(self) -> Memory:
        """The memory for the next run."""
        if self.record is None or self.kept is None:
            return self.began
        return self.began.add_run(self.record, self.kept.used, self.kept.refused)


@dataclass(frozen=True, slots=True)
class Batch:
    """Results of N runs, arrays of shape (N,), in the order of the seeds.

    ``verdicts``: PASS, FAIL, or INVALID of a run that says nothing about the controller. ``values``, ``signed`` and
    ``extras`` as in :class:`railhil.judge.score.Score`, NaN where a run has none.
    ``wraps``, ``saturations`` and ``zero_divisions`` are of the law's arithmetic in that run. ``digest`` is of the
    commands of each run. ``commands`` (raw values, int16) only on request: one array for each run, one value for each
    control period.
    """

    seed: Ints
    scores: tuple[Score, ...]
    values: Mapping[str, Floats]
    signed: Mapping[str, Floats]
    extras: Mapping[str, Floats]
    verdicts: tuple[str, ...]
    ended: tuple[str, ...]
    failures: tuple[tuple[str, ...], ...]
    wraps: Ints
    saturations: Ints
    zero_divisions: Ints
    digest: tuple[str, ...]
    commands: tuple[NDArray[np.int16], ...] | None = None
    #: Title and unit of each of ``values``.
    titles: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return text_table(self._headline, self._heads, self._rows())

    def _repr_html_(self) -> str:
        return html_cell(html_table(self._headline, self._heads, self._rows(), numbers=(1, 2, 3)))

    _heads: ClassVar = ("score", "least", "median", "most")

    @property
    def _headline(self) -> str:
        counts = Counter(self.verdicts)
        said = ", ".join(f"{verdict} {counts[verdict]}" for verdict in sorted(counts, reverse=True))
        return f"{count_of(len(self.seed), 'run')}: {said}"

    def _rows(self) -> list[tuple[str, ...]]:
        """Title, least value, median and greatest value of each score, of the runs that have one."""
        found = []
        for key, values in self.values.items():
            known = values[np.isfinite(values)]
            figures = (known.min(), np.median(known), known.max()) if known.size else ()
            found.append((self.titles.get(key, key), *(f"{value:.6g}" for value in figures)))
        return [row if len(row) > 1 else (*row, "-", "-", "-") for row in found]

    @property
    def passed(self) -> NDArray[np.bool_]:
        """For each run, whether it has passed."""
        return np.array([verdict == "PASS" for verdict in self.verdicts], dtype=bool)

    @classmethod
    def of(
        cls,
        scenario: AnyScenario,
        seeds: Sequence[int],
        scores: Sequence[Score],
        counts: Mapping[str, Ints],
        digests: Sequence[str],
        missed: Sequence[str] = (),
    ) -> Batch:
        """Runs of a scenario of any system, from their scores.

        :param counts: ``wraps``, ``saturations`` and ``zero_divisions``, each of shape (N,).
        :param missed: for each run why it says nothing about the controller, empty if it does; none: every run does.
        """
        judging, reasons = judging_of(scenario), missed or [""] * len(scores)
        signed = [criterion.signed for criterion in judging.criteria if criterion.signed is not None]
        return cls(
            seed=np.array(seeds, dtype=np.int64),
            scores=tuple(scores),
            values={item.key: column([score.values[item.key] for score in scores]) for item in judging.criteria},
            signed={key: column([score.signed[key] for score in scores]) for key in signed},
            extras={extra.key: column([score.extras[extra.key] for score in scores]) for extra in judging.extras},
            verdicts=tuple("INVALID" if why else score.verdict for score, why in zip(scores, reasons, strict=True)),
            ended=tuple(score.ended for score in scores),
            failures=tuple(
                (*score.failures, *filter(None, (why,))) for score, why in zip(scores, reasons, strict=True)
            ),
            wraps=counts["wraps"],
            saturations=counts["saturations"],
            zero_divisions=counts["zero_divisions"],
            digest=tuple(digests),
            titles={item.key: f"{item.title} ({item.unit_typeset})" for item in judging.criteria},
        )

    @classmethod
    def of_results(
        cls, scenario: AnyScenario, seeds: Sequence[int], runs: Sequence[Result | SequenceRun], digests: Sequence[str]
    ) -> Batch:
        """Runs of a scenario that were made one by one; INVALID where a fault had no effect."""
        counted = [run.counts for run in runs]
        counts = {name: np.array([one[name] for one in counted], dtype=np.int64) for name in COUNTS}
        return cls.of(scenario, seeds, [run.score for run in runs], counts, digests, [run.missed for run in runs])


def column(values: Sequence[float | None]) -> Floats:
    """Values of the runs as an array, NaN where there is none."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)
