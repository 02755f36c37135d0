"""What a law over several units looks like, and between which signals of the bus it stands."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

from railhil.bus.layout import Telegram
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T

State = TypeVar("State")


def raw_range(telegram: type[Telegram], field: str) -> tuple[int, int]:
    """Smallest and largest raw value of a telegram's field.

    :raises KeyError: it has no such field.
    """
    return dict(telegram.signals())[field].raw_range


@dataclass(frozen=True, slots=True)
class Reading:
    """One number that the law is given: a field of a telegram, its raw integer taken as Q ``q`` in ``unit``."""

    name: str
    telegram: type[Telegram]
    field: str
    q: int = 0
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Command:
    """One number that the law answers, in Q ``law_q``; rounded to Q ``q`` it is the raw integer of a telegram's field.

    It is kept inside what the signal can hold, or ``lowest`` to ``highest`` (raw). ``safe``: what is sent, raw, while
    a reading is missing or too old.
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
        """Smallest and largest raw value that is ever sent."""
        low, high = raw_range(self.telegram, self.field)
        return low if self.lowest is None else self.lowest, high if self.highest is None else self.highest


@dataclass(frozen=True, slots=True)
class Note:
    """What a law says besides, in Q ``law_q``: Q ``q`` of it, cut off downwards, stands in a field of the status."""

    name: str
    field: str
    law_q: int
    q: int = 0
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Interface:
    """Between which signals the laws of a system stand (its part ``interface``).

    ``status``: telegram of the notes; of its other fields the node fills ``overflow_flags`` (bit 0 wrap, 1 saturation,
    2 division by zero), ``step_count`` and ``life``, where they are. ``age_max_ms``: of the readings, in simulation
    time since the last telegram that was accepted (:class:`railhil.bus.acceptance.Acceptance`: new life sign ``life``,
    check variables correct); beyond it every command is the safe one. Each telegram of commands has a ``life``.
    """

    readings: tuple[Reading, ...]
    commands: tuple[Command, ...]
    notes: tuple[Note, ...] = ()
    status: type[Telegram] | None = None
    age_max_ms: int = 256


class Answer(NamedTuple, Generic[T]):
    """What a law answers: one number for each command of the interface, and for each of its notes."""

    commands: tuple[T, ...]
    notes: tuple[T, ...] = ()


class VectorLaw(ABC, Generic[T, State]):
    """A control law bound to an arithmetic and to its constants; it keeps no state of its own.

    ``step`` is pure and straight-line, as in :class:`railhil.controller_node.laws.base.Law`, so that one text serves
    every arithmetic, the telemetry and the interval analysis.
    """

    #: Name of the entry point.
    name: ClassVar[str]
    #: Frozen dataclass of the law's parameters, see :class:`railhil.controller_node.laws.base.Law`.
    parameters_type: ClassVar[type[Any]]
    #: Where the defaults come from.
    parameters_origin: ClassVar[str] = "origin not stated"
    #: Runs from which the defaults were chosen: name of the scenario, seeds.
    design_seeds: ClassVar[Mapping[str, range]] = {}
    #: Notes of a vector law are those of its system's interface.
    notes: ClassVar[tuple[Any, ...]] = ()
    #: Over what it takes its set-point: time, in every law of a vector.
    indexings: ClassVar[tuple[str, ...]] = ("time",)

    @abstractmethod
    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        """Bind the law to its constants.

        :param scenario: of the law's system.
        :param parameters: a :attr:`parameters_type`; None: its defaults.
        """

    @property
    @abstractmethod
    def constants(self) -> tuple[Constant, ...]:
        """Every constant of the law."""

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """Bounds of state variables that the law's own reasoning gives, in units, by name (``speed[0]``)."""
        return {}

    @abstractmethod
    def start(self, readings: Sequence[T]) -> State:
        """State before the first step, given what that step will be given."""

    @abstractmethod
    def step(self, state: State, readings: Sequence[T]) -> tuple[State, Answer[T]]:
        """One control period."""

    def with_sent(self, state: State, commands: Sequence[T]) -> State:
        """The state when other commands (Q ``q`` of the interface) than the law's were really sent."""
        return state

    @classmethod
    def memory_key(cls, scenario: Any) -> str:
        """Under what the law keeps a memory from run to run (train, platform, ...); empty: it keeps none.

        A law with a key is made with one argument more, ``memory``: what :meth:`memory` answered at the end of its last
        run, None before the first. The record of its program is made with it too, so that its formats are checked.
        """
        return ""

    def memory(self, state: State) -> Mapping[str, Any]:
        """What the law wants kept when the run is over: a dict of numbers, texts and lists that JSON can hold.

        :param state: after its last step; numbers of the arithmetic are read by :meth:`Arithmetic.raw`.
        """
        return {}
