"""The train's own checks: forces that nobody demands, a brake that does not answer, the end of the authority."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from railhil.bench import direct_run
from railhil.common.errors import InputError
from railhil.plant_sim.ato.command_watch import SUSPICIONS
from railhil.plant_sim.ato.plant import Plant
from railhil.plant_sim.ato.train import TrainOnBus
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import perturb
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


# -- forces ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_any_notches_of_a_healthy_train_are_normal(seed: int) -> None:
    plant = Plant(perturb(SCENARIO, seed), seed)
    for step in range(60):
        driven(plant, (1792, -1792, 0, 700, -300, 0, -1500)[step * (seed + 2) % 7], 50)
        assert plant.watch_level is WatchLevel.NORMAL


# -- end of authority -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("code", [300, 1792])
def test_a_train_that_never_brakes_stops_before_its_end(code: int) -> None:
    """Whatever the controller sends: coasting and traction with good commands."""
    plant = Plant(with_watch(end_of_authority=True, overspeed_margin_mps=100.0), 0)
    driven(plant, code, 60_000, until=EMERGENCY)
    assert plant.watch_cause is WatchCause.END_OF_AUTHORITY
    driven(plant, code, 6000)
    assert plant.true_speed_01mmps == 0
    assert plant.position_01mm / 1e4 <= SCENARIO.plan.distance_m + 5.0


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


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("law", ["ipfc", "fuzzy_pid"])
def test_a_run_that_stops_in_time_never_meets_its_end(law: str) -> None:
    run = direct_run(with_watch(end_of_authority=True), RunSpec(law=LawSpec(law), seed=3, perturbed=True))
    assert not any("emergency" in failure for failure in run.score.failures)
    assert run.commands("notch") == direct_run(SCENARIO, RunSpec(law=LawSpec(law), seed=3, perturbed=True)).commands(
        "notch"
    )
