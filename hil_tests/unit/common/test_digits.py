"""Rounded text says the same as the number."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.common.digits import count_of, percent, text_beside_limit

NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)


@given(value=NUMBERS, limit=NUMBERS, digits=st.integers(0, 4), kind=st.sampled_from("fg"))
def test_the_text_is_on_the_side_of_the_value(value: float, limit: float, digits: int, kind: str) -> None:
    shown = float(text_beside_limit(value, limit, digits, kind=kind))
    assert (shown > limit, shown < limit) == (value > limit, value < limit)


@pytest.mark.parametrize(
    ("value", "limit", "sign", "text"),
    [
        (0.30004, 0.3, "+", "+0.30004"),
        (-0.30004, 0.3, "+", "-0.30004"),
        (-0.29996, 0.3, "+", "-0.29996"),
        (0.3, 0.3, "+", "+0.300"),
        (4.0, 3.0, "", "4.000"),
        (1e-20, 0.0, "", "9.9999999999999995e-21"),
    ],
)
def test_no_more_digits_than_it_takes(value: float, limit: float, sign: str, text: str) -> None:
    assert text_beside_limit(value, limit, 3, sign) == text


@given(runs=st.integers(1, 10_000_000), data=st.data())
def test_a_hundred_per_cent_are_all_runs(runs: int, data: st.DataObject) -> None:
    hits = data.draw(st.integers(0, runs))
    shown = float(percent(hits / runs).removesuffix("%"))
    assert (shown == 100.0, shown == 0.0) == (hits == runs, hits == 0)


def test_shares_with_two_decimals_where_they_suffice() -> None:
    assert [percent(one) for one in (20_000 / 20_001, 0.5, 1.0, 0.0, 1e-5)] == [
        "99.995%",
        "50.00%",
        "100.00%",
        "0.00%",
        "0.001%",
    ]


def test_one_of_a_thing_is_singular() -> None:
    assert [count_of(count, "entry", "entries") for count in (0, 1, 2)] == ["0 entries", "1 entry", "2 entries"]
    assert count_of(1, "run") == "1 run"
    assert count_of(12_000, "run", spec=",") == "12,000 runs"
