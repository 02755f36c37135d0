"""Clients that only listen."""

from __future__ import annotations

import contextlib
import sys

from railhil.bus.link.base import Link


def be_passive(link: Link) -> None:
    """Tell the interface not even to acknowledge, where it can be told; who calls this sends nothing in any case."""
    # An interface of python-can has loaded it.
    can = sys.modules.get("can")
    if can is not None and isinstance(link.bus, can.BusABC):
        with contextlib.suppress(NotImplementedError, AttributeError):
            link.bus.state = can.BusState.PASSIVE
