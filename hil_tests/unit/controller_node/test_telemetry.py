"""Telemetry of a law's quantities: extremes, events and their assignment, for one train and for many; cycles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.batch_controller import BatchController
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, SATURATION, WRAP, Arithmetic
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.program.model import Quantity, Value
from railhil.controller_node.telemetry import QuantityTelemetry, Telemetry
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec

SCENARIO = load("lvshun_tieshan")
Q = 20
NAMES = ("first", "second", "third")
INT32 = st.integers(INT32_MIN, INT32_MAX)


def watched(name: str = "iq", batch: bool = False) -> tuple[Arithmetic[Any], Telemetry]:
    arithmetic = make(name, batch=batch)
    arithmetic.noted = []
    return arithmetic, Telemetry([Quantity(quantity, Q, "km/h", Value(0, Q)) for quantity in NAMES])


def note(arithmetic: Arithmetic[Any], values: Sequence[Any]) -> None:
    for name, value in zip(NAMES, values, strict=True):
        arithmetic.note(name, value, Q, "km/h")


def events(row: QuantityTelemetry) -> tuple[int, int, int]:
    return row.wraps, row.saturations, row.zero_divisions


@pytest.mark.parametrize("batch", [False, True])
@pytest.mark.parametrize("name", ["iq", "iq-portable"])
def test_an_event_belongs_to_the_quantity_noted_next(name: str, batch: bool) -> None:
    number, telemetry = watched(name, batch)
    trains = 3 if batch else 1

    def operand(value: int) -> Any:
        return np.full(trains, value) if batch else value

    for _ in range(2):
        number.note("first", operand(5), Q)
        wrapped = number.add(operand(INT32_MAX), operand(1))
        number.note("second", wrapped, Q)
        number.sat(operand(9), operand(3), operand(0))
        number.sat(operand(-9), operand(3), operand(0))
        number.note("third", number.div(operand(1), operand(0), Q), Q)
        # Behind the last note, and between two periods.
        number.add(operand(INT32_MIN), operand(-1))
        telemetry.take(number)
        number.neg(operand(INT32_MIN))
        telemetry.take(number)
    first, second, third = telemetry.rows
    assert events(first) == (0, 0, 0)
    assert events(second) == (2 * trains, 0, 0)
    assert events(third) == (4 * trains, 4 * trains, 2 * trains)
    assert (second.minimum_raw, second.maximum_raw) == (INT32_MIN, INT32_MIN)
    assert telemetry.steps == third.steps == 2
    counters = number.counters
    sums = tuple(sum(column) for column in zip(*map(events, telemetry.rows), strict=True))
    assert sums == (counters.wraps, counters.saturations, counters.zero_divisions)


def test_nothing_is_known_before_the_first_step() -> None:
    _, telemetry = watched()
    for name, row in zip(NAMES, telemetry.rows, strict=True):
        assert row == QuantityTelemetry(name, Q, "km/h", None, None, None, None, None, None, 0, 0, 0, 0)


@pytest.mark.parametrize(
    ("values", "used", "headroom"),
    [
        ((0,), 0, 31),
        ((1, 0), 1, 30),
        ((-1, 0), 1, 30),
        ((2**20 - 1, 3), 20, 11),
        ((2**20, 3), 21, 10),
        ((-(2**20), 3), 21, 10),
        ((5, INT32_MAX), 31, 0),
        ((5, INT32_MIN), 31, 0),
    ],
)
def test_bits_are_those_of_the_largest_size(values: tuple[int, ...], used: int, headroom: int) -> None:
    number, telemetry = watched()
    for value in values:
        note(number, (value, 0, 0))
        telemetry.take(number)
    row = telemetry.row(0)
    assert (row.used_bits, row.headroom_bits) == (used, headroom)


@given(st.lists(st.tuples(INT32, INT32, INT32), min_size=1, max_size=12))
@settings(max_examples=60, deadline=None)
def test_extremes_of_one_train_and_of_many(rows: list[tuple[int, int, int]]) -> None:
    one, single = watched()
    many, together = watched(batch=True)
    for values in rows:
        note(one, values)
        single.take(one)
        # Two trains, the second mirrored; a quantity may be common to all.
        note(many, (np.array([values[0], ~values[0]]), values[1], np.asarray(values[2])))
        together.take(many)
    for index, column in enumerate(zip(*rows, strict=True)):
        row = single.row(index)
        assert (row.minimum_raw, row.maximum_raw) == (min(column), max(column))
        assert (row.minimum, row.maximum) == (min(column) / 2**Q, max(column) / 2**Q)
        seen = (*column, *(~value for value in column)) if index == 0 else column
        row = together.row(index)
        assert (row.minimum_raw, row.maximum_raw) == (min(seen), max(seen))
        assert type(row.minimum_raw) is int


@pytest.mark.parametrize("batch", [False, True])
def test_floats_have_extremes_but_no_bits(batch: bool) -> None:
    number, telemetry = watched("float64", batch)
    for value in (0.5, -2.5, 1.0):
        note(number, (np.array([value, 0.0]) if batch else value, 1.0, 2.0))
        telemetry.take(number)
    row = telemetry.row(0)
    assert (row.minimum, row.maximum) == (-2.5, 1.0)
    assert type(row.minimum) is float
    assert (row.minimum_raw, row.maximum_raw, row.used_bits, row.headroom_bits) == (None,) * 4


def test_values_that_are_not_the_quantities_are_refused() -> None:
    number, telemetry = watched()
    for _ in range(2):
        number.note("first", 1, Q)
        with pytest.raises(ValueError, match="1 values noted, 3 quantities known"):
            telemetry.take(number)
        assert number.noted is not None
        number.noted.clear()
        note(number, (1, 2, 3))
        telemetry.take(number)
    with pytest.raises(ValueError, match="notes nothing"):
        telemetry.take(make("iq"))


def test_many_trains_have_the_telemetry_of_each() -> None:
    """Same inputs, one by one and together: extremes of all, events in sum. Jumps in speed make the law saturate."""
    random = np.random.default_rng(11)
    trains, steps = 5, 30
    batch = BatchController(SCENARIO, trains)
    single = [Controller(SCENARIO) for _ in range(trains)]
    for k in range(100, 100 + steps):
        speeds = random.choice([0, 150_000, 180_000, 220_000, 2_000_000], trains)
        positions = random.integers(0, 29_400_000, trains)
        together = batch.step(k, speeds, positions)
        told = np.clip(together.notch_code - 100, -1000, 1000)
        batch.sent(told)
        for train, controller in enumerate(single):
            controller.step(k, int(speeds[train]), int(positions[train]))
            controller.sent(int(told[train]))
    rows = list(zip(*(controller.telemetry.rows for controller in single), strict=True))
    assert sum(row.saturations for row in batch.telemetry.rows) > 0
    for found, each in zip(batch.telemetry.rows, rows, strict=True):
        assert found.name == each[0].name
        assert found.steps == steps
        assert found.minimum_raw == min(row.minimum_raw for row in each)
        assert found.maximum_raw == max(row.maximum_raw for row in each)
        assert found.headroom_bits == min(row.headroom_bits for row in each)
        assert events(found) == tuple(map(sum, zip(*map(events, each), strict=True)))


@pytest.mark.parametrize("name", ["iq", "iq-portable", "float64", "float32"])
def test_controller_keeps_the_rows_of_its_law(name: str) -> None:
    controller = Controller(SCENARIO, LawSpec("ipfc", name))
    before = controller.step(100, 180_000, 0)
    row = controller.telemetry.row(0)
    assert (row.name, row.unit, row.steps) == ("speed", "km/h", 1)
    assert row.minimum == row.maximum == pytest.approx(64.8, abs=1e-5)
    last = controller.telemetry.rows[-1]
    assert last.name == "notch"
    assert last.maximum == before.notch_code / 256
    assert (last.headroom_bits is None) == name.startswith("float")


def test_saturations_of_the_law_are_named() -> None:
    """A speed that drops to 0 in one period: the flags say that, the telemetry says where."""
    controller = Controller(SCENARIO)
    controller.step(100, 180_000, 0)
    assert controller.step(101, 0, 0).overflow_flags == SATURATION
    named = {row.name for row in controller.telemetry.rows if row.saturations}
    assert named
    assert named <= {f"error_rise[{i}]" for i in range(9)} | {f"d[{i}]" for i in range(9)}
    assert controller.counters.saturations == sum(row.saturations for row in controller.telemetry.rows)
    assert controller.counters.flags & WRAP == 0


def test_cost_is_that_of_the_chip_against_the_control_period() -> None:
    fixed, single, double = (Controller(SCENARIO, LawSpec("ipfc", name)) for name in ("iq", "float32", "float64"))
    assert 0 < single.cost.cycles < fixed.cost.cycles
    assert double.cost.cycles == 0
    for controller in (fixed, single, double):
        cost = controller.cost
        assert controller.step(0, 0, 0).cycles == cost.cycles
        assert cost.cycles_flash == 2 * cost.cycles
        assert cost.ram_us == pytest.approx(cost.cycles / 150e6 * 1e6)
        assert cost.flash_us == 2 * cost.ram_us
        assert cost.share == pytest.approx(cost.cycles_flash / 150e6 / 0.5)
    assert BatchController(SCENARIO, 2).cost == fixed.cost
    assert fixed.cost.operations["div"] == 1


@pytest.mark.parametrize("batch", [False, True])
def test_a_wrap_in_the_notch_really_sent_belongs_to_the_notch(batch: bool) -> None:
    """4096 notches do not fit into the state's format; they are told between two control periods."""
    controller: Any = BatchController(SCENARIO, 2) if batch else Controller(SCENARIO)
    given = (np.array([180_000, 180_000]), np.zeros(2, dtype=np.int64)) if batch else (180_000, 0)
    controller.step(100, *given)
    controller.sent(np.array([1 << 20, 256]) if batch else 1 << 20)
    assert [row.wraps for row in controller.telemetry.rows] == [0] * (len(controller.telemetry.rows) - 1) + [1]
