"""Emulated boards with a CAN controller: on a bus of their own between bench and board, and on that of the run."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from hil_tests.support.foreign import PORTABLE, without_status
from hil_tests.transport.vcan.bench import run_on, socketcan
from railhil.bus.frame import EXTENDED, REMOTE, Frame
from railhil.bus.mvb import master_frame
from railhil.bus.packing import pack_frame
from railhil.common.errors import InputError
from railhil.controller_node.boards import Board, Image
from railhil.controller_node.boards.can_bus import PrivateBus
from railhil.controller_node.boards.emulator import Emulator
from railhil.controller_node.pipe import ControllerFailed
from railhil.dbc import wire_contract
from railhil.judge.result import Result
from railhil.systems.ato.scenario.model import Scenario
from railhil.testing.result import disturbed

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.needs_qemu, pytest.mark.timeout(600)]

BOARDS = ["zcu102", "virt_ctucan"]
#: What the controller is asked for: NOTCH_CMD, CTL_STAT, CTL_IDENT, device status.
_POLLS = {master_frame(*asked).data for asked in ((1, 0x110), (3, 0x138), (3, 0x170), (15, 1))}
_STATUS = master_frame(15, 1)


@pytest.fixture(scope="module")
def export(hop_export: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """IPFC for the hop, in a folder of these tests."""
    return Path(shutil.copytree(hop_export, tmp_path_factory.mktemp("boards") / "export"))


def image(name: str, export: Path) -> Image:
    return Board.load(name).build(export, ("ipfc.c", *PORTABLE))


def switched_on(name: str, image: Image, patience_s: float = 30.0) -> Emulator:
    emulator = Emulator(Board.load(name), image, patience_s, wire_contract())
    emulator.start()
    return emulator


def interfaces() -> set[str]:
    return {name for _, name in socket.if_nameindex()}


def frames_of(log: Path) -> list[Frame]:
    fields = [line.split()[2].split("#") for line in log.read_text().splitlines()]
    return [Frame(int(can_id, 16), bytes.fromhex(data)) for can_id, data in fields]


def played(frames: Sequence[Frame], emulator: Emulator) -> list[Frame]:
    """What the board sends when it hears the frames, from poll to poll."""
    waiting: list[Frame] = []
    answers: list[Frame] = []
    for frame in frames:
        waiting.append(frame)
        if frame.can_id == 0x080 and frame.data in _POLLS:
            answers += emulator.exchange(waiting)
            waiting = []
    return answers


@pytest.mark.long_after(1)
@pytest.mark.parametrize("name", BOARDS)
def test_board_answers_through_its_can_registers_as_the_node(name: str, export: Path, hop_reference: Result) -> None:
    """Each notch of a run, and again after a reset; nothing is lost, and the bus is gone with the board."""
    assert hop_reference.log is not None
    before = interfaces()
    frames = frames_of(hop_reference.log)
    notches = [frame for frame in frames if frame.can_id == 0x110]
    assert len(set(notches)) > 10
    emulator = switched_on(name, image(name, export))
    answers = played(frames, emulator)
    assert [frame for frame in answers if frame.can_id == 0x110] == notches
    assert {frame.can_id for frame in answers} == {0x110, 0x138, 0x139, 0x13C, 0x170, 0x171, 0x174}
    emulator.reset()
    again = played(frames[:500], emulator)
    assert len(again) > 50
    assert again == answers[: len(again)]
    emulator.stop()
    assert emulator.console == []
    assert interfaces() == before
    figures = emulator.figures()
    assert 17 < figures["control_periods"] < 40
    assert 500 < figures["instructions"]["min"] <= figures["instructions"]["max"] < 3000
    assert 200 < figures["stack_used_octets"] < 4000


@pytest.mark.long
def test_frames_that_nobody_asked_for_are_passed_on_and_others_are_not_taken(export: Path) -> None:
    emulator = switched_on("zcu102", image("zcu102", export))
    found = re.search(r"if=(\w+),", " ".join(emulator.command))
    assert found is not None
    stranger = Frame(0x333, b"\x01\x02")
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as other:
        other.bind((found[1],))
        assert [frame.can_id for frame in emulator.exchange([_STATUS])] == [0x088]
        other.send(pack_frame(stranger))
        assert stranger in emulator.exchange([_STATUS])
    answers = emulator.exchange([Frame(0x080, _STATUS.data, EXTENDED), Frame(0x080, bytes(3), REMOTE), _STATUS])
    assert [frame.can_id for frame in answers] == [0x088]
    subprocess.run(["ip", "link", "set", found[1], "down"], check=True)
    with pytest.raises(ControllerFailed, match="board zcu102: has lost its bus: Network is down"):
        emulator.exchange([_STATUS])


#: It prints a line. Its stack overflows at a frame of TIME_SYNC; it answers TRN_SPEED, late if that is not 0, and
#: nothing else.
_BAD_CONTROLLER = """\
#include "railhil_board.h"
void railhil_init(railhil_control_t *control) { control->ended = 0; board_console("hello"); }
static void overflow(uint32_t can_id) { volatile char wide[100000]; memset((char *)wide, (int)can_id, sizeof wide); }
static void delay(void) { volatile uint32_t left = 200000000; while (left) { left--; } }
unsigned railhil_receive(railhil_control_t *control, uint32_t can_id, unsigned length, const unsigned char *data,
                         railhil_frame_t *answer)
{ (void)control; (void)length; if (can_id == 0x100) { overflow(can_id); }
  if (can_id == 0x118 && data[0]) { delay(); }
  answer->can_id = 0x333; answer->length = 1; answer->data[0] = 7; return can_id == 0x118; }
"""
_SPEED = Frame(0x118, bytes(8))


@pytest.fixture(scope="module")
def bad(export: Path) -> Path:
    (export / "bad.c").write_text(_BAD_CONTROLLER)
    return export


def bad_image(name: str, bad: Path) -> Image:
    return Board.load(name).build(bad, ("bad.c",))


@pytest.mark.long
@pytest.mark.parametrize("name", BOARDS)
def test_frames_lost_in_the_receiver_of_a_board_end_it(name: str, bad: Path) -> None:
    """They arrive while it computes, more than the receiver holds."""
    emulator = switched_on(name, bad_image(name, bad), 60.0)
    emulator.exchange([Frame(0x118, b"\x01" + bytes(7))])
    for _ in range(8):
        emulator.exchange([_SPEED] * 100)
        # The emulator takes them out of its socket.
        time.sleep(0.1)
    with pytest.raises(ControllerFailed, match="has failed: the CAN receiver has lost frames"):
        emulator.exchange([_STATUS])
    assert emulator.console == ["hello", "failure: the CAN receiver has lost frames"]


@pytest.mark.long
def test_a_bus_that_is_lost_while_a_board_answers_is_one_line(bad: Path) -> None:
    emulator = switched_on("zcu102", bad_image("zcu102", bad))
    emulator.exchange([_SPEED])
    assert emulator.figures()["console"] == ["hello"]
    found = re.search(r"if=(\w+),", " ".join(emulator.command))
    assert found is not None
    timer = threading.Timer(0.5, subprocess.run, [["ip", "link", "set", found[1], "down"]], {"check": True})
    timer.start()
    with pytest.raises(ControllerFailed, match="board zcu102: has lost its bus: Network is down"):
        emulator.exchange([_STATUS])
    timer.join()


@pytest.mark.long
def test_board_that_cannot_go_on_is_one_line_and_leaves_nothing(bad: Path) -> None:
    before = interfaces()
    for frames, words in [
        ([_SPEED, _STATUS], r"board zcu102: has not answered for 2 s, expected an answer"),
        (
            [_SPEED, Frame(0x100, bytes(8)), _STATUS],
            r"board zcu102: has failed: data abort at 0x\w{8}, expected an answer",
        ),
    ]:
        emulator = switched_on("zcu102", bad_image("zcu102", bad), 2.0)
        with pytest.raises(ControllerFailed, match=words) as error:
            emulator.exchange(frames)
        assert error.value.frames == [Frame(0x333, b"\x07")]
        assert interfaces() == before


def test_where_no_interface_can_be_made_it_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "ip"
    program.write_text("#!/bin/sh\necho RTNETLINK answers: Operation not permitted >&2\nexit 2\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    with pytest.raises(InputError, match=r"board zcu102: .*Operation not permitted, .*railhil vcan"):
        PrivateBus("zcu102")


def test_board_on_the_bus_of_the_run_sends_the_frames_of_the_node(
    export: Path, hop: Scenario, hop_reference: Result, folder: Path
) -> None:
    """As on a real bus: QEMU joins vcan0 as another node, and the bench has no controller."""
    board = Board.load("zcu102")
    places = {"image": image("zcu102", export).file, "can": "vcan0"}
    words = [board.table.emulator.program, *(word.format_map(places) for word in board.table.emulator.arguments)]
    with subprocess.Popen([*words, "-display", "none", "-monitor", "none"], stdout=subprocess.PIPE) as emulator:
        try:
            assert emulator.stdout is not None
            assert emulator.stdout.readline() == b"ready\n"
            # The controller of the bench is a program that does nothing.
            result, _ = run_on(socketcan(), hop, folder, controller_command=["true"])
        finally:
            emulator.kill()
    assert (result.line, result.score.verdict) == ("", "PASS")
    assert disturbed(result.recorder_counters) == {}
    assert hop_reference.log is not None
    assert without_status(folder / "frames.log") == without_status(hop_reference.log)
