"""Traffic store: staging, commit, freshness, counters; nothing on the bus may break it."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from railhil.bus.frame import ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.mvb import TelegramSource
from railhil.bus.store import ASSEMBLY_NS, CAUSES, NEVER_NS, TrafficStore
from railhil.dbc import wire_contract
from railhil.wire.ato import SimTruth, TrkInfo, TrnPos, TrnSpeed

SINKS = [wire_contract().port(name) for name in ("TRN_SPEED", "TRN_POS", "TRK_INFO")]


def speed_frame(speed_01mmps: int = 1234, life: int = 0) -> Frame:
    return TelegramSource(SINKS[0]).frames(TrnSpeed(speed_01mmps, life=life).encode())[0]


def position_frames(odometer_mm: int = 5) -> list[Frame]:
    return TelegramSource(SINKS[1]).frames(TrnPos(odometer_mm).encode())


def test_read_gives_data_and_age():
    store = TrafficStore(SINKS)
    assert store.read(TrnSpeed, 0) == (None, NEVER_NS)
    assert store.feed(speed_frame(777), 1000) == "TRN_SPEED"
    telegram, age_ns = store.read(TrnSpeed, 41_000)
    assert telegram is not None
    assert (telegram.speed_01mmps, age_ns) == (777, 40_000)


def test_port_without_mailbox_is_never_decoded():
    store = TrafficStore(SINKS)
    for frame in TelegramSource(SimTruth.port()).frames(SimTruth().encode()):
        assert store.feed(frame, 0) is None
    assert store.counters == {"unknown_id": 3}
    with pytest.raises(KeyError):
        store.read(SimTruth, 0)


@pytest.mark.parametrize("fd", [False, True])
@pytest.mark.parametrize("telegram", [TrnSpeed(-5), TrnPos(-5), TrkInfo(5)], ids=lambda item: item.PORT)
def test_commit_needs_the_whole_telegram(telegram, fd):
    store = TrafficStore(SINKS)
    frames = TelegramSource(type(telegram).port(), fd).frames(telegram.encode())
    for frame in frames[:-1]:
        assert store.feed(frame, 0) is None
        assert store.accepted(telegram.PORT) == 0
    assert store.feed(frames[-1], 0) == telegram.PORT
    assert store.read(type(telegram), 0)[0] == telegram
    assert not store.counters


def test_missing_block_drops_the_telegram_whole():
    store = TrafficStore(SINKS)
    frames = TelegramSource(SINKS[2]).frames(TrkInfo(1).encode())
    for frame in (frames[0], frames[2]):
        store.feed(frame, 0)
    assert store.counters == {"missing_block": 1}
    assert store.read(TrkInfo, 0)[0] is None
    # Staging was cleared by the trailer: a lone second block plus trailer is no telegram either.
    for frame in (frames[1], frames[2]):
        store.feed(frame, 0)
    assert store.counters == {"missing_block": 2}


@pytest.mark.parametrize(("late_ns", "accepted"), [(ASSEMBLY_NS, 1), (ASSEMBLY_NS + 1, 0)])
def test_blocks_must_come_within_the_assembly_time(late_ns, accepted):
    store = TrafficStore(SINKS)
    block, trailer = position_frames()
    store.feed(block, 0)
    store.feed(trailer, late_ns)
    assert store.accepted("TRN_POS") == accepted
    assert store.counters["assembly_timeout"] == 1 - accepted


@pytest.mark.parametrize("left_over", [(0,), (1,), (0, 1)])
def test_what_is_left_over_of_one_telegram_does_not_spoil_the_next(left_over):
    """A trailer was lost, or a frame of zeros came from nowhere: nine seconds later the port is heard again."""
    for stray in (None, bytes(8)):
        store = TrafficStore(SINKS)
        frames = TelegramSource(SINKS[2]).frames(TrkInfo(1).encode())
        for part in left_over:
            store.feed(frames[part] if stray is None else Frame(frames[part].can_id, stray), 5_000_000_000)
        results = [store.feed(frame, 14_000_000_000) for frame in TelegramSource(SINKS[2]).frames(TrkInfo(2).encode())]
        assert results[-1] == "TRK_INFO"
        assert store.read(TrkInfo, 0)[0] == TrkInfo(2)
        assert not store.counters


def test_a_left_over_block_is_no_part_of_the_next_telegram():
    store = TrafficStore(SINKS)
    frames = TelegramSource(SINKS[2]).frames(TrkInfo(1).encode())
    store.feed(frames[0], 0)
    assert [store.feed(frame, ASSEMBLY_NS + 1) for frame in frames[1:]] == [None, None]
    assert store.counters == {"assembly_timeout": 1}


def mutated(frame: Frame, byte: int, value: int) -> Frame:
    data = bytearray(frame.data)
    data[byte] ^= value
    return frame._replace(data=bytes(data))


@pytest.mark.parametrize(
    ("byte", "value", "cause"),
    [
        (0, 1, "wrong_check_sequence"),
        (4, 1, "wrong_check_sequence"),
        (5, 0x10, "wrong_master_word"),
        (6, 8, "wrong_master_word"),
        (7, 1, "wrong_master_word"),
    ],
)
def test_single_frame_is_checked_everywhere(byte, value, cause):
    store = TrafficStore(SINKS)
    assert store.feed(mutated(speed_frame(), byte, value), 0) is None
    assert store.counters == {cause: 1}


@pytest.mark.parametrize(
    ("byte", "value", "cause"),
    [
        (0, 1, "wrong_check_sequence"),
        (4, 1, "wrong_block_count"),
        (5, 0x10, "wrong_master_word"),
        (6, 8, "wrong_master_word"),
        (7, 1, "wrong_master_word"),
    ],
)
def test_trailer_is_checked_everywhere(byte, value, cause):
    store = TrafficStore(SINKS)
    block, trailer = position_frames()
    store.feed(block, 0)
    assert store.feed(mutated(trailer, byte, value), 0) is None
    assert store.counters == {cause: 1}


def test_every_single_bit_error_of_every_frame_is_rejected():
    """Each bit of each frame flipped: nothing is committed, except where the bit means nothing (the seq counter,
    unused check octets of the trailer)."""
    for telegram in (TrnSpeed(4711, life=3), TrnPos(4711), TrkInfo(4711)):
        port = type(telegram).port()
        frames = TelegramSource(port).frames(telegram.encode())
        for index, frame in enumerate(frames):
            for bit in range(64):
                is_trailer = index == len(frames) - 1 and not port.single_frame
                byte = bit // 8
                if is_trailer and (port.blocks <= byte < 4 or (byte == 4 and bit % 8 >= 4)):
                    continue
                store = TrafficStore(SINKS)
                changed = [*frames[:index], mutated(frame, byte, 1 << bit % 8), *frames[index + 1 :]]
                assert [store.feed(item, 0) for item in changed][-1] is None


@pytest.mark.parametrize(
    ("frame", "cause"),
    [
        (Frame(0x118, b"", ERROR), "error_frame"),
        (Frame(0x118, b"", REMOTE), "remote_frame"),
        (Frame(0x118, bytes(8), EXTENDED), "extended_id"),
        (Frame(0x118, bytes(7)), "wrong_length"),
        (Frame(0x118, bytes(8), FD), "wrong_length"),
        (Frame(0x11D, bytes(8)), "wrong_length"),
        (Frame(0x120, bytes(3)), "wrong_length"),
        (Frame(0x7FF, bytes(8)), "unknown_id"),
    ],
)
def test_foreign_frames_are_counted_and_ignored(frame, cause):
    store = TrafficStore(SINKS)
    assert store.feed(frame, 0) is None
    assert store.counters == {cause: 1}
    assert cause in CAUSES


def any_frame() -> st.SearchStrategy[Frame]:
    known = st.sampled_from([can_id for port in SINKS for can_id in (*port.can_ids, port.fd_id)])
    return st.builds(
        Frame,
        st.one_of(known, st.integers(0, 0x7FF)),
        st.binary(max_size=64),
        st.sampled_from([0, 0, 0, FD, ERROR, REMOTE, EXTENDED]),
    )


@settings(max_examples=50, stateful_step_count=60)
class RandomBytesMachine(RuleBasedStateMachine):
    """Random frames between right ones: never an exception, never a value that nobody sent."""

    def __init__(self) -> None:
        super().__init__()
        self.store = TrafficStore(SINKS)
        self.now_ns = 0
        self.sent: int | None = None
        self.fed = 0

    @rule(frame=any_frame())
    def garbage(self, frame: Frame) -> None:
        self.fed += 1
        self.store.feed(frame, self.now_ns)

    @rule(speed=st.integers(-(1 << 23), (1 << 23) - 1), life=st.integers(0, 15))
    def right_telegram(self, speed: int, life: int) -> None:
        self.fed += 1
        assert self.store.feed(speed_frame(speed, life), self.now_ns) == "TRN_SPEED"
        self.sent = speed

    @rule(step_ns=st.integers(0, 20_000_000))
    def time_goes_on(self, step_ns: int) -> None:
        self.now_ns += step_ns

    @invariant()
    def value_is_the_last_sent(self) -> None:
        telegram, age_ns = self.store.read(TrnSpeed, self.now_ns)
        assert age_ns >= 0
        if telegram is not None and self.sent is not None:
            # A random frame passes both check sequences with the right master word once in 2^32 tries.
            assert telegram.speed_01mmps == self.sent

    @invariant()
    def every_frame_is_accounted_for(self) -> None:
        assert sum(self.store.counters.values()) <= self.fed


TestRandomBytes = RandomBytesMachine.TestCase


@given(st.lists(any_frame(), max_size=200))
def test_random_bytes_commit_nothing(frames):
    store = TrafficStore(SINKS)
    for frame in frames:
        store.feed(frame, 0)
    assert [store.accepted(name) for name in store.ports] == [0, 0, 0]


def test_a_frame_that_was_checked_already_is_not_checked_again() -> None:
    store = TrafficStore([TrnSpeed.port()])
    (frame,) = TelegramSource(TrnSpeed.port()).frames(TrnSpeed(77).encode())
    assert store.feed(frame, 5, store.check(frame)) == "TRN_SPEED"
    assert store.read(TrnSpeed, 5, "TRN_SPEED") == (TrnSpeed(77), 0)
    wrong = frame._replace(flags=REMOTE)
    assert store.feed(wrong, 6, store.check(wrong)) is None
    assert (store.counters, store.accepted("TRN_SPEED")) == ({"remote_frame": 1}, 1)
