"""The law of a system with an ``Interface`` whose commands are computed by code of the user."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.given.computing import NoParameters, Quantity, SkeletonLaw, Terms
from railhil.controller_node.program.model import identifier
from railhil.controller_node.vector.law import Answer, Command, Interface, VectorLaw
from railhil.scenarios.model import AnyScenario


class Sent(NamedTuple):
    """State: the commands that were really sent last."""

    commands: tuple[Any, ...]


def _command(one: Command) -> Quantity:
    least, largest = (raw / 2**one.q for raw in one.bounds)
    return Quantity(identifier(one.name), one.unit, largest=largest, step=2.0**-one.q, least=least)


class GivenVectorLaw(SkeletonLaw, VectorLaw[T, Sent]):
    """See :class:`~railhil.controller_node.given.computing.SkeletonLaw`."""

    name: ClassVar[str] = "given"
    floating: ClassVar[bool] = True
    parameters_type: ClassVar[type[Any]] = NoParameters
    parameters_origin: ClassVar[str] = "those of a given controller"

    def __init__(self, arithmetic: Arithmetic[T], scenario: AnyScenario, parameters: Any = None) -> None:
        self._arithmetic = arithmetic
        interface: Interface = scenario.installed_system.part("interface")
        self.terms = Terms(
            (
                *(Quantity(identifier(one.name), one.unit, f"in[{n}]") for n, one in enumerate(interface.readings)),
                *(
                    Quantity(f"sent_{identifier(one.name)}", one.unit, f"state.commands[{n}]")
                    for n, one in enumerate(interface.commands)
                ),
            ),
            tuple(_command(one) for one in interface.commands),
            scenario.timing.control_period_ns / 1e9,
        )
        self._zeros = tuple(
            arithmetic.const(Constant("zero", 0.0, one.law_q, "skeleton")) for one in interface.commands
        )
        self._notes = tuple(arithmetic.const(Constant("zero", 0.0, one.law_q, "skeleton")) for one in interface.notes)

    @property
    def constants(self) -> tuple[Constant, ...]:
        return ()

    def start(self, readings: Sequence[T]) -> Sent:
        return Sent(self._zeros)

    def step(self, state: Sent, readings: Sequence[T]) -> tuple[Sent, Answer[T]]:
        commands = tuple(self.ask(self._arithmetic, self.terms, state, tuple(readings)))
        return Sent(commands), Answer(commands, self._notes)

    def with_sent(self, state: Sent, commands: Sequence[T]) -> Sent:
        return Sent(tuple(commands))
