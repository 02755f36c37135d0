"""How a run ends when something is not as it should be: always, and with the right event."""

from __future__ import annotations

import numpy as np
import pytest

from bus import administrator as administrator_module
from bus.errors import PeerSilent
from bus.frame import Frame
from bus.local import LocalBus
from bus.mvb import master_frame
from bus.telegrams import CtlStat, Event, NotchCmd, RunEvent, SimTruth, SupCmd, SupCommand
from controller_node.node import ControllerNode, ControllerOptions
from plant_sim import dynamics
from plant_sim.node import PlantNode, PlantOptions
from plant_sim.plant import PlantError
from supervisor.score import score
from supervisor.session import Session
from supervisor.trace import Trace

NOTCH_POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
STATUS_POLL = master_frame(CtlStat.port().f_code, CtlStat.port().address)


@pytest.fixture
def session(lvshun):
    return Session(
        lvshun, lambda line: None, seed=0, perturbed=False, controller="ipfc", arithmetic="iq", indexing="time"
    )


def plant_with(lvshun, session, controller) -> PlantNode:
    return PlantNode(lvshun, PlantOptions(), LocalBus([controller, session.handle]))


def test_controller_that_never_answers_a_notch_ends_the_run_at_once(lvshun, session, monkeypatch):
    """It passes the handshake and then is silent: the train never moves, so no stop is to be waited for."""
    monkeypatch.setattr(administrator_module, "WATCHDOG_NS", 1)
    node = ControllerNode(lvshun, ControllerOptions())

    def half_finished(frame: Frame) -> list[Frame]:
        return [] if frame in (NOTCH_POLL, STATUS_POLL) else node.handle(frame)

    plant = plant_with(lvshun, session, half_finished)
    plant.administrator._watchdog_ns = 1_000_000
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
