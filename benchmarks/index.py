"""The index of many run folders: time and memory of ``railhil runs`` and ``railhil query``."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.figures import Figure, MeasurementError, Setting
from railhil.judge.events.event import EVENTS
from railhil.record.documents import CERTIFICATE, SCORE
from railhil.record.framelog import sha256_of
from railhil.record.hash_list import HASH_LIST, listed_files

TITLE = "index of run folders"
METHOD = (
    "One run is recorded; folders with copies of its certificate, score, events and hashes, each with another seed and "
    "error, are indexed by commands of their own: `railhil runs` without an index, again with it, with one more "
    "folder, with the page, and `railhil query`. Processor time of the command with its start, which is the wall time "
    "of an idle machine; peak: largest resident set; MB = 10^6 bytes."
)
_FOLDERS, _FOLDERS_QUICK = 10_000, 50
_LAWS, _VERSIONS = ("ipfc", "ipfc_plus", "tpfc1"), ("0.1.0", "0.2.0", "0.2.0+gabc1234")
_STATEMENT = "select law, version, count(*), median(stop_error_m) from runs group by all order by all"


def write_copies(run: Path, out: Path, numbers: range) -> None:
    """Folders that differ in law, version, seed and stop error."""
    certificate, score = (json.loads((run / name).read_text(encoding="utf-8")) for name in (CERTIFICATE, SCORE))
    events = (run / EVENTS).read_bytes()
    for number in numbers:
        folder = out / f"{number // 100:03d}" / f"run{number:05d}"
        folder.mkdir(parents=True)
        law, version = _LAWS[number % len(_LAWS)], _VERSIONS[number // 7 % len(_VERSIONS)]
        own = {"seed": number, "controller": law, "railhil": version}
        (folder / CERTIFICATE).write_text(json.dumps(certificate | own), encoding="utf-8")
        score["scores"]["stop_error_m"] = 0.001 * (number % 300)
        (folder / SCORE).write_text(json.dumps(score), encoding="utf-8")
        (folder / EVENTS).write_bytes(events)
        # As hash_list writes it, without waiting for the disk 10 000 times.
        lines = (f"{sha256_of(folder / name)}  {name}\n" for name in listed_files(folder))
        (folder / HASH_LIST).write_text("".join(lines), encoding="utf-8")


def _timed(*words: str | Path) -> tuple[float, float, float]:
    """Processor and wall seconds and peak MB of a command. Raises MeasurementError."""
    begin_s = time.perf_counter()
    command = [sys.executable, "-m", "railhil.cli", *map(str, words)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise MeasurementError(f"index: {' '.join(command)} ended with {process.returncode}")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - begin_s, usage.ru_maxrss * 1024 / 1e6


def measure(setting: Setting) -> list[Figure]:
    """Times and peaks.

    :raises MeasurementError: a command failed.
    """
    root, run, count = setting.folder / "runs", setting.folder / "one", _FOLDERS_QUICK if setting.quick else _FOLDERS
    done = subprocess.run(
        [sys.executable, "-m", "railhil.cli", "run", setting.scenario_name, "--bus", "local", "--no-report", "--quiet",
         "--out", str(run)],
        stdout=subprocess.DEVNULL, check=False,
    )  # fmt: skip
    if done.returncode not in (0, 1):
        raise MeasurementError(f"index: the run ended with {done.returncode}")
    write_copies(run, root, range(count))
    found = {"made from nothing": _timed("runs", root), "nothing has changed": _timed("runs", root)}
    write_copies(run, root, range(count, count + 1))
    found["one more folder"] = _timed("runs", root)
    out = setting.folder / "index.html"
    found["with its page"] = _timed("runs", root, "--out", out)
    found["a query"] = _timed("query", _STATEMENT, root)
    size_mb = sum(one.stat().st_size for one in (root / ".railhil-index").iterdir()) / 1e6
    figures = [
        Figure(f"{count} folders: {name}", cpu_s, "s", spread={"wall": wall_s, "peak MB": peak_mb})
        for name, (cpu_s, wall_s, peak_mb) in found.items()
    ]
    return [
        *figures,
        Figure(f"{count} folders: size of the index", size_mb, "MB"),
        Figure(f"{count} folders: size of the page", out.stat().st_size / 1e6, "MB"),
    ]
