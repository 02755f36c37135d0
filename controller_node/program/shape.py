"""What two recorded programs share that differ only in their numbers: the operations, and which operand goes where.

A law made for another line, train or parameter file has other constants, tables and curves, but as a rule the same
operations. Whatever is written for a shape serves all of them (:mod:`railhil.controller_node.written`).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

from railhil.controller_node.arithmetic.base import Constant, Curve
from railhil.controller_node.program.model import Operation, Program, Table, Value

#: Operations whose parameters matter in every arithmetic.
_MATTERS = ("at", "quantise")


@dataclass(slots=True)
class Shape:
    """The numbers of a program in the order of their first use, and the digest of everything else.

    ``formats``: False where the fraction bits of an operand change nothing. ``lasts``: the largest index of each
    ``index`` operation, which depends on the length of a table. Constants, tables and curves are told apart by
    identity: two of one value may differ on another line.
    """

    formats: bool
    digest: str = ""
    constants: list[Constant] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list)
    lasts: list[int] = field(default_factory=list)
    _places: dict[int, int] = field(default_factory=dict)

    def constant(self, constant: Constant) -> int:
        """Number of a constant; its name is not in the digest."""
        key = id(constant)
        if key not in self._places:
            self._places[key] = len(self.constants)
            self.constants.append(constant)
        return self._places[key]

    def table(self, table: Table) -> int:
        """Number of a table."""
        for number, known in enumerate(self.tables):
            if known is table:
                return number
        self.tables.append(table)
        return len(self.tables) - 1

    def curve(self, curve: Curve) -> int:
        """Number of a curve."""
        for number, known in enumerate(self.curves):
            if known is curve:
                return number
        self.curves.append(curve)
        return len(self.curves) - 1

    def operand(self, value: Value) -> str:
        """``c3`` for a constant, ``v12`` for an input or a result."""
        return f"v{value.number}" if value.constant is None else f"c{self.constant(value.constant)}"

    def operation(self, operation: Operation) -> str:
        """An operation as one word of the digest; it is listed here."""
        words = [operation.op, *(self.operand(value) for value in operation.arguments)]
        if operation.op == "index":
            self.lasts.append(operation.parameters[0])
        elif self.formats or operation.op in _MATTERS:
            words += map(str, operation.parameters)
        if operation.table is not None:
            words.append(f"t{self.table(operation.table)}")
        if operation.curve is not None:
            words.append(f"f{self.curve(operation.curve)}")
            if self.formats:
                words.append(f"Q{operation.curve.q_in}")
        if operation.problem is not None:
            words.append(operation.problem.name)
        return f"v{operation.result.number} = {' '.join(words)}"


def shape_of(program: Program, family: str, formats: bool) -> Shape:
    """Shape of a program.

    :param family: the kind of arithmetic for which it was recorded: the same operations mean something else in another.
    :param formats: whether that arithmetic has fixed-point formats.
    """
    shape = Shape(formats)
    lines = [family, *(f"{name} v{value.number}" for name, value in program.inputs)]
    lines += [shape.operation(operation) for operation in program.operations]
    lines += [f"{name} {shape.operand(value)}" for name, value in program.outputs]
    lines += [f"{quantity.name} {shape.operand(quantity.value)}" for quantity in program.quantities]
    shape.digest = hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]
    return shape
