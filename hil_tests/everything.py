"""All tests, with every capability brought up that this machine can have: ``python -m hil_tests.everything [PART]``.

Parts: ``anywhere`` (with gcc, clang and Chromium installed where they are missing); ``vcan``, kernel SocketCAN (the
host's in a network namespace, else that of a throw-away virtual machine); ``compose``, a Docker engine (the host's,
else a private one), then one on a kernel with CAN. A capability that cannot be had is said loudly; with
``RAILHIL_REQUIRE_ALL=1`` it is a failure, so that continuous integration never skips silently.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bus.exitcodes import guarded
from bus.usage import OneLineParser
from hil_tests.machines import debian

_ROOT = Path(__file__).resolve().parent.parent
#: Exit code of the machines when this host cannot have the capability.
_NO_CAPABILITY = 77
_PYTEST = [sys.executable, "-m", "pytest", "-q"]
_ANYWHERE = "not needs_socketcan and not needs_docker"


@dataclass(frozen=True, slots=True)
class Part:
    """One part: what it needs, and the command."""

    key: str
    name: str
    command: list[str]
    #: What is to be installed for it, by the name of what goes missing without.
    tools: dict[str, Callable[[], None]] = field(default_factory=dict)

    def run(self) -> int:
        """Run and return the exit code."""
        print(f"\n=== {self.name} ===", flush=True)
        started_s = time.monotonic()
        code = subprocess.run(self.command, cwd=_ROOT, check=False).returncode
        print(f"=== {self.name}: exit code {code} after {time.monotonic() - started_s:.0f} s ===", flush=True)
        return code


def parts() -> list[Part]:
    """The parts, in order; the machines wrap their pytest."""
    machine = [sys.executable, "-m"]
    # A file at a time on each core: what a module's tests share is made once.
    side_by_side = ["-n", str(len(os.sched_getaffinity(0))), "--dist", "loadfile"]
    # Named by folder: collecting all modules takes minutes in an emulated machine.
    vcan = [*_PYTEST, "-p", "no:cacheprovider", "-m", "needs_socketcan", "hil_tests/vcan"]
    vcan = [*machine, "hil_tests.machines.vcan", "--timeout", "1500", "--", *vcan]
    docker = [*machine, "hil_tests.machines.docker_engine", "--timeout", "1500", "--"]
    return [
        Part(
            "anywhere",
            "tests that run anywhere",
            [*_PYTEST, *side_by_side, "-m", f"{_ANYWHERE} and not wall_clock"],
            {"exported C": debian.install_compilers, "report in a browser": debian.install_browser},
        ),
        Part("anywhere", "tests in real time, alone", [*_PYTEST, "-m", f"{_ANYWHERE} and wall_clock"]),
        Part(
            "vcan",
            "kernel SocketCAN",
            vcan,
            {"CAN tools": debian.install_can_tools, "compilers": debian.install_compilers},
        ),
        Part("compose", "Docker", [*docker, *_PYTEST, "-m", "needs_docker", "hil_tests/compose"]),
        Part("compose", "Docker on kernel CAN", [*machine, "hil_tests.compose.vcan_runs"]),
    ]


def _install_tools(chosen: Sequence[Part]) -> list[str]:
    """Have what the parts need; names of what could not be had."""
    missing = []
    for name, install in [item for part in chosen for item in part.tools.items()]:
        try:
            install()
        except (debian.CapabilityError, debian.MachineError) as error:
            debian.say(f"{name}: {error}")
            missing.append(name)
    return missing


def main() -> int:
    """Run all parts, or those named; 0 when everything that could run passed and nothing that must run was missing."""
    parser = OneLineParser(prog="python -m hil_tests.everything", epilog=None)
    every = parts()
    keys = list(dict.fromkeys(part.key for part in every))
    parser.add_argument("part", nargs="*", metavar="PART", help=f"{', '.join(keys)}; default: all")
    wanted = parser.parse_args().part
    for name in wanted:
        if name not in keys:
            parser.error(f"found {name!r}, allowed: {', '.join(keys)}")
    chosen = [part for part in every if part.key in wanted or not wanted]
    failed: list[str] = []
    missing = _install_tools(chosen)
    for part in chosen:
        code = part.run()
        if code == _NO_CAPABILITY:
            missing.append(part.name)
        elif code != 0:
            failed.append(part.name)
    for name in missing:
        print(f"MISSING CAPABILITY: {name}: its tests did NOT run on this machine", flush=True)
    for name in failed:
        print(f"FAILED: {name}", flush=True)
    passed = len([part for part in chosen if part.name not in (*failed, *missing)])
    print(f"{passed} passed, {len(failed)} failed, {len(missing)} skipped", flush=True)
    return 1 if failed or (missing and os.environ.get("RAILHIL_REQUIRE_ALL")) else 0


if __name__ == "__main__":
    sys.exit(guarded("hil_tests.everything", main))
