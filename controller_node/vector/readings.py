"""Acceptance of the telegrams that carry readings, and the age of the readings."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from railhil.bus.layout import CHECK_CORRECT, Telegram
from railhil.bus.lifesign import Life, LifeSign
from railhil.bus.responder import Reading, Responder
from railhil.common.errors import InputError, Words
from railhil.controller_node.vector.law import Interface
from railhil.dbc import Signal

_LIFE_RANGE = (0, 15)


def life_of(kind: type[Telegram]) -> Signal | None:
    """The life sign of a telegram, its field ``life``; None: it has none.

    :raises InputError: it is not a number of 4 bits.
    """
    found = dict(kind.signals()).get("life")
    if found is not None and found.raw_range != _LIFE_RANGE:
        low, high = found.raw_range
        raise InputError("interface", f"{kind.PORT}.life", Words(f"{low} to {high}"), "a life sign of 4 bits, 0 to 15")
    return found


def checks_of(kind: type[Telegram]) -> dict[str, Signal]:
    """Fields of a telegram that are check variables (``check = "chk"`` in the port table), with their signals."""
    return {name: signal for name, signal in kind.signals() if signal.check == "chk"}


def sources_of(interface: Interface) -> dict[str, type[Telegram]]:
    """Ports with readings, in the order of the readings, each with its telegram."""
    found: dict[str, type[Telegram]] = {}
    for reading in interface.readings:
        found.setdefault(reading.telegram.PORT, reading.telegram)
    return found


@dataclass(slots=True)
class _Source:
    """One port with readings.

    ``life``: life sign of its last telegram; ``data``, ``taken_ns``: process data and time of the last accepted one.
    """

    has_life: bool
    checks: tuple[str, ...]
    life: LifeSign = field(default_factory=LifeSign)
    data: bytes = b""
    taken_ns: int = 0


class Readings:
    """Takes the telegrams with an interface's readings from a responder.

    A telegram that passed the traffic store is accepted if its life sign is new and all its check variables are
    correct, as far as it has them. Only an accepted telegram updates the readings; their age is the time since its
    arrival.

    ``counters``: refused telegrams by cause (``duplicate``, ``out_of_order``, ``check_variable``), and ``gap`` for new
    telegrams after lost ones, with the names used by :class:`railhil.controller_node.guard.Guard`.

    :raises InputError: the life sign of a telegram is not a number of 4 bits.
    """

    def __init__(self, interface: Interface, responder: Responder) -> None:
        self.counters: Counter[str] = Counter()
        self._interface = interface
        self._clock = responder.clock
        self._store = responder.store
        self._sources: dict[str, _Source] = {}
        for port, kind in sources_of(interface).items():
            self._sources[port] = _Source(life_of(kind) is not None, tuple(checks_of(kind)))
            responder.on(kind, partial(self._take, port), port)

    def _take(self, port: str, reading: Reading[Any]) -> None:
        source, telegram = self._sources[port], reading.telegram
        if source.has_life:
            life = source.life.judge(telegram.life)
            if not life.fresh:
                # A repeated or old telegram carries no new information: the age of the readings keeps growing.
                self.counters[life.value] += 1
                return
            if life is Life.GAP:
                self.counters["gap"] += 1
            source.life.accept(telegram.life)
        if any(getattr(telegram, name) != CHECK_CORRECT for name in source.checks):
            self.counters["check_variable"] += 1
            return
        # If this is a TIME_SYNC, it has already set the clock.
        source.data, source.taken_ns = self._store.raw(port), self._clock.now_ns

    def fresh(self) -> bool:
        """Whether every reading has an accepted telegram, none of them older than ``age_max_ms``."""
        oldest_ns = self._clock.now_ns - self._interface.age_max_ms * 1_000_000
        return all(source.data and source.taken_ns >= oldest_ns for source in self._sources.values())

    def raws(self) -> list[int]:
        """One raw integer for each reading, from the last accepted telegrams; call only when :meth:`fresh`."""
        readings = self._interface.readings
        return [getattr(item.telegram.decode(self._sources[item.telegram.PORT].data), item.field) for item in readings]
