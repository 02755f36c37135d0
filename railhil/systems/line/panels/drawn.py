"""A recorded run of a line, ready to be drawn, and what its doors did at each stop."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from railhil.charts.figure import Look
from railhil.judge.record import Record
from railhil.record.sampling import Sampler, holding_s
from railhil.record.trace import FloatArray, Trace
from railhil.report.styles import Style
from railhil.systems.ato.judge.measures import KMH
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.ato import SimTruth
from railhil.wire.line import AtpLim, AtpStat, DoorStat, DoorState, SignalAspect, StnInfo

#: Rows of SIM_TRUTH after a departure until STN_INFO tells the next section, at most.
_TOLD_ROWS = 16
#: The parts of a stop, in their order.
DOORS, EXCHANGE, HOLD = "doors", "exchange", "hold"


class Spell(NamedTuple):
    """A part of a stop: number of the stop from 1, kind, begin and end in s."""

    stop: int
    kind: str
    begun_s: float
    until_s: float


class Red(NamedTuple):
    """A time for which the record shows a red signal that is not red by the scenario: place in the run in m, begin and
    end in s."""

    position_m: float
    begun_s: float
    until_s: float


@dataclass(frozen=True)
class DrawnRun:
    """One run: its curves are those of SIM_TRUTH, shape (n,), NaN where the record has a gap.

    ``number``: of the run on the page.
    """

    label: str
    style: Style
    number: int
    scenario: LineScenario
    record: Record

    #: Whether other runs stand beside it.
    is_among: bool = False

    @property
    def look(self) -> Look:
        """Its line: alone, continuous and stronger than the plan."""
        return self.style.look if self.is_among else Look(self.style.look.colour, 1.8)

    @property
    def trace(self) -> Trace:
        """The record with its gaps."""
        return self.record.trace

    @cached_property
    def time_s(self) -> FloatArray:
        """Instants of SIM_TRUTH."""
        return self.trace.times_s(SimTruth.PORT)

    @cached_property
    def position_m(self) -> FloatArray:
        """Position in run coordinates."""
        return self.trace.values(SimTruth.PORT, "TruePos")

    @cached_property
    def speed_kmh(self) -> FloatArray:
        """True speed."""
        return self.trace.values(SimTruth.PORT, "TrueSpeed") * KMH

    @cached_property
    def permitted_kmh(self) -> FloatArray:
        """Permitted speed of the train protection at the instants of SIM_TRUTH."""
        return self._sampler.signal(AtpLim.PORT, "PermittedSpeed") * KMH

    @cached_property
    def ebi_kmh(self) -> FloatArray:
        """Speed of its emergency brake at the instants of SIM_TRUTH."""
        return self._sampler.signal(AtpStat.PORT, "EbiSpeed") * KMH

    @cached_property
    def uncertainty_m(self) -> FloatArray:
        """Half of its interval of the position, at the instants of SIM_TRUTH."""
        return self._sampler.signal(AtpStat.PORT, "Uncertainty")

    @cached_property
    def has_protection(self) -> bool:
        """Whether the train protection is on, and told anything."""
        return self.scenario.atp.enabled and self.trace.count(AtpLim.PORT) > 0

    @cached_property
    def _sampler(self) -> Sampler:
        return Sampler(self.trace, self.time_s, holding_s(self.scenario, self.trace.contract))

    def section_rows(self, section: int) -> tuple[int, int]:
        """First row of a section's run and the row after its standstill; a train that has not come so far has none.

        :param section: its number from 1, from the departure on.
        """
        here = np.flatnonzero(self._sections == section)
        if not len(here):
            return 0, 0
        stands = here[self.speed_kmh[here] == 0.0]
        after = int(here[-1]) + 1
        if len(stands) and after - stands[-1] <= _TOLD_ROWS:
            # The dwell has no place of its own.
            breaks = np.flatnonzero(np.diff(stands) > 1)
            after = int(stands[breaks[-1] + 1 if len(breaks) else 0]) + 1
        return int(here[0]), after

    def leg_rows(self, leg: int) -> npt.NDArray[np.int64]:
        """Rows on a leg, the gaps among them; where the leg is not known, it is that of the row before.

        :param leg: its number from 0.
        """
        told = self._sampler.signal(StnInfo.PORT, "Leg")
        places = np.maximum.accumulate(np.where(np.isfinite(told), np.arange(len(told)), 0))
        return np.flatnonzero(np.nan_to_num(told[places]) == leg)

    @cached_property
    def _sections(self) -> FloatArray:
        return self._sampler.signal(StnInfo.PORT, "Section")

    def spells(self) -> list[Spell]:
        """What the doors did at each stop, in the order of time, from the telegrams DOOR_STAT and STN_INFO.

        Doors: from the standstill until they are open, and while they close or open again. Exchange: the rest of the
        exchange of passengers is above 0. Hold: doors are open longer, or the train stands with doors closed again.
        """
        port, trace = DoorStat.PORT, self.trace
        time_s = trace.times_s(port)
        here = Sampler(trace, time_s, holding_s(self.scenario, trace.contract)).signal(StnInfo.PORT, "StationHere")
        states = [trace.values(port, name) for name in ("LeftState", "RightState", "PsdState")]
        left_s = trace.values(port, "DwellLeft")
        is_open = np.logical_or.reduce([state == DoorState.OPEN for state in states])
        moves = np.logical_or.reduce(
            [np.isin(state, (DoorState.OPENING, DoorState.CLOSING, DoorState.OBSTRUCTED)) for state in states]
        )
        found: list[Spell] = []
        opened_at = -1.0
        for row, (at_s, stop) in enumerate(zip(time_s.tolist(), here.tolist(), strict=True)):
            if not stop > 0 or left_s[row] != left_s[row]:
                opened_at = -1.0
                continue
            was_open = opened_at == stop
            if is_open[row]:
                opened_at = stop
            is_exchange = is_open[row] and not moves[row] and left_s[row] > 0
            is_doors = moves[row] or not (was_open or is_open[row] or stop == 1)
            kind = DOORS if is_doors else EXCHANGE if is_exchange else HOLD
            if found and found[-1].until_s == at_s and (found[-1].stop, found[-1].kind) == (stop, kind):
                found[-1] = found[-1]._replace(until_s=self._next(time_s, row))
            else:
                found.append(Spell(int(stop), kind, at_s, self._next(time_s, row)))
        return found

    def reds(self) -> list[Red]:
        """Red signals that the scenario does not have red then, in the order of time, from STN_INFO: a fault holds
        them. Its place is that of the next signal on the way; without one the exit of the stop where the train stands.
        """
        port, trace, line = StnInfo.PORT, self.trace, self.scenario
        time_s, is_red = trace.times_s(port), trace.raw(port, "SignalNext") == SignalAspect.RED
        here, legs = trace.values(port, "StationHere"), trace.values(port, "Leg")
        places_m = np.interp(time_s, self.time_s, self.position_m)
        found: list[Red] = []
        for row in np.flatnonzero(is_red & np.isfinite(places_m)).tolist():
            at_s, place_m = float(time_s[row]), float(places_m[row])
            stop = line.stops[int(here[row]) - 1] if here[row] > 0 else None
            leg = int(legs[row]) + int(stop is not None and stop.turn_back)
            ahead = [one for one in line.signals if one.leg == leg and one.position_m >= place_m]
            signal = min(ahead, key=lambda one: one.position_m, default=None)
            if signal is not None and at_s < signal.clear_s:
                continue
            if signal is not None:
                place_m = signal.position_m
            elif stop is not None:
                place_m = stop.position_m
            until_s = self._next(time_s, row)
            if found and found[-1].until_s == at_s and found[-1].position_m == place_m:
                found[-1] = found[-1]._replace(until_s=until_s)
            else:
                found.append(Red(place_m, at_s, until_s))
        return found

    @staticmethod
    def _next(time_s: FloatArray, row: int) -> float:
        return float(time_s[min(row + 1, len(time_s) - 1)])
