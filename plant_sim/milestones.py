"""RUN_EVENT on the bus: every milestone is numbered and repeated, so that no single frame decides a verdict."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from railhil.bus.codes import EVENT_COPIES, EVENT_SPACING_NS, Event
from railhil.bus.layout import Telegram
from railhil.bus.telegrams import RunEvent

_NUMBER_MASK: Final = 0xFFFF


class Milestones:
    """Sends each milestone :data:`railhil.bus.codes.EVENT_COPIES` times under one number.

    The first telegram is sent at once, the others at intervals of :data:`railhil.bus.codes.EVENT_SPACING_NS` (in
    whole ticks, at least one). For the milestone that ends the run there is no later tick: all its telegrams are sent
    at once, after the outstanding repetitions of earlier milestones.

    :param publish: queues a telegram for the bus.
    """

    def __init__(self, publish: Callable[[Telegram], None], base_tick_ns: int) -> None:
        self._publish = publish
        self._spacing_ticks = -(-EVENT_SPACING_NS // base_tick_ns)
        self._number = 0
        #: Tick at which the telegram is due, in increasing order per milestone.
        self._due: list[tuple[int, RunEvent]] = []

    def reached(self, tick: int, event: int, instant_01ms: int, position_01mm: int) -> None:
        """Send a milestone of the train at ``tick``."""
        telegram = self._numbered(event, instant_01ms, position_01mm)
        self._publish(telegram)
        self._due += [(tick + copy * self._spacing_ticks, telegram) for copy in range(1, EVENT_COPIES)]

    def repeat(self, tick: int) -> None:
        """Send the repetitions due at ``tick``."""
        if self._due:
            for due_tick, telegram in self._due:
                if due_tick <= tick:
                    self._publish(telegram)
            self._due = [item for item in self._due if item[0] > tick]

    def end(self, event: Event, instant_01ms: int, position_01mm: int) -> None:
        """Send the milestone that ends the run."""
        for _, telegram in self._due:
            self._publish(telegram)
        self._due = []
        telegram = self._numbered(event, instant_01ms, position_01mm)
        for _ in range(EVENT_COPIES):
            self._publish(telegram)

    def _numbered(self, event: int, instant_01ms: int, position_01mm: int) -> RunEvent:
        self._number = self._number % _NUMBER_MASK + 1
        return RunEvent(event, self._number, instant_01ms, position_01mm)
