"""What is wrong with the answers of a controller, in words: their frames, beside those that the codec makes of the same
data, and their values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, NamedTuple

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.layout import CHECK_CORRECT, FLAG_FALSE, FLAG_TRUE
from railhil.bus.lifesign import Life, LifeSign
from railhil.bus.mvb import TelegramSource, check_sequence, device_status_frame
from railhil.dbc import Contract, Port, Signal

#: Octets of a trailer, and of a telegram of one frame.
_END_BYTES: Final = 8
_COUNT_MASK: Final = 0xF
#: What a life sign does that does not count by one.
_LIFE_WORDS: Final = {Life.DUPLICATE: "stands", Life.GAP: "skips", Life.OUT_OF_ORDER: "goes back"}


class Fault(NamedTuple):
    """A fault of a controller: ``kind`` is the same for all faults that are told in one line, with their number."""

    kind: str
    text: str


@dataclass(frozen=True)
class Form:
    """What an answer has to look like.

    :param blocks: number of data octets that each check sequence covers.
    :param make: the right frames for process data.
    """

    name: str
    can_ids: tuple[int, ...]
    flags: int
    blocks: tuple[int, ...]
    make: Callable[[bytes], list[Frame]]

    @classmethod
    def of_port(cls, port: Port, fd: bool) -> Form:
        """The telegram of a port."""
        blocks = (port.data_bytes,) if port.single_frame else (8,) * port.blocks

        def make(data: bytes) -> list[Frame]:
            return TelegramSource(port, fd).frames(data)

        return cls(port.name, (port.fd_id,) if fd else port.can_ids, FD if fd else 0, blocks, make)

    @classmethod
    def of_device_status(cls, contract: Contract, device: int) -> Form:
        """The answer to a device status poll."""

        def make(data: bytes) -> list[Frame]:
            return [device_status_frame(device, int.from_bytes(data))]

        return cls("device status", (contract.device_status_id,), 0, (2,), make)

    def data(self, frames: Sequence[Frame]) -> bytes:
        """The process data in frames; octets that are missing are 0."""
        size = sum(self.blocks)
        return b"".join(frame.data for frame in frames)[:size].ljust(size, b"\0")

    def end(self, frames: Sequence[Frame]) -> bytes:
        """The octets with the check sequences and the master word."""
        begin = sum(self.blocks) if len(self.blocks) > 1 or self.blocks[0] == _END_BYTES else 0
        return frames[0].data[begin : begin + _END_BYTES] if self.flags & FD else frames[-1].data

    @property
    def is_single(self) -> bool:
        """Whether data and check sequence are in the same 8 octets."""
        return self.blocks[0] < _END_BYTES

    def faults(self, heard: Sequence[Frame]) -> Iterator[Fault]:
        """Everything that is wrong with an answer; none of it is left if the bench would take it.

        :param heard: frames with identifiers of the bench since the poll, at least one.
        """
        for frame in heard:
            if frame.flags & ~BRS != self.flags:
                wanted = "a CAN FD frame" if self.flags else "a classic data frame with a standard identifier"
                text = f"frame {frame.can_id:03X} is {_flags_said(frame.flags)}, right {wanted}"
                yield Fault("form", f"{self.name}: {text}")
                return
        found = tuple(frame.can_id for frame in heard)
        if found != self.can_ids:
            yield Fault(
                "frames", f"{self.name}: frames {ids_words(found)}, right {ids_words(self.can_ids)}, in this order"
            )
            return
        data = self.data(heard)
        right = self.make(data)
        lengths = [
            Fault("length", f"{self.name}: frame {one.can_id:03X} has {len(one.data)} octets, right {len(other.data)}")
            for one, other in zip(heard, right, strict=True)
            if len(one.data) != len(other.data)
        ]
        yield from lengths or self._octets(data, self.end(heard), self.end(right))

    def _octets(self, data: bytes, found: bytes, right: bytes) -> Iterator[Fault]:
        """Faults of check sequences, number of blocks and master word."""
        for number, _ in enumerate(self.blocks):
            at = 4 if self.is_single else number
            name = "check sequence" if self.is_single else f"check sequence of block {number + 1}"
            if found[at] != right[at]:
                hint = self._hint(data, found, right[at], found[at])
                yield Fault(name, f"{self.name}: {name} {found[at]:02X}, right {right[at]:02X}{hint}")
        if not self.is_single and (found[4] ^ right[4]) & _COUNT_MASK:
            count = found[4] & _COUNT_MASK
            yield Fault("count", f"{self.name}: number of blocks {count} in octet 4, right {right[4] & _COUNT_MASK}")
        if found[5:7] != right[5:7]:
            word = f"master word {found[5:7].hex().upper()}, right {right[5:7].hex().upper()}"
            yield Fault("master word", f"{self.name}: {word}")
        elif found[7] != right[7]:
            name = "check sequence of the master word"
            yield Fault(name, f"{self.name}: {name} {found[7]:02X}, right {right[7]:02X}{_mistake(found[7], right[7])}")

    def _hint(self, data: bytes, found: bytes, right: int, octet: int) -> str:
        """The usual mistake that gives this check sequence."""
        if self.blocks == (2,) and octet == check_sequence(found[:4]):
            return " (that of 4 octets; it covers 2)"
        return _mistake(octet, right)


def _mistake(found: int, right: int) -> str:
    if found ^ right == 0xFF:
        return " (not inverted)"
    return " (wrong parity)" if found ^ right == 1 else ""


def ids_words(can_ids: Sequence[int]) -> str:
    """Identifiers in hexadecimal."""
    return " ".join(f"{can_id:03X}" for can_id in can_ids)


def _flags_said(flags: int) -> str:
    words = ((ERROR, "an error frame"), (REMOTE, "a remote frame"), (EXTENDED, "extended"), (FD, "a CAN FD frame"))
    return next((word for flag, word in words if flags & flag), "a classic frame")


def value_words(signal: Signal, raw: int) -> str:
    """A value as the port table names it, or in its unit; a hash in hexadecimal."""
    if raw in signal.values:
        return signal.values[raw]
    if signal.name.endswith("Hash"):
        return f"{raw:08x}"
    value = f"{raw}" if signal.scale == 1 else f"{raw * signal.scale:g}"
    return value if signal.unit in ("", "1") else f"{value} {signal.unit}"


def value_faults(port: Port, signal: Signal, raw: int) -> list[Fault]:
    """The fault of one value: a check variable or a flag that is not set, or a value out of its range."""
    allowed = {"chk": (CHECK_CORRECT,), "antivalent": (FLAG_FALSE, FLAG_TRUE)}.get(signal.check)
    if allowed is not None and raw not in allowed:
        right = " or ".join(_code(signal, one) for one in allowed)
        return [Fault(signal.name, f"{port.name}: {signal.name} {_code(signal, raw)}, right {right}")]
    if _is_enumeration(signal) and raw not in signal.values:
        right = ", ".join(f"{value} ({word})" for value, word in sorted(signal.values.items()))
        return [Fault(signal.name, f"{port.name}: {signal.name} {raw}, right {right}")]
    value, low, high = raw * signal.scale, signal.minimum, signal.maximum
    if low is not None and high is not None and not low <= value <= high:
        return [Fault(signal.name, f"{port.name}: {signal.name} {value:g} {signal.unit}, right {low:g} to {high:g}")]
    return []


def _is_enumeration(signal: Signal) -> bool:
    """Whether its words name all its values; a table without 0 names a special value among numbers."""
    return 0 in signal.values


def constant_flags(port: Port, signal: Signal, raws: Sequence[int]) -> Iterator[str]:
    """A flag that is set in all answers, and is not as usual: right, but worth a look."""
    if signal.check == "antivalent" and {*raws} == {FLAG_FALSE + FLAG_TRUE - signal.default}:
        found, usual = signal.values[raws[0]], signal.values[signal.default]
        yield f"{port.name}: {signal.name} {found} in every answer, usual {usual}"


def _code(signal: Signal, raw: int) -> str:
    return f"{raw:02b} ({signal.values.get(raw, raw)})"


def life_faults(port: Port, life: Signal, lives: Sequence[int]) -> list[Fault]:
    """Life signs that do not count by one at each answer."""
    found, sign, modulus = [], LifeSign(), 1 << life.length
    for last, now in pairwise(lives):
        sign.accept(last)
        if (how := _LIFE_WORDS.get(sign.judge(now))) is not None:
            text = f"{port.name}: {life.name} {how}: {now} after {last}, right {(last + 1) % modulus}"
            found.append(Fault(f"life sign {how}", text))
    return found
