"""The controller of any system: a law on one arithmetic, its program, telemetry and cost.

:class:`~railhil.controller_node.ato.controller.Controller` and
:class:`~railhil.controller_node.vector.controller.VectorController` are subclasses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from railhil.common.errors import InputError, Words
from railhil.common.mypyc import mypyc_attr
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Counters
from railhil.controller_node.compiled_law import compile_law
from railhil.controller_node.cost import Cost, cost_of
from railhil.controller_node.laws.failure import describe_failure
from railhil.controller_node.program.ranges import Interval, refuse_wraps
from railhil.controller_node.program.tracer import record_loop
from railhil.controller_node.telemetry import Telemetry
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import System


@dataclass(frozen=True, slots=True)
class CommandCode:
    """One output of a law: on the wire an integer, in Q ``q`` of ``unit``."""

    name: str
    q: int
    unit: str

    def shown(self, code: int) -> str:
        """A code in its unit: ``3/256 notch``, ``3 x 0.01 N``."""
        number = f"{code}/{1 << self.q}" if self.q > 0 else f"{code << -self.q}"
        return f"{number} {'x ' * self.unit[:1].isdigit()}{self.unit}".strip()


class Computed(Protocol):
    """Result of one control period."""

    @property
    def commands(self) -> tuple[int, ...]:
        """One code for each command, in the order of :attr:`LawController.commands`."""


@mypyc_attr(allow_interpreted_subclasses=True)
class LawController:
    """One law on one arithmetic; inputs and outputs are raw integers of the bus.

    A subclass has ``step``, one control period, which returns a :class:`Computed`, and ``sent``, which passes the codes
    really sent, one for each command, to the law if they are not those that ``step`` returned. ``telemetry`` is up to
    date after each of them; ``cost`` is that of every control period.

    :param law: a law of the system and the way to run it; in ``iq`` (C28x fixed point) there is no float between the
        arguments of ``step`` and its result.
    :param arithmetic: a fresh one to use instead of the one named by ``law``.
    :param may_wrap: accept a law in which an operation may wrap.
    :raises InputError: as the class :attr:`loop`; an operation of the law may wrap in fixed point for a value on the
        wire. In ``step`` and ``sent``: the law has raised.
    """

    #: Class of the :class:`~railhil.controller_node.law_loop.LawLoop`, made from scenario, law and arithmetic.
    loop: ClassVar[type[Any]]
    #: The law's outputs.
    commands: tuple[CommandCode, ...]
    #: Raw range of each input of the law's program, by name, for all values that may be on the wire.
    wire: Mapping[str, Interval]

    def __init__(
        self,
        scenario: AnyScenario,
        law: LawSpec,
        arithmetic: Arithmetic[Any] | None = None,
        *,
        may_wrap: bool = False,
    ) -> None:
        #: The arithmetic on which the law runs.
        self.arithmetic = number = arithmetic or make(law.arithmetic)
        self._loop: Any = self.loop(scenario, law, number)
        #: The law, with ``constants`` and ``state_bounds``.
        self.law = self._loop.law
        #: Program of the law, recorded for this arithmetic.
        self.program = program = record_loop(self.loop, scenario, law, wide=number.wide)
        ranges = None
        if not number.wide and not may_wrap:
            ranges = refuse_wraps(program, self.law, f"at {self._loop.made_for}", self.wire)
        if law.given is None:
            self._loop.compiled = compile_law(program, self.law, number, ranges)
        # Telemetry starts here, after the law's constants have been made.
        number.noted = []
        self.telemetry = Telemetry(program.quantities)
        period_ns = scenario.timing.control_period_ns
        # Of code of the user nothing is known.
        self.cost = cost_of(program, number, period_ns) if law.given is None else Cost({}, 0, period_ns)

    @property
    def counters(self) -> Counters:
        """Wraps, saturations and divisions by zero since the controller was made."""
        return self.arithmetic.counters

    @property
    def state(self) -> Any:
        """State of the law; None before the first step."""
        return self._loop.state

    def kept(self) -> dict[str, Any] | None:
        """Key and values of the law's memory after the last step; None for a law that keeps none.

        :raises InputError: the law has raised, or its answer cannot be stored in a file.
        """
        found: dict[str, Any] | None = self._loop.kept()
        return found

    def failed(self, error: Exception, function: str) -> InputError:
        """The error line for a law that raised in a run, with the last quantity that it named in this period."""
        named = self.telemetry.quantities[: len(self.arithmetic.noted or ())]
        last = named[-1].name if named else None
        return describe_failure(self._loop.name, type(self.law), error, function, last)


def maker_of(system: System, scenario: AnyScenario) -> type[Any]:
    """The :class:`LawController` of a system.

    :raises InputError: the system's controller has no class attribute ``computes``.
    """
    maker: type[Any] | None = getattr(system.part("controller"), "computes", None)
    if maker is None:
        found = Words(f"{system.name}, whose controller is {system.controller}")
        raise InputError(scenario.name, "system", found, "a controller with a class attribute computes, as VectorNode")
    return maker
