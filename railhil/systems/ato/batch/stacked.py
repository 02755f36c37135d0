"""Control loops of one law with different parameters, stepped together: one batch for many sets of parameters.

A law has no branches on data (:mod:`railhil.controller_node.program`), so two parameter sets give the same operations
with different constants, unless a parameter determines their number (a horizon). The recorded operations of loops with
the same structure are merged; a constant in which they differ becomes one number for each train. float64 only; each
train computes the same as alone, bit for bit.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from railhil.batch.case import Case
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import Curve
from railhil.controller_node.arithmetic.float64 import Float64Batch, Floats
from railhil.controller_node.ato.control_loop import NO_BALISE
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.program.model import BALISE_INPUTS, Evaluator, LawProgram, Operation, Program, Table, Value
from railhil.controller_node.program.tracer import record
from railhil.judge.score import Score
from railhil.scenarios.parameters import ParameterSet
from railhil.systems.ato.batch import CHUNK
from railhil.systems.ato.batch.engine import Engine

_OUTPUT = "out."


@dataclass(frozen=True, slots=True, eq=False)
class _Each:
    """Replaces a constant or a curve by one for each train, shape (N,) or N functions."""

    value: Any


class _EachFloat64(Float64Batch):
    """Double precision for N trains whose constants, tables and curves may differ."""

    def table(self, name: str, constants: Sequence[Any]) -> Any:
        values = [constant.value for constant in constants]
        if any(isinstance(value, np.ndarray) for value in values):
            values = list(np.broadcast_arrays(*values))
        return np.array(values)

    def at(self, table: Any, index: Any, offset: int = 0) -> Any:
        if table.ndim == 2 and np.ndim(index) == 1:
            return table[index + offset, np.arange(table.shape[1])]
        return table[index + offset]

    def locate(self, table: Any, a: Floats) -> Any:
        if table.ndim == 1:
            return super().locate(table, a)
        return np.clip((table <= a).sum(axis=0) - 1, 0, len(table) - 2)

    def curve(self, curve: Any, a: Floats) -> Floats:
        if isinstance(curve, Curve):
            return super().curve(curve, a)
        arguments = np.broadcast_to(np.asarray(a, dtype=np.float64), (len(curve.value),)).tolist()
        return np.array([function(x) for function, x in zip(curve.value, arguments, strict=True)])


def _operand(value: Value) -> tuple[int, bool]:
    return value.number, value.constant is None


def _program_shape(program: Program) -> Any:
    return (
        [(name, value.number) for name, value in program.inputs],
        [
            (
                operation.op,
                operation.parameters,
                [_operand(value) for value in operation.arguments],
                None if operation.table is None else len(operation.table.constants),
                operation.curve is None,
            )
            for operation in program.operations
        ],
        [(name, *_operand(value)) for name, value in program.outputs],
    )


def shape(programs: LawProgram) -> str:
    """The structure that two loops must share to be stepped together."""
    return repr([_program_shape(part) for part in (programs.inputs, programs.start, programs.step)])


class _Stack:
    """Programs of one shape merged into a program with constants for each train, ``repeat`` trains per program."""

    def __init__(self, repeat: int) -> None:
        self._repeat = repeat
        self._tables: dict[int, Table] = {}

    def program(self, parts: Sequence[Program]) -> Program:
        first = parts[0]
        operations = [self._operation(alike) for alike in zip(*(part.operations for part in parts), strict=True)]
        outputs = [
            (first.outputs[i][0], self._value([part.outputs[i][1] for part in parts]))
            for i in range(len(first.outputs))
        ]
        return Program(first.name, first.inputs, operations, outputs)

    def _operation(self, alike: Sequence[Operation]) -> Operation:
        first = alike[0]
        arguments = tuple(self._value(values) for values in zip(*(one.arguments for one in alike), strict=True))
        table = None if first.table is None else self._table([one.table for one in alike])
        curve: Any = first.curve
        if curve is not None:
            functions = [one.curve.function for one in alike if one.curve is not None]
            curve = _Each([function for function in functions for _ in range(self._repeat)])
        return replace(first, arguments=arguments, table=table, curve=curve)

    def _value(self, values: Sequence[Value]) -> Value:
        if values[0].constant is None:
            return values[0]
        return replace(values[0], constant=self._constant([value.constant for value in values]))

    def _constant(self, constants: Sequence[Any]) -> Any:
        numbers = [constant.value for constant in constants]
        if numbers.count(numbers[0]) == len(numbers):
            return constants[0]
        return _Each(np.repeat(np.array(numbers, dtype=np.float64), self._repeat))

    def _table(self, tables: Sequence[Any]) -> Table:
        # Several look-ups share one table, and comparing all its rows takes time.
        key = id(tables[0])
        if key not in self._tables:
            rows = zip(*(table.constants for table in tables), strict=True)
            self._tables[key] = Table(tables[0].name, tuple(self._constant(row) for row in rows))
        return self._tables[key]


class _Outputs(NamedTuple):
    """The outputs that the batch engine uses."""

    notch: NDArray[np.float64]


class StackedLoop:
    """A :class:`~railhil.controller_node.ato.control_loop.ControlLoop` of ``repeat`` trains for each of
    several programs.

    :param programs: of one :func:`shape`, recorded with ``wide``.
    """

    def __init__(self, programs: Sequence[LawProgram], repeat: int) -> None:
        self.arithmetic = _EachFloat64()
        self.state: dict[str, Any] | None = None
        self._track = programs[0].track
        stack = _Stack(repeat)
        self._inputs, self._start, self._step = (
            Evaluator(stack.program([getattr(one, part) for one in programs]), self.arithmetic)
            for part in ("inputs", "start", "step")
        )

    def step(
        self, k: Any, speed_01mmps: Any, position_01mm: Any, balise: BaliseReading[Any] = NO_BALISE
    ) -> tuple[dict[str, Any], _Outputs]:
        """One control period: from the inputs of the laws to their notches."""
        number = self.arithmetic
        wire = {
            "k": k,
            "speed_01mmps": number.from_raw(speed_01mmps, 0),
            "position_01mm": number.from_raw(position_01mm, 0),
        }
        if self._track:
            wire |= {name: number.from_raw(value, 0) for name, value in zip(BALISE_INPUTS, balise, strict=True)}
        found = self._inputs.run(wire)
        if self.state is None:
            self.state = self._start.run(found)
        after = self._step.run(self.state | found)
        self.state = {name: value for name, value in after.items() if not name.startswith(_OUTPUT)}
        return found, _Outputs(after[f"{_OUTPUT}notch"])


def run_parameter_sets(
    case: Case, sets: Sequence[ParameterSet | None], seeds: Sequence[int]
) -> list[list[Score] | str]:
    """Runs of a case with each set of parameters of its law, all with the same seeds
    (:attr:`railhil.tuning.trials.Tuning.run_sets`).

    :param case: its arithmetic is ``float64``; the parameters of its law are ignored.
    :param sets: None: the law's own parameters.
    :returns: for each set the score of each seed, or the reason for which the law cannot be made with this set.
    :raises InputError: the law refuses the names or types of the parameters, or does not fit the scenario.
    """
    found: list[list[Score] | str] = [""] * len(sets)
    alike: dict[str, list[tuple[int, LawProgram]]] = defaultdict(list)
    for place, parameters in enumerate(sets):
        try:
            programs = record(case.scenario, replace(case.law, parameters=parameters), wide=True)
        except InputError as error:
            # Raised by a law for inconsistent parameters.
            if not isinstance(error.__cause__, ValueError):
                raise
            found[place] = str(error.__cause__)
        else:
            alike[shape(programs)].append((place, programs))
    # As many trains together as is optimal for the engine.
    most = max(1, CHUNK // len(seeds))
    for group in alike.values():
        for first in range(0, len(group), most):
            part = group[first : first + most]
            loop = StackedLoop([programs for _, programs in part], len(seeds))
            scores = Engine(case, loop).run([*seeds] * len(part)).scores
            for number, (place, _) in enumerate(part):
                found[place] = scores[number * len(seeds) : (number + 1) * len(seeds)]
    return found
