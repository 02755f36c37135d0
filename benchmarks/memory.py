"""Memory of the processes of a run, from its start to the last file that the supervisor writes."""

from __future__ import annotations

import time
from pathlib import Path

import psutil

from benchmarks.figures import Figure, MeasurementError, Setting
from benchmarks.processes import RunCommand
from railhil.supervisor.processes import process_name

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
