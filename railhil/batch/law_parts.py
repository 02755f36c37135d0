"""Operations of a law that are not a line of an emitted text (:mod:`railhil.controller_node.program.emit_numba`)."""

from __future__ import annotations

from math import floor, frexp, inf, ldexp
from typing import Any

import numpy as np

from railhil.batch import compiled
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.arithmetic.float32 import ESTIMATE_BITS, FLT_MAX, FLT_MIN

#: Stands for a quotient in fixed point whose events are counted.
LEFT = 2**40


@compiled.side_by_side_part
def quotient_int(a: int, b: int, q: int) -> int:
    """``C28.div``."""
    if b == 0:
        return LEFT
    if b < 0:
        a, b = -a, -b
    exact = ((a << (q + 1)) + b) // (2 * b)
    return exact if INT32_MIN <= exact <= INT32_MAX else LEFT


@compiled.side_by_side_part
def quotient(a: float, b: float, q: int) -> float:
    """``Float64.div``."""
    if b == 0.0:
        return -inf if a < 0.0 else inf
    return a / b


@compiled.side_by_side_part
def nearest_multiple(a: float, q_from: int, q_to: int) -> float:
    """``Float64.quantise``."""
    return ldexp(floor(ldexp(a, q_to) + 0.5), -q_to) if -inf < a < inf else a


@compiled.side_by_side_part
def nearest(value: float) -> float:
    """``float32.nearest``."""
    rounded = float(np.float32(value))
    size = abs(rounded)
    if size < FLT_MIN:
        return 0.0
    if size <= FLT_MAX:
        return rounded
    return -inf if rounded < 0.0 else inf


@compiled.side_by_side_part
def located(table: Any, a: float) -> int:
    """``Arithmetic.locate``."""
    low, high = 0, len(table)
    while low < high:
        middle = (low + high) // 2
        if table[middle] <= a:
            low = middle + 1
        else:
            high = middle
    return min(max(low - 1, 0), len(table) - 2)


@compiled.side_by_side_part
def quotient_single(a: float, b: float, q: int) -> float:
    """``Float32.div``."""
    if b == 0.0 or abs(b) > FLT_MAX:
        reciprocal = inf if b == 0.0 else 0.0
    else:
        mantissa, exponent = frexp(b)
        digits = floor(ldexp(1.0 / mantissa, ESTIMATE_BITS) + 0.5)
        reciprocal = nearest(ldexp(float(digits), -ESTIMATE_BITS - exponent))
    for _ in range(2):
        reciprocal = nearest(reciprocal * nearest(2.0 - nearest(b * reciprocal)))
    return nearest(a * (0.0 if abs(b) > FLT_MAX else reciprocal))
