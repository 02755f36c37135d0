"""Bit lengths, arbitration order and the timing of the hub's wire model (all in simulated nanoseconds)."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.hub.ports import SwitchPort
from railhil.bus.hub.wire_model import (
    PENDING_LIMIT_FRAMES,
    WireModel,
    arbitration_key,
    crc15,
    frame_bits,
    stuff_bit_positions,
)
from railhil.bus.packing import pack_frame, unpack_frames


def _stuffed(bits: str) -> str:
    """Stuffing seen from the receiver's side: after five equal bits *on the wire* comes the opposite."""
    sent = ""
    for bit in bits:
        sent += bit
        if sent[-5:] in ("00000", "11111"):
            sent += "1" if bit == "0" else "0"
    return sent


def test_crc15_has_the_catalogued_check_value() -> None:
    assert crc15("".join(f"{octet:08b}" for octet in b"123456789")) == 0x059E


@given(st.text("01", max_size=120))
def test_stuff_bits_are_those_of_the_wire(bits: str) -> None:
    assert len(bits) + len(stuff_bit_positions(bits, at_end=True)) == len(_stuffed(bits))


@pytest.mark.parametrize(
    ("bits", "positions"),
    [("0000", []), ("00000", [4]), ("0000000000", [4, 9]), ("000001111", [4, 8]), ("0000011110000", [4, 8, 12])],
)
def test_a_stuff_bit_counts_for_the_next_run(bits: str, positions: list[int]) -> None:
    assert stuff_bit_positions(bits, at_end=True) == positions
    assert stuff_bit_positions(bits, at_end=False) == [p for p in positions if p != len(bits) - 1]


@given(st.integers(0, 0x7FF), st.binary(max_size=8))
def test_standard_frames_lie_between_no_and_worst_case_stuffing(can_id: int, data: bytes) -> None:
    bits, fast_bits = frame_bits(Frame(can_id, data))
    size = len(data)
    assert 47 + 8 * size <= bits <= 47 + 8 * size + (34 + 8 * size - 1) // 4
    assert fast_bits == 0


@given(st.integers(0, 0x1FFFFFFF), st.binary(max_size=8))
def test_extended_frames_lie_between_no_and_worst_case_stuffing(can_id: int, data: bytes) -> None:
    bits, _ = frame_bits(Frame(can_id, data, EXTENDED))
    size = len(data)
    assert 67 + 8 * size <= bits <= 67 + 8 * size + (54 + 8 * size - 1) // 4


def test_a_frame_computed_by_hand() -> None:
    # SOF 0, id 0x555, RTR IDE r0 000, DLC 0000: 0 10101010101 000 0000. The seven zeros take one stuff bit.
    header = "0" + "10101010101" + "000" + "0000"
    crc = f"{crc15(header):015b}"
    stuff_bits = len(_stuffed(header + crc)) - len(header + crc)
    assert frame_bits(Frame(0x555, b"")) == (47 + stuff_bits, 0)
    # A remote frame carries no data whatever length it asks for.
    assert 47 <= frame_bits(Frame(0x555, bytes(8), REMOTE))[0] <= 47 + 33 // 4
    assert frame_bits(Frame(0x4, bytes(8), ERROR)) == (0, 0)


def test_can_fd_lengths_computed_by_hand() -> None:
    # 0 01010101010 RRS0 IDE0 FDF1 res0 BRS0 ESI0 DLC0000: 22 bits, one stuff bit in the last seven zeros;
    # stuff count and CRC-17 with fixed stuff bits 4 + 17 + 6; tail 13.
    assert frame_bits(Frame(0x2AA, b"", FD)) == (22 + 1 + 27 + 13, 0)
    # With BRS 1 no more stuff bit at the zeros after it (ESI0 DLC0000 are five zeros at the very end, where the fixed
    # stuff bit stands). Nominal: 17 bits to BRS and 12 after the CRC delimiter.
    assert frame_bits(Frame(0x2AA, b"", FD | BRS)) == (17 + 12, 5 + 27 + 1)
    # 20 data bytes take CRC-21: 4 + 21 + 7. Alternating data has no stuff bits; DLC 1011.
    assert frame_bits(Frame(0x2AA, b"\x55" * 20, FD)) == (22 + 160 + 0 + 32 + 13, 0)


def _arbitration_bits(frame: Frame) -> str:
    remote = "1" if frame.flags & REMOTE else "0"
    if frame.flags & EXTENDED:
        return f"{frame.can_id >> 18:011b}11{frame.can_id & 0x3FFFF:018b}{remote}"
    return f"{frame.can_id:011b}{remote}0"


_ids = st.one_of(
    st.builds(Frame, st.integers(0x100, 0x103), st.just(b""), st.sampled_from([0, REMOTE])),
    st.builds(
        Frame,
        st.builds(lambda base, low: base << 18 | low, st.integers(0x100, 0x103), st.integers(0, 3)),
        st.just(b""),
        st.sampled_from([EXTENDED, EXTENDED | REMOTE]),
    ),
)


@given(_ids, _ids)
def test_arbitration_is_won_by_the_first_dominant_bit(first: Frame, second: Frame) -> None:
    bits = _arbitration_bits(first), _arbitration_bits(second)
    keys = arbitration_key(first), arbitration_key(second)
    assert (keys[0] < keys[1]) == (bits[0] < bits[1])
    assert (keys[0] == keys[1]) == (bits[0] == bits[1])


class _NamedPort(SwitchPort):
    """A port that only stands for its name: the model never touches more."""

    def fileno(self) -> int:
        return -1

    def receive(self) -> list[bytes]:
        return []

    def send(self, packet: bytes) -> bool:
        return False

    def flush(self) -> None:
        return

    def close(self) -> None:
        return


def _ids_of(delivered: list[tuple[SwitchPort, bytes]]) -> list[int]:
    return [unpack_frames(packet)[0].can_id for _, packet in delivered]


def _packet(*can_ids: int) -> bytes:
    return b"".join(pack_frame(Frame(can_id, b"")) for can_id in can_ids)


def test_arbitration_without_a_bit_rate_sorts_heads_and_keeps_each_client_in_order() -> None:
    model = WireModel(None, None, arbitration=True)
    first, second = _NamedPort("first"), _NamedPort("second")
    model.offer(first, _packet(0x300, 0x100), 0)
    model.offer(second, _packet(0x200, 0x400), 0)
    # 0x100 may not overtake 0x300 of its own client, but goes before 0x400 as soon as it heads its queue.
    assert _ids_of(model.due(0)) == [0x200, 0x300, 0x100, 0x400]
    assert model.next_due_ns() is None


def test_without_arbitration_frames_leave_in_order_of_arrival() -> None:
    model = WireModel(1_000_000, None, arbitration=False)
    first, second = _NamedPort("first"), _NamedPort("second")
    model.offer(first, _packet(0x300), 0)
    model.offer(second, _packet(0x200), 1)
    model.offer(first, _packet(0x100), 2)
    assert _ids_of(model.due(10**9)) == [0x300, 0x200, 0x100]


def test_a_frame_is_delivered_at_its_end_and_is_not_preempted() -> None:
    model = WireModel(1_000_000, None, arbitration=True)
    low, high = _NamedPort("low priority"), _NamedPort("high priority")
    low_ns = frame_bits(Frame(0x700, b""))[0] * 1000
    high_ns = frame_bits(Frame(0x100, b""))[0] * 1000
    model.offer(low, _packet(0x700, 0x700), 0)
    assert model.due(0) == []
    assert model.next_due_ns() == low_ns
    model.offer(high, _packet(0x100), low_ns - 1)
    assert model.due(low_ns - 1) == []
    assert _ids_of(model.due(low_ns)) == [0x700]
    assert model.next_due_ns() == low_ns + high_ns
    assert model.due(low_ns + high_ns - 1) == []
    assert _ids_of(model.due(low_ns + high_ns)) == [0x100]
    assert _ids_of(model.due(2 * low_ns + high_ns)) == [0x700]


def test_a_late_wake_up_neither_accumulates_nor_lets_late_frames_contend_early() -> None:
    model = WireModel(1_000_000, None, arbitration=True)
    early, late = _NamedPort("early"), _NamedPort("late")
    duration_ns = frame_bits(Frame(0x500, b""))[0] * 1000
    model.offer(early, _packet(0x500, 0x500), 0)
    assert model.due(0) == []
    # The hub wakes long after the first end; meanwhile a more urgent frame came, but after the second had started.
    model.offer(late, _packet(0x100), duration_ns + 1)
    assert _ids_of(model.due(10 * duration_ns)) == [0x500, 0x500, 0x100]


def test_can_fd_data_phase_runs_at_the_data_bit_rate() -> None:
    frame = Frame(0x2AA, b"\x55" * 64, FD | BRS)
    slow_bits, fast_bits = frame_bits(frame)
    model = WireModel(500_000, 2_000_000, arbitration=False)
    model.offer(_NamedPort("sender"), pack_frame(frame), 0)
    assert model.due(0) == []
    assert model.next_due_ns() == slow_bits * 2000 + fast_bits * 500


def test_a_client_with_a_full_transmit_queue_is_full_until_the_wire_takes_frames() -> None:
    model = WireModel(1_000_000, None, arbitration=False)
    sender, other = _NamedPort("sender"), _NamedPort("other")
    for _ in range(PENDING_LIMIT_FRAMES // 256):
        model.offer(sender, _packet(*itertools.repeat(0x100, 256)), 0)
    assert model.is_full(sender)
    assert not model.is_full(other)
    model.due(0)
    assert not model.is_full(sender)
