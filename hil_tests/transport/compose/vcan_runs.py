"""The compose file on a kernel with CAN, and tests of it: ``python -m hil_tests.transport.compose.vcan_runs``

Where an engine answers already, it is used, and the host's kernel must have the interfaces can0 (up) and can1 (down).
Else all of it runs in a virtual machine (:mod:`hil_tests.machines.docker_vm`), where everything is slow; so only
``on_vcan.sh`` runs there, and the tests of ``on_vcan.py`` look at the folder it leaves from here.

Exit code: that of the tests; 77 when this host cannot have an engine on a kernel with CAN, 125 when that failed.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import yaml

from hil_tests.machines import docker_vm
from hil_tests.machines.bytecode import compile_by
from hil_tests.machines.docker_engine import docker_engine, engine_answers
from hil_tests.support.paths import ROOT
from railhil.machines import debian

_SCRIPT = Path(__file__).with_name("on_vcan.sh")
_TESTS = Path(__file__).with_name("on_vcan.py")
_SHORT = Path(__file__).with_name("short_move.toml")
#: What compose reads; the image is built before.
_PROJECT = ("docker-compose.yml", "docker-compose.hardware.yml", "Dockerfile")
_TIMEOUT_S = 2400.0
#: Where it runs in the virtual machine: in a folder of the host, all files would belong to one user.
_INSIDE = "/var/tmp/railhil-vcan-inside"
_INTERFACES = "ip link add can0 type vcan && ip link add can1 type vcan && ip link set can0 up"
#: Programs in Python that run there outside the containers.
_IN_THE_MACHINE = ("hil_tests.machines.docker_engine", "railhil.controller_node")
#: linux/if.h
_IFF_UP = 1
#: Name the folder and the cases to the tests.
FOLDER_VARIABLE, CASES_VARIABLE = "RAILHIL_VCAN_RUNS", "RAILHIL_VCAN_CASES"
#: In the virtual machine one takes half a minute and more.
CASES = ("vcan", "foreign")
LONG_CASES = ("published", "hardware", "foreign")


def _copy(project: Path) -> None:
    """What compose needs of the project, with the short scenario in the mounted folder."""
    project.mkdir()
    for name in _PROJECT:
        shutil.copy(ROOT / name, project / name)
    # Compose 1.29 makes the network of a service whose profile is off, and the virtual machine's kernel has no bridges.
    compose = yaml.safe_load((ROOT / _PROJECT[0]).read_text(encoding="utf-8"))
    compose["services"] = {name: one for name, one in compose["services"].items() if "profiles" not in one}
    (project / _PROJECT[0]).write_text(yaml.safe_dump(compose), encoding="utf-8")
    for name in ("scenarios", "runs"):
        (project / name).mkdir()
    shutil.copy(_SHORT, project / "scenarios")


def _is_up(interface: str) -> bool | None:
    """Whether an interface of this kernel is up; None when it is not there."""
    flags = Path("/sys/class/net", interface, "flags")
    return bool(int(flags.read_text(), 16) & _IFF_UP) if flags.exists() else None


def _on_this_kernel(words: list[str]) -> int:
    """Run the containers with the engine that answers."""
    if _is_up("can0") is not True or _is_up("can1") is not False:
        raise debian.CapabilityError(
            "docker compose on kernel CAN: no interfaces can0 (up) and can1 (down) on this host"
        )
    with docker_engine() as environment:
        variables = {**os.environ, **environment}
        build = [*environment["RAILHIL_COMPOSE"].split(), "build", "-q"]
        if subprocess.run(build, cwd=ROOT, env=variables, timeout=_TIMEOUT_S, check=False).returncode != 0:
            raise debian.MachineError("the image does not build")
        return subprocess.run(words, env=variables, timeout=_TIMEOUT_S, check=False).returncode


def run(cases: Sequence[str]) -> int:
    """Run the containers, then the tests; returns the exit code.

    Args:
        cases: names that ``on_vcan.sh`` explains.

    Raises:
        CapabilityError, MachineError: as :func:`hil_tests.machines.docker_vm.run`.
    """
    # Not below /run: the machine has its own file system there.
    with tempfile.TemporaryDirectory(prefix="railhil-vcan-", dir="/var/tmp") as name:
        folder = Path(name)
        _copy(folder / "project")
        words = ["sh", str(_SCRIPT), str(folder), sys.executable, *cases]
        if engine_answers():
            code = _on_this_kernel(words)
        else:
            for module in _IN_THE_MACHINE:
                compile_by([sys.executable, "-m", module, "--help"])
            words = ["sh", str(_SCRIPT), _INSIDE, sys.executable, *cases]
            there, back = (shlex.join(["cp", "-a", f"{a}/.", b]) for a, b in ((name, _INSIDE), (_INSIDE, name)))
            words = ["sh", "-ec", f"{_INTERFACES}; mkdir {_INSIDE}; {there}; {shlex.join(words)}; {back}"]
            code = docker_vm.run(words, shares=[folder], timeout_s=_TIMEOUT_S)
        if code != 0:
            raise debian.MachineError(f"{_SCRIPT.name} ended with {code}")
        tests = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(_TESTS)]
        variables = {**os.environ, FOLDER_VARIABLE: name, CASES_VARIABLE: " ".join(cases)}
        return subprocess.run(tests, cwd=ROOT, env=variables, check=False).returncode


def main() -> int:
    """Command line; see the module's docstring for the exit codes."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.transport.compose.vcan_runs")
    parser.add_argument("--long", action="store_true", help="all cases, among them the published run of 195 s on vcan0")
    cases = LONG_CASES if parser.parse_args().long else CASES
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    return debian.guarded("vcan_runs", lambda: run(cases))


if __name__ == "__main__":
    sys.exit(main())
