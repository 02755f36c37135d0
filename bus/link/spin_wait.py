"""How a node on pipes waits for its turn: awake while the machine is calm, else asleep.

Waking a sleeping process often takes longer than the work that it is woken for. So a node polls repeatedly and yields
its processor in between (``sched_yield``). Another process that is given the processor keeps it for milliseconds: where
turns come late, the node sleeps for the next thousands of turns, and for more of them if it is late again.

While the controller is awake it uses another processor than the plant; asleep it shares the plant's, because only one
of the two acts at a time.
"""

from __future__ import annotations

import contextlib
import os
import select
import time
from collections.abc import Sequence
from typing import Final, NamedTuple

#: Number of polls before a node sleeps in any case: some milliseconds.
_LOOKS: Final = 2000
#: The work of another node does not delay a turn by more than this.
_LATE_NS: Final = 1_000_000
#: Weight of one late turn against turns in time, and the weight at which the node goes to sleep.
_LATE_WEIGHT: Final = 50
_LATE_MAX: Final = 150


class Sleep(NamedTuple):
    """Number of turns for which a node sleeps: at first, while the nodes start; after late turns; at most, when turns
    stay late."""

    starting: int = 60
    least: int = 1_500
    most: int = 80_000


#: Awake while the machine is calm; always asleep.
AWAKE: Final = Sleep()
ASLEEP: Final = Sleep(starting=1 << 60)


class SpinWait:
    """Waits until one of some descriptors is readable.

    :param moves: use another processor while awake than while asleep: the node is not awake before this process has
        been limited to one of the processors that it may use now.
    """

    def __init__(self, descriptors: Sequence[int], *, moves: bool = False, sleep: Sleep = AWAKE) -> None:
        poller = select.poll()
        for descriptor in descriptors:
            poller.register(descriptor, select.POLLIN)
        self._poll = poller.poll
        #: Removes a descriptor from those waited for.
        self.leave = poller.unregister
        self._moves = moves
        self._allowed = os.sched_getaffinity(0)
        # The processor shared with the plant, while it is left.
        self._shared: set[int] = set()
        self._sleep = sleep
        self._asleep = sleep.starting
        self._next_asleep = sleep.least
        self._weight = 0

    @property
    def is_awake(self) -> bool:
        """True while it does not sleep between two looks."""
        return self._asleep == 0

    def wait(self, timeout_ms: float | None) -> list[tuple[int, int]]:
        """The readable descriptors, each with its events as in :func:`select.poll`; none after the time-out (None: no
        time-out)."""
        poll = self._poll
        if self._asleep:
            self._asleep -= 1
            if not self._asleep:
                self._rise()
            return poll(timeout_ms)
        if (ready := poll(0)) or timeout_ms == 0:
            return ready
        begun_ns = time.monotonic_ns()
        for _ in range(_LOOKS):
            os.sched_yield()
            if ready := poll(0):
                self._came(time.monotonic_ns() - begun_ns)
                return ready
        self._came(_LATE_NS)
        return poll(timeout_ms)

    def _came(self, after_ns: int) -> None:
        """Note after how long a turn has come; decide whether the node sleeps."""
        if after_ns < _LATE_NS:
            if self._weight:
                self._weight -= 1
                if not self._weight:
                    self._next_asleep = max(self._next_asleep // 2, self._sleep.least)
            return
        self._weight += _LATE_WEIGHT
        if self._weight >= _LATE_MAX:
            self._weight = 0
            self._asleep = self._next_asleep
            self._next_asleep = min(self._next_asleep * 2, self._sleep.most)
            if self._shared:
                self._go_to(self._shared)
                self._shared = set()

    def _rise(self) -> None:
        """Stay awake from now on."""
        if not self._moves:
            return
        now = os.sched_getaffinity(0)
        if len(now) > 1:
            # Not placed yet.
            self._asleep = self._sleep.starting
        elif (others := self._allowed - now) and self._go_to(others):
            self._shared = now

    def _go_to(self, processors: set[int]) -> bool:
        # The processors of a container can change at any time; staying is slower but not wrong.
        with contextlib.suppress(OSError):
            os.sched_setaffinity(0, processors)
            return True
        return False
