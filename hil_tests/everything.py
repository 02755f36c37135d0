"""All tests, with every capability brought up that this machine can have: ``python -m hil_tests.everything [PART]``.

Parts: ``anywhere`` (with gcc, clang and Chromium installed where they are missing); ``vcan``, kernel SocketCAN (the
host's in a network namespace, else that of a throw-away virtual machine); ``compose``, a Docker engine (the host's,
else a private one), then one on a kernel with CAN. Where there are two cores, the last two run side by side.

A capability that cannot be had is said loudly; with ``RAILHIL_REQUIRE_ALL=1`` it is a failure, so that continuous
integration never skips silently.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence

from hil_tests import parts as running
from hil_tests.parts import Part
from railhil.common.command_line import OneLineParser
from railhil.common.exit_codes import guarded
from railhil.machines import debian

#: Exit code of the machines when this host cannot have the capability.
_NO_CAPABILITY = 77
_PYTEST = [sys.executable, "-m", "pytest", "-q"]
_ANYWHERE = "not needs_socketcan and not needs_docker"


def parts() -> list[Part]:
    """The parts, in order; the machines wrap their pytest."""
    machine = [sys.executable, "-m"]
    # A file at a time on each core: what a module's tests share is made once.
    side_by_side = ["-n", str(len(os.sched_getaffinity(0))), "--dist", "loadfile"]
    docker = [*machine, "railhil.machines.docker_engine", "--timeout", "1500", "--"]
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
            [*machine, "hil_tests.transport.vcan"],
            {"CAN tools": debian.install_can_tools, "compilers": debian.install_compilers},
            beside=True,
        ),
        Part(
            "compose", "Docker", [*docker, *_PYTEST, "-m", "needs_docker", "hil_tests/transport/compose"], beside=True
        ),
        Part("compose", "Docker on kernel CAN", [*machine, "hil_tests.transport.compose.vcan_runs"], beside=True),
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


def main(
    words: Sequence[str] | None = None,
    suite: Sequence[Part] | None = None,
    run: Callable[[Sequence[Part]], list[int]] = running.run,
) -> int:
    """Run all parts, or those named; 0 when everything that could run passed and nothing that must run was missing.

    Args:
        words: the command line; None: this process's own.
        suite: the parts there are; None: those of :func:`parts`.
        run: runs parts and returns their exit codes.
    """
    parser = OneLineParser(prog="python -m hil_tests.everything", epilog=None)
    every = parts() if suite is None else list(suite)
    keys = list(dict.fromkeys(part.key for part in every))
    parser.add_argument("part", nargs="*", metavar="PART", help=f"{', '.join(keys)}; default: all")
    wanted = parser.parse_args(words).part
    for name in wanted:
        if name not in keys:
            parser.error(f"found {name!r}, allowed: {', '.join(keys)}")
    chosen = [part for part in every if part.key in wanted or not wanted]
    failed: list[str] = []
    missing = _install_tools(chosen)
    for part, code in zip(chosen, run(chosen), strict=True):
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
