"""Reports of a controller on its law and its arithmetic: the notes, by the law's description, and the flags."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from railhil.bus.codes import ControllerFlag
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


#: Beginning of the failure text of a run in which the controller's fixed-point arithmetic has wrapped.
WRAP_FAILURE = "fixed-point wrap in the controller"


@dataclass(frozen=True, slots=True)
class Status:
    """``port`` of the telegram; ``flags``: its signal of :class:`~railhil.bus.codes.ControllerFlag`, empty: none.

    ``notes``: the notes common to all laws of the system; a law may declare further ones. ``further``: other telegrams
    with notes.
    """

    port: str
    flags: str = ""
    notes: tuple[ReportedNote, ...] = ()
    further: tuple[Status, ...] = ()

    @property
    def every(self) -> tuple[Status, ...]:
        """This telegram and the further ones."""
        return (self, *self.further)


def interface_status(interface: Any) -> Status | None:
    """The status of a system whose laws use the signals of an ``Interface``; None if it has no such telegram.

    :param interface: a :class:`railhil.controller_node.vector.law.Interface`.
    """
    found = [_of_telegram(interface, telegram) for telegram in interface.statuses]
    return replace(found[0], further=tuple(found[1:])) if found else None


def _of_telegram(interface: Any, telegram: Any) -> Status:
    signals = dict(telegram.signals())
    notes = []
    for note in interface.notes:
        if interface.status_of(note) is telegram:
            signal = signals[note.field]
            column = f"{note.name}_{signal.unit.replace('/', 'p')}" if signal.unit else note.name
            notes.append(ReportedNote(signal.name, column, note.name, "", signal.unit, signal.scale, False, ()))
    flags = signals.get("overflow_flags")
    return Status(telegram.PORT, "" if flags is None else flags.name, tuple(notes))


def wrap_failure(trace: Trace, status: Status | None) -> str:
    """The failure if the controller reports a wrap, after which its commands are meaningless; empty without one.

    :param status: its report; None: it does not report.
    """
    if status is None or not status.flags:
        return ""
    wrapped = np.flatnonzero(trace.raw(status.port, status.flags) & ControllerFlag.WRAP)
    return f"{WRAP_FAILURE}, reported at {trace.times_s(status.port)[wrapped[0]]:.2f} s" if len(wrapped) else ""


def untold_wrap(trace: Trace, status: Status | None, wraps: int) -> str:
    """Reason not to trust a run without a wrap in its record, if the controller itself has counted some; else empty.

    A fault may keep the telegram from the bus or change its flags. The record then does not show the events of the
    arithmetic.

    :param wraps: wraps in the controller's own telemetry.
    """
    if not wraps or status is None or not status.flags or wrap_failure(trace, status):
        return ""
    times = "once" if wraps == 1 else f"{wraps} times"
    return f"record: no {status.port} says that the controller's arithmetic has wrapped, which it did {times}"
