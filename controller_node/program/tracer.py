"""An arithmetic that computes nothing: it records the operations and checks their formats.

The operands are :class:`~railhil.controller_node.program.model.Value`. Formats follow from the inputs and the
constants, so a law that adds a Q20 to a Q24, or names a quantity with a wrong format, is refused here. The programs
of a law are recorded by calling each of its functions once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from railhil.common.plug_ins import guard_plug_in
from railhil.controller_node.arithmetic.base import INT32_MIN, Arithmetic, Condition, Constant, Curve, Problem
from railhil.controller_node.laws.failure import describe_failure
from railhil.controller_node.program.model import (
    Kind,
    LawProgram,
    OperandError,
    Operation,
    Program,
    Quantity,
    Table,
    Value,
    map_leaves,
    name_leaves,
)
from railhil.scenarios.run_spec import LawSpec

if TYPE_CHECKING:
    from railhil.controller_node.law_loop import LawLoop


class FormatError(Exception):
    """Two operands of an operation have different formats, or a result has a format other than the law states."""


def _q(a: Value) -> int | None:
    """Format of an operand.

    :raises OperandError: it is a Python number, or anything else that is not the result of an operation.
    """
    if not isinstance(a, Value):
        raise OperandError(f"{a!r} as an operand: use ar.const of a Constant")
    return a.q


class Tracer(Arithmetic[Value]):
    """Records into the program of the last :meth:`begin`.

    :param wide: trace the law as for an arithmetic without formats; nothing is checked then.
    """

    name: ClassVar[str] = "tracer"
    solves: ClassVar[bool] = True

    def __init__(self, wide: bool = False) -> None:
        super().__init__()
        self.wide = wide  # type: ignore[misc]
        self.program: Program | None = None
        self._number = 0

    def begin(self, name: str) -> Program:
        """Start a new program."""
        self.program = Program(name)
        self._number = 0
        return self.program

    def input(self, name: str, q: int | None, kind: Kind = Kind.NUMBER) -> Value:
        """A new input of the program."""
        value = self._new(q, kind)
        self._into().inputs.append((name, value))
        return value

    def _into(self) -> Program:
        if self.program is None:
            raise FormatError("an operation outside of a law's functions: only constants may be negated there")
        return self.program

    def _new(self, q: int | None, kind: Kind = Kind.NUMBER) -> Value:
        self._number += 1
        return Value(self._number - 1, q, kind)

    def _emit(
        self,
        op: str,
        arguments: Sequence[Value],
        q: int | None,
        parameters: tuple[int, ...] = (),
        kind: Kind = Kind.NUMBER,
        table: Table | None = None,
        curve: Curve | None = None,
        problem: Problem | None = None,
    ) -> Value:
        into = self._into()
        result = self._new(q, kind)
        into.operations.append(Operation(op, result, tuple(arguments), parameters, table, curve, problem))
        return result

    def _refuse(self, what: str) -> None:
        if not self.wide:
            raise FormatError(f"{self.program.name if self.program else 'law'}: {what}")

    def _same(self, op: str, values: Sequence[Value]) -> int | None:
        """The one format of several operands."""
        formats = sorted({q for q in map(_q, values) if q is not None})
        if len(formats) > 1:
            self._refuse(f"{op} of {' and '.join(f'Q{q}' for q in formats)}: ar.convert changes a format")
        return formats[0] if formats else None

    def _expect(self, op: str, a: Value, q: int) -> None:
        found = _q(a)
        if found is not None and found != q:
            self._refuse(f"{op} of a Q{found} as if it were Q{q}")

    def _product(self, a: Value, b: Value, q: int) -> int | None:
        first, second = _q(a), _q(b)
        return None if first is None or second is None else first + second - q

    def const(self, constant: Constant) -> Value:
        return Value(-1, constant.q if constant.raw else None, constant=constant)

    def raw(self, a: Value, q: int) -> Value:
        self._expect("raw", a, q)
        return a

    def from_raw(self, raw: Any, q: int) -> Value:
        self._expect("from_raw", raw, q)
        value: Value = raw
        return value

    def note(self, name: str, a: Value, q: int, unit: str = "") -> Value:
        self._expect(f"note {name}", a, q)
        into = self._into()
        if any(quantity.name == name for quantity in into.quantities):
            raise FormatError(f"{into.name}: two quantities are called {name}")
        into.quantities.append(Quantity(name, q, unit, a))
        return a

    def note_all(self, name: str, values: Sequence[Value], q: int, unit: str = "") -> tuple[Value, ...]:
        return tuple(self.note(f"{name}[{i}]", value, q, unit) for i, value in enumerate(values))

    def convert(self, a: Value, q_from: int, q_to: int) -> Value:
        self._expect("convert", a, q_from)
        return self._emit("convert", [a], q_to, (q_from, q_to))

    def quantise(self, a: Value, q_from: int, q_to: int) -> Value:
        self._expect("quantise", a, q_from)
        return self._emit("quantise", [a], q_to, (q_from, q_to))

    def add(self, a: Value, b: Value) -> Value:
        return self._emit("add", [a, b], self._same("add", [a, b]))

    def sub(self, a: Value, b: Value) -> Value:
        return self._emit("sub", [a, b], self._same("sub", [a, b]))

    def neg(self, a: Value) -> Value:
        q = _q(a)
        if a.constant is not None:
            constant = a.constant
            if self.wide:
                return self.const(Constant(f"-{constant.name}", -constant.value, constant.q, constant.origin))
            # Taken from the integer, as in fixed point: a value between two integers would be rounded again.
            raw = constant.raw if constant.raw == INT32_MIN else -constant.raw
            return self.const(Constant(f"-{constant.name}", math.ldexp(raw, -constant.q), constant.q, constant.origin))
        return self._emit("neg", [a], q)

    def abs(self, a: Value) -> Value:
        return self._emit("abs", [a], _q(a))

    def mpy(self, a: Value, b: Value, q: int) -> Value:
        return self._emit("mpy", [a, b], self._product(a, b, q), (q,))

    def rmpy(self, a: Value, b: Value, q: int) -> Value:
        return self._emit("rmpy", [a, b], self._product(a, b, q), (q,))

    def rsmpy(self, a: Value, b: Value, q: int) -> Value:
        return self._emit("rsmpy", [a, b], self._product(a, b, q), (q,))

    def mpy_iqx(self, a: Value, q_a: int, b: Value, q_b: int, q: int) -> Value:
        self._expect("mpy_iqx", a, q_a)
        self._expect("mpy_iqx", b, q_b)
        return self._emit("mpy_iqx", [a, b], q, (q_a, q_b, q))

    def dot(self, coefficients: Sequence[Value], values: Sequence[Value], q: int) -> Value:
        if len(coefficients) != len(values):
            raise FormatError(f"dot of {len(coefficients)} coefficients and {len(values)} values")
        first, second = self._same("dot", coefficients), self._same("dot", values)
        result = None if first is None or second is None else first + second - q
        return self._emit("dot", [*coefficients, *values], result, (q,))

    def div(self, a: Value, b: Value, q: int) -> Value:
        self._same("div", [a, b])
        return self._emit("div", [a, b], q, (q,))

    def sqrt(self, a: Value, q: int) -> Value:
        self._expect("sqrt", a, q)
        return self._emit("sqrt", [a], q, (q,))

    def sat(self, a: Value, upper: Value, lower: Value) -> Value:
        return self._emit("sat", [a, upper, lower], self._same("sat", [a, upper, lower]))

    def clip(self, a: Value, upper: Value, lower: Value) -> Value:
        return self._emit("clip", [a, upper, lower], self._same("clip", [a, upper, lower]))

    def minimum(self, a: Value, b: Value) -> Value:
        return self._emit("minimum", [a, b], self._same("minimum", [a, b]))

    def maximum(self, a: Value, b: Value) -> Value:
        return self._emit("maximum", [a, b], self._same("maximum", [a, b]))

    def gt(self, a: Value, b: Value) -> Condition:
        self._same("gt", [a, b])
        return self._emit("gt", [a, b], None, kind=Kind.CONDITION)

    def where(self, condition: Condition, a: Value, b: Value) -> Value:
        return self._emit("where", [condition, a, b], self._same("where", [a, b]))

    def curve(self, curve: Curve, a: Value) -> Value:
        self._expect(f"curve {curve.name}", a, curve.q_in)
        return self._emit("curve", [a], curve.q_out, curve=curve)

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        self._same(f"table {name}", [self.const(constant) for constant in constants])
        return Table(name, tuple(constants))

    def at(self, table: Any, index: Any, offset: int = 0) -> Value:
        return self._emit("at", [index], table.constants[0].q, (offset,), table=table)

    def index(self, k: Any, last: int) -> Any:
        return self._emit("index", [k], None, (last,), Kind.INDEX)

    def locate(self, table: Any, a: Value) -> Any:
        self._expect(f"locate in {table.name}", a, table.constants[0].q)
        return self._emit("locate", [a], None, (), Kind.INDEX, table)

    def solve(self, problem: Problem, values: Sequence[Value]) -> tuple[Value, ...]:
        if len(values) != problem.inputs:
            raise FormatError(f"{problem.name} has {problem.inputs} inputs, not {len(values)}")
        self._refuse(f"{problem.name} is solved by a library, which has no formats")
        return tuple(self._emit("solve", values, None, (i,), problem=problem) for i in range(problem.outputs))


#: Functions of a law whose names differ from those of their programs.
_FUNCTIONS = {"sent": "with_sent", "first step": "step"}


def record(scenario: Any, law: LawSpec, *, wide: bool = False) -> LawProgram:
    """Programs of a law on a scenario of its system, see :func:`record_loop`."""
    computes = scenario.installed_system.part("controller").computes
    return record_loop(computes.loop, scenario, law, wide=wide)


def record_loop(
    loop: Callable[[Any, LawSpec, Any], LawLoop[Value]], scenario: Any, law: LawSpec, *, wide: bool = False
) -> LawProgram:
    """Programs of a law on a scenario.

    :param loop: binds a law to an arithmetic.
    :param law: its arithmetic is ignored.
    :param wide: record it as run by an arithmetic without formats (for operation counts); formats are then not checked.
    :raises InputError: the law cannot be bound; a law that raises, mixes formats, computes with Python's operators or
        changes the formats of its state: with the location in the law's source.
    """
    tracer = Tracer(wide)
    bound = loop(scenario, law, tracer)
    try:
        with guard_plug_in():
            return _recorded(tracer, bound)
    except Exception as error:
        # A law is code that somebody plugs in, and may raise anything.
        program = tracer.program
        quantity = program.quantities[-1].name if program is not None and program.quantities else None
        function = program.name if program is not None else "inputs"
        raise describe_failure(
            bound.name, type(bound.law), error, _FUNCTIONS.get(function, function), quantity
        ) from error


def _recorded(tracer: Tracer, loop: LawLoop[Value]) -> LawProgram:
    wide = tracer.wide

    def fresh(name: str, old: Value) -> Value:
        return tracer.input(name, old.q, old.kind)

    inputs = tracer.begin("inputs")
    given = loop.trace_inputs(tracer)
    inputs.outputs = list(name_leaves(given, "in"))

    start = tracer.begin("start")
    first_state = loop.law.start(map_leaves(given, fresh, "in"))
    start.outputs = list(name_leaves(first_state, "state"))
    formats = _formats(tracer, loop, first_state, given)

    def state_input(name: str, old: Value) -> Value:
        return tracer.input(name, formats[name])

    step = tracer.begin("step")
    state = map_leaves(first_state, state_input, "state")
    new_state, outputs = loop.compute_answer(state, map_leaves(given, fresh, "in"))
    step.outputs = [*name_leaves(new_state, "state"), *name_leaves(outputs, "out")]
    sent = tracer.begin("sent")
    told = loop.law.with_sent(map_leaves(first_state, state_input, "state"), loop.trace_commands(tracer))
    sent.outputs = list(name_leaves(told, "state"))
    if not wide:
        _check(step, formats)
        _check(sent, formats)
    return LawProgram(loop.name, inputs, start, step, sent)


def _formats(tracer: Tracer, loop: LawLoop[Value], first_state: Any, given: Any) -> dict[str, int | None]:
    """Format of every leaf of the state: from its start or, if it starts as the constant 0, from the result of a
    step."""
    formats = {name: value.q for name, value in name_leaves(first_state, "state")}

    def known(name: str, old: Value) -> Value:
        return tracer.input(name, formats.get(name, old.q), old.kind)

    while True:
        tracer.begin("first step")
        after, _ = loop.compute_answer(map_leaves(first_state, known, "state"), map_leaves(given, known, "in"))
        found = {name: value.q for name, value in name_leaves(after, "state") if formats[name] is None}
        if all(q is None for q in found.values()):
            return formats
        formats |= found


def _check(program: Program, formats: dict[str, int | None]) -> None:
    for name, value in program.outputs:
        expected = formats.get(name)
        if expected is not None and value.q is not None and value.q != expected:
            raise FormatError(f"{program.name}: state {name} is Q{expected} before and Q{value.q} after")
