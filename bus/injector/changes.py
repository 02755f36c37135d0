"""Faults that change telegrams: their signals, counters, check sequences and frames. Nothing is held back here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from railhil.bus.frame import FD, REMOTE, Frame
from railhil.bus.injector.follower import raw_of
from railhil.bus.injector.telegram_frames import (
    Telegram,
    checks_of,
    data_of,
    with_checks,
    with_data,
    with_signal,
)
from railhil.dbc import Port, Signal
from railhil.faults.activity import Activity
from railhil.faults.model import Random


class Change(Protocol):
    """One fault at one port; it sees every telegram of the port."""

    def __call__(self, frames: Telegram, now_ns: int) -> Telegram:
        """The telegram as it leaves; unchanged if the fault does nothing to it."""


class SignalChange:
    """Another value of a signal, with the check sequences that go with it."""

    def __init__(self, activity: Activity, port: Port, signal: Signal, random: Random) -> None:
        self._activity = activity
        self._port = port
        self._signal = signal
        self._random = random
        self._low, self._high = signal.raw_range
        self._first: int | None = None

    def __call__(self, frames: Telegram, now_ns: int) -> Telegram:
        if not self._activity.active:
            return frames
        data = data_of(self._port, frames)
        before = raw_of(data, self._signal)
        raw = self._raw(before)
        return frames if raw == before else with_data(self._port, frames, with_signal(data, self._signal, raw))

    def _raw(self, before: int) -> int:
        fault = self._activity.fault
        scale = self._signal.scale
        match fault.what:
            case "value":
                raw = round(fault.parameter("value") / scale)
            case "raw":
                raw = round(fault.parameter("value"))
            case "offset":
                raw = before + round(fault.parameter("error") / scale)
            case "scale":
                raw = round(before * fault.parameter("factor"))
            case "random":
                raw = int(self._random.integers(self._low, self._high + 1))
            case _:
                if self._first is None:
                    self._first = before
                raw = self._first
        return min(max(raw, self._low), self._high)


class CounterChange:
    """Another life sign, with the check sequences that go with it; afterwards the counter may continue elsewhere."""

    def __init__(self, activity: Activity, port: Port, signal: Signal, random: Random) -> None:
        self._activity = activity
        self._port = port
        self._signal = signal
        self._random = random
        self._modulus = 1 << signal.length
        self._last_valid: int | None = None
        self._last: int | None = None
        # Number that is added to every counter after the fault.
        self._afterwards: int | None = None

    def __call__(self, frames: Telegram, now_ns: int) -> Telegram:
        activity = self._activity
        data = data_of(self._port, frames)
        before = raw_of(data, self._signal)
        if activity.active:
            raw = self._raw(before)
            self._last = raw
        elif activity.begun_ns is None:
            self._last_valid = before
            return frames
        else:
            if self._afterwards is None:
                self._afterwards = self._continued(before)
            raw = (before + self._afterwards) % self._modulus
        return frames if raw == before else with_data(self._port, frames, with_signal(data, self._signal, raw))

    def _raw(self, before: int) -> int:
        fault = self._activity.fault
        match fault.what:
            case "value":
                return int(fault.parameter("value")) % self._modulus
            case "offset":
                return (before + int(fault.parameter("offset"))) % self._modulus
            case "random":
                return int(self._random.integers(0, self._modulus))
        # Frozen at the value of the last telegram before the fault.
        if self._last_valid is None:
            self._last_valid = before
        return self._last_valid

    def _continued(self, before: int) -> int:
        start = {"last_valid": self._last_valid, "last": self._last}.get(self._activity.fault.after)
        return 0 if start is None else (start + 1 - before) % self._modulus


class ChecksChange:
    """Other check sequences; the data stay."""

    def __init__(self, activity: Activity, port: Port, random: Random) -> None:
        self._activity = activity
        self._port = port
        self._random = random
        self._first: bytes | None = None

    def __call__(self, frames: Telegram, now_ns: int) -> Telegram:
        if not self._activity.active:
            # Frozen at the check sequences of the last telegram before the fault.
            self._first = checks_of(self._port, frames)
            return frames
        return with_checks(self._port, frames, self._changed)

    def _changed(self, checks: bytes) -> bytes:
        fault = self._activity.fault
        match fault.what:
            case "value":
                return bytes([int(fault.parameter("value"))]) * len(checks)
            case "offset":
                return bytes((octet + int(fault.parameter("offset"))) % 256 for octet in checks)
            case "random":
                return bytes(int(self._random.integers(0, 256)) for _ in checks)
        if self._first is None:
            self._first = checks
        return self._first


class TimeChange:
    """Another time in TIME_SYNC."""

    def __init__(self, activity: Activity, port: Port) -> None:
        self._activity = activity
        self._port = port
        signals = {signal.name: signal for signal in port.signals}
        self._seconds, self._ticks = signals["TimeSeconds"], signals["TimeTicks"]
        self._first: int | None = None

    def __call__(self, frames: Telegram, now_ns: int) -> Telegram:
        activity, fault = self._activity, self._activity.fault
        if not activity.active:
            return frames
        data = data_of(self._port, frames)
        before = raw_of(data, self._seconds) << self._ticks.length | raw_of(data, self._ticks)
        per_s = 1 << self._ticks.length
        if fault.what == "step":
            told = before + round(fault.parameter("error_s") * per_s)
        elif fault.what == "drift":
            since_s = (now_ns - (activity.begun_ns or 0)) / 1e9
            told = before + round(fault.parameter("rate_ppm") * 1e-6 * since_s * per_s)
        else:
            if self._first is None:
                self._first = before
            told = self._first
        told = max(told, 0)
        if told == before:
            return frames
        changed = with_signal(data, self._seconds, told >> self._ticks.length)
        return with_data(self._port, frames, with_signal(changed, self._ticks, told % per_s))


class FrameChange:
    """Corrupted, truncated, repeated, older or foreign frames instead of a telegram's own.

    :param other: ``masquerade``: the port on whose identifiers the frames appear.
    """

    def __init__(self, activity: Activity, random: Random, other: Port | None = None) -> None:
        self._activity = activity
        self._random = random
        self._other = other
        self._first: Telegram | None = None
        # ``replay``: telegrams with the instants at which they were due to leave.
        self._past: list[tuple[int, Telegram]] = []
        change: dict[str, Callable[[Telegram, int], Telegram]] = {
            "corrupt": self._corrupt,
            "truncate": self._truncate,
            "masquerade": self._masquerade,
            "remote": self._remote,
            "stuck": self._stuck,
            "replay": self._replay,
        }
        self._change = change[activity.fault.what]

    def __call__(self, frames: Telegram, now_ns: int) -> Telegram:
        if self._activity.fault.what == "replay" and not self._activity.over:
            self._past.append((now_ns, frames))
        return self._change(frames, now_ns) if self._activity.active else frames

    def _corrupt(self, frames: Telegram, now_ns: int) -> Telegram:
        fault, random = self._activity.fault, self._random
        if random.random() >= fault.parameter("share"):
            return frames
        place = int(random.integers(0, len(frames)))
        data = bytearray(frames[place].data)
        left = list(range(len(data) * 8))
        for _ in range(min(int(fault.parameter("bits")), len(left))):
            bit = left.pop(int(random.integers(0, len(left))))
            data[bit // 8] ^= 0x80 >> bit % 8
        return [*frames[:place], frames[place]._replace(data=bytes(data)), *frames[place + 1 :]]

    def _truncate(self, frames: Telegram, now_ns: int) -> Telegram:
        left = int(self._activity.fault.parameter("bytes"))
        return [frame._replace(data=frame.data[:left]) for frame in frames]

    def _masquerade(self, frames: Telegram, now_ns: int) -> Telegram:
        assert self._other is not None
        ids = (self._other.fd_id,) if frames[0].flags & FD else self._other.can_ids
        return [frame._replace(can_id=ids[min(index, len(ids) - 1)]) for index, frame in enumerate(frames)]

    def _remote(self, frames: Telegram, now_ns: int) -> Telegram:
        # CAN FD has no remote frames: on such a bus, too, they are classic ones.
        return [Frame(frame.can_id, bytes(min(len(frame.data), 8)), REMOTE) for frame in frames]

    def _stuck(self, frames: Telegram, now_ns: int) -> Telegram:
        if self._first is None:
            self._first = frames
        return self._first

    def _replay(self, frames: Telegram, now_ns: int) -> Telegram:
        wanted_ns = now_ns - round(self._activity.fault.parameter("age_s") * 1e9)
        while len(self._past) > 1 and self._past[1][0] <= wanted_ns:
            self._past.pop(0)
        return self._past[0][1] if self._past[0][0] <= wanted_ns else frames
