"""The IQ vectors detect wrong semantics: each likely mistake, introduced into a profile, must be reported."""

from __future__ import annotations

from typing import Any

import pytest

from hil_tests.support.iq_vectors import FUNCTIONS, as_arrays, check, judge, shipped_rows
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.arithmetic.iq import C28, C28Batch, Portable
from railhil.controller_node.arithmetic.iq.core import low32

C28_DIV, C28_SQRT = C28.div, C28.sqrt


def exact_quotient(a: int, b: int, q: int) -> int:
    """Rounded, not limited."""
    if b < 0:
        a, b = -a, -b
    return ((a << (q + 1)) + b) // (2 * b)


def truncated_div(self: C28, a: int, b: int, q: int) -> int:
    if b == 0:
        return C28_DIV(self, a, b, q)
    size = (abs(a) << q) // abs(b)
    return self.sat(size if (a < 0) == (b < 0) else -size, INT32_MAX, INT32_MIN)


#: Mistake -> (method it replaces, function of the vectors that must show it, the wrong method).
MISTAKES: dict[str, tuple[str, str, Any]] = {
    "rmpy for mpy": ("mpy", "mpy", C28.rmpy),
    "mpy for rmpy": ("rmpy", "rmpy", C28.mpy),
    "floor for toward zero in int": ("int_part", "int", Portable.int_part),
    "floor for toward zero in mpyI32int": ("mpy_i32_int", "mpyI32int", lambda self, a, n, q: low32((a * n) >> q)),
    "unsigned fraction": ("frac", "frac", Portable.frac),
    "unsigned fraction in mpyI32frac": ("mpy_i32_frac", "mpyI32frac", Portable.mpy_i32_frac),
    "wrap for saturation in rsmpy": ("rsmpy", "rsmpy", C28.rmpy),
    "wrap for saturation in div": (
        "div",
        "div",
        lambda self, a, b, q: low32(exact_quotient(a, b, q)) if b else INT32_MAX,
    ),
    "wrap for saturation in sadd": ("sadd", "sadd", C28.add),
    "saturation for wrap in add": ("add", "add", C28.sadd),
    "truncated for rounded div": ("div", "div", truncated_div),
    "sign of the numerator in x/0": (
        "div",
        "div",
        lambda self, a, b, q: C28_DIV(self, a, b, q) if b else (INT32_MAX if a >= 0 else INT32_MIN),
    ),
    "Q off by one in mpy": ("mpy", "mpy", lambda self, a, b, q: low32((a * b) >> (q - 1))),
    "Q off by one in rmpy": ("rmpy", "rmpy", lambda self, a, b, q: low32(((a * b << 1) + (1 << (q - 1))) >> q)),
    "Q off by one in div": ("div", "div", lambda self, a, b, q: C28_DIV(self, a, b, q - 1)),
    "Q off by one in sqrt": ("sqrt", "sqrt", lambda self, a, q: C28_SQRT(self, a, q - 1)),
    "truncated for rounded sqrt": ("sqrt", "sqrt", lambda self, a, q: C28_SQRT(self, a, q + 2) >> 1),
    "logical shift": ("shr", "shr", lambda self, a, count: (a & 0xFFFFFFFF) >> count),
    "two's complement in toF": ("to_f", "toF", Portable.to_f),
    "turns of -1/2 to 1/2": ("atan2_pu", "atan2PU", Portable.atan2_pu),
    "sides swapped in atan2": ("atan2", "atan2", lambda self, y, x, q: C28().atan2(x, y, q)),
    "sine for cosine in acos": ("acos", "acos", C28.asin),
    "zero for the logarithm of nothing": ("log", "log", lambda self, a, q: C28().log(a, q) if a > 0 else 0),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_reported(mistake: str) -> None:
    method, function, wrong = MISTAKES[mistake]
    mutant = type("Mutant", (C28,), {method: wrong})
    assert check("c28", function, shipped_rows()[function]).wrong == 0
    assert check("c28", function, shipped_rows()[function], mutant()).wrong >= 2


@pytest.mark.parametrize(
    "function",
    ["div", "sqrt", "isqrt", "mag", "exp", "log", "sin", "cos", "sinPU", "cosPU", "asin", "acos", "atan2", "atan2PU"],
)
def test_the_portable_profile_is_told_from_exact_results(function: str) -> None:
    method = FUNCTIONS[function].method
    mutant = type(
        "Mutant",
        (Portable,),
        {method: getattr(C28, method), "_size": C28._size, "_limited_to_one": C28._limited_to_one},
    )
    assert check("portable", function, shipped_rows()[function], mutant()).wrong >= 5


@pytest.mark.parametrize("function", ["mpy", "rmpy", "div", "sqrt"])
def test_a_mistake_in_arrays_is_reported(function: str, monkeypatch: pytest.MonkeyPatch) -> None:
    right = getattr(C28Batch, FUNCTIONS[function].method)
    monkeypatch.setattr(C28Batch, FUNCTIONS[function].method, lambda self, *operands: right(self, *operands) + 1)
    assert (
        judge(
            "c28", function, shipped_rows()[function], as_arrays(C28Batch(), function, shipped_rows()[function])
        ).wrong
        >= 100
    )
