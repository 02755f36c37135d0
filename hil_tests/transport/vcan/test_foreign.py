"""The exported controller in C on kernel SocketCAN, as a separate process with the Python plant and recorder."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.foreign import build_node, without_status
from hil_tests.support.hub import running_hub
from hil_tests.support.paths import ROOT
from hil_tests.transport.vcan.bench import counters_of, run_on, socketcan
from railhil.bench import Result
from railhil.bus.ident import Role
from railhil.bus.link import Link, open_link
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.dbc import wire_contract
from railhil.systems.ato.scenario.model import Scenario
from railhil.testing.result import disturbed

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def program(hop_export: Path) -> Path:
    """IPFC for the hop; not optimised, because the machine is slow."""
    return build_node(hop_export, flags=("-std=c99", "-O0"))


def test_foreign_controller_sends_the_same_frames_on_vcan(
    program: Path, hop: Scenario, hop_reference: Result, folder: Path
) -> None:
    """Every frame of the record but CTL_STAT is that of our node; nothing is lost or refused."""
    command = [str(program), "can", "vcan0"]
    result, exit_codes = run_on(socketcan(), hop, folder, controller_command=command)
    said = (folder / "controller.txt").read_text()
    assert (result.line, exit_codes) == ("", [0, 0]), said
    assert result.score.verdict == "PASS"
    assert disturbed(result.recorder_counters) == disturbed(counters_of(folder, "plant")) == {}
    assert said.strip().endswith("control periods, run event 4"), said
    assert hop_reference.log is not None
    assert without_status(folder / "frames.log") == without_status(hop_reference.log)
    assert len(set(hop_reference.commands("notch"))) > 8


#: Of a program in Python with libraries of its own, on a machine that is slow and busy.
_START_S = 150.0
#: Starts a program in Python as where only its own libraries are installed. python-can loads asammdf where it finds it,
#: with pandas and pyarrow: four fifths of the start, for a file format that the program does not use.
_ALONE = """\
import runpy, sys
sys.modules["asammdf"] = None
del sys.argv[0]
runpy.run_path(sys.argv[0], run_name="__main__")
"""


@pytest.mark.long_after(1)
@pytest.mark.parametrize("language", ["C", "Python"])
def test_a_controller_without_railhil_has_one_hash_on_vcan_and_hub(
    hop: Scenario, language: str, tmp_path: Path
) -> None:
    """The controllers of docs/reference/wire.md, tuned for the published run: only their frames are compared."""
    examples, dbc, program = ROOT / "docs/examples/wire", str(ROOT / "dbc/railhil.dbc"), str(tmp_path / "controller")
    if language == "C":
        subprocess.run(["gcc", "-std=gnu99", "-o", program, str(examples / "controller.c"), "-lm"], check=True)
    hashes = set()
    with running_hub() as hub:
        for config in (socketcan(), {"interface": "railhil", "channel": hub.channel}):
            folder = tmp_path / config["interface"]
            folder.mkdir()
            command = [program, {"socketcan": "can", "railhil": "hub"}[config["interface"]], config["channel"]]
            if language == "Python":
                alone = [sys.executable, "-P", "-c", _ALONE]
                command = [*alone, str(examples / "controller.py"), *config.values(), dbc]
            result, exit_codes = run_on(config, hop, folder, controller_command=command, appear_s=_START_S)
            assert (result.trusted, exit_codes) == (True, [0, 0]), (folder / "controller.txt").read_text()
            hashes.add(result.frames_sha256)
    assert len(hashes) == 1


def test_interface_that_is_not_there_is_one_line(program: Path) -> None:
    done = subprocess.run([program, "can", "vcan9"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert done.stderr == "ipfc_node: vcan9: cannot be opened: No such device\n"


def make_vcan5() -> Link:
    """A new vcan5, and a link on it."""
    subprocess.run(["ip", "link", "add", "dev", "vcan5", "type", "vcan"], check=True)
    subprocess.run(["ip", "link", "set", "vcan5", "up"], check=True)
    return open_link(socketcan("vcan5"))


def answers_as_controller(link: Link) -> bool:
    """Whether the controller answers a device status poll soon."""
    link.send([master_frame(F_DEVICE_STATUS, Role.CONTROLLER)])
    return any(frame.can_id == wire_contract().device_status_id for frame in link.receive(0.2))


def eventually(condition: Callable[[], bool]) -> None:
    """Wait until it holds."""
    assert any(condition() for _ in range(100))


def test_interface_that_is_plugged_in_again_is_joined_again(program: Path, tmp_path: Path) -> None:
    """Its second life has another index: the socket of the first hears nothing any more."""
    link = make_vcan5()
    said = tmp_path / "said.txt"
    with said.open("wb") as stream, subprocess.Popen([program, "can", "vcan5"], stderr=stream) as node:
        try:
            eventually(lambda: answers_as_controller(link))
            link.close()
            subprocess.run(["ip", "link", "del", "vcan5"], check=True)
            link = make_vcan5()
            eventually(lambda: answers_as_controller(link))
        finally:
            node.kill()
            link.close()
            subprocess.run(["ip", "link", "del", "vcan5"], check=True)
    assert [line.split(" (")[0] for line in said.read_text().splitlines()] == [
        "ipfc_node: vcan5 is down",
        "ipfc_node: vcan5 is back",
    ]
