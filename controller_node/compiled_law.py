"""The recorded program of a shipped law as two compiled functions, made when a run binds its law.

The functions take a third of the law's time and give the same results (:mod:`..program.emit_python`). A law of another
distribution, single precision that truncates, and a step with an event to count run as the law itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

from railhil import controller_node
from railhil.common.generated_source import compile_source
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.arithmetic.float32 import Float32
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.arithmetic.iq import C28, Portable
from railhil.controller_node.program.emit_python import FIXED, FLOAT32, FLOAT64, emit_python
from railhil.controller_node.program.model import LawProgram, Program

if TYPE_CHECKING:
    from railhil.controller_node.program.ranges import LawRanges, Ranges

#: Operands in the order of a program's inputs, outputs or quantities.
Values: TypeAlias = tuple[Any, ...]
#: State and inputs -> new state, other outputs, quantities; None: the law itself has to compute this step.
Step: TypeAlias = Callable[[Values, Values], tuple[Values, Values, Values] | None]

#: Arithmetics for one train that a family of functions serves.
_FAMILIES: dict[type[Arithmetic[Any]], str] = {C28: FIXED, Portable: FIXED, Float64: FLOAT64, Float32: FLOAT32}


class CompiledLaw:
    """One control period as two functions: wire values to the law's inputs, then state and inputs to the outputs.

    :param number: the arithmetic that the functions call; its counters show whether an event occurred in them.
    """

    def __init__(self, inputs: Step, step: Step, number: Arithmetic[Any]) -> None:
        self._inputs, self._step = inputs, step
        self._happened = number.counters

    def step(self, state: Values, wire: Values) -> tuple[Values, Values, Values, Values] | None:
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

    A law of another distribution may do more than its operations: print a value, stop in a debugger, raise. Its program
    does not contain these.
    """
    return law.__module__.startswith(f"{controller_node.__name__}.")


def compile_law(
    program: LawProgram, law: Any, arithmetic: Arithmetic[Any], ranges: LawRanges | None
) -> CompiledLaw | None:
    """The functions of a law, None if it runs as the law itself.

    :param program: recorded for the arithmetic.
    :param ranges: of this program, for fixed point: nothing in it may wrap. None: not analysed.
    """
    family = _FAMILIES.get(type(arithmetic))
    if family is None or not is_shipped(type(law)):
        return None
    if family == FIXED and (ranges is None or ranges.may_wrap):
        return None
    if any(operation.problem is not None for operation in program.step.operations):
        # A library solves it.
        return None
    number = make(arithmetic.name)

    def compiled(part: Program, within: Ranges | None) -> Step:
        text, names = emit_python(part, family, number, within)
        step: Step = compile_source(f"law {program.law} {arithmetic.name} {part.name}", text, names)[part.name]
        return step

    inputs = compiled(program.inputs, None if ranges is None else ranges.inputs)
    return CompiledLaw(inputs, compiled(program.step, None if ranges is None else ranges.step), number)
