"""A fault that ends at a time of the run has a duration."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from railhil.common.errors import InputError
from railhil.faults.model import TIME, Fault
from railhil.faults.notation import number_of, trigger_text


class Complain(Protocol):
    """Makes the error for a part of a fault."""

    def __call__(self, found: str, allowed: str, hint: str | None = None) -> InputError:
        """``found`` is empty for a missing part."""


def end_s(until: str) -> float | None:
    """The time of the run at which a fault ends; None: it ends with an event."""
    return number_of(until, TIME) if until[:1].isdigit() and not until[-1:].isdigit() else None


def with_span(fault: Fault, complain: Complain) -> Fault:
    """The fault with its duration, if it ends at a time of the run.

    :raises InputError: it would end before it begins, or its beginning is no time.
    """
    ends_s, trigger = end_s(fault.until), fault.trigger
    if ends_s is None or trigger.kind == "mark":
        return fault
    if trigger.kind != "time":
        raise complain(f"until {fault.until}", "until a time only for a fault that begins at a time")
    span_s = round(ends_s - float(trigger.value) - trigger.delay_s, 9)
    if span_s <= 0.0:
        raise complain(f"until {fault.until}", f"a time after @{trigger_text(trigger)}")
    return replace(fault, until="", duration_s=span_s)
