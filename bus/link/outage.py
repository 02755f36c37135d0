"""An interface that is down: since when, why, when to look again, and when to give up."""

from __future__ import annotations

import time

#: Time between two looks whether the interface is back.
RETRY_S = 0.1
#: A node waits this long for its interface, then it ends.
GIVE_UP_S = 30.0


class Outage:
    """One outage.

    :ivar reason: one clause.
    :ivar bus_off: the interface is there, but its controller chip has gone off the bus.
    """

    def __init__(self, reason: str, *, bus_off: bool = False) -> None:
        self.reason = reason
        self.bus_off = bus_off
        self._since_s = time.monotonic()
        self._look_s = self._since_s + (0.0 if bus_off else RETRY_S)

    @property
    def lasted_s(self) -> float:
        """Wall time since it began."""
        return time.monotonic() - self._since_s

    @property
    def hopeless(self) -> bool:
        """True when a node has waited long enough."""
        return self.lasted_s > GIVE_UP_S

    def until_look_s(self) -> float:
        """Wall time until the interface should be looked at again, at least 0."""
        return max(0.0, self._look_s - time.monotonic())

    def looked(self) -> None:
        """It was looked at, and it is not back."""
        self._look_s = time.monotonic() + RETRY_S
