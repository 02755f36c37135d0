"""Parts of the learned laws: residuals and their modelling error, dither, networks of a law, weights files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.high_speed.identification import Past, residual, theta_of
from railhil.controller_node.high_speed.law import Unit
from railhil.controller_node.high_speed.laws.elm_ngpc import ElmNgpc
from railhil.controller_node.high_speed.laws.os_elm_ngpc import SequentialEstimator, SequentialStep
from railhil.controller_node.high_speed.learned import LearnedParameters, NetworkEstimator, shipped_networks
from railhil.controller_node.high_speed.model import pade_zoh
from railhil.controller_node.high_speed.network import Forward
from railhil.controller_node.high_speed.training import HELD_OUT, Recipe, rows_of, select_held_out, train_and_judge
from railhil.controller_node.vector.reals import Reals

MODEL = pade_zoh(0.5, 0.4, 1.0)
UNIT = Unit(0.5, 1.0, 0.4, 1.0)


def journey(count: int = 1200, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Speeds and commands of a train that is the linear model with running resistance and noise."""
    random = np.random.default_rng(seed)
    v, u = np.zeros(count), np.zeros(count)
    for k in range(3, count):
        goal = 40.0 + 40.0 * np.sin(k / 180.0)
        resistance = 0.05 + 0.07 * (v[k - 1] / 83.0) ** 2
        linear = -np.dot(MODEL.a, v[k - 3 : k][::-1]) + np.dot(MODEL.b, u[k - 3 : k][::-1])
        # A(1) = 0: what is subtracted here is the resistance as the model's residual.
        v[k] = linear - 0.1 * resistance + 0.002 * random.standard_normal()
        u[k] = np.clip(0.2 * (goal - v[k]) + 0.05 * (1 if k // 3 % 2 else -1), -1.3, 0.55)
    return v, u


def test_the_rows_hold_the_residual_that_the_law_measures() -> None:
    v, u = journey(40)
    rows = rows_of(MODEL, v, u)
    re: Reals[float] = Reals(make("float64"))
    theta = theta_of(re, MODEL)
    for inputs, found, speed in zip(rows.inputs.tolist(), rows.residual_mps, v[3:].tolist(), strict=True):
        past = Past(tuple(inputs[:3]), tuple(inputs[3:]))
        assert residual(re, theta, speed, past, integrating=True) == pytest.approx(found, abs=1e-12)


def test_a_network_halves_the_modelling_error_on_samples_that_it_has_not_seen() -> None:
    network, error = train_and_judge(rows_of(MODEL, *journey()), Recipe(ridge=0.01), 1.0, 0.5, 0.4)
    assert error.integrated_kmh < 0.5 * error.linear_kmh
    assert (network.sample_period_s, network.model_delay_s, network.model_lag_s) == (1.0, 0.5, 0.4)


def test_the_held_out_samples_are_300_spread_over_the_journey() -> None:
    chosen = select_held_out(3754)
    gaps = np.diff(np.flatnonzero(chosen))
    assert chosen.sum() == HELD_OUT
    assert set(gaps.tolist()) == {12, 13}
    with pytest.raises(ValueError, match="599 samples"):
        select_held_out(599)


@pytest.fixture
def law() -> ElmNgpc[float]:
    """A law without a scenario: only its choice of a network."""
    return ElmNgpc.__new__(ElmNgpc)


def test_a_law_takes_the_network_of_its_linear_model(law: ElmNgpc[float]) -> None:
    rows = rows_of(MODEL, *journey())
    networks = [train_and_judge(rows, Recipe(), 1.0, delay_s, 0.4)[0] for delay_s in (0.5, 0.7)]
    law._networks = tuple(networks)
    assert law.network(UNIT, LearnedParameters()) is networks[0]
    assert law.network(UNIT, LearnedParameters(model_delay_s=0.7)) is networks[1]
    with pytest.raises(InputError, match="elm_ngpc, networks: no such network, expected one trained for T0 = 2 s"):
        law.network(Unit(0.5, 1.0, 0.4, 2.0), LearnedParameters())
    law._networks = (train_and_judge(rows, Recipe("bp", hidden=2), 1.0, 0.5, 0.4)[0],)
    with pytest.raises(InputError, match="found 'bp', allowed elm"):
        law.network(UNIT, LearnedParameters())


def test_a_sequential_network_learns_a_shift_that_a_trained_one_keeps() -> None:
    ar = make("float64")
    rows = rows_of(MODEL, *journey())
    network, _ = train_and_judge(rows, Recipe(), 1.0, 0.5, 0.4)
    estimators: list[Any] = [
        NetworkEstimator(Forward(ar, network)),
        SequentialEstimator(Forward(ar, network), SequentialStep(ar, 0.01), newest=True),
    ]
    left = []
    for estimator in estimators:
        memory = estimator.start()
        for inputs, measured in zip(rows.inputs.tolist()[:60], rows.residual_mps.tolist(), strict=False):
            past = Past(tuple(inputs[:3]), tuple(inputs[3:]))
            memory, estimate = estimator.step(memory, past, measured + 0.03)
            # Before and after the sample.
            error = abs(measured + 0.03 - estimate.predicted)
        left.append((error, abs(measured + 0.03 - estimate.used)))
    assert left[0][0] == left[0][1] > 0.02
    assert left[1][1] < left[1][0] < 0.01


def test_a_damaged_weights_file_is_one_line(tmp_path: Path) -> None:
    assert shipped_networks("elm_ngpc", "toy") == ()
    (tmp_path / "elm_ngpc_toy.toml").write_text(
        'law = "elm_ngpc"\n[[parameters.networks]]\nkind = "elm"\nsample_period_s = 1.0\nmodel_delay_s = 0.5\n'
        "model_lag_s = 0.4\noffset = [0.0]\nscale = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]\n"
        "hidden = [[1.0, 1.0, 1.0, 1.0, 1.0, 1.0]]\nbias = [0.0]\noutput = [1.0]\n"
    )
    with pytest.raises(InputError, match=r"elm_ngpc_toy.toml: parameters.networks.*offset: found") as caught:
        shipped_networks("elm_ngpc", "toy", tmp_path)
    assert "\n" not in str(caught.value)
