"""Faults of a sensor: what each word makes of the readings, and what is noted of it."""

from __future__ import annotations

from dataclasses import replace
from math import exp

import pytest

from hil_tests.support.plant_faults import SCENARIO, commanded, fault, faulty, shown
from railhil.bus.layout import CHECK_CORRECT, CHECK_ERRONEOUS
from railhil.faults.model import Draw, Fault
from railhil.faults.sensors import Reading
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.faults.readings import FaultySensor, quantity_of
from railhil.scenarios.fault_list import draw_values
from railhil.wire.ato import SpeedSdt, TrnPos, TrnSpeed

TICK_NS = 10_000_000
SPEED = quantity_of(TrnSpeed, "speed_01mmps", 1e4)
FULL = -(2**23), 2**23 - 1


def readings(*faults: Fault, raw: list[int], seed: int = 0) -> list[Reading]:
    """What a speed sensor with faults makes of raw readings at ticks 0, 1, 2, ..."""
    injections = Injections([(n, draw_values(one, n, seed)) for n, one in enumerate(faults, 1)], seed, TICK_NS)
    sensor = FaultySensor(injections, SPEED, 0.01, "speed")
    found = []
    for tick, value in enumerate(raw):
        injections.look(tick, 0.0, 0.0)
        sensor.sample(value)
        found.append(sensor.reading)
    return found


def raws(*faults: Fault, raw: list[int], seed: int = 0) -> list[int]:
    found = readings(*faults, raw=raw, seed=seed)
    assert all(reading.valid for reading in found)
    return [reading.raw for reading in found]


RAMP = [10_000, 11_000, 12_000, 13_000, 14_000, 15_000]
#: Active at ticks 2 and 3.
TWO = {"duration_s": 0.02}


@pytest.mark.parametrize(
    ("what", "values", "expected"),
    [
        ("stuck", {}, [10_000, 11_000, 12_000, 12_000, 14_000, 15_000]),
        ("value", {"value": -5.0}, [10_000, 11_000, -50_000, -50_000, 14_000, 15_000]),
        ("value", {"value": 1e6}, [10_000, 11_000, FULL[1], FULL[1], 14_000, 15_000]),
        ("wrong", {"factor": 1.05}, [10_000, 11_000, 12_600, 13_650, 14_000, 15_000]),
        ("offset", {"error": -0.2}, [10_000, 11_000, 10_000, 11_000, 14_000, 15_000]),
        ("drift", {"per_s": 5.0}, [10_000, 11_000, 12_000, 13_500, 14_000, 15_000]),
        ("delayed", {"delay_s": 0.02}, [10_000, 11_000, 10_000, 11_000, 14_000, 15_000]),
    ],
)
def test_words(what: str, values: dict[str, float], expected: list[int]) -> None:
    assert raws(fault("sensor.speed", what, 0.02, values, **TWO), raw=RAMP) == expected


def test_off_says_that_the_value_is_not_valid() -> None:
    found = readings(fault("sensor.speed", "off", 0.02, **TWO), raw=RAMP)
    assert [reading.valid for reading in found] == [True, True, False, False, True, True]
    assert found[2] == Reading(0, False)


def test_slow_is_a_first_order_lag() -> None:
    raw = [0] * 3 + [100_000] * 100
    found = raws(fault("sensor.speed", "slow", 0.01, {"time_constant_s": 0.2}), raw=raw)
    for after in (1, 20, 90):
        assert found[2 + after] == pytest.approx(100_000 * (1 - exp(-after * 0.01 / 0.2)), abs=1)


def test_random_words_use_the_fault_s_own_numbers() -> None:
    raw = [50_000] * 400
    noise = raws(fault("sensor.speed", "noise", 0.0, {"sigma": 0.1}), raw=raw)
    spread = (sum((value - 50_000) ** 2 for value in noise) / len(noise)) ** 0.5
    assert spread == pytest.approx(1000, rel=0.1)
    garbage = raws(fault("sensor.speed", "garbage"), raw=raw)
    assert all(FULL[0] <= value <= FULL[1] for value in garbage)
    assert min(garbage) < FULL[0] // 2
    assert max(garbage) > FULL[1] // 2
    off = readings(fault("sensor.speed", "intermittent", 0.0, {"share": 0.3}), raw=raw)
    assert sum(not reading.valid for reading in off) == pytest.approx(120, abs=30)
    # The same run again, another run, a seed of the fault's own in two runs, and the same fault as the second.
    one = fault("sensor.speed", "garbage")
    assert raws(one, raw=raw) == garbage != raws(one, raw=raw, seed=1)
    own = replace(one, seed=7)
    assert raws(own, raw=raw) == raws(own, raw=raw, seed=1) != garbage
    assert raws(fault("sensor.speed", "offset", 0.0, {"error": 0.0}), one, raw=raw) != garbage


def test_a_distribution_is_drawn_once_for_each_run() -> None:
    wrong = fault("sensor.speed", "wrong", 0.0, {"factor": Draw("uniform", 0.9, 1.1)})
    first = raws(wrong, raw=[100_000] * 5)
    assert len(set(first)) == 1
    assert 90_000 <= first[0] <= 110_000
    assert first == raws(wrong, raw=[100_000] * 5) != raws(wrong, raw=[100_000] * 5, seed=1)


def test_several_faults_act_in_the_order_of_their_numbers() -> None:
    wrong = fault("sensor.speed", "wrong", 0.0, {"factor": 2.0}, combine=True)
    offset = fault("sensor.speed", "offset", 0.0, {"error": 1.0}, combine=True)
    assert raws(wrong, offset, raw=[10_000]) == [30_000]
    assert raws(offset, wrong, raw=[10_000]) == [40_000]


def test_ok_ends_what_is_active_at_its_place() -> None:
    stuck = fault("sensor.speed", "stuck", 0.01)
    other = fault("sensor.position", "stuck", 0.01)
    clear = fault("sensor.speed", "ok", 0.03)
    injections = Injections([(1, stuck), (2, other), (3, clear)], 0, TICK_NS)
    sensor = FaultySensor(injections, SPEED, 0.01, "speed")
    found = []
    for tick, value in enumerate(RAMP):
        injections.look(tick, 0.0, 0.0)
        sensor.sample(value)
        found.append(sensor.reading.raw)
    assert found == [10_000, 11_000, 11_000, 13_000, 14_000, 15_000]
    assert [one.active for one in injections.activities] == [False, True, False]
    assert [one.hits for one in injections.activities] == [0, 0, 1]


def test_a_hit_is_a_changed_reading_that_was_sent() -> None:
    plant = faulty(
        fault("sensor.speed", "stuck", 0.1, duration_s=5.0),
        fault("sensor.position", "off", 5.0, count=3),
    )
    position = []
    for _ in range(600):
        plant.makers[TrnSpeed.PORT]()
        if plant.tick % 2 == 0:
            plant.command(1200, False)
            telegram = plant.makers[TrnPos.PORT]()
            assert isinstance(telegram, TrnPos)
            position.append((telegram.odometer_mm, telegram.check))
        plant.advance()
    speed, odometer = plant.injections.activities
    # The train stands for the first tenths of a second: a stuck zero changes nothing.
    assert 400 < speed.hits < 500
    first = next(hit for hit in shown(plant) if hit[0] == 1)
    assert first[1] > 0.1
    assert (first[2], first[3]) == (str(int(first[2])), "0")
    # Three telegrams, one in two ticks; then the count is over.
    assert odometer.hits == 3
    assert next(hit[1:] for hit in shown(plant) if hit[0] == 2)[0] == 5.0
    assert [check for _, check in position[250:254]] == [CHECK_ERRONEOUS] * 3 + [CHECK_CORRECT]
    assert [at for at, _ in position[250:253]] == [0, 0, 0]


def test_a_jump_shows_in_the_odometer_and_in_the_balise_s() -> None:
    healthy, jumped = faulty(), faulty(fault("sensor.position", "jump", 5.0, {"distance_m": 10.0}))
    for plant in (healthy, jumped):
        commanded(plant, 1200, 1000)
    assert jumped.odometer_mm == healthy.odometer_mm + 10_000
    assert jumped.true_speed_01mmps == healthy.true_speed_01mmps
    balise = SCENARIO.line.balises[0]
    plants = [faulty(), faulty(fault("sensor.position", "jump", 1.0, {"distance_m": 10.0}))]
    read = []
    for plant in plants:
        events = commanded(plant, 1200, 6000)
        read.append(next(event.odometer_mm for event in events if event.balise and event.balise.true_m > 1.0))
    assert read[1] == read[0] + 10_000, balise


def test_a_safe_telegram_is_not_sent_without_valid_readings() -> None:
    """SPEED_SDT has no check variable that could say so; the channel ages."""
    scenario = replace(SCENARIO, safety=replace(SCENARIO.safety, sdt=True))
    plant = faulty(fault("sensor.speed", "off", 1.0), scenario=scenario)
    commanded(plant, 1200, 99)
    assert plant.makers[SpeedSdt.PORT]() is not None
    commanded(plant, 1200, 1)
    assert plant.makers[SpeedSdt.PORT]() is None
