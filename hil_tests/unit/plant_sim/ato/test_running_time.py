"""Shortest running times: published ones, closed forms, and constraints on the result."""

from __future__ import annotations

import csv
from dataclasses import replace
from itertools import pairwise
from math import sqrt

import pytest

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.running_time import CELL_M, CannotMove, flat_out_run, running_time_s
from railhil.scenarios.load import load
from railhil.scenarios.profiles import find_lowest, profile_value
from railhil.systems.ato.scenario.importers.railtoolkit import load_line, load_train
from railhil.systems.ato.scenario.model import Effort, Line, Train

DATA = TEST_DATA / "railtoolkit"
#: The published times come from an explicit 20 m step and carry up to 0.58 % of step error.
TOLERANCE = 0.006

with (DATA / "expected" / "running_times.csv").open(encoding="utf-8", newline="") as table:
    PUBLISHED = [(row["train"], row["path"], float(row["running_time_s"])) for row in csv.DictReader(table)]


def railtoolkit(train: str, path: str) -> tuple[Train, Line, float]:
    line = load_line(DATA / "paths" / f"{path}.yaml", train_length_m=0)
    stock = load_train(DATA / "trains" / f"{train}.yaml", actuator_pole_per_s=0.34, accel_per_notch_mps2=0.2)
    return stock, line.line, line.stops[-1].position_m


def test_all_nine_published_times_are_there() -> None:
    assert len(PUBLISHED) == 9


@pytest.mark.parametrize(("train", "path", "published_s"), PUBLISHED)
def test_published_running_times(train: str, path: str, published_s: float) -> None:
    assert running_time_s(*railtoolkit(train, path)) == pytest.approx(published_s, rel=TOLERANCE)


@pytest.mark.parametrize(("train", "path"), [("local", "const"), ("freight", "slope"), ("longdistance", "speed")])
def test_the_cell_is_fine_enough(train: str, path: str) -> None:
    stock, line, distance_m = railtoolkit(train, path)
    fine_s = flat_out_run(stock, line, distance_m, CELL_M / 8)[-1].time_s
    assert running_time_s(stock, line, distance_m) == pytest.approx(fine_s, rel=2e-5)


#: 100 t without resistance, pulling 100 kN, braking at 0.5 m/s2: 1 m/s2 up, 0.5 m/s2 down.
BARE = Train(
    name="bare",
    mass_kg=100e3,
    inertial_mass_kg=100e3,
    length_m=50.0,
    davis_a_n_per_kn=0.0,
    davis_b_n_per_kn_kmh=0.0,
    davis_c_n_per_kn_kmh2=0.0,
    traction=Effort(100e3),
    brake=Effort(100e3),
    actuator_pole_per_s=1.0,
    force_per_notch_n=10e3,
    service_braking_mps2=0.5,
)


def level(*limits: tuple[float, float]) -> Line:
    return Line("level", ((0.0, 0.0),), limits)


def test_trapezoid_has_its_closed_form() -> None:
    # 20 m/s: 200 m and 20 s up, 400 m and 40 s down, 400 m and 20 s between.
    assert running_time_s(BARE, level((0.0, 20.0)), 1000.0) == pytest.approx(80.0, abs=1e-6)


def test_triangle_has_its_closed_form() -> None:
    # Never at the limit: up over d/3 to sqrt(2d/3), down over 2d/3.
    distance_m = 300.0
    top_mps = sqrt(2 * distance_m / 3)
    expected_s = top_mps / 1.0 + top_mps / 0.5
    assert running_time_s(BARE, level((0.0, 90.0)), distance_m) == pytest.approx(expected_s, rel=1e-3)


def test_a_slow_part_is_kept_until_the_rear_has_left_it() -> None:
    # 20 m/s, 10 m/s from 500 to 600 m: braking from 200 m on is 300 m before, the front is slow for 100 + 50 m.
    points = flat_out_run(BARE, level((0.0, 20.0), (500.0, 10.0), (600.0, 20.0)), 2000.0)
    up, down = 200 / 10, (20 - 10) / 0.5
    slow_s, again_s, stop_s = 150 / 10, (20 - 10) / 1.0, 20 / 0.5
    cruise_s = (2000 - 650 - 150 - 400) / 20
    assert points[-1].time_s == pytest.approx(up + down + slow_s + again_s + cruise_s + stop_s, rel=1e-5)


@pytest.mark.parametrize("name", ["lvshun_tieshan", "yizhuang_03_xiaohongmen_jiugong"])
def test_runs_keep_to_limits_braking_and_timetable(name: str) -> None:
    scenario = load(name)
    train, plan = scenario.train, scenario.plan
    points = flat_out_run(train, scenario.line, plan.distance_m)
    limit = find_lowest(scenario.line.speed_limit_mps, train.length_m, train.speed_limit_mps)
    for before, point in pairwise(points):
        assert point.time_s > before.time_s
        inside_m = (before.position_m + point.position_m) / 2
        assert (before.speed_mps + point.speed_mps) / 2 <= profile_value(limit, inside_m) + 1e-9
        braking_mps2 = (before.speed_mps - point.speed_mps) / (point.time_s - before.time_s)
        assert braking_mps2 <= train.service_braking_mps2 * (1 + 1e-6)
    assert points[-1].position_m == plan.distance_m
    assert points[-1].speed_mps == 0.0
    assert 0.7 * plan.running_time_s < points[-1].time_s < plan.running_time_s


def test_a_grade_too_steep_is_one_clear_line() -> None:
    line = replace(level((0.0, 20.0)), grade_permil=((0.0, 0.0), (200.0, 120.0)))
    with pytest.raises(CannotMove, match=r"^-?\d+\.\d kN are left for the train at \d+ m, .* permil: it comes to a"):
        running_time_s(BARE, line, 5000.0)


@pytest.mark.parametrize(("distance_m", "cell_m"), [(0.0, 1.0), (-5.0, 1.0), (100.0, 0.0), (float("nan"), 1.0)])
def test_lengths_must_be_above_zero(distance_m: float, cell_m: float) -> None:
    with pytest.raises(ValueError, match="must be above 0"):
        flat_out_run(BARE, level((0.0, 20.0)), distance_m, cell_m)
