"""Soak: the same run again and again in one process, which must not grow and must give the same record each time.

``python -m hil_tests.soak --runs 200`` prints memory, descriptors, threads and hash; exit code 1 if anything grew or
the last hash is not the first. ``--hub-runs N`` adds runs over the hub, with the plant and the controller in processes
of their own.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hil_tests.fuzz import resident_bytes
from railhil.bench import unrecorded_run
from railhil.common import exit_codes
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec

#: Growth after the first tenth of the runs that is not a leak: the allocator's arenas.
GROWTH_MAX_BYTES = 4 << 20


@dataclass(frozen=True)
class State:
    """What one run leaves behind: the hash of its record, resident memory, open descriptors, threads, children."""

    frames_sha256: str
    resident_bytes: int
    descriptors: int
    threads: int
    children: int


def state_after(frames_sha256: str) -> State:
    """State of this process now."""
    gc.collect()
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text("ascii").split()
    return State(
        frames_sha256,
        resident_bytes(),
        len(os.listdir("/proc/self/fd")),
        len(os.listdir("/proc/self/task")),
        len(children),
    )


def soaked(run: Callable[[], str], runs: int) -> list[State]:
    """The state after each of the runs, which return the hash of their record."""
    return [state_after(run()) for _ in range(runs)]


def growth(states: list[State]) -> list[str]:
    """What grew or differs after the first tenth of the runs, in which caches fill; empty: nothing."""
    first, last = states[max(len(states) // 10, 1) - 1], states[-1]
    found = []
    if len({state.frames_sha256 for state in states}) != 1:
        found.append("the records differ")
    for name in ("descriptors", "threads", "children"):
        if getattr(last, name) > getattr(first, name):
            found.append(f"{name}: {getattr(first, name)}, then {getattr(last, name)}")
    if last.resident_bytes - first.resident_bytes > GROWTH_MAX_BYTES:
        found.append(f"memory grew by {(last.resident_bytes - first.resident_bytes) / 1e6:.1f} MB")
    return found


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0: nothing grew."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.soak", description=__doc__)
    parser.add_argument("--runs", type=int, default=200, help="in this process, without a bus")
    parser.add_argument("--hub-runs", type=int, default=0, help="with plant and controller in their own processes")
    parser.add_argument("--scenario", default="lvshun_tieshan")
    given = parser.parse_args(arguments)
    scenario = load(given.scenario)
    good = True
    for name, count, run in (
        ("in process", given.runs, lambda: unrecorded_run(scenario, RunSpec(seed=1)).frames_sha256),
        ("over the bus", given.hub_runs, lambda: hub_run(given.scenario)),
    ):
        if not count:
            continue
        states = soaked(run, count)
        last = states[-1]
        print(
            f"{name}: {count} runs, {last.resident_bytes / 1e6:.1f} MB "
            f"({(last.resident_bytes - states[max(count // 10, 1) - 1].resident_bytes) / 1e6:+.2f} MB after the first "
            f"tenth), {last.descriptors} descriptors, {last.threads} threads, {last.children} children, "
            f"sha256 {last.frames_sha256[:16]}"
        )
        for line in growth(states):
            print(f"FAIL: {line}")
            good = False
    return exit_codes.PASS if good else exit_codes.FAIL


def hub_run(scenario: str) -> str:
    """One run over a bus; the hash of its record."""
    import railhil

    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        return railhil.run(scenario, seed=1, bus="auto", out=folder + "/run").frames_sha256


if __name__ == "__main__":
    sys.exit(main())
