"""The motion of a train that keeps the timetable exactly, and the lateness of a train at a place."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from railhil.record.trace import FloatArray
from railhil.systems.ato.scenario.target import target_of
from railhil.systems.line.scenario.model import LineScenario, Section, StationStop

#: Interval of the planned motion inside a section, s.
_STEP_S = 0.5
#: Distance that keeps places apart at which the train stands, m.
_APART_M = 1e-9
#: A train this near to a stopping point is at the stop: its planned time there is arrival to departure, m (chosen).
_AT_STOP_M = 5.0
#: Speed below which a train that is at a stop stands or creeps there, m/s: the fastest jog.
_AT_STOP_MPS = 1.0


class PlannedMotion:
    """Time in s of the run, position in run coordinates in m, speed in m/s; shape (n,) each, both ends of each stop
    among them."""

    def __init__(self, stops: Sequence[StationStop], sections: Sequence[Section]) -> None:
        times, places, speeds = [np.zeros(1)], [np.zeros(1)], [np.zeros(1)]
        for section in sections:
            here, there = stops[section.departure], stops[section.arrival]
            assert here.depart_s is not None
            target = target_of(section.target)
            time_s = np.append(np.arange(0.0, target.stop_time_s, _STEP_S), target.stop_time_s)
            times.append(here.depart_s + time_s)
            places.append(np.minimum(here.position_m + np.asarray(target.position_m(time_s)), there.position_m))
            speeds.append(np.maximum(np.asarray(target.speed_mps(time_s)), 0.0))
            places[-1][-1], speeds[-1][-1] = there.position_m, 0.0
        self.time_s: FloatArray = np.concatenate(times)
        self.position_m: FloatArray = np.maximum.accumulate(np.concatenate(places))
        self.speed_mps: FloatArray = np.concatenate(speeds)
        self._stops = [stop for stop in stops if stop.service != "pass"]

    def positions_at(self, time_s: Any) -> FloatArray:
        """Planned position at each of some instants, shape of ``time_s``."""
        return np.asarray(np.interp(time_s, self.time_s, self.position_m), dtype=np.float64)

    def lateness_s(self, time_s: FloatArray, position_m: FloatArray, speed_mps: FloatArray) -> FloatArray:
        """How late a train is, negative: early; NaN where its place is not known, shape (n,).

        Under way it is the time less the planned time at that place. At a stop the train is early before the planned
        arrival and late after the planned departure; in between it is neither.
        """
        # Both ends of a stop keep their order: before it the arrival counts, behind it the departure.
        increasing_m = self.position_m + _APART_M * np.arange(len(self.position_m))
        planned_s = np.interp(position_m, increasing_m, self.time_s)
        found = np.asarray(time_s - planned_s, dtype=np.float64)
        for stop in self._stops:
            here = (np.abs(position_m - stop.position_m) <= _AT_STOP_M) & (speed_mps < _AT_STOP_MPS)
            arrive_s = 0.0 if stop.arrive_s is None else stop.arrive_s
            depart_s = np.inf if stop.depart_s is None else stop.depart_s
            first_s = np.minimum(arrive_s, planned_s[here])
            found[here] = time_s[here] - np.clip(time_s[here], first_s, np.maximum(depart_s, planned_s[here]))
        return found


def planned_motion(line: LineScenario) -> PlannedMotion:
    """The planned motion of a scenario, made once."""
    return _plan(line.stops, line.sections)


@lru_cache(maxsize=8)
def _plan(stops: tuple[StationStop, ...], sections: tuple[Section, ...]) -> PlannedMotion:
    return PlannedMotion(stops, sections)


def fold_positions(line: LineScenario, position_m: Any) -> FloatArray:
    """Places on the line from positions of the run: behind each turn-back the train comes back towards the first stop.

    :param position_m: m in run coordinates, any shape, NaN allowed.
    """
    knots = [0.0, *(stop.position_m for stop in line.stops if stop.turn_back), line.stops[-1].position_m]
    places = [0.0]
    for leg, length_m in enumerate(np.diff(knots).tolist()):
        places.append(places[-1] + (-length_m if leg % 2 else length_m))
    return np.asarray(np.interp(position_m, knots, places), dtype=np.float64)
