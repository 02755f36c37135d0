"""The measurements of a run against closed forms, and against references that go sample by sample."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.judge.stops import PlannedStop, ScoredStop
from railhil.scenarios.load import load
from railhil.scenarios.profiles import Profile
from railhil.systems.ato.judge import journey, measures
from railhil.systems.ato.judge.journey import ErrorGrid, Journey, stop_of
from railhil.systems.ato.scenario.model import Energy, TargetCurve
from railhil.systems.ato.scenario.target import Target

LVSHUN = load("lvshun_tieshan")
#: 0.5 m/s2 for 2 s and back to rest, at 2 m.
HOP = replace(
    LVSHUN,
    target=TargetCurve(((0.0, 0.5), (1.9, 0.5), (2.1, -0.5), (4.0, -0.5))),
    plan=replace(LVSHUN.plan, distance_m=2.0, running_time_s=4.0),
)
#: Control period and time between two SIM_TRUTH in ms.
CYCLE_MS, TRUTH_MS = 500, 20

# -- terms ------------------------------------------------------------------------------------------------------------

LIMITS: Profile = ((0.0, 20.0), (100.0, 10.0), (300.0, 15.0))


@pytest.mark.parametrize(
    ("front_m", "allowed_mps"),
    # A train of 50 m: a lower limit from its front on, a higher one when its rear has passed.
    [
        (-1e9, 20.0), (-5.0, 20.0), (0.0, 20.0), (99.999, 20.0), (100.0, 10.0), (149.999, 10.0), (200.0, 10.0),
        (300.0, 10.0), (349.999, 10.0), (350.0, 15.0), (1e9, 15.0),
    ],
)  # fmt: skip
def test_limit_under_the_train(front_m: float, allowed_mps: float) -> None:
    assert measures.limits_under_train(LIMITS, front_m, 50.0) == allowed_mps
    assert measures.limits_under_train(((40.0, 12.5),), front_m, 50.0) == 12.5


@given(
    rows=st.dictionaries(st.integers(-300, 3000), st.integers(5, 40), min_size=1, max_size=6),
    length_m=st.integers(1, 400),
    fronts_m=st.lists(st.integers(-500, 4000), min_size=1, max_size=20),
)
def test_limit_under_the_train_is_the_lowest_it_stands_on(
    rows: dict[int, int], length_m: int, fronts_m: list[int]
) -> None:
    """By half metres: on whole numbers no point of a limit's boundary is looked at."""
    limits = tuple(sorted((float(begin), float(speed)) for begin, speed in rows.items()))

    def at(place: float) -> float:
        return next((speed for begin, speed in reversed(limits) if place >= begin), limits[0][1])

    found = measures.limits_under_train(limits, np.array(fronts_m, dtype=float) + 0.5, float(length_m))
    # The middle of each half metre under the train; limits begin at whole metres.
    under = [min(at(front + 0.25 - k / 2) for k in range(2 * length_m)) for front in fronts_m]
    assert found.tolist() == under


def test_sum_from_the_first_to_the_last_value() -> None:
    values = [0.1, 0.2, 0.3, 1e16, -1e16, 0.7]
    plain = 0.0
    for value in values:
        plain += value
    assert measures.total(values) == plain
    assert measures.total(np.array([values, values[::-1]])).shape == (2,)
    assert measures.total(np.zeros((3, 2, 0))).tolist() == [[0.0, 0.0]] * 3


def test_terms() -> None:
    assert measures.error_kmh(10.0, 12.5) == measures.error_kmh(12.5, 10.0) == pytest.approx(9.0, rel=1e-12)
    assert measures.work_j(0.5, 100.0, 300.0) == 100.0
    assert measures.KMH == 3.6
    assert measures.energy_kj(Energy(0.8, 0.4, 500.0), 8000.0, 2000.0, 10.0) == pytest.approx(10.0 + 5.0 + 0.8)
    # Three cycles of 0.5 s with 2, 1 and no samples: 1 * 0.25 * 2 + 2 * 0.25 * 8, and nothing.
    assert measures.itae_kmh_s2(np.array([4.0, 8.0, 0.0]), np.array([2, 1, 0]), 0.5, np.ones(3)) == 4.5
    assert measures.itae_kmh_s2(np.array([4.0, 9.0, 3.0]), np.array([2, 3, 1]), 2.0, np.array([1, 1, 0.5])) == 4 * (
        2 + 2 * 3 + 1.5 * 3
    )
    # 0.5 up, 0.8 down, and the last -0.3 to zero, over half a kilometre.
    assert measures.comfort_mps2_per_km(np.array([0.0, 0.5, -0.3]), 500.0) == pytest.approx(3.2)
    assert measures.comfort_mps2_per_km(np.array([[0.0, 0.5, -0.3, -0.3], [1.0] * 4]), 2000.0) == pytest.approx(
        [0.8, 0.5]
    )


# -- a whole run ------------------------------------------------------------------------------------------------------


def travelled(
    scenario: Any = HOP, indexing: str = "time", stop: ScoredStop | None = None, **given_arrays: Any
) -> Journey:
    """A run with a SIM_TRUTH every 20 ms from 0 on."""
    length = max(len(values) for values in given_arrays.values())
    arrays = {name: np.asarray(given_arrays.get(name, np.zeros(length)), dtype=float) for name in _ARRAYS}
    time_s = np.arange(length) * TRUTH_MS / 1000
    return Journey(scenario, indexing, time_s, stop=stop or stop_of(scenario.plan, []), **arrays)


_ARRAYS = ("position_m", "speed_mps", "accel_mps2", "traction_n", "brake_n")


def test_grid_of_the_published_scenario() -> None:
    grid = ErrorGrid.of(LVSHUN)
    assert (grid.step_s, grid.period_s) == (0.02, 0.5)
    assert grid.time_s == pytest.approx(np.arange(1, 9751) * 0.02)
    # 0.5 s belongs to the first cycle, 0.52 s to the second.
    assert grid.cycle.tolist() == [-(-20 * k // 500) - 1 for k in range(1, 9751)]
    assert grid.counts.tolist() == [25] * 390


@pytest.mark.parametrize(("running_time_s", "cycles"), [(4.0, 8), (4.01, 9), (3.99, 8), (0.5, 1)])
def test_grid_ends_with_the_timetable(running_time_s: float, cycles: int) -> None:
    grid = ErrorGrid.of(replace(HOP, plan=replace(HOP.plan, running_time_s=running_time_s)))
    assert len(grid.counts) == cycles
    assert grid.time_s[-1] <= running_time_s + 1e-9
    assert grid.time_s[-1] == pytest.approx(running_time_s, abs=0.02)
    assert grid.shares.tolist() == [1.0] * (cycles - 1) + [pytest.approx(running_time_s / 0.5 - (cycles - 1))]
    assert sum(grid.counts) == len(grid.time_s) == len(grid.cycle)


def test_grid_with_cycles_that_no_whole_number_of_telegrams_fills() -> None:
    """Every 40 ms, cycles of 0.1 s: 3, 2, 3, 2 ... samples, those at the end of a cycle inside it."""
    timing = replace(HOP.timing, control_period_ns=100_000_000, port_period_ns={"SIM_TRUTH": 40_000_000})
    grid = ErrorGrid.of(replace(HOP, timing=timing, plan=replace(HOP.plan, running_time_s=0.4)))
    assert grid.step_s == 0.04
    assert grid.cycle.tolist() == [0, 0, 1, 1, 1, 2, 2, 3, 3, 3]
    assert grid.counts.tolist() == [2, 3, 2, 3]


def test_grid_leaves_out_what_lies_after_the_last_cycle() -> None:
    """0.3 s are 7.5 times 40 ms: of 8 samples the last lies outside."""
    timing = replace(HOP.timing, control_period_ns=100_000_000, port_period_ns={"SIM_TRUTH": 40_000_000})
    grid = ErrorGrid.of(replace(HOP, timing=timing, plan=replace(HOP.plan, running_time_s=0.3)))
    assert grid.time_s == pytest.approx([0.04, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28])
    assert (grid.cycle.tolist(), grid.counts.tolist()) == ([0, 0, 1, 1, 1, 2, 2], [2, 3, 2])


def test_grid_with_cycles_of_two_seconds() -> None:
    timing = replace(HOP.timing, control_period_ns=2_000_000_000)
    assert ErrorGrid.of(replace(HOP, timing=timing)).counts.tolist() == [100, 100]


def itae_by_hand(run: Journey) -> float:
    """Sample by sample, in whole milliseconds."""
    target, speeds = Target(run.scenario.target), run.speed_mps.tolist()
    end_ms = round(run.scenario.plan.running_time_s * 1000)
    cycles = -(-end_ms // CYCLE_MS)
    total = 0.0
    for k in range(1, cycles + 1):
        errors = []
        for at_ms in range(CYCLE_MS * (k - 1) + TRUTH_MS, min(CYCLE_MS * k, end_ms) + 1, TRUTH_MS):
            place = at_ms // TRUTH_MS
            speed = speeds[place] if place < len(speeds) else 0.0
            wanted_s = at_ms / 1000
            if run.indexing == "distance":
                wanted_s = float(target.time_s(run.position_m[min(place, len(speeds) - 1)]))
            errors.append(abs(target.speed_mps(wanted_s) - speed) * 3.6)
        share = min(CYCLE_MS * k, end_ms) - CYCLE_MS * (k - 1)
        total += k * 0.25 * sum(errors) / len(errors) * share / CYCLE_MS
    return total


@settings(deadline=None, max_examples=60)
@given(
    speeds=st.lists(st.floats(0, 3), min_size=2, max_size=230),
    indexing=st.sampled_from(["time", "distance"]),
    running_time_s=st.sampled_from([4.0, 3.7, 2.0]),
)
def test_itae_is_that_of_the_samples(speeds: list[float], indexing: str, running_time_s: float) -> None:
    scenario = replace(HOP, plan=replace(HOP.plan, running_time_s=running_time_s))
    run = travelled(scenario, indexing, speed_mps=speeds, position_m=np.cumsum(speeds) * 0.02)
    assert journey.itae_kmh_s2(run) == pytest.approx(itae_by_hand(run), rel=1e-9, abs=1e-9)


def test_itae_of_a_constant_error() -> None:
    """1 m/s too fast throughout: 3.6 km/h times 0.25 s2 times 1 + 2 + ... + 8."""
    speeds = Target(HOP.target).speed_mps(np.arange(201) * 0.02) + 1.0
    assert journey.itae_kmh_s2(travelled(speed_mps=speeds)) == pytest.approx(3.6 * 0.25 * 36)


@pytest.mark.parametrize("shift_s", [-0.008, 0.008])
def test_itae_with_stamps_nearly_half_a_period_off(shift_s: float) -> None:
    run = travelled(speed_mps=np.linspace(3.0, 0.5, 150))
    assert journey.itae_kmh_s2(replace(run, time_s=run.time_s + shift_s)) == journey.itae_kmh_s2(run)


def test_itae_with_telegrams_missing_takes_the_next_one() -> None:
    speeds = Target(HOP.target).speed_mps(np.arange(201) * 0.02) + 1.0
    run = travelled(speed_mps=speeds)
    kept = np.ones(201, dtype=bool)
    kept[50:60] = False
    holed = replace(run, **{name: getattr(run, name)[kept] for name in ("time_s", *_ARRAYS)})
    expected = itae_by_hand(run)
    for place in range(50, 60):
        wanted = Target(HOP.target).speed_mps(place * 0.02)
        k = -(-20 * place // 500)
        expected += k * 0.25 * (abs(wanted - speeds[60]) - abs(wanted - speeds[place])) * 3.6 / 25
    assert journey.itae_kmh_s2(holed) == pytest.approx(expected)


@pytest.mark.parametrize("stopped_ms", [None, 2000, 2010])
def test_energy_until_the_stop(stopped_ms: int | None) -> None:
    """Force and speed grow evenly: by whole fractions, trapezoid by trapezoid."""
    n = 201
    speed, traction, brake = np.arange(n) * 0.01, np.arange(n) * 100.0, 7000.0 - np.arange(n) * 30.0
    scenario = replace(HOP, energy=Energy(0.8, 0.25, 1000.0))
    stop = None if stopped_ms is None else stop_of(HOP.plan, [(stopped_ms / 1000, 2.0)])
    found = journey.energy_kj(travelled(scenario, speed_mps=speed, traction_n=traction, brake_n=brake, stop=stop))
    end_ms = 4000 if stopped_ms is None else stopped_ms
    last = end_ms // TRUTH_MS
    work: list[Fraction] = []
    for force in (lambda k: 100 * k, lambda k: 7000 - 30 * k):
        powers = [Fraction(k, 100) * force(k) for k in range(last + 1)]
        work.append(sum((a + b) / 2 * Fraction(TRUTH_MS, 1000) for a, b in pairwise(powers)))  # type: ignore[arg-type]
    expected = work[0] / Fraction(8, 10) + end_ms + work[1] / 4
    assert found == pytest.approx(float(expected) / 1000, rel=1e-12)


@pytest.mark.parametrize("samples", [1, 2, 25, 26, 27, 51, 201])
def test_comfort_at_the_beginning_of_each_cycle(samples: int) -> None:
    accel = [((7 * k) % 11) / 10 - 0.5 for k in range(samples)]
    ticks = [accel[k] for k in range(0, samples, 25)]
    expected = sum(abs(b - a) for a, b in pairwise(ticks)) + abs(ticks[-1])
    assert journey.comfort_mps2_per_km(travelled(accel_mps2=accel)) == pytest.approx(expected / 0.002)


def test_comfort_with_telegrams_missing_takes_the_next_one() -> None:
    accel = np.zeros(101)
    accel[30], accel[100] = 0.4, 0.1
    run = travelled(accel_mps2=accel)
    kept = np.ones(101, dtype=bool)
    kept[20:30] = False
    holed = replace(run, **{name: getattr(run, name)[kept] for name in ("time_s", *_ARRAYS)})
    # 0, 0.4 (in place of that at 0.5 s), 0, 0, 0.1 (at 2 s), 0.
    assert journey.comfort_mps2_per_km(holed) == pytest.approx((0.4 + 0.4 + 0.1 + 0.1) / 0.002)


def test_the_stop_of_a_plan() -> None:
    plan = LVSHUN.plan
    stop = stop_of(plan, [(60.0, 900.0), (195.4, 2939.9)])
    planned = PlannedStop("stopping point", 2940.0, plan.stop_error_max_m, 195.0, plan.time_error_max_s)
    assert (stop.planned, stop.error_m, stop.late_s) == (planned, pytest.approx(-0.1), pytest.approx(0.4))
    assert ScoredStop(replace(planned, due_s=None), stop.standstill).late_s is None
