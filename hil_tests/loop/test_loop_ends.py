"""How a run ends when something is not as it should be: always, and with the right event."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from railhil.bus.errors import PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.bus.mvb import master_frame
from railhil.bus.telegrams import CtlStat, Event, NotchCmd, RunEvent, SimTruth, SupCmd, SupCommand
from railhil.controller_node.node import ControllerNode, ControllerOptions
from railhil.plant_sim import dynamics
from railhil.plant_sim.node import PlantNode, PlantOptions
from railhil.plant_sim.plant import PlantError
from railhil.supervisor.score import score
from railhil.supervisor.session import Session
from railhil.supervisor.trace import Trace

NOTCH_POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
STATUS_POLL = master_frame(CtlStat.port().f_code, CtlStat.port().address)


@pytest.fixture
def session(lvshun):
    return Session(
        lvshun, lambda line: None, seed=0, perturbed=False, controller="ipfc", arithmetic="iq", indexing="time"
    )


def plant_with(lvshun, session, controller) -> PlantNode:
    return PlantNode(lvshun, PlantOptions(), LocalBus([controller, session.handle]))


def test_controller_that_never_answers_a_notch_ends_the_run_at_once(lvshun, session):
    """It passes the handshake and then is silent: the train never moves, so no stop is to be waited for."""
    node = ControllerNode(lvshun, ControllerOptions())

    def half_finished(frame: Frame) -> list[Frame]:
        return [] if frame in (NOTCH_POLL, STATUS_POLL) else node.handle(frame)

    plant = plant_with(lvshun, session, half_finished)
    with pytest.raises(PeerSilent, match="controller"):
        plant.run()
    assert session.ended is Event.ENDED_CONTROLLER_LOST
    assert plant.plant.tick < 10


def test_stop_order_of_the_supervisor_ends_the_run_without_blaming_the_controller(lvshun, session):
    node = ControllerNode(lvshun, ControllerOptions())
    orders = {"polls": 0}
    command = session._command

    def stopping() -> SupCmd:
        orders["polls"] += 1
        answer = command()
        if orders["polls"] > 3:
            answer.command = SupCommand.STOP
        return answer

    word = SupCmd.port().f_code << 12 | SupCmd.port().address
    source, _ = session._responder._answers[word]
    session._responder._answers[word] = (source, stopping)
    assert plant_with(lvshun, session, node.handle).run() is Event.ENDED_BY_SUPERVISOR
    assert session.ended is Event.ENDED_BY_SUPERVISOR
    assert node.ended is Event.ENDED_BY_SUPERVISOR


@pytest.mark.parametrize("rate", [0.0, 20.0])
@pytest.mark.parametrize(("running_time_s", "ticks"), [(0.15, [0, 16]), (0.16, [0, 16, 17]), (0.31, [0, 16, 32])])
def test_status_of_the_last_tick_is_always_asked_for_once(lvshun, running_time_s, ticks, rate):
    """CTL_STAT is due every 16 ticks; the run ends one tick after its time."""
    plan = dataclasses.replace(lvshun.plan, running_time_s=running_time_s, overtime_max_s=0.0)
    pace = "realtime" if rate else "lockstep"
    given = {"controller": "ipfc", "arithmetic": "iq", "indexing": "time", "pace": pace}
    scenario = dataclasses.replace(lvshun, plan=plan)
    session = Session(scenario, lambda line: None, seed=0, perturbed=False, **given)
    node = ControllerNode(scenario, ControllerOptions())
    asked, heard = [], []

    def listening(frame: Frame) -> list[Frame]:
        heard.append(frame)
        if frame == STATUS_POLL:
            asked.append(plant.plant.tick)
        return node.handle(frame)

    plant = PlantNode(scenario, PlantOptions(rate=rate), LocalBus([listening, session.handle]))
    plant.administrator._reply_ns = 10**10
    assert plant.run() is session.ended is Event.ENDED_NOT_STOPPED
    assert asked == ticks
    last_event = max(i for i, frame in enumerate(heard) if frame.can_id == RunEvent.port().can_ids[0])
    assert STATUS_POLL not in heard[last_event:]


@pytest.mark.parametrize(("damaged", "polls"), [(0, 1), (1, 2), (2, 3), (3, 3)])
def test_last_status_is_asked_for_again_when_its_answer_is_damaged(lvshun, session, damaged, polls):
    plan = dataclasses.replace(lvshun.plan, running_time_s=0.16, overtime_max_s=0.0)
    scenario = dataclasses.replace(lvshun, plan=plan)
    node = ControllerNode(scenario, ControllerOptions())
    asked = []

    def disturbed(frame: Frame) -> list[Frame]:
        answers = node.handle(frame)
        if frame == STATUS_POLL:
            asked.append(plant.plant.tick)
            if 0 < asked.count(17) <= damaged:
                return [item._replace(data=bytes([item.data[0] ^ 1]) + item.data[1:]) for item in answers]
        return answers

    plant = plant_with(scenario, session, disturbed)
    assert plant.run() is Event.ENDED_NOT_STOPPED
    assert asked.count(17) == polls


def test_controller_that_dies_before_its_last_status_is_lost(lvshun, session):
    """The train has run to its end, but nobody knows what the controller would have said."""
    plan = dataclasses.replace(lvshun.plan, running_time_s=0.16, overtime_max_s=0.0)
    scenario = dataclasses.replace(lvshun, plan=plan)
    node = ControllerNode(scenario, ControllerOptions())

    def dying(frame: Frame) -> list[Frame]:
        return [] if frame == STATUS_POLL and plant.plant.tick == 17 else node.handle(frame)

    plant = plant_with(scenario, session, dying)
    with pytest.raises(PeerSilent, match=r"controller \(CTL_STAT\)"):
        plant.run()
    assert session.ended is Event.ENDED_CONTROLLER_LOST


def test_plant_that_fails_says_so_on_the_bus(lvshun, session, monkeypatch):
    node = ControllerNode(lvshun, ControllerOptions())
    plant = plant_with(lvshun, session, node.handle)
    whole = dynamics.step
    calls = {"steps": 0}

    def broken(*arguments):
        calls["steps"] += 1
        step = whole(*arguments)
        if calls["steps"] < 3000:
            return step
        return step._replace(motion=step.motion._replace(position_m=float("nan")))

    monkeypatch.setattr(dynamics, "step", broken)
    with pytest.raises(PlantError, match="not finite"):
        plant.run()
    assert session.ended is Event.ENDED_PLANT_ERROR


def test_score_survives_repeated_telegrams_and_unknown_events(lvshun):
    trace = Trace()
    for tick in range(0, 19700, 2):
        speed = 0 if tick > 19500 else 150_000
        for _ in range(2 if tick in (0, 400) else 1):
            trace.add(SimTruth.PORT, tick * 10_000_000, SimTruth(tick * 1000, speed).encode())
    unknown = bytearray(RunEvent(0, 0, 0).encode())
    unknown[0] |= 0xF0
    trace.add(RunEvent.PORT, 0, bytes(unknown))
    trace.add(RunEvent.PORT, 0, RunEvent(Event.STOPPED, 1_950_000, 29_400_000).encode())
    trace.add(RunEvent.PORT, 0, RunEvent(Event.ENDED_COMPLETE, 0, 0).encode())
    found = score(lvshun, trace)
    assert found.verdict == "PASS"
    assert np.isfinite([found.itae, found.energy_kj, found.comfort]).all()


@pytest.mark.parametrize(("lost_ticks", "verdict"), [(98, "FAIL"), (100, "INVALID")])
def test_a_record_with_a_hole_is_no_run(lvshun, lost_ticks, verdict):
    """What the train did meanwhile, too fast perhaps, is not in it; a bus that fails for a moment is no reason."""
    trace = Trace()
    for tick in range(0, 1000, 2):
        if not 500 < tick <= 500 + lost_ticks:
            trace.add(SimTruth.PORT, tick * 10_000_000, SimTruth(tick * 1000, 100).encode())
    trace.add(RunEvent.PORT, 9_980_000_000, RunEvent(Event.ENDED_NOT_STOPPED, 99_800, 0).encode())
    found = score(lvshun, trace)
    assert found.verdict == verdict
    if verdict == "INVALID":
        assert found.failures == ("record: no SIM_TRUTH for 1.02 s from 5.00 s on, allowed 1 s",)
        assert found.overspeed_mps == 0.0
        assert found.itae is None
