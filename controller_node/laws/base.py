"""The interface of a control law."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.laws.note import Note

State = TypeVar("State")

# Q formats of the inputs and outputs of every law.
#: Speeds, set-points and their differences, km/h.
SPEED_Q = 20
#: Notch before clipping and quantising: a saturated deviation times the largest gains stays inside +-4096.
NOTCH_RAW_Q = 19
#: Notch as sent, 1/256 notch.
NOTCH_Q = 8

#: Largest error of the distance by the odometer that a worn wheel explains, as a share: 1.25 %.
WHEEL_ERROR_MAX = 1 / 80
#: Largest error of a surveyed balise that is explained without the wheel.
BALISE_ERROR_MAX_M = 0.5


class BaliseReading(NamedTuple, Generic[T]):
    """The last balise passed: its number (0: none yet), its surveyed position, and the odometer at its passing.

    Whole numbers (Q0), positions in 0.1 mm.
    """

    number: T
    position_01mm: T
    odometer_01mm: T


class TrackInputs(NamedTuple, Generic[T]):
    """Additional inputs of a law with ``track``: the number of the control period, for tables over time, the odometer
    in 0.1 mm and the last balise (Q0)."""

    k: Any
    position_01mm: T
    balise: BaliseReading[T]


class LawInputs(NamedTuple, Generic[T]):
    """Inputs of a law in each control period; speeds in km/h, Q ``SPEED_Q``.

    ``preview`` holds the set-points of the next ``horizon`` periods. ``track`` is empty for a law without
    :attr:`Law.track`.
    """

    speed: T
    set_point: T
    preview: Sequence[T]
    track: TrackInputs[T] | tuple[()] = ()


class LawOutputs(NamedTuple, Generic[T]):
    """Outputs of a law.

    ``notch_raw`` in Q ``NOTCH_RAW_Q`` before clipping and quantising, ``notch`` in Q ``NOTCH_Q`` to be sent, ``notes``
    the figures declared by :attr:`Law.notes`, in that order and in those formats. Intermediate quantities are named by
    :meth:`Arithmetic.note`.
    """

    notch_raw: T
    notch: T
    notes: tuple[T, ...] = ()


class ControlLaw(ABC, Generic[T, State]):
    """A control law bound to an arithmetic and to its constants; it keeps no state of its own.

    ``step`` is a pure function without branches: operations of the arithmetic on named quantities, and no Python branch
    that depends on data, so the same code serves one train, N trains and an export.
    """

    #: Name by which it is requested.
    name: ClassVar[str]
    #: Set-point indexings with which the law works.
    indexings: ClassVar[tuple[str, ...]] = ("time",)
    #: Its notes in CTL_STAT: at most one bit field and two other figures. A law of an ``Interface`` has none: its notes
    #: are those of the interface.
    notes: ClassVar[tuple[Note, ...]] = ()
    #: Frozen dataclass of the law's parameters: the defaults are published or textbook values, the types give the range
    #: that a file may set (``Annotated[float, Field(ge=0, le=1)]``).
    parameters_type: ClassVar[type[Any]]
    #: Parameters that ``railhil tune`` may change, and their bounds.
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {}
    #: Origin of the defaults, as printed after "the law's own parameters:".
    parameters_origin: ClassVar[str] = "origin not stated"
    #: Perturbed runs used to choose the defaults: name of the scenario, seeds. The law is not evaluated on them.
    design_seeds: ClassVar[Mapping[str, range]] = {}
    #: True: the law has no fixed-point formats and needs float64 or float32.
    floating: ClassVar[bool] = False
    #: True: its steps ask a solver (:meth:`~railhil.controller_node.arithmetic.base.Arithmetic.solve`). Such a law is
    #: also ``floating`` and needs an arithmetic that solves: float64. Its recorded program contains the solution as one
    #: operation, so it has no C and no audit.
    solver: ClassVar[bool] = False

    @abstractmethod
    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        """Bind the law to its constants.

        :param scenario: a nominal scenario of the law's system: train, line and task as known to the controller.
        :param parameters: a :attr:`parameters_type`; None: its defaults.
        """

    @property
    @abstractmethod
    def constants(self) -> tuple[Constant, ...]:
        """Every constant of the law, for reports and export."""

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """Bounds of state variables derived by the law's author, in physical units, by name (``model[0]``).

        For the interval analysis, which alone cannot find a bound for a variable that feeds back into itself.
        """
        return {}

    @classmethod
    def memory_key(cls, scenario: Any) -> str:
        """Key of the law's memory from run to run (train, platform, ...); empty: it keeps none.

        A law with a key is constructed with one more argument, ``memory``
        (:class:`railhil.controller_node.laws.memory.Remembered`): the result of :meth:`memory` at the end of its last
        run, and the place where it was stored. Its program is recorded with that memory too, so that its formats are
        checked.
        """
        return ""

    @classmethod
    def check_memory(cls, scenario: Any, values: Mapping[str, Any]) -> None:
        """Refuse stored values with which the law must not begin, although they are undamaged: out of range, missing.

        :param values: as :meth:`memory` returned them, after JSON.
        :raises Exception: of any kind; its text says what is wrong. Another record is then used, or none.
        """

    def memory(self, state: State) -> Mapping[str, Any]:
        """The memory to keep after the run: a dict of numbers, strings and lists that JSON can hold.

        :param state: after its last step; numbers of the arithmetic are converted by :meth:`Arithmetic.raw`.
        """
        return {}


class Law(ControlLaw[T, State]):
    """A law of the system ``ato``: speed and set-points in, a notch out."""

    indexings: ClassVar[tuple[str, ...]] = ("time", "distance")
    #: True for a law that uses ``LawInputs.track``.
    track: ClassVar[bool] = False

    @property
    @abstractmethod
    def horizon(self) -> int:
        """Number of future set-points, in control periods, in ``LawInputs.preview``."""

    @abstractmethod
    def start(self, inputs: LawInputs[T]) -> State:
        """State before the first step, from the inputs of that step."""

    @abstractmethod
    def step(self, state: State, inputs: LawInputs[T]) -> tuple[State, LawOutputs[T]]:
        """One control period."""

    @abstractmethod
    def with_sent(self, state: State, notch: T) -> State:
        """The state if a notch other than the law's (Q ``NOTCH_Q``) was really sent."""
