"""The brake model of the stopping laws, against an integration in small steps; the grade map."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from railhil.controller_node.arithmetic import make
from railhil.controller_node.stop.model import BrakeModel, Grades, NegativeExp, Rolled, StoppingDistance
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q, Numbers

PERIOD_S = 0.016


@pytest.mark.parametrize(("delay_s", "lag_s"), [(0.6, 0.4), (0.64, 0.4), (0.0, 0.3), (0.01, 0.2)])
def test_prediction_and_steps_are_those_of_an_integration(delay_s, lag_s):
    model = BrakeModel(Numbers(make("float64")), delay_s, lag_s, PERIOD_S)
    commands = np.random.default_rng(4).uniform(-1.0, 0.5, 160)
    small_s = PERIOD_S / 16
    accel = np.zeros(160 * 16 + 1)
    for i in range(160 * 16):
        index = int(np.floor((i * small_s - delay_s) / PERIOD_S + 1e-9))
        target = commands[index] if index >= 0 else 0.0
        accel[i + 1] = target + (accel[i] - target) * np.exp(-small_s / lag_s)
    queue: tuple[float, ...] = (0.0,) * model.count
    state = 0.0
    for k in range(100):
        now = Rolled(500.0, 20.0, state)
        found = model.predict(now, 0.05, queue)
        part = accel[16 * k : 16 * k + round(delay_s / small_s) + 1]
        if len(part) > 1:
            gained = np.concatenate([[0.0], np.cumsum((part[1:] + part[:-1]) / 2 * small_s)])
            moved = ((gained[1:] + gained[:-1]) / 2 * small_s).sum()
            assert found.speed == pytest.approx(20.0 + gained[-1] + 0.05 * delay_s, abs=2e-5)
            assert found.left == pytest.approx(500.0 - 20 * delay_s - moved - 0.025 * delay_s**2, abs=2e-5)
        assert found.accel == pytest.approx(part[-1], abs=1e-9)
        queue = (commands[k], *queue[:-1])
        before, (state, gained_mps) = state, model.step(state, queue)
        cycle = accel[16 * k : 16 * k + 17]
        assert before == pytest.approx(cycle[0], abs=1e-9)
        assert gained_mps == pytest.approx(((cycle[1:] + cycle[:-1]) / 2 * small_s).sum(), abs=2e-5)


def test_grades_by_the_distance_that_is_left():
    numbers = Numbers(make("float64"))
    grades = Grades(numbers, [(0.0, 9.0), (1000.0, 3.0), (2500.0, -2.0), (3000.0, 7.0)], 2181.0, 2631.0)
    up, down = -9.81 * 3.0 / 1000, 9.81 * 2.0 / 1000
    assert grades.at(400.0) == pytest.approx(up)
    assert grades.at(100.0) == pytest.approx(down)
    assert grades.mean(262.0) == pytest.approx((up * 131 + down * 131) / 262)
    assert grades.mean(50.0) == pytest.approx(down)


DELAY_S, LAG_S, DECEL_MPS2 = 0.6, 0.4, 0.8


def stop(speed_mps: float, decel_mps2: float = DECEL_MPS2, arithmetic: str = "float64", model: Any = None) -> Any:
    """(t_s, f) of the law's function."""
    ar = make(arithmetic)
    delay_s, lag_s = model or (DELAY_S, LAG_S)
    numbers = Numbers(ar)
    decel = numbers.hold("decel", decel_mps2, ACCEL_Q, "test")
    found = StoppingDistance(numbers, delay_s, lag_s)(numbers.hold("speed", speed_mps, SPEED_Q, "test"), decel)
    if ar.wide:
        return found.time, found.distance
    return ar.raw(found.time, TIME_Q) / 2**TIME_Q, ar.raw(found.distance, DISTANCE_Q) / 2**DISTANCE_Q


def independent(v0: float, a: float, delay_s: float, lag_s: float) -> tuple[float, float]:
    """Root of (4) by bisection, and the integral of the speed until then."""

    def speed(t: float) -> float:
        left = max(t - delay_s, 0.0)
        return v0 - a * (left + lag_s * math.expm1(-left / lag_s))

    time_s = float(brentq(speed, delay_s, delay_s + v0 / a + lag_s + 1.0, xtol=1e-13, rtol=1e-14))
    return time_s, v0 * delay_s + float(quad(speed, delay_s, time_s, epsabs=1e-12, epsrel=1e-13, limit=400)[0])


@pytest.mark.parametrize("v0", [0.001, 0.05, 0.3, 1.0, 3.0, 8.0, 60 / 3.6, 25.0, 60.0])
@pytest.mark.parametrize(("a", "delay_s", "lag_s"), [(0.8, 0.6, 0.4), (0.55, 0.0, 1.5), (1.2, 1.0, 0.05)])
def test_time_and_distance(v0, a, delay_s, lag_s):
    assert stop(v0, a, model=(delay_s, lag_s)) == pytest.approx(independent(v0, a, delay_s, lag_s), abs=1e-8)


def test_the_published_form_of_the_distance():
    time_s, distance_m = stop(60 / 3.6)
    left = time_s - DELAY_S
    behind = left**2 / 2 - LAG_S * left - LAG_S**2 * math.expm1(-left / LAG_S)
    assert distance_m == pytest.approx(60 / 3.6 * time_s - DECEL_MPS2 * behind, abs=1e-9)


def test_a_train_that_stands_or_rolls_back_needs_nothing_but_the_delay():
    assert stop(0.0) == pytest.approx((DELAY_S, 0.0), abs=1e-12)
    assert stop(-0.2) == pytest.approx((DELAY_S, 0.0), abs=1e-12)


def test_sensitivities_at_60_km_h():
    v0 = 60 / 3.6
    time_s, distance_m = stop(v0)
    assert distance_m == pytest.approx(190.21, abs=0.01)
    assert time_s == pytest.approx(21.83, abs=0.005)
    slope = (stop(v0 + 1e-4)[1] - stop(v0 - 1e-4)[1]) / 2e-4
    assert slope == pytest.approx(time_s, abs=1e-6)
    assert stop(v0, 0.99 * DECEL_MPS2)[1] - distance_m == pytest.approx(1.75, abs=0.01)
    assert v0 * 0.016 == pytest.approx(0.267, abs=1e-3)


@pytest.mark.parametrize(("arithmetic", "within_m"), [("float32", 2e-4), ("iq", 1e-3)])
def test_other_arithmetics(arithmetic, within_m):
    for v0 in (0.05, 1.0, 5.0, 60 / 3.6):
        assert stop(v0, arithmetic=arithmetic)[1] == pytest.approx(stop(v0)[1], abs=within_m)


def test_the_exponential_function():
    ar = make("float64")
    exp = NegativeExp(Numbers(ar), 0.4)
    for time_s in (0.0, 1e-6, 0.01, 0.4, 1.3, 4.0, 11.9):
        assert exp(time_s) == pytest.approx(math.exp(-time_s / 0.4), abs=1e-13)
    fixed = make("iq")
    rough = NegativeExp(Numbers(fixed), 0.4)(fixed.from_raw(round(0.4 * 2**TIME_Q), TIME_Q))
    assert fixed.raw(rough, GAIN_Q) / 2**GAIN_Q == pytest.approx(math.exp(-1.0), abs=1e-5)


def test_a_lag_must_be_positive():
    with pytest.raises(ValueError, match="must be positive"):
        StoppingDistance(Numbers(make("float64")), 0.6, 0.0)
