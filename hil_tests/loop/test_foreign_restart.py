"""A controller that begins in a run under way, as after its restart: the exported C answers as the Python node."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import pytest

from hil_tests.support.driven import short
from hil_tests.support.foreign import (
    CNode,
    without_telemetry,
)
from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.node import make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.canonical import scenario_sha256
from railhil.systems.ato.scenario.model import Safety, Scenario
from railhil.wire.ato import CtlCause, CtlMode, NotchCmd, TrnSpeed

pytestmark = pytest.mark.needs_compiler


def late_run(
    scenario: Scenario, c: CNode, law: str, at_s: float, hears: Callable[[Frame, float], bool] = lambda *_: True
) -> list[NotchCmd]:
    """Answers of a controller that takes over at an instant of a run, its clock at 0; those of the C are equal.

    :param hears: whether it gets a frame, so many seconds after that instant.
    """
    spec = RunSpec(law=LawSpec(law))
    session = make_session(scenario, lambda line: None, spec)
    first, late = ControllerNode(scenario, spec.law), ControllerNode(scenario, spec.law)
    ticks, told = 0, []

    def node(frame: Frame) -> list[Frame]:
        nonlocal ticks
        ticks += frame.can_id == TrnSpeed.port().address
        if ticks * scenario.timing.base_tick_ns < at_s * 1e9:
            return first.handle(frame)
        if not hears(frame, ticks * scenario.timing.base_tick_ns / 1e9 - at_s):
            return []
        answer = late.handle(frame)
        assert without_telemetry(c.handle(frame)) == without_telemetry(answer), f"{frame} in tick {ticks}"
        if answer and answer[0].can_id == NotchCmd.port().address:
            told.append(NotchCmd.decode(answer[0].data[:4]))
        return answer

    make_plant_node(scenario, spec, LocalBus([node, session.handle])).run()
    counters = {cause: count for cause, count in late.counters.items() if cause in c.counters}
    assert counters == c.counters
    assert c.counters["time_ahead"] == 1
    return told


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "deaf_s"),
    [("ipfc", 0.1), ("ipfc_plus", 0.5), pytest.param("ipfc", 1.6, marks=pytest.mark.long)],
)
def test_a_controller_that_restarts_in_motion_and_hears_no_speed_brakes(exported, law: str, deaf_s: float) -> None:
    """The ladder of the age, from SERVICE BRAKE on, by its own time; speeds end the service brake."""
    scenario = short()
    watch = scenario.watch
    clock_id = TrnSpeed.port().address
    told = late_run(
        scenario, CNode(exported(scenario, law), law), law, 3.0,
        lambda frame, since_s: frame.can_id != clock_id or since_s >= deaf_s,
    )  # fmt: skip
    silent = [telegram for place, telegram in enumerate(told) if 0.02 * place < deaf_s - 1e-9]
    modes = [telegram.mode for telegram in silent]
    assert modes == [
        CtlMode.EMERGENCY
        if age_ms > watch.emergency_ms
        else CtlMode.SERVICE_BRAKE
        if age_ms > watch.service_brake_ms
        else CtlMode.INITIALISING
        for age_ms in range(0, 20 * len(silent), 20)
    ]
    causes = [CtlCause.NONE if mode == CtlMode.INITIALISING else CtlCause.SPEED_AGE for mode in modes]
    assert [telegram.cause for telegram in silent] == causes
    notches = [telegram.notch_256th for telegram in silent]
    assert notches == sorted(notches, reverse=True)
    assert [notch < 0 for notch in notches] == [mode != CtlMode.INITIALISING for mode in modes]
    # It knows the time only after 1.28 to 2.56 s: until then it brakes because of that.
    later = [telegram.mode for telegram in told[len(silent) :]]
    if deaf_s * 1000 > watch.emergency_ms:
        assert set(later) == {CtlMode.EMERGENCY}
    else:
        assert later[0] == CtlMode.SERVICE_BRAKE
        assert later[-1] == CtlMode.RUNNING
        assert CtlMode.INITIALISING not in later
        assert CtlMode.EMERGENCY not in later


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "safe", "at_s"),
    [
        ("ipfc_plus", False, 3.0),
        ("ipfc", True, 3.0),
        pytest.param("ipfc", False, 3.0, marks=pytest.mark.long),
        pytest.param("ipfc", False, 3.39, marks=pytest.mark.long),
    ],
)
def test_a_controller_that_restarts_in_motion_brakes_until_it_knows_the_time(
    exported, law: str, safe: bool, at_s: float
) -> None:
    scenario = dataclasses.replace(short(), safety=Safety(sdt=safe))
    scenario = dataclasses.replace(scenario, sha256=scenario_sha256(scenario))
    told = late_run(scenario, CNode(exported(scenario, law), law), law, at_s)
    modes = [telegram.mode for telegram in told]
    begun = modes.index(CtlMode.RUNNING)
    # Two periods of TIME_SYNC at most, and ten good speeds.
    assert set(modes[:begun]) == {CtlMode.SERVICE_BRAKE}
    assert {telegram.cause for telegram in told[:begun]} == {CtlCause.CLOCK}
    assert 1.28 < begun * 0.02 < 2.56 + 0.14
    assert max(telegram.notch_256th for telegram in told[:begun]) <= 0
    assert min(telegram.notch_256th for telegram in told[:begun]) < -256
    assert set(modes[begun:]) == {CtlMode.RUNNING}


def test_a_controller_that_restarts_at_a_standstill_waits_for_the_time(exported) -> None:
    """Without the time its law would depart again."""
    scenario = short()
    c, node = CNode(exported(scenario), "ipfc"), ControllerNode(scenario, LawSpec("ipfc"))
    poll = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
    for tick in range(10_000, 10_060):
        (frame,) = TelegramSource(TrnSpeed.port()).frames(TrnSpeed(0, life=tick & 0xF).encode())
        assert c.handle(frame) == node.handle(frame) == []
        (answer,) = node.handle(poll)
        assert c.handle(poll) == [answer]
        told = NotchCmd.decode(answer.data[:4])
        assert (told.mode, told.notch_256th) == (CtlMode.INITIALISING, 0)
