"""Reports of a controller on its law and its arithmetic: the notes, by the law's description, and the flags."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from railhil.bus.codes import ControllerFlag
from railhil.record.trace import FloatArray, Trace

_HALF, _WHOLE = 1 << 15, 1 << 16


@dataclass(frozen=True, slots=True)
class ReportedNote:
    """One note: its signal in the status telegram; ``name`` is a column header, figures have ``title`` and ``symbol``.

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

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> ReportedNote:
        """Inverse of :meth:`as_json`.

        :raises LookupError, TypeError, ValueError: it is not the description of a note.
        """
        signal, name, title, symbol, unit = (
            str(document[key]) for key in ("signal", "name", "title", "symbol", "unit")
        )
        bits = tuple(map(str, document["bits"]))
        return cls(signal, name, title, symbol, unit, float(document["scale"]), bool(document["signed"]), bits)

    @property
    def label(self) -> str:
        """Title with symbol and unit."""
        return " ".join(word for word in (self.title, self.symbol, f"({self.unit})" if self.unit else "") if word)


@dataclass(frozen=True, slots=True)
class Status:
    """``port`` of the telegram; ``flags``: its signal of :class:`~railhil.bus.codes.ControllerFlag`, empty: none.

    ``notes``: the notes common to all laws of the system. ``slots``: the signals in which each law sends notes of its
    own, with the names that they have if the law's declaration is not known. ``earlier``: the notes of records whose
    wire contract has no slots, but signals with fixed names. ``further``: other telegrams with notes.
    """

    port: str
    flags: str = ""
    notes: tuple[ReportedNote, ...] = ()
    slots: tuple[ReportedNote, ...] = ()
    earlier: tuple[ReportedNote, ...] = ()
    further: tuple[Status, ...] = ()

    @property
    def every(self) -> tuple[Status, ...]:
        """This telegram and the further ones."""
        return (self, *self.further)

    def declared(self, documents: Sequence[dict[str, Any]]) -> tuple[ReportedNote, ...]:
        """Notes from the controller's description of its law.

        :raises LookupError, TypeError, ValueError: it is not a valid description.
        """
        notes = tuple(map(ReportedNote.from_json, documents))
        if others := {note.signal for note in notes} - {slot.signal for slot in self.slots}:
            raise ValueError(f"no signals of {self.port} for notes: {', '.join(sorted(others))}")
        return notes

    def recorded(self, trace: Trace, documents: Sequence[dict[str, Any]] | None) -> tuple[ReportedNote, ...]:
        """The notes of a record in this telegram.

        :param documents: ``notes`` of its certificate; None: unknown.
        """
        if not self.slots:
            return self.notes
        if not trace.has(self.port, self.slots[0].signal):
            return self.notes + self.earlier
        return self.notes + (self.slots if documents is None else self.declared(documents))


def note_values(trace: Trace, note: ReportedNote, port: str) -> FloatArray:
    """Values of a note in each telegram of the port, in its unit, shape (n,)."""
    raw = trace.raw(port, note.signal)
    if note.signed:
        raw = (raw + _HALF) % _WHOLE - _HALF
    return np.asarray(np.ma.filled(raw * note.scale, np.nan), dtype=np.float64)


#: Beginning of the failure text of a run in which the controller's fixed-point arithmetic has wrapped.
WRAP_FAILURE = "fixed-point wrap in the controller"


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
