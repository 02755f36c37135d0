"""Properties of the arithmetics: one train and many give equal bits, constants are rounded, names are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.bus.ident import ARITHMETICS
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make, names
from railhil.controller_node.arithmetic.base import Constant, Curve
from railhil.controller_node.arithmetic.float64 import Float64, Float64Batch
from railhil.controller_node.arithmetic.iq import C28, C28Batch

REAL = st.floats(-1e6, 1e6)

CURVE = Curve.sampled("decay", lambda x: math.exp(-x), 24, 30)


@pytest.mark.slow
@settings(deadline=None, max_examples=100)
@given(st.lists(st.tuples(REAL, REAL), min_size=1, max_size=8))
def test_float64_scalar_equals_array(pairs: list[tuple[float, float]]) -> None:
    one, many = Float64(), Float64Batch()
    a, b = (np.array(column) for column in zip(*pairs, strict=True))
    for operation in ("add", "sub", "minimum", "maximum", "gt"):
        expected = [getattr(one, operation)(x, y) for x, y in pairs]
        np.testing.assert_array_equal(getattr(many, operation)(a, b), expected)
    for operation in ("mpy", "rmpy", "rsmpy"):
        expected = [getattr(one, operation)(x, y, 24) for x, y in pairs]
        np.testing.assert_array_equal(getattr(many, operation)(a, b, 24), expected)
    np.testing.assert_array_equal(many.quantise(a, 19, 8), [one.quantise(x, 19, 8) for x, _ in pairs])
    np.testing.assert_array_equal(many.raw(a, 8), [one.raw(x, 8) for x, _ in pairs])
    expected = [one.dot([x, y, x], [y, y, x], 24) for x, y in pairs]
    np.testing.assert_array_equal(many.dot([a, b, a], [b, b, a], 24), expected)
    unit = np.clip(abs(a) / 1e6, 0, 1)
    np.testing.assert_array_equal(many.curve(CURVE, unit), [one.curve(CURVE, x) for x in unit.tolist()])
    expected = [one.clip(x, max(x, y), y) for x, y in pairs]
    np.testing.assert_array_equal(many.clip(a, np.maximum(a, b), b), expected)


@pytest.mark.filterwarnings("error")
def test_float64_division_by_zero_is_infinite_for_one_and_for_many() -> None:
    one, many = Float64(), Float64Batch()
    inf, huge, tiny = math.inf, 1e308, 5e-324
    a = [3.0, -3.0, 0.0, -0.0, tiny, -tiny, inf, -inf, math.nan, -3.0]
    b = [0.0] * 9 + [-0.0]
    expected = [inf, -inf, inf, inf, inf, -inf, inf, -inf, inf, -inf]
    assert [one.div(x, y, 20) for x, y in zip(a, b, strict=True)] == expected
    assert many.div(np.array(a), np.array(b), 20).tolist() == expected
    assert many.div(np.array(a), 0.0, 20).tolist() == expected  # type: ignore[arg-type]
    assert many.div(-2.0, np.array([0.0, 4.0]), 20).tolist() == [-inf, -0.5]  # type: ignore[arg-type]
    # What overflows, underflows or has no value otherwise is silent too, and equal.
    a, b = [huge, -huge, tiny, inf, 6.0, -7.0], [tiny, tiny, huge, inf, inf, 2.0]
    expected = [one.div(x, y, 20) for x, y in zip(a, b, strict=True)]
    np.testing.assert_array_equal(many.div(np.array(a), np.array(b), 20), expected)
    assert one.div(-7.0, 2.0, 20) == -3.5
    # An infinite quotient stays what it is when it is rounded to a format.
    assert [one.quantise(x, 19, 8) for x in (inf, -inf)] == many.quantise(np.array([inf, -inf]), 19, 8).tolist()
    assert one.quantise(-inf, 19, 8) == -inf


@given(st.lists(st.integers(0, 2**24), min_size=1, max_size=30))
def test_curve_table_scalar_equals_array_and_is_close(arguments: list[int]) -> None:
    one = [C28().curve(CURVE, a) for a in arguments]
    np.testing.assert_array_equal(C28Batch().curve(CURVE, np.array(arguments)), one)
    exact = np.exp(-np.array(arguments) / 2**24)
    # Linear interpolation over 1/256: at most f''/8/256^2, plus rounding.
    assert np.max(abs(np.array(one) / 2**30 - exact)) < 1 / 8 / 256**2 + 2**-28


def test_curve_ends_are_samples() -> None:
    assert C28().curve(CURVE, 0) == 2**30
    assert C28().curve(CURVE, 2**24) == CURVE.samples[-1].raw


@given(st.lists(st.integers(-5, 120), min_size=1, max_size=20))
def test_locate_scalar_equals_array(arguments: list[int]) -> None:
    constants = [Constant(f"x[{i}]", float(x), 0) for i, x in enumerate((0, 3, 4, 50, 50, 100))]
    for one, many in ((C28(), C28Batch()), (Float64(), Float64Batch())):
        table = one.table("t", constants)
        expected = [one.locate(table, a) for a in arguments]
        np.testing.assert_array_equal(many.locate(many.table("t", constants), np.array(arguments)), expected)
        assert all(0 <= index <= 4 for index in expected)
        assert all(table[i] <= a for i, a in zip(expected, arguments, strict=True) if a >= 0)


def test_constants_are_rounded_to_nearest() -> None:
    constant = Constant("k", 0.7, 24)
    assert constant.raw == 11744051
    assert abs(constant.rounding_error) <= 2**-25
    assert constant.relative_error == abs(constant.rounding_error) / 0.7
    assert C28().const(constant) == 11744051
    assert Float64().const(constant) == 0.7
    assert Constant("zero", 0.0, 24).relative_error == 0.0


@pytest.mark.parametrize("value", [128.0, -129.0, math.nan, math.inf])
def test_constant_outside_its_format_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r"constant k .* does not fit into int32 with Q24"):
        Constant("k", value, 24)


def test_unknown_arithmetic_is_one_line() -> None:
    allowed = ", ".join(sorted(ARITHMETICS[1:]))
    assert ", ".join(names()) == allowed, "those that the wire can name"
    with pytest.raises(InputError, match=rf"^arithmetic: name: found 'float16', allowed one of {allowed}$"):
        make("float16")
