"""The constant table of the IPFC law: basis values first, then gains, then their rounding errors in fixed point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.float32 import rounding_error
from railhil.controller_node.ato.ipfc_constants import IpfcParameters, compute_constants, make_constants
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.ato.pfc_constants import Wavelet, internal_model, wavelet_basis
from railhil.controller_node.ato.pfc_model import InternalModel, polynomial_fit
from railhil.controller_node.laws.constant_table import coarse
from railhil.scenarios.load import load

SCENARIO = load("lvshun_tieshan")

PAPER = IpfcParameters()


def values(row: tuple) -> list[float]:
    return [constant.value for constant in row]


def test_basis_functions_at_zero() -> None:
    wavelets = wavelet_basis(PAPER.wavelets, PAPER.horizon, 0.5)
    assert wavelets.shape == (2, 10)
    np.testing.assert_allclose(wavelets[:, 0], [1.0, -0.2096], atol=5e-5)


def test_gains_are_those_of_the_reading() -> None:
    table = compute_constants(PAPER, 0.5, 7.0)
    np.testing.assert_allclose(values(table.gains_step), [0.061112, 0.148285, 0.312669, 0.371784], atol=5e-7)
    np.testing.assert_allclose(values(table.gains_wavelet), [9.768280, 5.632148, -4.685656, 0.807362], atol=5e-7)


def test_threshold_of_the_basis_is_that_of_the_paper() -> None:
    assert make_constants(PAPER, 0.5, 7.0).wavelet_change.value == pytest.approx(5.67, abs=1e-12)


def test_internal_model_against_its_poles() -> None:
    """A and B of a sampled second-order model follow from its two real poles."""
    model = internal_model(PAPER, 0.5)
    p1, p2 = np.roots([1.0, 0.4356, 0.0324])
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(model.a)), np.sort(np.exp([p1 * 0.5, p2 * 0.5])), rtol=1e-11)
    settled = np.linalg.solve(np.eye(2) - model.a, model.b)
    np.testing.assert_allclose(settled, [0.07128 * 3.6 / 0.0324, 0.0], atol=1e-10)


def test_free_rows_and_step_response_replay_the_model() -> None:
    model = internal_model(PAPER, 0.5)
    state, forced = np.array([3.0, -0.7]), np.zeros(2)
    for row, response in zip(model.free_rows(10), model.step_response(10), strict=True):
        state, forced = model.a @ state, model.a @ forced + model.b
        assert row @ [3.0, -0.7] == pytest.approx(state[0] - 3.0, abs=1e-11)
        assert response == pytest.approx(forced[0], abs=1e-11)


def test_gains_minimise_the_squared_deviation() -> None:
    """The gains applied to a reachable d give back the input that reaches it."""
    model = internal_model(PAPER, 0.5)
    wavelets = wavelet_basis(PAPER.wavelets, PAPER.horizon, 0.5)
    weights = np.array([0.4, -1.3])
    d = weights @ model.responses(wavelets)[:, [2, 4, 7, 8]]
    assert model.gains(wavelets, (3, 5, 8, 9)) @ d == pytest.approx(weights @ wavelets[:, 0], abs=1e-9)


def test_polynomial_fit_returns_the_coefficients_of_a_polynomial() -> None:
    for points in (range(1, 11), range(-7, 0)):
        fit = polynomial_fit(points, 2)
        ahead = np.array([2.5 * i - 0.3 * i**2 for i in points])
        np.testing.assert_allclose(fit @ ahead, [2.5, -0.3], atol=1e-10)


def test_fixed_point_holds_every_constant_to_1e_4() -> None:
    assert coarse(Ipfc(make("iq"), SCENARIO).constants) == ()
    assert all(abs(c.rounding_error) <= 2.0 ** -(c.q + 1) for c in Ipfc(make("iq"), SCENARIO).constants)


def test_names_of_constants_are_unique() -> None:
    names = [constant.name for constant in Ipfc(make("iq"), SCENARIO).constants]
    assert len(names) == len(set(names)) > 300


def test_single_precision_holds_every_constant_to_half_a_step() -> None:
    for constant in Ipfc(make("float32"), SCENARIO).constants:
        assert abs(rounding_error(constant)) <= abs(constant.value) * 2.0**-24
    assert any(rounding_error(constant) for constant in Ipfc(make("float32"), SCENARIO).constants)


@pytest.mark.parametrize("period_s", [0.5, 0.4])
def test_softening_curve_is_sampled_in_the_table(period_s: float) -> None:
    """Fixed point takes eq. (27) from the table, loaded or computed, not from the function of this machine."""
    timing = replace(SCENARIO.timing, control_period_ns=round(period_s * 1e9))
    law = Ipfc(make("iq"), replace(SCENARIO, timing=timing))
    assert law._curve.samples is law.table.softening
    assert len(law.table.softening) == 257
    for i, sample in enumerate(law.table.softening):
        assert sample.value == pytest.approx(0.85 * (0.77 / 0.85) ** ((i / 256) ** 0.94), abs=1e-14)


@pytest.mark.parametrize("period_s", [0.2, 0.4, 0.5, 1.0])
def test_other_control_periods_fit_the_formats(period_s: float) -> None:
    table = make_constants(PAPER, period_s, 7.0)
    assert table.per_period.value == 1 / period_s
    assert len(table.gains_step) == 4


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"fit_points": (3, 5, 8, 11)}, "beyond the horizon of 10 periods"),
        ({"fit_points": (3,)}, "as many different fitting points"),
        ({"error_order": 4, "error_window": 4}, "error_order 4 takes an error_window longer than 4"),
        ({"horizon": 3, "fit_points": (2, 3), "set_point_order": 4}, "set_point_order 4 is above the horizon of 3"),
        ({"softening_span": 0.85}, "softening_span 0.85 is not below softening_max 0.85"),
        ({"rise_time_min_s": 0.03}, "rise_time_min_s 0.03 is above rise_time_max_s 0.02"),
    ],
)
def test_parameters_that_do_not_fit_each_other_are_refused(change: dict, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        make_constants(replace(PAPER, **change), 0.5, 7.0)


def test_wavelet_parameters_reach_the_gains() -> None:
    other = replace(PAPER, wavelets=(Wavelet(1.0, 0.0, 0.5), Wavelet(2.0, 4.0, 0.5)))
    gains = [values(make_constants(parameters, 0.5, 7.0).gains_wavelet) for parameters in (PAPER, other)]
    assert gains[0] != gains[1]


def test_model_of_a_pure_integrator() -> None:
    """Zero damping and stiffness: a double integrator, whose sampled form is known in closed form."""
    model = InternalModel.sampled(2.0, 0.0, 0.0, 0.5)
    np.testing.assert_allclose(model.a, [[1.0, 0.5], [0.0, 1.0]], atol=1e-12)
    np.testing.assert_allclose(model.b, [2.0 * 0.125, 1.0], atol=1e-12)
