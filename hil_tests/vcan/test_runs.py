"""The bench on kernel SocketCAN: the same bytes as everywhere else.

The nodes of the run are forked from this process instead of started as commands: in the virtual machine that gives
the kernel (:mod:`hil_tests.machines.vcan_vm`) it takes ten seconds and more to import them once.
"""

from __future__ import annotations

import argparse
import dataclasses
import multiprocessing
import socket
import struct
from pathlib import Path

import pytest

from bus.frame import Frame
from bus.link import open_link
from bus.select import BusChoice, choose_bus
from controller_node.node import ControllerNode, ControllerOptions, run_controller
from hil_tests.bench import local_run
from plant_sim.node import PlantOptions, run_plant
from scenarios.model import Scenario, TargetCurve
from scenarios.target import Target
from supervisor import cli
from supervisor.options import RunOptions
from supervisor.run import Run, RunResult

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]

_SEED = 1
#: A move of 17 s and 48 m: up to 17 km/h, coast, brake. Short, because the machine is slow; it departs and it stops.
_MOVE = TargetCurve(((0.0, 0.0), (2.0, 0.8), (6.0, 0.8), (8.0, 0.0), (10.0, 0.0), (12.0, -0.8)))
#: ``struct can_frame`` of linux/can.h: identifier with flags, length, padding, data.
_CAN_FRAME = struct.Struct("=IB3x8s")


def config(channel: str) -> dict[str, str]:
    """Arguments of ``can.Bus`` for a kernel interface."""
    return {"interface": "socketcan", "channel": channel}


@pytest.fixture
def move(lvshun: Scenario) -> Scenario:
    """The short move with the published train."""
    target = Target(_MOVE)
    plan = dataclasses.replace(
        lvshun.plan, distance_m=target.stop_position_m, running_time_s=target.stop_time_s, stop_error_max_m=2.0
    )
    return dataclasses.replace(lvshun, target=_MOVE, plan=plan)


def run_on_vcan(scenario: Scenario, folder: Path) -> tuple[RunResult, list[int | None]]:
    """One run of three processes on vcan0: its result, and the exit codes of controller and plant."""

    def controller() -> None:
        raise SystemExit(run_controller(ControllerNode(scenario, ControllerOptions()), open_link(config("vcan0"))))

    def plant() -> None:
        raise SystemExit(run_plant(scenario, PlantOptions(seed=_SEED), open_link(config("vcan0"))))

    fork = multiprocessing.get_context("fork")
    nodes = [fork.Process(target=target) for target in (controller, plant)]
    for node in nodes:
        node.start()
    try:
        options = RunOptions(scenario.name, seed=_SEED, attach=True)
        result = Run(scenario, options, BusChoice(config("vcan0"), "the test's"), folder).execute()
        for node in nodes:
            node.join(20)
        return result, [node.exitcode for node in nodes]
    finally:
        for node in nodes:
            node.kill()
            node.join()


def test_run_gives_the_bytes_of_every_other_transport(move, tmp_path):
    (tmp_path / "vcan").mkdir()
    (tmp_path / "local").mkdir()
    result, exit_codes = run_on_vcan(move, tmp_path / "vcan")
    assert (result.line, exit_codes) == ("", [0, 0])
    assert result.score.verdict == "PASS"
    healthy = ("sent", "received", "send_retries")
    assert {key: count for key, count in result.counters.items() if key not in healthy and count} == {}
    reference = local_run(move, tmp_path / "local", seed=_SEED)
    assert (tmp_path / "vcan/frames.log").read_text() == reference.log.read_text()
    assert result.frames_sha256 == reference.frames_sha256


def test_vcan_is_taken_when_nothing_is_said():
    choice = choose_bus(argparse.Namespace())
    assert (choice.transport, choice.needs_hub) == ("socketcan:vcan0", False)
    assert "vcan0" in choice.reason


def test_frames_are_plain_classic_frames_for_any_other_program():
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as listener:
        listener.bind(("vcan0",))
        listener.settimeout(5.0)
        link = open_link(config("vcan0"))
        try:
            link.send([Frame(0x118, bytes(range(8))), Frame(0x110, b"\x01\x02")])
            heard = [_CAN_FRAME.unpack(listener.recv(_CAN_FRAME.size)) for _ in range(2)]
            listener.send(_CAN_FRAME.pack(0x7FF, 3, b"abc"))
            answered = link.receive(5.0)
        finally:
            link.close()
    assert heard == [(0x118, 8, bytes(range(8))), (0x110, 2, b"\x01\x02".ljust(8, b"\0"))]
    assert answered == [Frame(0x7FF, b"abc")]


def test_interfaces_are_separate_buses():
    one, other = open_link(config("vcan0")), open_link(config("vcan1"))
    try:
        one.send([Frame(0x100, b"one")])
        assert other.receive(0.5) == []
    finally:
        one.close()
        other.close()


def test_missing_interface_is_one_clear_line(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(
        "sys.argv", ["railhil", "run", "--attach", "-i", "socketcan", "-c", "vcan9", "--out", str(tmp_path / "run")]
    )
    assert cli.main() == 2
    captured = capsys.readouterr()
    assert "socketcan:vcan9 cannot be opened" in captured.err
    assert len(captured.err.strip().splitlines()) == 1
    assert not (tmp_path / "run").exists()
