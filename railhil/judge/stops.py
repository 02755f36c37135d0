"""The stops of a run: place and time of the stops that a scenario requires, and the result for each.

A run may have one or several. They are listed in the system's score (:attr:`railhil.judge.score.Score.stops`),
from which score.json, report, JUnit and console take them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from railhil.common.digits import text_beside_limit

#: Reported standstills closer together than this count as one.
_SAME_PLACE_M = 0.001


@dataclass(frozen=True, slots=True)
class Standstill:
    """A standstill: instant in s, true position in m."""

    instant_s: float
    position_m: float


@dataclass(frozen=True, slots=True)
class PlannedStop:
    """One stop that a scenario requires.

    :param error_max_m: allowed distance from ``target_m``, in either direction.
    :param due_s: instant in the timetable, allowed ``late_max_s`` early or late; None: there is no timetable, or it is
        not judged.
    """

    name: str
    target_m: float
    error_max_m: float
    due_s: float | None = None
    late_max_s: float | None = None


@dataclass(frozen=True, slots=True)
class ScoredStop:
    """A planned stop and the standstill assigned to it; None: the train did not stop there."""

    planned: PlannedStop
    standstill: Standstill | None

    @property
    def error_m(self) -> float | None:
        """Distance past the stopping point, in m."""
        return None if self.standstill is None else self.standstill.position_m - self.planned.target_m

    @property
    def late_s(self) -> float | None:
        """Delay in s; None without a standstill or a timetable."""
        if self.standstill is None or self.planned.due_s is None:
            return None
        return self.standstill.instant_s - self.planned.due_s

    @property
    def missed(self) -> str:
        """The limits of the plan that it misses, in words; empty if none."""
        if self.standstill is None:
            return "not stopped"
        compared = ((self.error_m, self.planned.error_max_m, "m"), (self.late_s, self.planned.late_max_s, "s"))
        return ", ".join(
            f"{text_beside_limit(found, allowed, 3, '+')} {unit} (allowed +-{allowed:.10g} {unit})"
            for found, allowed, unit in compared
            if found is not None and allowed is not None and abs(found) > allowed
        )

    @property
    def verdict(self) -> str:
        """PASS or FAIL."""
        return "FAIL" if self.missed else "PASS"

    def as_json(self) -> dict[str, Any]:
        """Its entry in ``stops`` of ``score.json``."""
        return {
            "name": self.planned.name,
            "target_m": self.planned.target_m,
            "instant_s": None if self.standstill is None else self.standstill.instant_s,
            "position_m": None if self.standstill is None else self.standstill.position_m,
            "error_m": self.error_m,
            "error_max_m": self.planned.error_max_m,
            "late_s": self.late_s,
            "late_max_s": self.planned.late_max_s,
            "verdict": self.verdict,
        }


def standstills_of(reached: Sequence[tuple[float, float]]) -> tuple[Standstill, ...]:
    """The standstills from the milestones ``(instant s, position m)``, in order; one reported twice counts once."""
    found: list[Standstill] = []
    for instant_s, position_m in reached:
        if all(abs(position_m - known.position_m) > _SAME_PLACE_M for known in found):
            found.append(Standstill(instant_s, position_m))
    return tuple(found)


def scored_stops(planned: Sequence[PlannedStop], found: Sequence[Standstill]) -> tuple[ScoredStop, ...]:
    """Each planned stop with the standstill assigned to it: the nearest of the standstills that are nearer to it than
    to any other planned stop; the first if several are equally near."""
    near: list[list[Standstill]] = [[] for _ in planned]
    for one in found:
        away_m = [abs(one.position_m - stop.target_m) for stop in planned]
        near[away_m.index(min(away_m))].append(one)

    def nearest(stop: PlannedStop, own: Sequence[Standstill]) -> ScoredStop:
        return ScoredStop(stop, min(own, key=lambda one: abs(one.position_m - stop.target_m), default=None))

    return tuple(nearest(stop, own) for stop, own in zip(planned, near, strict=True))


def missed_stops(stops: Sequence[ScoredStop]) -> list[str]:
    """Sentences for a verdict: the missed stops with their reasons."""
    return [f"stop {stop.planned.name}: {stop.missed}" for stop in stops if stop.missed]
