"""Filters of the speed: against PyWavelets' own results, against a transform written here, and their figures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.stop.filters import (
    FILTERS,
    PATH,
    SAMPLE_S,
    SAMPLES,
    document,
    speed_filter,
    steady_gains,
    taps,
)
from railhil.controller_node.stop.numbers import ACCEL_Q, SPEED_Q, Numbers

GOLDEN = json.loads((Path(__file__).parents[3] / "data/stopping/packet_golden.json").read_text())
LOW = np.array(document()["low_pass"])


def ran(name: str, speeds: Any, arithmetic: str = "float64", accels: Any = None, noise_mps: float = 0.05) -> Any:
    """Estimates after each cycle of five samples."""
    ar = make(arithmetic)
    filtered = speed_filter(Numbers(ar), name, noise_mps)
    quantity = [ar.from_raw(round(v * 2**SPEED_Q), SPEED_Q) for v in speeds]
    state = filtered.start(quantity[0])
    found = []
    for cycle in range(len(speeds) // SAMPLES):
        accel = ar.from_raw(round((0.0 if accels is None else accels[cycle]) * 2**ACCEL_Q), ACCEL_Q)
        state, estimate = filtered.step(state, quantity[cycle * SAMPLES : (cycle + 1) * SAMPLES], accel)
        found.append(ar.raw(estimate, SPEED_Q) / 2**SPEED_Q)
    return np.array(found)


def approximated(window: Any, mode: str) -> Any:
    """Approximation of three levels of the db8 transform, written out with convolutions."""
    low = LOW
    lengths, part = [], np.asarray(window, dtype=float)
    for _ in range(3):
        lengths.append(len(part))
        width = len(low) - 1
        if mode == "symmetric":
            wide = np.pad(part, width, mode="symmetric")
        else:
            wide = np.pad(part, width, mode="reflect", reflect_type="odd")
        part = np.convolve(wide, low, mode="valid")[1::2]
    for length in reversed(lengths):
        up = np.zeros(2 * len(part) - 1)
        up[::2] = part
        part = np.convolve(up, low[::-1])[len(low) - 2 :][:length]
    return part


@pytest.mark.parametrize("case", GOLDEN, ids=lambda case: f"{case['name']}-{case['mode']}")
def test_the_taps_are_the_wavelet_packet_of_pywavelets(case):
    for lag, expected in case["packet_mps"].items():
        found = np.dot(taps(f"packet_{case['mode']}_{lag}"), case["window_mps"])
        assert found == pytest.approx(expected, abs=1e-9)
        assert expected == pytest.approx(case["approximation_mps"][lag], abs=1e-12)


@pytest.mark.parametrize("mode", ["symmetric", "antireflect"])
def test_the_taps_are_the_approximation_of_a_transform_written_here(mode):
    rows = np.array([approximated(row, mode) for row in np.eye(128)]).T
    for lag in (0, 8, 63):
        assert np.abs(rows[127 - lag] - taps(f"packet_{mode}_{lag}")).max() < 1e-12


@pytest.mark.parametrize(
    ("name", "gain"),
    [
        ("packet_symmetric_0", 0.567),
        ("packet_antireflect_0", 1.19),
        ("packet_symmetric_8", 0.389),
        ("packet_symmetric_63", 0.352),
        ("fir65_10hz", 0.227),
    ],
)
def test_noise_gains(name, gain):
    assert np.sqrt(np.square(taps(name)).sum()) == pytest.approx(gain, abs=2.5e-3)


def test_the_packet_leaves_an_eighth_of_the_noise_power():
    assert np.square(taps("packet_symmetric_63")).sum() == pytest.approx(0.125, abs=0.005)
    noise = 16.0 + 0.05 * np.random.default_rng(3).standard_normal(5 * 4000)
    assert ran("packet", noise)[30:].var() / 0.05**2 == pytest.approx(0.125, abs=0.01)


@pytest.mark.parametrize(
    ("name", "bias_mps"),
    [("packet_symmetric_0", 0.0017), ("packet_antireflect_0", 0.0), ("packet_symmetric_63", 0.161)],
)
def test_bias_on_a_ramp(name, bias_mps):
    ramp = -0.8 * SAMPLE_S * np.arange(128)
    assert np.dot(taps(name), ramp) - ramp[-1] == pytest.approx(bias_mps, abs=3e-4)


@pytest.mark.parametrize(
    ("frequency_hz", "gain", "within"), [(1.0, 1.0, 0.001), (15.0, 0.97, 0.03), (30.0, 0.01, 0.03)]
)
def test_pass_band_of_the_packet(frequency_hz, gain, within):
    wave = np.exp(2j * np.pi * frequency_hz * SAMPLE_S * np.arange(128))
    assert abs(np.dot(taps("packet_symmetric_63"), wave)) == pytest.approx(gain, abs=within)


@pytest.mark.parametrize(
    ("name", "cruise_mmps", "braking_mmps"),
    [
        ("none", 50, 50),
        ("packet", 17.6, 159),
        ("mean16", 12.5, 22.8),
        ("iir", 6.0, 88.8),
        ("kalman", 9.3, 9.5),
        ("kalman_command", 4.8, 4.9),
    ],
)
def test_errors_at_50_mm_per_s(name, cruise_mmps, braking_mmps):
    count = 5 * 2500
    time_s = SAMPLE_S * np.arange(count)
    noise = 0.05 * np.random.default_rng(5).standard_normal(count)
    cruise = np.full(count, 20.0)
    braking = 40.0 - 0.8 * time_s
    for clean, accel, expected in ((cruise, 0.0, cruise_mmps), (braking, -0.8, braking_mmps)):
        error = ran(name, clean + noise, accels=np.full(count // 5, accel)) - clean[4::5]
        assert 1e3 * np.sqrt(np.square(error[1000:]).mean()) == pytest.approx(expected, rel=0.12)


def test_the_low_pass_is_the_textbook_filter():
    # Every process that collects the tests would load it.
    from scipy.signal import lfilter

    speeds = 10.0 + np.random.default_rng(6).standard_normal(500)
    b, a = taps("butterworth2_2hz_b"), taps("butterworth2_2hz_a")
    rest = speeds[0] * np.array([1.0 - b[0], b[2] - a[2]])
    expected, _ = lfilter(b, a, speeds, zi=rest)
    assert ran("iir", speeds) == pytest.approx(expected[4::5], abs=1e-6)


def test_steady_gains_settle_and_refuse_nothing_as_noise():
    step, walked = np.array([[1.0, 0.016], [0.0, 1.0]]), np.diag([0.0, 0.02**2 * 0.016])
    covariance = solve_discrete_are(step.T, np.array([[1.0], [0.0]]), walked, np.array([[0.01**2]]))
    expected = covariance[:, 0] / (covariance[0, 0] + 0.01**2)
    assert steady_gains(0.016, 0.01, 0.02) == pytest.approx(expected, rel=1e-9)
    with pytest.raises(ValueError, match="must be positive"):
        steady_gains(0.016, 0.0, 0.02)


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("arithmetic", ["float32", "iq"])
def test_other_arithmetics_stay_close(name, arithmetic):
    time_s = SAMPLE_S * np.arange(600)
    speeds = np.round(16.0 - 0.8 * time_s + 0.01 * np.random.default_rng(8).standard_normal(600), 3)
    difference = ran(name, speeds, arithmetic) - ran(name, speeds)
    assert np.abs(difference).max() < 1e-3


def test_changed_taps_are_refused(tmp_path):
    text = PATH.read_text(encoding="utf-8")
    other = tmp_path / "taps.json"
    other.write_text(text.replace("e-05,", "e-04,", 1), encoding="utf-8")
    with pytest.raises(InputError, match="taps_sha256"):
        document(other)
