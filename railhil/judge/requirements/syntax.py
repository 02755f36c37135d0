"""The parts of a sentence, as the parser finds them. Each has the columns of its text, from 0."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class Node:
    """A part of a sentence: its text begins at ``column`` and ends before ``after``."""

    column: int
    after: int


@dataclass(frozen=True, slots=True)
class Number(Node):
    """A number with its unit; empty: it has none."""

    value: Fraction
    unit: str


@dataclass(frozen=True, slots=True)
class Name(Node):
    """A column of ``signals.csv``, a name of ``[define]``, a word of a level, or an event."""

    name: str


@dataclass(frozen=True, slots=True)
class PortSignal(Node):
    """``PORT.Signal`` of the port table."""

    port: str
    signal: str


@dataclass(frozen=True, slots=True)
class Arithmetic(Node):
    """``+ - * /`` of two values."""

    sign: str
    left: Value
    right: Value


@dataclass(frozen=True, slots=True)
class Call(Node):
    """A function; a port or an event is its only argument, by name."""

    function: str
    values: tuple[Value, ...] = ()
    time: Number | None = None
    port: Name | None = None
    event: Condition | None = None


@dataclass(frozen=True, slots=True)
class Compare(Node):
    """A comparison of two values."""

    sign: str
    left: Value
    right: Value


@dataclass(frozen=True, slots=True)
class OneOf(Node):
    """``value in (word, word)``."""

    value: Value
    words: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class Junction(Node):
    """``and`` or ``or``."""

    word: str
    left: Condition
    right: Condition


@dataclass(frozen=True, slots=True)
class Not(Node):
    """The opposite of a condition."""

    of: Condition


@dataclass(frozen=True, slots=True)
class Occurs(Node):
    """An event, or a condition with a name of ``[define]``."""

    name: str


@dataclass(frozen=True, slots=True)
class Edge(Node):
    """``begin of`` or ``end of`` a condition."""

    word: str
    of: Condition


Value: TypeAlias = Number | Name | PortSignal | Arithmetic | Call
Condition: TypeAlias = Compare | OneOf | Junction | Not | Occurs | Edge


@dataclass(frozen=True, slots=True)
class Limit(Node):
    """``start`` or ``end`` of the record."""

    word: str


@dataclass(frozen=True, slots=True)
class Scope(Node):
    """The part of the record that is judged. ``from``: both instants; ``after``: one event; ``between``: two events."""

    word: str
    first: Number | Limit | Condition
    last: Number | Limit | Condition | None = None


@dataclass(frozen=True, slots=True)
class Always(Node):
    """The condition holds at every tick."""

    condition: Condition


@dataclass(frozen=True, slots=True)
class Never(Node):
    """The condition holds at no tick, or never for longer than a time."""

    condition: Condition
    longer: Number | None = None


@dataclass(frozen=True, slots=True)
class Whenever(Node):
    """When ``given`` holds, the condition holds from a tick on that lies between ``first`` and ``last`` (None: at
    once), for a time, or until another condition holds; ``until``: ``end``: the end of the record."""

    given: Condition
    condition: Condition
    first: Number | None = None
    last: Number | None = None
    hold: Number | None = None
    until: Condition | Limit | None = None


@dataclass(frozen=True, slots=True)
class At(Node):
    """The condition holds at each event; ``end``: at the end of the record."""

    event: Condition | Limit
    condition: Condition


@dataclass(frozen=True, slots=True)
class Eventually(Node):
    """The condition comes to hold, for a time, at the latest ``within`` a time."""

    condition: Condition
    within: Number | None = None
    hold: Number | None = None


Body: TypeAlias = Always | Never | Whenever | At | Eventually


@dataclass(frozen=True, slots=True)
class Sentence:
    """A requirement: what holds, and in which part of the record; None: in all of it."""

    text: str
    scope: Scope | None
    body: Body
