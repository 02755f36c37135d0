"""Operations on floats of :mod:`railhil.common.floats`: the same bits as those of Python."""

from __future__ import annotations

from math import inf, nan, nextafter

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from railhil.common import compilable, floats

FLOATS = st.floats(allow_nan=False)


@given(st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**53), 2**53).map(lambda value: value / 2))
@example(0.5)
@example(1.5)
@example(-2.5)
@example(2.0**51)
@example(-(2.0**51))
@example(nextafter(2.0**51, 0.0))
@example(nextafter(0.5, 0.0))
@example(nextafter(0.5, 1.0))
def test_rounded_is_round(value: float) -> None:
    found = floats.rounded(value)
    assert (found, type(found)) == (round(value), int)


@pytest.mark.parametrize(("value", "error"), [(nan, ValueError), (inf, OverflowError), (-inf, OverflowError)])
def test_what_is_no_number_is_not_rounded(value: float, error: type[Exception]) -> None:
    with pytest.raises(error):
        floats.rounded(value)


@given(FLOATS, FLOATS)
@example(0.0, -0.0)
@example(-0.0, 0.0)
def test_smaller_and_larger(a: float, b: float) -> None:
    """As those for any numbers, and the signs of zeros too."""
    assert repr((floats.smaller(a, b), floats.larger(a, b))) == repr(
        (compilable.smaller(a, b), compilable.larger(a, b))
    )
    assert (floats.smaller(a, b), floats.larger(a, b)) == (min(a, b), max(a, b))
