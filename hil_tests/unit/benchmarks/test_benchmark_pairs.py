"""The ends used to measure transports: in Python, in C, and what happens when one of them fails."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
from pathlib import Path

import psutil
import pytest
from rich.console import Console

from benchmarks import __main__ as table
from benchmarks import native
from benchmarks.buses import GATEWAY, KERNEL, SOCKET_PAIR, TCP_HUB, UNIX_HUB, Transport, transports
from benchmarks.figures import MeasurementError, Missing
from benchmarks.machine import Machine
from benchmarks.pairs import PYTHON, C, Pair, _runaway_limit_us, busy_cores, fifo, pinned
from benchmarks.peer import Near, PeerError, echo, open_end
from benchmarks.processes import end, hub
from benchmarks.transports import open_pairs, to_c
from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame

FIRST_ID = 0x110
NO_C = Missing("the plain C loop", "not asked for")


@pytest.fixture(scope="session")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The C loop, compiled."""
    found = native.c_loop(tmp_path_factory.mktemp("loop"))
    if isinstance(found, Missing):
        pytest.skip(f"MISSING CAPABILITY {found.why}")
    return found


class Wire:
    """A near end's bus with the far end behind it, in one process; loses every ``lose``-th frame."""

    def __init__(self, lose: int = 0) -> None:
        self._lose = lose
        self._sent = 0
        self._to_far: list[Frame] = []
        self._to_near: list[Frame] = []

    def send(self, frames: list[Frame]) -> None:
        """Carry frames to the far end and let it answer."""
        for frame in frames:
            self._sent += 1
            if not self._lose or self._sent % self._lose:
                self._to_far.append(frame)
        if any(frame.can_id != FIRST_ID + 2 for frame in frames):
            echo(_FarSide(self), FIRST_ID)

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """What the far end has sent."""
        frames, self._to_near = self._to_near, []
        return frames


class _FarSide:
    def __init__(self, wire: Wire) -> None:
        self._wire = wire

    def send(self, frames: list[Frame]) -> None:
        self._wire._to_near += frames

    def receive(self, timeout_s: float | None) -> list[Frame]:
        frames, self._wire._to_far = self._wire._to_far, []
        return frames


def test_near_end_measures_what_it_is_asked_for() -> None:
    near = Near(Wire(), FIRST_ID)
    near.wait_for_echo()
    assert len(near.obey("trips 7\n")) == 7
    assert len(near.obey("stream 3\n")) == 1
    answer = near.obey("pace 5 1000000 0\n")
    assert len(answer) == 10
    assert all(0 <= late_ns <= answered_ns for late_ns, answered_ns in zip(answer[::2], answer[1::2], strict=True))


def test_a_lost_frame_of_a_stream_is_an_error() -> None:
    with pytest.raises(PeerError, match="frames of the stream were lost"):
        Near(Wire(lose=50), FIRST_ID).obey("stream 1")


def test_a_lost_answer_is_an_error() -> None:
    with pytest.raises(PeerError, match="no echo within"):
        Near(Wire(lose=1), FIRST_ID).obey("trips 1")


def test_echo_ends_with_its_bus() -> None:
    class Gone(_FarSide):
        def receive(self, timeout_s: float | None) -> list[Frame]:
            raise BusLost("gone")

    with pytest.raises(BusLost):
        echo(Gone(Wire()), FIRST_ID)


@pytest.mark.long_after(1)
@pytest.mark.loop
@pytest.mark.parametrize("transport", [SOCKET_PAIR, UNIX_HUB, TCP_HUB], ids=lambda transport: transport.short)
def test_both_languages_on_one_transport(transport: Transport, loop: Path, socket_folder: Path) -> None:
    with open_pairs(transport, loop, socket_folder) as pairs:
        assert [pair.language for pair in pairs] == [PYTHON, C]
        pids = [pid for pair in pairs for pid in (*pair.pids, *pair.hub_pids)]
        for pair in pairs:
            trips_ns = pair.ask("trips 20")
            assert len(trips_ns) == 20
            assert all(0 < taken_ns < 10_000_000_000 for taken_ns in trips_ns)
            assert len(pair.ask("stream 2")) == 1
            assert len(pair.ask("pace 3 1000000 0")) == 6
        with pinned(pids):
            assert {frozenset(os.sched_getaffinity(pid)) for pid in pids} == {frozenset({min(os.sched_getaffinity(0))})}
        assert all(os.sched_getaffinity(pid) == os.sched_getaffinity(0) for pid in pids)
    assert not any(psutil.pid_exists(pid) for pid in pids)


@pytest.mark.loop
def test_the_two_languages_understand_each_other(loop: Path, socket_folder: Path) -> None:
    """A near end in Python with a far end in C: it is one protocol, not two."""
    with hub(str(socket_folder / "hub.sock")) as (channel, _):
        far = subprocess.Popen([str(loop), "echo", "hub", channel, hex(FIRST_ID)])
        end_of_link = open_end("hub", channel, FIRST_ID)
        try:
            near = Near(end_of_link, FIRST_ID)
            near.wait_for_echo()
            assert len(near.trips(5)) == 5
            assert len(near.stream(2)) == 1
        finally:
            end_of_link.close()
            end(far)


@pytest.mark.loop
@pytest.mark.parametrize("language", [PYTHON, C])
def test_an_end_that_dies_is_one_line(language: str, loop: Path, socket_folder: Path) -> None:
    program = None if language == PYTHON else loop
    with UNIX_HUB.opened(socket_folder) as ends, Pair(language, program, ends) as pair:
        pair.wait_until_ready()
        os.kill(ends.hub_pids[0], signal.SIGKILL)
        with pytest.raises(MeasurementError, match=rf"^{language} loop on hub .+: .+") as caught:
            pair.ask("trips 5")
    assert "\n" not in str(caught.value)


@pytest.mark.loop
def test_fifo_is_given_and_taken_back(socket_folder: Path) -> None:
    with open_pairs(UNIX_HUB, NO_C, socket_folder) as (pair,):
        try:
            with fifo([pair]):
                scheduling = {pid: os.sched_getscheduler(pid) for pid in (*pair.pids, *pair.hub_pids)}
                (hub_pid,), end_pids = pair.hub_pids, pair.pids
                hub_priority = os.sched_getparam(hub_pid).sched_priority
                assert all(os.sched_getparam(pid).sched_priority < hub_priority for pid in end_pids)
                assert len(pair.ask("trips 5")) == 5
        except PermissionError:
            pytest.skip("MISSING CAPABILITY SCHED_FIFO (root, or ulimit -r)")
        assert set(scheduling.values()) == {os.SCHED_FIFO}
        assert {os.sched_getscheduler(pid) for pid in scheduling} == {os.SCHED_OTHER}


@pytest.mark.parametrize(
    ("found_us", "soft_us"),
    [((-1, -1), 5_000_000), ((500_000, 2_000_000), 2_000_000), ((-1, 9_000_000), 5_000_000)],
)
def test_the_limit_of_a_runaway_stays_within_the_hard_one(found_us, soft_us) -> None:
    assert _runaway_limit_us(found_us) == (soft_us, found_us[1])


@pytest.mark.loop
def test_an_end_that_dies_under_fifo_leaves_nobody_there(loop: Path, socket_folder: Path) -> None:
    """What has no process any more hides nothing, and the others get their scheduling back."""
    with open_pairs(UNIX_HUB, loop, socket_folder) as (first, second):
        living = [*first.hub_pids, *second.pids, *second.hub_pids]
        try:
            with fifo([first, second]):
                os.kill(first.pids[0], signal.SIGKILL)
                with pytest.raises(MeasurementError):
                    first.answer()
        except PermissionError:
            pytest.skip("MISSING CAPABILITY SCHED_FIFO (root, or ulimit -r)")
        assert {os.sched_getscheduler(pid) for pid in living} == {os.SCHED_OTHER}


def test_load_is_on_every_core_and_goes() -> None:
    before = set(psutil.Process().children())
    with busy_cores(30.0):
        spinners = set(psutil.Process().children()) - before
        assert {tuple(spinner.cpu_affinity()) for spinner in spinners} == {(cpu,) for cpu in os.sched_getaffinity(0)}
    assert not any(spinner.is_running() for spinner in spinners)


def test_without_a_compiler_the_ratio_is_missing_and_said(monkeypatch, tmp_path, capsys) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    missing = native.c_loop(tmp_path)
    assert isinstance(missing, Missing)
    assert "no C compiler" in missing.why
    assert to_c({PYTHON: 2.0}, PYTHON) == (None, "")
    assert to_c({PYTHON: 2.0, C: 1.0}, PYTHON) == (2.0, "Python to C")
    result = {"title": "t", "method": "m", "taken_s": 0.0, "figures": [], "missing": [dataclasses.asdict(missing)]}
    table._print(Console(width=200), result)
    printed = capsys.readouterr().out
    assert "MISSING" in printed
    assert missing.why in printed


def test_a_loop_that_does_not_compile_is_no_measurement(tmp_path) -> None:
    broken = tmp_path / "loop.c"
    broken.write_text("int main(void) { return nothing; }\n")
    if native.compiler() is None:
        pytest.skip("MISSING CAPABILITY C compiler")
    with pytest.raises(MeasurementError, match=r"loop\.c does not compile: .*nothing"):
        native.c_loop(tmp_path, broken)


def test_a_hub_that_does_not_start_says_why(socket_folder) -> None:
    with pytest.raises(MeasurementError, match=r"did not start: .*missing"), hub(str(socket_folder / "missing" / "h")):
        pass


def test_a_kernel_without_can_is_said() -> None:
    ways, missing = transports(emulated=False, vcan=False)
    assert KERNEL not in ways
    assert [each.name for each in missing] == [KERNEL.name]
    ways, missing = transports(emulated=True, vcan=True)
    assert KERNEL in ways
    assert {each.name for each in missing} == {TCP_HUB.name, GATEWAY.name}


@pytest.mark.parametrize(("cpu", "emulated"), [("QEMU TCG CPU version 2.5+", True), ("UML", True), ("AMD EPYC", False)])
def test_an_emulated_machine_is_said(cpu: str, emulated: bool) -> None:
    machine = Machine(cpu, 2, 2.0, "Linux", "CPython", "PGO", "pure", {}, 0.1, 0.0, 20.0)
    assert machine.emulated is emulated
    assert ("EMULATED" in dict(machine.lines())) is emulated
