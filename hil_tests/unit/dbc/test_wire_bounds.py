"""Runs of 400 km and 8 h fit the wire format: every telegram at the limits of a scenario, and beyond."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from railhil.bus.clock import to_time_sync
from railhil.bus.codes import Event
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource
from railhil.bus.store import TrafficStore
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.dbc import wire_contract
from railhil.plant_sim.ato.dynamics import Motion
from railhil.plant_sim.ato.plant import Plant
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.record.trace import Trace
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.schema import RUNNING_TIME_MAX_S
from railhil.systems.ato.scenario.model import DISTANCE_MAX_M, Scenario
from railhil.systems.ato.scenario.schema import PlanTable
from railhil.wire.ato import BalisePassed, CtlStat, SimTruth, TrkInfo, TrnPos

#: Over the stopping point by this, and as much later; the plant goes on for some minutes after the timetable.
_OVER_M, _OVER_S = 20_000.0, 1200.0


def over_the_wire(telegram: Telegram) -> Telegram:
    """The telegram through blocks, check sequences and traffic store."""
    port = type(telegram).port()
    store = TrafficStore([port])
    for frame in TelegramSource(port).frames(telegram.encode()):
        store.feed(frame, 0)
    found, _ = store.read(type(telegram), 0)
    assert found is not None
    return found


@pytest.fixture
def longest(lvshun: Scenario) -> Scenario:
    plan = replace(lvshun.plan, distance_m=DISTANCE_MAX_M, running_time_s=RUNNING_TIME_MAX_S, overtime_max_s=600.0)
    limits = (*lvshun.line.speed_limit_mps, (DISTANCE_MAX_M, 350 / 3.6))
    sensors = replace(lvshun.sensors, wheel_factor=1.01)
    return replace(lvshun, plan=plan, line=replace(lvshun.line, speed_limit_mps=limits), sensors=sensors)


@pytest.mark.parametrize("position_m", [0.0, 214_748.4, DISTANCE_MAX_M, DISTANCE_MAX_M + _OVER_M])
def test_every_periodic_telegram_of_the_plant_at_the_far_end(longest: Scenario, position_m: float) -> None:
    plant = Plant(longest, 0)
    plant.tick = round((RUNNING_TIME_MAX_S + _OVER_S) * 100)
    plant._motion = Motion(position_m, 100.0, -1e5, -1.0)
    makers = TrainTelegrams(longest, plant, 0.0).makers
    made = {port: make() for port, make in makers.items()}
    found = {port: over_the_wire(telegram) for port, telegram in made.items() if telegram is not None}
    assert found == {port: telegram for port, telegram in made.items() if telegram is not None}
    truth, track, place, clock = (found[cls.PORT] for cls in (SimTruth, TrkInfo, TrnPos, TimeSync))
    assert isinstance(truth, SimTruth)
    assert isinstance(track, TrkInfo)
    assert isinstance(place, TrnPos)
    assert isinstance(clock, TimeSync)
    assert truth.position_01mm == round(position_m * 1e4)
    assert track.target_mm == DISTANCE_MAX_M * 1000
    assert track.target_time_ds == RUNNING_TIME_MAX_S * 10
    # Farther than 65 km away stands as 65535 m.
    assert track.next_limit_distance_m == (0xFFFF if position_m < 300_000 else 0)
    assert place.odometer_mm == pytest.approx(1.01 * position_m * 1000, abs=6)
    assert clock.seconds_s == RUNNING_TIME_MAX_S + _OVER_S


def test_milestones_and_balises_at_the_far_end() -> None:
    instant, place = round((RUNNING_TIME_MAX_S + _OVER_S) * 1e4), round((DISTANCE_MAX_M + _OVER_M) * 1e4)
    for telegram in (
        RunEvent(Event.STOPPED, 65_535, instant, place),
        BalisePassed(255, round((DISTANCE_MAX_M + _OVER_M) * 1000), 65_535),
        to_time_sync(instant // 100, 10_000_000, rate_10th=255, state=3, life=15),
        CtlStat(step_count=round(RUNNING_TIME_MAX_S / 0.2) & 0xFFFF),
    ):
        assert over_the_wire(telegram) == telegram


def test_the_record_reads_what_was_sent() -> None:
    """Also what needs more than 32 bits, and what is below 0."""
    trace = Trace(wire_contract())
    truths = [(0, 0), (2**31, 1_000_000), (4_200_000_000, -1), (-5, 0), (2**33 - 1, 2**23 - 1), (-(2**33), -(2**23))]
    for position, speed in truths:
        trace.add(SimTruth.PORT, 0, SimTruth(position, speed).encode())
        trace.add(RunEvent.PORT, 0, RunEvent(2, 7, abs(position) % 2**32, position).encode())
    assert trace.raw(SimTruth.PORT, "TruePos").tolist() == [position for position, _ in truths]
    assert trace.raw(SimTruth.PORT, "TrueSpeed").tolist() == [speed for _, speed in truths]
    assert trace.raw(RunEvent.PORT, "EventPos").tolist() == [position for position, _ in truths]
    assert np.all(trace.raw(RunEvent.PORT, "EventNumber") == 7)


def test_every_signal_has_room_for_what_a_scenario_may_ask() -> None:
    """What the schema allows, held against the port table, with room for a run that goes wrong."""
    assert PlanTable(
        distance_m=DISTANCE_MAX_M, running_time_s=RUNNING_TIME_MAX_S, stop_error_max_m=1, time_error_max_s=1
    )
    far_m, late_s = DISTANCE_MAX_M + _OVER_M, RUNNING_TIME_MAX_S + _OVER_S
    needed = {
        ("SIM_TRUTH", "TruePos"): far_m,
        ("RUN_EVENT", "EventPos"): far_m,
        ("RUN_EVENT", "EventTime"): late_s,
        ("TRN_POS", "TrainPos"): 2 * far_m,
        ("BALISE", "BalisePos"): far_m,
        ("TRK_INFO", "TargetPos"): DISTANCE_MAX_M,
        ("TRK_INFO", "TargetTime"): RUNNING_TIME_MAX_S,
        ("TIME_SYNC", "TimeSeconds"): late_s,
    }
    for (port, name), value in needed.items():
        cls = next(cls for cls in (SimTruth, RunEvent, TrnPos, BalisePassed, TrkInfo, TimeSync) if port == cls.PORT)
        entry = next(item for item in cls.port().signals if item.name == name)
        assert entry.raw_range[1] * entry.scale >= value, (port, name)


@pytest.mark.parametrize(("law", "indexing"), [("ipfc", "distance"), ("ipfc_plus", "time")])
def test_a_law_that_uses_the_position_is_refused_beyond_what_it_is_given(
    longest: Scenario, law: str, indexing: str
) -> None:
    with pytest.raises(InputError) as caught:
        ControlLoop(longest, LawSpec(law, indexing=indexing), make("iq"))
    text = str(caught.value)
    assert text.startswith("lvshun_tieshan: plan.distance_m: found 400000.0, allowed at most 198020 m for ")
    # Its wheels are drawn up to 1.01: 200 km by the odometer.
    if law == "ipfc":
        # IPFC+ has a limit of its own.
        assert ControlLoop(
            replace(longest, plan=replace(longest.plan, distance_m=198_000.0)),
            LawSpec(law, indexing=indexing),
            make("iq"),
        )
