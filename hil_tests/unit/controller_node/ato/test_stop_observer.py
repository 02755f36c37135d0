"""The observer of ipfc_plus_stop: the actuator's lag twice, its gains, time constant and delay each found."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from railhil.bench import coupled_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.ipfc_plus_constants import ACCEL_Q, UNIT_Q
from railhil.controller_node.ato.ipfc_plus_design import (
    StopUncertainty,
    lag_twice,
    lagged_force,
    stop_observer_gains,
)
from railhil.controller_node.ato.ipfc_plus_stop_constants import IpfcPlusStopParameters
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario

LAW = "ipfc_plus_stop"
WORN = load("lvshun_tieshan_worn_wheels")
POLE, PERIOD_S, DELAY_S = 0.34, 0.5, 0.11


# -- designed before the run ------------------------------------------------------------------------------------------


def test_the_notch_after_two_lags_is_exact() -> None:
    twice, lagged, notches = 0.7, 1.3, (-2.0, 4.0)
    weights = lag_twice(POLE, PERIOD_S, DELAY_S)
    start, parts = (twice, lagged), 50_000
    step_s = PERIOD_S / parts
    at_delay = math.nan
    for i in range(parts):
        if math.isnan(at_delay) and i * step_s >= DELAY_S:
            at_delay = twice
        acting = notches[0] if i * step_s < DELAY_S else notches[1]
        after = acting + (lagged - acting) * math.exp(-POLE * step_s)
        twice += ((lagged + after) / 2 - twice) * (1 - math.exp(-POLE * step_s))
        lagged = after
    assert np.dot(weights.over_period, (*start, *notches)) == pytest.approx(twice, abs=1e-4)
    assert np.dot(weights.over_delay, (*start, notches[0])) == pytest.approx(at_delay, abs=1e-4)
    assert sum(weights.over_period) == pytest.approx(1.0)
    assert sum(weights.over_delay) == pytest.approx(1.0)


def test_a_force_after_a_lag() -> None:
    """A ramp arrives late by the time constant, as soon as the start is forgotten; a step as 1 - exp(-p t)."""
    ramp = np.arange(100) * PERIOD_S * 0.3
    assert lagged_force(ramp, POLE, PERIOD_S)[-1] == pytest.approx(ramp[-1] - 0.3 / POLE, abs=1e-6)
    assert lagged_force(np.ones(100), POLE, PERIOD_S)[4] == pytest.approx(1 - math.exp(-POLE * 2.0))


FORCE = np.array([0.0, 0.4, 0.8, 0.8, 0.2, -0.5, -0.7, -0.7])
DRAG = np.array([0.02, 0.02, 0.03, 0.03, 0.05, 0.05, 0.05, 0.05])
UNKNOWN = StopUncertainty(0.065, 0.2, 0.03, 0.015, 0.001, 0.2, 0.004)


def gains(**changed: float) -> Any:
    return stop_observer_gains(FORCE, DRAG, POLE, PERIOD_S, replace(UNKNOWN, **changed))


def test_nothing_is_learnt_of_what_is_held_certain() -> None:
    assert not gains(gain=0.0, lag_s=0.0, delay_s=0.0)[:, 2:].any()
    learning = gains()
    assert learning[0, 1:].tolist() == [0.0, 0.0, 0.0, 0.0]
    # More force than expected where there is force: a larger gain; while it rises: a smaller lag and a smaller delay.
    assert learning[1, 2] > 0
    assert (learning[1, 3:] < 0).all()


def test_the_disturbance_wanders_with_the_planned_drag() -> None:
    """Where the drag changes, more of a surprise is taken for a disturbance."""
    with_it, without = gains(gain=0.0, lag_s=0.0, delay_s=0.0), gains(gain=0.0, lag_s=0.0, delay_s=0.0, drag=0.0)
    assert with_it[1] == pytest.approx(without[1])
    # It changes before readings 2 and 4, and shows in the speed one period later.
    assert with_it[2] == pytest.approx(without[2])
    assert (with_it[[3, 5], 1] > 1.05 * without[[3, 5], 1]).all()


# -- in a run ---------------------------------------------------------------------------------------------------------


def observed(scenario: Scenario, arithmetic: str) -> Any:
    """The observer at 185 s, in braking, of a run whose train differs from the nominal one: gain, lag and delay."""
    loop: ControlLoop[Any] = ControlLoop(WORN, LawSpec(LAW), make(arithmetic))
    seen = []

    def step(*given: Any) -> int:
        _, outputs = loop.step(*given)
        seen.append(loop.state.observer)
        return int(loop.arithmetic.raw(outputs.notch, 8))

    # Nothing is drawn: the plant is the scenario that is passed.
    coupled_run(scenario, step, RunSpec(seed=4))
    raw = loop.arithmetic.raw
    one = seen[370]
    return raw(one.gain, ACCEL_Q) / 2**ACCEL_Q, raw(one.lag, UNIT_Q) / 2**UNIT_Q, raw(one.delay, UNIT_Q) / 2**UNIT_Q


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
@pytest.mark.parametrize(("pole", "delay_s"), [(0.85, 0.11), (1.15, 0.11), (1.0, 0.2), (1.0, 0.02), (0.85, 0.02)])
def test_time_constant_and_delay_are_told_apart(pole: float, delay_s: float, arithmetic: str) -> None:
    train = replace(WORN.train, actuator_pole_per_s=WORN.train.actuator_pole_per_s * pole)
    timing = replace(WORN.timing, loop_delay_s=delay_s)
    gain, lag_s, found_s = observed(replace(WORN, train=train, timing=timing), arithmetic)
    assert gain == pytest.approx(WORN.train.force_per_notch_n / WORN.train.inertial_mass_kg * 3.6, rel=0.01)
    assert lag_s == pytest.approx((1 / pole - 1) / WORN.train.actuator_pole_per_s, abs=0.08)
    assert found_s == pytest.approx(delay_s - IpfcPlusStopParameters().loop_delay_s, abs=0.04)
