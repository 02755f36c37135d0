"""``python -m benchmarks.against WHAT ...``: this version and others, the same run in turns, each as its own default.

WHAT is a commit of this repository, a folder with a railhil (a clone, an unpacked archive), or the Python of an
environment in which one is installed, such as an older version or a compiled build.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

from benchmarks.counting import counting
from benchmarks.figures import FULL_SCENARIO, MeasurementError, Setting, median
from benchmarks.machine import cpu_model, far_read_ns
from benchmarks.memory import Peak, peak_of
from benchmarks.processes import end, last_line
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, PASS, run_guarded

_TOP = Path(__file__).resolve().parents[1]
#: Options that the command omits for a version without them.
_WISHED = ("--quiet", "--no-report")
_PATIENCE_S = 300.0
#: Prints how the other Python and its railhil were built; an older railhil has no such information.
_DESCRIBE = """\
import platform, sysconfig
from importlib.util import find_spec
flags = sysconfig.get_config_var("CONFIG_ARGS") or ""
pgo = "PGO," if "--enable-optimizations" in flags else "no PGO,"
lto = "LTO" if "--with-lto" in flags else "no LTO"
if "--enable-shared" in flags and "/libpython" not in open("/proc/self/maps").read():
    # Debian: the configuration is that of another build.
    pgo, lto = "PGO and", "LTO not told"
store = find_spec("railhil.bus.store")
build = "pure" if store is None or store.origin.endswith(".py") else "compiled"
print(f"{platform.python_implementation()} {platform.python_version()} ({pgo} {lto}), railhil {build}")
"""


@dataclass(slots=True)
class Version:
    """One railhil to measure, and its measurements.

    ``factors``: simulated seconds per wall second of each run. ``rest_s``: wall time of each command before its
    first frame and after its last one. ``cpu_s``: processor time of each command with all its processes.
    ``score_s``: wall time of ``railhil score`` of each run. ``peaks``: memory of each run that was made for it.
    """

    name: str
    python: str
    environment: dict[str, str]
    build: str = ""
    options: list[str] = field(default_factory=list)
    factors: list[float] = field(default_factory=list)
    rest_s: list[float] = field(default_factory=list)
    cpu_s: list[float] = field(default_factory=list)
    score_s: list[float] = field(default_factory=list)
    peaks: list[Peak] = field(default_factory=list)
    transports: set[str] = field(default_factory=set)
    hashes: set[str] = field(default_factory=set)


def _unpacked(commit: str, folder: Path) -> Path:
    """The tree of a commit below ``folder``.

    :raises InputError: there is no such commit.
    """
    found = subprocess.run(["git", "-C", str(_TOP), "archive", commit], capture_output=True, check=False)
    if found.returncode:
        raise InputError("command line", "WHAT", commit, "a commit, a folder with a railhil, or a Python")
    target = folder / "trees" / commit.replace("/", "_")
    target.mkdir(parents=True)
    subprocess.run(["tar", "-x", "-C", str(target)], input=found.stdout, check=True)
    return target


def _importable(tree: Path, folder: Path) -> str:
    """PYTHONPATH of a tree, with the entry points (laws, bus, systems) that its installation would have."""
    project = tomllib.loads((tree / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    info = folder / "entry_points" / tree.name / f"railhil-{project['version']}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: railhil\nVersion: {project['version']}\n")
    lines = []
    for group, points in project.get("entry-points", {}).items():
        lines += [f"[{group}]", *(f"{name} = {value}" for name, value in points.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    return os.pathsep.join((str(info.parent), str(tree)))


def version_of(what: str, folder: Path) -> Version:
    """The version that a word of the command line names.

    :param folder: for unpacked trees.
    :raises InputError: it is neither a commit nor a folder with a railhil nor a Python.
    """
    path = Path(what)
    if path.is_file() and os.access(path, os.X_OK):
        # Not resolved: the Python of an environment is a link.
        return Version(what, str(path.absolute()), {})
    if path.is_dir() and not (path / "pyproject.toml").is_file():
        raise InputError("command line", "WHAT", what, "a folder with a railhil and its pyproject.toml")
    tree = path.resolve() if path.is_dir() else _unpacked(what, folder)
    return Version(what, sys.executable, {"PYTHONPATH": _importable(tree, folder)})


def _environment(version: Version) -> dict[str, str]:
    # Neither the folder of this repository nor its PYTHONPATH may decide which railhil is imported.
    return {**{key: value for key, value in os.environ.items() if key != "PYTHONPATH"}, **version.environment}


def _asked(version: Version, words: Sequence[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [version.python, *words],
        cwd=folder,
        env=_environment(version),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=_PATIENCE_S,
        check=False,
    )


def describe(version: Version, folder: Path) -> None:
    """Fill in how it was built, and which of the wished options its command has.

    :raises MeasurementError: it does not start.
    """
    told = _asked(version, ["-c", _DESCRIBE], folder)
    usage = _asked(version, ["-m", "railhil.cli", "run", "--help"], folder)
    for done in (told, usage):
        if done.returncode:
            raise MeasurementError(f"{version.name}: {last_line(done.stderr)}")
    version.build = told.stdout.strip()
    version.options = [option for option in _WISHED if option in usage.stdout]


def run_once(version: Version, scenario: str, out: Path) -> None:
    """One run of it into the folder ``out``, and its score once more from the log, added to its measurements.

    :raises MeasurementError: no verdict, or no speed in its score.
    """
    before, start_s = os.times(), perf_counter()
    done = _asked(version, _run_words(version, scenario, out), out.parent)
    taken_s, after = perf_counter() - start_s, os.times()
    factor, loop_s = _recorded(version, out, done.returncode, done.stderr or done.stdout)
    version.factors.append(factor)
    version.rest_s.append(taken_s - loop_s)
    version.cpu_s.append(after.children_user + after.children_system - before.children_user - before.children_system)
    start_s = perf_counter()
    scored = _asked(version, ["-m", "railhil.cli", "score", str(out)], out.parent)
    version.score_s.append(perf_counter() - start_s)
    _demand_verdict(version, scored.returncode, scored.stderr or scored.stdout)


def weigh_once(version: Version, scenario: str, out: Path) -> None:
    """One more run of it, for its memory alone, because reading the memory slows the run down.

    :raises MeasurementError: as :func:`run_once`.
    """
    with (out.parent / f"{out.name}.txt").open("w+", encoding="utf-8") as said:
        process = subprocess.Popen(
            [version.python, *_run_words(version, scenario, out)],
            cwd=out.parent,
            env=_environment(version),
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=said,
        )
        try:
            peak = peak_of(process, _PATIENCE_S)
        finally:
            end(process)
        said.seek(0)
        _recorded(version, out, process.returncode, said.read())
    version.peaks.append(peak)


def _run_words(version: Version, scenario: str, out: Path) -> list[str]:
    return ["-m", "railhil.cli", "run", scenario, "--out", str(out), *version.options]


def _demand_verdict(version: Version, exit_code: int, said: str) -> None:
    """Refuse a command that has ended without a verdict; ``said``: its output.

    :raises MeasurementError: with the last line of that.
    """
    if exit_code not in (PASS, FAIL):
        raise MeasurementError(f"{version.name}: exit code {exit_code}: {last_line(said)}")


def _recorded(version: Version, out: Path, exit_code: int, said: str) -> tuple[float, float]:
    """Speed factor of a run and the wall time it was taken from, in s; other values from its folder are added to its
    measurements.

    :raises MeasurementError: as :func:`run_once`.
    """
    _demand_verdict(version, exit_code, said)
    run = json.loads((out / "score.json").read_text(encoding="utf-8")).get("run", {})
    if "speed_factor" not in run:
        raise MeasurementError(f"{version.name}: score.json has no speed factor")
    # The path of a hub's socket is another one in each run.
    transport, slash, _ = str(run.get("transport", "not in the score")).partition("/")
    version.transports.add(f"{transport}hub" if slash else transport)
    version.hashes.add(hashlib.sha256((out / "frames.log").read_bytes()).hexdigest())
    return float(run["speed_factor"]), float(run["wall_time_s"])


def _memory_lines(version: Version, here: Version) -> list[str]:
    """Lines on the memory of a version; none if no run was made for it."""
    if not version.peaks:
        return []
    totals_mb = [peak.total_mb for peak in version.peaks]
    largest = max(version.peaks, key=lambda peak: peak.total_mb)
    lines = [
        f"  memory     {median(totals_mb):.1f} MB, peak of all processes together, median of {len(totals_mb)} "
        f"({min(totals_mb):.1f} to {max(totals_mb):.1f})",
        f"  of it      {', '.join(f'{name} {part_mb:.1f}' for name, part_mb in largest.parts)}",
    ]
    if version is not here:
        ratio = median([peak.total_mb for peak in here.peaks]) / median(totals_mb)
        lines.append(f"  ratio      this version takes {ratio:.2f} times the memory, ratio of the medians")
    return lines


def _lines(versions: Sequence[Version]) -> list[str]:
    """Lines on all versions; the last one is this."""
    here = versions[-1]
    lines = []
    for version in versions:
        factor = median(version.factors)
        lines += [
            version.name,
            f"  build      {version.build}",
            f"  transport  {', '.join(sorted(version.transports))}",
            f"  factor     {factor:.1f} times real time, median of {len(version.factors)} "
            f"({min(version.factors):.1f} to {max(version.factors):.1f})",
            f"  start, end {_seconds(version.rest_s)}, before the first frame and after the last one together",
            f"  score      {_seconds(version.score_s)}, railhil score of the run",
            f"  processor  {_seconds(version.cpu_s)}, whole command",
            *(f"  frames.log {sha256}" for sha256 in sorted(version.hashes)),
        ]
        lines += _memory_lines(version, here)
        if version is not here:
            pairs = [now / was for now, was in zip(here.factors, version.factors, strict=True)]
            lines.append(
                f"  ratio      this version is {median(pairs):.2f} times as fast, median of the pairs "
                f"({min(pairs):.2f} to {max(pairs):.2f})"
            )
    return lines


def _seconds(taken_s: Sequence[float]) -> str:
    return f"{median(taken_s):.2f} s, median ({min(taken_s):.2f} to {max(taken_s):.2f})"


def _load() -> str:
    return ", ".join(f"{value:.2f}" for value in os.getloadavg())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.against", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", nargs="+", metavar="WHAT", help="commit, folder, or Python")
    parser.add_argument("--pairs", type=int, choices=range(1, 101), default=5, metavar="N", help="runs of each (5)")
    parser.add_argument("--memory", type=int, choices=range(101), default=1, metavar="N", help="more for memory (1)")
    parser.add_argument("--counting", type=int, choices=range(65), default=0, metavar="N", help="processes beside")
    parser.add_argument("--quick", action="store_true", help="a run of 8 s: a check, not a measurement")
    return parser


def work(arguments: Sequence[str] | None = None) -> int:
    """The command: exit code 0, 1 if a version had different frame logs of the same run."""
    options = _parser().parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="railhil-") as name:
        folder = Path(name)
        scenario = Setting.make(options.quick, folder).scenario_name
        here = Version("this version", sys.executable, {"PYTHONPATH": str(_TOP)})
        versions = [*(version_of(what, folder) for what in options.what), here]
        for version in versions:
            describe(version, folder)
        print(f"CPU        {cpu_model()}, {len(os.sched_getaffinity(0))} cores usable")
        print(f"run        {scenario if options.quick else FULL_SCENARIO}, {options.pairs} of each, in turns")
        print(f"beside     {options.counting} processes that only count")
        print(f"load       {_load()} (1, 5, 15 min) before")
        print(f"latency    {far_read_ns():.0f} ns for a read anywhere in 8 MB that depends on the one before")
        with counting(options.counting):
            for number in range(options.pairs):
                for index, version in enumerate(versions):
                    run_once(version, scenario, folder / f"run{index}-{number}")
            for number in range(options.memory):
                for index, version in enumerate(versions):
                    weigh_once(version, scenario, folder / f"memory{index}-{number}")
        print(f"load       {_load()} after", f"latency    {far_read_ns():.0f} ns after", *_lines(versions), sep="\n")
    unequal = [version.name for version in versions if len(version.hashes) > 1]
    for name in unequal:
        print(f"OTHER BYTES in the runs of {name}")
    return FAIL if unequal else PASS


if __name__ == "__main__":
    sys.exit(run_guarded("benchmarks.against", work))
