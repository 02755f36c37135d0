"""The packet format of the hub: byte layout, round trips, and what is refused."""

from __future__ import annotations

import struct

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.bus import packing
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame

_NATIVE_ID = struct.Struct("=I")


def _wire_bytes(wire_id: int, rest: str) -> bytes:
    return _NATIVE_ID.pack(wire_id) + bytes.fromhex(rest)


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        (Frame(0x118, bytes.fromhex("1388f459dd11182e")), _wire_bytes(0x118, "08000000 1388f459dd11182e")),
        (Frame(0x080, b"\x11\x18\x2e"), _wire_bytes(0x080, "03000000 11182e0000000000")),
        (Frame(0x1ABCDEF0, b"\x01", EXTENDED), _wire_bytes(0x9ABCDEF0, "01000000 0100000000000000")),
        (Frame(0x7FF, bytes(5), REMOTE), _wire_bytes(0x400007FF, "05000000 0000000000000000")),
        (Frame(0x004, bytes(8), ERROR), _wire_bytes(0x20000004, "08000000 0000000000000000")),
        (Frame(0x12D, b"\xaa" * 12, FD), _wire_bytes(0x12D, "0c000000" + "aa" * 12 + "00" * 52)),
        (Frame(0x12D, b"\xaa" * 64, FD | BRS), _wire_bytes(0x12D, "40010000" + "aa" * 64)),
    ],
)
def test_frames_have_the_layout_of_linux_can_h(frame: Frame, expected: bytes) -> None:
    packed = packing.pack_frame(frame)
    assert packed == expected
    assert packing.fault_of(packed) is None
    assert packing.unpack_frames(packed) == [frame]


@st.composite
def messages(draw: st.DrawFn) -> can.Message:
    """Any message that a CAN controller can send or report."""
    extended = draw(st.booleans())
    is_fd = draw(st.booleans())
    remote = not is_fd and draw(st.booleans())
    error = not is_fd and not remote and draw(st.booleans())
    length = draw(st.sampled_from(sorted(packing.FD_LENGTHS))) if is_fd else draw(st.integers(0, 8))
    return can.Message(
        arbitration_id=draw(st.integers(0, 0x1FFFFFFF if extended else 0x7FF)),
        is_extended_id=extended,
        is_remote_frame=remote,
        is_error_frame=error,
        is_fd=is_fd,
        bitrate_switch=is_fd and draw(st.booleans()),
        error_state_indicator=is_fd and draw(st.booleans()),
        dlc=length,
        data=b"" if remote else draw(st.binary(min_size=length, max_size=length)),
        channel="x",
    )


@given(messages())
def test_messages_round_trip(message: can.Message) -> None:
    packed = packing.pack_message(message)
    assert packing.fault_of(packed) is None
    back = packing.unpack_message(packed, 0, 0.0, "x", own=False)
    assert back.equals(message, check_channel=True, timestamp_delta=None), f"{back!r} {message!r}"


@pytest.mark.slow
@given(st.lists(messages().filter(lambda message: not message.is_fd), min_size=1, max_size=20))
def test_a_batch_is_its_frames_in_order(batch: list[can.Message]) -> None:
    packet = b"".join(map(packing.pack_message, batch))
    assert packing.fault_of(packet) is None
    for index, frame in enumerate(packing.unpack_frames(packet)):
        assert packing.pack_frame(frame) == packet[16 * index : 16 * index + 16]
        assert packing.unpack_frames(packet, 16 * index)[0] == frame
        assert packing.unpack_message(packet, 16 * index, 0.0, "x", own=True).arbitration_id == frame.can_id


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        (Frame(0x800, b""), "0x800, allowed: 0..0x7FF"),
        (Frame(-1, b""), "allowed: 0..0x7FF"),
        (Frame(0x20000000, b"", EXTENDED), "allowed: 0..0x1FFFFFFF"),
        (Frame(0x100, bytes(9)), "9 bytes, allowed: 0..8"),
        (Frame(0x100, bytes(9), EXTENDED), "9 bytes, allowed: 0..8"),
        (Frame(0x100, bytes(10), FD), "10 bytes, allowed: 0..8, 12"),
        (Frame(0x100, bytes(65), FD), "65 bytes"),
        (Frame(0x100, b"", FD | REMOTE), "no remote frames"),
    ],
)
def test_what_no_can_frame_can_hold_is_refused(frame: Frame, words: str) -> None:
    with pytest.raises(ValueError, match=words.replace("(", r"\(")) as caught:
        packing.pack_frame(frame)
    assert "\n" not in str(caught.value)


def test_a_message_whose_dlc_contradicts_its_data_is_refused() -> None:
    message = can.Message(arbitration_id=0x100, is_extended_id=False, data=b"abc")
    message.data = bytearray(b"abcd")
    with pytest.raises(ValueError, match="dlc 3 with 4 data bytes"):
        packing.pack_message(message)


_GOOD = packing.pack_frame(Frame(0x100, b"12345678"))


@pytest.mark.parametrize("size", [0, 1, 15, 17, 71, 73, 76, 4097, 4112])
def test_a_packet_of_wrong_size_is_malformed(size: int) -> None:
    assert packing.fault_of((_GOOD * 300)[:size]) is not None


def test_every_allowed_packet_size_is_accepted_and_one_bad_length_field_anywhere_is_not() -> None:
    for count in range(1, 257):
        packet = bytearray(_GOOD * count)
        assert packing.fault_of(bytes(packet)) is None
        packet[16 * (count - 1) + 4] = 9
        assert "payload length 9" in str(packing.fault_of(bytes(packet)))
    fd_packet = bytearray(packing.pack_frame(Frame(0x100, bytes(64), FD)))
    fd_packet[4] = 63
    assert "payload length 63" in str(packing.fault_of(bytes(fd_packet)))


def test_the_own_mark_shows_in_the_packet_length_of_every_packet() -> None:
    for size in (*range(16, 4097, 16), 72):
        assert not size & packing.OWN_LENGTH_BIT
        assert size + len(packing.OWN_MARK) & packing.OWN_LENGTH_BIT


@pytest.mark.parametrize(
    "packet", [b"\xff\xfe", b"GET / HTTP/1.1", b"[1]", b"[" * 4000, b"{}", b'{"railhil_hub": 2}', _GOOD]
)
def test_what_is_no_hello_gives_one_line(packet: bytes) -> None:
    with pytest.raises(ValueError, match="hello") as caught:
        packing.decode_hello(packet)
    assert "\n" not in str(caught.value)
