"""Which controller a run had, where it was not railhil's own: as it reported itself, or as the user names it."""

from __future__ import annotations

from typing import Final

from railhil.bus.ident import CtlIdent
from railhil.record.trace import Trace
from railhil.scenarios.run_spec import StartUp

UNKNOWN: Final = "unknown"
#: Keys of a run that the handshake of the controller confirms, with its fields; 0 there: not said.
_CONFIRMED: Final = {"controller": "law", "arithmetic": "arithmetic", "indexing": "indexing"}


def reported(start_up: StartUp, trace: Trace) -> dict[str, str]:
    """What has to be said instead of what was asked for, by key of a run; empty if the controller has confirmed it.

    A controller of somebody else that says what it is has said what was asked for: others are refused.
    """
    if not start_up.joins:
        return {}
    ident = trace.ident(CtlIdent)
    found = {key: UNKNOWN for key, field in _CONFIRMED.items() if ident is None or not getattr(ident, field)}
    return found | ({"controller": start_up.controller_name} if start_up.controller_name else {})
