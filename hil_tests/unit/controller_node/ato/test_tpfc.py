"""TPFC1 and TPFC2: gains and steps against an independent transcription of the equations, basis in use, fixed point,
closed loop."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.bench import coupled_run, direct_run
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.laws.tpfc1 import TABLE as TABLE1
from railhil.controller_node.ato.laws.tpfc1 import Tpfc1Parameters
from railhil.controller_node.ato.laws.tpfc2 import TABLE as TABLE2
from railhil.controller_node.ato.pfc_model import SOFTENING_Q
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, Law, LawInputs
from railhil.scenarios.load import load
from railhil.scenarios.load import names as shipped
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

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


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_fixed_point_follows_float64_on_the_same_inputs(name: str) -> None:
    """Over four runs: a raw notch lies within 1e-4 of a code's edge in a few ticks of each, by chance."""
    codes: list[tuple[int, int]] = []
    for seed in range(4):
        fixed: ControlLoop[int] = ControlLoop(SCENARIO, LawSpec(name), make("iq"))
        wide: ControlLoop[float] = ControlLoop(SCENARIO, LawSpec(name), make("float64"))

        def step(k: int, speed_01mmps: int, position_01mm: int, *_: Any, fixed: Any = fixed, wide: Any = wide) -> int:
            outputs = fixed.step(k, speed_01mmps, position_01mm)[1]
            reference = wide.step(k, speed_01mmps, position_01mm)[1]
            assert outputs.notch_raw / 2**NOTCH_RAW_Q == pytest.approx(reference.notch_raw, abs=2e-4)
            assert outputs.notes[1] / 2**SOFTENING_Q == pytest.approx(reference.notes[1], abs=1e-9)
            wide.sent(outputs.notch / 2**NOTCH_Q)
            codes.append((outputs.notch, round(reference.notch * 2**NOTCH_Q)))
            return int(outputs.notch)

        coupled_run(SCENARIO, step, RunSpec(seed=seed, perturbed=seed > 0))
        assert fixed.arithmetic.counters.flags == 0
    differences = [abs(a - b) for a, b in codes]
    assert len(codes) > 1500
    assert max(differences) <= 1
    assert differences.count(0) >= 0.99 * len(codes)


@pytest.mark.parametrize("scenario", ["lvshun_tieshan", "yizhuang_12"])
@pytest.mark.parametrize("name", LAWS)
def test_closed_loop_stops_near_the_mark(name: str, scenario: str) -> None:
    found = next(full for full in shipped() if full.startswith(scenario))
    score = direct_run(load(found), RunSpec(law=LawSpec(name, "iq"))).score
    assert score.extras["overspeed_mps"] == 0
    assert score.signed["stop_error_m"] is not None
    # TPFC1 comes to rest before the mark, TPFC2 behind it.
    low, high = (-1.3, -0.3) if name == "tpfc1" else (0.3, 0.9)
    assert low < score.signed["stop_error_m"] < high
    assert abs(score.signed["time_error_s"]) < 0.15
    assert 300 < score.values["itae"] < 2500
    assert not [text for text in score.failures if "stop error" not in text]


def given(name: str, **parameters: float) -> ParameterSet:
    return ParameterSet(name, parameters, Path("tuned.toml"))


@pytest.mark.slow
def test_softening_from_a_file_reaches_the_reference_trajectory() -> None:
    own, soft = (
        direct_run(SCENARIO, RunSpec(law=LawSpec("tpfc2", "float64", parameters=p))).score
        for p in (None, given("tpfc2", softening=0.85))
    )
    assert soft.values["itae"] > 1.3 * own.values["itae"]


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
