"""What a law does apart from the values of its constants, from one call of each of its functions.

Two laws of one shape can be computed as one law whose constants are arrays. A law has no branches on data, so one call
shows all of its operations; which ones they are may still depend on what it was constructed with, as on its memory.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.program.model import Value, leaves
from railhil.controller_node.program.tracer import Tracer
from railhil.controller_node.vector.controller import VectorLoop
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Anything that can be compared.
Shape = tuple[Any, ...]


class _Shaper(Tracer):
    """Records all operations in one program, those on constants too; formats are those of the laws' own trace."""

    def __init__(self, wide: bool) -> None:
        super().__init__(wide)
        #: In the order in which they were loaded.
        self.constants: list[Constant] = []
        self.begin("law")

    def const(self, constant: Constant) -> Value:
        self.constants.append(constant)
        return Value(-1, None, constant=constant)

    def neg(self, a: Value) -> Value:
        return self._emit("neg", [a], a.q)

    def _same(self, op: str, values: Sequence[Value]) -> int | None:
        return None

    def _expect(self, op: str, a: Value, q: int) -> None:
        return None

    def note(self, name: str, a: Value, q: int, unit: str = "") -> Value:
        return a


def shape_of(scenario: AnyScenario, law: LawSpec) -> Shape:
    """Operations of a law of an ``Interface``, with what they are done on, and its constants by name.

    A constant of its construction counts by its name, format and place, any other one by its value.

    :raises InputError: as :class:`railhil.controller_node.vector.controller.VectorLoop`.
    """
    tracer = _Shaper(make(law.arithmetic).wide)
    loop: VectorLoop[Value] = VectorLoop(scenario, law, tracer)
    made = list(tracer.constants)
    places = {id(constant): place for place, constant in enumerate(made)}
    given = loop.traced_inputs(tracer)
    state = loop.law.start(given)
    after, answer = loop.answered(state, given)
    told = loop.law.with_sent(after, loop.traced_commands(tracer))

    def operand(value: Value) -> Any:
        constant = value.constant
        return value.number if constant is None else places.get(id(constant), constant)

    assert tracer.program is not None
    return (
        tuple((constant.name, constant.q) for constant in made),
        tuple(
            (one.op, tuple(map(operand, one.arguments)), one.parameters, one.table, one.curve, id(one.problem))
            for one in tracer.program.operations
        ),
        tuple((name, operand(value)) for part in (state, after, answer, told) for name, value in leaves(part)),
    )
