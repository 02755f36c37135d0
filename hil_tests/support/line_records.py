"""Records of runs over the four-stop line: telegrams of its plant, driven without a controller, and changed ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

from hil_tests.support.lines import STOPS, Driver, four_stops
from railhil.bus.codes import EVENT_COPIES, EVENT_SPACING_NS, Event
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent
from railhil.dbc import Contract
from railhil.plant_sim.line.train import LineTrain
from railhil.record.trace import Trace
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.line import AtoStat

#: Ports that the score reads.
JUDGED = ("SIM_TRUTH", "RUN_EVENT", "DOOR_STAT", "STN_INFO", "ATP_LIM", "ATP_STAT", "ATO_STAT", "PLT_STAT")


class Told(NamedTuple):
    """A telegram of a record."""

    time_ns: int
    port: str
    data: bytes


@cache
def driven_run(*, short: bool = False) -> tuple[LineScenario, tuple[Told, ...]]:
    """A run in which everything is in order, and the scenario with the timetable that it keeps.

    :param short: a line of 300 m, for tests that score many records.
    """
    scale = 0.1 if short else 1.0
    places_m = [stop.position_m * scale for stop in STOPS]
    depart_s, end_s = (80.0, 200.0) if short else (260.0, 600.0)
    stops = [replace(stop, position_m=place_m) for stop, place_m in zip(STOPS, places_m, strict=True)]
    stops[1] = replace(stops[1], arrive_s=depart_s - 30.0, depart_s=depart_s)
    stops[3] = replace(stops[3], arrive_s=end_s)
    line = four_stops(stops=tuple(stops))
    told, arrivals_s = drive(line)
    for place, arrived_s in zip((1, 3), arrivals_s, strict=True):
        stops[place] = replace(stops[place], arrive_s=float(round(arrived_s)))
    sections = tuple(
        replace(one, running_time_s=(stops[one.arrival].arrive_s or 0.0) - (stops[one.departure].depart_s or 0.0))
        for one in line.sections
    )
    return replace(line, stops=tuple(stops), sections=sections), told


def drive(
    line: LineScenario, act: Callable[[Driver], object] = lambda _: None, until: Callable[[Driver], bool] | None = None
) -> tuple[tuple[Told, ...], list[float]]:
    """The telegrams of a run to its end, and its arrivals in s.

    :param act: called before each tick.
    :param until: the run is ended when this is true; None: at its own end.
    """
    train = LineTrain(line, 1)
    driver = Driver(train, line)
    contract: Contract = line.installed_system.contract
    schedule = Schedule.from_contract(line.timing.base_tick_ns, line.timing.port_period_ns, contract)
    told: list[Told] = []
    number, seen, arrivals_s = 0, 0, list[float]()
    own = line.installed_system.events
    life = 0
    ended = None
    while ended is None:
        now_ns = train.tick * line.timing.base_tick_ns
        for port, make in train.makers.items():
            if train.tick % schedule.ticks(port) == 0 and (made := make()) is not None:
                told.append(Told(now_ns, port, made.encode()))
        if train.tick % schedule.ticks(AtoStat.PORT) == 0 and train.journey.section >= 0:
            running_s = line.sections[train.journey.section].running_time_s
            status = AtoStat(section=train.journey.section + 1, running_time_ds=round(running_s * 10), life=life % 16)
            told.append(Told(now_ns, AtoStat.PORT, status.encode()))
            life += 1
        ended = train.ending.reached(train.tick, False)
        if until is not None and until(driver):
            ended = Event.ENDED_NOT_STOPPED
        if ended is not None:
            break
        act(driver)
        driver.tick()
        for event in driver.events[seen:]:
            code = own.get(event.kind) or getattr(Event, event.kind.upper(), None)
            if event.kind == "arrived":
                arrivals_s.append(event.instant_01ms / 1e4)
            if code is not None:
                number += 1
                milestone = RunEvent(code, number, event.instant_01ms, event.position_01mm)
                told += _copies(train.tick * line.timing.base_tick_ns, milestone)
        seen = len(driver.events)
    last = RunEvent(ended, number + 1, train.tick * line.timing.base_tick_ns // 100_000, train.position_01mm)
    told += [one._replace(time_ns=train.tick * line.timing.base_tick_ns) for one in _copies(0, last)]
    judged = (one for one in told if one.port in JUDGED)
    return tuple(sorted(judged, key=lambda one: one.time_ns)), arrivals_s


def _copies(time_ns: int, milestone: RunEvent) -> list[Told]:
    data = milestone.encode()
    return [Told(time_ns + copy * EVENT_SPACING_NS, RunEvent.PORT, data) for copy in range(EVENT_COPIES)]


def trace_of(line: LineScenario, told: Iterable[Told]) -> Trace:
    """The record with these telegrams."""
    trace = Trace(line.installed_system.contract)
    for one in told:
        trace.add(one.port, one.time_ns, one.data)
        trace.end_ns = max(trace.end_ns, one.time_ns)
    return trace


def milestones_in(told: Sequence[Told], kind: str, line: LineScenario) -> list[int]:
    """The numbers of the milestones of a kind in a record."""
    code = line.installed_system.events.get(kind) or Event[kind.upper()].value
    found = [RunEvent.decode(one.data) for one in told if one.port == RunEvent.PORT]
    return sorted({one.number for one in found if one.event == code})
