"""Declarations of a system from which its events are found: watches with their levels, interlocks, judged telegrams."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from railhil.bus.acceptance import checks_of, life_of
from railhil.bus.layout import Telegram
from railhil.record.trace import FloatArray, Trace
from railhil.scenarios.profiles import Profile


def in_words(scenario: Any, level: str, cause: str) -> str:
    return cause.replace("_", " ")


@dataclass(frozen=True, slots=True)
class Watch:
    """A reaction ladder whose level is on the bus.

    ``name``: source of its events, and of a column of ``signals.csv``. ``title``: stands before its levels in
    sentences; empty: nothing. ``port``, ``level``, ``cause``: the telegram and its signals; the wire contract has the
    words of both. ``ladder``: raw values of the level from normal to the strongest reaction; others are no reaction (a
    controller that initialises). ``start``: causes for which the first level of a run is no reaction but the normal
    start. ``said``: (scenario, level, cause) -> the cause in words. ``uncaused``: the cause of a level without one, in
    words; empty: not known. ``quiet``: levels of the ladder that are no reaction either, such as an indication to the
    driver. ``rungs``: how strong each level of the ladder is, as a place in
    :data:`railhil.faults.model.WATCH_LEVELS`; empty: its place in the ladder.
    """

    name: str
    title: str
    port: str
    level: str
    cause: str
    ladder: tuple[int, ...]
    start: frozenset[str] = frozenset()
    said: Callable[[Any, str, str], str] = in_words
    uncaused: str = ""
    quiet: frozenset[int] = frozenset()
    rungs: tuple[int, ...] = ()

    def is_normal(self, level: int) -> bool:
        """Whether a level is no reaction."""
        return level == self.ladder[0] or level in self.quiet


@dataclass(frozen=True, slots=True)
class Received:
    """Telegrams of one port whose receiver judges their content: life sign, check variables, values in range.

    Names of signals; ``life`` is empty for a telegram without one. ``ranges``: smallest and largest raw value.
    ``follows_bad``: the life sign of a telegram that is refused for its content is the last one nevertheless.
    """

    port: str
    life: str
    checks: tuple[str, ...]
    ranges: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    follows_bad: bool = True

    @classmethod
    def of(cls, kind: type[Telegram], ranges: Mapping[str, tuple[int, int]] | None = None) -> Received:
        """The signals that :class:`railhil.bus.acceptance.Acceptance` checks in a telegram, and ``ranges``.

        :raises InputError: its life sign is not a number of 4 bits.
        """
        life = life_of(kind)
        checks = tuple(signal.name for signal in checks_of(kind).values())
        return cls(kind.PORT, "" if life is None else life.name, checks, ranges or {})


@dataclass(frozen=True, slots=True)
class Place:
    """A named place of a scenario; ``position``: in the unit of the truth's position.

    ``kind``: ``stop`` (where the train is to stand), ``balise``, or ``mark`` (anything else).
    """

    name: str
    position: float
    kind: str = "stop"


@dataclass(frozen=True, slots=True)
class ShownProfile:
    """A quantity over the position as the scenario has it, such as the grade, in its displayed ``unit``.

    ``rows``: position and value; ``is_step``: each value holds until the next row, otherwise it is linear between them.
    """

    label: str
    unit: str
    rows: Profile
    is_step: bool = True


@dataclass(frozen=True, slots=True)
class Interlocks:
    """Signals of one port with the raw value that each has in normal operation."""

    port: str
    normal: Mapping[str, int]


def interface_received(interface: Any) -> tuple[Received, ...]:
    """The telegrams of a system whose laws use the signals of an ``Interface``: its readings and its commands.

    :param interface: a :class:`railhil.controller_node.vector.law.Interface`.
    """
    kinds = dict.fromkeys(item.telegram for item in (*interface.readings, *interface.commands))
    return tuple(Received.of(kind) for kind in kinds)


def reports(trace: Trace, watch: Watch) -> bool:
    """Whether the record can have the watch's levels; a record of an earlier version may not."""
    return trace.has(watch.port, watch.level)


def ranks(trace: Trace, watch: Watch) -> FloatArray:
    """Place in the ladder (0 = normal) in each telegram of the watch's port, NaN for other states; shape (n,)."""
    rank_of = {value: float(rank) for rank, value in enumerate(watch.ladder)}
    return np.array([rank_of.get(raw, np.nan) for raw in trace.raw(watch.port, watch.level).tolist()], dtype=np.float64)
