"""Doors as DOOR_STAT shows them: when the exchange ends, when they close, and where they are open.

No figure depends on one telegram alone: a telegram that stands alone against those before and after it is named as a
contradiction of the record.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from railhil.judge.record_checks import UNCLEAR
from railhil.record.trace import FloatArray, Trace
from railhil.systems.line.judge.course import Course, Visit, stop_name
from railhil.systems.line.judge.motion import Motion
from railhil.systems.line.scenario.model import LineScenario, Side
from railhil.wire.line import DoorStat, DoorState

BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]
#: States of a door that cannot be open.
_SHUT: Final = (DoorState.LOCKED, DoorState.ISOLATED)
_CLOSING: Final = (DoorState.CLOSING, DoorState.OBSTRUCTED)
#: Sides of the doors, with the state of each and the platforms at which they may open.
_SIDES: Final[tuple[tuple[str, str, tuple[Side, ...]], ...]] = (
    ("left", "LeftState", ("left", "both")),
    ("right", "RightState", ("right", "both")),
)
#: Accuracy of the docking loop, by which doors may open outside of the window, m (section 2: 2 cm).
DOCKING_ERROR_M: Final = 0.02
#: A door telegram shows the state of its tick, the truth of the same tick may be in the next telegram, s.
_TICK_S: Final = 0.02
#: Smallest speed that is motion, m/s; below it a creeping train reads 0.
_MOVING_MPS: Final = 0.01
#: Time within which DOOR_STAT shows a milestone of the doors, s: its period and half of it again.
_SHOWN_S: Final = 0.12


@dataclass(frozen=True, slots=True)
class Exchange:
    """The exchange of passengers at one stop, in s of the run.

    ``ended_s``: when the doors may close; None: DOOR_STAT does not show it. ``closing_s``: when they began to close;
    None: they did not. ``reopened``: how often they opened again for an obstacle.
    """

    ended_s: float | None = None
    closing_s: float | None = None
    reopened: int = 0


class Doors:
    """The telegrams DOOR_STAT of a record, shape (n,) each."""

    def __init__(self, trace: Trace) -> None:
        port = DoorStat.PORT
        self.time_s: FloatArray = trace.times_s(port)
        self.states: dict[str, IntArray] = {side: trace.raw(port, name) for side, name, _ in _SIDES}
        psd = trace.raw(port, "PsdState")
        self._is_platform_open: BoolArray = (psd == DoorState.OPEN) | (trace.raw(port, "PsdPresent") == 0)
        self._left_s = trace.values(port, "DwellLeft")
        self._reopened = trace.raw(port, "Reopened")

    def exchange(self, visit: Visit, until_s: float) -> Exchange:
        """The exchange at a stop.

        Its end is the median over all telegrams of their instant plus the time that each says is left.

        :param until_s: departure, or end of the record.
        """
        if not visit.opened:
            return Exchange()
        opened_s = visit.opened[0].instant_s
        here = (self.time_s >= opened_s) & (self.time_s <= until_s)
        counting = here & (self._left_s > 0)
        ended_s = float(np.median((self.time_s + self._left_s)[counting])) if counting.any() else opened_s
        closing = here & np.logical_or.reduce([np.isin(state, _CLOSING) for state in self.states.values()])
        begun = np.flatnonzero(closing & np.append(closing[1:], False))
        closing_s = float(self.time_s[begun[0]]) if len(begun) else None
        return Exchange(ended_s, closing_s, _second_most(self._reopened[here]))

    def breaches(self, scenario: LineScenario, course: Course, motion: Motion) -> Iterator[str]:
        """The first time that a door is open in motion, outside of the window, or on the wrong side.

        A sentence that begins with :data:`~railhil.judge.record_checks.UNCLEAR` names a telegram that stands alone.
        """
        speed_mps, position_m = motion.speeds_at(self.time_s), motion.positions_at(self.time_s)
        later_mps = motion.speeds_at(self.time_s + _TICK_S)
        moving = np.minimum(np.abs(speed_mps), np.abs(later_mps)) > _MOVING_MPS
        here = self._stop_at(scenario, course)
        stops_m = np.array([stop.position_m for stop in scenario.stops])
        outside = np.abs(position_m - stops_m[here]) > scenario.route.door_window_m + DOCKING_ERROR_M
        for side, _, platforms in _SIDES:
            wrong_side = np.array([stop.platform not in platforms for stop in scenario.stops])[here]
            unlocked = ~np.isin(self.states[side], _SHUT)
            for what, marked in (
                ("open in motion", unlocked & moving),
                ("open outside of the window", unlocked & outside & ~moving),
                ("open, which is not the side of the platform", unlocked & wrong_side & ~moving & ~outside),
            ):
                yield from self._said(f"{side} doors {what}", marked, scenario, here, position_m, speed_mps)

    def _said(
        self, what: str, marked: BoolArray, scenario: LineScenario, here: IntArray, position_m: FloatArray,
        speed_mps: FloatArray,
    ) -> Iterator[str]:  # fmt: skip
        lasting = marked & (np.append(marked[1:], False) | np.append(False, marked[:-1]))
        for rows, before in ((lasting, ""), (marked & ~lasting, f"{UNCLEAR}one {DoorStat.PORT} alone says ")):
            if rows.any():
                first = int(np.flatnonzero(rows)[0])
                place = int(here[first])
                away_m = position_m[first] - scenario.stops[place].position_m
                yield (
                    f"{before}{what} at {self.time_s[first]:.2f} s, {speed_mps[first] * 3.6:.1f} km/h, "
                    f"{away_m:+.2f} m from stop {stop_name(scenario.stops, place)}"
                )

    def _stop_at(self, scenario: LineScenario, course: Course) -> IntArray:
        """The stop that each telegram belongs to: that of the last arrival, by number from 0."""
        arrivals = [(visit.arrived.instant_s, visit.stop) for visit in course.visits if visit.arrived is not None]
        times_s, places = [0.0, *(at for at, _ in arrivals)], [0, *(stop for _, stop in arrivals)]
        return np.array(places)[np.maximum(np.searchsorted(times_s, self.time_s, side="right") - 1, 0)]

    def unlike(self, scenario: LineScenario, course: Course) -> str:
        """A milestone of the doors that DOOR_STAT contradicts, or the other way round, as a reason; empty if none.

        Where DOOR_STAT is missing, nothing is compared.
        """
        opened = np.logical_or.reduce([state == DoorState.OPEN for state in self.states.values()])
        for visit in course.visits:
            name = stop_name(scenario.stops, visit.stop)
            for told in visit.opened:
                near = (self.time_s >= told.instant_s - _TICK_S) & (self.time_s <= told.instant_s + _SHOWN_S)
                if near.any() and not opened[near].any():
                    return f"{UNCLEAR}doors_open at {told.instant_s:.2f} s at stop {name}, but {DoorStat.PORT} does not"
        here, opened = self._stop_at(scenario, course), opened & self._is_platform_open
        lasting = np.flatnonzero(opened & np.append(opened[1:], False) & ~np.append(False, opened[:-1]))
        for first in lasting.tolist():
            begun_s, place = float(self.time_s[first]), int(here[first])
            visit = course.visits[place]
            if visit.departed is not None and begun_s >= visit.departed.instant_s:
                # Doors that open under way have no milestone; :meth:`breaches` names them.
                continue
            if not any(one.instant_s <= begun_s + _TICK_S for one in visit.opened):
                name = stop_name(scenario.stops, place)
                return (
                    f"{UNCLEAR}no doors_open at stop {name}, but {DoorStat.PORT} shows open doors "
                    f"from {begun_s:.2f} s on"
                )
        return ""


def _second_most(values: IntArray) -> int:
    """The largest value but one: a value that one telegram alone has does not count."""
    return int(np.sort(values)[-2]) if len(values) > 1 else 0
