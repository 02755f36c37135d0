"""Memory of the processes of a run, from its start to the last file that the supervisor writes."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

from benchmarks.figures import Figure, MeasurementError, Setting
from benchmarks.processes import RunCommand
from railhil.live.processes import process_name

TITLE = "memory"
METHOD = (
    "Largest proportional set (Pss of the kernel: each page in RAM divided by the number of processes that have it; "
    "nodes are forked, so their resident sets count the pages of the supervisor again) of each process of one "
    "`railhil run`, read every 20 ms until the command ends; MB = 10^6 bytes."
)
LIMIT_MB = 150.0
_LOOK_S = 0.02
_ROLES = ("hub", "plant", "controller")


def share_mb(pid: int) -> float:
    """Memory in MB of a process, each page divided by the number of processes that have it; 0 when it has ended."""
    try:
        rollup = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii", errors="replace")
    except (FileNotFoundError, ProcessLookupError):
        return 0.0
    return sum(int(line.split()[1]) for line in rollup.splitlines() if line.startswith("Pss:")) * 1024 / 1e6


@dataclass(frozen=True, slots=True)
class Peak:
    """The largest memory that all processes of a command had at one time.

    :param parts: name and memory in MB of each process.
    """

    parts: tuple[tuple[str, float], ...] = ()

    @property
    def total_mb(self) -> float:
        """Memory of all of them in MB, pages that they share counted once."""
        return sum(part_mb for _, part_mb in self.parts)


def peak_of(process: subprocess.Popen[Any], patience_s: float) -> Peak:
    """Wait for the end of a command and read every 20 ms the memory of it and its descendants.

    :returns: the peak, the largest process first.
    :raises MeasurementError: it does not end within ``patience_s``.
    """
    command = psutil.Process(process.pid)
    deadline_s = time.monotonic() + patience_s
    peak = Peak()
    while process.poll() is None:
        if time.monotonic() > deadline_s:
            raise MeasurementError(f"the command did not end within {patience_s:g} s")
        peak = max(peak, Peak(tuple(_parts(command))), key=lambda each: each.total_mb)
        time.sleep(_LOOK_S)
    return Peak(tuple(sorted(peak.parts, key=lambda part: -part[1])))


def _parts(command: psutil.Process) -> Iterator[tuple[str, float]]:
    """Name and memory of a command and its descendants; one that ends meanwhile is left out."""
    with suppress(psutil.NoSuchProcess):
        for one in (command, *command.children(recursive=True)):
            with suppress(psutil.NoSuchProcess):
                yield _name(one), share_mb(one.pid)


def _name(process: psutil.Process) -> str:
    """The module of a ``python -m MODULE``, else the name of the process."""
    words, name = process.cmdline(), process.name()
    is_module = words[1:2] == ["-m"] and not name.startswith("railhil")
    return words[2] if is_module else name


def _role(process: psutil.Process) -> str | None:
    """Role of a child of the command; None before it has become one of the nodes."""
    try:
        name = process.name()
    except psutil.Error:
        return None
    return next((role for role in _ROLES if process_name(role) == name), None)


def measure(setting: Setting) -> list[Figure]:
    """One figure per process.

    :raises MeasurementError: the run failed, or a process was never found.
    """
    peaks_mb = dict.fromkeys(("hub", "plant", "controller", "supervisor"), 0.0)
    with RunCommand(setting, "iq", setting.folder / "memory") as running:
        pids = {"supervisor": running.process.pid}
        command = psutil.Process(running.process.pid)
        while running.process.poll() is None:
            if len(pids) < len(peaks_mb):
                for child in command.children():
                    role = _role(child)
                    if role is not None:
                        pids[role] = child.pid
            for role, pid in pids.items():
                peaks_mb[role] = max(peaks_mb[role], share_mb(pid))
            time.sleep(_LOOK_S)
        running.finish()
    unseen = [role for role, peak in peaks_mb.items() if peak == 0]
    if unseen:
        raise MeasurementError(f"memory: no sight of {', '.join(unseen)}")
    return [
        Figure(f"{role}: peak proportional set", peak, "MB", peak / LIMIT_MB, f"to the limit of {LIMIT_MB:g} MB")
        for role, peak in peaks_mb.items()
    ]
