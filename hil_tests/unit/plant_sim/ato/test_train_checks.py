"""The train's own checks: forces that nobody demands, a brake that does not answer, the end of the authority."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from railhil.bench import direct_run
from railhil.common.errors import InputError
from railhil.plant_sim.ato import dynamics
from railhil.plant_sim.ato.command_watch import SUSPICIONS
from railhil.plant_sim.ato.dynamics import Motion
from railhil.plant_sim.ato.plant import Plant
from railhil.plant_sim.ato.train import TrainOnBus
from railhil.plant_sim.ato.train_checks import OwnChecks, is_beyond_authority, train_checks
from railhil.plant_sim.force_tables import train_constants
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import perturbed
from railhil.wire.ato import NotchCmd, WatchCause, WatchLevel

SCENARIO = load("lvshun_tieshan")
EMERGENCY = WatchLevel.EMERGENCY


def with_watch(**limits: Any) -> Scenario:
    return replace(SCENARIO, watch=replace(SCENARIO.watch, **limits))


def driven(plant: Plant, code: int, ticks: int, *, until: WatchLevel | None = None) -> int:
    """Advance with good commands every 20 ms; returns the ticks, at most up to a level."""
    for passed in range(ticks):
        if until is not None and plant.watch_level >= until:
            return passed
        if plant.tick % 2 == 0:
            plant.command(code, False)
        plant.advance()
    return ticks


def running(code: int = 1500, ticks: int = 1500, scenario: Scenario = SCENARIO) -> Plant:
    plant = Plant(scenario, 0)
    driven(plant, code, ticks)
    return plant


# -- forces ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_any_notches_of_a_healthy_train_are_normal(seed: int) -> None:
    plant = Plant(perturbed(SCENARIO, seed), seed)
    for step in range(60):
        driven(plant, (1792, -1792, 0, 700, -300, 0, -1500)[step * (seed + 2) % 7], 50)
        assert plant.watch_level is WatchLevel.NORMAL


def test_traction_that_stays_is_an_emergency_within_half_a_second() -> None:
    plant = running()
    driven(plant, 0, 10)
    stuck_n = plant._motion.actuator_n
    assert stuck_n > 0.0
    for _ in range(50):
        plant._motion = plant._motion._replace(actuator_n=stuck_n)
        driven(plant, 0, 1)
        if plant.watch_level is EMERGENCY:
            break
    assert plant.watch_level is EMERGENCY
    assert plant.watch_cause is WatchCause.RUNAWAY
    driven(plant, 0, 50)
    assert plant.traction_n == 0.0


def test_traction_that_comes_by_itself_is_an_emergency() -> None:
    plant = running()
    driven(plant, -300, 2500)
    plant._motion = plant._motion._replace(actuator_n=20_000.0)
    for _ in range(30):
        plant._motion = plant._motion._replace(actuator_n=20_000.0)
        driven(plant, -300, 1)
    assert (plant.watch_level, plant.watch_cause) == (EMERGENCY, WatchCause.RUNAWAY)


def braked(plant: Plant, share: float, code: int, ticks: int) -> int:
    """Ticks to the emergency with a brake that gives a share of its force."""
    for passed in range(ticks):
        if plant.watch_level is EMERGENCY:
            return passed
        if plant.tick % 2 == 0 and code is not None:
            plant.command(code, False)
        plant._protect()
        position_m, speed_mps, actuator_n, _ = plant._motion
        wanted_n = dynamics.applied_n(plant._constants, plant._window, plant._motion)
        accel_mps2 = (wanted_n * share if wanted_n < 0 else 0.0) / SCENARIO.train.inertial_mass_kg
        decayed_n = actuator_n + (code * SCENARIO.train.force_per_notch_n / 256 - actuator_n) * 0.0034
        plant._motion = Motion(position_m + speed_mps * 0.01, speed_mps + accel_mps2 * 0.01, decayed_n, accel_mps2)
        plant._acting_code = code
        plant.tick += 1
    return ticks


@pytest.mark.parametrize(("share", "is_found"), [(1.0, False), (0.6, False), (0.0, True)])
def test_a_brake_that_does_not_answer(share: float, is_found: bool) -> None:
    """A demand of 1.25 m/s2: within 1 s of the time from which its half exceeds what a grade may take."""
    plant = running(1792, 2500)
    passed = braked(plant, share, -1500, 900)
    assert (plant.watch_level is EMERGENCY) == is_found
    if is_found:
        assert plant.watch_cause is WatchCause.BRAKE_NOT_ANSWERING
        assert passed < 650


def test_demands_that_a_grade_could_hide_are_not_judged() -> None:
    plant = running(1792, 2500)
    assert braked(plant, 0.0, -700, 900) == 900
    checks = OwnChecks(with_watch(brake_share_min_percent=0.0), train_constants(SCENARIO.train))
    for tick in range(300):
        assert checks.finding(tick, -1792, Motion(0.0, 20.0, -300e3, 0.0), 0.0) is WatchCause.NONE


def test_the_watchs_own_brake_is_judged_too() -> None:
    checks = OwnChecks(SCENARIO, train_constants(SCENARIO.train))
    demand_n = SCENARIO.train.service_braking_mps2 * SCENARIO.train.inertial_mass_kg
    moving = Motion(0.0, 20.0, 0.0, 0.0)
    found = [checks.finding(tick, 0, moving, demand_n) for tick in range(106)]
    # At every fifth tick, from 0 on: 20 looks make 1 s.
    assert found[:100] == [WatchCause.NONE] * 100
    assert found[100::5] == [WatchCause.BRAKE_NOT_ANSWERING] * 2
    # Standing, or in traction, the count begins again.
    for code, speed_mps in ((0, 0.0), (5, 20.0)):
        assert checks.finding(110, code, moving._replace(speed_mps=speed_mps), demand_n) is WatchCause.NONE
        assert checks.finding(115, 0, moving, demand_n) is WatchCause.NONE


# -- end of authority -----------------------------------------------------------------------------------------------


def test_the_curve_to_the_end_at_its_edge() -> None:
    checks = train_checks(with_watch(end_of_authority=True, end_of_authority_braking_mps2=0.5))
    end_m = SCENARIO.plan.distance_m + 5.0
    assert checks.end_m == end_m
    for way_m in (400.0, 25.0, 1.0):
        edge_mps = (2 * 0.5 * way_m) ** 0.5
        assert not is_beyond_authority(checks, end_m - way_m, edge_mps - 1e-9)
        assert is_beyond_authority(checks, end_m - way_m, edge_mps + 1e-9)
    assert is_beyond_authority(checks, end_m + 10.0, 0.01)
    assert not is_beyond_authority(checks, end_m + 10.0, 0.0)
    assert not is_beyond_authority(train_checks(SCENARIO), 1e9, 99.0)


@pytest.mark.parametrize("code", [300, 1792])
def test_a_train_that_never_brakes_stops_before_its_end(code: int) -> None:
    """Whatever the controller sends: coasting and traction with good commands."""
    plant = Plant(with_watch(end_of_authority=True, overspeed_margin_mps=100.0), 0)
    driven(plant, code, 60_000, until=EMERGENCY)
    assert plant.watch_cause is WatchCause.END_OF_AUTHORITY
    driven(plant, code, 6000)
    assert plant.true_speed_01mmps == 0
    assert plant.position_01mm / 1e4 <= SCENARIO.plan.distance_m + 5.0


def test_without_an_end_of_authority_it_goes_on() -> None:
    plant = Plant(with_watch(overspeed_margin_mps=100.0), 0)
    driven(plant, 1792, 19_000)
    assert plant.position_01mm / 1e4 > SCENARIO.plan.distance_m + 100.0
    assert plant.watch_level is WatchLevel.NORMAL


def test_an_end_that_the_brake_cannot_keep_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "end.toml"
    head = 'extends = "lvshun_tieshan"\nname = "end"\n[watch]\nend_of_authority = true\n'
    path.write_text(head + "end_of_authority_braking_mps2 = 1.3\n")
    with pytest.raises(
        InputError, match=r"watch\.end_of_authority_braking_mps2: found 1\.3, allowed at most 1\.\d\d m"
    ):
        load(path)
    path.write_text(head)
    end = load(path)
    assert end.watch.weakened == ""
    assert end.sha256 != SCENARIO.sha256


# -- what the gate finds ----------------------------------------------------------------------------------------------


def told(train: TrainOnBus, *commands: NotchCmd) -> tuple[WatchLevel, WatchCause]:
    """State after commands of one tick each, every second tick."""
    for command in commands:
        train.take(command)
        train.advance()
        train.advance()
    return train.watch_level, train.watch_cause


def on_bus(scenario: Scenario = SCENARIO) -> tuple[TrainOnBus, int]:
    train = TrainOnBus(scenario, 0)
    told(train, *(NotchCmd(1000, life=life % 16) for life in range(500)))
    assert train.watch_level is WatchLevel.NORMAL
    return train, 500


def test_a_notch_out_of_range_cuts_traction_at_once() -> None:
    train, life = on_bus()
    assert told(train, NotchCmd(1793, life=life % 16)) == (WatchLevel.TRACTION_CUT, WatchCause.NOTCH_RANGE)
    assert train.traction_n == 0.0
    good = [NotchCmd(1000, life=(life + count) % 16) for count in range(5)]
    assert told(train, *good[:4])[0] is WatchLevel.TRACTION_CUT
    assert told(train, good[4]) == (WatchLevel.NORMAL, WatchCause.NONE)


@pytest.mark.parametrize(("notch", "applied"), [(1700, 1000), (-300, -300)])
def test_too_large_a_step_is_followed_only_as_far_as_it_brakes(notch: int, applied: int) -> None:
    train, life = on_bus(with_watch(notch_step_max=2.0))
    found = told(train, NotchCmd(notch, life=life % 16))
    assert found == (WatchLevel.TRACTION_CUT, WatchCause.NOTCH_STEP)
    assert train._staged_code == applied


def test_two_controllers_brake() -> None:
    train, life = on_bus()
    both = [NotchCmd(1000, life=(life + count // 2 + 3 * (count % 2)) % 16) for count in range(40)]
    assert told(train, *both) == (WatchLevel.SERVICE_BRAKE, WatchCause.TWO_SOURCES)


def test_of_several_findings_of_a_tick_the_strongest_counts() -> None:
    for causes in ((WatchCause.TWO_SOURCES, WatchCause.NOTCH_STEP), (WatchCause.NOTCH_STEP, WatchCause.TWO_SOURCES)):
        train, _ = on_bus()
        for cause in causes:
            train.suspect(cause)
        train.advance()
        assert (train.watch_level, train.watch_cause) == (SUSPICIONS[WatchCause.TWO_SOURCES], WatchCause.TWO_SOURCES)


def test_what_the_age_demands_is_named_first() -> None:
    for silent, level, cause in (
        (7, WatchLevel.TRACTION_CUT, WatchCause.COMMAND_AGE),
        (26, WatchLevel.SERVICE_BRAKE, WatchCause.COMMAND_AGE),
        (4, WatchLevel.TRACTION_CUT, WatchCause.NOTCH_RANGE),
    ):
        train, _ = on_bus()
        for tick in range(silent - 1):
            if tick == silent - 2:
                train.suspect(WatchCause.NOTCH_RANGE)
            train.advance()
        train.advance()
        assert (train.watch_level, train.watch_cause) == (level, cause)


def test_brake_wins_over_traction() -> None:
    train, life = on_bus()
    told(train, NotchCmd(1792, emergency=2, life=life % 16))
    assert (train.watch_level, train.watch_cause) == (EMERGENCY, WatchCause.EMERGENCY_COMMAND)
    assert train.traction_n == 0.0
    assert train.brake_n == SCENARIO.train.brake.force_max_n


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("law", ["ipfc", "fuzzy_pid"])
def test_a_run_that_stops_in_time_never_meets_its_end(law: str) -> None:
    run = direct_run(with_watch(end_of_authority=True), RunSpec(law=LawSpec(law), seed=3, perturbed=True))
    assert not any("emergency" in failure for failure in run.score.failures)
    assert run.notches == direct_run(SCENARIO, RunSpec(law=LawSpec(law), seed=3, perturbed=True)).notches
