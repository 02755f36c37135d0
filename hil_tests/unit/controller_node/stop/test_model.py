"""The brake model of the stopping laws, against an integration in small steps; the grade map."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.stop.model import BrakeModel, Grades, Rolled
from railhil.controller_node.stop.numbers import Numbers

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
        found = model.ahead(now, 0.05, queue)
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
