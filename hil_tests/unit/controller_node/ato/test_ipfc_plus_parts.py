"""Parts of IPFC+: the odometer with its balises, the observer, the actuator between two periods, re-planning."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks.ablation import LAW
from railhil.bench import coupled_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.balise_odometer import BaliseOdometer
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.ipfc_plus_constants import GAP_Q, IpfcPlusParameters, compute_constants, fit_points
from railhil.controller_node.ato.ipfc_plus_design import (
    Uncertainty,
    basis_functions,
    lag,
    observer_gains,
    replanning_gains,
)
from railhil.controller_node.ato.pfc_model import InternalModel
from railhil.controller_node.laws.base import BaliseReading, TrackInputs
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import perturb

WORN = load("lvshun_tieshan_worn_wheels")
TABLE = compute_constants(IpfcPlusParameters(), WORN)


# -- where the train is -----------------------------------------------------------------------------------------------

#: Relative error of the wheel, and of each balise in m.
WHEEL = 0.004
ERRORS_M = {2: 0.03, 3: -0.04, 4: 0.05, 5: -0.02, 6: 0.04}
PLACES_M = {2: 600.0, 3: 1500.0, 4: 2400.0, 5: 2800.0, 6: 2915.0}


def located(arithmetic: str, passings: list[tuple[int, float]], at_m: float = 2940.0) -> float:
    """Error (m) at the end after passing balises (number, what is added to its survey), each told three times."""
    ar = make(arithmetic)
    odometer: BaliseOdometer[Any] = BaliseOdometer(ar, TABLE, 2940.0)
    state = odometer.start()
    balise = BaliseReading(*(ar.from_raw(0, 0) for _ in range(3)))
    place = None
    for number, moved_m in [*passings, (0, 0.0)]:
        if number:
            true_m = PLACES_M[number] + ERRORS_M[number]
            raws = (number, round((PLACES_M[number] + moved_m) * 1e4), round(true_m * (1 + WHEEL) * 1e4))
            balise = BaliseReading(*(ar.from_raw(raw, 0) for raw in raws))
        for _ in range(3):
            track = TrackInputs(0, ar.from_raw(round(at_m * (1 + WHEEL) * 1e4), 0), balise)
            state, place = odometer.step(state, track)
    assert place is not None
    return (ar.raw(place.odometer, 0) + ar.raw(place.correction, GAP_Q) / 2**GAP_Q) / 1e4 - at_m


def least_squares(numbers: list[int]) -> float:
    """The same from the normal equation, without the weight of the nominal wheel."""
    measured = np.array([(PLACES_M[n] + ERRORS_M[n]) * (1 + WHEEL) for n in numbers])
    surveyed = np.array([PLACES_M[n] for n in numbers])
    return float(2940.0 * (1 + WHEEL) * (measured @ surveyed) / (measured @ measured)) - 2940.0


@pytest.mark.parametrize("arithmetic", ["float64", "float32", "iq", "iq-portable"])
@pytest.mark.parametrize("numbers", [[2, 3, 4, 5, 6], [2, 3, 4], [6], [4, 6], [2, 3]])
def test_position_is_the_least_squares_fit_to_the_balises_there_were(arithmetic: str, numbers: list[int]) -> None:
    got = located(arithmetic, [(number, 0.0) for number in numbers])
    # The nominal wheel weighs as much as a balise at 10 m; float32 holds positions to a millimetre or two.
    assert got == pytest.approx(least_squares(numbers), abs=0.004 if numbers != [2, 3] else 0.02)
    assert abs(got) < (0.03 if len(numbers) == 5 else 0.2)


def test_no_balise_leaves_the_nominal_wheel() -> None:
    assert located("iq", []) == pytest.approx(2940 * WHEEL, abs=1e-3)


def test_a_balise_that_no_wheel_explains_is_left_out() -> None:
    numbers = [2, 3, 4, 5, 6]
    wrong = [(number, -40.0 if number == 5 else 0.0) for number in numbers]
    assert located("iq", wrong) == pytest.approx(least_squares([2, 3, 4, 6]), abs=1e-3)


def test_wheel_converges_with_each_balise() -> None:
    after = [abs(located("float64", [(number, 0.0) for number in (2, 3, 4, 5, 6)[:count]])) for count in range(6)]
    assert after[0] > 11
    assert all(error < 0.15 for error in after[1:])
    assert after[5] < 0.02


def test_wheel_of_a_drawn_run_is_found() -> None:
    loop: ControlLoop[Any] = ControlLoop(WORN, LawSpec(LAW), make("iq"))

    def step(*given: Any) -> int:
        _, outputs = loop.step(*given)
        return int(outputs.notch)

    coupled_run(WORN, step, RunSpec(seed=11, perturbed=True))
    balises = loop.state.balises
    factor = perturb(WORN, 11).sensors.wheel_factor
    assert abs(factor - 1) > 1e-3
    assert 1 + balises.errors / balises.squares == pytest.approx(1 / factor, abs=3e-5)


# -- the observer -----------------------------------------------------------------------------------------------------


def observed(scenario: Scenario, arithmetic: str = "float64") -> tuple[Any, float]:
    """The observer at the end of a run whose train differs from the nominal one, and the true gain in km/h/s."""
    loop: ControlLoop[Any] = ControlLoop(WORN, LawSpec(LAW), make(arithmetic))
    seen = []

    def step(*given: Any) -> int:
        _, outputs = loop.step(*given)
        seen.append(loop.state.observer)
        return int(loop.arithmetic.raw(outputs.notch, 8))

    # Nothing is drawn: the plant is the scenario that is passed.
    coupled_run(scenario, step, RunSpec(seed=4))
    return seen[330], scenario.train.force_per_notch_n / scenario.train.inertial_mass_kg * 3.6


@pytest.mark.parametrize("mass", [0.9, 1.1])
def test_force_gain_is_found(mass: float) -> None:
    train = replace(WORN.train, mass_kg=WORN.train.mass_kg * mass, inertial_mass_kg=WORN.train.inertial_mass_kg * mass)
    observer, true_gain = observed(replace(WORN, train=train))
    assert observer.gain == pytest.approx(true_gain, rel=0.015)


@pytest.mark.parametrize(("pole", "delay_s"), [(0.85, 0.2), (1.15, 0.02)])
def test_lag_is_found(pole: float, delay_s: float) -> None:
    nominal_s = 1 / WORN.train.actuator_pole_per_s
    train = replace(WORN.train, actuator_pole_per_s=WORN.train.actuator_pole_per_s * pole)
    observer, _ = observed(replace(WORN, train=train, timing=replace(WORN.timing, loop_delay_s=delay_s)))
    true_s = nominal_s / pole - nominal_s + delay_s - IpfcPlusParameters().loop_delay_s
    assert math.copysign(1.0, observer.lag) == math.copysign(1.0, true_s)
    assert abs(observer.lag) == pytest.approx(min(abs(true_s), 0.4), abs=0.2)


def test_actuator_between_two_periods_is_exact() -> None:
    pole, period_s, delay_s, parts = 0.34, 0.5, 0.11, 50_000
    lagged, integral, notches = 1.3, 0.0, (-2.0, 4.0)
    weights = lag(pole, period_s, delay_s)
    step_s = period_s / parts
    value = lagged
    for i in range(parts):
        acting = notches[0] if i * step_s < delay_s else notches[1]
        after = acting + (value - acting) * math.exp(-pole * step_s)
        integral += (value + after) / 2 * step_s
        value = after
    got = [float(np.dot(row, (lagged, *notches))) for row in weights.over_period]
    assert got == pytest.approx([value, integral], abs=1e-4)
    assert sum(weights.over_period[1]) == pytest.approx(period_s)
    assert sum(weights.over_delay[1]) == pytest.approx(delay_s)


def test_observer_learns_nothing_of_what_it_holds_certain() -> None:
    force = np.array([0.0, 0.4, 0.8, 0.8, 0.2, -0.5])
    known = observer_gains(force, 0.5, Uncertainty(0.0, 0.0, 0.01, 0.001, 0.004))
    assert not known[:, 2:].any()
    learning = observer_gains(force, 0.5, Uncertainty(0.065, 0.26, 0.01, 0.001, 0.004))
    assert learning[0, 1:].tolist() == [0.0, 0.0, 0.0]
    # More force than expected where there is force: a larger gain; while it rises: a smaller lag.
    assert learning[1, 2] > 0
    assert learning[1, 3] < 0


# -- re-planning ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("speed_mps", "position_m"), [(0.3, 0.0), (0.0, 0.5), (-0.2, 0.4)])
def test_replanning_removes_both_errors_by_the_time_left(speed_mps: float, position_m: float) -> None:
    """With R from 12 s down to 2 s, then constant, the errors are (nearly) gone when no time is left."""
    pole, period_s, points = 0.34, 0.05, (20, 40, 60)
    model = InternalModel.sampled(pole, pole, 0.0, period_s)
    weights = model.gains(basis_functions("ramp", 60, period_s), points)
    left_s = np.arange(12.0, 0.0, -period_s)
    gains = replanning_gains(weights, pole, points, period_s, np.maximum(left_s, 2.0))
    error_v, error_x, lagged = speed_mps, position_m, 0.0
    for by_position, by_speed, by_force in gains:
        wanted = by_position * error_x + by_speed * error_v - by_force * lagged
        decay = math.exp(-pole * period_s)
        gained = wanted * period_s + (lagged - wanted) * (1 - decay) / pole
        lagged = wanted + (lagged - wanted) * decay
        error_x += (error_v - gained / 2) * period_s
        error_v -= gained
    assert abs(error_x) < 0.01
    assert abs(error_v) < 0.02


def test_fitting_points_follow_the_control_period() -> None:
    parameters = IpfcPlusParameters()
    assert fit_points(parameters, 0.5) == (2, 4, 6)
    assert fit_points(parameters, 0.2) == (5, 10, 15)
    assert fit_points(replace(parameters, fit_points_s=(0.1, 0.2, 2.0)), 0.5) == (1, 4)
