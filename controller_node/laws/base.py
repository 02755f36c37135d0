"""What every control law looks like to the controller."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.laws.note import Note
from railhil.scenarios.model import Scenario

State = TypeVar("State")

# Q formats at the edge of every law.
#: Speeds, set-points and their differences, km/h.
SPEED_Q = 20
#: Notch before clipping and quantising: a saturated deviation times the largest gains stays inside +-4096.
NOTCH_RAW_Q = 19
#: Notch as sent, 1/256 notch.
NOTCH_Q = 8


class BaliseReading(NamedTuple, Generic[T]):
    """The last balise passed: its number (0: none yet), where it was surveyed, and the odometer at its passing.

    Whole numbers (Q0), positions in 0.1 mm.
    """

    number: T
    position_01mm: T
    odometer_01mm: T


class TrackInputs(NamedTuple, Generic[T]):
    """What a law with ``track`` is given besides: the number of the control period, for tables over time, the
    odometer in 0.1 mm and the last balise (Q0)."""

    k: Any
    position_01mm: T
    balise: BaliseReading[T]


class LawInputs(NamedTuple, Generic[T]):
    """What a law is given each control period; speeds in km/h, Q ``SPEED_Q``.

    ``preview`` holds the set-points of the next ``horizon`` periods. ``track`` is empty for a law without
    :attr:`Law.track`.
    """

    speed: T
    set_point: T
    preview: Sequence[T]
    track: TrackInputs[T] | tuple[()] = ()


class LawOutputs(NamedTuple, Generic[T]):
    """What a law answers.

    ``notch_raw`` in Q ``NOTCH_RAW_Q`` before clipping and quantising, ``notch`` in Q ``NOTCH_Q`` as to be sent,
    ``notes`` the figures that :attr:`Law.notes` declares, in that order and in those formats. Everything in between is
    named by :meth:`Arithmetic.note`.
    """

    notch_raw: T
    notch: T
    notes: tuple[T, ...] = ()


class Law(ABC, Generic[T, State]):
    """A control law bound to an arithmetic and to its constants; it keeps no state of its own.

    ``step`` is pure and straight-line: operations of the arithmetic on named quantities, and no Python branch that
    depends on data, so that one text serves one train, N trains and an export.
    """

    #: Name of the entry point.
    name: ClassVar[str]
    #: Set-point indexings with which the law works.
    indexings: ClassVar[tuple[str, ...]] = ("time", "distance")
    #: True for a law that is given ``LawInputs.track``.
    track: ClassVar[bool] = False
    #: What it tells of itself in CTL_STAT: at most one bit field and two other figures.
    notes: ClassVar[tuple[Note, ...]] = ()
    #: Frozen dataclass of the law's parameters: defaults the published or textbook ones, types with the range that a
    #: file may set (``Annotated[float, Field(ge=0, le=1)]``).
    parameters_type: ClassVar[type[Any]]
    #: Parameters that ``railhil tune`` may change, and their bounds.
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {}
    #: Where the defaults come from, as it stands behind "the law's own parameters:".
    parameters_origin: ClassVar[str] = "origin not stated"
    #: Perturbed runs from which the defaults were chosen: name of the scenario, seeds. Nobody judges them by these.
    design_seeds: ClassVar[Mapping[str, range]] = {}

    @abstractmethod
    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: Any = None) -> None:
        """Bind the law to its constants.

        :param scenario: the nominal one: train, line and timetable as the controller knows them.
        :param parameters: a :attr:`parameters_type`; None: its defaults.
        """

    @property
    @abstractmethod
    def horizon(self) -> int:
        """Number of set-points ahead, in control periods, that ``LawInputs.preview`` holds."""

    @property
    @abstractmethod
    def constants(self) -> tuple[Constant, ...]:
        """Every constant of the law, for reports and export."""

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """Bounds of state variables that the law's own reasoning gives, in units, by name (``model[0]``).

        For the interval analysis: a variable that feeds back into itself has no bound that intervals alone can find.
        """
        return {}

    @abstractmethod
    def start(self, inputs: LawInputs[T]) -> State:
        """State before the first step, given what that step will be given."""

    @abstractmethod
    def step(self, state: State, inputs: LawInputs[T]) -> tuple[State, LawOutputs[T]]:
        """One control period."""

    @abstractmethod
    def with_sent(self, state: State, notch: T) -> State:
        """The state when another notch than the law's (Q ``NOTCH_Q``) was really sent."""

    @classmethod
    def memory_key(cls, scenario: Scenario) -> str:
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
