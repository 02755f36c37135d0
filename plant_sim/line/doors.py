"""The doors of the train and of the platform: an automaton of whole ticks for each side, and the orders for them.

::

    LOCKED -> OPENING -> OPEN -> CLOSING -> LOCKED
                ^         |         |
                |         |stuck    v obstacle, at half of the way
                +-----------< OBSTRUCTED (at most reopen_max times), then FAULT

An order is carried out as long as it is given. Doors that an obstacle has opened again stay open for
:data:`PAUSE_S` and then close, if they are still ordered to.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from railhil.systems.line.scenario.model import Doors, Side
from railhil.wire.line import DoorOrder, DoorState

# Looking up a member of an enum costs as much as a call on CPython 3.11.
LOCKED: Final = int(DoorState.LOCKED)
OPENING: Final = int(DoorState.OPENING)
OPEN: Final = int(DoorState.OPEN)
CLOSING: Final = int(DoorState.CLOSING)
OBSTRUCTED: Final = int(DoorState.OBSTRUCTED)
FAULT: Final = int(DoorState.FAULT)
ISOLATED: Final = int(DoorState.ISOLATED)
CLOSE: Final = int(DoorOrder.CLOSE)
LEFT: Final = int(DoorOrder.OPEN_LEFT)
RIGHT: Final = int(DoorOrder.OPEN_RIGHT)

#: Sides as bits, as in the orders to open and in SidePermitted.
SIDES: Final[dict[Side, int]] = {"none": 0, "left": LEFT, "right": RIGHT, "both": LEFT | RIGHT}
#: The doors of the platform begin to open later than those of the train.
PSD_DELAY_S: Final = 0.3
#: How long doors stand still in front of an obstacle, and how long they stay open after it (chosen).
OBSTRUCTED_S: Final = 0.2
PAUSE_S: Final = 1.0


class DoorTicks(NamedTuple):
    """Durations in ticks."""

    opening: int
    closing: int
    psd_delay: int
    obstructed: int
    pause: int


def door_ticks(doors: Doors, tick_s: float) -> DoorTicks:
    """Durations of the doors of a route; each is at least one tick."""
    spans_s = doors.open_s, doors.close_s, PSD_DELAY_S, OBSTRUCTED_S, PAUSE_S
    return DoorTicks(*(max(1, round(span_s / tick_s)) for span_s in spans_s))


class DoorSet:
    """The doors of one side, which move together.

    :ivar obstacles: closings from now on that meet an obstacle.
    :ivar is_stuck: they open, but do not close.
    :ivar slowness: factor of the time in which they open and close.
    :ivar has_lost_lock: they are closed, but not locked.
    :ivar reopened: times that an obstacle has opened them since the last locking.
    :ivar obstructions: obstacles since the start of the run.
    """

    __slots__ = (
        "_left", "_pause", "_reopen_max", "_ticks", "has_lost_lock", "is_stuck", "obstacles", "obstructions",
        "reopened", "slowness", "state",
    )  # fmt: skip

    def __init__(self, ticks: DoorTicks, reopen_max: int) -> None:
        self.state = LOCKED
        self.obstacles = 0
        self.is_stuck = False
        self.slowness = 1.0
        self.has_lost_lock = False
        self.reopened = 0
        self.obstructions = 0
        self._ticks = ticks
        self._reopen_max = reopen_max
        self._left = 0
        self._pause = 0

    @property
    def is_locked(self) -> bool:
        """Whether they are closed and locked, or isolated."""
        return self.state == ISOLATED or (self.state == LOCKED and not self.has_lost_lock)

    def isolate(self) -> None:
        """Lock them by hand: they no longer move, and count as locked."""
        self.state = ISOLATED

    def open(self, delay_ticks: int = 0) -> None:
        """Begin to open, after a delay."""
        if self.state in (LOCKED, CLOSING):
            self.state = OPENING
            self._left = delay_ticks + round(self._ticks.opening * self.slowness)

    def close(self) -> None:
        """Begin to close, if they are open and have been for long enough."""
        if self.state == OPEN and not self._pause:
            self.state = CLOSING
            self._left = round(self._ticks.closing * self.slowness)

    def keep_shut(self) -> None:
        """Open no further: the train moves."""
        if self.state == OPENING:
            self.state = CLOSING
            self._left = round(self._ticks.closing * self.slowness)
        elif self.state == OBSTRUCTED:
            self._left += 1

    def step(self) -> None:
        """Advance by a tick."""
        state = self.state
        if state == OPEN:
            if self._pause:
                self._pause -= 1
            return
        if state not in (OPENING, CLOSING, OBSTRUCTED):
            return
        self._left -= 1
        if state == CLOSING and self.obstacles and self._left <= self._ticks.closing // 2:
            self._obstruct()
        elif self._left > 0:
            return
        elif state == OPENING:
            self.state = OPEN
        elif state == OBSTRUCTED:
            self.state = OPENING
            self._left = self._ticks.opening // 2
            self._pause = self._ticks.pause
        elif self.is_stuck:
            self.state = FAULT
        else:
            self.state = LOCKED
            self.reopened = 0

    def _obstruct(self) -> None:
        self.obstacles -= 1
        self.obstructions += 1
        if self.reopened >= self._reopen_max:
            self.state = FAULT
            return
        self.reopened += 1
        self.state = OBSTRUCTED
        self._left = self._ticks.obstructed


class TrainDoors:
    """Both sides of the train, and the doors of the platform at which it stands.

    The platform's doors follow the orders for the train's.

    :ivar opened: sides that have been ordered to open since all doors were locked, as bits.
    """

    def __init__(self, doors: Doors, tick_s: float) -> None:
        self._ticks = door_ticks(doors, tick_s)
        self.left, self.right, self.psd = (DoorSet(self._ticks, doors.reopen_max) for _ in range(3))
        self.has_psd = False
        self.opened = 0

    @property
    def are_train_doors_locked(self) -> bool:
        """Whether all doors of the train are closed and locked."""
        return self.left.is_locked and self.right.is_locked

    @property
    def is_psd_locked(self) -> bool:
        """Whether the platform has no doors, or all are closed and locked."""
        return not self.has_psd or self.psd.is_locked

    @property
    def are_locked(self) -> bool:
        """Whether train and platform are closed and locked: the interlock of traction."""
        return self.left.is_locked and self.right.is_locked and self.is_psd_locked

    @property
    def are_open(self) -> bool:
        """Whether all doors that were ordered to open are open; isolated ones do not open."""
        moving = [door for door, side in ((self.left, LEFT), (self.right, RIGHT)) if self.opened & side]
        if self.has_psd:
            moving.append(self.psd)
        states = {door.state for door in moving} - {ISOLATED}
        return states == {OPEN}

    @property
    def reopened(self) -> int:
        """The most that an obstacle has opened one side again at this stop."""
        return max(self.left.reopened, self.right.reopened, self.psd.reopened)

    @property
    def obstructions(self) -> int:
        """Obstacles since the start of the run."""
        return self.left.obstructions + self.right.obstructions + self.psd.obstructions

    def open(self, sides: int) -> None:
        """Open the doors of these sides, as bits, and those of the platform."""
        self.opened |= sides
        if sides & LEFT:
            self.left.open()
        if sides & RIGHT:
            self.right.open()
        if self.has_psd:
            self.psd.open(self._ticks.psd_delay)

    def close(self) -> None:
        """Close what is open."""
        self.left.close()
        self.right.close()
        self.psd.close()

    def step(self, moving: bool = False) -> None:
        """Advance by a tick. In motion no door opens: what was opening closes, and an obstacle stays where it is."""
        for door in (self.left, self.right, self.psd):
            if moving:
                door.keep_shut()
            door.step()
