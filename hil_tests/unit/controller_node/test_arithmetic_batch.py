"""Both IQ profiles: one train and many give equal bits, counts and events, for every function and format."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP, Counters
from railhil.controller_node.arithmetic.iq import C28, C28Batch, Portable, PortableBatch

PROFILES = {"c28": (C28, C28Batch), "portable": (Portable, PortableBatch)}
EDGES = [-(2**31), -(2**31) + 1, -(2**30), -3, -1, 0, 1, 2, 2**16, 2**24 - 1, 2**30, 2**31 - 1]
INT32 = st.one_of(st.integers(-(2**31), 2**31 - 1), st.sampled_from(EDGES), st.integers(0, 30).map(lambda k: 1 << k))
TRIPLES = st.lists(st.tuples(INT32, INT32, INT32), min_size=1, max_size=12)
Q = st.integers(1, 30)

#: Name -> call with an arithmetic, three operands (numbers or arrays) and Q.
Call = Callable[[Any, Any, Any, Any, int], Any]
OPERATIONS: dict[str, Call] = {
    **{
        name: lambda ar, a, b, c, q, name=name: getattr(ar, name)(a, b)  # type: ignore[misc]
        for name in ("add", "sub", "sadd", "ssub", "minimum", "maximum", "gt", "mpy_i32")
    },
    **{
        name: lambda ar, a, b, c, q, name=name: getattr(ar, name)(a, b, q)  # type: ignore[misc]
        for name in ("mpy", "rmpy", "rsmpy", "div", "mag", "mpy_i32_int", "mpy_i32_frac", "atan2_pu")
    },
    **{
        name: lambda ar, a, b, c, q, name=name: getattr(ar, name)(a, q)  # type: ignore[misc]
        for name in ("int_part", "frac", "sqrt", "isqrt", "exp", "log", "sin_pu", "cos_pu", "to_f")
    },
    **{
        name: lambda ar, a, b, c, q, name=name: getattr(ar, name)(a, min(q, 29))  # type: ignore[misc]
        for name in ("sin", "cos", "asin", "acos")
    },
    "atan2": lambda ar, a, b, c, q: ar.atan2(a, b, min(q, 29)),
    **{name: lambda ar, a, b, c, q, name=name: getattr(ar, name)(a) for name in ("neg", "abs")},  # type: ignore[misc]
    # Also with limits the wrong way round.
    **{
        name: lambda ar, a, b, c, q, name=name: getattr(ar, name)(a, b, c)  # type: ignore[misc]
        for name in ("sat", "clip")
    },
    "shl": lambda ar, a, b, c, q: ar.shl(a, q),
    "shr": lambda ar, a, b, c, q: ar.shr(a, q),
    "convert": lambda ar, a, b, c, q: ar.convert(a, q, 31 - q),
    "quantise": lambda ar, a, b, c, q: ar.quantise(a, q, 0),
    "mpy_iqx": lambda ar, a, b, c, q: ar.mpy_iqx(a, q, b, 31 - q, 20),
    "mpy_iqx_left": lambda ar, a, b, c, q: ar.mpy_iqx(a, 1, b, 2, q),
    "dot": lambda ar, a, b, c, q: ar.dot([a, b, c], [b, c, a], q),
    "where": lambda ar, a, b, c, q: ar.where(ar.gt(a, b), b, c),
    "from_float": lambda ar, a, b, c, q: ar.from_float(a / 2.0**q, q),
}


def summed(events: list[tuple[int, int, int]]) -> Counter[tuple[int, int]]:
    """Events by (quantities noted before, kind)."""
    total: Counter[tuple[int, int]] = Counter()
    for place, kind, count in events:
        total[place, kind] += count
    return total


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("operation", OPERATIONS)
@settings(deadline=None, max_examples=10)
@given(triples=TRIPLES, q=Q)
def test_one_train_equals_many(profile: str, operation: str, triples: list[tuple[int, int, int]], q: int) -> None:
    one, many = (make() for make in PROFILES[profile])
    one.noted, many.noted = [], []
    call = OPERATIONS[operation]
    result = call(many, *(np.array(column) for column in zip(*triples, strict=True)), q)
    assert result.shape == (len(triples),)
    assert result.tolist() == [call(one, *triple, q) for triple in triples]
    assert one.counters == many.counters
    assert summed(one.events) == summed(many.events)


@pytest.mark.parametrize("profile", PROFILES)
def test_edges_in_every_format(profile: str) -> None:
    for operation in OPERATIONS:
        one, many = (make() for make in PROFILES[profile])
        call = OPERATIONS[operation]
        # Neighbours in the list and the opposite end: signs, sizes and INT32_MIN meet each other.
        triples = list(zip(EDGES, EDGES[1:] + EDGES[:1], EDGES[::-1], strict=True))
        columns = [np.array(column) for column in zip(*triples, strict=True)]
        for q in range(1, 31):
            assert call(many, *columns, q).tolist() == [call(one, *triple, q) for triple in triples]
        assert one.counters == many.counters


@pytest.mark.parametrize("profile", PROFILES)
def test_numbers_common_to_all_trains(profile: str) -> None:
    one, many = (make() for make in PROFILES[profile])
    a = np.array([-7, 9, 2**30])
    for operation in ("mpy", "rmpy", "div", "mag"):
        expected = [getattr(one, operation)(x, -3 << 18, 20) for x in a.tolist()]
        assert getattr(many, operation)(a, -3 << 18, 20).tolist() == expected
    assert many.sat(a, 5, -5).tolist() == [-5, 5, 5]
    assert many.counters.saturations == 3


@pytest.mark.parametrize("profile", PROFILES)
def test_counters_and_events(profile: str) -> None:
    for make in PROFILES[profile]:
        ar: Any = make()
        ar.add(2**30, -(2**30))
        assert ar.counters == Counters()
        assert ar.add(2**31 - 1, 1) == -(2**31)
        assert ar.counters.flags == WRAP
        # Nobody watches: nothing is kept.
        assert ar.events == []
        ar.noted = []
        assert ar.rsmpy(2**31 - 1, 2**31 - 1, 1) == 2**31 - 1
        ar.note("first", 1, 20)
        assert ar.div(-5, 0, 20) == 2**31 - 1
        assert ar.clip(9, 5, 0) == 5
        assert ar.where(ar.gt(1, 2), 3, 4) == 4
        ar.note_all("more", [1, 2], 20)
        assert ar.neg(-(2**31)) == -(2**31)
        assert ar.abs(-(2**31)) == -(2**31)
        assert ar.sat(-9, 5, -5) == -5
        assert ar.counters == Counters(wraps=3, saturations=2, zero_divisions=1)
        assert ar.events == [
            (0, SATURATION, 1),
            (1, DIVISION_BY_ZERO, 1),
            (3, WRAP, 1),
            (3, WRAP, 1),
            (3, SATURATION, 1),
        ]


def test_an_event_of_many_trains_counts_them() -> None:
    many: Any = C28Batch()
    many.noted = []
    many.add(np.array([2**31 - 1, 5, 2**31 - 2]), np.array([1, 1, 2]))
    many.note("sum", np.zeros(3), 20)
    many.log(np.array([-1, 2**24, 0]), 24)
    assert many.events == [(0, WRAP, 2), (1, SATURATION, 2)]


@pytest.mark.parametrize(("profile", "expected"), [("c28", -5), ("portable", -7)])
def test_limits_the_wrong_way_round(profile: str, expected: int) -> None:
    # C28x: max(min(a, upper), lower). Portable: the upper limit is looked at first.
    for make in PROFILES[profile]:
        ar: Any = make()
        assert ar.clip(3, -7, -5) == expected
        assert ar.sat(3, -7, -5) == expected


@pytest.mark.parametrize("profile", PROFILES)
def test_texts_of_many(profile: str) -> None:
    one, many = (make() for make in PROFILES[profile])
    texts = ["1.5", "-0.25", "x", "99999", "-99999.5", "", "-", "3.", "-.5"]
    assert many.ato_iq(texts, 24).tolist() == [one.ato_iq(text, 24) for text in texts]
    assert one.counters == many.counters == Counters(saturations=2)
    numbers = np.array([5 << 20, -(3 << 20) - 77, -(2**31)])
    assert many.to_a("%5.4f", numbers, 20) == [one.to_a("%5.4f", a, 20) for a in numbers.tolist()]


def test_trigonometry_in_rad_ends_at_q29() -> None:
    for make in (*PROFILES["c28"], *PROFILES["portable"]):
        for function in ("sin", "cos"):
            with pytest.raises(ValueError, match="not for Q30"):
                getattr(make(), function)(np.array([1]) if "Batch" in make.__name__ else 1, 30)


@pytest.mark.parametrize("profile", PROFILES)
def test_each_limit_is_counted_once(profile: str) -> None:
    ar: Any = PROFILES[profile][0]()
    calls = [
        (ar.div(2**30, 1, 20), 2**31 - 1),
        (ar.isqrt(1, 30), 2**31 - 1),
        (ar.mag(-(2**31), 2**31 - 1, 16), 2**31 - 1),
        (ar.sadd(2**31 - 1, 1), 2**31 - 1),
        (ar.ssub(-(2**31), 1), -(2**31)),
        (ar.log(1, 30), -(2**31)),
        (ar.ato_iq("3000000000.5", 4), 2**31 - 1),
    ]
    assert [result for result, _ in calls] == [limit for _, limit in calls]
    assert ar.counters == Counters(saturations=len(calls))
    ar.exp(2**31 - 1, 16)
    assert ar.counters == Counters(saturations=len(calls) + 1)
