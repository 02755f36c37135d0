"""The two float32 arithmetics: against numpy's single precision, against exact fractions, one number and many."""

from __future__ import annotations

import math
import struct
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant, Counters, Curve
from railhil.controller_node.arithmetic.float32 import (
    FLT_MAX,
    FLT_MIN,
    Float32,
    Float32Truncated,
    nearest,
    rounding_error,
    toward_zero,
)
from railhil.controller_node.arithmetic.float32_batch import Float32Batch, Float32TruncatedBatch

PAIRS_OF_CLASSES = [(Float32, Float32Batch), (Float32Truncated, Float32TruncatedBatch)]
ONE = [Float32(), Float32Truncated()]
INF = math.inf
#: Smallest step above 1.
EPS = 2.0**-23
CURVE = Curve.sampled("decay", lambda x: math.exp(-x), 24, 30)


def of_bits(bits: int) -> float:
    return struct.unpack("<f", struct.pack("<I", bits))[0]


#: Zeros, smallest denormal, largest denormal, smallest normal and its neighbour, one and neighbours, largest, infinity,
#: NaN, each with both signs.
_EDGES = [0, 1, 0x7FFFFF, 0x800000, 0x800001, 0x3F7FFFFF, 0x3F800000, 0x3F800001, 0x7F7FFFFF, 0x7F800000, 0x7FC00000]
_ALL = st.one_of(
    st.integers(0, 2**32 - 1),
    st.sampled_from([bits | sign for bits in _EDGES for sign in (0, 1 << 31)]),
    # Exponents close to each other, where sums cancel and round.
    st.builds(
        lambda e, m, s: (s << 31) | (e << 23) | m, st.integers(110, 150), st.integers(0, 2**23 - 1), st.booleans()
    ),
)
BITS = _ALL.map(of_bits)
PAIRS = st.lists(st.tuples(BITS, BITS), min_size=1, max_size=20)


def flushed(value: Any) -> float:
    """What the unit makes of an IEEE single."""
    single = float(value)
    if math.isnan(single):
        return INF
    return 0.0 if abs(single) < FLT_MIN else single


def same_bits(a: Any, b: Any) -> bool:
    return struct.pack("<d", a) == struct.pack("<d", b)


def cut(exact: Fraction) -> float:
    """An exact number with the digits behind the 24th cut off, by whole numbers only."""
    if exact == 0:
        return 0.0
    size, shift = abs(exact), 0
    while size >= 2**24:
        size, shift = size / 2, shift + 1
    while size < 2**23:
        size, shift = size * 2, shift - 1
    value = math.floor(size) * Fraction(2) ** shift
    if value < Fraction(FLT_MIN):
        return 0.0
    return math.copysign(min(float(min(value, Fraction(FLT_MAX))), FLT_MAX), exact)


@settings(deadline=None, max_examples=400)
@given(BITS, BITS)
def test_nearest_is_numpy_with_denormals_flushed(x: float, y: float) -> None:
    ar = Float32()
    a, b = ar.operand(x), ar.operand(y)
    assert same_bits(a, flushed(np.float32(x)))
    m, n = np.float32(a), np.float32(b)
    with np.errstate(all="ignore"):
        expected = {"add": m + n, "sub": m - n, "mpy": m * n, "neg": -m, "abs": abs(m)}
    found = {"add": ar.add(a, b), "sub": ar.sub(a, b), "mpy": ar.mpy(a, b, 24), "neg": ar.neg(a), "abs": ar.abs(a)}
    assert all(same_bits(found[name], flushed(expected[name])) for name in expected), (a, b, found, expected)
    if a > 0:
        assert same_bits(ar.sqrt(a, 20), float(np.sqrt(m)))
    assert found["mpy"] == ar.rmpy(a, b, 24) == ar.rsmpy(a, b, 24) == ar.mpy_iqx(a, 20, b, 20, 20)


@pytest.mark.slow
@settings(deadline=None, max_examples=400)
@given(BITS, BITS)
def test_truncation_is_that_of_exact_fractions(x: float, y: float) -> None:
    ar = Float32Truncated()
    a, b = ar.operand(x), ar.operand(y)
    if math.isinf(a) or math.isinf(b):
        assert math.isinf(ar.add(a, b))
        return
    exact_a, exact_b = Fraction(a), Fraction(b)
    assert same_bits(ar.add(a, b), cut(exact_a + exact_b))
    assert same_bits(ar.sub(a, b), cut(exact_a - exact_b))
    assert same_bits(ar.mpy(a, b, 24), cut(exact_a * exact_b))
    if a > 0:
        root = Fraction(ar.sqrt(a, 20))
        assert root**2 <= exact_a < (root * (1 + Fraction(EPS))) ** 2


@settings(deadline=None, max_examples=200)
@given(st.floats(allow_nan=False, allow_infinity=False))
def test_doubles_are_rounded_to_nearest_and_cut(x: float) -> None:
    with np.errstate(over="ignore"):
        assert same_bits(nearest(x), flushed(np.float32(x)))
    assert same_bits(toward_zero(x), cut(Fraction(x)))


@pytest.mark.slow
@pytest.mark.parametrize(("one", "many"), PAIRS_OF_CLASSES)
@settings(deadline=None, max_examples=120)
@given(pairs=PAIRS, q=st.integers(0, 30))
def test_one_number_equals_many(one: Any, many: Any, pairs: list[tuple[float, float]], q: int) -> None:
    one, many = one(), many()
    x, y = (np.array(column) for column in zip(*pairs, strict=True))
    a, b = many.operand(x), many.operand(y)
    assert a.dtype == np.float32
    operands = [(one.operand(p), one.operand(r)) for p, r in pairs]

    def check(found: Any, expected: list[Any]) -> None:
        assert np.asarray(found).dtype in (np.float32, np.int64, np.bool_)
        np.testing.assert_array_equal(found, expected)
        assert not np.signbit(np.asarray(found)[np.asarray(found) == 0]).any()

    check(a, [p for p, _ in operands])
    for name in ("add", "sub", "minimum", "maximum", "gt"):
        check(getattr(many, name)(a, b), [getattr(one, name)(p, r) for p, r in operands])
    for name in ("mpy", "rmpy", "div"):
        check(getattr(many, name)(a, b, q), [getattr(one, name)(p, r, q) for p, r in operands])
    for name in ("neg", "abs"):
        check(getattr(many, name)(a), [getattr(one, name)(p) for p, _ in operands])
    check(many.sqrt(a, q), [one.sqrt(p, q) for p, _ in operands])
    check(many.where(many.gt(a, b), a, b), [one.where(p > r, p, r) for p, r in operands])
    check(many.dot([a, b, b], [b, b, a], q), [one.dot([p, r, r], [r, r, p], q) for p, r in operands])
    check(many.clip(a, abs(b), -abs(b)), [one.clip(p, abs(r), -abs(r)) for p, r in operands])
    check(many.raw(a, q), [one.raw(p, q) for p, _ in operands])
    check(many.quantise(a, 30, q - 10), [one.quantise(p, 30, q - 10) for p, _ in operands])
    unit = many.operand(np.clip(np.nan_to_num(abs(x), posinf=1.0) / (1 + abs(np.nan_to_num(y))), 0, 1))
    check(many.curve(CURVE, unit), [one.curve(CURVE, p) for p in unit.tolist()])


@pytest.mark.parametrize(("one", "many"), PAIRS_OF_CLASSES)
@given(numbers=st.lists(st.integers(-(2**31), 2**31 - 1), min_size=1, max_size=10), q=st.integers(0, 30))
def test_whole_numbers_come_and_go_equally(one: Any, many: Any, numbers: list[int], q: int) -> None:
    one, many = one(), many()
    expected = [one.from_raw(n, q) for n in numbers]
    np.testing.assert_array_equal(many.from_raw(np.array(numbers), q), expected)
    for n, value in zip(numbers, expected, strict=True):
        if abs(n) <= 2**24:
            assert value == n / 2**q
            assert one.raw(value, q) == n
    table = [Constant(f"t[{i}]", float(n), 0) for i, n in enumerate([*sorted(numbers), 2**31 - 1])]
    found = many.locate(many.table("t", table), many.from_raw(np.array(numbers), 0))
    np.testing.assert_array_equal(found, [one.locate(one.table("t", table), one.from_raw(n, 0)) for n in numbers])
    assert many.table("t", table).dtype == np.float32


@settings(deadline=None, max_examples=300)
@given(st.builds(of_bits, st.integers(0, 0xFF7FFFFF)), st.builds(of_bits, st.integers(0, 0xFF7FFFFF)))
def test_quotient_is_within_two_steps_at_one(x: float, y: float) -> None:
    """3.5 half steps by the rounding errors of its operations, twice that when they cut; no over- or underflow here."""
    for ar, bound in ((ONE[0], 1.75), (ONE[1], 3.5)):
        a, b = ar.operand(x), ar.operand(y)
        if math.isinf(a) or not 0 < abs(b) < 2.0**125 or not 2.0**-125 < abs(a) / abs(b) < 2.0**127:
            continue
        error = abs(Fraction(ar.div(a, b, 0)) * Fraction(b) / Fraction(a) - 1)
        assert error < bound * EPS + EPS**1.5


def test_quotient_is_not_the_correctly_rounded_one() -> None:
    """Own model of the estimate, so the share says only that the algorithm is that of the target, not a division."""
    generator = np.random.Generator(np.random.PCG64(3))
    a, b = generator.uniform(1, 2, (2, 2000)).astype(np.float32)
    assert 0.3 < np.mean(Float32Batch().div(a, b, 0) != a / b) < 0.6


@pytest.mark.parametrize("ar", ONE)
def test_documented_special_cases_of_division_and_root(ar: Float32) -> None:
    assert ar.div(0.0, 0.0, 0) == INF
    assert ar.div(FLT_MAX, FLT_MAX, 0) == 0.0
    assert ar.div(FLT_MIN, FLT_MAX, 0) == 0.0
    assert ar.div(-3.0, 0.0, 0) == -INF
    assert ar.div(3.0, 0.0, 0) == INF
    assert ar.div(5.0, INF, 0) == 0.0
    assert ar.div(6.0, 2.0, 0) == 3.0
    assert ar.sqrt(-4.0, 20) == 0.0
    assert ar.sqrt(0.0, 20) == 0.0
    assert ar.counters == Counters()


@pytest.mark.parametrize("ar", ONE)
def test_denormals_minus_zero_and_not_a_number(ar: Float32) -> None:
    # As an input, as a product and as a difference.
    assert ar.mpy(ar.operand(1e-40), ar.operand(1e30), 0) == 0.0
    assert ar.mpy(2.0**-100, 2.0**-27, 0) == 0.0
    assert ar.sub(FLT_MIN * (1 + EPS), FLT_MIN) == 0.0
    for zero in (ar.operand(-0.0), ar.mpy(-1.0, 0.0, 0), ar.neg(0.0), ar.sub(1.0, 1.0), ar.add(-0.0, -0.0)):
        assert same_bits(zero, 0.0)
    assert ar.operand(math.nan) == ar.sub(INF, INF) == ar.mpy(0.0, -INF, 0) == INF


def test_just_below_the_smallest_normal() -> None:
    """Rounded it becomes that number, cut it is a denormal, so zero."""
    below = FLT_MIN * (1 - EPS / 2)
    for kind, expected in ((0, FLT_MIN), (1, 0.0)):
        one, many = PAIRS_OF_CLASSES[kind]
        assert one().operand(below) == many().operand(np.array([below]))[0] == expected


def test_overflow_is_infinite_when_rounded_and_the_largest_number_when_cut() -> None:
    assert [ar.mpy(-1e30, 1e30, 0) for ar in ONE] == [-INF, -FLT_MAX]
    assert [ar.add(FLT_MAX, FLT_MAX) for ar in ONE] == [INF, FLT_MAX]
    assert [ar.add(-INF, 1.0) for ar in ONE] == [-INF, -INF]


def test_a_sum_is_cut_as_if_it_were_exact() -> None:
    """The double of 1 - 2^-60 is 1, and cutting that would miss the borrow."""
    ar = Float32Truncated()
    assert ar.sub(1.0, 2.0**-60) == 1 - EPS / 2
    assert ar.add(-1.0, 2.0**-60) == -1 + EPS / 2
    assert ar.add(1.0, 2.0**-60) == 1.0
    np.testing.assert_array_equal(
        Float32TruncatedBatch().sub(np.float32([1, -1, 1]), np.float32([2.0**-60, -(2.0**-60), -(2.0**-60)])),
        [1 - EPS / 2, -1 + EPS / 2, 1.0],
    )


def test_a_sum_of_products_is_rounded_term_by_term_in_order() -> None:
    ar, a = Float32(), 1 + EPS
    # Fused, the second product would leave its low part 2^-46 behind.
    assert ar.dot([a, -1.0], [a, 1 + 2 * EPS], 0) == 0.0
    assert ar.dot([1.0, 1.0, 1.0], [2.0**24, 1.0, 1.0], 0) == 2.0**24
    assert ar.dot([1.0, 1.0, 1.0], [1.0, 1.0, 2.0**24], 0) == 2.0**24 + 2


@pytest.mark.parametrize("ar", ONE)
def test_quantise_is_nearest_with_ties_upward_and_exact(ar: Float32) -> None:
    assert ar.quantise(of_bits(0x3EFFFFFF), 19, 0) == 0.0
    assert [ar.quantise(x, 19, 0) for x in (0.5, 1.5, -0.5, -1.5, -1.25, 2.75)] == [1.0, 2.0, 0.0, -1.0, -1.0, 3.0]
    assert ar.quantise(8388609.0, 19, 0) == 8388609.0
    assert ar.quantise(INF, 19, 0) == INF
    assert all(ar.raw(ar.quantise(code / 256 + 0.0009, 19, 8), 8) == code for code in range(-1792, 1793))


@pytest.mark.parametrize("ar", ONE)
def test_raw_is_exact_for_multiples_and_saturates(ar: Float32) -> None:
    assert [ar.raw(n / 2**8, 8) for n in (8388609, -8388609, 16777215, -1792)] == [8388609, -8388609, 16777215, -1792]
    assert [ar.raw(x, 20) for x in (1e6, -1e6, INF, -INF)] == [2**31 - 1, -(2**31), 2**31 - 1, -(2**31)]


def test_constants_are_rounded_once_to_nearest_in_both_modes() -> None:
    constant = Constant("k", 0.7, 24)
    assert {ar.const(constant) for ar in ONE} == {0.699999988079071}
    assert Float32Batch().const(constant) == Float32TruncatedBatch().const(constant) == np.float32(0.7)
    assert rounding_error(constant) == 0.699999988079071 - 0.7
    assert rounding_error(Constant("k", 0.75, 24)) == 0.0


def test_curve_is_a_straight_line_between_its_samples() -> None:
    for ar, tolerance in ((ONE[0], 1.5), (ONE[1], 3)):
        for i in (0, 1, 100, 255, 256):
            assert ar.curve(CURVE, i / 256) == nearest(CURVE.samples[i].value)
        left, right = (CURVE.samples[i].value for i in (40, 41))
        assert ar.curve(CURVE, 40.25 / 256) == pytest.approx(0.75 * left + 0.25 * right, abs=tolerance * EPS)


def test_names_and_kind() -> None:
    for name, one, many in (
        ("float32", Float32, Float32Batch),
        ("float32-truncated", Float32Truncated, Float32TruncatedBatch),
    ):
        assert type(make(name)) is one
        assert type(make(name, batch=True)) is many
        assert one.name == many.name == name
        assert one.wide is many.wide is True
