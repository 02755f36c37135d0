"""Faults of the train: equipment, mass and gradient, balises; each on the plant alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.plant_faults import SCENARIO, commanded, fault, faulty, shown
from railhil.bus.layout import CHECK_ERRONEOUS
from railhil.common.errors import InputError
from railhil.faults.model import Draw, Fault, Trigger, Word
from railhil.faults.words import CLEAR, words_at
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.ato.faults.mismatch import Mismatch
from railhil.plant_sim.ato.plant import Plant
from railhil.scenarios.load import load_any
from railhil.systems.ato import ATO
from railhil.systems.ato.scenario.model import Balise
from railhil.wire.ato import BalisePassed, TrnPos, TrnSpeed

#: Every place of this plant with every word of the language that it has.
INJECTED = [(place, word) for place in ATO.injects for word in words_at(*place.split("."), "") if word.name != CLEAR]


def with_usual(place: str, word: Word, trigger: Trigger) -> Fault:
    """A fault with the usual values of its word, or 2."""
    values = {one.name: 2.0 if one.usual is None else one.usual for one in word.parameters}
    return fault(place, word.name, trigger, values)


# -- without an active fault ------------------------------------------------------------------------------------------


def test_a_train_whose_faults_are_not_active_is_the_train_without_faults() -> None:
    """Bit for bit: state, readings and events; every fault, none of which ever begins."""
    faults = [with_usual(place, word, Trigger("event", "never")) for place, word in INJECTED]
    plants = [Plant(SCENARIO, 3), faulty(*faults, seed=3)]
    for code in (1500, -300, 900, -1700):
        events = [commanded(plant, code, 700) for plant in plants]
        assert events[0] == events[1]
        seen = [
            (plant._motion, plant.speed_01mmps, plant.odometer_mm, plant.brake_n, plant.accel_mps2, plant.notch_acting)
            for plant in plants
        ]
        assert seen[0] == seen[1]


# -- mass, resistance, gradient ---------------------------------------------------------------------------------------


def test_a_mismatch_from_the_start_is_a_changed_scenario() -> None:
    """Bit for bit, also where it is drawn."""
    faults = (
        fault("train.mass", "scale", 0.0, {"factor": 1.13}),
        fault("train.gradient", "scale", 0.0, {"factor": 0.9}),
        fault("train.gradient", "offset", 0.0, {"permil": Draw("uniform", 1.0, 2.0)}),
        fault("train.resistance", "scale", 0.0, {"factor": 1.3}),
    )
    plant = faulty(*faults)
    drawn = plant.injections.activities[2].fault.values["permil"]
    assert isinstance(drawn, float)
    assert 1.0 < drawn < 2.0
    changed = Plant(Mismatch(1.13, 1.3, 0.9, drawn).applied(SCENARIO), 0)
    for code in (1500, 0, -900):
        commanded(plant, code, 900)
        commanded(changed, code, 900)
        assert plant._motion == changed._motion
    assert [hit[:2] for hit in shown(plant)] == [(1, 0.0), (2, 0.0), (3, 0.0), (4, 0.0)]


# -- balises ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("what", "values", "expected", "note"),
    [
        ("missed", {}, [], ("7:30", "none")),
        ("doubled", {}, [(7, 30_000, 1), (7, 30_000, 1)], ("7:30", "7:30 7:30")),
        ("wrong", {"error_m": -3.5}, [(7, 26_500, 1)], ("7:30", "7:26.5")),
        ("wrong_number", {"number": 9.0, "only": 7.0}, [(9, 30_000, 1)], ("7:30", "9:30")),
        ("off", {}, [(7, 0, CHECK_ERRONEOUS)], ("7:30", "invalid")),
        ("intermittent", {"share": 1.0}, [(7, 0, CHECK_ERRONEOUS)], ("7:30", "invalid")),
    ],
)
def test_balises(
    what: str, values: dict[str, float], expected: list[tuple[int, int, int]], note: tuple[str, str]
) -> None:
    line = replace(SCENARIO.line, balises=(Balise(7, 30.0, 30.0), Balise(8, 60.0, 60.0)))
    scenario = replace(SCENARIO, line=line)
    plant = faulty(
        fault("sensor.balise", what, Trigger("position", 20.0), values, count=1),
        scenario=scenario,
    )
    found = []
    for _ in range(3000):
        for event in commanded(plant, 1500, 1):
            telegram = plant.telegram_of(event)
            if isinstance(telegram, BalisePassed):
                found.append((telegram.balise_id, telegram.surveyed_mm, telegram.check))
    assert found == [*expected, (8, 60_000, 1)]
    assert [hit[2:] for hit in shown(plant)] == [note]


def test_a_shifted_balise_is_passed_elsewhere() -> None:
    """Its telegram is the same; the odometer at the passing is not. One that is moved behind the front is not read."""
    places_m = (30.0, 60.0, 90.0)
    line = replace(SCENARIO.line, balises=tuple(Balise(7 + index, at_m, at_m) for index, at_m in enumerate(places_m)))
    begin = Trigger("position", 20.0)
    plant = faulty(
        fault("sensor.balise", "shifted", begin, {"by_m": 2.5, "only": 8.0}, combine=True),
        fault("sensor.balise", "shifted", begin, {"by_m": -80.0, "only": 9.0}, combine=True),
        scenario=replace(SCENARIO, line=line),
    )
    found = []
    for _ in range(3000):
        for event in commanded(plant, 1500, 1):
            telegram = plant.telegram_of(event)
            if isinstance(telegram, BalisePassed):
                found.append((telegram.balise_id, telegram.surveyed_mm, event.position_01mm))
    assert found == [(7, 30_000, 300_000), (8, 60_000, 625_000)]
    assert [hit[2:] for hit in shown(plant)] == [("60 m", "62.5 m")]


# -- triggers and refusals --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "trigger",
    [Trigger("speed", 5.0), Trigger("position", 20.0), Trigger("event", "departed", delay_s=2.0)],
)
def test_a_fault_begins_by_the_truth_of_the_plant(trigger: Trigger) -> None:
    plant = faulty(fault("train.pantograph", "off", trigger))
    while plant.status.pantograph_up:
        commanded(plant, 1200, 1)
    (begun,) = plant.injections.activities
    assert begun.begun_ns == plant.tick * 10_000_000
    if trigger.kind == "speed":
        assert 49_999 < plant.true_speed_01mmps < 50_200
    elif trigger.kind == "position":
        assert 199_999 < plant.position_01mm < 201_000
    else:
        assert plant.tick > 200


@pytest.mark.parametrize(("place", "word"), INJECTED, ids=lambda one: one if isinstance(one, str) else one.name)
def test_every_word_of_the_language_changes_something(place: str, word: Word) -> None:
    line = replace(SCENARIO.line, balises=tuple(Balise(number, 3.0 * number, 3.0 * number) for number in range(1, 40)))
    plant = faulty(with_usual(place, word, Trigger("time", 5.0)), scenario=replace(SCENARIO, line=line))
    if word.name == "nan":
        with pytest.raises(PlantError):
            commanded(plant, 1700, 800)
    else:
        for code, ticks in ((1700, 800), (-900, 500)):
            for _ in range(ticks):
                commanded(plant, code, 1)
                for port in (TrnSpeed.PORT, TrnPos.PORT):
                    plant.makers[port]()
    assert plant.injections.activities[0].hits > 0
    assert min(hit.time_ns for hit in plant.injections.log.hits) >= 5_000_000_000


@pytest.mark.parametrize(
    ("text", "allowed"),
    [
        ("speed off @#7", "a telegram only for a port"),
        ("sensor.temperature off @3s", "sensor.speed, sensor.position"),
        ("speed off @3s units 2", "no units"),
        ("speed missed @3s", "off"),
    ],
)
def test_what_the_train_cannot_have_is_refused_at_load(text: str, allowed: str) -> None:
    with pytest.raises(InputError, match=allowed) as error:
        load_any("lvshun_tieshan", (), (text,))
    assert "\n" not in str(error.value)
