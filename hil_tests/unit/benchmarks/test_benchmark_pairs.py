"""The ends used to measure transports: in Python, in C, and what happens when one of them fails."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import psutil
import pytest

from benchmarks import native
from benchmarks.buses import SOCKET_PAIR, TCP_HUB, UNIX_HUB, Transport
from benchmarks.figures import MeasurementError, Missing
from benchmarks.pairs import PYTHON, C, Pair, fifo, pinned
from benchmarks.peer import Near, PeerError, echo, open_end
from benchmarks.processes import end, hub
from benchmarks.transports import open_pairs
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
