"""The stops of a run: where a scenario wants the train to stand and when, and what became of each.

A run may have one or several. The system's score lists them (:attr:`railhil.supervisor.score.Score.stops`); score.json,
report, JUnit and console walk that list.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

#: Standstills reported nearer to each other than this are one.
_SAME_PLACE_M = 0.001


@dataclass(frozen=True, slots=True)
class Standstill:
    """Where something stood: instant in s, true position in m."""

    instant_s: float
    position_m: float


@dataclass(frozen=True, slots=True)
class PlannedStop:
    """One stop that a scenario asks for.

    :param error_max_m: how far from ``target_m`` is still a pass, either way.
    :param due_s: instant of the timetable, with ``late_max_s`` either way; None: no timetable, or none that is judged.
    """

    name: str
    target_m: float
    error_max_m: float
    due_s: float | None = None
    late_max_s: float | None = None


@dataclass(frozen=True, slots=True)
class ScoredStop:
    """A planned stop and the standstill that counts as it; None: it never stood there."""

    planned: PlannedStop
    standstill: Standstill | None

    @property
    def error_m(self) -> float | None:
        """How far past its point, in m."""
        return None if self.standstill is None else self.standstill.position_m - self.planned.target_m

    @property
    def late_s(self) -> float | None:
        """How late, in s; None without a timetable, too."""
        if self.standstill is None or self.planned.due_s is None:
            return None
        return self.standstill.instant_s - self.planned.due_s

    @property
    def missed(self) -> str:
        """What of the plan it misses, in words; empty when nothing."""
        if self.standstill is None:
            return "not stopped"
        compared = ((self.error_m, self.planned.error_max_m, "m"), (self.late_s, self.planned.late_max_s, "s"))
        return ", ".join(
            f"{found:+.3f} {unit} (allowed +-{allowed:g} {unit})"
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
    """The standstills behind the milestones ``(instant s, position m)``, in their order; one told twice counts once."""
    found: list[Standstill] = []
    for instant_s, position_m in reached:
        if all(abs(position_m - known.position_m) > _SAME_PLACE_M for known in found):
            found.append(Standstill(instant_s, position_m))
    return tuple(found)


def scored_stops(planned: Sequence[PlannedStop], found: Sequence[Standstill]) -> tuple[ScoredStop, ...]:
    """Each planned stop with the standstill that counts as it: of those that are nearer to it than to any other planned
    stop, the nearest, the first of equals."""
    near: list[list[Standstill]] = [[] for _ in planned]
    for one in found:
        away_m = [abs(one.position_m - stop.target_m) for stop in planned]
        near[away_m.index(min(away_m))].append(one)

    def nearest(stop: PlannedStop, own: Sequence[Standstill]) -> ScoredStop:
        return ScoredStop(stop, min(own, key=lambda one: abs(one.position_m - stop.target_m), default=None))

    return tuple(nearest(stop, own) for stop, own in zip(planned, near, strict=True))


def missed_stops(stops: Sequence[ScoredStop]) -> list[str]:
    """Sentences for a verdict: which stops are missed, and by what."""
    return [f"stop {stop.planned.name}: {stop.missed}" for stop in stops if stop.missed]
