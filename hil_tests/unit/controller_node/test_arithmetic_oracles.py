"""IQ fixed point against independent results: apytypes, fractions, and 80 decimal digits, for Q1 to Q30."""

from __future__ import annotations

import math
import struct
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from apytypes import APyFixed, OverflowMode, QuantizationMode
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.exact import FORMATS, PI, limited, nearest, rounded, sine, spread, with_many_digits
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, SATURATION, WRAP
from railhil.controller_node.arithmetic.iq import C28, C28Batch, Portable, portable_functions, series

INT32 = st.integers(INT32_MIN, INT32_MAX)
Q = st.integers(1, 30)


@pytest.fixture(autouse=True)
def _digits() -> None:
    with_many_digits()


@pytest.mark.parametrize(
    ("operation", "quantization", "overflow"),
    [
        ("mpy", QuantizationMode.TRN, OverflowMode.WRAP),
        ("rmpy", QuantizationMode.RND, OverflowMode.WRAP),
        ("rsmpy", QuantizationMode.RND, OverflowMode.SAT),
    ],
)
def test_products_are_those_of_apytypes(operation: str, quantization: QuantizationMode, overflow: OverflowMode) -> None:
    for q in FORMATS:
        ar = C28()
        # The first pair overflows in every format.
        for a, b in [(INT32_MAX, INT32_MAX), *zip(spread(q), spread(-q)[::-1], strict=True)]:
            left, right = (APyFixed(x & 0xFFFFFFFF, int_bits=32 - q, frac_bits=q) for x in (a, b))
            bits = (
                (left * right)
                .cast(int_bits=32 - q, frac_bits=q, quantization=quantization, overflow=overflow)
                .to_bits()
            )
            assert getattr(ar, operation)(a, b, q) == (bits + 2**31) % 2**32 - 2**31
        assert ar.counters.wraps + ar.counters.saturations > 0


@settings(max_examples=300)
@given(INT32, INT32.filter(bool), Q)
def test_quotient_is_the_rounded_fraction(a: int, b: int, q: int) -> None:
    ar = C28()
    exact = Fraction(a << q, b)
    assert ar.div(a, b, q) == nearest(exact)
    assert ar.counters.saturations == (not INT32_MIN <= math.floor(exact + Fraction(1, 2)) <= INT32_MAX)


@settings(max_examples=300)
@given(INT32, INT32.filter(bool), Q)
def test_portable_quotient_is_within_two(a: int, b: int, q: int) -> None:
    assert abs(Portable().div(a, b, q) - nearest(Fraction(a << q, b))) <= 2


def test_portable_quotient_of_the_smallest_number_is_not_the_librarys_fault() -> None:
    # The library answers INT32_MIN and INT32_MAX here.
    assert Portable().div(INT32_MIN, 3 << 20, 20) == pytest.approx(INT32_MIN / 3, abs=2)
    assert Portable().div(INT32_MIN, -5 << 20, 20) == pytest.approx(-INT32_MIN / 5, abs=2)


def is_root(root: int, square: Fraction) -> bool:
    """Is ``root`` the number next to the root of ``square``?"""
    return max(2 * root - 1, 0) ** 2 <= 4 * square <= (2 * root + 1) ** 2


def test_roots_lie_between_the_squares_of_their_neighbours() -> None:
    for q in FORMATS:
        ar, portable = C28(), Portable()
        for a, b in zip(spread(q + 100), spread(q + 200)[::-1], strict=True):
            mag = ar.mag(a, b, q)
            assert mag == INT32_MAX or is_root(mag, Fraction(a * a + b * b))
            assert abs(portable.mag(a, b, q) - mag) <= 2
            if a <= 0:
                assert [ar.sqrt(a, q), ar.isqrt(a, q), portable.sqrt(a, q), portable.isqrt(a, q)] == [0] * 4
                continue
            root = ar.sqrt(a, q)
            assert is_root(root, Fraction(a << q))
            assert abs(portable.sqrt(a, q) - root) <= 1
            inverse, square = ar.isqrt(a, q), Fraction(1 << (3 * q), a)
            assert inverse == INT32_MAX if square > INT32_MAX**2 else is_root(inverse, square)
            # Two Newton steps up to Q23, three from Q24 on.
            assert -(1 if q > 23 else 25) <= portable.isqrt(a, q) - inverse <= 1
        assert ar.mag(INT32_MIN, INT32_MIN, q) == INT32_MAX


def test_exponential() -> None:
    for q in FORMATS:
        ar, portable = C28(), Portable()
        smallest, largest = series.exp_range(q)
        assert rounded((Decimal(largest) / 2**q).exp(), q) <= INT32_MAX
        assert (Decimal(largest + 1) / 2**q).exp() * 2**q > INT32_MAX
        assert (Decimal(smallest) / 2**q).exp() * 2**q >= 1
        assert smallest == INT32_MIN or (Decimal(smallest - 1) / 2**q).exp() * 2**q < 1
        near = spread(q, 12) + [largest, largest + 1, -q << q] + [int(x * largest / 8) for x in range(-8, 8)]
        near += [smallest - 1, smallest, smallest + 1]
        for a in map(limited, near):
            value = rounded((Decimal(min(max(a, smallest), largest)) / 2**q).exp(), q)
            assert ar.exp(a, q) == value
            assert abs(portable.exp(a, q) - (value if a <= largest else INT32_MAX)) <= 3
        assert ar.counters.saturations == sum(limited(a) > largest for a in near)


def test_logarithm() -> None:
    for q in FORMATS:
        ar, portable = C28(), Portable()
        assert ar.log(1 << q, q) == 0
        for a in spread(q):
            if a <= 0:
                assert ar.log(a, q) == INT32_MIN
                assert portable.log(a, q) == 0
                continue
            value = rounded((Decimal(a) / 2**q).ln(), q)
            assert ar.log(a, q) == limited(value)
            assert abs(portable.log(a, q) - limited(value)) <= (8 if q >= 29 else 3)


def test_sine_and_cosine() -> None:
    for q in FORMATS:
        ar, portable = C28(), Portable()
        quarter = PI / 2
        eighths = [k << q >> 3 for k in range(-9, 10) if abs(k << q >> 3) <= INT32_MAX]
        for a in [*spread(q, 12), *eighths]:
            angle = Decimal(a) / 2**q
            turn = sine(2 * PI * angle), sine(2 * PI * angle + quarter)
            assert (ar.sin_pu(a, q), ar.cos_pu(a, q)) == tuple(rounded(value, q) for value in turn)
            assert abs(portable.sin_pu(a, q) - ar.sin_pu(a, q)) <= 4
            assert abs(portable.cos_pu(a, q) - ar.cos_pu(a, q)) <= 4
            if q < 30:
                assert (ar.sin(a, q), ar.cos(a, q)) == (rounded(sine(angle), q), rounded(sine(angle + quarter), q))
                assert abs(portable.sin(a, q) - ar.sin(a, q)) <= 2
                assert abs(portable.cos(a, q) - ar.cos(a, q)) <= 2
        assert (ar.sin_pu(0, q), ar.cos_pu(0, q)) == (0, 1 << q)


@settings(max_examples=200)
@given(INT32.filter(lambda a: a > INT32_MIN), INT32.filter(lambda a: a > INT32_MIN), Q)
def test_whole_and_broken_parts(a: int, n: int, q: int) -> None:
    ar, portable = C28(), Portable()
    value, product = Fraction(a, 1 << q), Fraction(a * n, 1 << q)
    assert ar.int_part(a, q) == math.trunc(value)
    assert portable.int_part(a, q) == math.floor(value)
    for profile in (ar, portable):
        assert (profile.int_part(a, q) << q) + profile.frac(a, q) == a
    # The sign is put on the low 32 bits of the size, saturating.
    whole = (math.trunc(abs(product)) + 2**31) % 2**32 - 2**31
    assert ar.mpy_i32_int(a, n, q) == (whole if product >= 0 else limited(-whole))
    assert ar.mpy_i32_frac(a, n, q) == (product - math.trunc(product)) * 2**q
    wrapped = (a * n + 2**31) % 2**32 - 2**31
    assert portable.mpy_i32_int(a, n, q) == math.floor(Fraction(wrapped, 1 << q))
    assert (portable.mpy_i32_int(a, n, q) << q) + portable.mpy_i32_frac(a, n, q) == wrapped


@pytest.mark.parametrize(("a", "n"), [(INT32_MAX, -INT32_MAX), (-65536, 65536), (65536, -65536)])
def test_the_sign_of_a_wrapped_integer_part_saturates(a: int, n: int) -> None:
    """NEGTC with OVM set: 0x80000000 with a negative sign is 0x7fffffff."""
    one, many = C28(), C28Batch()
    assert one.mpy_i32_int(a, n, 1) == INT32_MAX
    assert many.mpy_i32_int(np.array([a]), np.array([n]), 1).tolist() == [INT32_MAX]
    assert one.mpy_i32_int(-a, n, 1) == INT32_MIN
    assert one.counters.flags == many.counters.flags == WRAP | SATURATION


def single(bits: int) -> np.float32:
    return np.float32(struct.unpack("<f", struct.pack("<I", bits))[0])


@settings(max_examples=200)
@given(st.one_of(INT32, st.integers(0, 31).map(lambda k: -1 << k)).filter(bool), Q)
def test_float_of_a_number(a: int, q: int) -> None:
    value = Fraction(a, 1 << q)
    cut = single(C28().to_f(a, q))
    size, above = Fraction(float(abs(cut))), Fraction(float(np.nextafter(abs(cut), np.float32(np.inf))))
    # Cut; a negative number is one bit less before it is cut, so never exact.
    assert size <= value < above if a > 0 else size < -value <= above
    assert (cut < 0) == (a < 0)
    # Only ties may differ from rounding to nearest even.
    rounded_up = single(Portable().to_f(a, q))
    halves = Fraction(float(abs(rounded_up))) - abs(value)
    down = Fraction(float(abs(rounded_up))) - Fraction(float(np.nextafter(abs(rounded_up), np.float32(0))))
    assert -down < halves <= down / 2 if halves > 0 else abs(halves) < down
    assert rounded_up == np.float32(float(value)) or 2 * halves == down
    assert Portable().to_f(0, q) == C28().to_f(0, q) == 0


@pytest.mark.parametrize("value", [128.0, -128.1, 1e308, -1e308, float("nan"), float("inf")])
def test_macro_refuses_what_is_undefined_on_the_target(value: float) -> None:
    for q in (24, 30):
        with pytest.raises(ValueError, match="outside int32"):
            C28().from_float(value, q)
    with pytest.raises(ValueError, match="outside int32"):
        C28Batch().from_float(np.array([0.0, value]), 30)


def test_macro_takes_all_that_fits_and_no_more() -> None:
    for q in FORMATS:
        top, bottom = math.ldexp(INT32_MAX + 0.75, -q), math.ldexp(INT32_MIN - 0.75, -q)
        assert (C28().from_float(top, q), C28().from_float(bottom, q)) == (INT32_MAX, INT32_MIN)
        for value in (math.ldexp(INT32_MAX + 1, -q), math.ldexp(INT32_MIN - 1, -q)):
            with pytest.raises(ValueError, match="outside int32"):
                C28().from_float(value, q)


@settings(max_examples=200)
@given(st.decimals(-300, 300, places=7), Q)
def test_number_of_a_text(value: Decimal, q: int) -> None:
    text = f"{value:f}"
    exact = Fraction(value) * 2**q
    c28 = limited(round_half_away(exact))
    assert C28().ato_iq(text, q) == c28
    # Tenths in 31 bits: an error of some 2^-29 of the fraction, in LSB, plus the rounding.
    if abs(exact) < INT32_MAX:
        assert abs(Portable().ato_iq(text, q) - c28) <= 1 + (1 << max(q - 29, 0))


def round_half_away(exact: Fraction) -> int:
    size = math.floor(abs(exact) + Fraction(1, 2))
    return size if exact >= 0 else -size


def test_texts_of_any_length() -> None:
    """More digits than Python makes a number of, and digits that decide a rounding late."""
    for q in FORMATS:
        for profile in (C28(), C28Batch(), Portable()):
            assert profile.ato_iq("9" * 5000, q) == INT32_MAX
            assert profile.ato_iq("-" + "9" * 5000 + "." + "9" * 5000, q) == INT32_MIN
            assert profile.ato_iq("9" * 11 + ".0", q) == INT32_MAX
            assert profile.counters.saturations == 3
        half = f"{Decimal(1) / 2 ** (q + 1):f}"
        ar = C28()
        assert ar.ato_iq(half + "0" * 5000, q) == 1
        assert ar.ato_iq(half[:-1] + "4" + "9" * 5000, q) == 0
        assert ar.ato_iq("-" + "0" * 5000 + half, q) == -1
        assert ar.ato_iq("0." + "9" * 5000, q) == 1 << q
        assert ar.counters.saturations == 0


def test_texts_that_are_special() -> None:
    c28, portable = C28(), Portable()
    assert (c28.ato_iq("-5", 20), portable.ato_iq("-5", 20)) == (-5 << 20, 5 << 20)
    for text in ("1e3", "+1", " 1", "1.5x", "x"):
        assert (c28.ato_iq(text, 20), portable.ato_iq(text, 20)) == (0, 0)
    for text, limit in (("9999999", INT32_MAX), ("-9999999.0", INT32_MIN)):
        assert (c28.ato_iq(text, 20), portable.ato_iq(text, 20)) == (limit, limit)
    assert c28.counters.saturations == portable.counters.saturations == 2
    assert c28.to_a("%5.4f", -(3 << 19), 20) == (0, "-1.500")
    assert portable.to_a("%5.4f", -(3 << 19), 20) == (0, "-00001.5000")
    assert c28.to_a("%3.0f", 7 << 20, 20) == (0, "7")
    assert portable.to_a("%3.f", 7 << 20, 20) == (0, "007")
    assert (c28.to_a("%5.1f", INT32_MIN, 20), portable.to_a("%5.1f", INT32_MIN, 20)) == ((1, None), (0, "-02048.0"))
    for profile in (c28, portable):
        assert profile.to_a("%1.2f", 10 << 20, 20) == (1, None)
        for form in ("5.2f", "%5f", "%12.2f", "%5.2d", "%5.123f", "%x.2f", "%5.2f "):
            assert profile.to_a(form, 1, 20) == (2, None)


@settings(max_examples=100)
@given(INT32, Q, st.integers(1, 12))
def test_text_of_a_number_is_cut(a: int, q: int, digits: int) -> None:
    error, text = Portable().to_a(f"%11.{digits}F", a, q)
    assert error == 0
    assert 0 <= abs(Fraction(a, 1 << q)) - abs(Fraction(text)) < Fraction(1, 10**digits)
    assert len(text) == 11 + 1 + digits + (a < 0)


def test_an_undecided_rounding_is_computed_again_with_more_bits() -> None:
    attempts = []

    def close_to_a_half(bits: int) -> int:
        attempts.append(bits)
        # 2.5 - 2^-100: seen as 2 only with more than 100 bits.
        return (5 << (bits - 1)) - (1 << bits >> 100)

    assert series.nearest(close_to_a_half) == 2
    assert attempts == [64, 128]


def test_tables_of_the_portable_profile() -> None:
    # Newton steps hide a wrong guess, and a wrong last coefficient shows in few numbers only.
    assert len(portable_functions.RECIPROCAL) == 65
    for i, guess in enumerate(portable_functions.RECIPROCAL):
        assert abs(guess - Fraction(16384, 129 + 2 * i)) <= Fraction(1, 2)
    assert [hex(x) for x in portable_functions._EXP[:3]] == ["0x127", "0xb93", "0x6806"]
    assert portable_functions._EXP[-2:] == (2**30, 2**30)
    cut = [math.trunc(Fraction((-1) ** (k + 1) * 2**30, k)) for k in range(13, 0, -1)]
    assert (-(2**30 // 14) - 1, *cut, 0) == portable_functions._LN


@pytest.mark.parametrize("q", range(25, 31))
def test_smallest_logarithm_of_the_portable_profile(q: int) -> None:
    last = portable_functions.ln_out_of_range(q)
    lowest = -(Decimal(2) ** (31 - q))
    if last:
        assert (Decimal(last - 1) / 2**q).ln() < lowest < (Decimal(last) / 2**q).ln()
        assert Portable().log(last, q) == INT32_MIN < Portable().log(last + 1, q)
    else:
        assert (Decimal(1) / 2**q).ln() > lowest
