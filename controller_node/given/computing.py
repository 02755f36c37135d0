"""The seam between the node of a system and code of the user: named readings in units in, named commands out."""

from __future__ import annotations

import hashlib
import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.program.model import name_leaves
from railhil.controller_node.program.tracer import Tracer
from railhil.scenarios.given import GivenController
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec


class Quantity(NamedTuple):
    """A reading, or a command, in its unit.

    A reading is a leaf of a law's inputs and state (``in.speed``, ``state.sent[0]``) times a factor. A command is sent
    from ``least`` (None: minus ``largest``) to ``largest``, as a multiple of ``step`` (None: not stated).
    """

    name: str
    unit: str
    leaf: str = ""
    factor: float = 1.0
    largest: float | None = None
    step: float | None = None
    least: float | None = None


@dataclass(frozen=True, slots=True)
class Terms:
    """What a controller is given, and what it has to answer, in each control period."""

    readings: tuple[Quantity, ...]
    commands: tuple[Quantity, ...]
    period_s: float

    @property
    def interface(self) -> str:
        """Identity of the readings and commands, in compiled code that is made for them."""
        lines = [f"{one.name} {one.unit}" for one in (*self.readings, *self.commands)]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]

    def as_json(self) -> dict[str, Any]:
        """For the worker."""
        return {
            "readings": [list(one[:2]) for one in self.readings],
            "commands": [list(one[:2]) for one in self.commands],
            "period_s": self.period_s,
        }

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Terms:
        """As :meth:`as_json` gives it, without the leaves."""
        readings, commands = (tuple(Quantity(*one) for one in document[key]) for key in ("readings", "commands"))
        return cls(readings, commands, document["period_s"])


class Computer(Protocol):
    """Code of the user, at the start of a run."""

    def compute(self, readings: Sequence[float]) -> Sequence[float]:
        """One control period: values of the readings in, values of the commands out, in the order of the terms.

        :raises InputError: it fails, or its answer is no finite number for each command.
        """

    def close(self) -> None:
        """End what computes outside of this process."""


def asked_name(command: Quantity) -> str:
    """Name of a command in the recorded program of a law without one."""
    return f"asked.{command.name}"


@dataclass(frozen=True, slots=True)
class NoParameters:
    """Parameters of a law that has none."""


class SkeletonLaw:
    """Part of the laws of a system that have no program: code of the user computes their commands.

    Recorded for an export, such a law has inputs, a state with the commands really sent, and the limits and rounding of
    the commands.
    """

    _computer: Computer | None = None

    def begin(self, computer: Computer) -> None:
        """Have the commands computed by it."""
        self._computer = computer

    def share(self, other: SkeletonLaw) -> None:
        """Have the commands computed by what computes those of another law of the same system."""
        self._computer = other._computer

    def ask(self, arithmetic: Any, terms: Terms, state: Any, inputs: Any) -> Sequence[Any]:
        """Commands in their units; where the law is recorded, inputs of its program (:func:`asked_name`).

        :raises InputError: as :meth:`Computer.compute`, or nothing computes the commands.
        """
        if isinstance(arithmetic, Tracer):
            return [arithmetic.input(asked_name(one), None) for one in terms.commands]
        if self._computer is None:
            raise InputError("controller", "given", Words("no code of the user"), "a run through the nodes")
        leaves = {**dict(name_leaves(inputs, "in")), **dict(name_leaves(state, "state"))}
        factors = [arithmetic.const(Constant(one.name, one.factor, 0)) for one in terms.readings]
        readings = zip(terms.readings, factors, strict=True)
        return self._computer.compute([float(arithmetic.mpy(leaves[one.leaf], factor, 0)) for one, factor in readings])


class ComputingController(GivenController):
    """A controller that computes in units, once in a control period, within the node of the system."""

    @abstractmethod
    def start(self, terms: Terms, patience_s: float) -> Computer:
        """The code at the start of a run.

        :param patience_s: wall time for one answer.
        :raises InputError: it cannot be loaded, or does not take these readings.
        """

    def terms_of(self, scenario: AnyScenario, run: RunSpec) -> Terms:
        """Readings and commands of the system."""
        terms: Terms = scenario.installed_system.part("controller").computes(scenario, run.law).law.terms
        return terms

    def make_node(self, scenario: AnyScenario, run: RunSpec, *, fd: bool, bit_rate: int | None) -> Any:
        """The node of the system, with this code in the place of the law."""
        part = scenario.installed_system.part("controller")
        controller = part.computes(scenario, run.law)
        # The bus administrator must not lose patience first.
        computer = self.start(controller.law.terms, run.patience_s / 2)
        controller.law.begin(computer)
        node = part(scenario, run.law, controller, fd=fd, bit_rate=bit_rate)
        node.ends = computer.close
        return node


def checked_answer(source: str, terms: Terms, answer: Any) -> list[float]:
    """The values of an answer, in the order of the commands.

    :param answer: a mapping by name, a sequence in that order, or for a single command its number.
    :raises InputError: it is none of these, or not finite.
    """
    names = [one.name for one in terms.commands]
    allowed = (
        f"a number for {', '.join(f'{one.name} ({one.unit})' if one.unit else one.name for one in terms.commands)}"
    )
    values: Sequence[Any]
    if isinstance(answer, Mapping):
        if set(answer) != set(names):
            raise InputError(source, "answer", dict(answer), allowed)
        values = [answer[name] for name in names]
    elif isinstance(answer, Sequence) and not isinstance(answer, str | bytes):
        values = answer
    else:
        values = [answer]
    if len(values) != len(names):
        raise InputError(source, "answer", answer, allowed)
    found = []
    for name, value in zip(names, values, strict=True):
        try:
            if isinstance(value, str | bytes | bytearray):
                raise TypeError(value)
            number = float(value)
        except (TypeError, ValueError, OverflowError):
            raise InputError(source, f"answer, {name}", value, allowed) from None
        if not math.isfinite(number):
            raise InputError(source, f"answer, {name}", number, "a finite number")
        found.append(number)
    return found
