"""What can go wrong on the bus.

::

    BusError
     +-- BusUnavailable   the interface cannot be opened (missing, busy, no permission)
     |    +-- BusOccupied another bench is running on it
     +-- BusLost          an open interface is gone for good (hub died, adapter did not come back)
     +-- PeerSilent       nobody is there to be waited for any longer (:mod:`railhil.common.patience`)
"""

from __future__ import annotations

from railhil.common.exit_codes import INVALID, USAGE


class BusError(Exception):
    """Base of all bus errors; the text is one line that can be shown to a user as it stands."""


class BusUnavailable(BusError):
    """The interface cannot be opened. Example: no such vcan, socket path in use, no hub at the path."""

    exit_code = USAGE


class BusOccupied(BusUnavailable):
    """Another bus administrator polls on this bus: two benches on one would spoil both."""


class BusLost(BusError):
    """The interface was open and is gone. Example: the hub process was killed."""

    exit_code = INVALID


class PeerSilent(BusError):
    """Somebody has ended, or patience is over. The text says who waited for whom, since when."""

    exit_code = INVALID
