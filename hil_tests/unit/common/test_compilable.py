"""Functions that the interpreter runs and numba compiles: the same bits, and nothing that numba cannot do."""

from __future__ import annotations

import ast
import inspect
import math
import struct
import textwrap
from bisect import bisect_right
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from railhil.common import compilable as compilable_module
from railhil.common.compilable import (
    compilable,
    compilable_aside,
    field_types,
    interpreted,
    larger,
    result_type,
    smaller,
)
from railhil.plant_sim.ato import dynamics, forces, plant_readings
from railhil.scenarios.system import names, system_named

numba = pytest.importorskip("numba", reason="MISSING CAPABILITY numba (extra campaign)")
#: Equal numbers of both signs, ties, and what lies beside them.
NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.5, 1.5, 2.5, -0.5, -1.5, 1e-300, -1e-300, 3.0, math.inf, -math.inf)


def bits(value: float) -> bytes:
    return struct.pack("<d", value)


@pytest.fixture(scope="module", autouse=True)
def _told() -> None:
    """Numba knows the marked functions."""
    import railhil.batch.compiled  # noqa: F401


@pytest.mark.parametrize(("ours", "pythons"), [(smaller, min), (larger, max)])
def test_the_smaller_and_the_larger_are_those_of_python(
    ours: Callable[..., float], pythons: Callable[..., float]
) -> None:
    compiled = numba.njit(lambda a, b: ours(a, b))
    for a in NUMBERS:
        for b in NUMBERS:
            assert bits(ours(a, b)) == bits(compiled(a, b)) == bits(pythons(a, b))


def test_compiled_round_and_bisect_are_those_of_python() -> None:
    rounded = numba.njit(lambda value: round(value))
    for value in (number for number in NUMBERS if math.isfinite(number)):
        assert rounded(value) == round(value)
    row = numba.njit(lambda values, value: bisect_right(values, value))
    for values in ((), (0.0,), (-1.0, 0.0, 0.0, 2.5)):
        for value in NUMBERS:
            assert row(np.array(values, dtype=np.float64), value) == bisect_right(values, value)


@pytest.mark.slow
def test_a_marked_function_is_itself_and_numba_compiles_it() -> None:
    table = forces.GradeTable((0.0, 100.0), (5.0, -2.0), (0.0, 0.1))
    grade = numba.njit(lambda table, front_m: forces.mean_grade_permil(table, front_m))
    reading = numba.njit(lambda speed_mps: plant_readings.speed_reading_01mmps(speed_mps, 0.001, 0.99, 0.01))
    arrays = forces.GradeTable(*(np.array(column) for column in table))
    for front_m in (-1.0, 0.0, 99.9, 100.0, 133.3):
        assert bits(grade(arrays, front_m)) == bits(forces.mean_grade_permil(table, front_m))
    for speed_mps in (-1.0, 0.0, 1e-4, 0.0151, 13.337):
        assert reading(speed_mps) == plant_readings.speed_reading_01mmps(speed_mps, 0.001, 0.99, 0.01)


def test_the_type_of_a_result_is_found_in_the_source() -> None:
    assert result_type(dynamics.lag) is dynamics.Lag
    assert result_type(dynamics.clipped_mean_n) is float
    assert field_types(dynamics.Step) == [dynamics.Motion, float, float]


def test_what_numba_cannot_compile_is_refused_where_it_is_marked() -> None:
    around = 1.0

    def by_keyword(*, speed_mps: float) -> float:
        return speed_mps

    def over_a_name_around_it(speed_mps: float) -> float:
        return speed_mps + around

    things: tuple[Any, ...] = (by_keyword, over_a_name_around_it)
    for function in things:
        for mark in (compilable, compilable_aside):
            with pytest.raises(TypeError, match="plain function of positional arguments"):
                mark(function)


def _has_choice_in_fields(function: Callable[..., Any]) -> bool:
    """Whether a returned call has a conditional expression among its arguments."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(interpreted(function).__code__)))
    results = (node.value for node in ast.walk(tree) if isinstance(node, ast.Return))
    return any(
        isinstance(part, ast.IfExp)
        for result in results
        if isinstance(result, ast.Call)
        for given in result.args
        for part in ast.walk(given)
    )


def test_no_marked_function_chooses_a_field_where_it_returns() -> None:
    # On Python 3.12 and 3.13 numba takes each arm for a result with types of its own; 3.11 does not show it.
    for system in names():
        system_named(system).optional_part("batch")
    marked = {*compilable_module.INLINE, *compilable_module.ASIDE}
    assert len(marked) > 20
    assert [function.__qualname__ for function in marked if _has_choice_in_fields(function)] == []
