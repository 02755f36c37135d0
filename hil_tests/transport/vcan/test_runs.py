"""The bench on kernel SocketCAN: the same bytes as everywhere else."""

from __future__ import annotations

import socket
import struct

import pytest

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.published import PUBLISHED_SHA256
from hil_tests.transport.vcan.bench import (
    STOPS,
    STOPS_SHA256,
    beginning,
    counters_of,
    run_on,
    sequence_on,
    short_stop,
    socketcan,
)
from railhil import cli
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.bus.link import open_link
from railhil.bus.select import choose_bus
from railhil.common.exit_codes import PASS
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.sequences.evidence import sequence_sha256
from railhil.testing.result import disturbed

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]

NODES = ("controller", "plant")
#: ``struct can_frame`` of linux/can.h: identifier with flags, length, padding, data.
_CAN_FRAME = struct.Struct("=IB3x8s")


@pytest.mark.long
def test_published_run_gives_the_bytes_of_every_other_transport(lvshun, folder):
    """195 s, 98 000 frames. It stops 0.219 m short, where the scenario allows 0.3 m."""
    result, exit_codes = run_on(socketcan(), lvshun, folder, seed=0)
    assert (result.exit_code, exit_codes) == (PASS, [0, 0])
    found = [result.recorder_counters, *(counters_of(folder, role) for role in NODES)]
    assert [disturbed(counters) for counters in found] == [{}, {}, {}]
    assert result.frames_sha256 == PUBLISHED_SHA256


def test_published_run_begins_with_the_bytes_of_every_other_transport(lvshun, folder):
    """A twentieth of it."""
    recorded, expected = beginning(socketcan(), lvshun, folder)
    assert len(recorded) > 4_000
    assert recorded == expected


@pytest.mark.long_after(1)
@pytest.mark.parametrize("name", ["hst_short", "emu3_short"])
def test_high_speed_trains_give_the_bytes_of_every_other_transport(name, folder, tmp_path):
    """4 s of one power unit and of three."""
    scenario = load_any(name, ["task.duration_s=4", "task.rmse_max_kmh=9"])
    reference = tmp_path / "local"
    reference.mkdir()
    expected = local_run(scenario, reference, RunSpec(law=LawSpec("pid", "float64"), seed=3))
    result, exit_codes = run_on(socketcan(), scenario, folder, seed=3, controller="pid", arithmetic="float64")
    assert (result.line, exit_codes, result.frames_sha256) == ("", [0, 0], expected.frames_sha256)
    assert (folder / "frames.log").read_bytes() == expected.log.read_bytes()


@pytest.mark.long
def test_a_line_with_a_dwell_gives_the_bytes_of_every_other_transport(folder, tmp_path):
    """38 s with three stops, 27 000 frames: doors, departure and train protection. Left out in a virtual machine."""
    scenario, spec = load_any(str(TEST_DATA / "tiny_line.toml")), RunSpec(law=LawSpec("ipfc_plus"), seed=3)
    reference = tmp_path / "local"
    reference.mkdir()
    expected = local_run(scenario, reference, spec)
    result, exit_codes = run_on(socketcan(), scenario, folder, spec=spec)
    assert (result.exit_code, exit_codes, result.frames_sha256) == (PASS, [0, 0], expected.frames_sha256)


@pytest.mark.long
def test_a_sequence_of_stops_gives_the_hash_of_every_other_transport(tmp_path):
    """Two runs of 6 s, the second with what the first has learned."""
    made = sequence_on(socketcan(), short_stop(), tmp_path, STOPS, 2)
    assert sequence_sha256(made) == STOPS_SHA256


def test_vcan_is_taken_when_nothing_is_said():
    choice = choose_bus({})
    assert (choice.transport, choice.needs_hub) == ("socketcan:vcan0", False)
    assert "vcan0" in choice.reason


def test_frames_are_plain_classic_frames_for_any_other_program():
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as listener:
        listener.bind(("vcan0",))
        listener.settimeout(5.0)
        link = open_link(socketcan("vcan0"))
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
    one, other = open_link(socketcan("vcan0")), open_link(socketcan("vcan1"))
    try:
        one.send([Frame(0x100, b"one")])
        assert other.receive(0.5) == []
    finally:
        one.close()
        other.close()


def test_missing_interface_is_one_clear_line(tmp_path, capsys):
    assert cli.main(["run", "--attach", "-i", "socketcan", "-c", "vcan9", "--out", str(tmp_path / "run")]) == 2
    captured = capsys.readouterr()
    assert "socketcan:vcan9 cannot be opened" in captured.err
    assert len(captured.err.strip().splitlines()) == 1
    assert not (tmp_path / "run").exists()
