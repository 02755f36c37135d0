"""Target speed curve: exact values, continuity, the virtual continuation after the stop."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.scenarios.load import load
from railhil.scenarios.model import TargetCurve
from railhil.scenarios.target import Target

TRIANGLE = TargetCurve(((0.0, 0.0), (10.0, 1.0), (20.0, -1.0), (30.0, -1.0)))


@pytest.fixture(scope="module")
def lvshun() -> Target:
    return Target(load("lvshun_tieshan").target)


def test_lvshun_stops_at_2940_m_after_195_s(lvshun: Target) -> None:
    assert lvshun.stop_time_s == pytest.approx(195.0, abs=1e-9)
    assert lvshun.stop_position_m == pytest.approx(2940.0, abs=1e-6)
    assert lvshun.speed_mps(195.0) == pytest.approx(0.0, abs=1e-12)


def test_lvshun_first_seconds_are_the_cubic_launch(lvshun: Target) -> None:
    """a = 0.16 t, so v = 0.08 t^2 and x = 0.08 t^3 / 3 (single-step vectors: 0.072 km/h at 0.5 s)."""
    assert lvshun.speed_mps(0.5) * 3.6 == pytest.approx(0.072, abs=1e-12)
    assert lvshun.speed_mps(4.5) * 3.6 == pytest.approx(5.832, abs=1e-12)
    assert lvshun.position_m(3.0) == pytest.approx(0.72, abs=1e-12)


def test_after_the_stop_the_last_deceleration_continues(lvshun: Target) -> None:
    assert lvshun.speed_mps(200.0) == pytest.approx(-0.35 * 5, abs=1e-9)
    assert lvshun.accel_mps2(1000.0) == -0.35


def test_before_departure_everything_is_zero(lvshun: Target) -> None:
    for value in (lvshun.accel_mps2, lvshun.speed_mps, lvshun.position_m):
        assert value(-1.0) == 0.0


def test_arrays_give_the_same_as_scalars_in_the_same_shape(lvshun: Target) -> None:
    times = np.linspace(-5.0, 210.0, 216).reshape(8, 27)
    for value in (lvshun.accel_mps2, lvshun.speed_mps, lvshun.position_m):
        assert np.array_equal(value(times), [[value(float(t)) for t in row] for row in times])


def test_position_is_the_integral_of_the_speed(lvshun: Target) -> None:
    times = np.arange(0.0, 195.0005, 0.001)
    speed = lvshun.speed_mps(times)
    integral = float(np.sum((speed[1:] + speed[:-1]) / 2) * 0.001)
    assert lvshun.position_m(195.0) == pytest.approx(integral, abs=1e-4)


def test_time_at_a_position_inverts_the_position(lvshun: Target) -> None:
    times = np.linspace(1.0, 194.0, 50)
    assert lvshun.time_s(lvshun.position_m(times)) == pytest.approx(times, abs=1e-7)
    assert lvshun.time_s(1e6) == pytest.approx(195.0, abs=1e-6)


def test_a_whole_run_inside_one_piece_is_found() -> None:
    """v = t - t^2 / 10: up to 2.5 m/s at 5 s, and down to rest exactly at the next node."""
    target = Target(TargetCurve(((0.0, 1.0), (10.0, -1.0))))
    assert target.stop_time_s == pytest.approx(10.0, abs=1e-9)
    assert target.stop_position_m == pytest.approx(100 / 6, abs=1e-9)


def test_stop_inside_a_piece_is_found() -> None:
    """v = t^2/20 to 5 m/s at 10 s; then 5 + s - s^2/10, zero at s = 5 + sqrt(75) > 10; then 5 - s from 20 s."""
    target = Target(TRIANGLE)
    assert target.stop_time_s == pytest.approx(25.0, abs=1e-12)
    assert target.speed_mps(24.9) > 0 > target.speed_mps(25.1)


@given(
    st.lists(st.tuples(st.floats(0.01, 30.0), st.floats(-2.0, 2.0)), min_size=1, max_size=12),
    st.floats(-2.0, 2.0),
)
def test_speed_and_position_are_continuous_at_every_node(steps: list[tuple[float, float]], first: float) -> None:
    times = np.concatenate(([0.0], np.cumsum([step for step, _ in steps])))
    accel = [first, *(value for _, value in steps)]
    end = float(times[-1])
    nodes = [*zip(times.tolist(), accel, strict=True), (end + 1.0, 50.0), (end + 900.0, -50.0)]
    target = Target(TargetCurve(tuple(nodes)))
    assert target.speed_mps(target.stop_time_s) == pytest.approx(0.0, abs=1e-6)
    for t, a in nodes:
        assert target.accel_mps2(t) == pytest.approx(a, abs=1e-9)
        assert target.speed_mps(t - 1e-7) == pytest.approx(target.speed_mps(t), abs=1e-5)
        assert target.position_m(t - 1e-9) == pytest.approx(target.position_m(t), abs=1e-3)


@pytest.mark.parametrize(
    ("nodes", "words"),
    [
        ((), "nodes"),
        (((1.0, 0.0), (2.0, -1.0)), "start at 0"),
        (((0.0, 1.0), (2.0, 1.0), (2.0, -1.0)), "increase"),
        (((0.0, 1.0), (2.0, 1.0)), "never comes to a stop"),
        (((0.0, -1.0), (2.0, -1.0)), "never comes to a stop"),
    ],
)
def test_what_is_no_curve_is_refused(nodes: tuple[tuple[float, float], ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Target(TargetCurve(nodes))
