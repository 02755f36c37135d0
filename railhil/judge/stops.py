"""The stops of a run: place and time of the stops that a scenario requires, and the result for each.

A run may have one or several. They are listed in the system's score (:attr:`railhil.judge.score.Score.stops`),
from which score.json, report, JUnit and console take them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

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
    :param service: ``start``: the run begins here, so that only the departure counts; ``pass``: the train has to pass
        without a stop.
    :param departure_due_s: the departure in the timetable, allowed ``departure_late_max_s`` late.
    """

    name: str
    target_m: float
    error_max_m: float
    due_s: float | None = None
    late_max_s: float | None = None
    service: Literal["start", "stop", "pass"] = "stop"
    departure_due_s: float | None = None
    departure_late_max_s: float | None = None


@dataclass(frozen=True, slots=True)
class Passing:
    """A passing without a stop: instant in s, true speed in m/s."""

    instant_s: float
    speed_mps: float


class StopColumn(NamedTuple):
    """A column of a table of stops: heading with the unit in brackets, and the text for one stop; ``brief``: also on a
    terminal."""

    heading: str
    text: str
    brief: bool = False


@dataclass(frozen=True, slots=True)
class ScoredStop:
    """A planned stop and the standstill assigned to it; None: the train did not stop there.

    ``departed_s``: instant of the departure. ``passed``: where the service is to pass. ``excused_s``: time by which the
    arrival may be later than the limit, ``early_excused_s``: earlier, ``departure_excused_s``: by which the departure
    may be later, for what the run could not avoid.
    """

    planned: PlannedStop
    standstill: Standstill | None
    departed_s: float | None = None
    passed: Passing | None = None
    excused_s: float = 0.0
    departure_excused_s: float = 0.0
    early_excused_s: float = 0.0

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
    def departure_late_s(self) -> float | None:
        """Delay of the departure in s; None without a departure or a timetable."""
        if self.departed_s is None or self.planned.departure_due_s is None:
            return None
        return self.departed_s - self.planned.departure_due_s

    @property
    def misses(self) -> tuple[str, ...]:
        """Each limit of the plan that it misses, in words."""
        planned = self.planned
        if planned.service == "pass" and self.passed is None:
            return ("not passed",)
        if planned.service == "stop" and self.standstill is None:
            return ("not stopped",)
        found = [_beyond(self.error_m, planned.error_max_m, "m"), self._late]
        if planned.departure_due_s is not None and self.departed_s is None:
            found.append("not departed")
        most_s, late_s = planned.departure_late_max_s, self.departure_late_s
        if most_s is not None and late_s is not None and late_s > most_s + self.departure_excused_s:
            allowed_s = most_s + self.departure_excused_s
            found.append(f"departure {_later(late_s, allowed_s)}")
        return tuple(filter(None, found))

    @property
    def _late(self) -> str:
        most_s, late_s = self.planned.late_max_s, self.late_s
        if most_s is None or late_s is None:
            return ""
        if late_s < 0.0:
            found = _beyond(late_s, most_s + self.early_excused_s, "s")
        elif not self.excused_s:
            found = _beyond(late_s, most_s, "s")
        else:
            allowed_s = most_s + self.excused_s
            found = _later(late_s, allowed_s) if late_s > allowed_s else ""
        return f"arrival {found}" if found else ""

    @property
    def missed(self) -> str:
        """The limits of the plan that it misses, in words; empty if none."""
        return ", ".join(self.misses)

    @property
    def headed(self) -> tuple[StopColumn, ...]:
        """All columns of a table of stops but its name, and its verdict with the limits that it misses."""
        usual = (
            StopColumn("at (m)", f"{self.planned.target_m:g}"),
            StopColumn("error (m)", _text(self.error_m), brief=True),
            StopColumn("late (s)", _text(self.late_s), brief=True),
        )
        return (*usual, *self.columns)

    @property
    def columns(self) -> tuple[StopColumn, ...]:
        """Further columns of a table of stops, with the same headings for all stops of a run. None for a stop of which
        only place and time count."""
        return ()

    @property
    def verdict(self) -> str:
        """PASS or FAIL."""
        return "FAIL" if self.missed else "PASS"

    def as_json(self) -> dict[str, Any]:
        """Its entry in ``stops`` of ``score.json``; keys of departure and passing only where the plan has them."""
        planned, more = self.planned, dict[str, Any]()
        if planned.service != "stop" or planned.departure_late_max_s is not None:
            more |= {
                "service": planned.service,
                "departed_s": self.departed_s,
                "departure_late_s": self.departure_late_s,
                "departure_late_max_s": planned.departure_late_max_s,
                "passed_s": None if self.passed is None else self.passed.instant_s,
                "passed_mps": None if self.passed is None else self.passed.speed_mps,
                "excused_s": self.excused_s,
                "early_excused_s": self.early_excused_s,
                "departure_excused_s": self.departure_excused_s,
            }
        return {
            "name": self.planned.name,
            "target_m": self.planned.target_m,
            "instant_s": None if self.standstill is None else self.standstill.instant_s,
            "position_m": None if self.standstill is None else self.standstill.position_m,
            "error_m": self.error_m,
            "error_max_m": self.planned.error_max_m,
            "late_s": self.late_s,
            "late_max_s": self.planned.late_max_s,
            **more,
            "verdict": self.verdict,
        }


def _later(late_s: float, allowed_s: float) -> str:
    """A lateness above its limit, in words; a limit that a run has made has many digits."""
    found, allowed = text_beside_limit(late_s, allowed_s, 3, "+"), text_beside_limit(allowed_s, late_s, 3, "+")
    return f"{found} s (allowed at most {allowed} s)"


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:+.4f}"


def _beyond(found: float | None, allowed: float | None, unit: str) -> str:
    """A value beyond its limit in either direction, in words; empty if it keeps the limit, or if there is none."""
    if found is None or allowed is None or abs(found) <= allowed:
        return ""
    return f"{text_beside_limit(found, allowed, 3, '+')} {unit} (allowed +-{allowed:.10g} {unit})"


def standstills_of(reached: Sequence[tuple[float, float]]) -> tuple[Standstill, ...]:
    """The standstills from the milestones ``(instant s, position m)``, in order; one reported twice counts once."""
    found: list[Standstill] = []
    for instant_s, position_m in reached:
        if all(abs(position_m - known.position_m) > _SAME_PLACE_M for known in found):
            found.append(Standstill(instant_s, position_m))
    return tuple(found)


def scored_stops(planned: Sequence[PlannedStop], found: Sequence[Standstill]) -> tuple[ScoredStop, ...]:
    """Each planned stop with the standstill assigned to it by its place: the nearest of the standstills that are nearer
    to it than to any other planned stop; the first if several are equally near."""
    near: list[list[Standstill]] = [[] for _ in planned]
    for one in found:
        away_m = [abs(one.position_m - stop.target_m) for stop in planned]
        near[away_m.index(min(away_m))].append(one)

    def nearest(stop: PlannedStop, own: Sequence[Standstill]) -> ScoredStop:
        return ScoredStop(stop, min(own, key=lambda one: abs(one.position_m - stop.target_m), default=None))

    return tuple(nearest(stop, own) for stop, own in zip(planned, near, strict=True))


def worst_stop(stops: Sequence[ScoredStop]) -> ScoredStop | None:
    """The stop that misses most limits, and of several the one with the largest stop error; None without a stop."""
    made = [stop for stop in stops if stop.planned.service == "stop"]
    return max(made, key=lambda stop: (len(stop.misses), abs(stop.error_m or 0.0)), default=None)


def missed_stops(stops: Sequence[ScoredStop]) -> list[str]:
    """Sentences for a verdict: the missed stops with their reasons."""
    return [f"stop {stop.planned.name}: {stop.missed}" for stop in stops if stop.missed]
