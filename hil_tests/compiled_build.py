"""Hashes of every law with the compiled build and without it: ``python -m hil_tests.compiled_build [WORD ...]``

Builds the wheel with mypyc (gcc; some minutes), unpacks it beside this environment's libraries, makes the runs of
:mod:`hil_tests.hashes` with it, and those of :mod:`hil_tests.uses` with it and with these sources; a line that differs
from the list of hashes, or from what these sources say, is printed and fails. ``RAILHIL_PURE=1`` is tried with it, a
campaign in two processes, which pass compiled objects to each other, and whether ``railhil doctor`` and certificates
say which build it is. The words are those of :mod:`hil_tests.hashes` (a group, ``--sample N --day DAY``); without one
all runs are made, and ``uses`` alone leaves out the runs.

Exit code: 0 if all lines are equal, 1 if not; 77 without a compiler (one line says why).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path
from subprocess import PIPE, Popen

from hil_tests import uses
from hil_tests.machines import tools
from hil_tests.support.same_lines import HASHES, USES, compare_hashes, compare_lines, wheel
from hil_tests.support.toy_system import certificate, install_toy
from railhil.machines import debian

_BUILD = "import railhil.common.build as build; print(build.railhil_build())"
_RAILHIL = "import sys; from railhil.cli import main; sys.exit(main())"
_CAMPAIGN_WORDS = ["campaign", "yizhuang_05", "--runs", "6", "--laws", "ipfc", "--arithmetic", "float64", "--json"]


class _Environment:
    """This environment's libraries with the compiled railhil before them."""

    def __init__(self, site: Path, *others: Path) -> None:
        # A path file of its own would come after the checkout's.
        self._variables = {**os.environ, "PYTHONPATH": _path(site, *others, Path(sysconfig.get_path("purelib")))}

    def start(self, words: list[str], cwd: Path, **variables: str) -> Popen[str]:
        return Popen([sys.executable, *words], env={**self._variables, **variables}, cwd=cwd, stdout=PIPE, text=True)

    def said(self, words: list[str], cwd: Path, **variables: str) -> str:
        with self.start(words, cwd, **variables) as process:
            text, _ = process.communicate(timeout=600)
        # A run that misses the limits of its scenario is a run.
        if process.returncode not in (0, 1):
            raise debian.MachineError(f"{' '.join(words[2:])} ended with {process.returncode}")
        return text.strip()


def _path(*folders: Path) -> str:
    return os.pathsep.join(map(str, folders))


def compared(words: list[str]) -> int:
    """Build, run and compare; returns the exit code.

    Raises:
        CapabilityError: there is no compiler.
    """
    tools.install_compilers()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        debian.say("compiled build: mypyc and gcc, some minutes")
        with zipfile.ZipFile(wheel(folder / "wheel", {"RAILHIL_COMPILED": "1"})) as archive:
            archive.extractall(folder / "site")
        toy, law = install_toy(folder / "toy"), uses.written(folder / "law")
        environment = _Environment(folder / "site", toy, law)
        wrong = int(not _tells(environment, folder)) + int(not _is_one_campaign(environment, folder))
        here = {**os.environ, "PYTHONPATH": _path(toy, law)}
        ours = Popen([sys.executable, USES], env=here, stdout=PIPE, text=True)
        wrong += compare_lines(environment.start([USES], folder), ours, "compiled")
        if words != ["uses"]:
            # The list knows the shipped laws alone.
            runs = _Environment(folder / "site").start([HASHES, *words], folder)
            wrong += compare_hashes(runs, "compiled", "--sample" in words)
    return 1 if wrong else 0


def _tells(environment: _Environment, folder: Path) -> bool:
    """Whether each of the two builds says in doctor and certificate which one it is."""
    builds: list[list[str]] = []
    for variables in ({}, {"RAILHIL_PURE": "1"}):
        run = folder / f"run{len(builds)}"
        doctor = json.loads(environment.said(["-c", _RAILHIL, "doctor", "--quick", "--json"], folder, **variables))
        words = ["run", "yizhuang_05", "--bus", "local", "--no-report", "--quiet", "--out", str(run)]
        environment.said(["-c", _RAILHIL, *words], folder, **variables)
        machine = certificate(run)["machine"]
        assert isinstance(machine, dict)
        said = [environment.said(["-c", _BUILD], folder, **variables), machine["railhil_build"]]
        builds.append([*said, doctor["railhil"].rpartition(", ")[2]])
    print(f"build, certificate, doctor: {' '.join(builds[0])}; with RAILHIL_PURE=1: {' '.join(builds[1])}")
    return builds == [["compiled"] * 3, ["pure"] * 3]


def _is_one_campaign(environment: _Environment, folder: Path) -> bool:
    """Whether a campaign gives the same in the batch and in two processes."""
    options = ("--out", "batch"), ("--out", "processes", "--engine", "processes", "--jobs", "2")
    laws = [
        json.loads(environment.said(["-c", _RAILHIL, *_CAMPAIGN_WORDS, *words], folder))["laws"] for words in options
    ]
    print(f"campaign in the batch and in two processes: {'equal' if laws[0] == laws[1] else 'different'}")
    return bool(laws[0] == laws[1])


def main(words: list[str]) -> int:
    """As :func:`compared`; a build that fails is one line."""
    try:
        return compared(words)
    except subprocess.SubprocessError as error:
        debian.say(f"compiled build: {error}")
        return 1


if __name__ == "__main__":
    sys.exit(debian.guarded("compiled build", lambda: main(sys.argv[1:])))
