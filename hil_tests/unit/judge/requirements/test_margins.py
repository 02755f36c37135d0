"""The operators give what their definition gives when it is written out tick by tick."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest

from railhil.judge.requirements.robustness import (
    LEAST,
    all_of,
    any_of,
    begins,
    ceases,
    compared,
    unless,
    window_max,
    window_min,
)
from railhil.record.trace import FloatArray

#: Margins of a few values, so that equal ones and changes of sign are frequent; NaN: not known.
VALUES = np.array([-3.0, -1.0, -LEAST, LEAST, 0.5, 2.0, math.nan])
CASES = 400


def row(*values: float) -> FloatArray:
    return np.array(values, dtype=np.float64)


def cases(count: int = CASES) -> Iterator[tuple[np.random.Generator, FloatArray]]:
    """Margins of short records, and the draws that made them."""
    draws = np.random.default_rng(39)
    for _ in range(count):
        yield draws, draws.choice(VALUES, draws.integers(1, 50))


def test_a_window_has_the_largest_and_the_smallest_of_its_ticks() -> None:
    for draws, margins in cases():
        first, length = draws.integers(0, 12), draws.integers(0, 70)
        beyond, last = draws.choice([-math.inf, math.inf]), first + length
        padded = [*margins.tolist(), *[beyond] * (last + 1)]
        windows = [
            [one for one in padded[tick + first : tick + last + 1] if one == one] for tick in range(len(margins))
        ]
        assert window_max(margins, first, last, beyond).tolist() == [max(one, default=-math.inf) for one in windows]
        assert window_min(margins, first, last, beyond).tolist() == [min(one, default=math.inf) for one in windows]


def test_a_condition_holds_from_a_tick_until_the_release() -> None:
    for draws, margins in cases():
        released = draws.random(len(margins)) < draws.choice([0.0, 0.1, 0.5])
        wanted = []
        for tick in range(len(margins)):
            ends = np.flatnonzero(released[tick:])
            part = margins[tick : tick + ends[0] if len(ends) else None].tolist()
            wanted.append(min((one for one in part if one == one), default=math.nan if part else math.inf))
        np.testing.assert_array_equal(unless(margins, released), wanted)


@pytest.mark.parametrize(("left", "right"), list(product(VALUES.tolist(), VALUES.tolist())))
def test_and_and_or_know_what_one_side_decides(left: float, right: float) -> None:
    both, either = float(all_of(row(left), row(right))[0]), float(any_of(row(left), row(right))[0])
    known = [value for value in (left, right) if not math.isnan(value)]
    if len(known) == 2:
        assert (both, either) == (min(known), max(known))
        return
    assert both == known[0] if known and known[0] < 0 else math.isnan(both)
    assert either == known[0] if known and known[0] > 0 else math.isnan(either)


def test_begin_and_end_are_the_changes_of_what_holds() -> None:
    for _, margins in cases(100):
        for tick, value in enumerate(margins):
            before = margins[tick - 1] if tick else math.nan
            assert begins(margins)[tick] == (value > 0 and not before > 0)
            assert ceases(margins)[tick] == (value < 0 and before > 0)


@pytest.mark.parametrize(
    ("sign", "below", "equal", "above"),
    [("<", 1, 0, -1), ("<=", 1, 0, -1), (">", -1, 0, 1), (">=", -1, 0, 1), ("=", -1, 0, -1), ("!=", 1, 0, 1)],
)
def test_a_comparison_at_its_limit_has_a_truth_and_no_size(sign: str, below: float, equal: float, above: float) -> None:
    found = compared(sign, row(1.0, 2.0, 3.0, math.nan), np.full(4, 2.0), 1e-9)
    assert np.where(np.abs(found) <= LEAST, 0.0, found)[:3].tolist() == [below, equal, above]
    assert (found[1] > 0) == (sign in ("<=", ">=", "="))
    assert math.isnan(found[3])


def test_values_that_are_equal_on_the_wire_are_equal() -> None:
    # 531 steps of 0.1 mm: above 0.0531 as binary fractions are computed.
    position_m = row(250.0531) - 250.0
    assert position_m[0] > 0.0531
    assert compared(">", position_m, row(0.0531), 1e-7)[0] == -LEAST
