"""An emulator that runs an image of a board: started, exchanging frames, reset, stopped, and what it measured."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from statistics import median_low
from typing import IO, Any
from weakref import finalize

from railhil.bus.frame import Frame
from railhil.controller_node.boards import Board, Image, figures_of
from railhil.controller_node.pipe import ControllerFailed, Pipe

#: The kernel ends the emulator with its parent thread, also if this process is killed.
_WITH_PARENT = ("setpriv", "--pdeathsig", "KILL")
_QUIET = ("-display", "none", "-monitor", "none")
_OUTPUT_OCTETS_MAX = 4000
_END_S = 10.0


class Emulator:
    """One emulated board. It has the power on from :meth:`start` to :meth:`stop`.

    :param patience_s: wall time for one answer.
    :param places: values of the places in the emulator's arguments, besides ``{image}``.
    """

    def __init__(self, board: Board, image: Image, patience_s: float, places: Mapping[str, str] | None = None) -> None:
        self.board, self.image = board, image
        self._patience_s = patience_s
        self._places = {"image": image.file, **(places or {})}
        self._program = board.table.emulator.path(f"board {board.name}")
        self._process: subprocess.Popen[bytes] | None = None
        self._output: IO[bytes] | None = None
        self._pipe: Pipe | None = None
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

    def start(self) -> None:
        """Switch it on."""
        self._output = tempfile.TemporaryFile()  # noqa: SIM115
        has_pipe = self.board.table.link == "pipe"
        streams = subprocess.PIPE if has_pipe else subprocess.DEVNULL
        self._process = process = subprocess.Popen(
            [*_WITH_PARENT, *self.command], stdin=streams, stdout=streams, stderr=self._output, bufsize=0
        )
        self._finalizer = finalize(self, _end, process)
        if process.stdin is not None and process.stdout is not None:
            name = f"board {self.board.name}"
            self._pipe = Pipe(name, process.stdout.fileno(), process.stdin.fileno(), self._patience_s)

    def exchange(self, frames: Sequence[Frame]) -> list[Frame]:
        """Send frames to a board with a pipe; returns its answers.

        :raises ControllerFailed: see there; the board is then without power, and its console tells more.
        """
        assert self._pipe is not None
        try:
            answer = self._pipe.exchange(frames)
        except ControllerFailed:
            self.stop()
            raise
        if answer.ticks:
            self._ticks.append(answer.ticks)
        if answer.free_stack:
            self._free_stack = min(answer.free_stack, self._free_stack or answer.free_stack)
        return answer.frames

    def reset(self) -> None:
        """The reset line, held until the board is without power: all of its memory begins anew."""
        self.stop()
        self.start()

    def stop(self) -> None:
        """Switch it off; what it said is in :attr:`console`."""
        if self._process is None or self._output is None:
            return
        self._finalizer()
        if self._pipe is not None:
            self.console += self._pipe.console
        self._output.seek(0)
        said = self._output.read(_OUTPUT_OCTETS_MAX).decode("utf-8", "replace")
        self.console += [line for line in said.splitlines() if line.strip()]
        self._output.close()
        self._process = self._output = self._pipe = None

    def figures(self) -> dict[str, Any]:
        """Board, image and emulator, and what was measured: instructions of a control period (None: not counted), and
        octets of the stack that were used (None: unknown)."""
        table = self.board.table
        step_ns = table.instruction_ns
        counts = sorted(round(ticks * table.tick_ns / step_ns) for ticks in self._ticks) if step_ns else []
        counted = {"min": counts[0], "median": median_low(counts), "max": counts[-1]} if counts else None
        return {
            **figures_of(self.image),
            "title": table.title,
            "emulator": self.version,
            "control_periods": len(self._ticks),
            "instructions": counted,
            "stack_used_octets": self.image.stack_octets - self._free_stack if self._free_stack else None,
        }


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait(_END_S)
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            stream.close()
