"""Starting, watching and ending the node processes of a run."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from railhil.common.python_process import Process, start_module
from railhil.common.scheduling import is_said

#: Time for a node to end by itself after SIGTERM.
TERMINATE_S = 1.0
#: Exit codes of a node that ended in an orderly way after a signal.
_STOPPED = {128 + number: number.name for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
#: Lines of a link about a past outage, or at the end of a node: not a reason for the end.
_OF_THE_CONNECTION = re.compile(r" is back after [\d.]+ s$|: [a-z_]+ \d+(, [a-z_]+ \d+)*$")
#: Index of ``starttime`` in /proc/PID/stat, counted after the command name (proc(5), field 22).
_STARTTIME = 19


def process_name(role: str) -> str:
    """Name of a node's process, of which the kernel keeps 15 bytes."""
    return f"railhil {role}"[:15]


def process_start_ns() -> int:
    """Monotonic time at which this process was started (its start time is kept in 10 ms steps)."""
    fields = Path("/proc/self/stat").read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
    started_s = int(fields[_STARTTIME]) / os.sysconf("SC_CLK_TCK")
    age_s = time.clock_gettime(time.CLOCK_BOOTTIME) - started_s
    return time.monotonic_ns() - int(age_s * 1e9)


@dataclass(slots=True)
class Node:
    """A child process with its role and the file with its output."""

    role: str
    process: Process
    output: Path

    def exit_code(self) -> int | None:
        """Exit code, negative for a signal, None while it runs."""
        return self.process.poll()

    def last_words(self) -> str:
        """The signal that ended the node, or else its last line about the reason for its end."""
        code = self.process.poll()
        if code is not None and code < 0:
            return f"killed by {signal.Signals(-code).name}"
        if code in _STOPPED:
            return f"ended by {_STOPPED[code]}"
        lines = [line for line in self.output.read_text(errors="replace").splitlines() if line.strip()]
        reasons = [line for line in lines if not is_said(line) and not _OF_THE_CONNECTION.search(line)]
        return reasons[-1] if reasons else f"exit code {code}"

    @property
    def is_suspended(self) -> bool:
        """True while a signal (SIGSTOP, SIGTSTP) or a debugger keeps it from running; it then neither acts nor ends."""
        if self.exit_code() is not None:
            return False
        try:
            status = Path(f"/proc/{self.process.pid}/stat").read_text(encoding="ascii", errors="replace")
        except OSError:
            # It has just ended.
            return False
        return status.rpartition(")")[2].split()[0] in ("T", "t")

    @property
    def was_killed(self) -> bool:
        """True when a signal has ended it, caught or not: the others have then ended as a consequence."""
        code = self.exit_code() or 0
        return code < 0 or code in _STOPPED


def nodes_processor() -> tuple[int, set[int]]:
    """In lockstep: the processor of the nodes that this process starts, and the other processors (none: there is only
    one). The processor is chosen by the process number, so that several benches spread over the processors."""
    processors = sorted(os.sched_getaffinity(0))
    chosen = processors[os.getpid() % len(processors)]
    return chosen, set(processors) - {chosen}


class Nodes:
    """The child processes of one run; a context manager that leaves none behind."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.nodes: list[Node] = []
        # Write ends of the lifelines of nodes that are not started yet, and of the supervisor.
        self._lifelines: dict[str, int] = {}

    def start(
        self,
        role: str,
        module: str,
        arguments: Sequence[str],
        watches: Sequence[str] = (),
        inherits: Sequence[int] = (),
    ) -> Node:
        """Start ``python -P -m module arguments`` with its output in ``<role>.txt``.

        :param watches: this command (``supervisor``) and nodes started later; it notices their end at once.
        :param inherits: open descriptors that its arguments name.
        """
        output = self._folder / f"{role}.txt"
        # See common.patience.Lifelines: this node's own write end, and the read ends of the processes that it watches.
        handed = [self._lifelines.pop(role)] if role in self._lifelines else []
        words = []
        for other in watches:
            reading, self._lifelines[other] = os.pipe()
            handed.append(reading)
            words += ["--lifeline", f"{other}={reading}"]
        try:
            process = start_module(process_name(role), module, [*arguments, *words], output, [*handed, *inherits])
        finally:
            for end in handed:
                os.close(end)
        node = Node(role, process, output)
        self.nodes.append(node)
        return node

    def keep_together(self) -> None:
        """Put hub, plant and controller on one processor.

        In lockstep only one of the three works at a time, so nothing is lost; switching between processors that have
        gone to sleep would cost more than the work itself. The supervisor works beside them on another processor, if
        there is one.
        """
        chosen, others = nodes_processor()
        if not others:
            return
        for node in self.nodes:
            # The end of a node is detected elsewhere.
            with contextlib.suppress(ProcessLookupError):
                os.sched_setaffinity(node.process.pid, {chosen})

    def list_ended(self) -> list[Node]:
        """Nodes that have ended."""
        return [node for node in self.nodes if node.exit_code() is not None]

    def failed_node(self) -> Node | None:
        """The node that probably caused the end of the others: a killed one first, the hub before all others."""
        roles = ("hub", "plant", "controller")
        return min(self.list_ended(), key=lambda node: (not node.was_killed, roles.index(node.role)), default=None)

    def find_suspended(self) -> str:
        """Role of a node that is suspended, the hub before all others; empty if none is."""
        return next((node.role for node in self.nodes if node.is_suspended), "")

    def wait(self, roles: Sequence[str], timeout_s: float) -> bool:
        """Wait until the nodes of these roles have ended; False after the time-out, and when one is suspended, which
        cannot end by itself."""
        deadline_s = time.monotonic() + timeout_s
        for node in self.nodes:
            if node.role in roles:
                if node.is_suspended:
                    return False
                try:
                    node.process.wait(max(0.0, deadline_s - time.monotonic()))
                except subprocess.TimeoutExpired:
                    return False
        return True

    def __enter__(self) -> Nodes:
        return self

    def __exit__(self, *_: object) -> None:
        running = [node for node in self.nodes if node.exit_code() is None]
        for node in running:
            node.process.terminate()
            # A suspended process takes the signal only when it continues.
            node.process.send_signal(signal.SIGCONT)
        deadline_s = time.monotonic() + TERMINATE_S
        for node in running:
            try:
                node.process.wait(max(0.0, deadline_s - time.monotonic()))
            except subprocess.TimeoutExpired:
                node.process.kill()
                node.process.wait()
        while self._lifelines:
            os.close(self._lifelines.popitem()[1])
