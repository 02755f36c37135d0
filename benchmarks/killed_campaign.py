"""``python -m benchmarks.killed_campaign``: a campaign killed again and again ends as an undisturbed one."""

from __future__ import annotations

import argparse
import hashlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.figures import MeasurementError
from benchmarks.processes import last_line
from railhil.common.exit_codes import run_guarded

#: Parts of a campaign in its folder.
_PARTS = "parts/*.parquet"
_LOOK_S = 0.01


@dataclass(frozen=True, slots=True)
class Killed:
    """Log of the kills: parts on the disk at each SIGKILL, and the SHA-256 of both results."""

    parts_at_kill: list[int]
    parts: int
    undisturbed_sha256: str
    resumed_sha256: str

    @property
    def same(self) -> bool:
        """True if the results have the same bytes."""
        return self.undisturbed_sha256 == self.resumed_sha256


def _campaign(words: Sequence[str]) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "railhil.cli", "campaign", *words]
    # A group of its own: its workers are killed with it.
    return subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True
    )


def _finished(words: Sequence[str], folder: Path) -> str:
    """Hash of the results of a campaign that is left alone from here on."""
    process = _campaign(words)
    _, said = process.communicate()
    if process.returncode:
        last = last_line(said.decode(errors="replace"))
        raise MeasurementError(f"campaign in {folder}: exit code {process.returncode}: {last}")
    return hashlib.sha256((folder / "results.parquet").read_bytes()).hexdigest()


def _kill_after(words: Sequence[str], folder: Path, delay_s: float, at_work: bool) -> bool:
    """Kill the campaign after ``delay_s``; False if it had ended by then.

    :param at_work: the delay counts from its first new part, else from its start.
    """
    process = _campaign(words)
    assert process.stderr is not None
    with process.stderr:
        before = _parts(folder)
        while at_work and process.poll() is None and _parts(folder) == before:
            time.sleep(_LOOK_S)
        try:
            process.wait(delay_s)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return True
    return False


def _parts(folder: Path) -> int:
    return sum(1 for _ in folder.glob(_PARTS))


def measure(folder: Path, words: Sequence[str], kills: int, longest_s: float, seed: int = 0) -> Killed:
    """Make a campaign twice, once killed at random instants.

    :param words: options of ``railhil campaign`` (``--runs``, ``--engine``, ...).
    :param kills: number of kills; fewer if the campaign ends before.
    :param longest_s: a kill comes this long after the start, or after the first new part, at most.
    :raises MeasurementError: a campaign that was not killed did not end with exit code 0.
    """
    alone, killed = folder / "undisturbed", folder / "killed"
    wanted = _finished([*words, "--out", str(alone)], alone)
    draw = random.Random(seed)
    at_kill: list[int] = []
    again = [*words, "--out", str(killed)]
    # The delay counts in turns from its first new part and from its start.
    while len(at_kill) < kills and _kill_after(again, killed, draw.uniform(0.0, longest_s), len(at_kill) % 2 == 0):
        at_kill.append(_parts(killed))
    resumed = _finished(again, killed)
    return Killed(at_kill, _parts(killed), wanted, resumed)


def work(arguments: Sequence[str] | None = None) -> int:
    """The command: exit code 0 for the same bytes, else 1."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.killed_campaign", description=__doc__)
    parser.add_argument("--runs", type=int, default=100_000, help="runs of the campaign (default %(default)s)")
    parser.add_argument("--kills", type=int, default=8, help="times it is killed (default %(default)s)")
    parser.add_argument("--longest", type=float, default=4.0, metavar="S", help="a kill comes after 0 to S seconds")
    parser.add_argument("--seed", type=int, default=0, help="of the instants (default %(default)s)")
    options, rest = parser.parse_known_args(arguments)
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        words = ["--runs", str(options.runs), *rest]
        found = measure(Path(folder), words, options.kills, options.longest, options.seed)
    print(f"{options.runs} runs, killed by SIGKILL {len(found.parts_at_kill)} times")
    print(f"parts there at each kill: {', '.join(map(str, found.parts_at_kill)) or 'none'}, at the end: {found.parts}")
    print(f"results.parquet undisturbed       {found.undisturbed_sha256}")
    print(f"results.parquet killed, resumed   {found.resumed_sha256}")
    print("same bytes" if found.same else "OTHER BYTES")
    return 0 if found.same else 1


if __name__ == "__main__":
    sys.exit(run_guarded("benchmarks.killed_campaign", work))
