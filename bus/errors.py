"""The errors of the bus.

::

    BusError
     +-- BusUnavailable   the interface cannot be opened (missing, busy, no permission)
     |    +-- BusOccupied another bench is running on it
     +-- BusLost          an open interface is gone for good (hub died, adapter did not come back)
     +-- PeerSilent       an awaited node has ended or is given up (:mod:`railhil.common.patience`)
"""

from __future__ import annotations

from typing import Final

from railhil.common.exit_codes import INVALID, USAGE


class BusError(Exception):
    """Base of all bus errors; the text is one line that can be shown to a user unchanged."""


class BusUnavailable(BusError):
    """The interface cannot be opened. Example: no such vcan, socket path in use, no hub at the path."""

    exit_code = USAGE


#: Said of a poll that is not this bench's.
OTHER_ADMINISTRATOR: Final = "another bus administrator polls on this bus: one bench at a time"


class BusOccupied(BusUnavailable):
    """Another bus administrator polls on this bus: two benches on one bus would corrupt both runs."""


class BusLost(BusError):
    """The interface was open and has been lost. Example: the hub process was killed."""

    exit_code = INVALID


class PeerSilent(BusError):
    """A node has ended, or the patience is exhausted. The text says who waited for whom, and since when."""

    exit_code = INVALID
