"""Braking curves: equal to values of independent programs, monotone, in order, inverted exactly, refused on a grade."""

from __future__ import annotations

from itertools import pairwise
from math import inf, sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hil_tests.support.braking_cases import make_case, read_cases
from railhil.scenarios.profiles import Profile
from railhil.systems.line.braking.brake import BrakeModel, constant
from railhil.systems.line.braking.curve import GradeNotHeldError, braking_curve
from railhil.systems.line.braking.limits import SPEED_ALLOWANCE, Braking, interpolate, release_mps

CASES = {case["case"]["name"]: case for case in read_cases()}
LEVEL: Profile = ((0.0, 0.0),)
FASTEST_MPS = 30.0


def metro(**changed: Any) -> BrakeModel:
    values: dict[str, Any] = {
        "emergency_mps2": constant(1.2),
        "service_mps2": constant(0.9),
        "k_dry": constant(0.85),
        "k_wet": constant(0.9),
        "m_avadh": 0.0,
        "a_max_reduced_mps2": inf,
        "t_be_s": 1.2,
        "t_bs1_s": 0.8,
        "t_bs2_s": 0.8,
        "t_cut_s": 0.7,
        "t_warning_s": 0.5,
        "t_driver_s": 1.0,
        "t_ind_min_s": 3.0,
        "rotating_percent": 6.0,
    }
    return BrakeModel(**values | changed)


@pytest.fixture(params=CASES)
def golden(request: pytest.FixtureRequest) -> dict[str, Any]:
    found: dict[str, Any] = CASES[request.param]
    return found


def test_positions_are_those_of_independent_programs(golden: dict[str, Any]) -> None:
    """The file has ten decimals of a metre, so an exact method differs by half of the last one."""
    case = make_case(golden["case"])
    target_mps = golden["case"]["target_speed"]
    for speed_mps, *positions_m in golden["rows"]:
        exact_mps = target_mps if abs(speed_mps - target_mps) < 1e-9 else speed_mps
        found = case.positions_m(exact_mps, golden["case"]["a_est"])
        assert found == pytest.approx(positions_m, abs=1e-9, rel=0)


def test_speeds_at_a_position_are_those_of_independent_programs(golden: dict[str, Any]) -> None:
    case = make_case(golden["case"])
    for position_m, *speeds_mps in golden["at_position"]["rows"]:
        for found, wanted in zip(case.speeds_mps(position_m, golden["case"]["a_est"]), speeds_mps, strict=True):
            # None: outside the table of the program.
            assert wanted is None or found == pytest.approx(wanted, abs=1e-8)


def test_release_speed_and_ceiling_are_those_of_independent_programs(golden: dict[str, Any]) -> None:
    case = make_case(golden["case"])
    if golden["release_mps"] is None:
        assert case.release_mps is None
    else:
        assert case.release_mps == pytest.approx(golden["release_mps"], abs=1e-9)
    assert case.ceiling_mps == pytest.approx(list(golden["ceiling_limits_mps"].values()), abs=1e-12)


def test_steps_of_the_deceleration_are_those_of_independent_programs(golden: dict[str, Any]) -> None:
    case = make_case(golden["case"])
    assert np.array(case.brake.safe_steps()) == pytest.approx(np.array(golden["a_safe_speed_steps"]))
    wanted = golden["a_gradient_steps"]
    assert [row[1] for row in case.gradients] == pytest.approx([row[1] for row in wanted], abs=1e-15)
    assert [row[0] for row in case.gradients][1:] == [row[0] for row in wanted][1:]


def test_times_are_those_of_independent_programs(golden: dict[str, Any]) -> None:
    brake, times = make_case(golden["case"]).brake, golden["times"]
    assert (brake.t_traction_s, brake.t_berem_s) == pytest.approx((times["t_traction"], times["t_berem"]))
    assert brake.t_indication_s(brake.t_bs1_s) == pytest.approx(times["t_indication"])


def test_times_between_the_limits() -> None:
    """The traction's rest counts for the emergency brake, and 0.8 T_bs for the indication where it is more than 5 s."""
    slow = metro(t_be_s=1.2, t_cut_s=2.0, t_bs1_s=10.0, t_ind_min_s=5.0)
    assert slow.t_traction_s == pytest.approx(2.0 - 0.5 - 0.8)
    assert slow.t_berem_s == pytest.approx(0.5)
    assert slow.t_indication_s(slow.t_bs1_s) == pytest.approx(8.0 + 1.0)
    assert metro(t_be_s=1.0, t_cut_s=9.0).t_berem_s == 0.0
    assert metro(t_be_s=1.0, t_cut_s=9.0, cut_at_warning=False).t_traction_s == 9.0
    assert metro().cut_at_warning


def test_a_closed_form_holds_on_the_level() -> None:
    curve = braking_curve(1000.0, 0.0, constant(0.9), LEVEL, FASTEST_MPS)
    assert curve.position_m(20.0) == pytest.approx(1000.0 - 400.0 / 1.8, abs=1e-12)
    assert curve.speed_mps(1000.0 - 400.0 / 1.8) == pytest.approx(20.0, abs=1e-12)
    assert curve.speed_mps(1000.1) == 0.0


def test_a_value_is_valid_from_its_speed_and_from_its_position_on() -> None:
    """The foot lies on a step of both: to the rear the curve has the upper speed's value and the rear's grade."""
    curve = braking_curve(500.0, 10.0, ((0.0, 1.0), (10.0, 0.8)), ((0.0, 0.1), (500.0, 0.2)), FASTEST_MPS)
    assert curve.position_m(12.0) == pytest.approx(500.0 - 44.0 / (2 * 0.9), abs=1e-12)
    assert curve.position_m(8.0) == pytest.approx(500.0 + 36.0 / (2 * 1.2), abs=1e-12)


def test_steps_of_speed_and_position_that_coincide_are_both_taken() -> None:
    """From 0 at 0 m the curve reaches 10 m/s exactly at -50 m."""
    curve = braking_curve(0.0, 0.0, ((0.0, 1.0), (10.0, 0.5)), ((-100.0, 0.25), (-50.0, 0.0)), FASTEST_MPS)
    assert curve.squares == (0.0, 100.0, 100.0 + 1.5 * 50.0)[: len(curve.squares)]
    assert curve.position_m(sqrt(175.0)) == pytest.approx(-100.0, abs=1e-12)
    assert len(curve.squares) == 2


def test_uphill_brakes_and_downhill_drives() -> None:
    """The sign of a grade: 10 permil uphill help by 9.81 * 0.01 / 1.06."""
    brake = metro()
    for permil, sign in ((10.0, 1.0), (-10.0, -1.0)):
        gradients = brake.gradient_steps(((0.0, permil),), 100.0)
        curve = Braking(brake, gradients, FASTEST_MPS).emergency_limits(1000.0, 0.0, 0.0).curve
        rate_mps2 = 0.918 + sign * 9.81 * 0.01 / 1.06
        assert curve.position_m(10.0) == pytest.approx(1000.0 - 50.0 / rate_mps2, abs=1e-9)


def test_the_lowest_grade_under_the_train_counts_and_not_the_mean() -> None:
    steps = metro(gravity_mps2=10.0, rotating_percent=0.0).gradient_steps(
        ((0.0, 10.0), (500.0, -20.0), (600.0, 30.0)), 100.0
    )
    # The rear leaves the descent one train length behind its end; the descent counts from its first metre on.
    assert steps == ((0.0, 0.1), (500.0, -0.2), (700.0, 0.3))


def test_unknown_rotating_masses_are_15_percent_uphill_and_2_percent_downhill() -> None:
    steps = metro(rotating_percent=None).gradient_steps(((0.0, 10.0), (500.0, -20.0)), 0.0)
    assert [value for _, value in steps] == pytest.approx([0.0981 / 1.15, -0.1962 / 1.02])
    ((_, slight),) = metro(rotating_percent=None).gradient_steps(((0.0, 0.4),), 0.0)
    assert slight == pytest.approx(0.003924 / 1.15)


def test_dead_times_lengthen_the_way_to_the_ebd() -> None:
    """T_be acts in full where traction is cut off before: 1.2 s at V_bec."""
    limits = Braking(metro(), LEVEL, FASTEST_MPS).emergency_limits(1000.0, 0.0, 0.0)
    start_mps = 20.0 + interpolate(SPEED_ALLOWANCE, 20.0)
    assert limits.place_m(20.0, 0.0) == pytest.approx(limits.curve.position_m(start_mps) - 1.2 * start_mps, abs=1e-9)


def test_adhesion_limits_the_emergency_brake() -> None:
    assert metro(a_max_reduced_mps2=0.7).safe_steps() == ((0.0, 0.7),)
    # Without any allowance for wet rails.
    ((_, rate_mps2),) = metro(m_avadh=1.0).safe_steps()
    assert rate_mps2 == pytest.approx(1.2 * 0.85)


def test_a_grade_that_the_brake_does_not_hold_is_refused_with_its_place() -> None:
    """110.85 permil down: 0.918 - 1.004 m/s2."""
    brake = metro(rotating_percent=2.0)
    steep = brake.gradient_steps(((0.0, 0.0), (900.0, -1.004 / 9.81 * 1020)), 100.0)
    with pytest.raises(GradeNotHeldError, match=r"-0\.086 m/s2 at 1010 m, 0 km/h"):
        Braking(brake, steep, FASTEST_MPS).emergency_limits(1010.0, 0.0, 0.0)


def test_a_grade_far_behind_the_fastest_speed_is_not_refused() -> None:
    steep = ((0.0, -1.0), (500.0, 0.0))
    assert braking_curve(1000.0, 0.0, constant(0.9), steep, 20.0).position_m(20.0) > 500.0
    with pytest.raises(GradeNotHeldError, match="at 500 m"):
        braking_curve(1000.0, 0.0, constant(0.9), steep, 30.1)
    # Exactly at the bound is not above it.
    with pytest.raises(GradeNotHeldError):
        braking_curve(1000.0, 0.0, constant(0.05), LEVEL, 20.0)


def test_a_speed_is_found_where_the_parabola_of_the_first_piece_has_no_root() -> None:
    limits = Braking(metro(), ((0.0, 0.0), (200.0, 0.0085), (511.0, 0.0)), FASTEST_MPS).service_limits(1010.0)
    assert limits.speed_mps(1010.0 - 1.0 / 1.8, 0.0, FASTEST_MPS) == pytest.approx(1.0, abs=1e-9)


def test_no_release_speed_where_the_overlap_is_too_short() -> None:
    limits = Braking(metro(), LEVEL, FASTEST_MPS).emergency_limits(1001.0, 0.0, 0.0)
    assert release_mps(limits, 1000.0, 2.0, 1.4) == 0.0


SPEEDS = st.floats(0.0, 28.0)
PERMIL = st.floats(-40.0, 40.0)


@st.composite
def brakings(draw: st.DrawFn) -> Braking:
    edges = sorted(draw(st.lists(st.floats(200.0, 1200.0), max_size=6, unique=True)))
    grade = ((0.0, draw(PERMIL)), *((edge, draw(PERMIL)) for edge in edges))
    speeds = sorted(draw(st.lists(st.floats(1.0, 28.0), max_size=3, unique=True)))
    emergency = ((0.0, 1.2), *((speed, draw(st.floats(0.9, 1.3))) for speed in speeds))
    brake = metro(
        emergency_mps2=emergency,
        t_cut_s=draw(st.floats(0.0, 4.0)),
        cut_at_warning=draw(st.booleans()),
        rotating_percent=draw(st.one_of(st.none(), st.floats(0.0, 20.0))),
    )
    return Braking(brake, brake.gradient_steps(grade, draw(st.floats(0.0, 200.0))), FASTEST_MPS)


@given(brakings(), st.lists(SPEEDS, min_size=2, max_size=8, unique=True), st.floats(-1.0, 1.0))
def test_every_limit_comes_earlier_the_faster_and_in_its_order(
    braking: Braking, speeds_mps: list[float], accel_mps2: float
) -> None:
    limits = braking.emergency_limits(1030.0, 0.0, 0.0)
    times = limits.times
    leads = (0.0, times.service_s, times.warning_s, times.permitted_s, times.indication_s)
    before: list[float] | None = None
    for speed_mps in sorted(speeds_mps):
        row = [limits.curve.position_m(speed_mps), *(limits.place_m(speed_mps, lead, accel_mps2) for lead in leads)]
        assert row == sorted(row, reverse=True)
        if speed_mps > 0.0:
            assert row[0] > row[1]
        if before is not None:
            assert all(now <= then + 1e-9 for now, then in zip(row, before, strict=True))
        before = row


@given(brakings(), SPEEDS, st.sampled_from([0.0, 0.8, 1.3, 1.8, 5.8]), st.floats(-1.0, 1.0))
def test_the_speed_at_the_position_of_a_limit_is_the_limits_speed(
    braking: Braking, speed_mps: float, lead_s: float, accel_mps2: float
) -> None:
    for limits in (braking.emergency_limits(1030.0, 0.0, 0.0), braking.service_limits(1010.0)):
        at_m = limits.place_m(speed_mps, lead_s, accel_mps2)
        found_mps = limits.speed_mps(at_m, lead_s, FASTEST_MPS, accel_mps2)
        # A curve is flat at standstill: there the place of a speed of 1e-5 m/s is that of 0, to 1e-10 m.
        assert found_mps == pytest.approx(speed_mps, abs=1e-6 if speed_mps > 0.01 else 2e-5)


@given(brakings(), SPEEDS)
def test_speed_and_position_of_a_curve_are_inverse(braking: Braking, speed_mps: float) -> None:
    assume(speed_mps > 1e-3)
    curve = braking.service_limits(1010.0).curve
    assert curve.speed_mps(curve.position_m(speed_mps)) == pytest.approx(speed_mps, abs=1e-7)


@given(brakings(), st.floats(1.0, 25.0), st.floats(0.5, 3.0))
def test_a_lower_limit_is_never_supervised_below_its_speed(braking: Braking, target_mps: float, above: float) -> None:
    limits = braking.emergency_limits(1000.0, target_mps + above, target_mps)
    assert limits.speed_mps(5000.0, 0.0, FASTEST_MPS) == target_mps
    assert limits.curve.position_m(target_mps + above) == pytest.approx(1000.0, abs=1e-9)
    places = [limits.place_m(target_mps + share, 0.0) for share in (0.0, 0.5, 1.0, 2.0)]
    assert all(after < before for before, after in pairwise(places))
