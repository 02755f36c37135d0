"""Single steps of the stopping laws: trigger, gaps of the speed, stages, wet rail."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.laws.memory import Remembered
from railhil.controller_node.stop.interface import STOP
from railhil.controller_node.stop.laws.ilc_stop import IlcStop, IlcStopParameters
from railhil.controller_node.stop.laws.reaim import Reaim, ReaimParameters
from railhil.controller_node.stop.model import StoppingDistance
from railhil.controller_node.stop.numbers import Numbers
from railhil.systems.stop.task import StopTask
from railhil.wire.stop import BrakeLevel, Stage

NAMES = [reading.name for reading in STOP.readings]
NOTES = [note.name for note in STOP.notes]
SPEED_MPS = 60 / 3.6
TICK_M = SPEED_MPS * 0.016


def scenario(**changes: Any) -> Any:
    keys = {
        "duration_s": 60.0,
        "platform": "board",
        "direction": "up",
        "stop_m": 2631.0,
        "start_m": 2331.0,
        "start_kmh": 60.0,
        "grade": ((0.0, 0.0),),
        "true": {"delay_s": 0.64, "lag_s": 0.42},
    }
    task = StopTask.model_validate({**keys, **changes})
    return SimpleNamespace(task=task, timing=SimpleNamespace(control_period_ns=16_000_000))


class Driven:
    """A law whose train runs at 60 km/h, whatever it commands."""

    def __init__(self, law: Any, parameters: Any, memory: Any = None, **changes: Any) -> None:
        self.law = law(make("float64"), scenario(**changes), parameters, Remembered(memory))
        self.state: Any = None
        self.tick = 0
        self.given = dict.fromkeys(NAMES, 0.0) | {"run": 3.0}

    def step(self, *, fresh: bool = True, **readings: float) -> dict[str, float]:
        odometer_m = self.tick * TICK_M
        if fresh:
            speeds = {f"speed{n}": SPEED_MPS * 1e3 for n in range(1, 6)}
            self.given |= {**speeds, "speed_count": float(self.tick % 65536), "speed_valid": 1.0}
        self.given |= {"odometer": odometer_m * 1e3, **readings}
        values = [self.given[name] for name in NAMES]
        if self.state is None:
            self.state = self.law.start(values)
        self.state, answer = self.law.step(self.state, values)
        self.tick += 1
        found = dict(zip(("u", "start", "valid"), answer.commands, strict=True))
        return {**found, **dict(zip(NOTES, answer.notes, strict=True)), "odometer_m": odometer_m}

    def until(self, stage: int, **readings: float) -> dict[str, float]:
        for _ in range(3000):
            found = self.step(**readings)
            if found["stage"] == stage:
                return found
        raise AssertionError(f"never reached {stage}")


def needed_m(decel_mps2: float = 0.8) -> float:
    return float(StoppingDistance(Numbers(make("float64")), 0.6, 0.4)(SPEED_MPS, decel_mps2).distance)


@pytest.mark.parametrize("epsilon_m", [0.0, 0.1, 0.4])
@pytest.mark.parametrize("trigger", ["one_sided", "window_or_late"])
def test_the_brake_begins_in_the_first_cycle_within_epsilon(epsilon_m, trigger):
    found = Driven(IlcStop, IlcStopParameters(epsilon_m=epsilon_m, trigger=trigger)).until(Stage.BRAKE)
    margin_m = 300.0 - found["odometer_m"] - needed_m()
    assert found["margin"] == pytest.approx(1e3 * margin_m, abs=1e-6)
    if trigger == "one_sided":
        assert epsilon_m - TICK_M < margin_m <= epsilon_m
    else:
        assert margin_m <= epsilon_m
    assert (found["u"], found["start"], found["valid"]) == (-800.0, 0.0, 1.0)


def test_the_window_alone_can_be_jumped_over_and_then_the_train_never_brakes():
    driven = Driven(IlcStop, IlcStopParameters(epsilon_m=0.01, trigger="window"))
    stages = {driven.step()["stage"] for _ in range(1200)}
    assert stages == {Stage.TRACK, Stage.ARMED}


def test_a_start_instant_inside_the_cycle_is_where_the_margin_is_epsilon():
    found = Driven(IlcStop, IlcStopParameters(start_inside_cycle=True)).until(Stage.BRAKE)
    place_m = found["odometer_m"] + found["start"] / 1e4 * SPEED_MPS
    assert 0.0 < found["start"] < 160.0
    assert 300.0 - place_m - needed_m() == pytest.approx(0.4, abs=1e-3)


def test_a_learned_offset_moves_the_start_and_is_reported():
    values = {
        "version": 1,
        "records": [
            {"load_class": 0, "wet": 0, "offset_m": 3.0, "variance_m2": 0.02, "runs": 9, "last_run": 9},
            {"load_class": 2, "wet": 0, "offset_m": -2.0, "variance_m2": 0.02, "runs": 5, "last_run": 9},
        ],
    }
    found = Driven(IlcStop, IlcStopParameters(), values).until(Stage.BRAKE)
    plain = Driven(IlcStop, IlcStopParameters()).until(Stage.BRAKE)
    assert plain["odometer_m"] - found["odometer_m"] == pytest.approx(3.0, abs=TICK_M)
    assert (found["offset"], found["memory_offset"], found["memory_runs"]) == (3000.0, 3000.0, 9.0)
    assert found["memory_variance"] == pytest.approx(200.0)
    assert Driven(IlcStop, IlcStopParameters(), values).step(load=80.0)["memory_offset"] == -2000.0


def test_a_wet_rail_is_braked_by_its_own_rate():
    found = Driven(IlcStop, IlcStopParameters()).until(Stage.BRAKE, wet=1.0)
    assert found["u"] == -550.0
    assert 300.0 - found["odometer_m"] - needed_m(0.55) <= 0.4


def test_gaps_of_three_cycles_are_bridged_and_longer_ones_forbid_to_brake():
    driven = Driven(IlcStop, IlcStopParameters())
    driven.until(Stage.ARMED)
    for _ in range(3):
        assert driven.step(fresh=False)["stage"] == Stage.ARMED
    assert driven.step()["stage"] == Stage.ARMED
    for _ in range(4):
        found = driven.step(fresh=False)
    assert found["stage"] == Stage.TRACK
    # 128 new samples until it may be armed again.
    stages = [driven.step()["stage"] for _ in range(27)]
    assert stages == [Stage.TRACK] * 25 + [Stage.ARMED] * 2


def test_samples_that_are_not_valid_are_a_gap_too():
    driven = Driven(IlcStop, IlcStopParameters())
    driven.until(Stage.ARMED)
    for _ in range(4):
        found = driven.step(speed_valid=0.0)
    assert found["stage"] == Stage.TRACK


@pytest.mark.parametrize(("law", "parameters"), [(IlcStop, IlcStopParameters()), (Reaim, ReaimParameters())])
def test_while_it_brakes_a_gap_keeps_the_command(law, parameters):
    driven = Driven(law, parameters)
    driven.until(Stage.BRAKE)
    for _ in range(60):
        before = driven.step()
    for _ in range(10):
        found = driven.step(fresh=False)
        assert (found["stage"], found["u"]) == (Stage.BRAKE, before["u"])


def test_it_is_not_armed_before_the_filter_is_warm():
    driven = Driven(IlcStop, IlcStopParameters(), start_m=2400.0)
    # The brake is due at once, but the first 128 samples are awaited.
    stages = [driven.step()["stage"] for _ in range(29)]
    assert Stage.BRAKE not in stages[:26]
    assert driven.until(Stage.BRAKE)["u"] == -800.0


@pytest.mark.parametrize(
    ("spoils", "learned"),
    [({}, True), ({"slide": 1.0}, False), ({"level": float(BrakeLevel.SERVICE_BRAKE)}, False)],
)
def test_a_run_is_learned_at_standstill_unless_it_was_spoiled(spoils, learned):
    driven = Driven(IlcStop, IlcStopParameters())
    driven.until(Stage.BRAKE)
    driven.step(**spoils)
    driven.step(slide=0.0, level=0.0)
    driven.until(Stage.STANDSTILL, standstill=1.0)
    found = [driven.step(report_run=3.0, report_error=2000.0) for _ in range(4)][-1]
    records = driven.law.memory(driven.state)["records"]
    assert [(one["offset_m"], one["last_run"]) for one in records] == ([(1.0, 3)] if learned else [])
    assert found["stage"] == Stage.LEARN


def test_a_run_in_which_the_controller_lost_its_readings_is_not_learned():
    driven = Driven(IlcStop, IlcStopParameters())
    driven.until(Stage.BRAKE)
    driven.state = driven.law.with_sent(driven.state, [0.0, 0.0, 0.0])
    driven.until(Stage.STANDSTILL, standstill=1.0)
    driven.step(report_run=3.0, report_error=2000.0)
    assert driven.law.memory(driven.state)["records"] == []


@pytest.mark.parametrize(("own", "report"), [(3.0, 9.0), (3.0, 4.0), (3.0, 2.0), (0.0, 3.0)])
@pytest.mark.parametrize("learning", ["offset", "rls_load"])
def test_the_report_of_another_run_is_not_learned(own, report, learning):
    driven = Driven(IlcStop, IlcStopParameters(learning=learning))
    driven.until(Stage.BRAKE)
    driven.until(Stage.STANDSTILL, standstill=1.0)
    before = driven.law.memory(driven.state)
    assert driven.step(run=own, report_run=report, report_error=2000.0)["stage"] == Stage.STANDSTILL
    assert driven.law.memory(driven.state) == before
    # Its own report comes after all.
    driven.step(run=3.0, report_run=3.0, report_error=2000.0)
    assert driven.law.memory(driven.state) != before


@pytest.mark.parametrize(("law", "parameters"), [(IlcStop, IlcStopParameters()), (Reaim, ReaimParameters())])
def test_the_command_that_a_law_goes_on_from_is_the_one_on_the_bus(law, parameters):
    driven = Driven(law, parameters)
    driven.until(Stage.BRAKE)
    for _ in range(60):
        found = driven.step()
        assert found["u"] == int(found["u"])
        assert driven.state.accel == pytest.approx(found["u"] / 1e3, abs=1e-12)
    driven.state = driven.law.with_sent(driven.state, [-700.0, 0.0, 1.0])
    assert driven.state.accel == pytest.approx(-0.7, abs=1e-12)
    assert driven.state.learned.spoiled == 0.0
    driven.state = driven.law.with_sent(driven.state, [0.0, 0.0, 0.0])
    assert driven.state.accel == pytest.approx(-0.7, abs=1e-12)
    assert driven.state.learned.spoiled == 1.0


def test_from_standstill_the_train_starts_when_its_doors_are_closed():
    driven = Driven(IlcStop, IlcStopParameters(), start_kmh=0.0)
    still = {f"speed{n}": 0.0 for n in range(1, 6)} | {"standstill": 1.0}
    assert {driven.step(doors=1.0, **still)["stage"] for _ in range(3)} == {Stage.IDLE}
    found = [driven.step(doors=0.0, **still) for _ in range(60)]
    assert found[0]["stage"] == Stage.START
    assert found[-1]["u"] == pytest.approx(600.0)
    slow = {f"speed{n}": 8000.0 for n in range(1, 6)} | {"standstill": 0.0}
    assert driven.until(Stage.ACCELERATE, **slow)["u"] == pytest.approx(600.0, abs=20.0)
    driven.given |= {f"speed{n}": 0.0 for n in range(1, 6)}
    assert driven.until(Stage.TRACK)["stage"] == Stage.TRACK


def test_another_sampling_period_than_a_multiple_of_the_cycle_is_refused():
    with pytest.raises(Exception, match="sample_period_ms"):
        Driven(Reaim, ReaimParameters(sample_period_ms=50))


def test_the_command_of_the_re_aim_stays_between_its_samples():
    driven = Driven(Reaim, ReaimParameters())
    driven.until(Stage.BRAKE)
    commands = [driven.step()["u"] for _ in range(40)]
    changes = [i for i in range(1, 40) if commands[i] != commands[i - 1]]
    assert {b - a for a, b in pairwise(changes)} == {4}
    assert max(abs(commands[i] - commands[i - 1]) for i in changes) <= 48.0 + 1e-9


# -- a law that joins a run under way ---------------------------------------------------------------------------------


def joined(law: Any, parameters: Any, speed_mps: float, at_m: float, **changes: Any) -> Driven:
    """A law that begins while the train is ``at_m`` from the start, at another speed than that of the run."""
    driven = Driven(law, parameters, **changes)
    driven.tick = round(at_m / TICK_M)
    driven.given |= {f"speed{n}": speed_mps * 1e3 for n in range(1, 6)}
    return driven


LAWS = [(IlcStop, IlcStopParameters()), (Reaim, ReaimParameters())]
UPHILL = {"grade": ((0.0, 10.0),)}


@pytest.mark.parametrize(("law", "parameters"), LAWS)
@pytest.mark.parametrize("doors", [0.0, 1.0])
@pytest.mark.parametrize("start_kmh", [0.0, 60.0])
def test_after_a_restart_at_the_platform_the_train_is_not_driven(law, parameters, doors, start_kmh):
    driven = joined(law, parameters, 0.0, 300.0, start_kmh=start_kmh, **UPHILL)
    still = {f"speed{n}": 0.0 for n in range(1, 6)} | {"standstill": 1.0, "doors": doors}
    found = [driven.step(odometer=300e3, **still) for _ in range(60)]
    assert max(one["u"] for one in found) <= 0.0
    assert {one["stage"] for one in found} <= {Stage.STANDSTILL, Stage.LEARN}


@pytest.mark.parametrize(("law", "parameters"), LAWS)
def test_after_a_restart_in_a_train_that_rolls_to_its_stop_it_brakes(law, parameters):
    driven = joined(law, parameters, 0.3, 299.0)
    slow = {f"speed{n}": 300.0 for n in range(1, 6)}
    found = [driven.step(odometer=299.9e3, **slow) for _ in range(160)]
    assert found[-1]["stage"] == Stage.BRAKE
    assert found[-1]["u"] < -100.0


def test_a_run_that_the_controller_joined_under_way_is_not_learned():
    driven = joined(IlcStop, IlcStopParameters(), SPEED_MPS, 200.0)
    driven.until(Stage.STANDSTILL, standstill=1.0, report_run=3.0, report_error=2000.0)
    driven.until(Stage.LEARN)
    assert driven.law.memory(driven.state)["records"] == []


def test_an_estimate_that_never_settles_defers_the_brake_by_half_a_second():
    driven = Driven(IlcStop, IlcStopParameters())
    driven.until(Stage.ARMED)
    found = {"stage": Stage.ARMED}
    while found["stage"] != Stage.BRAKE:
        for fresh in (False,) * 4 + (True,) * 10:
            found = driven.step(fresh=fresh)
            if found["stage"] == Stage.BRAKE:
                break
        assert driven.tick < 3000
    late_m = found["odometer_m"] - (300.0 - needed_m())
    assert late_m == pytest.approx(0.5 * SPEED_MPS, abs=4 * TICK_M)


@pytest.mark.parametrize(("law", "parameters"), LAWS)
@pytest.mark.parametrize("stage", [Stage.TRACK, Stage.ARMED])
def test_a_train_that_was_stopped_on_its_way_is_not_driven_again(law, parameters, stage):
    driven = Driven(law, parameters, **UPHILL)
    driven.until(stage)
    still = {f"speed{n}": 0.0 for n in range(1, 6)} | {"standstill": 1.0, "doors": 1.0}
    found = [driven.step(**still) for _ in range(60)]
    assert {one["stage"] for one in found} == {Stage.STANDSTILL}
    assert found[-1]["u"] <= 0.0


@pytest.mark.parametrize(("law", "parameters"), LAWS)
@pytest.mark.parametrize("stage", [Stage.TRACK, Stage.ARMED])
def test_a_standstill_that_the_speed_contradicts_does_not_stop_the_train_on_its_way(law, parameters, stage):
    driven = Driven(law, parameters)
    driven.until(stage)
    assert {driven.step(standstill=1.0)["stage"] for _ in range(8)} <= {Stage.TRACK, Stage.ARMED}
    assert driven.until(Stage.BRAKE, standstill=0.0)["odometer_m"] > 100.0
