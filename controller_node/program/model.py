"""A law as a list of operations, written by the tracer and read by cycle estimate, telemetry and C export."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, NoReturn

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, Curve, Problem


def name_leaves(value: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Named leaves of nested (named) tuples and lists: ``state.model[0]``, ``state.notch``, ..."""
    if hasattr(value, "_fields"):
        for name in value._fields:
            yield from name_leaves(getattr(value, name), f"{prefix}.{name}" if prefix else name)
    elif isinstance(value, tuple | list):
        for i, item in enumerate(value):
            yield from name_leaves(item, f"{prefix}[{i}]")
    else:
        yield prefix, value


def map_leaves(template: Any, make: Callable[[str, Any], Any], prefix: str = "") -> Any:
    """A structure of the same shape (lists become tuples) with new leaves, made from name and old leaf."""
    if hasattr(template, "_fields"):
        return type(template)(
            *(
                map_leaves(getattr(template, name), make, f"{prefix}.{name}" if prefix else name)
                for name in template._fields
            )
        )
    if isinstance(template, tuple | list):
        return tuple(map_leaves(item, make, f"{prefix}[{i}]") for i, item in enumerate(template))
    return make(prefix, template)


#: Inputs of a law with ``track`` in addition to k, speed and position: the fields of a ``BaliseReading``.
BALISE_INPUTS = ("balise", "balise_01mm", "balise_odometer_01mm")


def identifier(text: str) -> str:
    """A C identifier from a quantity's or constant's name: ``free[3][0]`` -> ``free_3_0``, ``-x`` -> ``minus_x``."""
    text = re.sub(r"^-+", lambda signs: "minus_" * len(signs.group()), text)
    text = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_") or "value"
    return f"n_{text}" if text[0].isdigit() else text


class BranchError(Exception):
    """A law uses one of its values in a Python branch: the recorded operations would contain only one branch."""


class OperandError(Exception):
    """A law uses its values in another way than by operations of the arithmetic."""


class Kind(Enum):
    """The type of a value on the target."""

    NUMBER = "number"
    CONDITION = "condition"
    INDEX = "index"


#: Python's own operators, and the operations that a law must use instead: in fixed point they would compute with raw
#: integers, where ``*`` and ``/`` change the format and nothing wraps.
_INSTEAD = {
    "+": ("ar.add", ("add", "radd", "iadd", "pos")),
    "-": ("ar.sub", ("sub", "rsub", "isub")),
    "-x": ("ar.neg", ("neg",)),
    "*": ("ar.mpy or ar.rmpy", ("mul", "rmul", "imul", "matmul", "rmatmul")),
    "/": ("ar.div", ("truediv", "rtruediv", "floordiv", "rfloordiv", "mod", "rmod", "divmod", "rdivmod")),
    "**": ("ar.mpy, or ar.sqrt", ("pow", "rpow")),
    "abs()": ("ar.abs", ("abs",)),
    "a comparison": ("ar.gt with ar.where, ar.minimum or ar.maximum", ("lt", "le", "gt", "ge")),
    "a shift": ("ar.convert", ("lshift", "rlshift", "rshift", "rrshift")),
    "a bit operation": ("conditions of ar.gt with ar.where", ("and", "rand", "or", "ror", "xor", "rxor", "invert")),
    "rounding": ("ar.quantise", ("round", "floor", "ceil", "trunc")),
    "a Python number": ("ar.raw outside of the law", ("int", "float", "complex", "index")),
}


class _Operand:
    """Makes :class:`Value` refuse Python's own operators.

    :raises OperandError: in each of them, with the operation of the arithmetic to use instead.
    """

    __slots__ = ()


def _refusing(sign: str, instead: str) -> Callable[..., NoReturn]:
    def refuse(self: _Operand, *_: object) -> NoReturn:
        raise OperandError(f"{sign} on a value of the law: use {instead}")

    return refuse


for _sign, (_instead, _names) in _INSTEAD.items():
    for _name in _names:
        setattr(_Operand, f"__{_name}__", _refusing(_sign, _instead))


@dataclass(frozen=True, slots=True)
class Value(_Operand):
    """An operand: the result of an operation or an input (``number`` >= 0), or a constant.

    ``q`` is the format, None if the value is not a fixed-point number or fits every format (the constant 0).
    """

    number: int
    q: int | None
    kind: Kind = Kind.NUMBER
    constant: Constant | None = None

    def __bool__(self) -> bool:
        raise BranchError("a branch in Python on a value of the law: Arithmetic.where chooses between values")


@dataclass(frozen=True, slots=True)
class Table:
    """Constants of one format, looked up by index."""

    name: str
    constants: tuple[Constant, ...]


@dataclass(frozen=True, slots=True)
class Operation:
    """``result = op(arguments)``, named after the method of
    :class:`~railhil.controller_node.arithmetic.base.Arithmetic`.

    ``parameters`` are the arguments that are not operands: formats, shift counts, the offset into a table,
    the last index. ``dot`` has its coefficients first, then as many values. ``solve`` is one operation for each output
    of its problem; its parameter is the number of the output.
    """

    op: str
    result: Value
    arguments: tuple[Value, ...]
    parameters: tuple[int, ...] = ()
    table: Table | None = None
    curve: Curve | None = None
    problem: Problem | None = None


@dataclass(frozen=True, slots=True)
class Quantity:
    """A named quantity of a law: its format, its unit and the value that carries it."""

    name: str
    q: int
    unit: str
    value: Value


@dataclass(slots=True)
class Program:
    """One function of a law, without branches: inputs and outputs by name, operations in order."""

    name: str
    inputs: list[tuple[str, Value]] = field(default_factory=list)
    operations: list[Operation] = field(default_factory=list)
    outputs: list[tuple[str, Value]] = field(default_factory=list)
    quantities: list[Quantity] = field(default_factory=list)

    def counts(self) -> Counter[str]:
        """Elementary operations of one call: a ``dot`` of n terms is n ``rmpy`` and n - 1 ``add``."""
        counts: Counter[str] = Counter()
        for operation in self.operations:
            if operation.op == "dot":
                terms = len(operation.arguments) // 2
                counts["rmpy"] += terms
                counts["add"] += terms - 1
            elif operation.op == "locate":
                assert operation.table is not None
                counts["locate_step"] += len(operation.table.constants).bit_length()
            elif operation.op == "solve":
                # All outputs come from one solution.
                counts["solve"] += operation.parameters == (0,)
            else:
                counts[operation.op] += 1
        return counts


@dataclass(frozen=True, slots=True)
class LawProgram:
    """All functions of a control loop: wire values to law inputs, first state, one control period, notch really sent.

    ``inputs``: control period k, speed in 0.1 mm/s, position in 0.1 mm, for a law with ``track`` also the last balise
    (:data:`BALISE_INPUTS`) -> the law's inputs. ``start``: those -> state. ``step``: state and those -> state and
    outputs. ``sent``: state and notch -> state.
    """

    law: str
    inputs: Program
    start: Program
    step: Program
    sent: Program

    @property
    def track(self) -> bool:
        """True when the law also gets the last balise."""
        return any(name == BALISE_INPUTS[0] for name, _ in self.inputs.inputs)

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Named quantities in the order in which one control period notes them."""
        return (*self.inputs.quantities, *self.step.quantities)

    def step_counts(self) -> Counter[str]:
        """Operations of one control period, set-points included: the same in every period."""
        return self.inputs.counts() + self.step.counts()


class Evaluator:
    """Runs a program on an arithmetic, to prove that the recording equals the law.

    Its constants and tables are made once.

    :param arithmetic: any, for one train or many; formats must equal the recorded ones.
    """

    def __init__(self, program: Program, arithmetic: Arithmetic[Any]) -> None:
        self._arithmetic = arithmetic
        self._program = program
        self._steps = [(operation.result.number, self._step(operation)) for operation in program.operations]

    def run(self, inputs: Mapping[str, Any]) -> dict[str, Any]:
        """Outputs by name.

        :param inputs: the operand of every input, by name.
        :raises KeyError: an input is missing.
        """
        values: dict[int, Any] = {value.number: inputs[name] for name, value in self._program.inputs}
        for number, step in self._steps:
            values[number] = step(values)
        return {name: self._reader(value)(values) for name, value in self._program.outputs}

    def _reader(self, value: Value) -> Callable[[dict[int, Any]], Any]:
        if value.constant is not None:
            constant = self._arithmetic.const(value.constant)
            return lambda values: constant
        return lambda values: values[value.number]

    def _step(self, operation: Operation) -> Callable[[dict[int, Any]], Any]:
        ar, op, parameters = self._arithmetic, operation.op, operation.parameters
        readers = [self._reader(value) for value in operation.arguments]
        if operation.table is not None:
            table = ar.table(operation.table.name, operation.table.constants)
            if op == "at":
                return lambda values: ar.at(table, readers[0](values), *parameters)
            return lambda values: ar.locate(table, readers[0](values))
        curve = operation.curve
        if curve is not None:
            return lambda values: ar.curve(curve, readers[0](values))
        problem = operation.problem
        if problem is not None:
            (place,) = parameters
            return lambda values: ar.solve(problem, [read(values) for read in readers])[place]
        if op == "dot":
            half = len(readers) // 2

            def dot(values: dict[int, Any]) -> Any:
                operands = [read(values) for read in readers]
                return ar.dot(operands[:half], operands[half:], *parameters)

            return dot
        if op == "mpy_iqx":
            q_a, q_b, q = parameters
            return lambda values: ar.mpy_iqx(readers[0](values), q_a, readers[1](values), q_b, q)
        method = getattr(ar, op)
        return lambda values: method(*(read(values) for read in readers), *parameters)
