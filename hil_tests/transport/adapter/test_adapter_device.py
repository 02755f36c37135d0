"""The emulated adapter's firmware, and the slcan lines against python-can's own reader and writer."""

from __future__ import annotations

import os
import select
from pathlib import Path

import pytest
from can.interfaces.slcan import slcanBus
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.frames import frames
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame, from_message, to_message
from railhil.bus.link.slcanline import FRAME_LETTERS, from_line, to_line
from railhil.machines.adapter.device import BIT_RATES, Build, Device
from railhil.machines.adapter.terminal import SerialLine, Terminal

#: A frame of each kind, with the line that the manuals give it.
KNOWN = [
    (Frame(0x118, bytes.fromhex("0011223344556677")), b"t11880011223344556677"),
    (Frame(0x080, b""), b"t0800"),
    (Frame(0x1ABCDEF0, b"\x01\xff", EXTENDED), b"T1ABCDEF0201FF"),
    (Frame(0x110, bytes(4), REMOTE), b"r1104"),
    (Frame(0x12345678, bytes(8), REMOTE | EXTENDED), b"R123456788"),
    (Frame(0x118, bytes(range(12)), FD), b"d1189000102030405060708090A0B"),
    (Frame(0x118, bytes(64), FD | BRS), b"b118F" + b"00" * 64),
    (Frame(0x1ABCDEF0, bytes(16), FD | EXTENDED), b"D1ABCDEF0A" + b"00" * 16),
]


def opened(build: Build | None = None) -> Device:
    """A device whose channel the host has opened at 500 kbit/s; its answers are read."""
    device = Device(build or Build())
    device.host_wrote(b"S6\rO\r")
    assert device.is_open
    device.to_host.clear()
    return device


def answer(device: Device, line: bytes) -> bytes:
    """What the device answers to one line."""
    device.to_host.clear()
    device.host_wrote(line + b"\r")
    return bytes(device.to_host)


# -- lines --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("frame", "line"), KNOWN)
def test_lines_are_those_of_the_manuals(frame, line):
    assert to_line(frame) == line
    assert from_line(line) == frame


@given(frames().filter(lambda frame: not frame.flags & ERROR))
def test_every_frame_survives_its_line(frame):
    assert from_line(to_line(frame)) == frame
    assert from_line(to_line(frame) + b"1F40", may_have_stamp=True) == frame


@given(st.binary(max_size=40), st.sampled_from(sorted(FRAME_LETTERS)))
def test_garbage_is_a_value_error_or_a_whole_frame(tail, letter):
    line = bytes([letter]) + tail
    try:
        frame = from_line(line)
    except ValueError:
        return
    assert to_line(frame).upper() == line.upper()


@pytest.mark.parametrize(
    "line",
    [b"t", b"t11", b"t118", b"t1182AB", b"t1182ABCDEF", b"t118G", b"t1189" + b"00" * 9, b"t8001FF", b"TFFFFFFFF0",
     b"r11020000", b"t1181 1", b"t+181FF", b"t118100F40"],
)  # fmt: skip
def test_lines_that_are_no_frame(line):
    with pytest.raises(ValueError, match=r"identifier|data"):
        from_line(line)


def test_an_error_frame_has_no_line():
    with pytest.raises(ValueError, match="error frame"):
        to_line(Frame(0, b"", ERROR))


# -- firmware -----------------------------------------------------------------------------------------------------


def test_commands_and_answers():
    device = Device(Build())
    said = {line: answer(device, line) for line in (b"", b"O", b"S9", b"S6", b"V", b"N", b"F", b"X", b"t1180", b"Z1")}
    assert said == {
        b"": b"\r", b"O": b"\a", b"S9": b"\a", b"S6": b"\r", b"V": b"V1013\r", b"N": b"NRH01\r", b"F": b"\a",
        b"X": b"\a", b"t1180": b"\a", b"Z1": b"\r",
    }  # fmt: skip
    said = {line: answer(device, line) for line in (b"O", b"O ", b"S5", b"Z0", b"t1180", b"T000001180", b"F", b"C")}
    assert said == {
        b"O": b"\r", b"O ": b"\a", b"S5": b"\a", b"Z0": b"\a", b"t1180": b"z\r", b"T000001180": b"Z\r", b"F": b"F00\r",
        b"C": b"\r",
    }  # fmt: skip
    assert answer(device, b"C") == b"\a"


@pytest.mark.parametrize("number", range(9))
def test_bit_rates(number):
    device = Device(Build())
    assert answer(device, b"S%d" % number) == b"\r"
    assert device.bit_rate == BIT_RATES[number]


def test_timing_registers_give_the_bit_rate():
    device = Device(Build())
    assert answer(device, b"s001C") == b"\r"
    assert device.bit_rate == 500_000
    assert answer(device, b"s00") == answer(device, b"sXYZW") == b"\a"


def test_listen_only_hears_and_does_not_send():
    device = Device(Build())
    device.host_wrote(b"S6\rL\r")
    assert answer(device, b"t1180") == b"\a"
    device.to_host.clear()
    device.bus_sent([Frame(0x118, b"")], 0)
    assert (bytes(device.to_host), device.transmit()) == (b"t1180\r", [])


def test_a_line_in_pieces_and_one_that_is_too_long():
    device = opened()
    device.host_wrote(b"t11")
    device.host_wrote(b"80\rt1181" + b"0" * 500 + b"\rt1190\r")
    assert bytes(device.to_host) == b"z\r\az\r"
    assert [frame.can_id for frame in device.transmit()] == [0x118, 0x119]


def test_full_transmit_queue_answers_bell_and_says_so_once():
    device = opened(Build(transmit_queue_frames=2))
    device.go_bus_off()
    assert [answer(device, b"t1180") for _ in range(3)] == [b"z\r", b"z\r", b"\a"]
    assert (device.transmit(), device.waiting_frames) == ([], 2)
    assert int(answer(device, b"F")[1:3], 16) & 0x82 == 0x82
    device.restart()
    assert len(device.transmit()) == 2
    assert answer(device, b"F") == b"F00\r"


def test_wrong_bit_rate_hears_nothing_and_sends_nothing():
    device = Device(Build(bus_bit_rate=500_000))
    device.host_wrote(b"S5\rO\r")
    device.to_host.clear()
    device.bus_sent([Frame(0x118, b"")], 0)
    device.host_wrote(b"t1180\r")
    assert (bytes(device.to_host), device.transmit()) == (b"z\r", [])
    assert int(answer(device, b"F")[1:3], 16) & 0x80
    assert device.counters["not_on_bus"] == 1


def test_time_stamps_and_a_host_that_does_not_read():
    device = Device(Build(receive_queue_bytes=20))
    device.host_wrote(b"S6\rZ1\rO\r")
    device.to_host.clear()
    device.bus_sent([Frame(0x118, bytes(8))] * 3, 61_000)
    assert bytes(device.to_host) == b"t1188" + b"00" * 8 + b"03E8\r"
    assert device.counters["receive_overrun"] == 2
    assert int(answer(device, b"F")[1:3], 16) & 0x09 == 0x09


def test_firmware_that_answers_nothing():
    device = Device(Build(answers=False))
    assert [answer(device, line) for line in (b"S6", b"O", b"t1180", b"F", b"V")] == [b"", b"", b"", b"", b"V1013\r"]
    assert [frame.can_id for frame in device.transmit()] == [0x118]


def test_closing_forgets_what_was_to_come():
    device = opened()
    device.bus_sent([Frame(0x118, bytes(8))], 0)
    device.go_bus_off()
    device.host_wrote(b"t1180\r")
    assert answer(device, b"C") == b"\r"
    device.host_wrote(b"O\r")
    assert device.transmit() == []


@given(st.binary(max_size=200))
def test_no_bytes_from_the_host_upset_the_firmware(data):
    device = opened()
    device.host_wrote(data + b"\r")
    assert device.to_host.endswith((b"\r", b"\a"))


# -- serial port --------------------------------------------------------------------------------------------------


def test_a_serial_rate_paces_the_line():
    line = SerialLine(115_200)
    now_ns = 1_000_000_000
    moved = 0
    for _ in range(1000):
        room = line.room_bytes(now_ns)
        line.moved(room, now_ns)
        moved += room
        now_ns += max(1, round(line.wait_s(now_ns) * 1e9))
    assert moved / (now_ns / 1e9 - 1.0) == pytest.approx(11_520, rel=0.01)


def test_unplugged_port_is_end_of_file_for_its_user(tmp_path: Path):
    terminal = Terminal(tmp_path / "tty")
    terminal.plug_in()
    user = os.open(terminal.link, os.O_RDWR | os.O_NOCTTY)
    try:
        terminal.write(b"z\r")
        assert os.read(user, 10) == b"z\r"
        terminal.pull_out()
        assert not terminal.link.exists()
        assert os.read(user, 10) == b""
        with pytest.raises(OSError, match="Input/output error"):
            os.write(user, b"C\r")
        terminal.plug_in()
        os.close(user)
        user = os.open(terminal.link, os.O_RDWR | os.O_NOCTTY)
        terminal.write(b"z\r")
        assert os.read(user, 10) == b"z\r"
    finally:
        os.close(user)
        terminal.pull_out()


def written(terminal: Terminal, lines: int) -> bytes:
    """The next ``lines`` lines that the host has written; the kernel hands them over in its own time."""
    data = b""
    while data.count(b"\r") < lines:
        assert select.select((terminal,), (), (), 5.0)[0], data
        data += terminal.read(200)
    return data


@pytest.mark.parametrize(("frame", "line"), KNOWN)
def test_python_can_reads_and_writes_the_same_lines(tmp_path: Path, frame, line):
    """The emulator is an adapter for python-can too, which has its own reader and writer."""
    terminal, device = Terminal(tmp_path / "tty"), Device(Build())
    terminal.plug_in()
    bus = slcanBus(str(terminal.link), bitrate=500_000, sleep_after_open=0)
    try:
        # C, S6, an empty line for no data bit rate, and O twice.
        device.host_wrote(written(terminal, 5))
        assert (device.is_open, device.bit_rate) == (True, 500_000)
        terminal.write(bytes(device.to_host))
        device.to_host.clear()
        bus.send(to_message(frame))
        data = written(terminal, 1)
        assert data == line + b"\r"
        device.host_wrote(data)
        assert device.transmit() == [frame]
        device.bus_sent([frame], 0)
        terminal.write(bytes(device.to_host))
        message = bus.recv(5.0)
        assert message is not None
        assert from_message(message) == frame
    finally:
        bus.shutdown()
        device.host_wrote(written(terminal, 1))
        terminal.pull_out()
    assert not device.is_open
