"""C in single precision, also for laws that have no fixed-point formats.

The functions ``f32_*`` of ``railhil_f32.h`` give the bits of the arithmetic ``float32``.
"""

from __future__ import annotations

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.arithmetic.float32 import nearest
from railhil.controller_node.export.body import Body
from railhil.controller_node.export.text import literal
from railhil.controller_node.program.model import Operation

#: Operations whose formats have no meaning here.
_CALLS = dict.fromkeys(("mpy", "rmpy", "rsmpy", "mpy_iqx"), "f32_mul") | {
    "add": "f32_add",
    "sub": "f32_sub",
    "neg": "f32_neg",
    "abs": "f32_abs",
    "sqrt": "f32_sqrt",
    "div": "f32_div",
    "minimum": "f32_min",
    "maximum": "f32_max",
    "sat": "f32_clip",
    "clip": "f32_clip",
}


class SingleBody(Body):
    """The body of a function in single precision; the law's outputs are integers, as in fixed point."""

    number = "float"
    header = "railhil_f32.h"
    has_formats = False
    code_words = (
        "Straight-line code in single precision: no branch except ?:, no",
        "allocation, no recursion.",
    )
    value_words = "Inputs and state are single numbers, outputs integers: value = raw / 2^Q."
    constant_words = "nearest single; value, origin"
    # A compiler that contracts a * b + c rounds only once.
    flags = "-ffp-contract=off"
    libraries = "-lm"
    prefix = "f32"

    @staticmethod
    def literal(constant: Constant) -> str:
        return f"{nearest(constant.value).hex()}f"

    @staticmethod
    def from_raw(expression: str, q: int) -> str:
        return f"f32_from({expression}, {q})"

    @staticmethod
    def raw(expression: str, q: int) -> str:
        return f"f32_raw({expression}, {q})"

    @staticmethod
    def note(expression: str, shift: int, low: int, high: int) -> str:
        return f"f32_note({expression}, {shift}, {literal(low)}, {literal(high)})"

    def _product(self, a: str, b: str, q: int) -> str:
        return f"f32_mul({a}, {b})"

    def _counts(self, operation: Operation, arguments: list[str]) -> list[str]:
        return []

    def _call(self, operation: Operation, arguments: list[str]) -> str:
        listed = ", ".join(arguments)
        match operation.op:
            case "convert":
                return listed
            case "quantise":
                return f"f32_quantise({listed}, {operation.parameters[1]})"
            case "curve":
                return f"f32_curve({self._curve(operation)}, {listed})"
        if operation.op not in _CALLS:
            raise ValueError(f"{operation.op} in single precision")
        return f"{_CALLS[operation.op]}({listed})"
