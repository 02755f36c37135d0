"""Notes of a law in CTL_STAT, besides its notch: named figures, and their encoding on the wire."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

#: Signals of CTL_STAT for the notes, and the bits of each.
SLOTS = {"Note1": 4, "Note2": 16, "Note3": 16}
#: UNIPOLAR2.16: 1/16384.
UNIPOLAR2_Q = 14


@dataclass(frozen=True, slots=True)
class Note:
    """One figure.

    ``name`` is used as a column header (``softening_factor``), ``title`` in figures, ``symbol`` at an axis. ``q``:
    fraction bits of the law's result, ``wire_q``: fraction bits of the value sent, which is rounded down and limited to
    its bits. ``bits`` names the bits of a bit field from bit 0 on: such a note has 4 bits on the wire, every other has
    16.
    """

    name: str
    title: str
    q: int
    wire_q: int = UNIPOLAR2_Q
    unit: str = ""
    symbol: str = ""
    signed: bool = False
    bits: tuple[str, ...] = ()

    @property
    def width(self) -> int:
        """Bits on the wire."""
        return 4 if self.bits else 16

    @property
    def shift(self) -> int:
        """Fraction bits dropped for the wire."""
        return self.q - self.wire_q

    @property
    def limits(self) -> tuple[int, int]:
        """Smallest and largest value on the wire."""
        return (-(1 << (self.width - 1)), (1 << (self.width - 1)) - 1) if self.signed else (0, (1 << self.width) - 1)

    def document(self, signal: str) -> dict[str, Any]:
        """The controller's declaration of it; physical value = wire value * ``scale`` in ``unit``."""
        return {
            "signal": signal,
            "name": self.name,
            "title": self.title,
            "symbol": self.symbol,
            "unit": self.unit,
            "scale": 2.0**-self.wire_q,
            "signed": self.signed,
            "bits": list(self.bits),
        }


def flags(name: str, title: str, bits: tuple[str, ...]) -> Note:
    """A bit field, the same integer in the law and on the wire."""
    return Note(name, title, 0, wire_q=0, bits=bits)


def slots(notes: Sequence[Note]) -> dict[str, int]:
    """Number of the note in each signal of CTL_STAT that carries one.

    :raises ValueError: they do not fit.
    """
    free = dict(SLOTS)
    found: dict[str, int] = {}
    for number, note in enumerate(notes):
        signal = next((name for name, width in free.items() if width == note.width), None)
        if signal is None:
            raise ValueError("at most one note with named bits and two others")
        if note.shift < 0 or len(note.bits) > note.width:
            raise ValueError(f"note {note.name}: wire_q at most q, at most {note.width} names of bits")
        del free[signal]
        found[signal] = number
    if len({note.name for note in notes}) < len(notes):
        raise ValueError("notes with different names")
    return found


def on_wire(note: Note, raw: int) -> int:
    """Value of a note's signal, two's complement, from the law's raw value."""
    low, high = note.limits
    value = raw >> note.shift
    value = low if value < low else high if value > high else value
    return value & 0xFFFF if note.signed else value
