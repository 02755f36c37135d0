"""Scores, columns and figures of high-speed trains, from a run without a bus under a law made for the test."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from railhil.bench import Result, coupled_run
from railhil.charts.svg import markup
from railhil.controller_node.vector.controller import VectorOutput
from railhil.judge.criteria import limited
from railhil.judge.judging import judging_of
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.high_speed import judge, panels
from railhil.systems.high_speed.ride import Ride, milestone

SPEC = RunSpec(law=LawSpec("pid", arithmetic="float64"))
SETTINGS = ("task.start_s=2660", "task.duration_s=200", "task.rmse_max_kmh=90")


def proportional(raws: Sequence[int]) -> VectorOutput:
    """A law for three units: 1 per s of each error, with the running resistance; it reports numbers."""
    speeds, target = raws[:3], raws[17]
    commands = []
    for speed in speeds:
        code = min(max(round((target - speed) / 360 * 1000) + 110, -1300), 550)
        commands += [code, 1 if code > 0 else 2]
    return VectorOutput(tuple(commands), (100, -200, 900, 1050) * 3, 0)


@pytest.fixture(scope="module")
def run() -> Result:
    return coupled_run(load_any("jinan_xuzhou_emu3_emergency", SETTINGS), proportional, SPEC)


@pytest.fixture(scope="module")
def scenario() -> Any:
    return load_any("jinan_xuzhou_emu3_emergency", SETTINGS)


def test_scores_are_those_of_the_record(run: Result, scenario: Any) -> None:
    """Computed here once more from the telegrams."""
    trace, values = run.trace, run.score.values
    target, speed = trace.values("TRUTH", "Target"), trace.values("TRUTH", "TrueSpeed")
    error = (speed - target)[target >= 0.5] * 3.6
    assert values["rmse_kmh"] == pytest.approx(float(np.sqrt(np.mean(error**2))))
    assert values["max_error_kmh"] == pytest.approx(float(np.abs(error).max()))
    called, arrived = milestone(trace, "emergency_called"), milestone(trace, "arrived")
    assert called is not None
    assert arrived is not None
    assert called[1] == pytest.approx(210_000.0, abs=3.4)
    assert values["emergency_stop_m"] == pytest.approx(arrived[1] - called[1])
    # The train is behind the profile by the delay of its brake.
    assert 4380.0 < arrived[1] - called[1] < 4500.0
    assert values["arrival_m"] is None
    per_second = [np.mean([trace.values(f"UNIT{unit}_CMD", f"Unit{unit}Accel")[::25] for unit in (1, 2, 3)], axis=0)]
    assert values["slope_mps3"] == pytest.approx(float(np.sqrt(np.mean(np.diff(per_second[0])[:199] ** 2))), rel=0.02)
    assert values["coupler_peak_kn"] == pytest.approx(
        max(np.abs(trace.values("TRUTH", f"Coupler{number}")).max() for number in (1, 2))
    )
    assert run.score.verdict == "PASS"


def test_energy_is_the_work_of_the_traction(run: Result, scenario: Any) -> None:
    ride = Ride.of(scenario, run.trace)
    before = ride.time_s < 70.0
    power_w = 428_000 * 1.06 * 0.117 * 300 / 3.6
    shorter = power_w * 70.0 / 3.6e6
    assert 0.8 * shorter < ride.energy_kwh() < 1.4 * shorter
    assert (ride.drive_mps2[before] > 0.0).mean() > 0.9


@pytest.mark.slow
def test_limits_and_units_that_act_alone_fail(run: Result, scenario: Any) -> None:
    strict = load_any("jinan_xuzhou_emu3_emergency", [*SETTINGS[:2], "task.rmse_max_kmh=0.001"])
    failures = judge.score(strict, run.trace).failures
    assert len(failures) == 1
    assert failures[0].startswith("RMSE ")
    short = judge.score(
        load_any("jinan_xuzhou_emu3_emergency", [*SETTINGS, "task.emergency_stop_max_m=1000"]), run.trace
    )
    assert short.failures[0].startswith("emergency stop ")
    assert [one.name for one in limited(judge.EMU3.criteria, scenario)] == ["RMSE", "emergency_stop"]
    short_run = load_any("hst_short")
    assert [one.key for one in judge.HST1.criteria if not one.applies(short_run)] == [
        "arrival_m",
        "emergency_rmse_kmh",
        "emergency_stop_m",
    ]
    assert all(one.applies(load_any("jinan_xuzhou")) for one in judge.HST1.criteria if "arrival" in one.key)
    early = coupled_run(load_any("jinan_xuzhou_emu3_emergency", [*SETTINGS, "task.duration_s=90"]), proportional, SPEC)
    assert early.score.failures == ("no emergency stop, allowed at most 4500 m",)


@pytest.mark.parametrize("setting", ["task.duration_s=0.4", "task.duration_s=3", "task.start_s=5000"])
def test_a_run_of_which_nothing_is_scored_is_invalid(setting: str) -> None:
    """Too short for the target to start, or the train stands at its end all the time: no limit can be missed."""
    done = coupled_run(load_any("emu3_short", ["task.duration_s=3", setting]), proportional, SPEC)
    assert (done.score.verdict, done.score.failures) == (
        "INVALID",
        ("nothing to score: the target stays below 0.5 m/s",),
    )
    done = coupled_run(load_any("emu3_short", ["task.duration_s=8", "task.rmse_max_kmh=9"]), proportional, SPEC)
    assert done.score.verdict == "PASS"


def test_every_port_of_a_column_is_in_the_contract(run: Result, scenario: Any) -> None:
    table = judging_of(scenario)
    assert all(run.trace.has(port, signal) for _, port, signal in table.columns)


def test_the_figures_show_speed_units_couplers_and_estimates(run: Result, scenario: Any) -> None:
    shown = SimpleNamespace(
        label="p", controller="pid", can_be_drawn=True, scenario=scenario, trace=run.trace, certificate={}
    )
    found = panels.pictures(scenario, [shown])
    assert [one.name for one in found] == ["speed", "units", "couplers", "estimates1", "estimates2", "estimates3"]
    assert "gain" in [chart.y_label for chart in found[3].charts]
    assert "true value" in {curve.label for chart in found[3].charts for curve in chart.curves}
    # Lines have as many points as can be seen.
    assert max(len(markup(one)) for one in found) < 250_000
    assert panels.pictures(scenario, [SimpleNamespace(label="p", controller="pid", can_be_drawn=False)]) == []
