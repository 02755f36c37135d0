"""All tests, with every capability brought up that this machine can have: ``python -m hil_tests.everything``.

Three parts: what runs anywhere (with gcc, clang and Chromium installed where they are missing); kernel
SocketCAN (the host's vcan0, else a throw-away virtual machine); a Docker engine (the host's, else a private one). A
capability that cannot be had is said loudly; with ``RAILHIL_REQUIRE_ALL=1`` it is a failure, so that continuous
integration never skips silently.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from bus.select import vcan_available
from hil_tests.machines import debian

_ROOT = Path(__file__).resolve().parent.parent
#: Exit code of the machines when this host cannot have the capability.
_NO_CAPABILITY = 77
_PYTEST = [sys.executable, "-m", "pytest", "-q"]


@dataclass(frozen=True, slots=True)
class Part:
    """One part: what it needs, and the command."""

    name: str
    command: list[str]

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
    # Named by file: collecting all modules takes minutes in an emulated machine.
    vcan = [*_PYTEST, "-p", "no:cacheprovider", "-m", "needs_socketcan", "hil_tests/test_vcan.py"]
    if not (vcan_available() and vcan_available("vcan1")):
        vcan = [*machine, "hil_tests.machines.vcan_vm", "--timeout", "1500", "--", *vcan]
    docker = [*machine, "hil_tests.machines.docker_engine", "--timeout", "1500", "--"]
    return [
        Part("tests that run anywhere", [*_PYTEST, "-m", "not needs_socketcan and not needs_docker"]),
        Part("kernel SocketCAN", vcan),
        Part("Docker", [*docker, *_PYTEST, "-m", "needs_docker", "hil_tests/test_compose.py"]),
    ]


def main() -> int:
    """Run all parts; 0 when everything that could run passed and nothing that must run was missing."""
    failed, missing = [], []
    for name, install in (("exported C", debian.install_compilers), ("report in a browser", debian.install_browser)):
        try:
            install()
        except (debian.CapabilityError, debian.MachineError) as error:
            debian.say(f"{name}: {error}")
            missing.append(name)
    everything = parts()
    for part in everything:
        code = part.run()
        if code == _NO_CAPABILITY:
            missing.append(part.name)
        elif code != 0:
            failed.append(part.name)
    for name in missing:
        print(f"MISSING CAPABILITY: {name}: its tests did NOT run on this machine", flush=True)
    for name in failed:
        print(f"FAILED: {name}", flush=True)
    passed = len([part for part in everything if part.name not in (*failed, *missing)])
    print(f"{passed} passed, {len(failed)} failed, {len(missing)} skipped", flush=True)
    return 1 if failed or (missing and os.environ.get("RAILHIL_REQUIRE_ALL")) else 0


if __name__ == "__main__":
    sys.exit(main())
