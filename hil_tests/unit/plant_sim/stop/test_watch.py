"""The watch of a train that stops at a platform: its ladder, cause by cause."""

from __future__ import annotations

from hil_tests.support.stops import EXACT, FLAT, stop_scenario
from railhil.faults.language import parse
from railhil.plant_sim.stop.faults import FaultyStopPlant
from railhil.plant_sim.stop.watch import StopWatch
from railhil.wire.stop import BrakeCause, BrakeLevel

TICK_NS = 16_000_000
HOLD_TICKS = 63


def watch() -> StopWatch:
    return StopWatch(TICK_NS, TICK_NS, service_mps2=0.8, lag_s=0.4)


def looked(one: StopWatch, ticks: range) -> list[tuple[BrakeLevel, float | None]]:
    found = []
    for tick in ticks:
        command = one.look(tick, 0.0, 0.0, False)
        found.append((one.level, command))
    return found


def test_a_train_that_brakes_holds_the_last_command_and_then_takes_the_service_brake() -> None:
    one = watch()
    assert one.command(0, -0.5, True) == -0.5
    seen = looked(one, range(1, 80))
    assert seen[1] == (BrakeLevel.NORMAL, None)
    assert seen[2] == (BrakeLevel.HOLD, -0.5)
    assert seen[2 + HOLD_TICKS] == (BrakeLevel.SERVICE_BRAKE, -0.8)
    assert one.cause is BrakeCause.COMMAND_AGE
    assert one.command(80, -0.6, True) == -0.6
    assert (one.level, one.cause) == (BrakeLevel.NORMAL, BrakeCause.NONE)


def test_a_stronger_command_than_the_service_brake_stays() -> None:
    one = watch()
    one.command(0, -1.1, True)
    assert looked(one, range(1, 80))[-1] == (BrakeLevel.SERVICE_BRAKE, -1.1)


def test_a_train_that_does_not_brake_never_coasts_for_longer_than_a_second() -> None:
    one = watch()
    one.command(0, 0.03, True)
    seen = looked(one, range(1, 80))
    assert seen[2] == (BrakeLevel.TRACTION_CUT, 0.0)
    assert seen[2 + HOLD_TICKS] == (BrakeLevel.SERVICE_BRAKE, -0.8)


def test_a_controller_without_readings_is_as_one_that_is_silent() -> None:
    one = watch()
    one.command(0, -0.8, True)
    for tick in range(1, 70):
        one.command(tick, 0.0, False)
        one.look(tick, 0.0, 0.0, False)
    assert (one.level, one.cause) == (BrakeLevel.SERVICE_BRAKE, BrakeCause.CONTROLLER_SAFE)


def test_a_brake_that_does_not_answer_is_replaced_by_the_emergency_brake() -> None:
    one = watch()
    for tick in range(300):
        one.command(tick, -0.8, True)
        one.look(tick, -0.8, -0.1, False)
    assert (one.level, one.cause) == (BrakeLevel.EMERGENCY, BrakeCause.BRAKE_NOT_ANSWERING)
    assert one.command(300, 0.5, True) is None


def plant_with(*faults: str) -> FaultyStopPlant:
    numbered = [(number, parse(text if "@" in text else f"{text} @0s")) for number, text in enumerate(faults, 1)]
    return FaultyStopPlant(stop_scenario(*EXACT, *FLAT), 0, False, 0.0, 1, numbered)


def braked(plant: FaultyStopPlant, ticks: int = 400) -> FaultyStopPlant:
    for tick in range(ticks):
        plant.watch.command(tick, -0.8, True)
        plant.train.command(-0.8)
        plant.advance()
    return plant


class TestFaults:
    def test_of_the_brake(self) -> None:
        assert abs(braked(plant_with("actuator.brake weak 50%")).train.motion.drive_mps2 + 0.394) < 1e-6
        assert abs(braked(plant_with("train.gain scale 0.9")).train.motion.drive_mps2 + 0.8 * 0.985 * 0.9) < 1e-6
        stuck = braked(plant_with("actuator.brake stuck @1s"))
        assert abs(stuck.train.motion.drive_mps2 + 0.8 * 0.985) < 1e-6

    def test_of_delay_and_lag(self) -> None:
        calm = braked(plant_with("train.gain scale 1"), 60).train.motion
        for fault in ("train.delay longer 200ms", "train.lag scale 2", "actuator.brake slow 0.5",
                      "actuator.brake dead_time 200ms"):  # fmt: skip
            assert braked(plant_with(fault), 60).train.motion.drive_mps2 > calm.drive_mps2 + 0.05, fault

    def test_a_brake_that_is_off_ends_in_the_emergency_brake(self) -> None:
        plant = braked(plant_with("actuator.brake off"))
        assert plant.watch.level is BrakeLevel.EMERGENCY
        assert abs(plant.train.motion.drive_mps2 + 1.2) < 1e-3

    def test_an_open_safety_loop_is_the_emergency_brake_for_good(self) -> None:
        plant = braked(plant_with("train.safety_loop off @1s for 500ms"))
        assert (plant.watch.level, plant.watch.cause) == (BrakeLevel.EMERGENCY, BrakeCause.NONE)
        assert abs(plant.train.motion.drive_mps2 + 1.2) < 1e-3
        assert braked(plant_with("train.safety_loop off @60s")).watch.level is BrakeLevel.NORMAL

    def test_of_the_adhesion(self) -> None:
        plant = braked(plant_with("adhesion low 0.05"))
        assert plant.train.slides
        assert abs(plant.train.accel_mps2 + 0.4905) < 1e-9
        assert plant.makers["SPEED_RAW"]().slide == 1  # type: ignore[union-attr]

    def test_of_the_speed_sensor_in_all_five_samples(self) -> None:
        plant = plant_with("sensor.speed offset 1")
        telegram = plant.makers["SPEED_RAW"]()
        assert {getattr(telegram, f"speed{n}") for n in range(1, 6)} == {17667}
        plant = plant_with("sensor.speed off")
        telegram = plant.makers["SPEED_RAW"]()
        assert telegram is not None
        assert (telegram.valid, telegram.check, telegram.speed5) == (0, 0, 0)  # type: ignore[attr-defined]

    def test_of_the_odometer(self) -> None:
        plant, found = plant_with("sensor.position stuck @1s"), []
        for _ in range(100):
            found.append(plant.makers["ODO"]().odometer)  # type: ignore[union-attr]
            plant.advance()
        assert abs(found[-1] - 16_667) < 300
        assert found[-1] == found[70] > found[50]

    def test_of_the_balises(self) -> None:
        scenario = stop_scenario(
            *EXACT, *FLAT, "task.balises_m=[100]", "task.start_m=2530", "task.sensors.balise_sigma_m=0"
        )
        found = []
        for fault in ("balise missed", "balise off", "balise wrong 2", "balise doubled"):
            plant = FaultyStopPlant(scenario, 0, False, 0.0, 1, [(1, parse(f"{fault} @0s"))])
            for _ in range(20):
                plant.advance()
            found.append(plant.train.passed)
        assert [passed.balise for passed in found] == [0, 0, 1, 1]
        assert abs(found[2].odometer_m - 3.0) < 1e-9
        assert abs(found[3].odometer_m - 1.0) < 1e-9
