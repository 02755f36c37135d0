"""The interface through which the audit uses the controller of any system.

:class:`~railhil.controller_node.ato.controller.Controller` and
:class:`~railhil.controller_node.vector.controller.VectorController` implement it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.base import Arithmetic, Counters
from railhil.controller_node.cost import Cost
from railhil.controller_node.program.model import LawProgram
from railhil.controller_node.program.ranges import Interval
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


class LawController(Protocol):
    """One law on one arithmetic; inputs and outputs are raw integers of the bus."""

    telemetry: Telemetry
    cost: Cost
    #: Program of the law, recorded for this arithmetic.
    program: LawProgram

    @property
    def arithmetic(self) -> Arithmetic[Any]:
        """The arithmetic on which the law runs."""

    @property
    def law(self) -> Any:
        """The law, with ``constants`` and ``state_bounds``."""

    @property
    def commands(self) -> tuple[CommandCode, ...]:
        """The law's outputs."""

    @property
    def wire(self) -> Mapping[str, Interval]:
        """Raw range of each input of the law's program, by name, for anything that may be on the wire."""

    @property
    def counters(self) -> Counters:
        """Wraps, saturations and divisions by zero since the controller was made."""

    # The arguments depend on the controller: the law's inputs, and the codes really sent instead of its own.
    def step(self, *given: Any, **named: Any) -> Computed:
        """One control period."""

    def sent(self, *codes: Any, **named: Any) -> None:
        """Pass the codes really sent, one for each command, to the law."""


class MakesControllers(Protocol):
    """Class of a :class:`LawController`; the class attribute ``computes`` of a controller's node refers to it."""

    def __call__(
        self, scenario: Any, law: LawSpec, arithmetic: Arithmetic[Any], *, may_wrap: bool = False
    ) -> LawController:
        """Make one on a fresh arithmetic; ``may_wrap``: accept also a law in which an operation may wrap."""


def maker_of(system: System, scenario: AnyScenario) -> MakesControllers:
    """Class that makes the controllers of a system.

    :raises InputError: the system's controller has no class attribute ``computes``.
    """
    maker: MakesControllers | None = getattr(system.part("controller"), "computes", None)
    if maker is None:
        found = Words(f"{system.name}, whose controller is {system.controller}")
        raise InputError(scenario.name, "system", found, "a controller with a class attribute computes, as VectorNode")
    return maker
