"""From which instant on a run that fails can no longer be saved by its noise.

A continuation is the run with other noise from an instant on, which the scenario key ``noise_from`` gives: anybody can
repeat it. Counted is how many of some continuations from an instant fail, for several instants. Nothing is said about
instants and continuations that were not computed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import count, islice
from typing import Any, Self

import numpy as np

from railhil.batch.case import Case
from railhil.batch.nodes import batch_of
from railhil.charts.figure import TIME, Chart, Curve, Figure, Look, Point
from railhil.common.errors import InputError, Words
from railhil.judge.record import Record
from railhil.judge.requirements.requirement import Requirement, requirements_of
from railhil.judge.requirements.scores import score_margins
from railhil.judge.result import Result
from railhil.judge.score import Score
from railhil.run.branch import Trunk, branched_run
from railhil.run.no_return import is_saved, no_return_sentence
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: Continuations from each instant (chosen).
CONTINUATIONS = 64
#: Instants of the first look over a run, where the batch makes the continuations; one where branches do. Chosen.
_INSTANTS = 32
#: Share of the run to which the decision is then bisected: by the batch, and by branches.
_BY_BATCH, _BY_BRANCHES = 1024, 32

#: (scores of runs) -> whether each of them fails.
ScoreFails = Callable[[Sequence[Score]], Sequence[bool]]
#: (ticks, ascending) -> how many continuations from each fail.
_Count = Callable[[Sequence[int]], Sequence[int]]


@dataclass(frozen=True, slots=True)
class Decision:
    """What was found: instants from which the noise was other noise, ascending, and how many of the ``runs``
    continuations from each fail."""

    runs: int
    at_s: tuple[float, ...]
    failed: tuple[int, ...]

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Self:
        """From its fields."""
        return cls(document["runs"], tuple(document["at_s"]), tuple(document["failed"]))

    @property
    def sentence(self) -> str:
        """Between which instants it was decided, in words."""
        many, kind = self.runs, "continuations with new noise"
        open_places = [place for place, failed in enumerate(self.failed) if failed < many]
        if not open_places:
            return f"{many} of {many} {kind} from the start fail"
        decided = open_places[-1] + 1
        if decided == len(self.failed):
            return f"not decided at {self.at_s[-1]:g} s: {self.failed[-1]} of {many} {kind} from there fail"
        saved = [place for place in open_places if 2 * self.failed[place] < many]
        last = saved[-1] if saved else 0
        return (
            f"decided between {self.at_s[last]:g} and {self.at_s[decided]:g} s: "
            f"{self.failed[last]} of {many} ... {many} of {many} {kind} from there fail"
        )


def decision_figure(document: Mapping[str, Any] | None, name: str) -> Figure | None:
    """The continuations that fail, over the instant; None: a sentence says all, because there is at most one instant.

    :param document: a decision as JSON; None: it is not known. :param name: its anchor in the page.
    """
    if document is None or len(document["at_s"]) < 2:
        return None
    found = Decision.from_json(document)
    look = Look("0", marker="o", marker_px=5.0)
    points = [
        Point("", at_s, failed, look, text=f"from {at_s:g} s: {failed} of {found.runs} fail")
        for at_s, failed in zip(found.at_s, found.failed, strict=True)
    ]
    curve = Curve("fail", np.array(found.at_s), np.array(found.failed, dtype=np.float64), Look("0"))
    title, bounds = f"of {found.runs} continuations with new noise fail", (-0.04 * found.runs, 1.06 * found.runs)
    chart = Chart([curve], TIME, title, y_bounds=bounds, points=points)
    caption = "Each point is the same run with other noise from that instant on; only the points were computed."
    return Figure(
        name, "What the noise decides", f"{found.sentence[0].upper()}{found.sentence[1:]}. {caption}", [chart]
    )


def scores_that_violate(requirements: Sequence[Requirement], scenario: AnyScenario) -> ScoreFails | None:
    """Which scores violate one of some requirements; None: one of them needs the record of a run."""
    margins = [found for one in requirements if (found := score_margins(one, scenario)) is not None]
    if len(margins) < len(requirements):
        return None

    def fails(scores: Sequence[Score]) -> Sequence[bool]:
        none = np.zeros(len(scores), dtype=bool)
        found: list[bool] = np.any([none, *(one(scores) < 0 for one in margins)], axis=0).tolist()
        return found

    return fails


def find_decision(
    spec: RunSpec, end_s: float, fails: Callable[[Result], bool], score_fails: ScoreFails | None = None
) -> Decision:
    """Count the continuations of a run that fail, over the instant.

    The batch makes them if it can, else branches. The instants are a grid, and then those of a bisection between the
    last instant from which a continuation passes and the next one.

    :param spec: of a run that fails. :param end_s: of the run.
    :param fails: whether a continuation fails, as the run does; ``score_fails``: the same from scores alone, if these
        suffice.
    :raises InputError: noise cannot be given to the run, or it has that of two seeds already.
    """
    scenario = spec.load()
    if scenario.installed_system.optional_part("draws") is None or getattr(scenario, "noise_from", None):
        found = Words(f"the noise of {scenario.name}")
        raise InputError("branch", "noise_from", found, "a run that can be given noise, and does not change it")
    own = {spec.seed, *(seed for seed, _ in getattr(scenario, "noise", ()))}
    seeds = [*islice((seed for seed in count(1) if seed not in own), CONTINUATIONS)]
    end = max(1, round(end_s * 1e9) // scenario.timing.base_tick_ns)
    by_batch = None if score_fails is None else _counted_by_batch(spec, scenario, seeds, end, score_fails)
    instants, share = (_INSTANTS, _BY_BATCH) if by_batch else (1, _BY_BRANCHES)
    asked = by_batch or _counted_by_branches(spec, scenario, seeds, fails)
    ticks = range(0, end, -(-end // instants))
    failed = dict(zip(ticks, asked(ticks), strict=True))
    while still_open := [tick for tick, number in failed.items() if number < len(seeds)]:
        low = max(still_open)
        high = min((tick for tick in failed if tick > low), default=end)
        if high - low <= max(1, end // share):
            break
        middle = (low + high) // 2
        (failed[middle],) = asked([middle])
    ordered = sorted(failed)
    at_s = tuple(round(_instant_s(tick, scenario), 9) for tick in ordered)
    return Decision(len(seeds), at_s, tuple(failed[tick] for tick in ordered))


def _instant_s(tick: int, scenario: AnyScenario) -> float:
    return tick * scenario.timing.base_tick_ns / 1e9


def _counted_by_batch(
    spec: RunSpec, scenario: AnyScenario, seeds: Sequence[int], end: int, score_fails: ScoreFails
) -> _Count | None:
    """Counts by the batch of the system; None: it does not make this run, or does not see that it fails."""
    make = scenario.installed_system.optional_part("vectors")
    is_other = spec.law.given is not None or spec.law.memory is not None or spec.plant_fmu is not None or spec.orders
    if make is None or is_other or batch_of(scenario) is None:
        return None
    try:
        runs = make(Case(scenario, spec.law, spec.perturbed))
    except InputError:
        # The nodes need no numba, and say what is wrong with the law.
        return None
    if not all(score_fails(runs.continue_run(spec.seed, [(end, seeds[0])]))):
        return None

    def asked(ticks: Sequence[int]) -> Sequence[int]:
        scores = runs.continue_run(spec.seed, [(tick, seed) for tick in ticks for seed in seeds])
        found: list[int] = np.reshape(score_fails(scores), (len(ticks), len(seeds))).sum(axis=1).tolist()
        return found

    return asked


def _counted_by_branches(
    spec: RunSpec, scenario: AnyScenario, seeds: Sequence[int], fails: Callable[[Result], bool]
) -> _Count:
    def asked(ticks: Sequence[int]) -> Sequence[int]:
        found = []
        with Trunk(spec) as trunk:
            for tick in ticks:
                from_s = round(_instant_s(tick, scenario), 9)
                if tick:
                    trunk.advance(from_s)
                settings = [f"noise_from=[{from_s!r}, {seed}]" for seed in seeds]
                found.append(sum(fails(trunk.branch(spec.faults, keep=False, settings=(one,))) for one in settings))
        return found

    return asked


def decision_of(record: Record) -> Decision:
    """:func:`find_decision` of a recorded run that fails: by its scores, and by its requirements if it has any.

    :raises InputError: as that, or the run cannot be repeated with the same bytes.
    """
    spec = branched_run(record.folder)
    violate = scores_that_violate(requirements_of(spec, record.scenario), record.scenario)

    def score_fails(scores: Sequence[Score]) -> Sequence[bool]:
        assert violate is not None
        return [bad or score.verdict != "PASS" for bad, score in zip(violate(scores), scores, strict=True)]

    by_score = None if violate is None else score_fails
    return find_decision(spec, record.trace.end_s, lambda result: not is_saved(result), by_score)


def lost_sentence(record: Record) -> str:
    """Up to when a recorded run could still be saved, in words; empty for a run that does not fail, or fails without
    faults and noise.

    :returns: of its faults :func:`~railhil.run.no_return.no_return_sentence`, else of its noise.
    """
    if record.verdict != "FAIL":
        return ""
    if said := no_return_sentence(record):
        return said
    try:
        return decision_of(record).sentence
    except InputError:
        return ""
