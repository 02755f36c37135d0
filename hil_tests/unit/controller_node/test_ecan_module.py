"""The receive side of the CAN module against slow, simple models: acceptance, overwriting, time stamps."""

from __future__ import annotations

import random
from types import ModuleType
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.mutation.in_memory import survivors
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.controller_node.ato.guard import Guard
from railhil.controller_node.ecan import module, timestamp
from railhil.controller_node.ecan.mailboxes import Mailbox
from railhil.controller_node.ecan.module import Ecan
from railhil.controller_node.ecan.timestamp import BitCounter, MessageAge
from railhil.wire.ato import TrnSpeed, WatchLevel

RATE = 500_000
MS = 1_000_000
#: Two counts of the stamps at 500 kbit/s make 4 us.
BIT_NS = 2_000
TURN_NS = (1 << 32) * BIT_NS


def box(number: int, can_id: int, mask: int = 0, **values: Any) -> Mailbox:
    return Mailbox(number, "", "", can_id, mask, **values)


def matches(mailbox: Mailbox, can_id: int, extended: bool) -> bool:
    """Bit by bit: a mask bit of 1 says don't care."""
    bits = 29 if mailbox.extended else 11
    wanted, dont_care, found = (f"{number:0{bits}b}" for number in (mailbox.can_id, mailbox.mask, can_id))
    if extended != mailbox.extended or len(found) > bits:
        return False
    return all(d == "1" or w == f for w, d, f in zip(wanted, dont_care, found, strict=True))


MAILBOXES = st.lists(
    st.tuples(
        st.integers(0, 31),
        st.integers(0, 0x7FF),
        st.sampled_from([0, 0x001, 0x7FF, 0x7F0, 0x400, 0x555]),
        st.booleans(),
        st.integers(0, 3).map(lambda x: x == 0),
    ),
    min_size=1,
    max_size=6,
    unique_by=lambda item: item[0],
)


@pytest.mark.slow
@settings(deadline=None, max_examples=40)
@given(MAILBOXES)
def test_acceptance_equals_the_bit_by_bit_rule(boxes: list[Any]) -> None:
    """Every standard identifier as a standard and as an extended frame: the highest number that matches."""
    table = [box(n, can_id, mask, transmit=sends, extended=wide) for n, can_id, mask, wide, sends in boxes]
    ecan = Ecan(table, BitCounter(RATE), range(32))
    nobody = 0
    for flags in (0, EXTENDED):
        for can_id in range(0x800):
            numbers = [m.number for m in table if not m.transmit and matches(m, can_id, flags == EXTENDED)]
            assert ecan.receive(Frame(can_id, b"", flags), 0) == max(numbers, default=-1)
            nobody += not numbers
    assert ecan.no_mailbox == nobody
    assert ecan.lost_messages == ecan.lost_unseen == 0


@settings(deadline=None, max_examples=300)
@given(st.integers(0, 0x1FFF_FFFF), st.integers(0, 0x1FFF_FFFF), st.integers(0, 0x1FFF_FFFF))
def test_acceptance_and_overlap_of_29_bits(one: int, other: int, mask: int) -> None:
    first, second = box(0, one, mask, extended=True), box(1, other, extended=True)
    assert first.accepts(other, extended=True) == matches(first, other, True) == first.overlaps(second)
    assert first.accepts(one ^ mask, extended=True)
    assert not first.accepts(one)
    assert not first.overlaps(box(2, one & 0x7FF))


class PlainEcan:
    """A mailbox as the list of what it was given since it was read."""

    def __init__(self, table: list[Mailbox], at_once: set[int]) -> None:
        self.boxes = sorted(table, key=lambda mailbox: mailbox.number, reverse=True)
        self.at_once = at_once
        self.waiting: dict[int, list[Frame]] = {mailbox.number: [] for mailbox in table}
        self.stamps: dict[int, int] = dict.fromkeys(self.waiting, 0)
        self.lost: dict[int, int] = dict.fromkeys(self.waiting, 0)
        self.unseen = self.nobody = 0

    def receive(self, frame: Frame, now_ns: int) -> int:
        bad = frame.flags & (ERROR | FD | BRS)
        right = [m for m in self.boxes if not bad and matches(m, frame.can_id, bool(frame.flags & EXTENDED))]
        free = [m for m in right if m.overwrite or not self.waiting[m.number]]
        if not free:
            self.unseen += bool(right)
            self.nobody += not right
            return -1
        number = free[0].number
        self.lost[number] += bool(self.waiting[number])
        self.stamps[number] = now_ns // BIT_NS % (1 << 32)
        if number not in self.at_once:
            self.waiting[number].append(frame)
        return number

    def read(self, number: int) -> Frame | None:
        waiting, self.waiting[number] = self.waiting[number], []
        return waiting[-1] if waiting else None


def sweep_module(subject: ModuleType) -> None:
    """Seeded traffic with every flag, protected and open mailboxes, reads in between, against the plain model."""
    assert subject._STANDARD_IDS == 0x800
    flags = [0] * 12 + [EXTENDED, EXTENDED, ERROR, REMOTE, FD, FD | BRS, BRS, ERROR | EXTENDED]
    for seed in range(12):
        draw = random.Random(seed)
        table = [
            box(n, draw.choice([0, 5, 0x7FF]), draw.choice([0, 2, 0x7F8]), overwrite=bool(o), extended=wide)
            for n, o, wide in [(0, 1, False), (3, 0, False), (4, 1, False), (9, 1, True), (31, 0, False)]
        ]
        at_once = {3} if seed % 3 == 0 else set()
        ecan = subject.Ecan([*table, box(7, 5, transmit=True)], BitCounter(RATE), at_once)
        plain = PlainEcan(table, at_once)
        assert ecan.counters == {}
        now_ns = TURN_NS - 40 * MS
        for _ in range(400):
            now_ns += draw.choice([0, 0, MS, 10 * MS])
            frame = Frame(draw.choice([0, 5, 7, 0x300, 0x7FF, 0x800]), draw.randbytes(2), draw.choice(flags))
            if draw.random() < 0.7:
                assert ecan.receive(frame, now_ns) == plain.receive(frame, now_ns)
            else:
                number = draw.choice(table).number
                assert ecan.read(number) == plain.read(number)
            assert {n: ecan.stamps[n] for n in plain.stamps} == plain.stamps
            assert {n: ecan.lost[n] for n in plain.lost} == plain.lost
            assert ecan.lost_messages == sum(plain.lost.values())
            assert (ecan.no_mailbox, ecan.lost_unseen) == (plain.nobody, plain.unseen)
        assert plain.nobody > 0 < sum(plain.lost.values())
        given_out = {"lost_messages": ecan.lost_messages, "lost_unseen": plain.unseen, "no_mailbox": plain.nobody}
        assert ecan.counters == {cause: count for cause, count in given_out.items() if count}
    fresh = subject.Ecan([box(0, 5)], BitCounter(RATE))
    assert (fresh.receive(Frame(5, b""), 0), fresh.read(0), fresh.stamps[0]) == (0, Frame(5, b""), 0)
    assert fresh.receive(Frame(5, b""), BIT_NS) == 0
    assert fresh.stamps[0] == 1
    assert len(fresh.lost) == len(fresh.stamps) == 32


def sweep_timestamp(subject: ModuleType) -> None:
    """The counter at its wrap and its rates; ages at every edge."""
    for rate in (500_000, 250_000, 125_000, 1_000_000, 83_333):
        counter = subject.BitCounter(rate)
        turn_bits = 1 << 32
        for bits in (0, 1, 2, 1000, turn_bits - 1, turn_bits, turn_bits + 1, 3 * turn_bits + 7):
            first_ns = -(-bits * 10**9 // rate)
            assert counter.at(first_ns) == bits % turn_bits
            assert bits == 0 or counter.at(first_ns - 1) == (bits - 1) % turn_bits
        assert counter.half_turn_ns == (1 << 31) * 10**9 // rate
        assert counter.age_ns(7, -(-1007 * 10**9 // rate)) == 1000 * 10**9 // rate
    counter = subject.BitCounter(RATE)
    for start_ns in (0, BIT_NS, TURN_NS - 20 * MS, TURN_NS - BIT_NS, TURN_NS, 3 * TURN_NS - 10 * MS):
        stamp = counter.at(start_ns)
        for age_bits in (0, 1, 5000, 10_000, (1 << 31) - 1, 1 << 31, (1 << 32) - (1 << 20) - 1):
            assert counter.age_ns(stamp, start_ns + age_bits * BIT_NS) == age_bits * BIT_NS
            assert counter.age_ns(stamp, start_ns + age_bits * BIT_NS + BIT_NS - 1) == age_bits * BIT_NS
        # The last 2^20 bit times of the turn are a stamp that lies ahead.
        for ahead_bits in (1, 1 << 20):
            assert counter.age_ns(stamp, start_ns + TURN_NS - ahead_bits * BIT_NS) == 0
    half_ns = TURN_NS // 2
    for start_ns in (0, TURN_NS - 10 * MS):
        age = subject.MessageAge(counter)
        age.accept(counter.at(start_ns))
        assert age.ns(start_ns + half_ns - BIT_NS) == half_ns - BIT_NS
        assert age.ns(start_ns + 30 * MS) == 30 * MS
        assert age.ns(start_ns + half_ns) == half_ns
        for later_ns in (half_ns + MS, TURN_NS, TURN_NS + 10 * MS, 2 * TURN_NS):
            assert age.ns(start_ns + later_ns) == half_ns
        age.accept(counter.at(start_ns + TURN_NS))
        assert age.ns(start_ns + TURN_NS + 20 * MS) == 20 * MS
    just = subject.MessageAge(counter)
    assert just.ns(half_ns) == half_ns
    assert just.ns(TURN_NS + 10 * MS) == half_ns
    before = subject.MessageAge(counter)
    assert before.ns(300 * MS) == 300 * MS


@pytest.mark.parametrize(("subject", "sweep"), [(module, sweep_module), (timestamp, sweep_timestamp)])
def test_sweep(subject: ModuleType, sweep: Any) -> None:
    sweep(subject)


#: Mutants whose change nobody can see.
EQUIVALENT = {
    # Within the first bit time the count is 0, whether it is taken from here or computed.
    module: {f"Ecan.__init__: self._now_ns, self._now_bits = ({now_ns}, 0)" for now_ns in (1, -1)},
    timestamp: set(),
}


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(("subject", "sweep"), [(module, sweep_module), (timestamp, sweep_timestamp)])
def test_every_mutant_is_noticed(subject: ModuleType, sweep: Any) -> None:
    count, alive = survivors(subject, [sweep])
    assert {mutant.key for mutant in alive} == EQUIVALENT[subject]
    assert count >= 15


def test_a_full_mailbox_is_overwritten_and_says_so() -> None:
    ecan = Ecan([box(0, 5)], BitCounter(RATE))
    for k in range(4):
        assert ecan.receive(Frame(5, bytes([k])), k * 10 * MS) == 0
    assert ecan.counters == {"lost_messages": 3}
    assert ecan.stamps[0] == 3 * 5000
    assert ecan.read(0) == Frame(5, b"\x03")
    assert ecan.read(0) is None
    ecan.receive(Frame(5, b"\x04"), 50 * MS)
    assert ecan.lost_messages == 3


def test_protected_mailboxes_fill_one_after_the_other_then_nothing_is_said() -> None:
    ecan = Ecan([box(2, 5, overwrite=False), box(1, 5, overwrite=False), box(0, 5)], BitCounter(RATE))
    assert [ecan.receive(Frame(5, bytes([k])), 0) for k in range(5)] == [2, 1, 0, 0, 0]
    assert ecan.lost_messages == 2
    assert [ecan.read(number) for number in (2, 1, 0)] == [Frame(5, b"\0"), Frame(5, b"\1"), Frame(5, b"\4")]
    closed = Ecan([box(2, 5, overwrite=False)], BitCounter(RATE))
    assert [closed.receive(Frame(5, b""), 0) for _ in range(3)] == [2, -1, -1]
    assert closed.counters == {"lost_unseen": 2}


def test_guard_ages_right_across_the_wrap_of_a_long_run(lvshun) -> None:
    """26 000 s, three wraps: a telegram every 10 ms around each wrap, then silence, at the same thresholds as ever."""
    guard, counter = Guard(lvshun), BitCounter(RATE)
    life = 0
    for turn in range(1, 4):
        edge_ns = turn * TURN_NS // (10 * MS) * 10 * MS
        for now_ns in range(edge_ns - 200 * MS, edge_ns + 10 * MS, 10 * MS):
            life = (life + 1) % 16
            guard.speed(TrnSpeed(0, life=life), now_ns, counter.at(now_ns))
            if life % 2 == 0:
                guard.notch(0, now_ns)
        assert guard.level is WatchLevel.NORMAL
        # Eight polls, a full turn of the life sign, so that none of the delay is left that they seem to show.
        for age_ms in (10, 20, 21, 64, 65, 255, 256, 257):
            guard.notch(0, edge_ns + age_ms * MS)
            expected = (age_ms > 20) + (age_ms > 64) + (age_ms > 256)
            # At standstill the ladder gives the service brake free again and demands it anew.
            assert guard.level == expected, (turn, age_ms)


def test_guard_takes_the_age_from_the_stamp_not_from_the_reading(lvshun) -> None:
    guard, counter = Guard(lvshun), BitCounter(RATE)
    guard.speed(TrnSpeed(100_000, life=1), 1000 * MS, counter.at(990 * MS))
    guard.notch(0, 1010 * MS)
    assert guard.level is WatchLevel.NORMAL
    guard.notch(0, 1011 * MS)
    assert guard.level is WatchLevel.HOLD


def test_guard_never_takes_a_channel_dead_for_hours_for_a_young_one(lvshun) -> None:
    guard = Guard(lvshun)
    guard.speed(TrnSpeed(0, life=1), 0, 0)
    for hour in range(1, 40):
        guard.notch(0, hour * 900 * 1000 * MS)
        assert guard.level is WatchLevel.SERVICE_BRAKE


def test_clock_set_back_a_little_is_no_age(lvshun) -> None:
    """TIME_SYNC takes back what repeated polls had put ahead: the stamp then lies in the future."""
    guard, counter = Guard(lvshun), BitCounter(RATE)
    guard.speed(TrnSpeed(100_000, life=1), 1000 * MS, counter.at(1000 * MS))
    guard.notch(0, 960 * MS)
    assert guard.level is WatchLevel.NORMAL
    age = MessageAge(counter)
    age.accept(counter.at(1000 * MS))
    assert age.ns(960 * MS) == 0
