"""The export's description of a kind of control, in addition to the law's recorded programs.

Each kind is a subclass of :class:`Control`: the readings and commands of an ``Interface`` (:mod:`.interface`), and a
system's part ``export``, as that of the single notch of a train (:mod:`railhil.controller_node.ato.export`). The rest
of the exported C is the same for all.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Protocol

from railhil.bus.layout import Telegram
from railhil.controller_node.arithmetic.base import Arithmetic, Constant
from railhil.controller_node.program.model import LawProgram, Value
from railhil.dbc import Contract, Port, Signal
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Bits of a record's flags: a run begins; the commands sent differ from the law's.
FLAG_BEGIN = 1
FLAG_SENT = 2
_MASK = 2**32 - 1


class Word(NamedTuple):
    """One integer passed to a law: its name in the recorded program, as a C parameter, and in the log."""

    name: str
    parameter: str
    column: str


class Period(NamedTuple):
    """One control period of a log.

    ``given``: the law's inputs, raw; ``told``: the commands really sent, valid if ``flags`` has ``FLAG_SENT``.
    """

    flags: int
    given: tuple[int, ...]
    told: tuple[int, ...]


class Wire(NamedTuple):
    """A word of an FMU: its description, and the signal whose raw integer it is (None: none).

    ``quantity``: the reading or command of which it is the integer, by the name that a given controller has for it
    (:class:`railhil.controller_node.given.computing.Terms`); empty: none. ``one``: value of 1 in the quantity's unit.
    """

    words: str
    port: str = ""
    signal: Signal | None = None
    quantity: str = ""
    one: float = 1.0

    @classmethod
    def of(cls, telegram: type[Telegram], field: str, quantity: str, one: float | None = None) -> Wire:
        """The raw integer of a telegram's field.

        :param one: None: in the unit of its signal.
        :raises KeyError: it has no such field.
        """
        signal = dict(telegram.signals())[field]
        unit = "" if signal.unit == "1" else signal.unit
        words = " ".join(filter(None, (f"{signal.scale:g}", unit)))
        name = f"{telegram.PORT} {signal.name}"
        said = name if words == "1" else f"{name}, 1 is {words}"
        return cls(said, telegram.PORT, signal, quantity, signal.scale if one is None else one)


class Macro(NamedTuple):
    """The macro that converts one note of a law to its signal.

    ``signal`` gives the macro its name; ``leaf`` is the member of ``out`` (None: the law has no such note), ``shift``
    the number of fraction bits dropped, ``limits`` the range of the signal, ``words`` a description.
    """

    signal: str
    leaf: str | None = None
    shift: int = 0
    limits: tuple[int, int] = (0, 0)
    words: str = ""


class Define(NamedTuple):
    """One constant in C: name without prefix, literal, comment."""

    name: str
    literal: str
    words: str = ""


@dataclass(frozen=True, slots=True)
class Source:
    """A law in C.

    ``header`` and ``source``: text of the two files. ``columns``: names of the result words in a log, in order.
    ``macros``: names of the macros for its notes. ``commands``: members of ``out`` that are the law's commands.
    ``constants``: the single constants. Sizes are in 16-bit words: ``table_words`` of the tables, ``constant_words`` of
    the single constants, ``ram_words`` of state, inputs, outputs and event counters, ``stack_words`` the stack
    estimated for each function by its name.
    """

    name: str
    header: str
    source: str
    columns: tuple[str, ...]
    macros: tuple[str, ...]
    commands: tuple[str, ...]
    constants: tuple[Constant, ...]
    table_words: Mapping[str, int]
    constant_words: int
    ram_words: int
    stack_words: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Comments:
    """Texts for the comments of the C, for one kind of control.

    ``use``: lines at the top of the header; ``inputs``, ``sent``: comments on the two prototypes; ``status``: telegram
    of the notes; ``what``: name of the commands ("notch"); ``other``: the case in which ``sent`` is called, as the
    subject of "... sent"; ``record``: the words after the flags in a record of the host program; ``constants``,
    ``units``: contents of the node's header besides those of the bus; ``node``: purpose of the C files that only this
    kind of control has.
    """

    use: tuple[str, ...]
    inputs: str
    sent: str
    status: str
    what: str
    other: str
    record: str
    constants: str
    units: str
    node: str


class Loop(Protocol):
    """A law in Python from the start of a run; its inputs are the raw integers of the wire."""

    @property
    def state(self) -> Any:
        """The law's state after the last call."""

    def step(self, given: Sequence[int]) -> tuple[Any, Any]:
        """One control period; returns the law's inputs and its outputs."""

    def sent(self, told: Sequence[int]) -> None:
        """Pass the commands really sent to the law."""


#: Runs the bench with the controller passed to it instead of the law's own.
Play = Callable[[Any], None]


class Control(ABC):
    """A recorded law of one kind of control.

    ``programs``: the recorded law. ``given``, ``told``: the parameters of the C functions ``inputs`` and ``sent``, in
    their order; ``record``: all of them in the order of the log; ``commands``: the leaves of the law's outputs for the
    words of ``told``; ``formats``: Q of the outputs by their leaves, where the law's numbers have none.

    :raises InputError: like :func:`railhil.controller_node.program.tracer.record`.
    """

    #: Arithmetics in which it can be exported.
    arithmetics: ClassVar[tuple[str, ...]] = ("iq",)
    #: Column of the word that is the number of the control period; empty: there is none.
    period_word: ClassVar[str] = ""
    #: Whether polls begin the time if nothing else does, see :class:`railhil.controller_node.node.LawNode`.
    polls_begin: ClassVar[bool] = False
    #: Life sign before that of the first telegram on each port that it sends.
    life_start: ClassVar[int] = 15
    programs: LawProgram
    given: tuple[Word, ...]
    told: tuple[Word, ...]
    record: tuple[Word, ...]
    commands: tuple[str, ...]
    formats: Mapping[str, int]

    def __init__(self, scenario: Any, law: LawSpec) -> None:
        self.scenario: AnyScenario = scenario
        self.law = law
        self.formats = {}

    @abstractmethod
    def comments(self, name: str) -> Comments:
        """Texts for the comments of the C.

        :param name: of the law in C.
        """

    @abstractmethod
    def member(self, leaf: str) -> str:
        """Name of the structure member for a leaf of the inputs or outputs (``in.speed``, ``out.notch``)."""

    @abstractmethod
    def input_unit(self, leaf: str, value: Value) -> str:
        """Unit of a leaf of the inputs."""

    @abstractmethod
    def macros(self) -> Sequence[Macro]:
        """Macros that convert the law's notes to their signals."""

    @abstractmethod
    def loop(self, number: Arithmetic[Any]) -> Loop:
        """The law itself, at the start of a run.

        :param number: a fresh arithmetic, that of :attr:`law`.
        """

    @abstractmethod
    def runs(self, play: Play | None) -> Iterator[Iterable[Period]]:
        """The runs of the reference log.

        :param play: runs the bench; None: no run of the bench is available.
        """

    #: Folder of the C files between the telegrams and the law, package:folder.
    folder: ClassVar[str]
    #: Names of these files: sources, headers.
    sources: ClassVar[tuple[str, ...]]
    headers: ClassVar[tuple[str, ...]]

    @classmethod
    def wires(cls, scenario: Any) -> Mapping[str, Wire]:
        """The words of an FMU of any law by their columns in the log; missing ones have no description."""
        return {}

    @property
    def contract(self) -> Contract:
        """The wire contract of its system."""
        return self.scenario.installed_system.contract

    @abstractmethod
    def ports(self) -> tuple[list[Port], list[Port]]:
        """Ports that the controller receives (the clock port first), and ports that it sends.

        :raises ValueError: the C cannot count time by the contract's clock port.
        """

    @abstractmethod
    def constants(self) -> list[Define]:
        """Constants of scenario and system for the node's header."""

    def tables(self) -> list[str]:
        """Lines of the node's header after the table of ports."""
        return []

    def places(self, source: Source, constants: Mapping[str, str]) -> dict[str, str]:
        """Replacements for the ``@NAME@`` placeholders in its C files.

        :param constants: C constants of the ports by their names.
        """
        return {}


class Generator:
    """Upper bits of Numerical Recipes' linear congruential generator: the same numbers on every machine."""

    def __init__(self, seed: int) -> None:
        self._state = seed

    def between(self, low: int, high: int) -> int:
        """An integer from ``low`` to ``high``, both included."""
        self._state = (1664525 * self._state + 1013904223) & _MASK
        return low + (self._state >> 8) % (high - low + 1)
