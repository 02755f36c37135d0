"""The TDMC law: gains, predictions and correction against an independent textbook implementation, then the law on the
train."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.closed_loop import stops_in_fixed_point
from railhil.bench import direct_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.laws.tdmc import Tdmc
from railhil.controller_node.ato.pfc_model import InternalModel
from railhil.controller_node.ato.tdmc_constants import (
    TdmcParameters,
    compute_constants,
    control_gains,
    correction_norms,
    dynamic_matrix,
)
from railhil.controller_node.laws.base import NOTCH_RAW_Q, LawInputs
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

SCENARIO = load("lvshun_tieshan")
DEFAULT = TdmcParameters()
TABLE = compute_constants(DEFAULT, 0.5, 7.0)


def values(row: Any) -> np.ndarray:
    return np.array([constant.value for constant in row])


def settled(**changes: float) -> Tdmc[float]:
    return Tdmc(make("float64"), SCENARIO, replace(DEFAULT, **changes))


def test_step_response_is_that_of_the_model_and_settles() -> None:
    a = values(TABLE.step_response)
    p1, p2 = np.sort(np.roots([1.0, 0.4356, 0.0324]))
    time_s = np.arange(1, 121) * 0.5
    rest = 0.07128 * 3.6 / 0.0324
    exact = rest * (1 - (p2 * np.exp(p1 * time_s) - p1 * np.exp(p2 * time_s)) / (p2 - p1))
    np.testing.assert_allclose(a, exact, atol=2.0**-16 + 1e-9)
    assert 0.995 < a[-1] / rest < 1
    assert all(constant.rounding_error == 0 for constant in TABLE.step_response)


def test_gains_solve_the_least_squares_problem() -> None:
    """First move that minimises sum q_i (d_i - (A du)_i)^2 + R |du|^2, by stacked least squares."""
    parameters = replace(DEFAULT, last_error_weight=4.0)
    table = compute_constants(parameters, 0.5, 7.0)
    a = values(table.step_response)
    matrix = np.array([[a[i - j] if i >= j else 0.0 for j in range(4)] for i in range(15)])
    np.testing.assert_array_equal(dynamic_matrix(a, 15, 4), matrix)
    weights = 4.0 ** (np.arange(15) / 14)
    stacked = np.vstack([np.sqrt(weights)[:, None] * matrix, np.sqrt(0.1) * np.eye(4)])
    for wanted in (np.eye(15)[6], np.linspace(0.3, -2.0, 15)):
        right = np.append(np.sqrt(weights) * wanted, np.zeros(4))
        moves = np.linalg.lstsq(stacked, right, rcond=None)[0]
        assert values(table.gains) @ wanted == pytest.approx(moves[0], abs=1e-9)
    reachable = matrix @ np.array([0.7, -0.2, 0.1, 0.4])
    assert control_gains(matrix, weights, 0.0) @ reachable == pytest.approx(0.7, abs=1e-9)


class Textbook:
    """One vector of N predictions: add the move, correct by h, shift, hold the last."""

    def __init__(self, level: float, ramp: float) -> None:
        self.a, self.d = values(TABLE.step_response), values(TABLE.gains)
        self.h = level + ramp * np.arange(len(self.a))
        self.y = np.zeros(len(self.a))
        self.sent = 0.0

    def notch(self, speed: float, ahead: np.ndarray) -> float:
        self.y = self.y + self.h * (speed - self.y[0])
        self.y = np.append(self.y[1:], self.y[-1])
        return self.sent + float(self.d @ (ahead - self.y[: len(self.d)]))

    def send(self, notch: float) -> None:
        self.y = self.y + self.a * (notch - self.sent)
        self.sent = notch


@pytest.mark.parametrize(("level", "ramp"), [(1.0, 0.6), (0.8, 0.2), (1.0, 0.0)])
def test_law_is_the_textbooks(level: float, ramp: float) -> None:
    """100 periods of random speeds; now and then another notch is sent than the law's."""
    generator = np.random.Generator(np.random.PCG64(1980))
    law, book = settled(correction_level=level, correction_ramp=ramp), Textbook(level, ramp)
    state = law.start(LawInputs(0.0, 0.0, [0.0] * 15))
    for k in range(100):
        speed, ahead = float(generator.uniform(0, 2)), generator.uniform(0, 3, 15)
        state, outputs = law.step(state, LawInputs(speed, 0.0, list(ahead)))
        assert outputs.notch_raw == pytest.approx(book.notch(speed, ahead), abs=1e-9)
        assert outputs.notch == np.floor(np.clip(outputs.notch_raw, -7, 7) * 256 + 0.5) / 256
        sent = outputs.notch
        if k % 9 == 4:
            sent = float(generator.integers(-1792, 1793)) / 256
            state = law.with_sent(state, sent)
        book.send(sent)


def test_predictions_are_the_models_responses() -> None:
    """50 random notches: what the law holds for the next 60 periods is what the sampled model does."""
    generator = np.random.Generator(np.random.PCG64(2))
    notches = generator.integers(-1792, 1793, 50) / 256
    model = InternalModel.sampled(0.07128 * 3.6, 0.4356, 0.0324, 0.5)
    law = settled()
    state = law.start(LawInputs(0.0, 0.0, [0.0] * 15))
    for notch in notches:
        state = law.with_sent(law.step(state, LawInputs(0.0, 0.0, [0.0] * 15))[0], float(notch))
    state = law.step(state, LawInputs(0.0, 0.0, [0.0] * 15))[0]
    held = np.append(notches, np.full(60, notches[-1]))
    np.testing.assert_allclose(state.predictions[:60], model.responses(held[None, :])[0, 50:], atol=2e-3)


def test_predictions_never_drift_in_fixed_point() -> None:
    """Sums of exact products: after 400 random notches raw predictions equal those of float64 to the last bit."""
    generator = np.random.Generator(np.random.PCG64(3))
    laws: list[Tdmc[Any]] = [Tdmc(make(name), SCENARIO) for name in ("iq", "float64")]
    zero = LawInputs(0, 0, [0] * 15)
    states = [law.start(zero) for law in laws]
    for _ in range(400):
        code = int(generator.integers(-1792, 1793))
        notches = (code, code / 256)
        states = [
            law.with_sent(law.step(state, zero)[0], notch)
            for law, state, notch in zip(laws, states, notches, strict=True)
        ]
    assert [raw / 2**23 for raw in states[0].predictions] == list(states[1].predictions)


def test_a_ramp_of_the_model_error_is_followed_only_by_a_ramp_of_the_correction() -> None:
    """Notch 0, speed rising by 0.5 km/h per period: the line ends on it with a ramp, below it without."""
    for ramp, behind in ((0.6, 0.0), (0.0, 0.5)):
        law = settled(correction_ramp=ramp)
        state = law.start(LawInputs(0.0, 0.0, [0.0] * 15))
        for k in range(1, 60):
            state = law.with_sent(law.step(state, LawInputs(0.5 * k, 0.0, [0.0] * 15))[0], 0.0)
        assert state.level == pytest.approx(0.5 * 59, abs=1e-9)
        assert 0.5 - state.slope == pytest.approx(behind, abs=1e-9)


def run(**changes: float) -> Any:
    return direct_run(
        SCENARIO, RunSpec(law=LawSpec("tdmc", "float64", parameters=ParameterSet("tdmc", changes, Path("test"))))
    ).score


@pytest.mark.long
@pytest.mark.slow
def test_train_needs_the_ramp_in_the_correction() -> None:
    with_ramp, without = run(), run(correction_ramp=0.0)
    assert with_ramp.values["stop_error_m"] < 0.5
    assert with_ramp.values["punctuality_s"] < 0.3
    assert without.values["stop_error_m"] > 10
    assert without.values["itae"] > 5 * with_ramp.values["itae"]


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("name", ["lvshun_tieshan", "yizhuang_01_songjiazhuang_xiaocun"])
def test_train_stops_with_set_points_over_distance_within_the_limits_of_speed(name: str) -> None:
    """Those over time: hil_tests/properties."""
    stops_in_fixed_point("tdmc", name, "distance", 0.5)


def test_a_speed_that_falls_to_zero_saturates_and_does_not_wrap() -> None:
    number = make("iq")
    law: Tdmc[int] = Tdmc(number, SCENARIO)
    fast = [250 << 20] * 15
    state, _ = law.step(law.start(LawInputs(fast[0], fast[0], fast)), LawInputs(fast[0], fast[0], fast))
    _, outputs = law.step(state, LawInputs(0, fast[0], fast))
    assert outputs.notch == 7 * 256
    assert outputs.notch_raw > 7 << NOTCH_RAW_Q
    assert number.counters.wraps == 0
    assert number.counters.saturations > 0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"control_horizon_s": 8.0}, "do not nest"),
        ({"model_horizon_s": 5.0}, "do not nest"),
        ({"model_horizon_s": 400.0}, "takes 800 control periods, more than 600"),
        ({"correction_ramp": 2.5}, "does not settle"),
        ({"correction_level": 0.0, "correction_ramp": 0.5}, "does not settle"),
    ],
)
def test_parameters_that_do_not_fit_are_refused(change: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        settled(**change)


def test_correction_without_ramp_is_bounded_by_the_error() -> None:
    assert correction_norms(1.0, 0.0) == pytest.approx((1.0, 0.0))
