"""The base class of laws for several units, and the signals of the bus that they read and write."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple

from railhil.bus.layout import Telegram
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.base import ControlLaw, State


def raw_range(telegram: type[Telegram], field: str) -> tuple[int, int]:
    """Smallest and largest raw value of a telegram's field.

    :raises InputError: its port has no signal for this field.
    """
    signals = dict(telegram.signals())
    if field not in signals:
        raise InputError(f"port {telegram.PORT}", "field", field, ", ".join(signals))
    return signals[field].raw_range


@dataclass(frozen=True, slots=True)
class Reading:
    """One input of the law: a field of a telegram; its raw integer is a value in Q ``q`` and ``unit``.

    ``age_max_ms``: its largest age; None: that of the interface.
    """

    name: str
    telegram: type[Telegram]
    field: str
    q: int = 0
    unit: str = ""
    age_max_ms: int | None = None


@dataclass(frozen=True, slots=True)
class Command:
    """One output of the law, in Q ``law_q``; rounded to Q ``q`` it is the raw integer of a telegram's field.

    It is limited to the range of the signal, or to ``lowest``..``highest`` (raw) where given. ``safe``: the raw value
    that is sent while a reading is missing or too old.
    """

    name: str
    telegram: type[Telegram]
    field: str
    law_q: int
    q: int = 0
    unit: str = ""
    lowest: int | None = None
    highest: int | None = None
    safe: int = 0

    @property
    def bounds(self) -> tuple[int, int]:
        """Smallest and largest raw value that can be sent."""
        low, high = raw_range(self.telegram, self.field)
        return low if self.lowest is None else self.lowest, high if self.highest is None else self.highest


@dataclass(frozen=True, slots=True)
class Note:
    """An additional figure of a law, in Q ``law_q``; a field of a status contains it in Q ``q``, rounded down.

    ``telegram``: the status that has the field; None: the interface's ``status``.
    """

    name: str
    field: str
    law_q: int
    q: int = 0
    unit: str = ""
    telegram: type[Telegram] | None = None


@dataclass(frozen=True, slots=True)
class Interface:
    """Inputs and outputs of the laws of a system (its part ``interface``).

    ``status``: telegram of the notes; ``further_status``: further ones, for notes that name them. The node also fills
    the fields ``overflow_flags`` (bit 0 wrap, 1 saturation, 2 division by zero), ``step_count`` and ``life`` of each of
    them, if it has them. ``age_max_ms``: largest age of a reading, in
    simulation time since the last accepted telegram (new life sign ``life``, check variables correct, see
    :class:`railhil.bus.acceptance.Acceptance`); if a reading is older, all commands are the safe ones.
    Each telegram of commands has a field ``life``. A reading may have a largest age of its own.
    """

    readings: tuple[Reading, ...]
    commands: tuple[Command, ...]
    notes: tuple[Note, ...] = ()
    status: type[Telegram] | None = None
    age_max_ms: int = 256
    further_status: tuple[type[Telegram], ...] = ()

    def __post_init__(self) -> None:
        for telegram in dict.fromkeys(command.telegram for command in self.commands):
            # Raises InputError for a status without it.
            raw_range(telegram, "life")

    @property
    def statuses(self) -> tuple[type[Telegram], ...]:
        """All telegrams in which the laws report."""
        return (*(() if self.status is None else (self.status,)), *self.further_status)

    def status_of(self, note: Note) -> type[Telegram] | None:
        """The telegram that contains a note; None: there is none."""
        return self.status if note.telegram is None else note.telegram

    def age_max_ns(self, reading: Reading) -> int:
        """Largest age of a reading, in ns."""
        return (self.age_max_ms if reading.age_max_ms is None else reading.age_max_ms) * 1_000_000


class Answer(NamedTuple, Generic[T]):
    """Result of a law's step: one number for each command of the interface, and one for each of its notes."""

    commands: tuple[T, ...]
    notes: tuple[T, ...] = ()


class VectorLaw(ControlLaw[T, State]):
    """A law of a system with an ``Interface``: its readings in, its commands and notes out."""

    @abstractmethod
    def start(self, readings: Sequence[T]) -> State:
        """State before the first step, from the readings of that step."""

    @abstractmethod
    def step(self, state: State, readings: Sequence[T]) -> tuple[State, Answer[T]]:
        """One control period."""

    def with_sent(self, state: State, commands: Sequence[T]) -> State:
        """The state if commands other than the law's (Q ``q`` of the interface) were really sent."""
        return state
