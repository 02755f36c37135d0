"""Notes of a law in CTL_STAT: the meaning of each signal, from the controller's description of its law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from railhil.record.trace import FloatArray, Trace
from railhil.wire.ato import CtlStat

#: UNIPOLAR2.16: 1/16384.
_UNIPOLAR2 = 2.0**-14
_HALF, _WHOLE = 1 << 15, 1 << 16


@dataclass(frozen=True, slots=True)
class ReportedNote:
    """One note: its signal in CTL_STAT; ``name`` is a column header, ``title`` and ``symbol`` are used in figures.

    Value = raw * ``scale`` in ``unit``, raw in two's complement (16 bits) when ``signed``. ``bits`` names the bits of a
    bit field from bit 0 on.
    """

    signal: str
    name: str
    title: str
    symbol: str
    unit: str
    scale: float
    signed: bool
    bits: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """As ``certificate.json`` has it."""
        return asdict(self) | {"bits": list(self.bits)}

    @property
    def label(self) -> str:
        """Title with symbol and unit."""
        return " ".join(word for word in (self.title, self.symbol, f"({self.unit})" if self.unit else "") if word)


#: The notes of a record whose wire contract names them: up to version 0.1.0 they were the notes of IPFC.
_EARLIER = (
    ReportedNote("BasisInUse", "basis_in_use", "basis functions", "", "", 1.0, False, ("step", "wavelet", "ramp")),
    ReportedNote("SofteningFactor", "softening_factor", "softening factor", "α", "", _UNIPOLAR2, False, ()),
    ReportedNote("Satisfaction", "satisfaction", "satisfaction", "μ", "", _UNIPOLAR2, False, ()),
)
#: The notes of a law without a description.
_UNKNOWN = (
    ReportedNote("Note1", "note_1", "note 1", "", "", 1.0, False, ()),
    ReportedNote("Note2", "note_2", "note 2", "", "", _UNIPOLAR2, False, ()),
    ReportedNote("Note3", "note_3", "note 3", "", "", _UNIPOLAR2, False, ()),
)


def told_notes(documents: Sequence[dict[str, Any]]) -> tuple[ReportedNote, ...]:
    """Notes from the controller's description of its law.

    :raises LookupError, TypeError, ValueError: it is not a valid description.
    """
    found = []
    for one in documents:
        if one["signal"] not in {note.signal for note in _UNKNOWN}:
            raise ValueError(f"no signal of CTL_STAT for notes: {one['signal']}")
        signal, name, title, symbol, unit = (str(one[key]) for key in ("signal", "name", "title", "symbol", "unit"))
        bits = tuple(map(str, one["bits"]))
        found.append(ReportedNote(signal, name, title, symbol, unit, float(one["scale"]), bool(one["signed"]), bits))
    return tuple(found)


def notes_of(trace: Trace, told: Sequence[dict[str, Any]] | None) -> tuple[ReportedNote, ...]:
    """The notes of a record; its wire contract determines whether their names are fixed.

    :param told: ``notes`` of its certificate; None: unknown.
    """
    if not trace.has(CtlStat.PORT, _UNKNOWN[0].signal):
        return _EARLIER
    return _UNKNOWN if told is None else told_notes(told)


def note_values(trace: Trace, note: ReportedNote, port: str = CtlStat.PORT) -> FloatArray:
    """Values of a note in each telegram of the port, in its unit, shape (n,)."""
    raw = trace.raw(port, note.signal)
    if note.signed:
        raw = (raw + _HALF) % _WHOLE - _HALF
    return np.asarray(np.ma.filled(raw * note.scale, np.nan), dtype=np.float64)
