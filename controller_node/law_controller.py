"""What drives a law of whatever system, as the audit looks into it: :class:`Controller` and
:class:`VectorController`."""

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
    """One number that a law answers: on the wire a whole number, Q ``q`` of ``unit``."""

    name: str
    q: int
    unit: str

    def shown(self, code: int) -> str:
        """A code in its unit: ``3/256 notch``, ``3 x 0.01 N``."""
        number = f"{code}/{1 << self.q}" if self.q > 0 else f"{code << -self.q}"
        return f"{number} {'x ' * self.unit[:1].isdigit()}{self.unit}".strip()


class Computed(Protocol):
    """What one control period gives."""

    @property
    def commands(self) -> tuple[int, ...]:
        """One code for each command, in their order."""


class LawController(Protocol):
    """One law on one arithmetic, from whole numbers of the bus to whole numbers of the bus."""

    telemetry: Telemetry
    cost: Cost
    #: The law as it is recorded for this arithmetic.
    program: LawProgram

    @property
    def arithmetic(self) -> Arithmetic[Any]:
        """On which the law runs."""

    @property
    def law(self) -> Any:
        """The law, with ``constants`` and ``state_bounds``."""

    @property
    def commands(self) -> tuple[CommandCode, ...]:
        """What the law answers."""

    @property
    def wire(self) -> Mapping[str, Interval]:
        """What the law may be handed, raw, whatever is on the wire: by name of the inputs of its program."""

    @property
    def counters(self) -> Counters:
        """Wraps, saturations and divisions by zero since the controller was made."""

    # Any arguments: what the law is given, and the codes that were really sent in place of its own.
    def step(self, *given: Any, **named: Any) -> Computed:
        """One control period."""

    def sent(self, *codes: Any, **named: Any) -> None:
        """Tell the law the codes really sent, one for each command."""


class MakesControllers(Protocol):
    """Class of a :class:`LawController`: what a controller's side of the bus names as ``computes``."""

    def __call__(
        self, scenario: Any, law: LawSpec, arithmetic: Arithmetic[Any], *, may_wrap: bool = False
    ) -> LawController:
        """Make one on a fresh arithmetic. ``may_wrap``: also of a law of which an operation may wrap."""


def maker_of(system: System, scenario: AnyScenario) -> MakesControllers:
    """What makes the controllers of a system.

    :raises InputError: its controller does not say.
    """
    maker: MakesControllers | None = getattr(system.part("controller"), "computes", None)
    if maker is None:
        found = Words(f"{system.name}, whose controller is {system.controller}")
        raise InputError(scenario.name, "system", found, "a controller with a class attribute computes, as VectorNode")
    return maker
