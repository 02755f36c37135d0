"""An emulator that runs an image of a board: started, exchanging frames, reset, stopped, and what it measured."""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median_low
from typing import IO, Any, NamedTuple
from weakref import finalize

from railhil.bus.frame import Frame
from railhil.common.errors import Words
from railhil.common.python_process import WITH_PARENT
from railhil.controller_node.boards import Board, Image, Program, figures_of
from railhil.controller_node.boards.can_bus import CanExchange, PrivateBus
from railhil.controller_node.pipe import ControllerFailed, Pipe
from railhil.dbc import Contract

#: Of :data:`WITH_PARENT`.
_TIE = Program(program=WITH_PARENT[0], packages="util-linux")
_QUIET = ("-display", "none", "-monitor", "none")
#: No sound of the host's. The ZCU102 has a display port with sound, and QEMU says which drivers are not installed.
_ENVIRONMENT = {"QEMU_AUDIO_DRV": "none"}
_NO_SOUND = "qemu: module audio-"
_OUTPUT_OCTETS_MAX = 4000
_END_S = 10.0


class Instructions(NamedTuple):
    """Numbers of instructions of control periods."""

    min: int
    median: int
    max: int


class Emulator:
    """One emulated board. It has the power on from :meth:`start` to :meth:`stop`.

    :param patience_s: wall time for one answer.
    :param contract: of the bus, for a board with CAN; its arguments have the place ``{can}`` for the interface.
    """

    def __init__(self, board: Board, image: Image, patience_s: float, contract: Contract | None = None) -> None:
        self.board, self.image = board, image
        self._patience_s = patience_s
        self._contract = contract
        self._places = {"image": image.file}
        _TIE.path(f"board {board.name}")
        self._program = board.table.emulator.path(f"board {board.name}")
        self._process: subprocess.Popen[bytes] | None = None
        self._output: IO[bytes] | None = None
        self._pipe: Pipe | None = None
        self._bus: PrivateBus | None = None
        self._can: CanExchange | None = None
        self._ticks: list[int] = []
        self._free_stack = 0
        #: Lines of the console, also from before a reset.
        self.console: list[str] = []

    @property
    def version(self) -> str:
        """What the emulator says of itself."""
        said = subprocess.run([self._program, "--version"], capture_output=True, text=True, check=False).stdout
        return said.partition("\n")[0].strip()

    @property
    def command(self) -> list[str]:
        """The words that start it."""
        table = self.board.table
        words = [word.format_map(self._places) for word in table.emulator.arguments]
        if "{image}" not in " ".join(table.emulator.arguments):
            words += ["-kernel", self.image.file]
        if table.instruction_ns:
            words += ["-icount", f"shift={table.instruction_ns.bit_length() - 1}"]
        return [self._program, *_QUIET, *words]

    def run(self, stdin: Path, limit_s: float) -> str:
        """Run the image of a program that ends; returns what it printed.

        :param stdin: its standard input.
        :raises ControllerFailed: it has not ended after ``limit_s``, or the emulator has failed.
        """
        name = f"board {self.board.name}"
        with stdin.open("rb") as stream:
            try:
                done = subprocess.run(
                    [*WITH_PARENT, *self.command], stdin=stream, capture_output=True, timeout=limit_s, check=False
                )
            except subprocess.TimeoutExpired:
                words = Words(f"has not ended after {limit_s:g} s")
                raise ControllerFailed(name, stdin.name, words, "a program that ends") from None
        if said := done.stderr.decode("utf-8", "replace").strip():
            raise ControllerFailed(name, self.board.table.emulator.program, Words(said), "an emulator that runs")
        return done.stdout.decode("utf-8", "replace")

    def start(self) -> None:
        """Switch it on.

        :raises InputError: there is no CAN bus for a board with CAN.
        """
        has_pipe = self.board.table.link == "pipe"
        if not has_pipe:
            self._bus = PrivateBus(self.board.name)
            self._places["can"] = self._bus.interface
        self._output = tempfile.TemporaryFile()  # noqa: SIM115
        self._process = process = subprocess.Popen(
            [*WITH_PARENT, *self.command],
            stdin=subprocess.PIPE if has_pipe else subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=self._output,
            bufsize=0,
            env={**os.environ, **_ENVIRONMENT},
        )
        self._finalizer = finalize(self, _end, process)
        assert process.stdout is not None
        if process.stdin is not None:
            name = f"board {self.board.name}"
            self._pipe = Pipe(name, process.stdout.fileno(), process.stdin.fileno(), self._patience_s)
        elif self._bus is not None:
            assert self._contract is not None
            self._can = CanExchange(
                self._bus, process.stdout, self._patience_s, contract=self._contract, note_period=self._note
            )

    def exchange(self, frames: Sequence[Frame]) -> list[Frame]:
        """Send frames to the board; returns its answers.

        :raises ControllerFailed: see there; the board is then without power, and its console tells more.
        """
        try:
            if self._can is not None:
                return self._can.exchange(frames)
            assert self._pipe is not None
            answer = self._pipe.exchange(frames)
        except ControllerFailed:
            self.stop()
            raise
        self._note(answer.ticks, answer.free_stack)
        return answer.frames

    def _note(self, ticks: int, free_stack: int) -> None:
        if ticks:
            self._ticks.append(ticks)
        if free_stack:
            self._free_stack = min(free_stack, self._free_stack or free_stack)

    def reset(self) -> None:
        """The reset line, held until the board is without power: all of its memory begins anew."""
        self.stop()
        self.start()

    def stop(self) -> None:
        """Switch it off; what it said is in :attr:`console`."""
        if self._process is None or self._output is None:
            return
        self._process.kill()
        self._process.wait(_END_S)
        if self._pipe is not None:
            self.console += self._pipe.console
        if self._can is not None:
            self._can.close()
            self.console += self._can.console
        self._finalizer()
        if self._bus is not None:
            self._bus.close()
        self._output.seek(0)
        said = self._output.read(_OUTPUT_OCTETS_MAX).decode("utf-8", "replace")
        self.console += [line for line in said.splitlines() if line.strip() and not line.startswith(_NO_SOUND)]
        self._output.close()
        self._process = self._output = self._pipe = self._bus = self._can = None

    def figures(self) -> dict[str, Any]:
        """Board, image and emulator, and what was measured: instructions of a control period (None: not counted), and
        octets of the stack that were used (None: unknown). The emulator's own words are known when it is off."""
        table, link = self.board.table, self._pipe or self._can
        counts = self.instructions(self._ticks)
        return {
            **figures_of(self.image),
            "title": table.title,
            "emulator": self.version,
            "control_periods": len(self._ticks),
            "instructions": None if counts is None else counts._asdict(),
            "console": [*self.console, *(() if link is None else link.console)],
            "stack_used_octets": self.image.stack_octets - self._free_stack if self._free_stack else None,
        }

    def instructions(self, ticks: Sequence[int]) -> Instructions | None:
        """The instructions of control periods that took so many ticks; None: it does not count them, or no period."""
        table = self.board.table
        if not table.instruction_ns or not ticks:
            return None
        counts = sorted(round(count * table.tick_ns / table.instruction_ns) for count in ticks)
        return Instructions(counts[0], median_low(counts), counts[-1])


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait(_END_S)
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            stream.close()
