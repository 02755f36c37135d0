"""Train protection as ATP_LIM and ATP_STAT show it: levels, interventions, and how near the train came to the permitted
speed.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Container, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from railhil.bus.layout import FLAG_TRUE
from railhil.judge.record_checks import UNCLEAR
from railhil.record.trace import FloatArray, Trace
from railhil.systems.line.judge.course import Course
from railhil.systems.line.judge.motion import Motion
from railhil.wire.line import AtpLim, AtpStat, AtpStatus

BoolArray = npt.NDArray[np.bool_]
#: A milestone and the telegrams that show the same are this close together, s: two periods of both ports, and the
#: supervision's own period of 100 ms.
_TOGETHER_S: Final = 0.5
#: A slower train is not compared with the permitted speed, m/s: the last metre before a stop.
_COMPARED_MPS: Final = 1.0


@dataclass(frozen=True, slots=True)
class Spell:
    """A time for which the protection was at a level or above: begin and end in s, its first cause, and the number of
    telegrams that show it."""

    begun_s: float
    until_s: float
    cause: str
    telegrams: int


class ProtectionRecord:
    """ATP_LIM and ATP_STAT of a record.

    :param forged: ports whose content a fault of the run changes: they show no level and no demand.
    """

    def __init__(self, trace: Trace, forged: Container[str] = ()) -> None:
        self._trace = trace
        self._is_whole = AtpLim.PORT not in forged and AtpStat.PORT not in forged
        self.time_s: FloatArray = trace.times_s(AtpLim.PORT)
        self.permitted_mps: FloatArray = trace.values(AtpLim.PORT, "PermittedSpeed")
        self.status = trace.raw(AtpLim.PORT, "AtpStatus")
        self._demand_s = trace.times_s(AtpStat.PORT)
        self._cause = trace.raw(AtpStat.PORT, "AtpCause")
        brakes = ("ServiceBrake", "AtpEmergency")
        self._brake: BoolArray = np.logical_or.reduce([trace.raw(AtpStat.PORT, name) == FLAG_TRUE for name in brakes])
        self._cut: BoolArray = np.asarray(trace.raw(AtpStat.PORT, "TractionCut") == FLAG_TRUE)
        if AtpLim.PORT in forged:
            self.status = np.zeros_like(self.status)
        if AtpStat.PORT in forged:
            self._cause, self._brake, self._cut = map(np.zeros_like, (self._cause, self._brake, self._cut))

    def level(self, from_s: float, until_s: float) -> str:
        """The strongest level in an interval that two telegrams show, as the wire names it; empty without telegrams."""
        here = np.sort(self.status[(self.time_s >= from_s) & (self.time_s <= until_s)])
        return self._trace.word(AtpLim.PORT, "AtpStatus", int(here[-2])) if len(here) > 1 else ""

    def warnings(self) -> list[Spell]:
        """Times at the level of a warning or above it, or with a demand."""
        return [*self._spells(self.time_s, self.status >= AtpStatus.WARNING, self._demand_s, self._cut | self._brake)]

    def interventions(self) -> list[Spell]:
        """Times at the level of an intervention, or with a demand for a brake."""
        intervening = self.status >= AtpStatus.INTERVENTION
        return [*self._spells(self.time_s, intervening, self._demand_s, self._brake)]

    def _spells(
        self, first_s: FloatArray, first: BoolArray, second_s: FloatArray, second: BoolArray
    ) -> Iterator[Spell]:
        """Marked telegrams of two ports, joined where they are close together."""
        marked_s = np.sort(np.concatenate([first_s[first], second_s[second]]))
        if not len(marked_s):
            return
        gaps = np.flatnonzero(np.diff(marked_s) > _TOGETHER_S)
        for begin, end in zip([0, *(gaps + 1)], [*gaps, len(marked_s) - 1], strict=True):
            begun_s, until_s = float(marked_s[begin]), float(marked_s[end])
            yield Spell(begun_s, until_s, self._cause_between(begun_s, until_s), int(end - begin) + 1)

    def _cause_between(self, begun_s: float, until_s: float) -> str:
        near = (self._demand_s >= begun_s - _TOGETHER_S) & (self._demand_s <= until_s + _TOGETHER_S)
        causes = self._cause[near & (self._cause > 0)]
        return self._trace.word(AtpStat.PORT, "AtpCause", int(causes[0])) if len(causes) else "no cause told"

    def unlike(self, course: Course) -> str:
        """A demand or level that one telegram alone shows, or that has no milestone ``atp``, or such a milestone
        without any, as a reason; empty if there is none. Of a port that a fault changes nothing is compared."""
        if not self._is_whole:
            return ""
        for spell in self.interventions():
            if spell.telegrams == 1:
                return (
                    f"{UNCLEAR}one {AtpLim.PORT} or {AtpStat.PORT} alone says that the train protection intervenes, at "
                    f"{spell.begun_s:.2f} s"
                )
        told_s = [told.instant_s for told in course.protection]
        for spell in self.warnings():
            if not any(spell.begun_s - _TOGETHER_S <= at <= spell.until_s for at in told_s):
                return (
                    f"{UNCLEAR}{AtpLim.PORT} or {AtpStat.PORT} shows a reaction of the train protection at "
                    f"{spell.begun_s:.2f} s, but there is no milestone atp"
                )
        for at in told_s:
            shown = (self.time_s >= at - _TOGETHER_S) & (self.time_s <= at + _TOGETHER_S)
            demanded = (self._demand_s >= at - _TOGETHER_S) & (self._demand_s <= at + _TOGETHER_S)
            reacts = (self.status[shown] > AtpStatus.INDICATION).any()
            if not reacts and not (self._cut | self._brake | (self._cause > 0))[demanded].any():
                return f"{UNCLEAR}milestone atp at {at:.2f} s, but neither {AtpLim.PORT} nor {AtpStat.PORT} shows it"
        return ""

    def nearest_m(self, motion: Motion, from_s: float, until_s: float) -> float | None:
        """Smallest distance in an interval of time from the train to the place further on where the permitted speed is
        down to the train's own, m; None if it nowhere is.

        The permitted speed at a place is the one told when the train was there, linear in between.
        """
        here = (self.time_s >= from_s) & (self.time_s <= until_s)
        places_m = motion.positions_at(self.time_s[here]).tolist()
        permitted = self.permitted_mps[here].tolist()
        speeds = motion.speeds_at(self.time_s[here]).tolist()
        nearest: float | None = None
        # Telegrams with a lower permitted speed than all before them back to the present one, the nearest last.
        lower: list[int] = []
        lower_mps: list[float] = []
        for here_at in range(len(places_m) - 1, -1, -1):
            speed_mps = speeds[here_at]
            while lower and lower_mps[-1] >= permitted[here_at]:
                lower.pop()
                lower_mps.pop()
            lower.append(here_at)
            lower_mps.append(permitted[here_at])
            last = bisect_right(lower_mps, speed_mps) - 1
            if last < 0 or speed_mps <= _COMPARED_MPS:
                continue
            at, before = lower[last], max(here_at, lower[last] - 1)
            fall_mps = permitted[before] - permitted[at]
            share = (permitted[before] - speed_mps) / fall_mps if fall_mps > 0.0 else 0.0
            away_m = places_m[before] + share * (places_m[at] - places_m[before]) - places_m[here_at]
            nearest = away_m if nearest is None else min(nearest, away_m)
        return nearest
