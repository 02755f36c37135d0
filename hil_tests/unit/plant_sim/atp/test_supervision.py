"""One look of the protection: the speeds that it shows are those at which it reacts, targets come and go."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.plant_sim.atp.position import PositionInterval
from railhil.plant_sim.atp.readings import CEILING, TARGET
from railhil.plant_sim.atp.supervision import (
    ABOVE_EMERGENCY,
    ABOVE_PERMITTED,
    ABOVE_SERVICE,
    ABOVE_WARNING,
    NOTHING,
    Supervision,
)
from railhil.systems.line.braking.limits import Braking
from railhil.systems.line.braking.track import TrackLimits
from railhil.systems.line.scenario.protection import Protection

SETTINGS = Protection()
EOA_M, SVL_M = 1010.0, 1030.0
LIMITS = ((0.0, 80 / 3.6), (300.0, 60 / 3.6), (450.0, 75 / 3.6))


def supervision(limits: tuple[tuple[float, float], ...] = LIMITS, svl_m: float = SVL_M) -> Supervision:
    brake = SETTINGS.brake_model(9.81)
    grade = ((0.0, 3.0), (500.0, -8.0), (800.0, 5.0))
    braking = Braking(brake, brake.gradient_steps(grade, 118.0), 30.0)
    track = TrackLimits(braking, SETTINGS.increments_mps, limits, 118.0, 80 / 3.6)
    found = Supervision(track)
    found.authorise(track.end_target(EOA_M, svl_m, SETTINGS.d_trip_m, SETTINGS.v_release_mps), TARGET)
    return found


def place_at(position_m: float, half_m: float = 3.0) -> PositionInterval:
    place = PositionInterval(0.02, 0.02, half_m)
    place.refer(position_m, 0.0, half_m)
    return place


@given(st.floats(0.0, 1015.0), st.floats(0.5, 15.0), st.floats(-1.0, 1.0), st.floats(1010.0, 1060.0))
def test_a_speed_exceeds_a_limit_exactly_above_the_speed_that_is_shown(
    at_m: float, half_m: float, accel_mps2: float, svl_m: float
) -> None:
    place, seen = place_at(at_m, half_m), supervision(svl_m=svl_m)
    seen.look(place, 0.0, accel_mps2)
    levels = seen.levels
    speeds = (levels.permitted_mps, levels.warning_mps, levels.service_mps, levels.emergency_mps)
    assert list(speeds) == sorted(speeds)
    if seen.is_released:
        assert len(set(speeds)) == 1
        seen.look(place, speeds[0] + 1e-6, accel_mps2)
        assert seen.excess == ABOVE_EMERGENCY
        return
    for speed_mps, excess in zip(speeds, (ABOVE_PERMITTED, ABOVE_WARNING, ABOVE_SERVICE, ABOVE_EMERGENCY), strict=True):
        seen.look(place, speed_mps + 1e-6, accel_mps2)
        assert seen.excess >= excess
        seen.look(place, max(speed_mps - 1e-6, 0.0), accel_mps2)
        assert seen.excess < excess


@given(st.floats(0.0, 990.0), st.floats(0.5, 10.0), st.floats(0.01, 5.0))
def test_a_wider_interval_never_permits_more(at_m: float, half_m: float, wider_m: float) -> None:
    narrow, wide = supervision(), supervision()
    narrow.look(place_at(at_m, half_m), 10.0, 0.0)
    wide.look(place_at(at_m, half_m + wider_m), 10.0, 0.0)
    assert wide.levels.permitted_mps <= narrow.levels.permitted_mps + 1e-9
    assert wide.levels.emergency_mps <= narrow.levels.emergency_mps + 1e-9


def test_the_lowest_ceiling_within_the_interval_counts() -> None:
    seen = supervision()
    # The lower limit begins at 300 m and ends when the rear has left it, at 568 m.
    for at_m, half_m, ceiling_kmh in (
        (299.0, 0.5, 80),
        (299.0, 2.0, 60),
        (567.0, 0.5, 60),
        (569.0, 2.0, 60),
        (569.0, 0.5, 75),
    ):
        seen.look(place_at(at_m, half_m), 30.0, 0.0)
        assert seen.cause == CEILING
        assert round(seen.levels.permitted_mps * 3.6, 6) <= ceiling_kmh
        assert round(seen.levels.emergency_mps * 3.6, 6) <= ceiling_kmh + 5


def test_a_lower_limit_stays_a_target_until_the_front_has_passed_it_for_certain() -> None:
    seen = supervision()
    seen.look(place_at(200.0), 22.0, 0.0)
    (target,) = seen.indicated
    assert target.place_m == 300.0
    assert seen.lowest_target is target
    seen.look(place_at(302.0), 16.0, 0.0)
    assert seen.indicated == [target]
    seen.look(place_at(304.0), 16.0, 0.0)
    assert seen.indicated == []
    # An interval that jumps back finds the ceiling alone.
    seen.look(place_at(290.0), 16.0, 0.0)
    assert seen.indicated == []


def test_of_two_targets_the_first_to_be_reached_counts() -> None:
    both = supervision(((0.0, 80 / 3.6), (990.0, 60 / 3.6)))
    both.look(place_at(780.0), 15.0, 0.0)
    assert both.lowest_target is not None
    assert both.lowest_target.place_m == EOA_M
    far = supervision(((0.0, 80 / 3.6), (760.0, 30 / 3.6)))
    far.look(place_at(620.0), 15.0, 0.0)
    assert far.lowest_target is not None
    assert far.lowest_target.place_m == 760.0


def test_exactly_at_a_limit_nothing_is_exceeded() -> None:
    seen = supervision()
    seen.look(place_at(50.0), 80 / 3.6, 0.0)
    assert seen.excess == NOTHING


def test_a_far_supervised_location_leaves_the_end_of_authority_to_the_service_brake() -> None:
    seen = supervision(svl_m=1500.0)
    seen.look(place_at(800.0), 10.0, 0.0)
    assert seen.levels.permitted_mps < 18.0
    assert seen.levels.emergency_mps == pytest.approx(80 / 3.6)
