"""Parts of the high-speed laws, each against an independent transcription: identification, filters, delay lines."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.high_speed.carima import increments
from railhil.controller_node.high_speed.delay_bank import Belief, Noise, correct, predict
from railhil.controller_node.high_speed.delay_line import DelayLines, step_response
from railhil.controller_node.high_speed.identification import (
    LowPass,
    NoEstimate,
    Past,
    coefficients,
    dead_zone,
    differenced_step,
    paper_step,
    residual,
    theta_of,
)
from railhil.controller_node.high_speed.law import weigh_preview
from railhil.controller_node.high_speed.laws.a_gpc import Rls, rls_step, triangle
from railhil.controller_node.high_speed.laws.delay_gpc import error_weights
from railhil.controller_node.high_speed.model import pade_zoh
from railhil.controller_node.high_speed.stability import Train, transition
from railhil.controller_node.vector.reals import Reals

RE = Reals(make("float64"))
MODEL = pade_zoh(0.5, 0.4, 1.0)
PAST = Past((83.0, 82.7, 82.1), (0.3, -0.1, 0.2))
X = np.array([-83.0, -82.7, -82.1, 0.3, -0.1, 0.2])


def flat(theta):
    """theta of the papers: a1, a2, a3, b0, b1, b2."""
    return np.array([*coefficients(RE, theta), *theta.b])


@pytest.mark.parametrize("drift", [0.0, 0.01])
def test_the_residual_is_that_of_the_model(drift):
    theta = theta_of(RE, MODEL)._replace(drift=drift)
    expected = 83.4 - X @ flat(theta)
    assert residual(RE, theta, 83.4, PAST, integrating=drift == 0.0) == pytest.approx(expected, abs=1e-11)


def test_the_projection_of_the_papers_is_that_of_eq_10():
    theta = theta_of(RE, MODEL)
    expected = flat(theta) + X * 0.1 / (1 + X @ X)
    assert flat(paper_step(RE, theta, PAST, 0.1)) == pytest.approx(expected, abs=1e-14)
    # D4: at 300 km/h an error of 0.1 m/s moves each a by 4.0e-4 and each b by 5.8e-7 (there with u = 0.12).
    moved = flat(paper_step(RE, theta, Past((83.333,) * 3, (0.12,) * 3), 0.1)) - flat(theta)
    assert moved[0] == pytest.approx(-4.0e-4, rel=0.01)
    assert moved[3] == pytest.approx(5.8e-7, rel=0.01)


def test_the_differenced_projection_keeps_the_integrator():
    theta = theta_of(RE, MODEL)
    x = np.array([82.7 - 83.0, 82.1 - 82.7, 0.3, -0.1, 0.2])
    found = differenced_step(RE, theta, PAST, 0.1)
    expected = np.array([*theta.alpha, *theta.b]) + x * 0.1 / (1 + x @ x)
    assert (*found.alpha, *found.b) == pytest.approx(expected, abs=1e-14)
    assert sum(coefficients(RE, found)) == pytest.approx(-1, abs=1e-14)


@pytest.mark.parametrize(("error", "expected"), [(0.1, 0.0), (0.1001, 0.1001), (-0.2, -0.2), (-0.05, 0.0)])
def test_errors_inside_the_dead_zone_identify_nothing(error, expected):
    assert dead_zone(RE, error, 0.1) == expected


def test_the_low_pass_follows_the_residual():
    estimator = LowPass(RE, 0.2)
    memory, estimate = estimator.step(0.5, PAST, 1.0)
    assert (memory, estimate) == (0.6, (0.5, 0.5))
    assert LowPass(RE, 0.2, "newest").step(0.5, PAST, 1.0)[1] == (0.5, 0.6)
    assert NoEstimate(RE).step((), PAST, 1.0) == ((), (0.0, 0.0))


def test_recursive_least_squares_are_those_of_the_textbook():
    generator = np.random.default_rng(1)
    root = generator.normal(size=(5, 5))
    p, theta, x = root @ root.T + np.eye(5), generator.normal(size=5), generator.normal(size=5)
    places = [(i, j) for i in range(5) for j in range(i, 5)]
    old = Rls(tuple(theta), tuple(p[i, j] for i, j in places))
    gain = p @ x / (0.9 + x @ p @ x)
    for most, forgotten in ((1e9, 0.9), (1e-9, 1.0)):
        found = rls_step(RE, old, tuple(x), 0.3, 0.9, most)
        expected = (p - np.outer(gain, x @ p)) / forgotten
        assert found.theta == pytest.approx(theta + 0.3 * gain, abs=1e-12)
        assert [found.covariance[triangle(j, i)] for i, j in places] == pytest.approx(
            [expected[i, j] for i, j in places], abs=1e-12
        )


def test_the_weights_on_increments_predict_the_integrated_model():
    """One unlimited step of the law brings a noise-free model's prediction to the least squares of its cost."""
    found = increments(RE, MODEL.a, MODEL.b, 3, 2, 0.5)
    whole = np.convolve([1.0, *MODEL.a], [1.0, -1.0])
    speeds, commands = [10.2, 10.1, 10.05, 10.0], [0.4, 0.3, 0.1]
    target = np.array([10.4, 10.5, 10.7])

    def future(steps):
        v, du = list(reversed(speeds)), [commands[1] - commands[2], commands[0] - commands[1], *steps, 0.0, 0.0]
        for j in range(3):
            past = v[:-5:-1]
            v.append(-whole[1:] @ past + sum(MODEL.b[m] * du[2 + j - m] for m in range(3)))
        return np.array(v[-3:])

    free = future([0.0, 0.0])
    g = np.column_stack([future([1.0, 0.0]) - free, future([0.0, 1.0]) - free])
    expected = np.linalg.solve(g.T @ g + 0.5 * np.eye(2), g.T @ (target - free))[0]
    now = speeds[0]
    change = np.dot(found.p, target - now) - np.dot(found.f, np.array(speeds[1:]) - now)
    change -= np.dot(found.h, [commands[0] - commands[1], commands[1] - commands[2]])
    assert change == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("delays_s", [(0.5, 1.0), (1.1, 0.7), (0.0, 0.2)])
def test_the_delay_lines_are_the_exact_plant(delays_s):
    period_s, lag_s = 0.2, 0.4
    lines = DelayLines(RE, delays_s, lag_s, period_s)
    generator = np.random.default_rng(3)
    commands = list(generator.uniform(-1, 0.5, 40))
    accel = speed = 0.0
    states = [np.zeros(3 + int(delay_s / period_s + 1e-9)) for delay_s in delays_s]
    plants = [transition(Train(delay_s, lag_s), period_s) for delay_s in delays_s]
    for k, command in enumerate(commands):
        past = [*commands[k::-1], *[0.0] * lines.count][: lines.count]
        rolled = lines.roll(accel, lines.parts(past), 0)
        accel, speed = rolled.accel, speed + rolled.gained
        for side, (step, drive) in enumerate(plants):
            part = max(command, 0.0) if side == 0 else min(command, 0.0)
            states[side] = step @ states[side] + drive * part
        assert speed == pytest.approx(sum(state[0] for state in states), abs=1e-12)
        assert accel == pytest.approx(sum(state[1] for state in states), abs=1e-12)


def test_the_step_response_is_that_of_the_plant():
    step, drive = transition(Train(0.5, 0.4), 0.2)
    state, speeds = np.zeros(len(drive)), []
    for _ in range(10):
        state = step @ state + drive
        speeds.append(state[0])
    assert step_response(0.5, 0.4, [0.2 * j for j in range(1, 11)]) == pytest.approx(speeds, abs=1e-12)


def test_the_filter_is_the_textbook_one():
    generator = np.random.default_rng(2)
    root = generator.normal(size=(3, 3))
    p, x = root @ root.T, np.array([80.0, -0.1, 0.9])
    noise = Noise(0.0004, 1e-5, 2e-5, 3e-5)
    upper = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
    old = Belief(*x, tuple(p[i, j] for i, j in upper))
    f = np.array([[1.0, 0.2, 0.07], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    x, p = f @ x, f @ p @ f.T + np.diag(noise[1:])
    before = predict(RE, old, 0.07, 0.2, noise)
    assert before[:3] == pytest.approx(x, abs=1e-12)
    assert before.covariance == pytest.approx([p[i, j] for i, j in upper], abs=1e-12)
    gain = p[:, 0] / (p[0, 0] + noise.reading)
    after, innovation = correct(RE, before, 80.1, noise)
    assert innovation == pytest.approx((80.1 - x[0], p[0, 0] + noise.reading))
    x, p = x + gain * (80.1 - x[0]), p - np.outer(gain, p[0])
    assert after[:3] == pytest.approx(x, abs=1e-12)
    assert after.covariance == pytest.approx([p[i, j] for i, j in upper], abs=1e-12)


def test_increments_of_the_correction_are_weighted_by_least_squares():
    response = (0.0, 0.1, 0.3, 0.5)
    g = np.array([[0.0, 0.0], [0.1, 0.0], [0.3, 0.1], [0.5, 0.3]])
    expected = np.linalg.solve(g.T @ g + 2.0 * np.eye(2), g.T)[0]
    assert error_weights(response, 2, 2.0) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize(
    ("place", "expected"),
    [(0, ((0,), (1.0,))), (4, ((4,), (1.0,))), (14, ((14,), (1.0,))), (0.8, ((0, 1), (0.2, 0.8)))],
)
def test_the_reference_between_two_points_of_the_preview_is_linear(place, expected):
    places, shares = weigh_preview(place)
    assert places == expected[0]
    assert shares == pytest.approx(expected[1])


def test_behind_the_preview_the_last_slope_goes_on():
    places, shares = weigh_preview(15.0)
    assert places == (13, 14)
    assert shares == pytest.approx((-1.0, 2.0))
