"""An interface that is down: since when, why, when to look again, and when to give up."""

from __future__ import annotations

import time
from dataclasses import dataclass

from railhil.bus.wallclock import WallClock


@dataclass(frozen=True, slots=True)
class Timeouts:
    """How long a link waits, in s on the wall clock.

    :ivar give_up_s: for an interface that is down, and in lockstep for a full transmit queue; then the node ends.
    :ivar look_again_s: between two looks whether the interface is back.
    :ivar queue_full_s: in realtime for a full transmit queue (ENOBUFS); then the frames are dropped.
    :ivar opening_s: so long after a serial port was opened, answers may be those to the commands that opened it.
    """

    give_up_s: float = 30.0
    look_again_s: float = 0.1
    queue_full_s: float = 0.02
    opening_s: float = 1.0


#: Of every link that is not told otherwise.
TIMEOUTS = Timeouts()


class Outage:
    """One outage.

    :ivar reason: one clause.
    :ivar bus_off: the interface is there, but its controller chip has gone off the bus.
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
        """True when a node has waited long enough."""
        return self.lasted_s > self._timeouts.give_up_s

    def until_look_s(self) -> float:
        """Wall time until the interface should be looked at again, at least 0."""
        return max(0.0, self._look_s - self._wall.monotonic())

    def looked(self) -> None:
        """It was looked at, and it is not back."""
        self._look_s = self._wall.monotonic() + self._timeouts.look_again_s
