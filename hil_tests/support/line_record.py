"""Records of a run over a line, made from its timetable without a bench: for figures, before and beside real runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from hil_tests.support.recordings import row_of
from railhil.judge.record import Record
from railhil.judge.score import Score
from railhil.judge.stops import PlannedStop, Standstill
from railhil.record.sampling import drawn_trace
from railhil.record.trace import Trace
from railhil.systems.ato.scenario.target import target_of
from railhil.systems.line.judge.criteria import CRITERIA, EXTRAS
from railhil.systems.line.judge.stop import LineStop, SectionFigures
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.ato import SimTruth
from railhil.wire.line import AtpLim, AtpStat, DoorStat, DoorState, StnInfo

#: Periods of the telegrams in ns.
_TRUTH_NS, _FAST_NS, _SLOW_NS = 20_000_000, 80_000_000, 160_000_000
#: Doors: opening from the standstill on, closing before the departure, s.
_OPENING_S, _CLOSING_S = 2.8, 3.3


class ImaginedRun:
    """A train that departs with some lateness at each stop and then keeps the running time of the timetable.

    :param late_s: lateness of the departures by the number of the stop from 0; others depart on time or when they can.
    :param error_m: stop errors likewise; others stop exactly.
    :param until_s: end of the record; None: 10 s after the last arrival.
    :param silent: ports and the intervals of time in which they are not recorded.
    """

    def __init__(
        self,
        line: LineScenario,
        late_s: Mapping[int, float] | None = None,
        error_m: Mapping[int, float] | None = None,
        until_s: float | None = None,
        silent: Sequence[tuple[str, float, float]] = (),
    ) -> None:
        self.line = line
        late_s, error_m = late_s or {}, error_m or {}
        #: Number of the stop, arrival, departure, stop error of each served stop.
        self.stays: list[tuple[int, float, float, float]] = [(0, 0.0, (line.stops[0].depart_s or 0.0), 0.0)]
        knots: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        for section in line.sections:
            place, _, departed_s, before_m = self.stays[-1]
            here, there = line.stops[section.departure], line.stops[section.arrival]
            assert place == section.departure
            target = target_of(section.target)
            time_s = np.arange(0.0, target.stop_time_s, 0.02)
            after_m = error_m.get(section.arrival, 0.0)
            length_m = there.position_m + after_m - here.position_m - before_m
            share = length_m / target.stop_position_m
            way_m = np.asarray(target.position_m(time_s)) * share
            knots.append(
                (departed_s + time_s, here.position_m + before_m + way_m, np.asarray(target.speed_mps(time_s)) * share)
            )
            arrived_s = departed_s + target.stop_time_s
            least_s = arrived_s + there.dwell_min_s
            due_s = arrived_s + 1e6 if there.depart_s is None else max(there.depart_s, least_s)
            self.stays.append((section.arrival, arrived_s, due_s + late_s.get(section.arrival, 0.0), after_m))
        self.end_s = self.stays[-1][1] + 10.0 if until_s is None else until_s
        self._time_s = np.concatenate([np.zeros(1), *(one[0] for one in knots), [self.stays[-1][1], self.end_s + 1e3]])
        last_m = line.stops[-1].position_m + self.stays[-1][3]
        self._place_m = np.concatenate([np.zeros(1), *(one[1] for one in knots), [last_m, last_m]])
        self._speed_mps = np.concatenate([np.zeros(1), *(one[2] for one in knots), [0.0, 0.0]])
        self._silent = silent
        self.trace = self._make_trace()

    def _make_trace(self) -> Trace:
        trace = Trace(self.line.installed_system.contract)
        end_ns = round(self.end_s * 1e9)
        for now_ns in range(0, end_ns + 1, _TRUTH_NS):
            now_s = now_ns / 1e9
            telegrams = [self._truth(now_s)]
            if now_ns % _FAST_NS == 0:
                telegrams += [self._doors(now_s), *self._protection(now_s)]
            if now_ns % _SLOW_NS == 0:
                telegrams.append(self._station(now_s))
            for telegram in telegrams:
                port = telegram.PORT
                if not any(name == port and from_s <= now_s < to_s for name, from_s, to_s in self._silent):
                    trace.add(port, now_ns, telegram.encode())
        trace.end_ns = end_ns
        return trace

    def _at(self, now_s: float) -> tuple[float, float]:
        speed_mps = float(np.interp(now_s, self._time_s, self._speed_mps))
        if any(arrived_s <= now_s <= departed_s for _, arrived_s, departed_s, _ in self.stays):
            speed_mps = 0.0
        return float(np.interp(now_s, self._time_s, self._place_m)), speed_mps

    def _truth(self, now_s: float) -> SimTruth:
        place_m, speed_mps = self._at(now_s)
        return SimTruth(position_01mm=round(place_m * 1e4), speed_01mmps=max(round(speed_mps * 1e4), 0))

    def _stay(self, now_s: float) -> tuple[int, float, float, float] | None:
        return next((stay for stay in self.stays if stay[1] <= now_s < stay[2]), None)

    def _doors(self, now_s: float) -> DoorStat:
        stay = self._stay(now_s)
        if stay is None or stay[0] == 0:
            return DoorStat()
        place, arrived_s, departed_s, _ = stay
        exchange_s = self.line.stops[place].dwell_min_s - _OPENING_S - _CLOSING_S - 2.0
        since_s, left_s = now_s - arrived_s, departed_s - now_s
        state = DoorState.OPEN
        if since_s < _OPENING_S:
            state = DoorState.OPENING
        elif left_s < _CLOSING_S:
            state = DoorState.CLOSING
        open_left_s = max(0.0, exchange_s - max(0.0, since_s - _OPENING_S))
        return DoorStat(left_state=state, psd_state=state, doors_locked=1, psd_locked=1, psd_present=1, in_window=2,
                        dwell_left_ds=round(open_left_s * 10))  # fmt: skip

    def _station(self, now_s: float) -> StnInfo:
        stay = self._stay(now_s)
        section = sum(departed_s <= now_s for _, _, departed_s, _ in self.stays)
        return StnInfo(station_here=0 if stay is None else stay[0] + 1, section=section)

    def _protection(self, now_s: float) -> tuple[AtpLim, AtpStat]:
        """Plausible, not exact: a square root before the next stop."""
        place_m, _ = self._at(now_s)
        served_m = [stop.position_m for stop in self.line.stops if stop.service != "pass"]
        ahead = [at_m for at_m in served_m if at_m > place_m - 5]
        left_m = max((ahead[0] if ahead else place_m) + 10.0 - place_m, 0.0)
        permitted = min(80 / 3.6, (1.3 * left_m) ** 0.5)
        ebi = min(85 / 3.6, (1.3 * (left_m + 25.0)) ** 0.5)
        half_m = 0.5 + 0.02 * (place_m % 600.0)
        return (
            AtpLim(permitted_4mmps=round(permitted * 250)),
            AtpStat(ebi_4mmps=round(ebi * 250), sbi_4mmps=round(ebi * 240), uncertainty_cm=round(half_m * 100)),
        )


def scored(run: ImaginedRun, missing: tuple[int, ...] = ()) -> Score:
    """The stops that the train has made, those of ``missing`` without a standstill."""
    made = {place: (arrived_s, departed_s, error_m) for place, arrived_s, departed_s, error_m in run.stays}
    stops = []
    for place, stop in enumerate(run.line.stops):
        planned = PlannedStop(
            stop.name, stop.position_m, stop.stop_error_max_m, stop.arrive_s, 5.0, departure_due_s=stop.depart_s
        )
        found = LineStop(planned, None)
        if place in made and place not in missing:
            arrived_s, departed_s, error_m = made[place]
            standstill = Standstill(arrived_s, stop.position_m + error_m) if place else None
            section = SectionFigures(
                number=max(1, sum(one.arrival <= place for one in run.line.sections)),
                planned_s=100.0, chosen_s=100.0, made_s=100.0, traction_kj=50_000.0 + 1000 * place,
                regenerated_kj=9_000.0, bound_kj=None, energy_share_percent=None,
                comfort_mps2_per_km=1.0, itae_kmh_s2=None, nearest_m=5.0, level="normal",
            )  # fmt: skip
            found = LineStop(planned, standstill, departed_s, section=section if place else None)
        stops.append(found)
    return Score(
        "PASS",
        {criterion.key: 1.0 for criterion in CRITERIA},
        {criterion.signed: 1.0 for criterion in CRITERIA if criterion.signed},
        (),
        "ended_complete",
        {extra.key: 0.0 for extra in EXTRAS},
        tuple(stops),
    )


def record(run: ImaginedRun, folder: Path, missing: tuple[int, ...] = (), label: str = "law") -> Record:
    trace = drawn_trace(run.line, run.trace)
    made = row_of(folder, {"controller": "ipfc_plus"}, run.line, trace, scored(run, missing))
    return made.copy_with(label=label, score=made.score, events=())
