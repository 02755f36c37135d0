"""Spectral radii of the comparators' loops and of our law's, against simulations and the poles of its filter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.high_speed.carima import Track, command_of, increments, radius, tracked
from railhil.controller_node.high_speed.delay_bank import steady_gains
from railhil.controller_node.high_speed.law import Sample, Unit
from railhil.controller_node.high_speed.laws.delay_gpc import DelayController, DelayGpcParameters, loop_radius, radii
from railhil.controller_node.high_speed.model import pade_zoh
from railhil.controller_node.high_speed.stability import Train, transition
from railhil.controller_node.vector.reals import Reals

RE = Reals(make("float64"))
LAG_S, PERIOD_S = 0.4, 1.0
UNIT = Unit(0.5, 1.0, LAG_S, 0.2)


@pytest.mark.parametrize("weight", [9.0, 0.3, 0.01])
@pytest.mark.parametrize(("model_s", "train_s"), [(0.5, 0.5), (0.5, 1.0), (1.2, 1.2)])
def test_the_loop_of_a_comparator_grows_by_its_radius(model_s, train_s, weight):
    model = pade_zoh(model_s, LAG_S, PERIOD_S)
    law = increments(RE, model.a, model.b, 3, 2, weight)
    train = Train(train_s, LAG_S)
    step, drive = transition(train, PERIOD_S)
    state = np.zeros(len(drive))
    state[0] = 1.0
    track = Track((0.0,) * 4, (0.0,) * 4)
    sizes = []
    for _ in range(400):
        speed = float(state[0])
        command = command_of(RE, law, Sample(speed, (0.0,) * 4, -1e99, 1e99, 0.0), track)
        track = tracked(track, speed, command)
        state = step @ state + drive * command
        sizes.append(np.linalg.norm([*state, *track.speeds]))
        if not 1e-90 < sizes[-1] < 1e90:
            break
    half = len(sizes) // 2
    grown = (sizes[-1] / sizes[half]) ** (1.0 / (len(sizes) - 1 - half))
    assert radius(law, train, PERIOD_S) == pytest.approx(grown, abs=0.01)


def sides(delay_s):
    controller = DelayController(
        RE, replace(UNIT, traction_delay_s=delay_s, braking_delay_s=delay_s), DelayGpcParameters()
    )
    return controller, steady_gains(RE, UNIT.sample_period_s, controller.noise)


@pytest.mark.parametrize("delay_s", [0.5, 1.0])
def test_with_the_nominal_delay_the_slowest_pole_is_that_of_the_filter(delay_s):
    """The predictor is exact, so the poles of the law and of the filter are separate."""
    controller, gains = sides(delay_s)
    move = np.array([[1.0, UNIT.sample_period_s], [0.0, 1.0]])
    filtered = (np.eye(2) - np.outer(gains, [1.0, 0.0])) @ move
    slowest = np.abs(np.linalg.eigvals(filtered)).max()
    for emergency in (False, True):
        assert loop_radius(controller, Train(delay_s, LAG_S), gains, emergency) == pytest.approx(slowest, abs=1e-6)


def test_a_second_more_delay_makes_our_law_unstable_if_it_is_not_estimated():
    controller, gains = sides(1.0)
    found = [loop_radius(controller, Train(1.0 + extra_s, LAG_S), gains, False) for extra_s in (0.0, 0.4, 1.0)]
    assert found[0] < found[1] < 1.0 < found[2]


def test_our_law_knows_its_radii_in_each_mode():
    found = radii(UNIT, DelayGpcParameters())
    modes = ("traction", "braking")
    assert sorted(found) == sorted([*modes, *(f"{mode} in an emergency" for mode in modes)])
    assert 0.8 < max(found.values()) < 1.0
