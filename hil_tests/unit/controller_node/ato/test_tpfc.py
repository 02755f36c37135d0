"""TPFC1 and TPFC2: gains and steps against an independent transcription of the equations, basis in use, fixed point,
closed loop."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.laws.tpfc1 import TABLE as TABLE1
from railhil.controller_node.ato.laws.tpfc1 import Tpfc1Parameters
from railhil.controller_node.ato.laws.tpfc2 import TABLE as TABLE2
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import Law, LawInputs
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec

SCENARIO = load("lvshun_tieshan")
LAWS = ["tpfc1", "tpfc2"]
POINTS = [3, 5, 8, 9]
PERIOD_S = 0.5
#: exp(-Ts / (2 Ts)).
ALPHA = np.exp(-0.5)

SECONDS = np.arange(10) * PERIOD_S
STEP = np.ones((1, 10))
STEP_RAMP = np.vstack([np.ones(10), SECONDS])
WAVELETS = np.vstack(
    [
        np.exp(-0.25 * SECONDS**2 / 2) * np.cos(np.pi * SECONDS),
        np.exp(-0.25 * (SECONDS - 5) ** 2 / 4) * np.cos(np.pi * (SECONDS - 5)),
    ]
)


@cache
def model() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, B and C of eq. (2) in km/h per notch, by scipy's own zero-order hold, in scipy's own choice of states."""
    # Every process that collects the tests would load it.
    from scipy.signal import cont2discrete, tf2ss

    a, b, c, _, _ = cont2discrete(tf2ss([0.07128 * 3.6], [1.0, 0.4356, 0.0324]), PERIOD_S)
    return a, b, c


def pulse(i: int) -> float:
    """Output of the model i periods after a unit notch for one period."""
    A, B, C = model()
    return (C @ np.linalg.matrix_power(A, i - 1) @ B).item()


def first_notch(basis: np.ndarray, d: np.ndarray) -> float:
    """Eqs. (9), (17), (18): the combination of basis functions whose response misses d least, at i = 0."""
    response = np.array([[sum(pulse(h - i) * f[i] for i in range(h)) for f in basis] for h in POINTS])
    return float(np.linalg.lstsq(response, d, rcond=None)[0] @ basis[:, 0])


def law(name: str, arithmetic: Any = None) -> Law[Any, Any]:
    return load_law(name)(arithmetic or Float64(), SCENARIO)


def values(row: Any) -> list[float]:
    return [constant.value for constant in row]


@pytest.mark.parametrize(
    ("found", "basis"),
    [
        (TABLE1.load().gains_step, STEP),
        (TABLE1.load().gains_ramp, STEP_RAMP),
        (TABLE2.load().gains_wavelet, WAVELETS),
    ],
    ids=["step", "step and ramp", "wavelets"],
)
def test_gains_are_the_least_squares_solution(found: Any, basis: np.ndarray) -> None:
    np.testing.assert_allclose(values(found), [first_notch(basis, d) for d in np.eye(4)], rtol=1e-8)


def transcribed(basis: np.ndarray, steps: list[tuple[float, np.ndarray]], sent: list[float]) -> Iterator[float]:
    """Notches by eqs. (10) to (19), at speeds and set-points (now and ten ahead); ``sent``: what the train is told."""
    A, B, C = model()
    state, errors = np.zeros((2, 1)), [steps[0][0]] * 8
    i = np.arange(1, 11)
    past = np.arange(-7, 0)
    for k, (speed, targets) in enumerate(steps):
        state = A @ state + B * (sent[k - 1] if k else 0.0)
        errors = [*errors[1:], speed - (C @ state).item()]
        c = np.linalg.lstsq(np.stack([i, i**2], axis=1), targets[1:] - targets[0], rcond=None)[0]
        e = np.linalg.lstsq(np.stack([past, past**2], axis=1), np.array(errors[:-1]) - errors[-1], rcond=None)[0]
        d = [
            (1 - ALPHA**h) * (targets[0] - speed)
            + sum((c[n] - e[n]) * h ** (n + 1) for n in range(2))
            - (C @ (np.linalg.matrix_power(A, h) - np.eye(2)) @ state).item()
            for h in POINTS
        ]
        yield first_notch(basis, np.array(d))


@pytest.mark.parametrize(
    ("name", "slope", "basis", "code"),
    [("tpfc1", 0.5, STEP, 1), ("tpfc1", 1.5, STEP_RAMP, 5), ("tpfc2", 0.5, WAVELETS, 2), ("tpfc2", 1.5, WAVELETS, 2)],
)
def test_steps_are_those_of_the_equations(name: str, slope: float, basis: np.ndarray, code: int) -> None:
    """Twelve periods of a set-point of that slope (km/h per s), with other notches sent than asked for."""
    generator = np.random.Generator(np.random.PCG64(19))
    # The second derivative of the set-point is there as well: both coefficients of its polynomial.
    target = [20 + slope * (t := k * PERIOD_S) + 0.01 * t**2 for k in range(22)]
    steps = [(target[k] + generator.uniform(-1, 1), np.array(target[k : k + 11])) for k in range(12)]
    sent = [float(code) / 256 for code in generator.integers(-1792, 1793, 12)]
    expected = list(transcribed(basis, steps, sent))
    tested = law(name)
    state: Any = None
    for (speed, targets), notch, raw in zip(steps, sent, expected, strict=True):
        inputs = LawInputs(speed, float(targets[0]), [float(point) for point in targets[1:]])
        state, outputs = tested.step(tested.start(inputs) if state is None else state, inputs)
        assert outputs.notch_raw == pytest.approx(raw, abs=1e-8)
        assert outputs.notch == np.clip(np.floor(raw * 256 + 0.5) / 256, -7, 7)
        assert (outputs.notes[0], len(outputs.notes)) == (code, 2)
        assert outputs.notes[1] == pytest.approx(ALPHA, abs=1e-15)
        state = tested.with_sent(state, notch)


@pytest.mark.parametrize(("change", "code"), [(5.67, 1), (5.68, 5), (-5.67, 1), (-5.68, 5)])
def test_ramp_above_the_threshold_of_the_paper(change: float, code: int) -> None:
    """5.67 km/h over the horizon, at the threshold the step alone; speeds in fixed point, where 5.67 is a number."""
    number = make("iq")
    tested = law("tpfc1", number)
    rise = int(np.floor(abs(change) * 2**20 + 0.5)) * (1 if change > 0 else -1)
    inputs = LawInputs(40 << 20, 40 << 20, [(40 << 20) + rise * i // 10 for i in range(1, 11)])
    _, outputs = tested.step(tested.start(inputs), inputs)
    assert outputs.notes[0] == code


def given(name: str, **parameters: float) -> ParameterSet:
    return ParameterSet(name, parameters, Path("tuned.toml"))


@pytest.mark.parametrize("softening", [1.0, -0.1])
@pytest.mark.parametrize("name", LAWS)
def test_a_softening_factor_beyond_its_range_is_one_line(name: str, softening: float) -> None:
    with pytest.raises(
        InputError, match=r"^tuned.toml: parameters.softening: found .*, allowed (less than 1|at least 0)$"
    ):
        ControlLoop(SCENARIO, LawSpec(name, parameters=given(name, softening=softening)), make("iq"))


def test_a_ramp_needs_two_fitting_points() -> None:
    with pytest.raises(ValueError, match="2 basis functions need as many different fitting points, there are 1"):
        load_law("tpfc1")(make("iq"), SCENARIO, Tpfc1Parameters(fit_points=(3, 3)))
