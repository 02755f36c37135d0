"""Nothing arrives for a while, and no interface says so: both controllers see how old the speed was."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from hil_tests.support.foreign import CNode, export_node, without_telemetry
from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource, master_frame, parse_master_frame
from railhil.bus.telegrams import TimeSync
from railhil.controller_node.ato.node import ControllerNode
from railhil.dbc import wire_contract
from railhil.plant_sim.node import make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.canonical import scenario_sha256
from railhil.systems.ato.scenario.model import Scenario, TargetCurve
from railhil.systems.ato.scenario.target import Target
from railhil.wire.ato import CtlCause, CtlMode, CtlStat, NotchCmd, TrkInfo, TrnPos, TrnSpeed, WatchLevel

pytestmark = pytest.mark.needs_compiler

_CURVE = TargetCurve(((0.0, 0.0), (1.0, 1.0), (5.0, 1.0), (6.0, 0.0), (7.0, 0.0), (8.0, -1.0)))


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    whole, target = load("lvshun_tieshan"), Target(_CURVE)
    plan = dataclasses.replace(whole.plan, distance_m=target.stop_position_m, running_time_s=target.stop_time_s)
    return dataclasses.replace(whole, target=_CURVE, plan=plan)


@pytest.fixture(scope="module")
def exported(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export")
    export_node(scenario, folder, law="ipfc_plus")
    return folder


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("ticks", "level"),
    [
        (12, CtlMode.TRACTION_CUT),
        (16, CtlMode.TRACTION_CUT),
        (20, CtlMode.TRACTION_CUT),
        (31, CtlMode.SERVICE_BRAKE),
        (110, CtlMode.EMERGENCY),
    ],
)
def test_the_age_of_the_speed_is_seen_after_a_silence(
    scenario: Scenario, exported: Path, ticks: int, level: CtlMode
) -> None:
    """Also where the life sign of TRN_SPEED goes on as if nothing had happened (16); never because of the position."""
    spec = RunSpec(law=LawSpec("ipfc_plus"))
    node, c = ControllerNode(scenario, spec.law), CNode(exported, "ipfc_plus")
    session = make_session(scenario, print, spec)
    tick, told = -1, list[NotchCmd]()

    def both(frame: Frame) -> list[Frame]:
        nonlocal tick
        tick += frame.can_id == TrnSpeed.port().address
        if 330 <= tick < 330 + ticks:
            # "No answer": in lockstep the bus administrator waits for every poll of the controller.
            asked = parse_master_frame(frame.data) if frame.can_id == wire_contract().poll_id else None
            polled = [kind.port() for kind in (NotchCmd, CtlStat) if asked and asked[1] == kind.port().address]
            return [Frame(port.can_ids[-1], b"") for port in polled]
        answer = node.handle(frame)
        assert without_telemetry(c.handle(frame)) == without_telemetry(answer), tick
        if answer and answer[0].can_id == NotchCmd.port().address:
            told.append(NotchCmd.decode(answer[0].data[:4]))
        return answer

    make_plant_node(scenario, spec, LocalBus([both, session.handle])).run()
    causes = {one.cause for one in told}
    assert CtlCause.SPEED_AGE in causes
    assert not causes & {CtlCause.POSITION_IMPLAUSIBLE, CtlCause.POSITION_LOST}
    assert max(one.mode for one in told) == level
    assert node.ended is not None


class Twins:
    """Both controllers at 1 m/s: a speed in each tick, position and poll in every other."""

    def __init__(self, scenario: Scenario, folder: Path, law: str) -> None:
        self.node, self.c = ControllerNode(scenario, LawSpec(law)), CNode(folder, law)
        self._tick_ns = scenario.timing.base_tick_ns
        self._speed, self._position = TelegramSource(TrnSpeed.port()), TelegramSource(TrnPos.port())
        self._poll = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)

    def go(self, ticks: range, off_mm: int | None = 0) -> set[WatchLevel]:
        """Levels passed; ``off_mm``: what the odometer is off by, None for no telegram."""
        levels = set()
        for tick in ticks:
            # The reading changes, as that of any train.
            self._take(self._speed.frames(TrnSpeed(10_000 + tick % 2, life=tick & 0xF).encode()))
            if tick % 16 == 0:
                self._take(
                    TelegramSource(TrkInfo.port()).frames(
                        TrkInfo(speed_limit_4mmps=60_000, life=tick // 16 % 4).encode()
                    )
                )
            if tick == 0:
                self._take(TelegramSource(TimeSync.port()).frames(TimeSync().encode()))
            if tick % 2 == 0:
                if off_mm is not None:
                    told = TrnPos(tick * self._tick_ns // 1_000_000 + off_mm, life=tick // 2 & 0xF)
                    self._take(self._position.frames(told.encode()))
                self._take([self._poll])
            levels.add(self.node.guard.level)
        return levels

    def _take(self, frames: list[Frame]) -> None:
        for frame in frames:
            assert without_telemetry(self.c.handle(frame)) == without_telemetry(self.node.handle(frame)), frame
            assert self.c.level == self.node.guard.level

    def poll(self) -> None:
        self._take([self._poll])

    def wait(self, step_ms: int) -> None:
        """Nothing arrives, and their own timers run."""
        self.c.was_stopped(step_ms * 1_000_000)
        self.node.was_stopped(step_ms * 1_000_000)
        assert self.c.level == self.node.guard.level


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("silent_ms", "level"),
    [
        (20, WatchLevel.NORMAL),
        (25, WatchLevel.NORMAL),
        (65, WatchLevel.HOLD),
        (300, WatchLevel.SERVICE_BRAKE),
        (1001, WatchLevel.SERVICE_BRAKE),
        (1015, WatchLevel.EMERGENCY),
    ],
)
def test_a_timer_of_its_own_tells_the_time_that_passes(
    scenario: Scenario, exported: Path, silent_ms: int, level: WatchLevel
) -> None:
    """In steps of 5 ms, less than a tick; the frames after it are those of the right ticks."""
    twins = Twins(scenario, exported, "ipfc_plus")
    assert twins.go(range(100)) == {WatchLevel.NORMAL}
    for _ in range(0, silent_ms, 5):
        twins.wait(5)
    assert twins.node.guard.level is level
    after = 100 + silent_ms // 10
    twins.go(range(after, after + 200))
    assert twins.node.responder.clock.tick == after + 199


@pytest.fixture(scope="module")
def without_position(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export")
    export_node(scenario, folder, law="ipfc")
    return folder


@pytest.mark.slow
def test_a_law_without_a_position_brakes_for_positions_that_are_wrong_and_never_for_none(
    scenario: Scenario, without_position: Path
) -> None:
    """A single wrong one and then none for 3 s, and again; then wrong ones for more than a second."""
    twins = Twins(scenario, without_position, "ipfc")
    assert twins.go(range(100)) == {WatchLevel.NORMAL}
    for start in (100, 402):
        assert twins.go(range(start, start + 2), off_mm=5000) == {WatchLevel.NORMAL}
        assert twins.go(range(start + 2, start + 302), off_mm=None) == {WatchLevel.NORMAL}
    assert twins.go(range(704, 804), off_mm=5000) == {WatchLevel.NORMAL}
    assert twins.go(range(804, 810), off_mm=5000) == {WatchLevel.NORMAL, WatchLevel.SERVICE_BRAKE}
    assert twins.node.guard.cause is CtlCause.POSITION_IMPLAUSIBLE
    # The port falls silent: the speed is good.
    assert twins.go(range(810, 900), off_mm=None) == {WatchLevel.NORMAL, WatchLevel.SERVICE_BRAKE}
    assert twins.node.guard.level is WatchLevel.NORMAL


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("tick_ns", [500_000, 7_000_000])
def test_the_ramps_lose_nothing_with_any_tick(scenario: Scenario, tmp_path: Path, tick_ns: int) -> None:
    """Service brake for want of a speed, and back: from a ramp of less than a code from one poll to the next on."""
    periods = {TrnSpeed.PORT: tick_ns, NotchCmd.PORT: 2 * tick_ns, TrnPos.PORT: 2 * tick_ns, TrkInfo.PORT: 16 * tick_ns}
    timing = dataclasses.replace(scenario.timing, base_tick_ns=tick_ns, port_period_ns=periods)
    other = dataclasses.replace(scenario, timing=timing)
    other = dataclasses.replace(other, sha256=scenario_sha256(other))
    export_node(other, tmp_path, law="ipfc")
    twins, ticks = Twins(other, tmp_path, "ipfc"), 400_000_000 // tick_ns
    assert twins.go(range(ticks)) == {WatchLevel.NORMAL}
    for _ in range(20):
        twins.wait(20)
        twins.poll()
    assert twins.node.guard.level is WatchLevel.SERVICE_BRAKE
    twins.go(range(ticks + 400_000_000 // tick_ns, 3 * ticks))
    assert twins.node.guard.level is WatchLevel.NORMAL
