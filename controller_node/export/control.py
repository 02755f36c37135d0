"""What the export has to know of a way of control, beside the law's recorded programs.

One subclass of :class:`Control` for each: a train's one notch (:mod:`.notch`), and the readings and commands of an
``Interface`` (:mod:`.interface`). Everything else of the export is the same text for both.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Protocol

from railhil.controller_node.arithmetic.base import Arithmetic, Constant
from railhil.controller_node.program.model import LawProgram, Value
from railhil.dbc import Contract, Port
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import system_named

#: Bits of a record's flags: a run begins; something else was sent than the law's answer.
FLAG_BEGIN = 1
FLAG_SENT = 2
_MASK = 2**32 - 1


class Word(NamedTuple):
    """One whole number that a law is given: its name in the recorded program, as a C parameter, and in the log."""

    name: str
    parameter: str
    column: str


class Period(NamedTuple):
    """One control period of a log: what is on the wire, and what was really sent if ``FLAG_SENT`` says so."""

    flags: int
    given: tuple[int, ...]
    told: tuple[int, ...]


class Macro(NamedTuple):
    """One note of a law as its signal holds it: what the macro is named for, the member of ``out`` (None: the law has
    no such note), fraction bits cut off, limits, and what it is in words."""

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

    ``header`` and ``source``: the two files. ``columns``: names of a log's result words, in order. ``macros``: names of
    its notes' macros. ``constants``: the single constants. ``table_words`` and ``constant_words``: 16-bit words of
    tables and single constants; ``ram_words``: of state, inputs, outputs and event counters. ``stack_words``: bound of
    the stack of each function, by its name.
    """

    name: str
    header: str
    source: str
    columns: tuple[str, ...]
    macros: tuple[str, ...]
    constants: tuple[Constant, ...]
    table_words: dict[str, int]
    constant_words: int
    ram_words: int
    stack_words: dict[str, int]


@dataclass(frozen=True, slots=True)
class Comments:
    """What the C says of one way of control.

    ``use``: lines of the header's head; ``inputs``, ``sent``: above the two prototypes; ``status``: telegram of the
    notes; ``what``: what is sent ("notch"); ``other``: when ``sent`` is called ("another notch than the answer was"
    sent); ``record``: what follows the flags in a record of the host program; ``constants``, ``units``: what the
    header of the node holds besides its bus; ``node``: what the files of the system's own do in it.
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
    """A law in Python from the start of a run, whole numbers of the wire in."""

    @property
    def state(self) -> Any:
        """Its state after the last call."""

    def step(self, given: Sequence[int]) -> tuple[Any, Any]:
        """One control period; returns the law's inputs and its outputs."""

    def sent(self, told: Sequence[int]) -> None:
        """What was really sent."""


#: Makes a run of the bench with a controller in the place of the law's.
Play = Callable[[Any], None]


class Control(ABC):
    """A law of one way of control, recorded.

    ``programs``: the law. ``given``, ``told``: what goes into ``inputs`` and into ``sent``, in the order of the
    parameters; ``record``: all of them in the order of the log.

    :raises InputError: as :func:`railhil.controller_node.program.record.record`.
    """

    programs: LawProgram
    given: tuple[Word, ...]
    told: tuple[Word, ...]
    record: tuple[Word, ...]

    def __init__(self, scenario: Any, law: LawSpec) -> None:
        self.scenario: AnyScenario = scenario
        self.law = law

    @abstractmethod
    def comments(self, name: str) -> Comments:
        """Texts.

        :param name: of the law in C.
        """

    @abstractmethod
    def member(self, leaf: str) -> str:
        """Name of a leaf of inputs or outputs (``in.speed``, ``out.notch``) in its structure."""

    @abstractmethod
    def input_unit(self, leaf: str, value: Value) -> str:
        """Unit of a leaf of the inputs."""

    @abstractmethod
    def macros(self) -> Sequence[Macro]:
        """The law's notes on the wire."""

    @abstractmethod
    def loop(self, number: Arithmetic[int]) -> Loop:
        """The law itself, at the start of a run."""

    @abstractmethod
    def runs(self, play: Play | None) -> Iterator[Iterable[Period]]:
        """The runs of the reference log.

        :param play: makes a run of the bench; None: there is none to be had.
        """

    #: Folder of the C files that stand between the telegrams and the law, package:folder.
    folder: ClassVar[str]
    #: Their names: sources, headers.
    sources: ClassVar[tuple[str, ...]]
    headers: ClassVar[tuple[str, ...]]

    @property
    def contract(self) -> Contract:
        """The wire contract of its system."""
        return system_named(self.scenario.system).contract

    @abstractmethod
    def ports(self) -> tuple[list[Port], list[Port]]:
        """Ports that the controller receives, the clock port first, and those that it answers.

        :raises ValueError: another port is the clock than the C counts by.
        """

    @abstractmethod
    def constants(self) -> list[Define]:
        """Numbers of scenario and system for the header of the node."""

    def tables(self) -> list[str]:
        """Lines of that header after the table of ports."""
        return []

    @abstractmethod
    def places(self, source: Source) -> dict[str, str]:
        """What stands between two @ in its C files."""


class Generator:
    """Numerical Recipes' linear congruential generator, upper bits: the same numbers everywhere."""

    def __init__(self, seed: int) -> None:
        self._state = seed

    def between(self, low: int, high: int) -> int:
        """A whole number of ``low`` to ``high``."""
        self._state = (1664525 * self._state + 1013904223) & _MASK
        return low + (self._state >> 8) % (high - low + 1)
