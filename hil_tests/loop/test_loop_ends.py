"""A run always ends when something goes wrong, and with the right event."""

from __future__ import annotations

import dataclasses

import pytest

from railhil.bus.codes import EVENT_COPIES, Event
from railhil.bus.errors import PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent, PltIdent
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.telegrams import RunEvent
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.ato import dynamics
from railhil.plant_sim.ato.plant import PlantError
from railhil.plant_sim.handshake import Refused
from railhil.plant_sim.node import PlantNode, make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import CtlStat, NotchCmd

NOTCH_POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
STATUS_POLL = master_frame(CtlStat.port().f_code, CtlStat.port().address)


@pytest.fixture
def session(lvshun):
    return make_session(lvshun, lambda line: None, RunSpec())


def plant_with(lvshun, session, controller) -> PlantNode:
    return make_plant_node(lvshun, RunSpec(), LocalBus([controller, session.handle]))


def test_controller_that_never_answers_a_notch_ends_the_run_at_once(lvshun, session):
    """It passes the handshake and then is silent: the train never moves, so no stop is to be waited for."""
    node = ControllerNode(lvshun, LawSpec())

    def half_finished(frame: Frame) -> list[Frame]:
        return [] if frame in (NOTCH_POLL, STATUS_POLL) else node.handle(frame)

    plant = plant_with(lvshun, session, half_finished)
    with pytest.raises(PeerSilent, match="controller"):
        plant.run()
    assert session.ended is Event.ENDED_CONTROLLER_LOST
    assert plant.plant.tick < 10


@pytest.mark.parametrize("telegram", [PltIdent, CtlIdent])
def test_a_handshake_telegram_with_a_strange_role_is_counted_and_nothing_else(lvshun, session, telegram):
    """A stray one in the middle of a run, with every check sequence right."""
    plan = dataclasses.replace(lvshun.plan, running_time_s=0.16, overtime_max_s=0.0)
    scenario = dataclasses.replace(lvshun, plan=plan)
    node = ControllerNode(scenario, LawSpec())
    strays = iter([TelegramSource(telegram.port()).frames(telegram(role=role).encode()) for role in (3, 15)])

    def with_strays(frame: Frame) -> list[Frame]:
        if frame == NOTCH_POLL:
            for stray in next(strays, []):
                session.handle(stray)
        return node.handle(frame)

    assert plant_with(scenario, session, with_strays).run() is session.ended is Event.ENDED_NOT_STOPPED
    assert session.handshake.disagreements == []
    assert session.counters["wrong_role"] == 2


def test_a_controller_with_a_strange_role_is_refused(lvshun, session):
    node = ControllerNode(lvshun, LawSpec())
    node._ident.role = 9
    with pytest.raises(Refused, match=r"^CTL_IDENT has role 9, allowed 1$"):
        plant_with(lvshun, session, node.handle).run()
    assert session.ended is Event.ENDED_REFUSED


@pytest.mark.parametrize("kept", range(EVENT_COPIES))
def test_the_end_of_the_run_is_heard_when_one_repetition_arrives(lvshun, session, kept):
    plan = dataclasses.replace(lvshun.plan, running_time_s=0.16, overtime_max_s=0.0)
    scenario = dataclasses.replace(lvshun, plan=plan)
    node = ControllerNode(scenario, LawSpec())
    ends = iter(range(EVENT_COPIES))

    def disturbed(frame: Frame) -> list[Frame]:
        lost = frame.can_id == RunEvent.port().can_ids[-1] and next(ends) != kept
        return [] if lost else node.handle(frame)

    assert plant_with(scenario, session, disturbed).run() is node.ended is Event.ENDED_NOT_STOPPED


def test_stop_order_of_the_supervisor_ends_the_run_without_blaming_the_controller(lvshun):
    def changes_its_mind(sim_time_s: float) -> None:
        if sim_time_s > 0.3:
            session.handshake.disagreements.append("the supervisor has changed its mind")

    session = make_session(lvshun, lambda line: None, RunSpec(), on_progress=changes_its_mind)
    node = ControllerNode(lvshun, LawSpec())
    assert plant_with(lvshun, session, node.handle).run() is Event.ENDED_BY_SUPERVISOR
    assert session.ended is Event.ENDED_BY_SUPERVISOR
    assert node.ended is Event.ENDED_BY_SUPERVISOR


@pytest.mark.parametrize("rate", [0.0, 20.0])
@pytest.mark.parametrize(("running_time_s", "ticks"), [(0.15, [0, 16]), (0.16, [0, 16, 17]), (0.31, [0, 16, 32])])
def test_status_of_the_last_tick_is_always_asked_for_once(lvshun, running_time_s, ticks, rate):
    """CTL_STAT is due every 16 ticks; the run ends one tick after its time."""
    plan = dataclasses.replace(lvshun.plan, running_time_s=running_time_s, overtime_max_s=0.0)
    run = RunSpec(pace="realtime" if rate else "lockstep", rate=rate)
    scenario = dataclasses.replace(lvshun, plan=plan)
    session = make_session(scenario, lambda line: None, run)
    node = ControllerNode(scenario, LawSpec())
    asked, heard = [], []

    def listening(frame: Frame) -> list[Frame]:
        heard.append(frame)
        if frame == STATUS_POLL:
            asked.append(plant.plant.tick)
        return node.handle(frame)

    plant = make_plant_node(scenario, run, LocalBus([listening, session.handle]), reply_ns=10**10)
    assert plant.run() is session.ended is Event.ENDED_NOT_STOPPED
    assert asked == ticks
    last_event = max(i for i, frame in enumerate(heard) if frame.can_id == RunEvent.port().can_ids[0])
    assert STATUS_POLL not in heard[last_event:]


@pytest.mark.parametrize(("damaged", "polls"), [(0, 1), (1, 2), (2, 3), (3, 3)])
def test_last_status_is_asked_for_again_when_its_answer_is_damaged(lvshun, session, damaged, polls):
    plan = dataclasses.replace(lvshun.plan, running_time_s=0.16, overtime_max_s=0.0)
    scenario = dataclasses.replace(lvshun, plan=plan)
    node = ControllerNode(scenario, LawSpec())
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
    node = ControllerNode(scenario, LawSpec())

    def dying(frame: Frame) -> list[Frame]:
        return [] if frame == STATUS_POLL and plant.plant.tick == 17 else node.handle(frame)

    plant = plant_with(scenario, session, dying)
    with pytest.raises(PeerSilent, match=r"controller \(CTL_STAT\)"):
        plant.run()
    assert session.ended is Event.ENDED_CONTROLLER_LOST


def test_plant_that_fails_says_so_on_the_bus(lvshun, session, monkeypatch):
    whole = dynamics.step
    calls = {"steps": 0}

    def broken(*arguments):
        calls["steps"] += 1
        step = whole(*arguments)
        if calls["steps"] < 3000:
            return step
        return step._replace(motion=step.motion._replace(position_m=float("nan")))

    monkeypatch.setattr(dynamics, "step", broken)
    node = ControllerNode(lvshun, LawSpec())
    plant = plant_with(lvshun, session, node.handle)
    with pytest.raises(PlantError, match="not finite"):
        plant.run()
    assert session.ended is Event.ENDED_PLANT_ERROR
