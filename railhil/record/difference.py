"""The first frame in which two records differ, decoded: port, signals, values before and now."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from railhil.bus.frame import FD, Frame
from railhil.bus.mvb import master_tail
from railhil.bus.own_frames import OwnFrames
from railhil.dbc import Contract, Port, Signal

#: A frame and its simulation time in ns.
Timed = tuple[int, Frame]
#: Parts of a frame that follow from its signals and its port.
_CHECK, _CHECKS, _MASTER = "check sequence", "check sequences", "master word"


@dataclass(frozen=True, slots=True)
class Difference:
    """The first difference of two records.

    ``line``: of the log, from 1 on; ``time_s``: simulation time there. ``frame``: port or poll, with its source; empty
    if the two are not the same part of the same telegram. ``recorded``, ``repeated``: both frames in words, empty after
    the end of a record. ``signals``: the signals that differ: name, value recorded, value now.
    """

    line: int
    time_s: float
    frame: str
    recorded: str
    repeated: str
    signals: tuple[tuple[str, str, str], ...] = ()

    @property
    def sentence(self) -> str:
        """One line for the console."""
        where = f"line {self.line}, {self.time_s:.6g} s"
        if not self.recorded:
            return f"{where}: the record has ended, now {self.repeated}"
        if not self.repeated:
            return f"{where}: recorded {self.recorded}, now the run has ended"
        if self.frame:
            values = ", ".join(f"{name} {old} -> {new}" for name, old, new in self.signals)
            return f"{where}, {self.frame}: {values} (recorded -> now)"
        return f"{where}: recorded {self.recorded}, now {self.repeated}"

    def as_json(self) -> dict[str, Any]:
        """All fields; signals as objects."""
        return {
            "line": self.line,
            "time_s": self.time_s,
            "frame": self.frame or None,
            "recorded": self.recorded or None,
            "repeated": self.repeated or None,
            "signals": [{"name": name, "recorded": old, "repeated": new} for name, old, new in self.signals],
        }


class FrameWords:
    """Frames of a wire contract in words, each decoded by itself."""

    def __init__(self, contract: Contract) -> None:
        self._poll_id = contract.poll_id
        self._own = OwnFrames(contract)
        # CAN identifier -> port and block; -1 the trailer, None the CAN FD form.
        self._parts: dict[int, tuple[Port, int | None]] = {}
        for port in contract.ports:
            self._parts |= {port.address + block: (port, block) for block in range(port.blocks)}
            self._parts |= {} if port.single_frame else {port.address + 4: (port, -1)}
            self._parts[port.fd_id] = port, None
        self._polled = {master_tail(port.f_code, port.address): port.name for port in contract.ports}

    def name(self, frame: Frame) -> str:
        """Kind of the frame: port and source, a poll, or a frame of no port."""
        is_own = frame in self._own
        if is_own and frame.can_id == self._poll_id:
            asked = self._polled.get(frame.data)
            return f"poll of {asked}" if asked else f"poll {frame.data.hex().upper()}"
        port, part = self._parts.get(frame.can_id, (None, None))
        if port is None or not is_own:
            return f"frame {frame.can_id:03X} of no port"
        block = f" block {part}" if part is not None and port.blocks > 1 and part >= 0 else ""
        return f"{port.name}{' trailer' if part == -1 else block} ({port.source})"

    def values(self, frame: Frame) -> dict[str, str]:
        """Signals of the frame with unit, then check sequences and its other fields, in readable form."""
        data = frame.data
        found = {"flags": f"{frame.flags:X}"} if frame.flags & ~FD else {}
        port, part = self._parts.get(frame.can_id, (None, None))
        if port is None or frame not in self._own:
            return found | {"data": data.hex().upper()}
        if part == -1:
            return found | _trailer(data, port.blocks)
        whole = part is None and not port.single_frame
        size = port.data_bytes if whole or port.single_frame else 8
        first = 0 if part is None else part
        for signal in port.signals:
            if whole or signal.block == first:
                found[signal.name] = _shown(signal, data[:size], 0 if whole else first * 64)
        rest = data[size:]
        return found | (
            _trailer(rest, port.blocks) if whole else {"check sequence": rest.hex().upper()} if rest else {}
        )

    def of(self, timed: Timed | None) -> str:
        """A frame with its time and all of its fields; empty for None."""
        if timed is None:
            return ""
        time_ns, frame = timed
        values = ", ".join(f"{name} {value}" for name, value in self.values(frame).items())
        return f"{self.name(frame)} at {time_ns / 1e9:.6g} s: {values}"


def _tail(data: bytes) -> dict[str, str]:
    """The fields behind the process data in a single frame."""
    return {_CHECK: data[4:5].hex().upper(), _MASTER: data[5:].hex().upper()}


def _trailer(data: bytes, blocks: int) -> dict[str, str]:
    """The fields of the trailer of a longer telegram."""
    sequence = str(data[4] >> 4) if len(data) > 4 else "none"
    return {_CHECKS: data[:blocks].hex().upper(), "sequence": sequence, _MASTER: data[5:].hex().upper()}


def _shown(signal: Signal, data: bytes, offset_bits: int) -> str:
    """Value of a signal in ``data``, which begins ``offset_bits`` after the start of the telegram."""
    shift = len(data) * 8 - (signal.first_bit - offset_bits) - signal.length
    if shift < 0:
        return "missing"
    raw = int.from_bytes(data) >> shift & ((1 << signal.length) - 1)
    if raw > signal.raw_range[1]:
        raw -= 1 << signal.length
    if raw in signal.values:
        return signal.values[raw]
    return f"{raw * signal.scale:.10g} {'' if signal.unit == '1' else signal.unit}".rstrip()


def difference_of(
    line: int, recorded: Timed | None, repeated: Timed | None, was: FrameWords, now: FrameWords
) -> Difference:
    """The difference of two unequal frames; None for one that is missing."""
    first = recorded or repeated
    assert first is not None
    words = was.of(recorded), now.of(repeated)
    kind = ""
    signals: tuple[tuple[str, str, str], ...] = ()
    if recorded and repeated and recorded[0] == repeated[0] and was.name(recorded[1]) == now.name(repeated[1]):
        kind = was.name(recorded[1])
        old, new = was.values(recorded[1]), now.values(repeated[1])
        names = dict.fromkeys((*old, *new))
        signals = tuple(
            (name, old.get(name, "none"), new.get(name, "none")) for name in names if old.get(name) != new.get(name)
        )
        # Check sequences are reported only where the signals are equal.
        signals = tuple(row for row in signals if row[0] not in (_CHECK, _CHECKS)) or signals
    return Difference(line, first[0] / 1e9, kind, *words, signals)


def first_difference(
    recorded: Iterable[Timed], repeated: Iterable[Timed], was: Contract, now: Contract
) -> Difference | None:
    """The first difference of two records in bus order; None when there is none.

    :param was: wire contract of the first, ``now`` of the second.
    """
    pairs: Iterator[tuple[Timed | None, Timed | None]] = zip_longest(recorded, repeated)
    for line, (old, new) in enumerate(pairs, 1):
        if old != new:
            return difference_of(line, old, new, FrameWords(was), FrameWords(now))
    return None
