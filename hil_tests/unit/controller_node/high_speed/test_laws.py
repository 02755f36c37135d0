"""The laws of hst1: what they refuse, that both float arithmetics agree, and the readings that fail."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.vector.controller import VectorController, VectorLoop
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.high_speed.tuning import journey

SHORT: Any = load_any("hst_short")
LAWS = ("pid", "pid_ff", "gpc", "mm_gpc", "a_gpc", "res_ngpc", "delay_gpc")


def given(law, **values):
    return ParameterSet(law, values, Path("test.toml"))


def loop(law, arithmetic="float64", scenario=SHORT, **values):
    parameters = given(law, **values) if values else None
    return VectorLoop(scenario, LawSpec(law, parameters=parameters), make(arithmetic))


@pytest.mark.parametrize("law", ["gpc", "res_ngpc", "mm_gpc", "a_gpc"])
def test_a_horizon_within_the_delay_is_refused_with_its_figure(law):
    with pytest.raises(
        InputError, match=r"horizon 3 \* sample_period_s 0.2 = 0.6 s, expected more than the longest delay"
    ):
        loop(law, sample_period_s=0.2)


def test_three_samples_of_about_a_tenth_of_a_second_are_refused():
    scenario = load_any("hst_short", ["timing.control_period_ms=120", "timing.base_tick_ms=40"])
    with pytest.raises(InputError, match=r"= 0.36 s, expected more than the longest delay, 1 s"):
        loop("res_ngpc", scenario=scenario, sample_period_s=0.12)
    loop("res_ngpc", scenario=scenario, sample_period_s=0.12, override=True)


def test_an_unstable_loop_is_refused_with_its_spectral_radius():
    with pytest.raises(InputError, match=r"spectral radius 1\.\d+ in \w+, expected a spectral radius below 1"):
        loop("res_ngpc", sample_period_s=0.4, control_weight=0.01)


@pytest.mark.parametrize(("law", "weight"), [("mm_gpc", 0.01), ("a_gpc", 0.3)])
def test_an_unstable_loop_of_a_comparator_is_refused_too(law, weight):
    message = r"spectral radius 1\.\d+ in braking( with gain 1)?, expected a spectral radius below 1"
    with pytest.raises(InputError, match=message):
        loop(law, control_weight=weight)
    loop(law, control_weight=weight, override=True)


def test_fixed_point_is_refused_in_one_line():
    with pytest.raises(InputError, match="float64 or float32: this law has no fixed-point formats"):
        VectorController(SHORT, LawSpec("res_ngpc", arithmetic="iq"))


def test_a_sampling_period_between_two_control_periods_is_refused():
    with pytest.raises(InputError, match=r"sample_period_s: found 0.5, allowed a multiple of the control period"):
        loop("res_ngpc", sample_period_s=0.5)


def readings(count=60):
    """Readings of a train that accelerates from 80 km/h with noise, raw."""
    generator = np.random.default_rng(7)
    for k in range(count):
        points = [8000 + round(140 * (0.2 * k + 0.25 * j)) for j in range(15)]
        speed = points[0] + round(7 * generator.standard_normal())
        yield [speed, *points[1:], points[0], int(k > 50)]


@pytest.mark.parametrize(
    ("law", "ident"), [*((law, "off") for law in LAWS), ("res_ngpc", "differenced"), ("res_ngpc", "paper")]
)
def test_single_precision_commands_what_double_precision_does(law, ident):
    values = {} if ident == "off" else {"ident": ident}
    double, single = loop(law, **values), loop(law, "float32", **values)
    differences = []
    for raws in readings():
        (_, first), (_, second) = double.step(raws), single.step(raws)
        # Commands count 0.001 m/s^2.
        differences.append(abs(first.commands[0] - second.commands[0]) / 1000)
    assert max(differences) <= 1e-4


def test_the_integral_of_the_pid_does_not_drift_in_single_precision():
    """At 300 km/h a speed in single precision is rounded to 8e-6 m/s; the difference of two counts is exact."""
    double, single = loop("pid"), loop("pid", "float32")
    generator = np.random.default_rng(7)
    for _ in range(400):
        speed = 30000 + round(7 * generator.standard_normal())
        for law in (double, single):
            law.step([speed, *[30001] * 15, 0])
    ours, theirs = (law.state.held[0].accel for law in (single, double))
    assert abs(ours - theirs) <= 1e-6


@pytest.mark.parametrize("law", LAWS)
def test_the_law_runs_on_arrays_as_on_one_train(law):
    one, many = loop(law), VectorLoop(SHORT, LawSpec(law), make("float64", batch=True))
    for raws in readings(20):
        (_, single), (_, several) = one.step(raws), many.step([np.full(3, raw) for raw in raws])
        assert np.broadcast_to(several.commands[0], 3).tolist() == [single.commands[0]] * 3


def test_a_command_that_was_not_the_laws_is_what_the_model_knows():
    told, silent = loop("res_ngpc"), loop("res_ngpc")
    for raws in readings(5):
        told.step(raws), silent.step(raws)
    told.sent([-1000, 2])
    assert told.state.loops[0].past.commands[0] == pytest.approx(-1.0)
    assert silent.state.loops[0].past.commands[0] != pytest.approx(-1.0)


def test_the_trigger_of_an_emergency_is_a_sample():
    law = loop("res_ngpc")
    commands = [law.step(raws)[1].commands[0] for raws in readings(60)]
    changes = [k for k in range(1, 60) if commands[k] != commands[k - 1]]
    # Every fifth control period, from the trigger at 51 on counted from there.
    assert all(k % 5 == 0 for k in changes if k < 51)
    assert 51 in changes
    assert all((k - 51) % 5 == 0 for k in changes if k >= 51)


def still(target, later, emergency=0):
    """Raw readings: a train at 0.36 km/h; the target now and up to 3.25 s ahead, and 3.5 s ahead, raw."""
    return [36, *[target] * 13, later, target, emergency]


@pytest.mark.parametrize("law", LAWS)
def test_a_train_is_held_at_the_end_of_the_reference_and_not_before_its_start(law):
    ends, starts = loop(law), loop(law)
    for _ in range(6):
        held, begun = ends.step(still(0, 0))[1], starts.step(still(0, 165))[1]
    assert held.commands[0] <= -300
    assert held.commands[1] == 2.0
    assert begun.commands[0] > -300


def test_the_first_command_of_an_emergency_is_stronger_with_the_smaller_weight():
    commands = []
    for values in ({}, {"emergency_weight": 4.0}):
        law = loop("delay_gpc", **values)
        for _ in range(20):
            law.step([30000] * 16 + [0])
        profile = [30000 - round(223 * max(0.25 * j - 0.5, 0.0)) for j in range(15)]
        commands.append(law.step([30000, *profile[1:], profile[0], 1])[1].commands[0])
    assert commands[0] < 1.2 * commands[1] < 0


@pytest.mark.slow
def test_our_law_follows_the_emergency_profile_and_stands_at_its_end():
    found = journey(load_any("jinan_xuzhou_emergency"), "delay_gpc", 105)
    assert found.rmse_kmh < 0.15
    assert found.commands_mps2[-1] <= -0.3


@pytest.mark.long
@pytest.mark.slow
def test_the_identification_error_of_002_lets_the_train_run_away():
    scenario = load_any("hst_short", ["task.duration_s=400"])
    found = journey(scenario, "res_ngpc", 1, {"ident": "paper", "ident_error": "reference"})
    assert found.rmse_kmh > 50


@pytest.mark.slow
def test_the_residual_tracks_the_curve():
    found = journey(SHORT, "res_ngpc", 1)
    assert found.rmse_kmh < 0.15
    assert replace(found, errors_kmh=found.errors_kmh * 2).rmse_kmh == pytest.approx(2 * found.rmse_kmh)


@pytest.mark.long
@pytest.mark.slow
def test_the_printed_identification_does_not_beat_none_in_the_emergency():
    scenario = load_any("jinan_xuzhou_emergency")
    printed, none = (journey(scenario, "res_ngpc", 1, {"ident": ident}) for ident in ("paper", "off"))
    assert printed.rmse_kmh > 2 * none.rmse_kmh
