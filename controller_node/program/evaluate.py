"""Runs a recorded program on an arithmetic, to prove that the recording equals what the law computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.program.model import Operation, Program, Value


class Evaluator:
    """A program on one arithmetic; its constants and tables are made once.

    :param arithmetic: any, for one train or many; formats must be those the program was recorded with.
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
