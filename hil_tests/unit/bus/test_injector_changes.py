"""Faults that change a telegram: what leaves, byte for byte, in both forms of every size."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.scripted import Scripted
from railhil.bus.frame import BRS, FD, REMOTE, Frame
from railhil.bus.injector.changes import (
    ChecksChange,
    CounterChange,
    FrameChange,
    SignalChange,
    TimeChange,
)
from railhil.bus.injector.follower import raw_of
from railhil.bus.injector.telegram_frames import (
    Telegram,
    checks_of,
    data_of,
    is_whole,
    shown,
    with_checks,
    with_data,
    with_signal,
)
from railhil.bus.mvb import TelegramSource, check_sequence
from railhil.bus.telegrams import TimeSync
from railhil.dbc import Port, Signal
from railhil.faults.activity import Activity
from railhil.faults.capability import life_signal
from railhil.faults.language import parse
from railhil.wire.ato import TrkInfo, TrnPos, TrnSpeed

S = 1_000_000_000
SPEED = TrnSpeed.port()
SIZES = [
    Port("F0", 0x400, 0, 0, "plant", "publish", "", ()), SPEED, TrnPos.port(), TrkInfo.port(),
    Port("F4", 0x600, 4, 0, "plant", "publish", "", ()),
]  # fmt: skip


def signal_of(port: Port, name: str) -> Signal:
    return next(one for one in port.signals if one.name == name)


def count(port: Port, first: int) -> bytes:
    return bytes((first + 3 * index) % 256 for index in range(port.data_bytes))


@pytest.mark.parametrize(
    ("port", "fd"),
    [(port, fd) for port in SIZES for fd in (False, True) if not (fd and port.single_frame)],
    ids=lambda item: getattr(item, "name", "fd" if item else "classic"),
)
def test_other_data_give_the_telegram_of_a_source(port: Port, fd: bool) -> None:
    one, other = TelegramSource(port, fd), TelegramSource(port, fd)
    for _ in range(3):
        # The telegram's own sequence counter stays.
        ours, theirs = one.frames(count(port, 5)), other.frames(count(port, 100))
    assert is_whole(port, ours)
    assert data_of(port, ours) == count(port, 5)
    assert with_data(port, ours, count(port, 100)) == theirs
    data = count(port, 5)
    sums = bytes(check_sequence(data[start : start + 8]) for start in range(0, len(data), 8))
    assert checks_of(port, ours) == sums
    wrong = bytes(octet ^ 0x5A for octet in sums)
    changed = with_checks(port, ours, lambda checks: bytes(octet ^ 0x5A for octet in checks))
    assert checks_of(port, changed) == wrong
    assert data_of(port, changed) == data
    assert with_checks(port, changed, lambda _: sums) == ours
    if len(ours) > 1:
        assert not is_whole(port, ours[:-1])
        assert not is_whole(port, [*ours[1:], ours[0]])
        assert not is_whole(port, ours[-1:])
        assert shown(ours[:2]) == f"{ours[0].can_id:03X}#{ours[0].data.hex().upper()} {ours[1].can_id:03X}#" + (
            ours[1].data.hex().upper()
        )


def test_a_signal_among_its_neighbours() -> None:
    signal = Signal("X", byte=1, msb=5, length=3)
    ones = b"\xff" * 4
    for raw in range(8):
        for data in (bytes(4), ones):
            changed = with_signal(data, signal, raw)
            assert raw_of(changed, signal) == raw
            # The bits beside it stay.
            assert with_signal(changed, signal, 0) == with_signal(data, signal, 0)
            assert with_signal(changed, signal, 7) == with_signal(data, signal, 7)
    assert with_signal(bytes(4), signal, 7) == b"\0\x38\0\0"
    # It wraps if it does not fit.
    assert with_signal(bytes(4), signal, 9) == with_signal(bytes(4), signal, 1)
    assert with_signal(bytes(4), signal, -1) == with_signal(bytes(4), signal, 7)
    signed = replace(signal, signed=True)
    assert [raw_of(with_signal(ones, signed, raw), signed) for raw in (-4, -1, 0, 3)] == [-4, -1, 0, 3]


class Speeds:
    """A fault at TRN_SPEED: telegrams go in with speed and life sign, and are read where they come out."""

    def __init__(self, text: str, numbers: tuple[float, ...] = ()) -> None:
        self.fault = Activity(parse(text), 1)
        self.random = Scripted(numbers)
        self._source = TelegramSource(SPEED)
        life = life_signal(SPEED)
        assert life is not None
        part = self.fault.fault.place.part
        self.change = (
            CounterChange(self.fault, SPEED, life, self.random)
            if part == "counter"
            else ChecksChange(self.fault, SPEED, self.random)
            if part == "checksum"
            else SignalChange(self.fault, SPEED, signal_of(SPEED, part), self.random)
            if part
            else FrameChange(self.fault, self.random)
        )

    def made(self, speed: int = 1000, life: int = 3) -> Telegram:
        data = with_signal(bytes(4), signal_of(SPEED, "TrainSpeed"), speed)
        return self._source.frames(with_signal(data, signal_of(SPEED, "SpeedLife"), life))

    def sent(self, active: bool, speed: int = 1000, life: int = 3) -> Telegram:
        self.fault.active = active
        if active and self.fault.begun_ns is None:
            self.fault.begun_ns = 0
        given = self.made(speed, life)
        left = self.change(given, 0)
        assert active or left is given or self.fault.fault.place.part == "counter"
        return left

    def speed(self, speed: int = 1000) -> int:
        """Speed that leaves under the fault; life sign and check sequences fit."""
        return self._read(self.sent(True, speed), "TrainSpeed")

    def life(self, active: bool, life: int) -> int:
        return self._read(self.sent(active, life=life), "SpeedLife")

    def _read(self, frames: Telegram, name: str) -> int:
        data = data_of(SPEED, frames)
        assert frames == self._source.frames(data)
        return raw_of(data, signal_of(SPEED, name))


def test_values_of_a_signal() -> None:
    """1 m/s is 10 000."""
    low, high = -(1 << 23), (1 << 23) - 1
    for text, speed, wanted in (
        ("value 2.5", 1000, 25_000), ("value -2.5", 1000, -25_000), ("value 1e6", 1000, high),
        ("value -1e6", 1000, low), ("raw 77", 1000, 77), ("offset 0.5", 1000, 6000), ("offset -0.5", 1000, -4000),
        ("offset 800", 5_000_000, high), ("scale 1.5", 1001, 1502), ("scale -2", 1000, -2000),
    ):  # fmt: skip
        assert Speeds(f"TRN_SPEED.TrainSpeed {text} @0s").speed(speed) == wanted, text
    drawn = Speeds("TRN_SPEED.TrainSpeed random @0s", (-5, 7))
    assert (drawn.speed(), drawn.speed()) == (-5, 7)
    assert drawn.random.ranges == [(low, high + 1)] * 2
    stuck = Speeds("TRN_SPEED.TrainSpeed stuck @0s")
    stuck.sent(False, 500)
    # At the value of the fault's first telegram.
    assert [stuck.speed(speed) for speed in (600, 700, 500)] == [600, 600, 600]
    zero = Speeds("TRN_SPEED.TrainSpeed stuck @0s")
    assert [zero.speed(speed) for speed in (0, 700)] == [0, 0]


def test_a_value_that_changes_nothing_leaves_the_telegram_alone() -> None:
    for text in ("TRN_SPEED.TrainSpeed raw 1000 @0s", "TRN_SPEED.counter value 3 @0s"):
        given = Speeds(text)
        given.fault.active, given.fault.begun_ns = True, 0
        frames = given.made()
        assert given.change(frames, 0) is frames


def lives(text: str, *, before: int = 3, numbers: tuple[float, ...] = ()) -> tuple[list[int], list[int]]:
    """Counters 14, 15, 0 under the fault (``before`` telegrams before it), and those of the next three."""
    given = Speeds(text, numbers)
    for life in range(14 - before, 14):
        assert given.life(False, life) == life
    under = [given.life(True, life) for life in (14, 15, 0)]
    return under, [given.life(False, life) for life in (1, 2, 15)]


def test_values_of_a_counter() -> None:
    assert lives("TRN_SPEED.counter value 5 @0s") == ([5, 5, 5], [1, 2, 15])
    assert lives("TRN_SPEED.counter value 21 @0s")[0] == [5, 5, 5]
    assert lives("TRN_SPEED.counter offset 3 @0s") == ([1, 2, 3], [1, 2, 15])
    assert lives("TRN_SPEED.counter random @0s", numbers=(9, 0, 4)) == ([9, 0, 4], [1, 2, 15])
    # Frozen at that of the last telegram before the fault, or its first one.
    assert lives("TRN_SPEED.counter freeze @0s") == ([13, 13, 13], [1, 2, 15])
    assert lives("TRN_SPEED.counter freeze @0s", before=0) == ([14, 14, 14], [1, 2, 15])
    given = Speeds("TRN_SPEED.counter random @0s", (1,))
    given.life(True, 1)
    assert given.random.ranges == [(0, 16)]


def test_how_a_counter_continues() -> None:
    """It goes on counting from the last valid one, or from the last one sent."""
    assert lives("TRN_SPEED.counter value 5 @0s after last_valid")[1] == [14, 15, 12]
    assert lives("TRN_SPEED.counter value 5 @0s after last")[1] == [6, 7, 4]
    assert lives("TRN_SPEED.counter value 5 @0s after last_valid", before=0)[1] == [1, 2, 15]
    assert lives("TRN_SPEED.counter freeze @0s after last", before=0)[1] == [15, 0, 13]


def test_values_of_the_check_sequences() -> None:
    def checks(text: str, numbers: tuple[float, ...] = ()) -> list[bytes]:
        given = Speeds(text, numbers)
        given.sent(False, 1)
        given.sent(False, 2)
        found = [given.sent(True, speed) for speed in (3, 4)]
        assert [data_of(SPEED, frames) for frames in found] == [
            data_of(SPEED, given.made(speed)) for speed in (3, 4)
        ], "the data stay"
        assert set(given.random.ranges) <= {(0, 256)}
        return [checks_of(SPEED, frames) for frames in found]

    def own(speed: int) -> int:
        return checks_of(SPEED, Speeds("TRN_SPEED stuck @0s").made(speed))[0]

    assert checks("TRN_SPEED.checksum value 77 @0s") == [b"M", b"M"]
    assert checks("TRN_SPEED.checksum offset 200 @0s") == [bytes([(own(speed) + 200) % 256]) for speed in (3, 4)]
    assert checks("TRN_SPEED.checksum random @0s", (8, 9)) == [b"\x08", b"\x09"]
    assert checks("TRN_SPEED.checksum freeze @0s") == [bytes([own(2)])] * 2
    first = Speeds("TRN_SPEED.checksum freeze @0s")
    assert [checks_of(SPEED, first.sent(True, speed))[0] for speed in (5, 6)] == [own(5)] * 2


def test_each_block_has_its_own_check_sequence() -> None:
    port = TrkInfo.port()
    activity = Activity(parse("TRK_INFO.checksum value 1 @0s"), 1)
    activity.active = True
    frames = TelegramSource(port).frames(count(port, 9))
    assert checks_of(port, ChecksChange(activity, port, Scripted())(frames, 0)) == b"\1\1"
    activity = Activity(parse("TRK_INFO.checksum random @0s"), 1)
    activity.active = True
    assert checks_of(port, ChecksChange(activity, port, Scripted((3, 4)))(frames, 0)) == b"\3\4"


def test_other_times() -> None:
    """2^-16 s is the unit of the ticks."""
    port = TimeSync.port()
    seconds, ticks = signal_of(port, "TimeSeconds"), signal_of(port, "TimeTicks")

    def frames(time_s: float) -> Telegram:
        told = round(time_s * 65536)
        data = with_signal(count(port, 1), seconds, told >> 16)
        return TelegramSource(port).frames(with_signal(data, ticks, told % 65536))

    def told(text: str, *times: tuple[float, int], begun_ns: int | None = 2 * S) -> list[float]:
        activity = Activity(parse(text), 1)
        activity.active, activity.begun_ns = True, begun_ns
        change, found = TimeChange(activity, port), []
        for time_s, now_ns in times:
            given = frames(time_s)
            left = change(given, now_ns)
            data = data_of(port, left)
            assert left == TelegramSource(port).frames(data)
            found.append(raw_of(data, seconds) + raw_of(data, ticks) / 65536)
            # What is not the time stays.
            assert data[6:] == data_of(port, given)[6:]
            assert (left is given) == (found[-1] == time_s)
        return found

    assert told("clock.time step 1.5s @0s", (10.75, 0)) == [12.25]
    assert told("clock.time step -1.5s @0s", (10.75, 0), (1.0, 0)) == [9.25, 0.0]
    assert told("clock.time step 0s @0s", (10.75, 0)) == [10.75]
    # 62 500 ppm: 1/16 s in each second.
    assert told("clock.time drift 62500ppm @0s", (10.0, 2 * S), (12.0, 4 * S)) == [10.0, 12.125]
    assert told("clock.time drift 62500ppm @0s", (12.0, 4 * S), begun_ns=None) == [12.25]
    # After eleven days each unit of the ticks is still right.
    assert told("clock.time drift 62500ppm @0s", (10.0, (1 << 20) * S), begun_ns=0) == [10.0 + (1 << 16)]
    assert told("clock.time stuck @0s", (10.5, 0), (11.5, S)) == [10.5, 10.5]
    assert told("clock.time stuck @0s", (0.0, 0), (11.5, S)) == [0.0, 0.0]
    idle = Activity(parse("clock.time step 1s @0s"), 1)
    given = frames(1.0)
    assert TimeChange(idle, port)(given, 0) is given


FRAMES = [Frame(0x120, bytes(range(8))), Frame(0x124, b"\xff" * 8)]


def framed(text: str, numbers: tuple[float, ...] = (), other: Port | None = None) -> tuple[FrameChange, Scripted]:
    activity = Activity(parse(text), 1)
    activity.active = True
    random = Scripted(numbers)
    return FrameChange(activity, random, other), random


def test_flipped_bits() -> None:
    change, random = framed("TRN_POS corrupt 50% bits 2 @0s", (0.5, 0.499, 1, 0, 0))
    # A share that is not below it does nothing.
    assert change(FRAMES, 0) is FRAMES
    # In the second frame the first bit, and of the others the first.
    assert change(FRAMES, 0) == [FRAMES[0], Frame(0x124, b"\x3f" + b"\xff" * 7)]
    assert random.ranges == [(0, 2), (0, 64), (0, 63)]
    change, random = framed("TRN_POS corrupt bits 3 @0s", (0.0, 0, 63, 8, 8))
    assert change(FRAMES, 0) == [Frame(0x120, b"\0\xc1\2\3\4\5\6\6"), FRAMES[1]]
    assert random.ranges == [(0, 2), (0, 64), (0, 63), (0, 62)]
    # Not more bits than there are.
    short = [Frame(0x120, b"\xa5", FD)]
    change, random = framed("TRN_POS corrupt bits 20 @0s", (0.0, 0, *([0] * 8)))
    assert change(short, 0) == [Frame(0x120, b"\x5a", FD)]
    assert random.left == 0
    change, random = framed("TRN_POS corrupt bits 7 @0s", (0.0, 0, *([0] * 7)))
    assert change(short, 0) == [Frame(0x120, b"\x5b", FD)]


def test_truncated_remote_and_foreign_frames() -> None:
    change, _ = framed("TRN_POS truncate 3 @0s")
    assert change(FRAMES, 0) == [Frame(0x120, b"\0\1\2"), Frame(0x124, b"\xff" * 3)]
    change, _ = framed("TRN_POS remote @0s")
    assert change([*FRAMES, Frame(0x125, bytes(16), FD | BRS), Frame(0x1, b"ab")], 0) == [
        Frame(0x120, bytes(8), REMOTE), Frame(0x124, bytes(8), REMOTE), Frame(0x125, bytes(8), REMOTE),
        Frame(0x1, bytes(2), REMOTE),
    ]  # fmt: skip
    other = TrkInfo.port()
    change, _ = framed("TRN_POS masquerade TRK_INFO @0s", other=other)
    assert [one.can_id for one in change(FRAMES, 0)] == [0x130, 0x131]
    assert [one.data for one in change(FRAMES, 0)] == [one.data for one in FRAMES]
    # More frames than the other port has: on its last one.
    assert [one.can_id for one in change([*FRAMES, *FRAMES], 0)] == [0x130, 0x131, 0x134, 0x134]
    assert change([Frame(0x125, bytes(16), FD)], 0) == [Frame(0x135, bytes(16), FD)]


def test_a_telegram_that_is_stuck() -> None:
    change, _ = framed("TRN_POS stuck @0s")
    first = list(FRAMES)
    assert change(first, 0) is first
    assert change([], 0) is first


def test_a_replay_has_the_newest_telegram_of_its_age() -> None:
    activity = Activity(parse("TRN_POS replay 1s @0s"), 1)
    change = FrameChange(activity, Scripted())
    telegrams = [[Frame(number, b"")] for number in range(8)]
    assert change(telegrams[0], 0) is telegrams[0]
    assert change(telegrams[1], S // 2) is telegrams[1]
    activity.active = True
    # Nothing is that old yet.
    assert FrameChange(activity, Scripted())(telegrams[2], 9 * S) is telegrams[2]
    assert change(telegrams[2], S - 1) is telegrams[2]
    assert change(telegrams[3], S) is telegrams[0]
    assert change(telegrams[4], S + S // 2 - 1) is telegrams[0]
    assert change(telegrams[5], S + S // 2) is telegrams[1]
    assert change(telegrams[6], 2 * S + 1) is telegrams[3]
    old, _ = framed("TRN_POS replay 100s @0s")
    assert old(telegrams[0], 0) is telegrams[0]
    assert old(telegrams[1], 100 * S - 1) is telegrams[1]
    assert old(telegrams[2], 100 * S) is telegrams[0]
    activity.active, activity.over = False, True
    assert change(telegrams[7], 3 * S) is telegrams[7]
    # After the end nothing is kept.
    assert len(change._past) == len({id(frames) for _, frames in change._past}) == 4
