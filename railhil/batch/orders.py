"""A recorded law as a list of orders on rows of numbers, one number for each train of a block.

:mod:`railhil.batch.ints` and :mod:`railhil.batch.floats` carry the orders out as machine code, compiled once for all
laws and parameters. A row that is no longer needed is used again, so that the rows of a block stay in the cache.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.batch.lanes import LANES
from railhil.controller_node.arithmetic.base import Arithmetic, Curve
from railhil.controller_node.program.model import LawProgram, Operation, Program, Value

#: Numbers of the orders.
(
    COPY,
    SHIFT_LEFT,
    SHIFT_RIGHT,
    ADD,
    SUB,
    NEG,
    ABS,
    PRODUCT,
    PRODUCT_SATURATED,
    DOT,
    DIV,
    SAT,
    CLIP,
    MINIMUM,
    MAXIMUM,
    GT,
    WHERE,
    CURVE,
    AT,
    INDEX,
    LOCATE,
    QUANTISE,
) = range(22)
#: Columns of an order: its number, the row of the result, up to three operands, up to three numbers.
_COLUMNS = 8

_SIMPLE = {
    "add": ADD,
    "sub": SUB,
    "neg": NEG,
    "abs": ABS,
    "sat": SAT,
    "clip": CLIP,
    "minimum": MINIMUM,
    "maximum": MAXIMUM,
    "gt": GT,
    "where": WHERE,
}
_PRODUCTS = {"mpy": (PRODUCT, False), "rmpy": (PRODUCT, True), "rsmpy": (PRODUCT_SATURATED, True)}


class NotInOrdersError(Exception):
    """An operation that only the law on arrays can do."""


@dataclass(frozen=True, slots=True)
class Pause:
    """A curve in double precision, which only the interpreter computes: before this order, from one row to another."""

    before: int
    curve: Curve
    result: int
    argument: int


@dataclass(slots=True)
class Orders:
    """Orders of one program: (n, 8), in rows times :data:`LANES`. ``pauses`` in their order."""

    rows: list[list[int]] = field(default_factory=list)
    pauses: list[Pause] = field(default_factory=list)

    @property
    def array(self) -> NDArray[np.int64]:
        """The orders as an array."""
        return np.array(self.rows, dtype=np.int64).reshape(-1, _COLUMNS)


class Assembly:
    """The orders of a law: its inputs, its start and its step, on common rows.

    ``terms``: (coefficient is a row or a constant, its row or its place in ``loose``, row of the factor) of all sums of
    products; ``pool``: entries of all tables; ``fixed``: numbers of the rows that are constants, by row; ``track``:
    whether the last balise is an input.

    :raises NotInOrdersError: an operation of the law has no order.
    """

    def __init__(self, program: LawProgram, arithmetic: Arithmetic[Any]) -> None:
        self._ar, self._fixed_point = arithmetic, not arithmetic.wide
        self.track = program.track
        self.terms: list[tuple[int, int, int]] = []
        self.loose: list[Any] = []
        self.pool: list[Any] = []
        self.fixed: dict[int, Any] = {}
        self.count = 0
        self._free: list[int] = []
        self._places: dict[int, int] = {}
        #: Keeps what is known by its identity.
        self._kept: list[Any] = []
        self._constants: dict[Any, int] = {}
        self._named: dict[str, int] = {}
        self.given = [self._row_of(name) for name, _ in program.inputs.inputs]
        for name, _ in program.start.outputs:
            self._row_of(name)
        #: Largest value of each index, by the row that holds it.
        self._largest: dict[int, int] = {}
        # The inputs of the law stay in their rows for the start and the step.
        self.inputs = self._orders(program.inputs)
        self.start = self._orders(program.start)
        self.step = self._orders(program.step)
        self.notch = self._named["out.notch"]

    def _row_of(self, name: str) -> int:
        """Row of an input or output, which is not used for anything else."""
        if name not in self._named:
            self._named[name] = self._new()
        return self._named[name]

    def _new(self) -> int:
        self.count += 1
        return self.count - 1

    def _constant(self, number: Any) -> int:
        """Row that holds a constant."""
        key = (type(number), repr(number))
        if key not in self._constants:
            self._constants[key] = row = self._new()
            self.fixed[row] = number
        return self._constants[key]

    def _table(self, what: Any, entries: Sequence[Any]) -> int:
        """Place of a table in the pool."""
        if id(what) not in self._places:
            self._places[id(what)] = len(self.pool)
            self._kept.append(what)
            self.pool += entries
        return self._places[id(what)]

    def _orders(self, program: Program) -> Orders:
        rows = {value.number: self._row_of(name) for name, value in program.inputs}
        last = {value.number: len(program.operations) for _, value in program.outputs}
        for place, operation in reversed(list(enumerate(program.operations))):
            for value in operation.arguments:
                last.setdefault(value.number, place)
        kept = set(rows.values())
        orders = Orders()
        for place, operation in enumerate(program.operations):
            result = self._free.pop() if self._free else self._new()
            rows[operation.result.number] = result
            operands = [self._operand(value, rows) for value in operation.arguments]
            self._order(orders, operation, result, operands)
            # Only now, so that a result never lies in the row of an operand.
            for number in {value.number for value in operation.arguments if value.constant is None}:
                if last[number] == place and rows[number] not in kept:
                    self._free.append(rows[number])
            if operation.result.number not in last:
                self._free.append(result)
        sources = {self._row_of(name): self._operand(value, rows) for name, value in program.outputs}
        between = self._move(orders, sources)
        free = {*between, *(rows[number] for number in rows if last.get(number) == len(program.operations))}
        self._free += sorted(free - kept - set(self._named.values()) - set(self._free) - set(self.fixed))
        return orders

    def _move(self, orders: Orders, sources: dict[int, int]) -> list[int]:
        """Copy rows to others, all at once as it were: a state may move from one of its variables to the next.

        :param sources: row by the row it goes to.
        :return: further rows that this took.
        """
        between = []
        moves = {to: row for to, row in sources.items() if to != row}
        while moves:
            ready = next((to for to in moves if to not in moves.values()), None)
            if ready is None:
                # Only rings are left: one number of a ring waits elsewhere.
                kept = next(iter(moves))
                between.append(self._free.pop() if self._free else self._new())
                self._say(orders, COPY, between[-1], [kept])
                moves = {to: between[-1] if row == kept else row for to, row in moves.items()}
            else:
                self._say(orders, COPY, ready, [moves.pop(ready)])
        return between

    def _operand(self, value: Value, rows: dict[int, int]) -> int:
        return rows[value.number] if value.constant is None else self._constant(self._ar.const(value.constant))

    def _say(self, orders: Orders, kind: int, result: int, operands: Sequence[int], *numbers: int) -> None:
        places = [result * LANES, *(row * LANES for row in operands)]
        row = [kind, *places, *[0] * (4 - len(places)), *numbers]
        orders.rows.append(row + [0] * (_COLUMNS - len(row)))

    def _order(self, orders: Orders, operation: Operation, to: int, operands: list[int]) -> None:
        op, numbers = operation.op, operation.parameters
        if op in _SIMPLE:
            self._say(orders, _SIMPLE[op], to, operands)
        elif op in _PRODUCTS:
            kind, rounded = _PRODUCTS[op]
            self._product(orders, kind, to, operands, numbers[0], rounded)
        elif op == "mpy_iqx" and sum(numbers[:2]) >= numbers[2]:
            self._product(orders, PRODUCT, to, operands, numbers[0] + numbers[1] - numbers[2], False)
        elif op == "dot":
            self._dot(orders, operation, to, operands)
        elif op == "div":
            self._say(orders, DIV, to, operands, numbers[0])
        elif op == "convert" and (not self._fixed_point or numbers[0] == numbers[1]):
            self._say(orders, COPY, to, operands)
        elif op == "convert":
            q = numbers[1] - numbers[0]
            self._say(orders, SHIFT_LEFT if q > 0 else SHIFT_RIGHT, to, operands, abs(q))
        elif op == "quantise":
            self._say(orders, QUANTISE, to, operands, numbers[0] - numbers[1] if self._fixed_point else numbers[1])
        elif op == "index":
            self._largest[to] = numbers[0]
            self._say(orders, INDEX, to, operands, numbers[0])
        elif operation.table is not None:
            entries = self._ar.load(operation.table.constants)
            place, count = self._table(operation.table, entries), len(entries)
            if op == "locate":
                self._largest[to] = count - 2
                self._say(orders, LOCATE, to, operands, place, count)
                return
            if not 0 <= self._largest[operands[0]] + numbers[0] < count or numbers[0] < 0:
                raise NotInOrdersError("a place beyond the end of a table")
            self._say(orders, AT, to, operands, place, numbers[0])
        elif operation.curve is not None and self._fixed_point:
            entries = self._ar.load(operation.curve.samples)
            self._say(orders, CURVE, to, operands, self._table(operation.curve, entries), operation.curve.q_in - 8)
        elif operation.curve is not None:
            orders.pauses.append(Pause(len(orders.rows), operation.curve, to * LANES, operands[0] * LANES))
        else:
            raise NotInOrdersError(op)

    def _product(self, orders: Orders, kind: int, to: int, operands: list[int], q: int, rounded: bool) -> None:
        self._say(orders, kind, to, operands, q, 1 << (q - 1) if rounded else 0)

    def _dot(self, orders: Orders, operation: Operation, to: int, operands: list[int]) -> None:
        half, first = len(operands) // 2, len(self.terms)
        for value, row, factor in zip(operation.arguments[:half], operands[:half], operands[half:], strict=True):
            if value.constant is None:
                self.terms.append((1, row * LANES, factor * LANES))
            else:
                self.terms.append((0, len(self.loose), factor * LANES))
                self.loose.append(self._ar.const(value.constant))
        q = operation.parameters[0]
        self._say(orders, DOT, to, [], q, 1 << (q - 1), first)
        orders.rows[-1][2] = half
