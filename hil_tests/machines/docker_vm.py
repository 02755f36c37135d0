"""Run a command with a Docker engine on a kernel with CAN: ``python -m hil_tests.machines.docker_vm -- COMMAND``

This combines the two machines: the image is built by the engine on the host, where that is fast; the engine's data are
copied into a disk file; an engine inside the virtual machine uses that disk. There a container with the permission to
make interfaces can create ``vcan0``. COMMAND runs in the virtual machine, in the caller's directory, and finds the
environment that :mod:`hil_tests.machines.docker_engine` describes.

Exit code: as for the two machines (that of the command; 77, 124, 125 for the machine's; 2 for a wrong command line).
"""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from hil_tests.machines.docker_engine import DATA_FOLDER, docker_engine, engine_answers
from railhil.machines import debian, vcan_vm

_PURPOSE = "a Docker engine in a virtual machine"
#: Space for data written by the containers, and for the file system itself.
_SPARE_BYTES = 1 << 30
_BUILD_S = 900.0


def build_image(project: Path) -> None:
    """Build the project's image with a private engine of the host, so that its layers are in that engine's data.

    Raises:
        CapabilityError: this host cannot have one, or another engine answers.
        MachineError: the image does not build.
    """
    if engine_answers():
        raise debian.CapabilityError(f"{_PURPOSE} needs the data of a private engine, here another one answers")
    with docker_engine() as environment:
        words = [*environment["RAILHIL_COMPOSE"].split(), "build", "-q"]
        done = subprocess.run(
            words, cwd=project, env={**debian.environment(), **environment}, capture_output=True, text=True,
            timeout=_BUILD_S, check=False,
        )  # fmt: skip
    if done.returncode != 0:
        lines = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()
        raise debian.MachineError(f"the image does not build: {lines[-1]}")


def _disk_with(folder: Path, disk: Path) -> None:
    """Write ``folder`` (owners, device nodes and extended attributes too) as an ext4 file system into ``disk``."""
    used = int(debian.run_tool(["du", "-sxB1", str(folder)]).split()[0])
    with disk.open("wb") as handle:
        handle.truncate(used * 5 // 4 + _SPARE_BYTES)
    debian.run_tool(["mke2fs", "-q", "-F", "-t", "ext4", "-d", str(folder), str(disk)])


def run(command: Sequence[str], *, shares: Sequence[Path] = (), timeout_s: float = 900.0) -> int:
    """Build the image, boot, start the engine, run ``command`` in the virtual machine; returns its exit code.

    Raises:
        CapabilityError: one of the two machines is not available here.
        MachineError: one of them failed.
    """
    debian.require_debian_root(_PURPOSE)
    debian.install_commands({"mke2fs": "e2fsprogs"}, _PURPOSE)
    build_image(Path.cwd())
    data = debian.cache_dir() / DATA_FOLDER
    with tempfile.TemporaryDirectory(prefix="railhil-disk-", dir="/var/tmp") as scratch:
        disk = Path(scratch, "docker.ext4")
        with debian.cache_lock(DATA_FOLDER):
            _disk_with(data, disk)
        words = [sys.executable, "-m", "hil_tests.machines.docker_engine", "--no-base-image"]
        words += ["--timeout", str(timeout_s), "--", *command]
        return vcan_vm.first_that_boots(
            lambda kind: vcan_vm.run(
                kind, words, shares=shares, disks={disk: data}, timeout_s=timeout_s, memory_mb=4096, processors=1
            )
        )


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; see the module's docstring for the exit codes."""
    parser = argparse.ArgumentParser(
        prog="python -m hil_tests.machines.docker_vm",
        description="Run a command beside a Docker engine in a virtual machine whose kernel has SocketCAN.",
    )
    parser.add_argument("--share", type=Path, action="append", default=[], metavar="DIR",
                        help="folder of the host that the command may write to (may be given again)")  # fmt: skip
    parser.add_argument("--timeout", type=float, default=900.0, metavar="S", help="for the machine (default 900)")
    parser.add_argument("command", nargs="+", help="command and its arguments, after --")
    options = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    return debian.guarded("docker_vm", lambda: run(options.command, shares=options.share, timeout_s=options.timeout))


if __name__ == "__main__":
    sys.exit(main())
