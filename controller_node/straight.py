"""The written-out functions of a shipped law (:mod:`railhil.controller_node.written`), bound to one run.

They are used where the law's program, recorded for this run, has the shape for which they were written; a law of
another distribution, other operations (a longer horizon) and single precision that truncates run as the law itself. So
does a step in which something is to be counted.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from railhil.controller_node import laws
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic, Curve
from railhil.controller_node.arithmetic.float32 import Float32
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.arithmetic.iq import C28, Portable
from railhil.controller_node.program.model import LawProgram, Operation, Program
from railhil.controller_node.program.shape import shape_of
from railhil.controller_node.program.writer import FIXED, FLOAT32, FLOAT64, are_constant, checked_inputs
from railhil.controller_node.written.index import FUNCTIONS
from railhil.controller_node.written.parts import Parts, Step, Values

if TYPE_CHECKING:
    from railhil.controller_node.program.ranges import LawRanges, Ranges

#: Arithmetics for one train that a family of functions serves.
_FAMILIES: dict[type[Arithmetic[Any]], str] = {C28: FIXED, Portable: FIXED, Float64: FLOAT64, Float32: FLOAT32}


class Straight:
    """One control period as two functions: wire values to the law's inputs, then state and inputs to the outputs."""

    def __init__(self, inputs: Step, step: Step, spare: Arithmetic[Any]) -> None:
        self._inputs, self._step = inputs, step
        self._happened = spare.counters

    def period(self, state: Values, wire: Values) -> tuple[Values, Values, Values, Values] | None:
        """One control period, or None if the law itself must compute it.

        :param state: leaves of the law's state; ``wire``: number of the period and wire values as operands.
        :returns: inputs, new state, outputs (all in the order of their leaves), quantities.
        """
        first = self._inputs((), wire)
        if first is None:
            return None
        given = first[1]
        second = self._step(state, given)
        happened = self._happened
        if happened.wraps or happened.saturations or happened.zero_divisions:
            happened.wraps = happened.saturations = happened.zero_divisions = 0
            return None
        if second is None:
            return None
        after, outputs, noted = second
        return given, after, outputs, first[2] + noted


def is_shipped(law: type[Any]) -> bool:
    """True for the class of a law of this distribution, whose program may replace it.

    What a law of somebody else does besides its operations, such as to raise, is not in its program.
    """
    return law.__module__.startswith(f"{laws.__name__}.")


def straight(program: LawProgram, law: Any, arithmetic: Arithmetic[Any], ranges: LawRanges | None) -> Straight | None:
    """The written-out functions of a law, None if there are none for it.

    :param program: recorded for the arithmetic.
    :param ranges: of this program, for fixed point: nothing in it may wrap. None: not analysed.
    """
    family = _FAMILIES.get(type(arithmetic))
    if family is None or not is_shipped(type(law)):
        return None
    if family == FIXED and (ranges is None or ranges.may_wrap):
        return None
    spare = make(arithmetic.name)
    inputs = _bound(program.inputs, family, spare, None if ranges is None else ranges.inputs)
    step = _bound(program.step, family, spare, None if ranges is None else ranges.step)
    return None if inputs is None or step is None else Straight(inputs, step, spare)


def _swapped(operation: Operation) -> bool:
    """True for limits in the wrong order, with which the arithmetics differ."""
    if operation.op not in ("clip", "sat") or not are_constant(operation):
        return False
    upper, lower = (value.constant for value in operation.arguments[1:])
    return upper is not None and lower is not None and lower.value > upper.value


def _curve(curve: Curve, family: str, spare: Arithmetic[Any]) -> Any:
    """A curve as a function of this family reads it: its samples, or in float64 what computes it."""
    if family == FIXED:
        return tuple(sample.raw for sample in curve.samples)
    return curve.function if family == FLOAT64 else spare.load(curve.samples)


def _bound(program: Program, family: str, spare: Arithmetic[Any], ranges: Ranges | None) -> Step | None:
    shape = shape_of(program, family, formats=family == FIXED)
    found = FUNCTIONS.get(shape.digest)
    if found is None or any(map(_swapped, program.operations)):
        return None
    module, _, name = found.partition(":")
    factory: Callable[[Parts], Step] = getattr(import_module(f"railhil.controller_node.written.{module}"), name)
    bounds: list[int] = []
    if ranges is not None:
        bounds = [bound for _, value in checked_inputs(program) for bound in ranges.of(value)]
    return factory(
        Parts(
            spare,
            spare.load(shape.constants),
            tuple(spare.table(table.name, table.constants) for table in shape.tables),
            tuple(_curve(curve, family, spare) for curve in shape.curves),
            tuple(shape.lasts),
            tuple(bounds),
        )
    )
