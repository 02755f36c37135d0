"""Frames to and from an emulated board with a CAN controller: on a CAN bus of its own, a ``vcan`` interface between the
bench and the emulator.

The bus carries every frame that the controller would see on the bus of the run. The board's console, lines of text on
its UART, says when it hears the bus (``ready``), what a control period took, and why it cannot go on (``failure:``);
see ``common/main_can.c``.
"""

from __future__ import annotations

import os
import re
import select
import socket
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import count
from typing import IO
from weakref import finalize

from railhil.bus.frame import ERROR, FD, Frame
from railhil.bus.ident import Role
from railhil.bus.mvb import parse_master_frame
from railhil.bus.own_frames import answer_ids
from railhil.bus.packing import CLASSIC_SIZE, FD_SIZE, pack_frame, unpack_frames
from railhil.common.errors import InputError, Words
from railhil.controller_node.boards import Program
from railhil.controller_node.pipe import LINES_MAX, ControllerFailed
from railhil.dbc import Contract

_IP = Program(program="ip", packages="iproute2")
_NUMBERS = count()
_PERIOD = re.compile(r"control period: (\d+) ticks, stack free: (\d+) octets")
_FAILURE = "failure: "
_READY = "ready"
_READ_OCTETS = 4096
#: Of struct can_frame and struct canfd_frame.
_LENGTH_AT, _CLASSIC_DATA_MAX = 4, 8
#: Wall time until a board is ready, on a busy host.
_START_S = 60.0


class PrivateBus:
    """A CAN interface of this host that only one board is on.

    :param board: its name, for errors.
    :raises InputError: the kernel has no CAN, or does not let this user make an interface.
    """

    def __init__(self, board: str) -> None:
        self.board = board
        ip = _IP.path(f"board {board}")
        #: Its name.
        self.interface = f"rh{os.getpid()}_{next(_NUMBERS)}"
        for words in (("add", "dev", self.interface, "type", "vcan"), ("set", self.interface, "up")):
            done = subprocess.run([ip, "link", *words], capture_output=True, text=True, check=False)
            if done.returncode:
                said = Words(f"there is no CAN bus for it: {done.stderr.strip()}")
                allowed = "a kernel where CAN interfaces can be made: railhil vcan -- ..."
                raise InputError(f"board {board}", "", said, allowed)
        #: Takes the interface away.
        self.close = finalize(self, subprocess.run, [ip, "link", "del", self.interface], capture_output=True)


class CanExchange:
    """One board on its bus, from the power on to the power off.

    :param console: of the emulator, the board's UART. The caller closes it.
    :param patience_s: wall time for one answer.
    :param contract: says how many frames an answer has.
    :param note_period: called after a control period with its ticks, and the octets of the stack never used so far.
    """

    def __init__(
        self,
        bus: PrivateBus,
        console: IO[bytes],
        patience_s: float,
        *,
        contract: Contract,
        note_period: Callable[[int, int], None],
    ) -> None:
        self._board, self._patience_s, self._note_period = bus.board, patience_s, note_period
        self._answers = answer_ids(contract, Role.CONTROLLER)
        self._poll_id = contract.poll_id
        self._console = console
        os.set_blocking(console.fileno(), False)
        self._rest = b""
        self._socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self._socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1)
        self._socket.bind((bus.interface,))
        self._arrives = select.poll()
        for source in (self._socket, console):
            self._arrives.register(source, select.POLLIN)
        self._started_s, self._is_ready = time.monotonic(), False
        self._failure = ""
        #: Lines of the console.
        self.console: list[str] = []

    def exchange(self, frames: Sequence[Frame]) -> list[Frame]:
        """Send frames, of which the last one may be a poll of the controller; returns what the board sent: the frames
        of its answer, and others that nobody asked for.

        :raises ControllerFailed: see there.
        """
        while not self._is_ready:
            self._wait(self._started_s + _START_S, "does not start")
        found: list[Frame] = []
        try:
            self._exchange(frames, found)
        except ControllerFailed as error:
            # The bus may be the cause.
            with suppress(OSError):
                found += self._received()
            error.frames = found
            raise
        return found

    def _exchange(self, frames: Sequence[Frame], found: list[Frame]) -> None:
        """Add the frames of the board to those found."""
        until_s = time.monotonic() + self._patience_s
        last = frames[-1]
        polled = parse_master_frame(last.data) if last.can_id == self._poll_id else None
        missing = list(self._answers.get(polled, ()) if polled else ())
        try:
            found += self._received()
            for frame in frames:
                if not frame.flags & (ERROR | FD):
                    self._socket.send(pack_frame(frame))
            while missing:
                self._wait(until_s, f"has not answered for {self._patience_s:g} s")
                for frame in self._received():
                    found.append(frame)
                    if frame.can_id in missing:
                        missing.remove(frame.can_id)
        except OSError as error:
            raise self._failed(f"has lost its bus: {error.strerror}") from error

    def close(self) -> None:
        """Leave the bus, and read what the board has said last."""
        self._socket.close()
        self._read_console()

    def _received(self) -> list[Frame]:
        """The frames that have arrived."""
        frames: list[Frame] = []
        try:
            while True:
                octets = self._socket.recv(FD_SIZE, socket.MSG_DONTWAIT)
                # QEMU 7.2 leaves the flags of a frame that the ZCU102 sends undefined, so some are CAN FD's by chance;
                # both structs have identifier, length and the first 8 octets at the same places.
                frames += unpack_frames(octets if octets[_LENGTH_AT] > _CLASSIC_DATA_MAX else octets[:CLASSIC_SIZE])
        except BlockingIOError:
            return frames

    def _wait(self, until_s: float, otherwise: str) -> None:
        """Wait for a frame, or for the console, which is read.

        :raises ControllerFailed: the board has failed, or neither comes: ``otherwise``.
        """
        ready = dict(self._arrives.poll(max(0.0, until_s - time.monotonic()) * 1e3))
        if not ready:
            raise self._failed(otherwise)
        if self._console.fileno() in ready:
            runs = self._read_console()
            if self._failure:
                raise self._failed(f"has failed: {self._failure}")
            if not runs:
                raise self._failed("has ended")

    def _read_console(self) -> bool:
        """Take the lines that are there; False: the emulator has ended."""
        while octets := self._console.read(_READ_OCTETS):
            *lines, self._rest = (self._rest + octets).split(b"\n")
            for line in lines:
                self._take(line.decode("utf-8", "replace").strip())
        return octets is None

    def _take(self, line: str) -> None:
        if found := _PERIOD.fullmatch(line):
            self._note_period(int(found[1]), int(found[2]))
        elif line == _READY:
            self._is_ready = True
        else:
            self.console = [*self.console, line][-LINES_MAX:]
            if line.startswith(_FAILURE):
                self._failure = line.removeprefix(_FAILURE)

    def _failed(self, words: str) -> ControllerFailed:
        return ControllerFailed(f"board {self._board}", "", Words(words), "an answer")
