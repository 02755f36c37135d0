"""Model, Diophantine equations, weights and stability of the high-speed laws, against independent transcriptions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from railhil.controller_node.arithmetic import make
from railhil.controller_node.high_speed.model import (
    bilinear,
    bilinear_without_direct,
    exponential,
    pade_zoh,
)
from railhil.controller_node.high_speed.predictor import first_row, predictions, weights
from railhil.controller_node.high_speed.stability import Train, spectral_radius
from railhil.controller_node.vector.reals import Reals

RE = Reals(make("float64"))
LAG_S = 0.4


def transfer(delay_s: float) -> tuple[list[float], list[float]]:
    """Numerator and denominator of the Pade model in s (004 eq. 5)."""
    pole = 2.0 / delay_s
    return [-1.0, pole], [LAG_S, pole * LAG_S + 1.0, pole, 0.0]


@pytest.mark.parametrize("delay_s", [0.5, 0.8, 1.0, 1.2])
@pytest.mark.parametrize("period_s", [0.1, 0.2, 0.5, 1.0])
@pytest.mark.parametrize(("mine", "method"), [(pade_zoh, "zoh"), (bilinear, "bilinear")])
def test_the_sampled_model_is_that_of_scipy(mine, method, delay_s, period_s):
    # Every process that collects the tests would load it.
    from scipy.signal import cont2discrete

    numerator, denominator, _ = cont2discrete(transfer(delay_s), period_s, method)
    found = mine(delay_s, LAG_S, period_s)
    assert found.a == pytest.approx(denominator[1:], abs=1e-9)
    assert (found.direct, *found.b) == pytest.approx(np.ravel(numerator), abs=1e-9)
    # The integrator.
    assert 1 + sum(found.a) == pytest.approx(0, abs=1e-12)


def test_the_matrix_exponential_is_that_of_scipy():
    matrix = np.array([[0.0, 1.0, 3.0], [0.5, -9.0, 20.0], [0.0, 1.0, -25.0]])
    assert exponential(matrix) == pytest.approx(expm(matrix), abs=1e-11)
    assert exponential(np.zeros((2, 2))).tolist() == np.eye(2).tolist()


@pytest.mark.parametrize(
    ("delay_s", "period_s", "share"), [(0.5, 1.0, 0.06), (1.0, 1.0, 0.0), (0.5, 0.5, 0.0), (1.2, 0.1, -1.375)]
)
def test_dropping_c0_costs_the_gain_that_the_specification_says(delay_s, period_s, share):
    whole, dropped = bilinear(delay_s, LAG_S, period_s), bilinear_without_direct(delay_s, LAG_S, period_s)
    assert dropped.b == whole.b
    assert whole.direct / (whole.direct + whole.b_sum) == pytest.approx(share, abs=0.005)


@pytest.mark.parametrize("horizon", [1, 3, 16])
@pytest.mark.parametrize("seed", range(5))
def test_the_identities_of_the_diophantine_equations_hold(horizon, seed):
    generator = np.random.default_rng(seed)
    a, b = generator.uniform(-1, 1, 3 + seed % 2), generator.uniform(-1, 1, 3)
    found = predictions(RE, tuple(a), tuple(b), horizon)
    whole = np.concatenate([[1.0], a])
    for j in range(1, horizon + 1):
        e, g = np.array(found.e[:j]), np.array(found.g[:j])
        one = np.convolve(e, whole)
        one[j:] += found.f[j - 1]
        assert one == pytest.approx(np.eye(1, len(one))[0], abs=1e-10)
        left, right = np.convolve(e, b), np.zeros(j + 2)
        right[:j] += g
        right[j:] += found.h[j - 1]
        assert left == pytest.approx(right, abs=1e-10)
        assert found.e_sum[j - 1] == pytest.approx(e.sum(), abs=1e-10)
        assert found.g_sum[j - 1] == pytest.approx(g.sum(), abs=1e-10)


@pytest.mark.parametrize("control_horizon", [1, 2])
@pytest.mark.parametrize("held", [False, True])
def test_the_closed_solution_is_the_first_row_of_the_normal_equations(control_horizon, held):
    g = (0.13, 0.71, 1.64, 2.6)
    matrix = np.zeros((4, 4))
    for i in range(4):
        matrix[i:, i] = g[: 4 - i]
    if held:
        matrix[:, control_horizon - 1] = matrix[:, control_horizon - 1 :].sum(axis=1)
    matrix = matrix[:, :control_horizon]
    expected = np.linalg.solve(matrix.T @ matrix + 0.3 * np.eye(control_horizon), matrix.T)[0]
    assert first_row(RE, g, control_horizon, 0.3, held) == pytest.approx(expected, abs=1e-12)


def test_a_longer_control_horizon_has_no_closed_solution():
    with pytest.raises(ValueError, match="control horizon 3, allowed 1 or 2"):
        first_row(RE, (1.0, 2.0), 3, 0.3)


@pytest.mark.parametrize("a_sum", [0.0, 0.01])
@pytest.mark.parametrize("weight", [0.0, 0.3, 1.0])
def test_both_conditions_of_eq_30_hold_exactly_only_with_the_weights_of_d6(a_sum, weight):
    model = pade_zoh(0.5, LAG_S, 1.0)
    a = (*model.a[:2], model.a[2] + a_sum)
    found = predictions(RE, a, model.b, 3)
    p = first_row(RE, found.g, 2, weight)
    exact = weights(RE, found, p, a_sum, model.b_sum)
    assert 1 + sum(exact.h) == pytest.approx(model.b_sum * exact.xi, abs=1e-10)
    h_1, f_1, w_1 = 1 + sum(exact.h), sum(exact.f), sum(exact.w)
    assert a_sum * h_1 + model.b_sum * f_1 == pytest.approx(model.b_sum * w_1, abs=1e-10)
    printed = weights(RE, found, p, a_sum, model.b_sum, exact=False)
    assert abs(1 + sum(printed.h) - model.b_sum * printed.xi) > 1e-3


WEIGHTS = (0.01, 0.1, 0.3, 1.0, 3.0, 10.0)
#: Table of D1: delay of the train, delay of the model, sampling period, radius for each of WEIGHTS.
TABLE_D1 = (
    (0.5, 0.5, 0.1, (1.144, 1.027, 1.010, 1.003, 1.001, 1.000)),
    (0.5, 0.5, 0.2, (0.901, 0.980, 0.993, 0.998, 0.999, 1.000)),
    (0.5, 0.5, 0.5, (0.951, 0.640, 0.471, 0.734, 0.901, 0.969)),
    (0.5, 0.5, 1.0, (0.380, 0.324, 0.261, 0.336, 0.600, 0.829)),
    (1.0, 1.0, 0.2, (1.419, 1.115, 1.051, 1.018, 1.006, 1.002)),
    (1.0, 1.0, 0.5, (1.789, 0.764, 0.691, 0.879, 0.957, 0.987)),
    (1.0, 1.0, 1.0, (0.811, 0.693, 0.586, 0.450, 0.648, 0.861)),
    (1.0, 0.5, 0.5, (1.398, 0.878, 0.822, 0.716, 0.886, 0.968)),
    (1.0, 0.5, 1.0, (0.737, 0.713, 0.683, 0.635, 0.566, 0.806)),
    (1.2, 1.2, 0.2, (1.419, 1.126, 1.059, 1.022, 1.008, 1.002)),
    (1.2, 1.2, 0.5, (1.276, 0.913, 0.826, 0.933, 0.976, 0.993)),
    (1.2, 1.2, 1.0, (1.192, 1.035, 0.878, 0.661, 0.671, 0.874)),
)


def radius(train, model_delay_s, period_s, weight, smoothing=None):
    model = pade_zoh(model_delay_s, LAG_S, period_s)
    found = predictions(RE, model.a, model.b, 3)
    p = first_row(RE, found.g, 2, weight)
    return spectral_radius(train, model, weights(RE, found, p, 0.0, model.b_sum), period_s, smoothing)


@pytest.mark.parametrize(("delay_s", "model_delay_s", "period_s", "expected"), TABLE_D1)
def test_spectral_radii_are_those_of_table_d1(delay_s, model_delay_s, period_s, expected):
    found = [radius(Train(delay_s, LAG_S), model_delay_s, period_s, weight) for weight in WEIGHTS]
    assert found == pytest.approx(expected, abs=5.1e-4)


@pytest.mark.parametrize("weight", WEIGHTS)
def test_a_horizon_shorter_than_the_delay_is_unstable_for_every_weight(weight):
    assert radius(Train(0.5, LAG_S), 0.5, 0.1, weight) > 1


SMOOTHINGS = (0.1, 0.2, 0.35, 0.6)
#: End of section 2 of the specification: train, radius for each of SMOOTHINGS.
TABLE_RESIDUAL = (
    (Train(0.5, 0.4), (0.900, 0.800, 0.648, 0.446)),
    (Train(1.0, 0.4), (0.901, 0.811, 0.843, 0.923)),
    (Train(1.0, 0.8, 0.7), (0.892, 0.812, 0.882, 0.938)),
    (Train(1.0, 0.4, 1.4), (0.907, 0.937, 1.010, 1.100)),
    (Train(1.5, 0.4), (0.902, 0.947, 1.008, 1.074)),
    (Train(2.0, 0.4), (0.992, 1.035, 1.088, 1.144)),
)


@pytest.mark.parametrize(("train", "expected"), TABLE_RESIDUAL)
def test_spectral_radii_with_the_residual_closed_are_those_of_the_specification(train, expected):
    found = [radius(train, 0.5, 1.0, 0.3, smoothing) for smoothing in SMOOTHINGS]
    assert found == pytest.approx(expected, abs=5.1e-4)


def test_an_estimator_that_never_learns_adds_its_own_pole():
    assert radius(Train(0.5, LAG_S), 0.5, 1.0, 0.3, 0.0) == pytest.approx(1.0)
