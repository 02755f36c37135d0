"""C in fixed point: operations that the IQmath library has (N = 1..30) are calls of its functions, all others of the
``iq_*`` functions in ``railhil_iq.h``.
"""

from __future__ import annotations

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.export.body import Body
from railhil.controller_node.export.text import literal
from railhil.controller_node.program.model import Operation

#: The IQmath library provides its functions for 1 to 30 fraction bits.
NAMED_Q = range(1, 31)

_PLAIN = {"add": "iq_add", "sub": "iq_sub", "neg": "iq_neg", "minimum": "iq_min", "maximum": "iq_max"}
_CURVE_BITS = 8
#: Largest shifts of a 64-bit product and of a 32-bit number.
_PRODUCT_SHIFT_MAX = 62
_SHIFT_MAX = 31
#: railhil's own functions, for formats that the library lacks. There are none for quotients and roots, which would need
#: more than 64 bits there.
_OWN = {"mpy": "iq_mpy", "rmpy": "iq_rmpy", "rsmpy": "iq_rsmpy"}


def _library_call(name: str, q: int, *arguments: str) -> str:
    """A call of the library function for this format if there is one, else of railhil's own function.

    :raises ValueError: there is neither.
    """
    if q in NAMED_Q:
        return f"_IQ{q}{name}({', '.join(arguments)})"
    if name not in _OWN or not 0 <= q <= _PRODUCT_SHIFT_MAX:
        raise ValueError(f"{name} with {q} fraction bits")
    return f"{_OWN[name]}({', '.join(arguments)}, {q})"


def _shift(argument: str, q_from: int, q_to: int) -> str:
    """Conversion to another format.

    :raises ValueError: all bits of the number would be shifted out.
    """
    if q_to - q_from > _SHIFT_MAX:
        raise ValueError(f"convert from Q{q_from} to Q{q_to}")
    if q_to > q_from:
        return f"iq_shl({argument}, {q_to - q_from})"
    # A shift by 31 leaves only the sign; larger shifts give the same result.
    return f"iq_shr({argument}, {min(q_from - q_to, _SHIFT_MAX)})"


class FixedBody(Body):
    """The body of a function in fixed point."""

    number = "int32_t"
    header = "railhil_iq.h"
    has_formats = True
    code_words = (
        "Straight-line int32 code: no float, no branch except ?:, no",
        "allocation, no recursion. Constants are integers because _IQ() on the target truncates its argument.",
    )
    value_words = "Value = raw / 2^Q."
    constant_words = "raw integer; value, Q, origin"
    flags = "-fwrapv"
    libraries = ""
    prefix = "iq"

    @staticmethod
    def literal(constant: Constant) -> str:
        return literal(constant.raw)

    @staticmethod
    def from_raw(expression: str, q: int) -> str:
        return expression

    @staticmethod
    def raw(expression: str, q: int) -> str:
        return expression

    @staticmethod
    def note(expression: str, shift: int, low: int, high: int) -> str:
        return f"iq_max({literal(low)}, iq_min({literal(high)}, iq_shr({expression}, {shift})))"

    def _product(self, a: str, b: str, q: int) -> str:
        return _library_call("rmpy", q, a, b)

    def _counts(self, operation: Operation, arguments: list[str]) -> list[str]:
        what = {"div": "division", "rsmpy": "product"}.get(operation.op)
        if what is None:
            return []
        return [f"iq_note_{what}({', '.join(arguments)}, {operation.parameters[0]}, events);"]

    def _call(self, operation: Operation, arguments: list[str]) -> str:
        parameters = operation.parameters
        listed = ", ".join(arguments)
        match operation.op:
            case "add" | "sub" | "neg" | "minimum" | "maximum":
                return f"{_PLAIN[operation.op]}({listed})"
            case "mpy" | "rmpy" | "rsmpy" | "div" | "sqrt":
                return _library_call(operation.op, parameters[0], *arguments)
            case "mpy_iqx":
                q_a, q_b, q = parameters
                if q in NAMED_Q and q_a in NAMED_Q and q_b in NAMED_Q:
                    return f"_IQ{q}mpyIQX({arguments[0]}, {q_a}, {arguments[1]}, {q_b})"
                if abs(q_a + q_b - q) > _PRODUCT_SHIFT_MAX:
                    raise ValueError(f"mpy_iqx from Q{q_a} and Q{q_b} to Q{q}")
                return f"iq_mpy_iqx({arguments[0]}, {q_a}, {arguments[1]}, {q_b}, {q})"
            case "abs":
                q_of = operation.result.q
                return f"_IQ{q_of}abs({listed})" if q_of in NAMED_Q else f"iq_abs({listed})"
            case "quantise":
                return _library_call("rmpy", parameters[0] - parameters[1], listed, literal(1))
            case "convert":
                return _shift(listed, *parameters)
            case "sat":
                return f"iq_limit({listed}, events)"
            case "clip":
                return f"_IQsat({listed})"
            case "curve":
                assert operation.curve is not None
                return f"iq_curve({self._curve(operation)}, {listed}, {operation.curve.q_in - _CURVE_BITS})"
        raise ValueError(f"{operation.op} in fixed point")


def names_of_iqmath() -> str:
    """Macros with the library's names for railhil's functions, for every format of the library."""
    lines = []
    for q in NAMED_Q:
        lines += [
            f"#define _IQ{q}mpy(a, b) iq_mpy((a), (b), {q})",
            f"#define _IQ{q}rmpy(a, b) iq_rmpy((a), (b), {q})",
            f"#define _IQ{q}rsmpy(a, b) iq_rsmpy((a), (b), {q})",
            f"#define _IQ{q}mpyIQX(a, q_a, b, q_b) iq_mpy_iqx((a), (q_a), (b), (q_b), {q})",
            f"#define _IQ{q}div(a, b) iq_div((a), (b), {q})",
            f"#define _IQ{q}sqrt(a) iq_sqrt((a), {q})",
            f"#define _IQ{q}abs(a) iq_abs(a)",
        ]
    return "\n".join(lines)
