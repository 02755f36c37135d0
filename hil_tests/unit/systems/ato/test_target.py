"""Target speed curve: exact values, continuity, the virtual continuation after the stop."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import TargetCurve
from railhil.systems.ato.scenario.target import Target, target_of, time_in_piece_s

TRIANGLE = TargetCurve(((0.0, 0.0), (10.0, 1.0), (20.0, -1.0), (30.0, -1.0)))


@pytest.fixture(scope="module")
def lvshun() -> Target:
    return Target(load("lvshun_tieshan").target)


def test_lvshun_stops_at_2940_m_after_195_s(lvshun: Target) -> None:
    assert lvshun.stop_time_s == pytest.approx(195.0, abs=1e-9)
    assert lvshun.stop_position_m == pytest.approx(2940.0, abs=1e-6)
    assert lvshun.speed_mps(195.0) == pytest.approx(0.0, abs=1e-12)


def test_a_curve_is_evaluated_once() -> None:
    found = target_of(TRIANGLE)
    assert found.stop_time_s == Target(TRIANGLE).stop_time_s
    assert target_of(TargetCurve(TRIANGLE.nodes)) is found


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
        (((0.0, 1.0),), "never comes to a stop"),
        (((0.0, -1.0),), "never comes to a stop"),
    ],
)
def test_what_is_no_curve_is_refused(nodes: tuple[tuple[float, float], ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Target(TargetCurve(nodes))


def way_m(time_s: float, piece: tuple[float, float, float]) -> float:
    """Way in a piece: of speed, acceleration and jerk."""
    speed, accel, jerk = piece
    return time_s * speed + time_s**2 * accel / 2 + time_s**3 * jerk / 6


#: From rest by jerk alone and by acceleration, at even speed, with both signs of acceleration and jerk, down to rest.
PIECES = [
    (0.0, 0.0, 0.16), (0.0, 0.7, 0.0), (0.0, 0.9, -0.1), (12.5, 0.0, 0.0), (12.5, 0.4, 0.1), (12.5, 0.4, -0.2),
    (12.5, -0.4, 0.1), (12.5, -0.4, -0.2), (5.0, -1.0, 0.0), (0.01, 0.0, 0.5), (0.2, 0.5, -0.14),
]  # fmt: skip


@pytest.mark.parametrize("piece", PIECES)
def test_the_time_to_each_way_in_a_piece(piece: tuple[float, float, float]) -> None:
    """Alone the same as in an array; less exact only where it is about to stand."""
    longest_s = 5.0
    times = np.linspace(0.0, longest_s, 41)
    ways = np.array([way_m(float(time_s), piece) for time_s in times])
    columns = (np.full(41, value) for value in (longest_s, *piece))
    found = time_in_piece_s(ways, *columns)
    assert found.tolist() == [float(time_in_piece_s(float(way), longest_s, *piece)) for way in ways]
    assert found[4:] == pytest.approx(times[4:], abs=1e-7 if piece[0] == 5.0 else 1e-11)
    assert (found >= 0.0).all()
    assert (found <= longest_s).all()
    assert [way_m(float(time_s), piece) for time_s in found] == pytest.approx(ways, abs=1e-12)


def test_ways_beyond_a_piece_take_as_long_as_it_lasts() -> None:
    for piece in PIECES:
        assert time_in_piece_s(way_m(5.0, piece) + 1.0, 5.0, *piece) == pytest.approx(5.0, abs=1e-11)
        assert time_in_piece_s(0.0, 5.0, *piece) == pytest.approx(0.0, abs=1e-11 if piece[0] else 1e-4)


def test_values_inside_the_pieces_and_at_their_nodes() -> None:
    """v = t^2/20 up to 10 s, then 5 + s - s^2/10 up to 20 s, then 5 - s."""
    target = Target(TRIANGLE)
    for time_s, accel, speed, place in (
        (-1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (5.0, 0.5, 1.25, 125 / 60), (10.0, 1.0, 5.0, 1000 / 60),
        (12.0, 0.6, 6.6, 1000 / 60 + 10.0 + 2.0 - 8 / 30), (20.0, -1.0, 5.0, 1000 / 60 + 50 + 50 - 1000 / 30),
        (22.0, -1.0, 3.0, 1000 / 60 + 100 - 1000 / 30 + 8.0),
        (30.0, -1.0, -5.0, 1000 / 60 + 100 - 1000 / 30), (40.0, -1.0, -15.0, 1000 / 60 + 100 - 1000 / 30 - 100.0),
    ):  # fmt: skip
        assert target.accel_mps2(time_s) == pytest.approx(accel, abs=1e-12)
        assert target.speed_mps(time_s) == pytest.approx(speed, abs=1e-12)
        assert target.position_m(time_s) == pytest.approx(place, abs=1e-10)


def test_times_at_the_nodes_and_outside_of_the_way() -> None:
    target = Target(TRIANGLE)
    for time_s in (1.0, 9.0, 10.0, 10.5, 20.0, 24.0):
        assert float(target.time_s(target.position_m(time_s))) == pytest.approx(time_s, abs=1e-9)
    assert target.time_s([-5.0, 0.0, 1e9]) == pytest.approx([0.0, 0.0, 25.0], abs=1e-4)
    # A stop at a node, and pieces behind it that go on: the first passing counts.
    goes_on = Target(TargetCurve(((0.0, 1.0), (10.0, -1.0), (20.0, 3.0), (30.0, -9.0))))
    assert goes_on.stop_time_s == pytest.approx(10.0, abs=1e-9)
    assert goes_on.time_s([8.0, 100.0]) == pytest.approx([time_of(8.0), 10.0], abs=1e-6)


def time_of(place_m: float) -> float:
    """When v = t - t^2/10 has covered a way, by bisection."""
    low, high = 0.0, 10.0
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if middle**2 / 2 - middle**3 / 30 < place_m else (low, middle)
    return low


@pytest.mark.parametrize(
    ("nodes", "stop_s"),
    [
        # It waits before it goes; a wait is no stop.
        (((0.0, 0.0), (5.0, 0.0), (6.0, 1.0), (8.0, -1.0), (9.0, -1.0)), None),
        # Even acceleration, then even braking: 5 m/s after 5 s, 2.5 m/s less each second.
        (((0.0, 1.0), (4.999999, 1.0), (5.000001, -2.5), (9.0, -2.5)), 7.0),
        # To rest exactly at the last node, and a little before it.
        (((0.0, 1.0), (4.0, 1.0), (6.0, -1.0), (10.0, -1.0)), 10.0),
        (((0.0, 1.0), (4.0, 1.0), (6.0, -1.0), (9.0, -1.0)), 10.0),
        # Slower without rest in a piece of falling acceleration, then on.
        (((0.0, 2.0), (2.0, 0.0), (4.0, -0.5), (6.0, 0.0), (8.0, -1.0), (20.0, -1.0)), None),
    ],
)
def test_the_first_stop(nodes: tuple[tuple[float, float], ...], stop_s: float | None) -> None:
    target = Target(TargetCurve(nodes))
    # Beside a search in small steps.
    times = np.arange(0.0, 40.0, 1e-4)
    speed = target.speed_mps(times)
    moving = int(np.argmax(speed > 1e-6))
    searched_s = float(times[moving + int(np.argmax(speed[moving:] <= 1e-9))])
    assert target.stop_time_s == pytest.approx(searched_s, abs=2e-4)
    if stop_s is not None:
        assert target.stop_time_s == pytest.approx(stop_s, abs=1e-5)
    assert target.speed_mps(target.stop_time_s) == pytest.approx(0.0, abs=1e-9)


def test_stops_in_pieces_of_every_slope() -> None:
    """5 m/s at 5 s, then a piece from one deceleration to another."""
    for first, last in product((-0.4, -1.0, 0.3, 0.0), (-2.0, -4.0, -1.0)):
        nodes = (0.0, 1.0), (4.5, 1.0), (5.5, first), (9.5, last), (12.0, last)
        target = Target(TargetCurve(nodes))
        times = np.arange(5.0, 30.0, 1e-4)
        searched_s = float(times[int(np.argmax(target.speed_mps(times) <= 0.0))])
        assert target.stop_time_s == pytest.approx(searched_s, abs=2e-4)
        assert target.speed_mps(target.stop_time_s) == pytest.approx(0.0, abs=1e-9)


def test_a_speed_that_rounding_may_leave_counts_as_rest() -> None:
    """1 m/s at 2 s, then -1 m/s2 until just before 3 s."""
    for gap_s, stop_s in ((5e-10, 3.0 - 5e-10), (5e-9, 3.0)):
        target = Target(TargetCurve(((0.0, 1.0), (1.0, 1.0), (2.0, -1.0), (3.0 - gap_s, -1.0), (4.0, -1.0))))
        assert target.stop_time_s == pytest.approx(stop_s, abs=5e-11)


def test_soft_stops() -> None:
    """1 m/s at 2 s, and a deceleration that fades until 4 s: to rest there, to what counts as rest, and before."""
    for more_s, stop_s in ((0.0, 4.0), (2e-10, 4.0), (-0.05, 2.0 + 1.9 / (1 + 0.05**0.5))):
        nodes = (0.0, 1.0), (1.0 + more_s, 1.0), (2.0 + more_s, -1.0), (4.0 + more_s, 0.0), (5.0, 0.0), (6.0, -1.0)
        target = Target(TargetCurve(nodes))
        assert target.stop_time_s == pytest.approx(stop_s + more_s, abs=1e-7 if not more_s else 1e-11)
    # A train that is pushed back first has not stopped when it stands again.
    pushed = Target(TargetCurve(((0.0, -1.0), (0.1, 1.0), (2.1, 1.0), (4.1, -1.0), (9.0, -1.0))))
    assert pushed.stop_time_s == pytest.approx(6.1, abs=1e-9)
    assert Target(TargetCurve(((0.0, 1.0), (1.0, -1.0)))).stop_time_s == pytest.approx(1.0, abs=1e-9)
    # Also of a weak run inside of one piece, and behind the last node.
    assert Target(TargetCurve(((0.0, 0.4), (10.0, -0.4)))).stop_time_s == pytest.approx(10.0, abs=1e-9)
    behind = Target(TargetCurve(((0.0, 1.0), (4.0, 1.0), (6.0, -1.0))))
    assert behind.stop_time_s == 10.0
    assert behind.time_s(behind.position_m(9.0)) == pytest.approx(9.0, abs=1e-9)
