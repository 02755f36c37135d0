"""The train with faults, part by part: at its start, in a tick, its readings, what ends its drive, and what is an
event for a fault that waits."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.plant_faults import SCENARIO, commanded, fault, faulty, moving, shown
from railhil.bus.layout import CHECK_CORRECT, CHECK_ERRONEOUS
from railhil.faults.model import Trigger, Value
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.ato.dynamics import Window
from railhil.plant_sim.ato.faults.forces import FeltChecks
from railhil.plant_sim.ato.faults.train import FaultyTrain
from railhil.plant_sim.ato.plant import Plant
from railhil.plant_sim.ato.plant_readings import LINE_VOLTAGE_MIN_PERCENT
from railhil.systems.ato.scenario.model import Balise
from railhil.systems.ato.scenario.perturb import perturb
from railhil.wire.ato import BalisePassed, CtlMode, NotchCmd, NotchSdt, TrnWatch, WatchCause


@pytest.mark.parametrize(
    ("field", "low"),
    [
        *[(name, False) for name in ("power_on", "pantograph_up", "main_breaker_closed", "doors_closed_locked")],
        ("line_voltage_percent", LINE_VOLTAGE_MIN_PERCENT - 0.01),
    ],
)
def test_an_interlock_that_blocks_traction_ends_that_of_a_drive_that_does_not_obey(field: str, low: object) -> None:
    plant = faulty(fault("actuator.traction", "full"))
    plant.status.line_voltage_percent = LINE_VOLTAGE_MIN_PERCENT
    commanded(plant, 256, 4)
    assert plant.traction_n > 0.0
    setattr(plant.status, field, low)
    commanded(plant, 256, 2)
    assert plant.traction_n == 0.0


@pytest.mark.parametrize("mode", [one for one in CtlMode if one is not CtlMode.INITIALISING])
def test_a_new_mode_of_the_controller_is_an_event(mode: CtlMode) -> None:
    plant = faulty(fault("train.doors", "off", Trigger("event", mode.name.lower())))
    (one,) = plant.injections.activities
    plant.take(NotchCmd(0, mode=CtlMode.INITIALISING, life=0))
    plant.advance()
    plant.advance()
    assert not one.active
    plant.take(NotchCmd(0, mode=mode, life=1))
    plant.advance()
    plant.advance()
    assert one.active
    assert not plant.status.doors_closed_locked


def test_a_mode_that_lasts_is_no_event() -> None:
    plant = faulty(fault("train.doors", "off", Trigger("event", "initialising")))
    (one,) = plant.injections.activities
    modes = CtlMode.INITIALISING, next(one for one in CtlMode if one is not CtlMode.INITIALISING), CtlMode.INITIALISING
    active = []
    for life, mode in enumerate(modes):
        plant.take(NotchCmd(0, mode=mode, life=life))
        plant.advance()
        plant.advance()
        active.append(one.active)
    assert active == [False, False, True]
    assert plant.gate.counters["accepted"] == 3


# -- before the first tick ---------------------------------------------------------------------------------------------


def test_a_fault_from_the_start_is_there_before_the_first_tick() -> None:
    plant = faulty(fault("sensor.speed", "value", 0.0, {"value": 5.0}), fault("train.pantograph", "off"))
    assert plant.tick == 0
    assert plant.speed_01mmps == 50_000
    assert not plant.status.pantograph_up


@pytest.mark.parametrize("kind", ["position", "speed"])
def test_the_train_stands_at_the_origin_at_its_start(kind: str) -> None:
    """Nothing has been faster or further before."""
    plant = faulty(fault("train.doors", "off", Trigger(kind, 0.3, edge="falling")))  # type: ignore[arg-type]
    commanded(plant, 0, 3)
    (one,) = plant.injections.activities
    assert one.begun_ns is None


def test_a_fault_of_the_first_tick_is_not_there_before_it() -> None:
    plant = faulty(fault("train.doors", "off", SCENARIO.timing.base_tick_ns / 1e9))
    assert plant.status.doors_closed_locked
    plant.advance()
    assert not plant.status.doors_closed_locked


def test_before_the_first_tick_no_other_force_acts_than_without_faults() -> None:
    plant, healthy = faulty(), Plant(SCENARIO, 0)
    assert (plant._applied_n, plant.accel_mps2) == (healthy._applied_n, healthy.accel_mps2)


# -- a tick ------------------------------------------------------------------------------------------------------------


def test_faults_that_began_change_the_train_once() -> None:
    plant = faulty(fault("train.mass", "scale", 0.05, {"factor": 1.25}))
    for _ in range(5):
        plant.advance()
    assert plant._changed
    assert plant._train.mass_kg == SCENARIO.train.mass_kg
    plant.advance()
    assert not plant._changed
    assert plant._train.mass_kg == plant._actual_train.mass_kg == SCENARIO.train.mass_kg * 1.25


def test_a_train_that_a_fault_changed_is_healthy_after_it() -> None:
    plant = faulty(
        fault("train.mass", "scale", 0.02, {"factor": 1.25}, duration_s=0.03),
        fault("train.gradient", "offset", 0.02, {"permil": 3.0}, duration_s=0.03),
    )
    healthy = faulty()
    found = []
    for _ in range(8):
        plant.advance()
        found.append((plant._constants.mass_kg / healthy._constants.mass_kg, plant.grade_permil - healthy.grade_permil))
    assert found == [(1.0, 0.0)] * 2 + [(pytest.approx(1.25), pytest.approx(3.0))] * 3 + [(1.0, 0.0)] * 3


def test_a_dead_time_is_counted_in_ticks_of_the_train() -> None:
    plant, healthy = faulty(fault("actuator.traction", "dead_time", 0.0, {"delay_s": 0.05})), faulty()
    acting: list[list[int]] = [[], []]
    for _ in range(40):
        for one, found in zip((plant, healthy), acting, strict=True):
            commanded(one, 1200, 1)
            found.append(one.notch_acting)
    assert 1200 in acting[1]
    assert acting[0] == [0] * 5 + acting[1][:-5]


@pytest.mark.parametrize(("sensor", "per_unit"), [("speed", 1e4), ("position", 1e3)])
def test_a_drift_grows_with_the_time_of_the_train(sensor: str, per_unit: float) -> None:
    plant = faulty(fault(f"sensor.{sensor}", "drift", 0.0, {"per_s": 5.0}))
    for _ in range(20):
        plant.advance()
    assert (plant._speed_sensor if sensor == "speed" else plant._position_sensor).error == round(5.0 * 0.2 * per_unit)


@pytest.mark.parametrize("event", ["traction", "departed", "traction_cut"])
def test_what_the_train_does_is_an_event(event: str) -> None:
    """Of its motion, of the run, and of its watch: commands come for 1 s only."""
    plant = faulty(fault("train.main_breaker", "off", Trigger("event", event)))
    commanded(plant, 1200, 100)
    (one,) = plant.injections.activities
    assert (one.begun_ns is None) == (event == "traction_cut")
    for _ in range(30):
        plant.advance()
    assert one.begun_ns is not None


def test_a_balise_is_no_event() -> None:
    plant = faulty(fault("train.doors", "off", Trigger("event", "balise")))
    plant._pass_balise(Balise(9, 50.0, 50.5), 0.0)
    plant.advance()
    plant.advance()
    assert not plant.injections.activities[0].active


@pytest.mark.parametrize(
    ("word", "value", "before"),
    [
        ("mass scale", 1.25, "1"),
        ("resistance scale", 1.5, "1"),
        ("gradient scale", 0.5, "1"),
        ("gradient offset", 2.0, "0"),
    ],
)
def test_a_mismatch_says_what_was_there_before(word: str, value: float, before: str) -> None:
    name, what = word.split()
    values: dict[str, Value] = {"permil" if what == "offset" else "factor": value}
    plant = faulty(fault(f"train.{name}", what, 0.02, values))
    for _ in range(4):
        plant.advance()
    assert shown(plant) == [(1, 0.02, before, str(value))]


def test_each_side_moves_the_train_with_its_own_force_and_pole() -> None:
    plant = faulty(
        fault("actuator.brake", "weak", 0.0, {"share": 0.5}, combine=True),
        fault("actuator.brake", "slow", 0.0, {"factor": 0.25}, combine=True),
    )
    train = SCENARIO.train
    moving(plant)
    assert plant._train.force_per_notch_n == train.force_per_notch_n
    assert plant._constants.pole_per_s == train.actuator_pole_per_s
    commanded(plant, -600, 100)
    assert plant.notch_acting == -600
    assert plant._train.force_per_notch_n == train.force_per_notch_n * 0.5
    assert plant._constants.pole_per_s == plant._train.actuator_pole_per_s == train.actuator_pole_per_s * 0.25


def test_traction_that_nobody_demands_is_felt_and_counts() -> None:
    plant = faulty(fault("actuator.traction", "full", 1.0))
    assert isinstance(plant._own_checks, FeltChecks)
    commanded(plant, 0, 105)
    assert plant._extra_n > 0.0
    assert plant.traction_n == pytest.approx(plant._extra_n)
    commanded(plant, 0, 300)
    assert plant.watch_cause is WatchCause.RUNAWAY


@pytest.mark.parametrize(
    ("traction", "code", "acting"), [(True, 700, 700), (False, 700, 0), (True, -700, -700), (False, -700, -700)]
)
def test_without_traction_only_a_brake_notch_acts(traction: bool, code: int, acting: int) -> None:
    plant = faulty()
    plant._acting_code, plant._window = code, Window(traction, 0.0)
    assert plant.notch_acting == acting


# -- readings ----------------------------------------------------------------------------------------------------------


def test_the_sensors_read_the_axle() -> None:
    """An axle that slips turns faster than the train moves, and has turned further."""
    plant = moving(faulty())
    motion, sensors = plant._motion, plant._sensors
    assert plant.speed_01mmps == sensors.speed_01mmps(motion.speed_mps, plant.tick)
    assert plant.odometer_mm == sensors.odometer_mm(motion.position_m)
    plant._forces.axle.slip_mps, plant._forces.axle.slip_m = 2.0, 7.0
    assert plant.speed_01mmps == sensors.speed_01mmps(motion.speed_mps + 2.0, plant.tick)
    assert plant.odometer_mm == sensors.odometer_mm(motion.position_m + 7.0)
    plant._forces.axle.slip_mps = -1.0 - motion.speed_mps
    assert plant.speed_01mmps == 0
    plant.drain_events()
    plant._pass_balise(Balise(9, 50.0, 50.5), 0.25)
    (event,) = plant.drain_events()
    assert event.odometer_mm == sensors.odometer_between_mm(57.5)
    assert event.balise == Balise(9, 50.0, 50.5)
    assert (event.kind, event.position_01mm) == ("balise", 505_000)
    assert event.instant_01ms == round(plant.tick * 100 + 2500)


def test_a_drawn_train_is_drawn_once_and_then_has_its_mismatch() -> None:
    plant = FaultyTrain(SCENARIO, 3, True, 0.0, [(1, fault("train.mass", "scale", 0.0, {"factor": 1.25}))])
    drawn = perturb(SCENARIO, 3).train
    assert drawn != SCENARIO.train
    assert plant._train == replace(drawn, mass_kg=drawn.mass_kg * 1.25, inertial_mass_kg=drawn.inertial_mass_kg * 1.25)


def test_a_model_that_fails_fails_at_its_instant() -> None:
    plant = faulty(fault("train.model", "nan", 0.02))
    commanded(plant, 1200, 2)
    with pytest.raises(PlantError, match="not finite at tick 3"):
        plant.advance()
    assert shown(plant) == [(1, 0.02, "a number", "nan")]


# -- telegrams ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("what", "check"), [("off", CHECK_ERRONEOUS), ("doubled", CHECK_CORRECT)])
def test_the_telegram_of_a_balise_says_whether_its_value_is_valid(what: str, check: int) -> None:
    plant = faulty(fault("sensor.balise", what))
    plant.drain_events()
    plant._pass_balise(Balise(9, 50.0, 50.5), 0.0)
    telegrams = [plant.telegram_of(event) for event in plant.drain_events()]
    assert [(one.balise_id, one.check) for one in telegrams if isinstance(one, BalisePassed)] == [(9, check)] * (
        1 if what == "off" else 2
    )
    plant._event("watch", 0.0, 0.0)
    plant._event("departed", 0.0, 0.0)
    watch, departed = (plant.telegram_of(event) for event in plant.drain_events())
    assert isinstance(watch, TrnWatch)
    assert departed is None


def test_a_safe_command_has_no_mode() -> None:
    plant = faulty(scenario=replace(SCENARIO, safety=replace(SCENARIO.safety, sdt=True)))
    mode = plant._mode
    plant.take(NotchSdt(0))
    assert plant._mode == mode
