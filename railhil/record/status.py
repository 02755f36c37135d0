"""The telegram in which a controller reports on its arithmetic and its law: flags, and the notes defined by its
system."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from railhil.bus.codes import ControllerFlag
from railhil.record.notes import ReportedNote
from railhil.record.trace import Trace

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

    A fault may keep the telegram from the bus or change its flags. The record then does not show what the arithmetic
    did.

    :param wraps: wraps in the controller's own telemetry.
    """
    if not wraps or status is None or not status.flags or wrap_failure(trace, status):
        return ""
    times = "once" if wraps == 1 else f"{wraps} times"
    return f"record: no {status.port} says that the controller's arithmetic has wrapped, which it did {times}"
