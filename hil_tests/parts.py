"""Parts of the test suite as processes: one after the other, or side by side with the output of each printed whole."""

from __future__ import annotations

import os
import selectors
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

_ROOT = Path(__file__).resolve().parent.parent
#: A part that is told to end takes its machine or engine down; after this long it is killed.
_END_S = 60.0
#: An emulated machine keeps about one busy.
_CORES = 2


@dataclass(frozen=True, slots=True)
class Part:
    """One part: what it needs, and the command."""

    key: str
    name: str
    command: list[str]
    #: What is to be installed for it, by the name of what goes missing without.
    tools: dict[str, Callable[[], None]] = field(default_factory=dict)
    #: May run beside parts of another key that are so too; those of one key never run side by side.
    beside: bool = False


def run(parts: Sequence[Part], *, cores: int | None = None, end_s: float = _END_S) -> list[int]:
    """Run the parts and return their exit codes.

    Neighbours that may run beside each other do so where this process may use two cores: each key is a lane in which
    its parts come one after the other. What such a part says is printed whole, in the order of ``parts``, as soon as it
    and all before it have ended. All other parts run alone, and what they say is printed as they say it.

    Args:
        cores: processors that may be used; None: those of this process.
        end_s: a part that is told to end is killed after this long.

    Raises:
        KeyboardInterrupt, SystemExit: by Ctrl-C or SIGTERM, after every part has been ended the same way; what those
            side by side have said until then is printed.
    """
    codes: list[int] = []
    for group in _groups(parts, len(os.sched_getaffinity(0)) if cores is None else cores):
        lanes = {part.key for part in group}
        codes += _side_by_side(group, end_s) if len(lanes) > 1 else [_alone(part, end_s) for part in group]
    return codes


def _groups(parts: Sequence[Part], cores: int) -> list[list[Part]]:
    """The parts in groups of neighbours that may run side by side."""
    groups: list[list[Part]] = []
    for part in parts:
        if part.beside and groups and groups[-1][-1].beside:
            groups[-1].append(part)
        else:
            groups.append([part])
    if cores < _CORES:
        return [[part] for part in parts]
    return groups


class _Running:
    """A part's process, in a process group of its own, so that it can be ended with all that it has started."""

    def __init__(self, part: Part, output: BinaryIO | None = None) -> None:
        self.part = part
        self._output = output
        self._started_s = time.monotonic()
        self._passed_s = 0.0
        self.process = subprocess.Popen(
            part.command, cwd=_ROOT, start_new_session=True, stdout=output,
            stderr=None if output is None else subprocess.STDOUT,
        )  # fmt: skip

    def first_line(self) -> str:
        return f"\n=== {self.part.name} ==="

    def wait(self, timeout_s: float | None = None) -> int:
        """Exit code."""
        code = self.process.wait(timeout_s)
        self._passed_s = time.monotonic() - self._started_s
        return code

    def last_line(self) -> str:
        return f"=== {self.part.name}: exit code {self.process.returncode} after {self._passed_s:.0f} s ==="

    def said(self) -> str:
        """What it has said so far."""
        assert self._output is not None
        self._output.seek(0)
        return self._output.read().decode(errors="replace")


@contextmanager
def _ended_with_us(running: Sequence[_Running], end_s: float) -> Iterator[None]:
    """End all that still run when this process is told to end: by the same signal, and killed if they do not.

    ``running`` may grow in the block.
    """
    try:
        yield
    except BaseException as error:
        number = signal.SIGINT if isinstance(error, KeyboardInterrupt) else signal.SIGTERM
        try:
            for one in running:
                _signal(one, number)
            deadline_s = time.monotonic() + end_s
            for one in running:
                with suppress(subprocess.TimeoutExpired):
                    one.wait(max(0.0, deadline_s - time.monotonic()))
        finally:
            for one in running:
                _signal(one, signal.SIGKILL)
                one.wait()
        raise


def _signal(one: _Running, number: int) -> None:
    # Until poll() has seen its end, its number is not given to another.
    if one.process.poll() is None:
        os.killpg(one.process.pid, number)


def _alone(part: Part, end_s: float) -> int:
    """Run a part that prints for itself."""
    running: list[_Running] = []
    with _ended_with_us(running, end_s):
        print(f"\n=== {part.name} ===", flush=True)
        running.append(_Running(part))
        code = running[0].wait()
        print(running[0].last_line(), flush=True)
    return code


def _side_by_side(parts: Sequence[Part], end_s: float) -> list[int]:
    """Run lanes of parts, with the output of each in a file until it is printed."""
    lanes: dict[str, list[Part]] = {}
    for part in parts:
        lanes.setdefault(part.key, []).append(part)
    names = "; ".join(", then ".join(part.name for part in lane) for lane in lanes.values())
    print(f"\n=== side by side, each printed at its end: {names} ===", flush=True)
    running: list[_Running] = []
    unprinted = list(parts)
    with ExitStack() as files, selectors.DefaultSelector() as ends:

        def start_next(lane: list[Part]) -> None:
            if lane:
                one = _Running(lane.pop(0), files.enter_context(tempfile.TemporaryFile()))
                running.append(one)
                end = os.pidfd_open(one.process.pid)
                files.callback(os.close, end)
                ends.register(end, selectors.EVENT_READ, one)

        def print_ended() -> None:
            ended = {one.part.name: one for one in running if one.process.returncode is not None}
            while unprinted and unprinted[0].name in ended:
                one = ended[unprinted.pop(0).name]
                print(f"{one.first_line()}\n{one.said()}{one.last_line()}", flush=True)

        try:
            with _ended_with_us(running, end_s):
                for lane in lanes.values():
                    start_next(lane)
                while ends.get_map():
                    for item, _ in ends.select():
                        ends.unregister(item.fd)
                        item.data.wait()
                        print_ended()
                        start_next(lanes[item.data.part.key])
        finally:
            # Told to end: the others have ended too, and what they have said may be why.
            print_ended()
    return [one.process.returncode for part in parts for one in running if one.part is part]
