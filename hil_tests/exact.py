"""Numbers to hold an arithmetic against: 80 decimal digits, fractions, and operands of every size."""

from __future__ import annotations

import decimal
import math
import random
from decimal import Decimal
from fractions import Fraction

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN

FORMATS = range(1, 31)
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211707")


def with_many_digits() -> None:
    """80 digits in this thread's decimals from here on."""
    context = decimal.getcontext()
    context.prec, context.Emin, context.Emax = 80, -(10**12), 10**12


def spread(seed: int, count: int = 30) -> list[int]:
    """Numbers of every size and sign, ends included."""
    source = random.Random(seed)
    sizes = [source.getrandbits(source.randint(1, 31)) for _ in range(count)]
    return [INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX, *(source.choice((-1, 1)) * size for size in sizes)]


def limited(exact: int) -> int:
    return min(max(exact, INT32_MIN), INT32_MAX)


def nearest(exact: Fraction) -> int:
    """Ties upward, limited."""
    return limited(math.floor(exact + Fraction(1, 2)))


def rounded(value: Decimal, q: int) -> int:
    """Decimal value in Q ``q``, to nearest, not limited."""
    return int((value * 2**q).to_integral_value(rounding=decimal.ROUND_HALF_EVEN))


def sine(angle: Decimal) -> Decimal:
    """Taylor series after removal of whole turns."""
    angle = angle.remainder_near(2 * PI)
    term = total = angle
    k = 1
    while abs(term) > Decimal("1e-60"):
        k += 2
        term = -term * angle * angle / (k * (k - 1))
        total += term
    return total
