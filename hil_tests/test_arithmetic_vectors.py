"""C28x fixed point against vectors made with TI's IQmath library, one by one and as arrays."""

from __future__ import annotations

import gzip
import json
import struct
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from controller_node.arithmetic.iq import Iq, IqBatch, iq_macro

DATA = Path(__file__).parent / "data" / "iq"

#: Function of the vectors -> file, number of cases, call on an arithmetic: (arithmetic, q, inputs) -> result.
Call = Callable[[Any, int, Any], Any]
FUNCTIONS: dict[str, tuple[str, int, Call]] = {
    "mpy": ("mul", 1204, lambda ar, q, i: ar.mpy(i[0], i[1], q)),
    "rmpy": ("mul", 1171, lambda ar, q, i: ar.rmpy(i[0], i[1], q)),
    "rsmpy": ("mul", 1204, lambda ar, q, i: ar.rsmpy(i[0], i[1], q)),
    "add": ("basic", 332, lambda ar, q, i: ar.add(i[0], i[1])),
    "sub": ("basic", 315, lambda ar, q, i: ar.sub(i[0], i[1])),
    "sat": ("basic", 437, lambda ar, q, i: ar.sat(i[0], i[1], i[2])),
    "abs": ("basic", 298, lambda ar, q, i: ar.abs(i[0])),
    "div": ("div", 1461, lambda ar, q, i: ar.div(i[0], i[1], q)),
}
#: Functions whose format or count is an input: they are called row by row on both classes.
BY_ROW: dict[str, tuple[str, int, Call]] = {
    "mpyIQX": ("mul", 599, lambda ar, q, i: ar.mpy_iqx(i[0], int(i[1]), i[2], int(i[3]), q)),
    "shr": ("basic", 285, lambda ar, q, i: ar.shr(i[0], int(i[1]))),
    "shl": ("basic", 289, lambda ar, q, i: ar.shl(i[0], int(i[1]))),
}
EVERY = FUNCTIONS | BY_ROW


@lru_cache
def rows(file: str) -> list[dict[str, Any]]:
    with gzip.open(DATA / f"{file}.jsonl.gz", "rt") as lines:
        return [json.loads(line) for line in lines]


def cases(function: str) -> list[dict[str, Any]]:
    return [row for row in rows(EVERY[function][0]) if row["f"] == function]


def expected(row: dict[str, Any]) -> int:
    """Result on the C28x: where it is determined, else the exact one rounded, else that of the C library."""
    return int(row.get("c", row.get("r", row["o"])))


def mismatches(arithmetic: Any, function: str) -> int:
    call = EVERY[function][2]
    return sum(int(call(arithmetic, row["q"], row["i"])) != expected(row) for row in cases(function))


@pytest.mark.parametrize("function", EVERY)
def test_every_vector_is_met_exactly(function: str) -> None:
    assert len(cases(function)) == EVERY[function][1]
    assert mismatches(Iq(), function) == 0


@pytest.mark.parametrize("function", FUNCTIONS)
def test_arrays_give_the_same_results_and_counts(function: str) -> None:
    call, one, many = FUNCTIONS[function][2], Iq(), IqBatch()
    for q in sorted({row["q"] for row in cases(function)}):
        group = [row for row in cases(function) if row["q"] == q]
        inputs = [np.array(column) for column in zip(*(row["i"] for row in group), strict=True)]
        result = call(many, q, inputs)
        assert result.dtype == np.int64
        np.testing.assert_array_equal(result, [call(one, q, row["i"]) for row in group])
    assert one.counters == many.counters


@pytest.mark.parametrize("function", BY_ROW)
def test_arrays_of_one_give_the_same_results_and_counts(function: str) -> None:
    call, one, many = BY_ROW[function][2], Iq(), IqBatch()
    for row in cases(function):
        inputs = [np.array([value]) for value in row["i"]]
        assert call(many, row["q"], [inputs[0], row["i"][1], *inputs[2:3], *row["i"][3:]])[0] == expected(row)
        call(one, row["q"], row["i"])
    assert one.counters == many.counters


@pytest.mark.parametrize(("function", "layout", "integer"), [("IQd", "<d", "<Q"), ("IQf", "<f", "<I")])
def test_macro_truncates_toward_zero(function: str, layout: str, integer: str) -> None:
    group = [row for row in rows("conv") if row["f"] == function]
    assert len(group) > 400
    for row in group:
        value = struct.unpack(layout, struct.pack(integer, row["i"][0]))[0]
        assert iq_macro(value, row["q"]) == expected(row)


@pytest.mark.parametrize("value", [128.0, -128.1, float("nan"), float("inf")])
def test_macro_refuses_what_is_undefined_on_the_target(value: float) -> None:
    with pytest.raises(ValueError, match="outside int32"):
        iq_macro(value, 24)


class RoundedMpy(Iq):
    def mpy(self, a: int, b: int, q: int) -> int:
        return self.rmpy(a, b, q)


class FlooredRmpy(Iq):
    def rmpy(self, a: int, b: int, q: int) -> int:
        return self.mpy(a, b, q)


class WrappingRsmpy(Iq):
    def rsmpy(self, a: int, b: int, q: int) -> int:
        return self.rmpy(a, b, q)


class TruncatedDiv(Iq):
    def div(self, a: int, b: int, q: int) -> int:
        if b == 0:
            return super().div(a, b, q)
        size = (abs(a) << q) // abs(b)
        return self.sat(size if (a < 0) == (b < 0) else -size, 2**31 - 1, -(2**31))


class OffByOneQ(Iq):
    def mpy(self, a: int, b: int, q: int) -> int:
        return super().mpy(a, b, q - 1)


class SaturatingAdd(Iq):
    def add(self, a: int, b: int) -> int:
        return self.sat(a + b, 2**31 - 1, -(2**31))


class LogicalShift(Iq):
    def shr(self, a: int, count: int) -> int:
        return (a & 0xFFFFFFFF) >> count


@pytest.mark.parametrize(
    ("mutant", "function"),
    [
        (RoundedMpy, "mpy"),
        (FlooredRmpy, "rmpy"),
        (WrappingRsmpy, "rsmpy"),
        (TruncatedDiv, "div"),
        (OffByOneQ, "mpy"),
        (SaturatingAdd, "add"),
        (LogicalShift, "shr"),
    ],
)
def test_vectors_tell_wrong_semantics_apart(mutant: type[Iq], function: str) -> None:
    assert mismatches(mutant(), function) > 20
