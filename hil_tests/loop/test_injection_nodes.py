"""Faults of the time, the bus and the controller, in one process: who notices, and how the run ends."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.disturbed import disturbed_run
from hil_tests.support.injected import NOTCH, SPEED, Runs, frames, runs_with_faults
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import local_run
from railhil.bus.codes import Event
from railhil.bus.frame import ERROR, FD, REMOTE, Frame
from railhil.bus.telegrams import SupCmd, TimeSync
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.scenarios.load import load
from railhil.wire.ato import CtlMode, NotchCmd, SimTruth, TrnPos, TrnWatch

pytestmark = pytest.mark.faults


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Runs:
    return runs_with_faults(tmp_path_factory)


@pytest.mark.slow
def test_the_time_told_may_be_wrong(runs: Runs) -> None:
    def told(fault: str = "") -> float:
        run = runs(*filter(None, [fault]))
        seconds, ticks = (run.trace.values(TimeSync.PORT, name)[1] for name in ("TimeSeconds", "TimeTicks"))
        return float(seconds + ticks)

    assert told() == pytest.approx(1.28, abs=1e-4)
    assert told("time step 500ms @1s for 500ms") == pytest.approx(1.78, abs=1e-4)
    assert told("time drift 10000ppm @0s for 1400ms") == pytest.approx(1.2928, abs=1e-4)
    assert told("time stuck @0s for 1400ms") == pytest.approx(0.0, abs=1e-4)


@pytest.mark.slow
def test_the_bus_is_off_for_both_sides(runs: Runs) -> None:
    run = runs("bus off @1s for 100ms")
    told = ("SUP_CMD", "SIM_TRUTH", "TRN_WATCH")
    vehicle = [port for port in wire_contract().ports if port.period_ns and port.name not in told]
    ids = {can_id for port in vehicle for can_id in port.can_ids}
    assert run.log is not None
    during = [frame for time_ns, frame in read_log(run.log) if 1_000_000_000 <= time_ns < 1_100_000_000]
    assert not [frame for frame in during if frame.can_id in ids and frame.data]
    assert run.trace.times_s("SIM_TRUTH").size == runs().trace.times_s("SIM_TRUTH").size
    assert run.counters["plant"]["no_answer"] >= 5
    # The controller's own timer runs on: it sees how old the speed is.
    modes = run.trace.raw(NotchCmd.PORT, "CtlMode")
    assert CtlMode.TRACTION_CUT in modes
    backlog = runs("bus off @1s for 100ms after deliver")
    assert len(frames(backlog, SPEED)) == len(frames(runs(), SPEED))
    newest = runs("bus full @1s for 100ms")
    assert len(frames(newest, SPEED)) == len(frames(runs(), SPEED)) - 9


@pytest.mark.slow
def test_both_watches_react_to_bus_off_and_the_notch_comes_back_without_a_jump(runs: Runs) -> None:
    """B3 of the catalogue; the record shows the train's watch while the bus is off."""
    run = runs("bus off @9s for 300ms", moving=True)
    time_s, notch = run.trace.times_s(NotchCmd.PORT), run.trace.values(NotchCmd.PORT, "NotchCmd")
    modes = run.trace.raw(NotchCmd.PORT, "CtlMode")
    watch_s, levels = run.trace.times_s(TrnWatch.PORT), run.trace.raw(TrnWatch.PORT, "WatchLevel")
    braked_s = watch_s[(levels == 3) & (watch_s > 1.0)]
    assert 9.2 < braked_s[0] <= 9.27
    assert braked_s[-1] < 9.5
    back = np.flatnonzero(time_s >= 9.3)
    assert modes[back[0]] == CtlMode.SERVICE_BRAKE
    assert modes[back[20]] == CtlMode.RUNNING
    # The brake's ramp had gone on meanwhile, and the way back is a ramp too.
    assert np.abs(np.diff(notch[back[0] : back[40]])).max() < 0.12
    assert abs(notch[back[0]] - notch[back[0] - 1]) < 1.2


def test_an_error_frame_is_neither_a_poll_nor_a_tick_for_the_recorder(tmp_path: Path) -> None:
    """Its identifier says what went wrong: "restarted" is the one of TRN_SPEED, "bus error" that of the polls."""
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML)
    session_ids = (0x100, 0x80, SupCmd.port().address, SimTruth.port().address)

    def disturbed(frame: Frame, time_s: float) -> list[Frame]:
        noise = [Frame(can_id, bytes(range(8)), ERROR) for can_id in session_ids]
        return [*noise, frame] if frame.can_id == TrnPos.port().address and 1.0 < time_s < 2.0 else [frame]

    trace = disturbed_run(load(path, (), ("TRN_SPEED loss @3s x1",)), tmp_path, disturbed)
    assert np.allclose(np.diff(trace.times_s(SimTruth.PORT)), 0.02)
    assert {(source, cause) for _, source, cause in trace.refused} == {("bus", "error_frame")}


def test_foreign_frames_load_the_bus(runs: Runs) -> None:
    run = runs("bus load 50% @1s for 1s")
    count = len(frames(run, 0x7E0))
    assert count * 111 == pytest.approx(0.5 * 500_000, rel=0.02)
    assert run.score.verdict == runs().score.verdict


def test_with_can_fd_a_remote_frame_is_classic_and_a_foreign_one_has_the_form_of_its_port(tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML)
    faults = ("TRN_POS remote @1s for 100ms", "TRN_POS masquerade SPEED_SDT @2s for 100ms")
    seen: list[Frame] = []

    def wire(frame: Frame) -> list[Frame]:
        seen.append(frame)
        return [frame]

    local_run(load(path, (), faults), tmp_path, fd=True, wire=wire)
    contract = wire_contract()
    remote = [frame for frame in seen if frame.can_id == contract.port(TrnPos.PORT).fd_id and frame.flags & REMOTE]
    assert {(len(frame.data), frame.flags & FD) for frame in remote} == {(8, 0)}
    foreign = [frame for frame in seen if frame.can_id == contract.port("SPEED_SDT").fd_id]
    assert {frame.flags & FD for frame in foreign} == {FD}


def test_a_killed_controller_is_gone(runs: Runs) -> None:
    run = runs("controller kill @1s")
    assert run.ended is Event.ENDED_CONTROLLER_LOST
    assert frames(run, NOTCH)[-1][0] < 1.0
    assert run.faults[0].effect_s == 1.0
    # As asked for: the train is judged, not the bench.
    assert (run.score.verdict, run.score.failures[0]) == ("FAIL", "controller lost")


@pytest.mark.parametrize("fault", ["bus down @1s", "NOTCH_CMD loss @1s", "controller stop @1s"])
def test_a_controller_silenced_for_good_is_lost(runs: Runs, fault: str) -> None:
    run = runs(fault)
    assert run.ended is Event.ENDED_CONTROLLER_LOST
    assert (run.score.verdict, run.score.failures[0]) == ("FAIL", "controller lost")


def test_a_stopped_controller_continues(runs: Runs) -> None:
    for after in ("", " after deliver"):
        run = runs(f"controller stop @1s for 200ms{after}")
        answers = frames(run, NOTCH)
        silent = [time_s for time_s, frame in answers if not frame.data]
        assert silent == pytest.approx([1.0 + step / 50 for step in range(10)])
        assert answers[-1][1].data
        assert run.ended is not Event.ENDED_CONTROLLER_LOST
    # Without the frames it only knows from its own timer how old the speed is.
    modes = runs("controller stop @1s for 200ms").trace.raw(NotchCmd.PORT, "CtlMode")
    assert CtlMode.TRACTION_CUT in modes


def test_a_controller_made_anew_initialises(runs: Runs) -> None:
    run = runs("controller restart @1s for 200ms")
    first = next(frame for time_s, frame in frames(run, NOTCH) if time_s >= 1.2)
    assert NotchCmd.decode(first.data[:4]).life == 1


def test_a_slow_controller_answers_late(runs: Runs) -> None:
    run = runs("controller slow 40ms @1s for 1s")
    late, own = dict(frames(run, NOTCH)), dict(frames(runs(), NOTCH))
    assert late[1.5].data[3] & 0xF == own[1.46].data[3] & 0xF
