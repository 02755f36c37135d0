"""A complete recorded run over a line, and its figures for each stop and for the whole line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railhil.bus.ident import INDEXINGS, CtlIdent
from railhil.bus.layout import FLAG_TRUE
from railhil.faults import parse_faults
from railhil.judge.stops import Passing, PlannedStop, ScoredStop, Standstill
from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.energy.record import electric_work_kj, energy_share_percent, work_kj
from railhil.systems.ato.judge import journey
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.line.judge.course import Course, Visit, stop_name
from railhil.systems.line.judge.doors import Doors
from railhil.systems.line.judge.lateness import Instants, delay_of, early_excused_s, excused_s, less, nominal_exchange_s
from railhil.systems.line.judge.motion import Motion
from railhil.systems.line.judge.protection import ProtectionRecord
from railhil.systems.line.judge.stop import LineStop, SectionFigures
from railhil.systems.line.scenario.model import LineScenario, Section, StationStop
from railhil.systems.line.scenario.sections import choose_running_time, make_target, section_scenario
from railhil.systems.line.shipped_bounds import shipped_bound_kj
from railhil.wire.line import AtoStat, StnInfo

#: Resolution of the running time that the controller tells, s.
_TOLD_S = 0.1
#: Period of STN_INFO, s: what one telegram says lasts until the next.
_STATION_S = 0.16


@dataclass(frozen=True)
class LineRun:
    """A run whose record is complete: its course, its motion, and what its telegrams show beside.

    ``forged``: ports whose telegrams a fault of the run changes, repeats or sends.
    """

    scenario: LineScenario
    trace: Trace
    course: Course
    motion: Motion
    doors: Doors
    protection: ProtectionRecord
    forged: frozenset[str] = frozenset()

    @cached_property
    def stops(self) -> tuple[LineStop, ...]:
        """The stops in the order of the run."""
        found: list[LineStop] = []
        excused = 0.0
        for visit in self.course.visits:
            stop, excused = self._stop(visit, excused)
            found.append(stop)
        return tuple(found)

    @property
    def served(self) -> list[LineStop]:
        """The stops at which the train has to stop."""
        return [stop for stop in self.stops if stop.planned.service == "stop"]

    def _stop(self, visit: Visit, excused: float) -> tuple[LineStop, float]:
        """The figures of a stop, and the lateness that excuses the next arrival.

        :param excused: that of this arrival; a stop that is passed hands it on.
        """
        of = self.scenario.stops[visit.stop]
        planned = self._planned(visit.stop, of)
        if planned.service == "pass":
            passed = None
            if visit.passed is not None:
                at_s = visit.passed.instant_s
                passed = Passing(at_s, float(self.motion.speeds_at(np.array([at_s]))[0]))
            return LineStop(planned, None, passed=passed, section=None), excused
        here, instants = self._rest(visit), self._instants(visit, of)
        delay = delay_of(self.scenario, of.dwell_min_s, instants)
        late_s = instants.departure_late_s
        is_late = late_s is not None and late_s > self.scenario.timing.control_period_ns / 1e9
        arriving = next((one for one in self.scenario.sections if one.arrival == visit.stop), None)
        departing = next((one for one in self.scenario.sections if one.departure == visit.stop), None)
        drawn_s = less(instants.exchange.ended_s, instants.opened_s)
        usual_s = nominal_exchange_s(self.scenario, of.dwell_min_s)
        stop = LineStop(
            planned,
            here,
            departed_s=instants.departed_s,
            excused_s=excused,
            early_excused_s=0.0 if arriving is None else early_excused_s(self.scenario, arriving),
            departure_excused_s=0.0 if late_s is None else max(0.0, late_s - delay.controller),
            platform=of.platform,
            dwell_nominal_s=of.dwell_min_s if instants.opened_s is not None else None,
            dwell_drawn_s=None if drawn_s is None else of.dwell_min_s + drawn_s - usual_s,
            dwell_s=less(instants.departed_s, instants.stood_s),
            opened_after_s=less(instants.opened_s, instants.stood_s),
            moved_after_s=less(self._moves_s(instants.departed_s), instants.due_departure_s),
            delay=delay,
            late_for=delay.cause if is_late else "",
            jogs=len(visit.creeps),
            reopened=instants.exchange.reopened,
            refused=len(visit.refused),
            doors_opened=bool(visit.opened),
            is_missed=visit.missed is not None,
            section=self._section(visit),
        )
        after = excused_s(self.scenario, departing, instants, delay) if departing is not None else 0.0
        return stop, after

    def _planned(self, place: int, of: StationStop) -> PlannedStop:
        route = self.scenario.route
        is_first = place == 0
        return PlannedStop(
            stop_name(self.scenario.stops, place),
            of.position_m,
            of.stop_error_max_m,
            due_s=None if is_first else of.arrive_s,
            late_max_s=None if of.arrive_s is None else route.arrival_error_max_s,
            service="start" if is_first else "pass" if of.service == "pass" else "stop",
            departure_due_s=of.depart_s,
            departure_late_max_s=route.departure_late_max_s,
        )

    def _rest(self, visit: Visit) -> Standstill | None:
        """The last standstill before the doors opened, or before the departure."""
        if visit.arrived is None:
            return None
        creeps = visit.creeps
        if not creeps:
            return Standstill(visit.arrived.instant_s, visit.arrived.position_m)
        motion = self.motion
        after = np.flatnonzero((motion.time_s > creeps[-1].instant_s) & (motion.speed_mps > 0.0))
        moving = int(after[0]) if len(after) else len(motion.time_s) - 1
        still = np.flatnonzero(motion.speed_mps[moving:] == 0.0)
        at = moving + int(still[0]) if len(still) else len(motion.time_s) - 1
        return Standstill(float(motion.time_s[at]), float(motion.position_m[at]))

    def _instants(self, visit: Visit, of: StationStop) -> Instants:
        here = self._rest(visit)
        departed_s = None if visit.departed is None else visit.departed.instant_s
        until_s = self.trace.end_s if departed_s is None else departed_s
        locked = [told.instant_s for told in visit.locked if told.instant_s <= until_s]
        locked_s = max(locked, default=None)
        return Instants(
            due_arrival_s=None if visit.stop == 0 else of.arrive_s,
            due_departure_s=of.depart_s,
            stood_s=None if here is None else here.instant_s,
            opened_s=visit.opened[0].instant_s if visit.opened else None,
            exchange=self.doors.exchange(visit, until_s),
            locked_s=locked_s,
            red_s=self._red_s(max(locked_s or 0.0, of.depart_s or 0.0), until_s),
            departed_s=departed_s,
        )

    def _red_s(self, from_s: float, until_s: float) -> float:
        """Time without the permission to depart, from the telegrams that say so: one alone changes little."""
        red_s = self._red_at_s
        return float(np.count_nonzero((red_s >= from_s) & (red_s < until_s))) * _STATION_S

    @cached_property
    def _red_at_s(self) -> FloatArray:
        """Instants of STN_INFO without the permission to depart, s."""
        refused = self.trace.raw(StnInfo.PORT, "DepartPermit") != FLAG_TRUE
        found: FloatArray = self.trace.times_s(StnInfo.PORT)[refused]
        return found

    def _moves_s(self, departed_s: float | None) -> float | None:
        if departed_s is None:
            return None
        moving = np.flatnonzero((self.motion.time_s >= departed_s) & (self.motion.speed_mps > 0.0))
        return float(self.motion.time_s[moving[0]]) if len(moving) else None

    def _section(self, visit: Visit) -> SectionFigures | None:
        """The figures of the section that ends at a stop; None for the first stop, and without an arrival."""
        index = next((at for at, one in enumerate(self.scenario.sections) if one.arrival == visit.stop), None)
        if index is None or visit.arrived is None:
            return None
        section = self.scenario.sections[index]
        left = self.course.visits[section.departure].departed
        if left is None:
            return None
        from_s, until_s = left.instant_s, visit.arrived.instant_s
        chosen_s = self._chosen_s(index, from_s, until_s)
        run, has_target = self._journey(index, section, from_s, until_s, chosen_s)
        protection = self.protection if self.scenario.atp.enabled else None
        traction_kj = work_kj(run.time_s, run.traction_n * run.speed_mps)
        bound_kj = shipped_bound_kj(self.scenario, index + 1, until_s - from_s)
        return SectionFigures(
            number=index + 1,
            planned_s=section.running_time_s,
            chosen_s=chosen_s,
            made_s=until_s - from_s,
            traction_kj=traction_kj,
            regenerated_kj=electric_work_kj(self.scenario, run.time_s, run.speed_mps, run.brake_n),
            bound_kj=bound_kj,
            energy_share_percent=None if bound_kj is None else energy_share_percent(traction_kj, bound_kj),
            comfort_mps2_per_km=journey.comfort_mps2_per_km(run),
            itae_kmh_s2=journey.itae_kmh_s2(run) if has_target else None,
            nearest_m=protection.nearest_m(self.motion, from_s, until_s) if protection else None,
            level=protection.level(from_s, until_s) if protection else "off",
        )

    def _chosen_s(self, index: int, from_s: float, until_s: float) -> float | None:
        """The running time that most telegrams of the controller name in the section; None: none does."""
        time_s, section, running_s = self._told_times
        told_s = running_s[(time_s > from_s) & (time_s < until_s) & (section == index + 1)]
        return float(np.median(told_s)) if len(told_s) else None

    @cached_property
    def _told_times(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """ATO_STAT: instants in s, section, running time in s; shape (n,) each."""
        port = AtoStat.PORT
        return self.trace.times_s(port), self.trace.values(port, "AtoSection"), self.trace.values(port, "RunningTime")

    def _journey(
        self, index: int, section: Section, from_s: float, until_s: float, chosen_s: float | None
    ) -> tuple[journey.Journey, bool]:
        """The run of a section as one of ``ato``, and whether its target curve is known."""
        line = self.scenario
        _, running_s, curve = choose_running_time(line, index, from_s)
        if chosen_s is not None and abs(chosen_s - running_s) > _TOLD_S:
            running_s, curve = chosen_s, None
        from_m = line.stops[section.departure].position_m
        distance_m = line.stops[section.arrival].position_m - from_m
        target = None
        try:
            target = make_target(line, index, running_s, distance_m, curve)
        except CurveError:
            # No curve is so fast; the law had another one, which the record does not name.
            running_s = section.running_time_s
        scenario = section_scenario(line, index, target, running_s)
        ident = self.trace.ident(CtlIdent)
        part = self.motion.between(from_s, until_s)
        stood = Standstill(until_s - from_s, float(part.position_m[-1]) - from_m)
        made = journey.Journey(
            scenario=scenario,
            indexing=INDEXINGS[ident.indexing] if ident is not None and ident.indexing < len(INDEXINGS) else "time",
            time_s=part.time_s - from_s,
            position_m=part.position_m - from_m,
            speed_mps=part.speed_mps,
            accel_mps2=part.accel_mps2,
            traction_n=part.traction_n,
            brake_n=part.brake_n,
            stop=ScoredStop(PlannedStop("", distance_m, 0.0), stood),
        )
        return made, target is not None

    @cached_property
    def whole(self) -> journey.Journey:
        """The whole run as one of ``ato``, whose stop is the last one."""
        return journey.Journey(
            scenario=self.scenario,
            indexing="time",
            time_s=self.motion.time_s,
            position_m=self.motion.position_m,
            speed_mps=self.motion.speed_mps,
            accel_mps2=self.motion.accel_mps2,
            traction_n=self.motion.traction_n,
            brake_n=self.motion.brake_n,
            stop=self.stops[-1],
        )

    def worst(self, of: Callable[[LineStop], float | None]) -> float | None:
        """The value of largest size over the served stops, with its sign; None if one of them has none."""
        values = [of(stop) for stop in self.served]
        known = [value for value in values if value is not None]
        return max(known, key=abs) if known and len(known) == len(values) else None


def forged_ports(scenario: LineScenario) -> frozenset[str]:
    """Ports whose telegrams a fault of the run changes, repeats or sends; a bus that is disturbed changes any."""
    found = set[str]()
    for fault in parse_faults(scenario.faults):
        if fault.place.level == "bus":
            found |= {port.name for port in scenario.installed_system.contract.ports}
        found.add(fault.place.name)
    return frozenset(found)
