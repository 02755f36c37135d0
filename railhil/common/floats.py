"""Operations on floats for functions that every tick calls: the compiled build (setup.py) computes them natively, where
:func:`railhil.common.compilable.smaller`, ``larger`` and ``round`` take any numbers.

The batch compiles them, too (:mod:`railhil.common.compilable`).
"""

from __future__ import annotations

from typing import Final

from railhil.common.compilable import compilable_functions

#: A sum with this float has no binary places: it is rounded to a whole number, halves to the even one (IEEE 754).
_NO_PLACES: Final = 1.5 * 2.0**52
#: Up to this magnitude the sum is exact except for the rounding.
_WHOLE_MAX: Final = 2.0**51


def smaller(a: float, b: float) -> float:
    """``min`` of two floats; if they are equal, the first."""
    return b if b < a else a


def larger(a: float, b: float) -> float:
    """``max`` of two floats; if they are equal, the first."""
    return b if b > a else a


def rounded(value: float) -> int:
    """``round`` of a float, native where it is compiled.

    :raises ValueError: not a number.
    :raises OverflowError: infinite.
    """
    if -_WHOLE_MAX < value < _WHOLE_MAX:
        return int((value + _NO_PLACES) - _NO_PLACES)
    return round(value)


compilable_functions(smaller, larger, rounded)
