"""One end of a measured connection, as a separate process.

``python -m benchmarks.peer echo|near KIND ADDRESS FIRST_ID``. KIND and ADDRESS: ``pair FD`` (an inherited end of an
AF_UNIX SEQPACKET pair), ``hub PATH``, ``tcp HOST:PORT``, ``can INTERFACE``, ``python-can SETTINGS`` (of any interface:
keyword arguments of ``can.Bus`` as JSON). ``c/loop.c`` is the same program in C, with the same words, frames and
answers, but without the last kind.

The far end, ``echo``, sends every frame back until the bus ends. The near end takes one command per line on standard
input and answers each with one line of nanoseconds on standard output; its first line is ``ready``.

========================= ============================================================================================
command                   answer
========================= ============================================================================================
``trips N``               N round trips of one frame of 8 bytes
``stream N``              wall time of N windows, each of 16 batches of 8 frames one way; the far end is asked after
                          each window how many have come, so no receive buffer overflows and a lost frame is an error
``pace N PERIOD PHASE``   N cycles with absolute deadlines every PERIOD ns, one round trip in each: lateness of the
                          start and of the answer after the deadline, in turns
========================= ============================================================================================

Identifiers: FIRST_ID for trips, one more for the question how many, two more for the stream.
"""

from __future__ import annotations

import gc
import json
import socket
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from typing import Protocol

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.clock import Pacer
from railhil.bus.errors import BusError, BusLost, BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.hub.address import TCP_SCHEME
from railhil.bus.link import Link, open_link
from railhil.bus.packing import MAX_PACKET_SIZE, pack_frames, unpack_frames

BATCH_FRAMES = 8
WINDOW_BATCHES = 16
_ANSWER_S = 20.0
#: Silence after which a far end without its near end ends by itself; longer than the turns of the other pairs.
_IDLE_S = 300.0
_PINGS_MAX = 400
_PING_S = 0.05
_SETTLE_PERIODS = 2
_HANDSHAKES_MAX = 5
#: Begins the line of standard error that says why an end has failed.
COMPLAINT = "peer: "


class PeerError(Exception):
    """The other end does not respond as expected; one line."""


class _End(Protocol):
    def send(self, frames: Sequence[Frame]) -> None: ...

    def receive(self, timeout_s: float | None) -> list[Frame]: ...


class _PairEnd:
    """One end of a SEQPACKET pair: the packet format of the hub, without a hub. Waits for ever."""

    def __init__(self, descriptor: int) -> None:
        self._sock = socket.socket(fileno=descriptor)

    def send(self, frames: Sequence[Frame]) -> None:
        """Send one packet."""
        for packet in pack_frames(frames):
            self._sock.send(packet)

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """Receive one packet.

        :raises BusLost: the other end has closed.
        """
        packet = self._sock.recv(MAX_PACKET_SIZE)
        if not packet:
            raise BusLost("socket pair closed")
        return unpack_frames(packet)

    def close(self) -> None:
        """Close the socket."""
        self._sock.close()


def open_end(kind: str, address: str, first_id: int) -> Link | _PairEnd:
    """Open an end like a node; on CAN with a filter for this pair's frames."""
    if kind == "pair":
        return _PairEnd(int(address))
    if kind == "can":
        rule = {"can_id": first_id, "can_mask": 0x7F0, "extended": False}
        return open_link({"interface": "socketcan", "channel": address, "can_filters": [rule]})
    if kind == "python-can":
        # A frame of the other end breaks python-can's handshake with socketcand if it comes in the middle of it.
        for _ in range(_HANDSHAKES_MAX - 1):
            with suppress(BusUnavailable):
                return open_link(json.loads(address))
        return open_link(json.loads(address))
    channel = TCP_SCHEME + address if kind == "tcp" else address
    return open_link({"interface": HUB_INTERFACE, "channel": channel})


def echo(end: _End, first_id: int) -> None:
    """Send frames back until the bus ends or has been silent for five minutes."""
    count_id, stream_id = first_id + 1, first_id + 2
    streamed = 0
    while frames := end.receive(_IDLE_S):
        answers = []
        for frame in frames:
            if frame[0] == stream_id:
                streamed += 1
            elif frame[0] == count_id:
                answers.append(Frame(count_id, streamed.to_bytes(8, sys.byteorder)))
                streamed = 0
            else:
                answers.append(frame)
        if answers:
            end.send(answers)


class Near:
    """The near end, which makes the measurements."""

    def __init__(self, end: _End, first_id: int) -> None:
        self._end = end
        self._trip_id, self._count_id, self._stream_id = first_id, first_id + 1, first_id + 2

    def wait_for_echo(self) -> None:
        """Ping until the far end answers.

        :raises PeerError: it does not.
        """
        for number in range(_PINGS_MAX):
            self._end.send([Frame(self._trip_id, number.to_bytes(8, sys.byteorder))])
            if self._end.receive(_PING_S):
                return
        raise PeerError("no echo process")

    def _trip(self, sent: Frame, expected: Frame) -> int:
        """Round trip of one frame, in ns; frames before the answer (late replies to a ping) are skipped."""
        start_ns = time.monotonic_ns()
        self._end.send([sent])
        while True:
            answer = self._end.receive(_ANSWER_S)
            stop_ns = time.monotonic_ns()
            if expected in answer:
                return stop_ns - start_ns
            if not answer:
                raise PeerError(f"no echo within {_ANSWER_S:g} s")
            if any(frame.can_id == self._count_id for frame in answer):
                raise PeerError("frames of the stream were lost")

    def _there_and_back(self, number: int) -> int:
        frame = Frame(self._trip_id, number.to_bytes(8, sys.byteorder))
        return self._trip(frame, frame)

    def trips(self, count: int) -> list[int]:
        """Round trips in ns."""
        return [self._there_and_back(number) for number in range(count)]

    def stream(self, windows: int) -> list[int]:
        """Wall time in ns of this many windows, one way."""
        batch = [Frame(self._stream_id, bytes(8))] * BATCH_FRAMES
        question = Frame(self._count_id, bytes(8))
        all_came = Frame(self._count_id, (WINDOW_BATCHES * BATCH_FRAMES).to_bytes(8, sys.byteorder))
        start_ns = time.monotonic_ns()
        for _ in range(windows):
            for _ in range(WINDOW_BATCHES):
                self._end.send(batch)
            self._trip(question, all_came)
        return [time.monotonic_ns() - start_ns]

    def pace(self, cycles: int, period_ns: int, phase_ns: int) -> list[int]:
        """Lateness of start and answer of each cycle in ns, with the nodes' pacer."""
        pacer = Pacer(rate=1.0)
        start_ns = (time.monotonic_ns() // period_ns + _SETTLE_PERIODS) * period_ns + phase_ns
        time.sleep((start_ns - time.monotonic_ns()) / 1e9)
        pacer.start()
        taken_ns = []
        for cycle in range(cycles):
            late_ns = pacer.wait(cycle * period_ns)
            self._there_and_back(cycle)
            taken_ns += [late_ns, time.monotonic_ns() - pacer.deadline_ns(cycle * period_ns)]
        return taken_ns

    def obey(self, line: str) -> list[int]:
        """Execute one command."""
        name, *numbers = line.split()
        commands: dict[str, Callable[..., list[int]]] = {
            "trips": self.trips,
            "stream": self.stream,
            "pace": self.pace,
        }
        return commands[name](*map(int, numbers))


def main(words: Sequence[str]) -> int:
    """Run one end until the bus or standard input ends."""
    mode, kind, address, first = words
    first_id = int(first, 0)
    # As in the nodes: no garbage collection inside a cycle.
    gc.freeze()
    gc.disable()
    try:
        with closing(open_end(kind, address, first_id)) as end:
            if mode == "echo":
                # The near end leaves first, which ends the echo process.
                with suppress(BusLost):
                    echo(end, first_id)
                return 0
            near = Near(end, first_id)
            near.wait_for_echo()
            print("ready", flush=True)
            for line in sys.stdin:
                print(*near.obey(line), flush=True)
    except (PeerError, BusError) as error:
        print(f"{COMPLAINT}{error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
