"""Latency of a frame through the hub to another process and back, against the least that two processes can do."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Protocol

from benchmarks.echo import STREAM_ID
from benchmarks.figures import Figure, MeasurementError, Setting, median, p99
from benchmarks.processes import end, hub, hub_config
from bus.frame import Frame
from bus.hub.wire import pack_frame
from bus.link import Link, open_link

TITLE = "round trip"
METHOD = (
    "One 8-byte frame: this process -> hub -> echo process -> hub -> this process (four socket hops, with packing and "
    "unpacking), as the nodes send them. Floor: 16 bytes over a raw AF_UNIX SEQPACKET pair to an echo process and back "
    "(two hops, no hub). All three are measured in turns. Pinned: all processes on one CPU. Stream: batches of 8 "
    "frames, one way, until the last frame's echo has come back."
)
_TRIP_ID = 0x118
_BATCH_FRAMES = 8
_ANSWER_S = 20.0
_PINGS_MAX = 400


class _Path(Protocol):
    name: str

    def trip(self, number: int) -> int:
        """One round trip; ns."""


class _Floor:
    """Raw socket pair with an echo process."""

    name = "raw socket pair (floor)"

    def __init__(self, sock: socket.socket) -> None:
        self._sock = sock

    def trip(self, number: int) -> int:
        packet = pack_frame(Frame(_TRIP_ID, number.to_bytes(8)))
        start_ns = time.perf_counter_ns()
        self._sock.send(packet)
        answer = self._sock.recv(len(packet))
        stop_ns = time.perf_counter_ns()
        if answer != packet:
            raise MeasurementError("raw socket pair: another packet came back")
        return stop_ns - start_ns


class _Hub:
    """A hub with an echo process."""

    def __init__(self, name: str, link: Link) -> None:
        self.name = name
        self._link = link

    def wait_for_echo(self) -> None:
        """Ping until the echo process is on the bus."""
        for number in range(_PINGS_MAX):
            ping = Frame(_TRIP_ID, number.to_bytes(8))
            self._link.send([ping])
            if ping in self._link.receive(0.05):
                return
        raise MeasurementError(f"{self.name}: no echo process")

    def trip(self, number: int) -> int:
        frame = Frame(_TRIP_ID, number.to_bytes(8))
        start_ns = time.perf_counter_ns()
        self._link.send([frame])
        answer = self._link.receive(_ANSWER_S)
        stop_ns = time.perf_counter_ns()
        # An answer to a late ping may be in front.
        while frame not in answer:
            if not answer:
                raise MeasurementError(f"{self.name}: no echo within {_ANSWER_S:g} s")
            answer = self._link.receive(_ANSWER_S)
            stop_ns = time.perf_counter_ns()
        return stop_ns - start_ns

    def stream(self, batches: int) -> float:
        """Frames per second of ``batches`` batches."""
        batch = [Frame(STREAM_ID, bytes(8))] * _BATCH_FRAMES
        start_ns = time.perf_counter_ns()
        for _ in range(batches):
            self._link.send(batch)
        return batches * _BATCH_FRAMES / ((time.perf_counter_ns() - start_ns + self.trip(0)) / 1e9)


@contextmanager
def _echo(*arguments: str, descriptors: tuple[int, ...] = ()) -> Iterator[int]:
    """An echo process; gives its process id."""
    process = subprocess.Popen([sys.executable, "-m", "benchmarks.echo", *arguments], pass_fds=descriptors)
    try:
        yield process.pid
    finally:
        end(process)


class _Bench:
    """The three paths with their processes; a context manager."""

    def __init__(self, folder: Path) -> None:
        self._stack = ExitStack()
        self._pids = [0]
        try:
            self.floor = self._start_floor()
            self.hubs = [
                self._start_hub("hub, Unix socket", str(folder / "hub.sock")),
                self._start_hub("hub, TCP loopback", "tcp://127.0.0.1:0"),
            ]
            self.floor.trip(0)
            for path in self.hubs:
                path.wait_for_echo()
        except BaseException:
            self._stack.close()
            raise

    def __enter__(self) -> _Bench:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def _start_floor(self) -> _Floor:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            echo = _echo("--fd", str(theirs.fileno()), descriptors=(theirs.fileno(),))
            self._pids.append(self._stack.enter_context(echo))
        # Closing our end is what lets the echo process end.
        return _Floor(self._stack.enter_context(ours))

    def _start_hub(self, name: str, channel: str) -> _Hub:
        channel, pid = self._stack.enter_context(hub(channel))
        link = open_link(hub_config(channel))
        self._stack.callback(link.close)
        self._pids += [pid, self._stack.enter_context(_echo("--channel", channel))]
        return _Hub(name, link)

    @contextmanager
    def pinned(self, to_one_cpu: bool) -> Iterator[None]:
        """Keep this process and all others of the bench on one CPU."""
        before = os.sched_getaffinity(0)
        chosen = {min(before)} if to_one_cpu else before
        for pid in self._pids:
            os.sched_setaffinity(pid, chosen)
        try:
            yield
        finally:
            os.sched_setaffinity(0, before)


def _figures(bench: _Bench, setting: Setting, where: str) -> list[Figure]:
    floor, hubs = bench.floor, bench.hubs
    paths: list[_Path] = [floor, *hubs]
    trips = setting.count(250, 5)
    samples_us: dict[str, list[float]] = {path.name: [] for path in paths}
    for turn in range(setting.count(11, 3)):
        for path in paths:
            taken_us = [path.trip(number) / 1000 for number in range(trips)]
            # The first turn warms up.
            samples_us[path.name] += taken_us if turn else []
    figures = []
    floor_us = median(samples_us[floor.name])
    for path in paths:
        taken_us = samples_us[path.name]
        compared = (None, "") if path is floor else (median(taken_us) / floor_us, f"to the floor, {where}")
        figures.append(Figure(f"{where}: {path.name}, median", median(taken_us), "us", *compared))
        figures.append(Figure(f"{where}: {path.name}, p99", p99(taken_us), "us"))
    for hub_path in hubs:
        frames_per_s = median([hub_path.stream(setting.count(1500, 5)) for _ in range(3)])
        figures.append(Figure(f"{where}: {hub_path.name}, stream in batches of 8", frames_per_s, "frames/s"))
    return figures


def measure(setting: Setting) -> list[Figure]:
    """Figures unpinned and on one CPU.

    :raises MeasurementError: a process did not start or did not answer.
    """
    figures: list[Figure] = []
    with _Bench(setting.folder) as bench:
        for where in ("unpinned", "pinned"):
            with bench.pinned(where == "pinned"):
                figures += _figures(bench, setting, where)
    return figures
