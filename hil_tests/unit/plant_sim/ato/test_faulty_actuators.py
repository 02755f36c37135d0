"""Faults of the train's actuators and of the adhesion, each on the plant alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.plant_faults import SCENARIO, commanded, fault, faulty, moving, shown
from railhil.plant_sim.ato.plant import Plant
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import WatchCause, WatchLevel

TRAIN = SCENARIO.train
WEIGHT_N = TRAIN.mass_kg * TRAIN.gravity_mps2


def coasting(plant: Plant) -> None:
    """The train under way without any force, at 25 s."""
    moving(plant, ticks=1500)
    commanded(plant, 0, 1000)
    # What the actuator's lag has left is below 5 % of it.
    assert plant.traction_n < 10e3


def test_the_service_brake_of_the_watch_is_weak_too_the_emergency_brake_is_not() -> None:
    for weak, service_share in ((fault("actuator.brake", "weak", 0.0, {"share": 0.25}), 0.25), (None, 1.0)):
        scenario = replace(SCENARIO, watch=replace(SCENARIO.watch, emergency_ms=6000))
        plant = faulty(*([weak] if weak else []), scenario=scenario)
        moving(plant, ticks=1500)
        for _ in range(500):
            plant.advance()
        assert plant.watch_level is WatchLevel.SERVICE_BRAKE
        service_n = TRAIN.service_braking_mps2 * TRAIN.inertial_mass_kg
        assert plant.brake_n == pytest.approx(service_share * service_n)
        for _ in range(110):
            plant.advance()
        assert plant.watch_level is WatchLevel.EMERGENCY
        assert plant.brake_n == TRAIN.brake.force_max_n


def without_runaway_check(scenario: Scenario = SCENARIO) -> Scenario:
    """The train's own watch never finds too much traction."""
    return replace(scenario, watch=replace(scenario.watch, traction_left_max_percent=200.0))


def test_a_runaway_drive_pulls_until_the_emergency_brake() -> None:
    """C4: traction with a braking notch and under TRACTION CUT; EMERGENCY opens the main breaker."""
    plant = faulty(fault("actuator.traction", "full", 15.0), scenario=without_runaway_check())
    moving(plant, ticks=1490)
    commanded(plant, -300, 70)
    assert plant.traction_n > 0.0
    assert plant.accel_mps2 > 0.0
    for _ in range(10):
        plant.advance()
    assert plant.watch_level is WatchLevel.TRACTION_CUT
    assert plant.traction_n > 0.0
    plant.command(0, True)
    plant.advance()
    plant.advance()
    assert plant.watch_level is WatchLevel.EMERGENCY
    assert plant.traction_n == 0.0
    assert plant.brake_n == TRAIN.brake.force_max_n
    assert shown(plant)[0][:2] == (1, 15.0)


@pytest.mark.parametrize("what", ["full", "stuck"])
def test_the_train_s_own_watch_finds_a_runaway_drive(what: str) -> None:
    """C4: within 0.5 s of the first braking notch, also while the brake works against the drive."""
    plant = faulty(fault("actuator.traction", what, 15.0))
    moving(plant, ticks=1600)
    assert plant.watch_level is WatchLevel.NORMAL
    commanded(plant, -300, 50)
    assert plant.watch_level is WatchLevel.EMERGENCY
    assert plant.watch_cause is WatchCause.RUNAWAY


@pytest.mark.parametrize(("what", "values"), [("off", {}), ("weak", {"share": 0.1})])
def test_the_train_s_own_watch_finds_a_brake_that_does_not_answer(what: str, values: dict[str, float]) -> None:
    """C3, under a notch and under the service brake of the watch itself."""
    for by_notch in (True, False):
        scenario = replace(SCENARIO, watch=replace(SCENARIO.watch, emergency_ms=60_000))
        plant = faulty(fault("actuator.brake", what, 0.0, values), scenario=scenario)
        coasting(plant)
        if by_notch:
            commanded(plant, -1792, 600)
        else:
            for _ in range(500):
                plant.advance()
        assert plant.watch_level is WatchLevel.EMERGENCY
        assert plant.watch_cause is WatchCause.BRAKE_NOT_ANSWERING


# -- adhesion ---------------------------------------------------------------------------------------------------------


def test_wheels_slip_when_the_rail_does_not_carry_the_traction() -> None:
    """The true force is limited, and the axle is faster than the train by Newton's law for the rotating mass."""
    plant = faulty(fault("train.adhesion", "low", 15.0, {"coefficient": 0.03}, duration_s=0.5))
    moving(plant, code=1100, ticks=1500)
    before_mps = plant.speed_01mmps / 1e4
    demand_n = plant.traction_n
    carried_n = 0.03 * WEIGHT_N
    assert demand_n > carried_n
    assert before_mps == pytest.approx(plant.true_speed_01mmps / 1e4, abs=0.02)
    commanded(plant, 1100, 40)
    assert plant.traction_n == pytest.approx(carried_n)
    slip_mps = (demand_n - carried_n) / (TRAIN.inertial_mass_kg - TRAIN.mass_kg) * 0.4
    assert plant.speed_01mmps / 1e4 - plant.true_speed_01mmps / 1e4 == pytest.approx(slip_mps, rel=0.1)
    assert plant.odometer_mm / 1e3 - plant.position_01mm / 1e4 == pytest.approx(slip_mps * 0.2, rel=0.2)
    drift_m = plant.odometer_mm / 1e3 - plant.position_01mm / 1e4
    commanded(plant, 1100, 20)
    # Good adhesion: the axle rolls, the odometer keeps what it counted too much.
    assert plant.speed_01mmps / 1e4 == pytest.approx(plant.true_speed_01mmps / 1e4, abs=0.02)
    assert plant.odometer_mm / 1e3 - plant.position_01mm / 1e4 >= drift_m - 0.01
    number, begun_s, before, after = shown(plant)[0]
    assert (number, begun_s, after) == (1, 15.0, f"{carried_n:.0f} N")
    assert float(before.split()[0]) == pytest.approx(demand_n, rel=1e-3)


def test_wheels_lock_under_the_emergency_brake() -> None:
    plant = faulty(fault("train.adhesion", "low", 15.0, {"coefficient": 0.05}))
    moving(plant, ticks=1500)
    plant.command(0, True)
    for _ in range(200):
        plant.advance()
    assert plant.true_speed_01mmps > 30_000
    assert plant.speed_01mmps == 0
    assert plant.brake_n == pytest.approx(0.05 * WEIGHT_N)
    for _ in range(9000):
        plant.advance()
    assert plant.true_speed_01mmps == 0
    # The odometer has missed what the locked wheels slid.
    assert plant.odometer_mm / 1e3 < plant.position_01mm / 1e4 - 20
