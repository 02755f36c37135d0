"""An outage of an interface: since when, why, when to check again, and when to give up."""

from __future__ import annotations

import time
from dataclasses import dataclass

from railhil.common.patience import WallClock


@dataclass(frozen=True, slots=True)
class Timeouts:
    """How long a link waits, in s on the wall clock.

    :ivar give_up_s: for an interface that is down, and in lockstep for a full transmit queue; then the node ends.
    :ivar look_again_s: between two checks whether the interface is back.
    :ivar queue_full_s: in real time for a full transmit queue (ENOBUFS); then the frames are dropped.
    :ivar opening_s: time after opening a serial port in which answers may still belong to the opening commands.
    """

    give_up_s: float = 30.0
    look_again_s: float = 0.1
    queue_full_s: float = 0.02
    opening_s: float = 1.0


#: Default of every link.
TIMEOUTS = Timeouts()


class Outage:
    """One outage.

    :ivar reason: the cause, as one clause.
    :ivar bus_off: the interface is present, but its CAN controller is bus-off.
    """

    def __init__(
        self, reason: str, *, bus_off: bool = False, timeouts: Timeouts = TIMEOUTS, wall: WallClock = time
    ) -> None:
        self.reason = reason
        self.bus_off = bus_off
        self._timeouts = timeouts
        self._wall = wall
        self._since_s = wall.monotonic()
        self._look_s = self._since_s + (0.0 if bus_off else timeouts.look_again_s)

    @property
    def lasted_s(self) -> float:
        """Wall time since it began."""
        return self._wall.monotonic() - self._since_s

    @property
    def hopeless(self) -> bool:
        """True when the node has waited long enough and gives up."""
        return self.lasted_s > self._timeouts.give_up_s

    def until_look_s(self) -> float:
        """Wall time until the interface should be checked again, at least 0."""
        return max(0.0, self._look_s - self._wall.monotonic())

    def looked(self) -> None:
        """Note that it was checked and is not back."""
        self._look_s = self._wall.monotonic() + self._timeouts.look_again_s
