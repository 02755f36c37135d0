"""``railhil vcan`` in a network namespace, on a kernel that has vcan."""

from __future__ import annotations

import multiprocessing
import os
import signal
import socket
import subprocess
from pathlib import Path

import pytest

from hil_tests.support.cli import wait_for
from hil_tests.transport.vcan.bench import say_into
from railhil.machines import vcan

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600), pytest.mark.usefixtures("can_utils")]

_NOBODY = 65534
_PATIENCE_S = 120.0


def command(words: list[str], folder: Path, user: int = 0) -> multiprocessing.process.BaseProcess:
    """The command in a fork of this process; what it says in ``folder/said``."""

    def process() -> None:
        say_into(folder / "said")
        if user:
            os.setgroups([])
            os.setgid(user)
            os.setuid(user)
        os._exit(vcan.main(["--via", "namespace", *words]))

    started = multiprocessing.get_context("fork").Process(target=process)
    started.start()
    return started


def host_interfaces() -> str:
    return subprocess.run(["ip", "-o", "link"], capture_output=True, text=True, check=True).stdout


def test_interfaces_are_its_own(folder):
    before = host_interfaces()
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as listener:
        listener.bind(("vcan0",))
        script = "ip -br link; cansend vcan0 123#11; cansend can5 123#11; exit 7"
        started = command(["--interfaces", "vcan0,can5", "--", "sh", "-c", script], folder)
        started.join(_PATIENCE_S)
        listener.settimeout(0.2)
        with pytest.raises(TimeoutError):
            listener.recv(16)
    assert started.exitcode == 7
    said = (folder / "said").read_text().splitlines()
    assert said[0] == "vcan: vcan0, can5 in a network namespace of its own (this kernel has vcan)"
    assert [line.split()[0] for line in said[1:]] == ["lo", "vcan0", "can5"]
    assert host_interfaces() == before


def test_without_root_and_ended_by_a_signal(folder):
    folder.chmod(0o777)
    for parent in folder.parents[:3]:
        parent.chmod(0o755)
    left = folder / "left"
    script = f"cansend vcan1 123#11 && setsid sleep 600 & sleep 600 & echo $! > {left}.new; mv {left}.new {left}; wait"
    started = command(["--", "sh", "-c", script], folder, _NOBODY)
    wait_for(left.exists, _PATIENCE_S)
    sleeper = Path(f"/proc/{left.read_text().strip()}")
    assert sleeper.exists()
    os.kill(started.pid, signal.SIGTERM)
    started.join(_PATIENCE_S)
    assert started.exitcode == 128 + signal.SIGTERM
    assert not sleeper.exists()
    assert (folder / "said").read_text() == (
        "vcan: vcan0, vcan1 in a network namespace of its own (this kernel has vcan, as root of a user namespace)\n"
    )
