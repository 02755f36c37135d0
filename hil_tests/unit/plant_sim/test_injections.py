"""Which faults of the plant are active, and what is noted of them; the plant of a run."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.plant_faults import SCENARIO, TICK_NS, fault, made, said
from hil_tests.support.plug import with_system
from railhil.bus.injector.activities import Hit
from railhil.common.errors import InputError
from railhil.faults.activity import MotionEvents
from railhil.faults.model import Trigger
from railhil.plant_sim.ato.faults.train import FaultyTrain
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.faults.plants import FMU_PART, in_plant, make_plant, needs_nodes
from railhil.scenarios.load import load_any
from railhil.scenarios.plant_fmu import PlantFmu
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import system_named

MANUAL = Trigger("manual")


# -- which faults are active -------------------------------------------------------------------------------------------


def test_events_of_the_motion() -> None:
    events = MotionEvents()
    # It begins at a standstill, which is no event.
    assert events.seen(0.0, 0.0, 0.0) == []
    assert events.seen(0.0, -0.3, 0.0) == ["braking"]
    assert events.seen(0.1, -0.3, 1e-9) == ["traction"]
    assert events.seen(0.1, -0.3, 1e-9) == []
    assert events.seen(0.1, -0.2999, -5.0) == []
    assert events.seen(0.0, -5.0, 5.0) == ["standstill", "braking", "traction"]
    assert MotionEvents().seen(1.0, 0.0, 0.0) == []
    assert MotionEvents().seen(0.0, -1.0, 1.0) == ["braking", "traction"]


def test_begins_and_ends_are_changes() -> None:
    injections = made(fault("sensor.speed", "off", 0.02, duration_s=0.02), fault("sensor.position", "off", MANUAL))
    assert [injections.look(tick, 0.0, 0.0) for tick in range(6)] == [True, False, True, False, True, False]
    # Ended between two looks, by its count: the next one tells.
    injections = made(fault("sensor.speed", "off", 0.0, count=1))
    injections.look(0, 0.0, 0.0)
    injections.hit(injections.activities[0], "a", "b")
    assert injections.look(1, 0.0, 0.0)
    assert not injections.look(2, 0.0, 0.0)


def test_place_and_speed_reach_the_faults() -> None:
    injections = made(
        fault("sensor.speed", "off", Trigger("position", 10.0)), fault("sensor.position", "off", Trigger("speed", 10.0))
    )
    injections.look(0, 9.0, 1.0)
    injections.look(1, 11.0, 9.0)
    assert [one.active for one in injections.activities] == [True, False]
    injections.look(2, 12.0, 11.0)
    assert [one.active for one in injections.activities] == [True, True]


def test_places_of_the_faults() -> None:
    injections = made(
        fault("sensor.speed", "off"), fault("sensor.position", "off"), fault("train.power", "off"),
        fault("actuator.brake", "off"),
    )  # fmt: skip
    assert [one.number for one in injections.activities] == [4, 5, 6, 7]
    assert [one.number for one in injections.at("sensor")] == [4, 5]
    assert [one.number for one in injections.at("sensor", "position", "power")] == [5]
    assert injections.at("train", "speed") == []


def test_units_of_the_faults() -> None:
    injections = made(*(fault("sensor.speed", "off", units=units) for units in ((), (1, 3), (2,))))
    found = [[one.number for one in injections.at("sensor", "speed", unit=unit)] for unit in (0, 1, 2, 3)]
    assert found == [[4, 5, 6], [4, 5], [4, 6], [4, 5]]
    assert [one.number for one in injections.at("sensor")] == [4, 5, 6]


def test_orders_and_events() -> None:
    injections = made(
        fault("sensor.speed", "off", MANUAL), fault("sensor.position", "off", MANUAL),
        fault("train.power", "off", Trigger("event", "braking")),
    )  # fmt: skip
    injections.look(3, 0.0, 0.0)
    injections.order(5, True)
    injections.order(1, True)
    injections.happened("standstill")
    injections.look(4, 0.0, 0.0)
    assert [one.active for one in injections.activities] == [False, True, False]
    injections.happened("braking")
    injections.order(5, False)
    assert injections.activities[1].ended_ns == 4 * TICK_NS
    injections.look(5, 0.0, 0.0)
    assert [one.active for one in injections.activities] == [False, False, True]


def test_ok_ends_what_is_active_at_its_place() -> None:
    injections = made(
        fault("sensor.speed", "off"), fault("sensor.speed", "stuck", 9.0), fault("sensor.position", "off"),
        fault("sensor.speed", "ok", 0.01), fault("sensor.speed", "noise"),
    )  # fmt: skip
    injections.look(0, 0.0, 0.0)
    injections.look(1, 0.0, 0.0)
    assert [one.active for one in injections.activities] == [False, False, True, False, False]
    assert [one.over for one in injections.activities] == [True, False, False, True, True]
    assert injections.log.hits == [Hit(7, TICK_NS, "ok", what, "ok") for what in ("off", "noise")]


def test_a_lasting_effect_is_a_hit_each_time_it_begins() -> None:
    injections = made(fault("train.power", "off"), fault("train.doors", "off"))
    one, other = injections.activities
    for tick, acts in enumerate((False, True, True, False, True)):
        injections.look(tick, 0.0, 0.0)
        injections.effect(one, acts, f"{tick}", "x")
    injections.effect(other, True, "y", "z")
    assert said(injections) == [(4, "1", "x"), (4, "4", "x"), (5, "y", "z")]
    assert [hit.time_ns for hit in injections.log.hits] == [TICK_NS, 4 * TICK_NS, 4 * TICK_NS]


def test_each_fault_has_its_own_random_numbers() -> None:
    injections = made(fault("sensor.speed", "garbage"), fault("sensor.speed", "garbage"))
    first, second = (injections.samples(one).random() for one in injections.activities)
    assert first != second
    assert injections.samples(injections.activities[0]).random() == first
    other = Injections([(4, fault("sensor.speed", "garbage"))], 1, TICK_NS)
    assert other.samples(other.activities[0]).random() != first


# -- the plant of a run ------------------------------------------------------------------------------------------------


def test_the_plant_of_a_run() -> None:
    assert in_plant([fault("bus.", "off"), fault("train.mass", "scale"), fault("sensor.speed", "off")]) == [
        (2, fault("train.mass", "scale")), (3, fault("sensor.speed", "off")),
    ]  # fmt: skip
    assert in_plant([fault("actuator.brake", "off"), fault("node.plant", "kill")]) == [
        (1, fault("actuator.brake", "off"))
    ]
    for faults in ((), ("TRN_SPEED loss @0s",)):
        plant, injections = make_plant(replace(SCENARIO, faults=faults), RunSpec())
        assert not isinstance(plant, FaultyTrain)
        assert injections is None
    spec = RunSpec(seed=7, perturbed=True)
    plant, injections = make_plant(replace(SCENARIO, faults=("TRN_SPEED loss @0s", "sensor.speed garbage @0s")), spec)
    assert isinstance(plant, FaultyTrain)
    assert injections is plant.injections
    (one,) = plant.injections.activities
    assert (one.number, one.fault.what) == (2, "garbage")
    # With the seed and the perturbation of the run.
    assert plant.injections.samples(one).random() == Injections([(2, one.fault)], 7, TICK_NS).samples(one).random()
    assert plant._healthy.train != SCENARIO.train


def test_the_number_of_a_run_reaches_its_plant() -> None:
    with pytest.raises(InputError, match=r"run: run_number: found 2, allowed 1: runs of system ato have no numbers"):
        make_plant(SCENARIO, RunSpec(run_number=2))
    learning = load_any("yizhuang_stop")
    runs = [make_plant(learning, RunSpec(seed=5, run_number=number))[0].train for number in (1, 3, 3)]
    begun_mps = [train.run.start_mps for train in runs]
    assert begun_mps[0] != begun_mps[1] == begun_mps[2]


def test_an_fmu_is_a_plant_of_systems_that_say_how(monkeypatch: pytest.MonkeyPatch) -> None:
    """And without faults of its own."""
    fmu = PlantFmu("train.fmu", "train.toml")
    spec = RunSpec(seed=7, perturbed=True, plant_fmu=fmu)
    made_from: list[object] = []
    taking = replace(system_named("ato"), fmu_plant="train.fmu")
    monkeypatch.setattr(type(taking), "part", lambda system, name: lambda *given: made_from.extend([name, *given]))
    scenario_of_fmu = with_system(SCENARIO, taking)
    assert make_plant(replace(scenario_of_fmu, faults=("TRN_SPEED loss @0s",)), spec) == (None, None)
    name, scenario, *given = made_from
    assert (name, given) == (FMU_PART, [7, True, spec.wall_rate, fmu])
    assert scenario.name == SCENARIO.name

    with pytest.raises(InputError) as refused:
        make_plant(replace(scenario_of_fmu, faults=("sensor.speed garbage @0s",)), spec)
    assert str(refused.value) == (
        "command line: --plant-fmu: faults in the plant, expected faults of telegrams, nodes and the bus: "
        "an FMU has no others"
    )
    with pytest.raises(InputError) as refused:
        make_plant(with_system(SCENARIO, replace(taking, fmu_plant=None)), spec)
    assert str(refused.value) == (
        "command line: --plant-fmu: system ato, expected a system with a part fmu_plant: what an FMU "
        "exchanges with the plant (docs/howto/fmi.md)"
    )


def test_faults_without_nodes() -> None:
    heavy = "train.mass scale 1.1 @0s"
    assert [needs_nodes(replace(SCENARIO, faults=faults)) for faults in ((), (heavy,), (heavy, "bus off @0s"))] == [
        False, False, True,
    ]  # fmt: skip
