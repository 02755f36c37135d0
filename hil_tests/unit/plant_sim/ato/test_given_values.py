"""Delays that an operator makes longer than they were prepared: the plant has kept enough of the past."""

from __future__ import annotations

import pytest

from railhil.bus.codes import FaultOrder
from railhil.faults.language import parse
from railhil.faults.operator_values import octets_of
from railhil.faults.sensors import Quantity
from railhil.plant_sim.ato.faults.equipment import Side
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.faults.readings import FaultySensor

TICK_NS = 10_000_000
TICK_S = 0.01


def given(prepared: str, wanted: str) -> tuple[Injections, list[tuple[int, int]]]:
    """The plant's faults with one by hand, and the orders that give it other values."""
    before = parse(prepared)
    octets = octets_of(1, before, parse(wanted))
    orders = [*((octet, FaultOrder.VALUE) for octet in octets), (1, FaultOrder.INJECT)]
    return Injections([(1, before)], 0, TICK_NS), orders


@pytest.mark.parametrize(("wanted_ms", "ticks"), [(50, 5), (100, 10), (300, 30)])
def test_a_sensor_says_what_it_read_as_long_ago_as_was_asked_for(wanted_ms: int, ticks: int) -> None:
    faults, orders = given("speed delayed 100ms @manual", f"speed delayed {wanted_ms}ms @manual")
    sensor = FaultySensor(faults, Quantity(1.0, 0, 1000), TICK_S, "speed")
    for tick in range(101):
        if tick == 100:
            for order in orders:
                faults.order(*order)
        faults.look(tick, 0.0, 0.0)
        sensor.sample(tick)
    assert sensor.reading.raw == 100 - ticks


@pytest.mark.parametrize(("wanted_ms", "ticks"), [(50, 5), (100, 10), (300, 30)])
def test_a_drive_does_what_it_was_told_as_long_ago_as_was_asked_for(wanted_ms: int, ticks: int) -> None:
    faults, orders = given("traction dead_time 100ms @manual", f"traction dead_time {wanted_ms}ms @manual")
    side = Side(faults.at("actuator", "traction"), 1, TICK_S)
    for tick in range(1, 101):
        side.remember(tick)
    for order in orders:
        faults.order(*order)
    faults.look(100, 0.0, 0.0)
    side.change(0.0)
    assert side.acting(100) == 100 - ticks
