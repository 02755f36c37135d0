"""One law on arrays for trains whose laws differ in their constants, such as laws with a memory each.

The law is made once for each train, which gives the constants of all trains in one order; made again on arrays, it gets
an array wherever they differ. All other that it does must be the same (:func:`shape_of`).
Two laws of one shape can be computed as one law whose constants are arrays. A law has no branches on data, so one call
shows all of its operations. The operations may still depend on the arguments of its constructor, such as its memory.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

import numpy as np

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Constant
from railhil.controller_node.program.model import Value, name_leaves
from railhil.controller_node.program.tracer import Tracer
from railhil.controller_node.vector.controller import VectorLoop
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Anything that can be compared.
Shape = tuple[Any, ...]


class _Shaper(Tracer):
    """Records all operations in one program, also those on constants, with the formats of the laws' own trace."""

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
    """Operations of a law of an ``Interface`` with their operands, and its constants by name.

    A constant of its construction counts by its name, format and place, any other one by its value.

    :raises InputError: as :class:`railhil.controller_node.vector.controller.VectorLoop`.
    """
    tracer = _Shaper(make(law.arithmetic).wide)
    loop: VectorLoop[Value] = VectorLoop(scenario, law, tracer)
    made = list(tracer.constants)
    places = {id(constant): place for place, constant in enumerate(made)}
    given = loop.trace_inputs(tracer)
    state = loop.law.start(given)
    after, answer = loop.compute_answer(state, given)
    told = loop.law.with_sent(after, loop.trace_commands(tracer))

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
        tuple((name, operand(value)) for part in (state, after, answer, told) for name, value in name_leaves(part)),
    )


def _recording(arithmetic: Arithmetic[Any]) -> tuple[Arithmetic[Any], list[Constant]]:
    """An arithmetic of the same kind that lists the constants loaded through it."""
    seen: list[Constant] = []

    def const(self: Any, constant: Constant) -> Any:
        seen.append(constant)
        return super(kind, self).const(constant)

    kind: Any = type(type(arithmetic).__name__, (type(arithmetic),), {"const": const})
    return kind(), seen


def _stacking(arithmetic: Arithmetic[Any], columns: Iterator[tuple[Constant, ...]]) -> Arithmetic[Any]:
    """An arithmetic on arrays whose constants are taken from all trains, as long as there are ``columns``."""

    def const(self: Any, constant: Constant) -> Any:
        load = super(kind, self).const
        every = next(columns, (constant,))
        if all(one.raw == constant.raw and one.value == constant.value for one in every):
            return load(constant)
        return np.array([load(one) for one in every])

    kind: Any = type(type(arithmetic).__name__, (type(arithmetic),), {"const": const})
    return cast(Arithmetic[Any], kind())


class StackedLaw:
    """A law on arrays, and the laws of its trains.

    ``loop``: on arrays; None: the laws differ in more than the values of their constants (``differs`` names the
    difference). ``own``: of each train, not stepped.

    :param laws: one for each train, alike but for the memory.
    :raises InputError: as :class:`railhil.controller_node.vector.controller.VectorLoop`.
    """

    def __init__(self, scenario: AnyScenario, laws: Sequence[LawSpec]) -> None:
        def made(law: LawSpec, arithmetic: Arithmetic[Any]) -> VectorLoop[Any]:
            return VectorLoop(scenario, law, arithmetic)

        self.own: list[VectorLoop[Any]] = []
        rows: list[list[Constant]] = []
        for law in laws:
            arithmetic, seen = _recording(make(law.arithmetic))
            self.own.append(made(law, arithmetic))
            rows.append(seen)
        self.differs = _difference(scenario, laws)
        self.loop: VectorLoop[Any] | None = None
        if not self.differs:
            columns = iter(list(zip(*rows, strict=True)))
            self.loop = made(laws[0], _stacking(make(laws[0].arithmetic, batch=True), columns))

    def end(self, train: int, state: Any) -> None:
        """The law of a train has come to its last step.

        :param state: of the law on arrays.
        """
        self.own[train].state = _own(state, train)


def _difference(scenario: AnyScenario, laws: Sequence[LawSpec]) -> str:
    """The difference between the laws beside the values of their constants; empty: there is none."""
    first: Shape = ()
    for law in laws:
        if law is laws[0]:
            first = shape_of(scenario, law)
        elif law != laws[0] and (shape := shape_of(scenario, law)) != first:
            return "constants" if shape[0] != first[0] else "operations"
    return ""


def _own(state: Any, train: int) -> Any:
    """The state of one train: an element of each array in (named) tuples of any depth."""
    if isinstance(state, tuple):
        parts = [_own(part, train) for part in state]
        return type(state)(*parts) if hasattr(state, "_fields") else tuple(parts)
    if isinstance(state, np.ndarray):
        return state[train].item() if state.ndim else state.item()
    return state.item() if isinstance(state, np.generic) else state
