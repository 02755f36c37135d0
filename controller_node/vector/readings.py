"""The readings of a law over several units, and their age."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import partial
from typing import Any

from railhil.bus.acceptance import Acceptance
from railhil.bus.layout import Telegram
from railhil.bus.responder import Reading, Responder
from railhil.controller_node.vector.law import Interface


def sources_of(interface: Interface) -> dict[str, type[Telegram]]:
    """Ports with readings, in the order of the readings, each with its telegram."""
    found: dict[str, type[Telegram]] = {}
    for reading in interface.readings:
        found.setdefault(reading.telegram.PORT, reading.telegram)
    return found


@dataclass(slots=True)
class _Source:
    """One port with readings: process data and time of the last accepted telegram."""

    acceptance: Acceptance
    age_max_ns: int
    data: bytes = b""
    taken_ns: int = 0


class Readings:
    """Takes the telegrams with an interface's readings from a responder.

    Only an accepted telegram (:class:`railhil.bus.acceptance.Acceptance`) updates the readings; their age is the time
    since its arrival. ``counters``: refused telegrams by cause.

    :raises InputError: the life sign of a telegram is not a number of 4 bits.
    """

    def __init__(self, interface: Interface, responder: Responder) -> None:
        self.counters: Counter[str] = Counter()
        self._interface = interface
        self._clock = responder.clock
        self._store = responder.store
        self._sources: dict[str, _Source] = {}
        for port, kind in sources_of(interface).items():
            ages_ns = [interface.age_max_ns(item) for item in interface.readings if port == item.telegram.PORT]
            self._sources[port] = _Source(Acceptance(kind, self.counters), min(ages_ns))
            responder.on(kind, partial(self._take, port), port)

    def _take(self, port: str, reading: Reading[Any]) -> None:
        source = self._sources[port]
        if source.acceptance.accept(reading.telegram):
            # If this is a TIME_SYNC, it has already set the clock.
            source.data, source.taken_ns = self._store.raw(port), self._clock.now_ns

    def fresh(self) -> bool:
        """Whether every reading has an accepted telegram, none of them older than its largest age."""
        now_ns = self._clock.now_ns
        return all(source.data and now_ns - source.taken_ns <= source.age_max_ns for source in self._sources.values())

    def raws(self) -> list[int]:
        """One raw integer for each reading, from the last accepted telegrams; call only when :meth:`fresh`."""
        readings = self._interface.readings
        return [getattr(item.telegram.decode(self._sources[item.telegram.PORT].data), item.field) for item in readings]
