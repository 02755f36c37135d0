"""The train protection, look by look: its levels in order, what it latches, its other causes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from hil_tests.unit.plant_sim.atp.ride import FAR, LEVEL, NEAR, TRAIN, Ride, demanded
from railhil.plant_sim.atp import readings as codes
from railhil.plant_sim.atp.protection import TrainProtection
from railhil.plant_sim.atp.readings import Authority, Readings, Track
from railhil.systems.line.braking.limits import Braking
from railhil.systems.line.scenario.protection import Protection


@pytest.mark.parametrize(
    ("above_kmh", "status", "wanted"),
    [
        (-0.5, codes.NORMAL, (False, False, False)),
        (1.0, codes.OVERSPEED, (False, False, False)),
        (2.5, codes.WARNING, (True, False, False)),
        (4.0, codes.INTERVENTION, (True, True, False)),
        (5.5, codes.INTERVENTION, (True, True, True)),
    ],
)
def test_reactions_above_a_ceiling(above_kmh: float, status: int, wanted: tuple[bool, bool, bool]) -> None:
    demands = Ride().go_to(500.0, (80 + above_kmh) / 3.6)
    assert demands.status == status
    assert demanded(demands) == wanted
    assert demands.cause == (codes.CEILING if above_kmh > 0 else codes.NONE)
    assert demands.permitted_mps == pytest.approx(80 / 3.6)
    assert (demands.warning_mps, demands.sbi_mps, demands.ebi_mps) == pytest.approx((82 / 3.6, 83 / 3.6, 85 / 3.6))


def test_traction_and_service_brake_come_back_at_the_permitted_speed() -> None:
    ride = Ride()
    assert demanded(ride.go_to(500.0, 84 / 3.6)) == (True, True, False)
    # Below the warning, yet above the permitted speed: both are latched.
    assert demanded(ride.look(81 / 3.6)) == (True, True, False)
    assert demanded(ride.look(80 / 3.6)) == (False, False, False)
    assert ride.demands.status == codes.NORMAL


def test_traction_cut_at_the_warning_comes_back_at_the_permitted_speed() -> None:
    ride = Ride()
    assert demanded(ride.go_to(500.0, 82.5 / 3.6)) == (True, False, False)
    assert demanded(ride.look(81 / 3.6)) == (True, False, False)
    assert ride.demands.status == codes.WARNING
    assert demanded(ride.look(80 / 3.6)) == (False, False, False)


def test_the_emergency_brake_stays_until_the_end() -> None:
    ride = Ride()
    ride.go_to(500.0, 86 / 3.6)
    assert demanded(ride.look(50 / 3.6)) == (True, False, True)
    assert demanded(ride.look(0.0, looks=100)) == (True, False, True)
    assert ride.demands.cause == codes.CEILING
    assert ride.demands.status == codes.INTERVENTION


def first_places(authority: Authority, **settings: Any) -> dict[int, float]:
    """Odometer at the first look with each status, towards an end of authority at 72 km/h."""
    ride = Ride(authority=authority, **settings)
    ride.go_to(200.0, 20.0)
    found: dict[int, float] = {}
    while not ride.demands.emergency_brake:
        found.setdefault(ride.demands.status, ride.odometer_m)
        if ride.demands.service_brake:
            found.setdefault(5, ride.odometer_m)
        ride.look(20.0)
    found[6] = ride.odometer_m
    return found


def test_the_limits_before_an_end_of_authority_are_reached_in_order_and_at_their_places() -> None:
    places = first_places(Authority(1010.0, 1110.0))
    # From the SBD at 1010 m: 222.2 m of braking, 0.8 s; then 0.5 s, 1 s, 4 s. Looks are 2 m apart.
    service_m = 1010.0 - 400 / 1.8 - 0.8 * 20
    assert places[5] == pytest.approx(service_m + 1, abs=1.5)
    assert places[codes.WARNING] == pytest.approx(service_m - 10 + 1, abs=1.5)
    assert places[codes.OVERSPEED] == pytest.approx(service_m - 20 + 1, abs=1.5)
    assert places[codes.INDICATION] == pytest.approx(service_m - 100 + 1, abs=1.5)
    # EBI from the EBD at 1110 m, by the most advanced position: 2 % and 0.5 m.
    start_mps = 20 + (1 + 42 / 50) / 3.6
    emergency_m = 1110.0 - start_mps**2 / (2 * 0.918) - 1.2 * start_mps
    assert places[6] / 0.98 + 0.5 == pytest.approx(emergency_m + 1, abs=1.5)


def test_the_estimated_position_counts_for_the_service_brake_and_the_most_advanced_one_for_the_emergency_brake() -> (
    None
):
    authority = Authority(1010.0, 1110.0)
    exact, rough = first_places(authority), first_places(authority, balise_accuracy_m=8.0)
    assert rough[5] == pytest.approx(exact[5], abs=2.1)
    assert rough[6] == pytest.approx(exact[6] - 7.5, abs=2.1)


def test_the_cause_is_the_target_or_its_red_signal() -> None:
    for authority, cause in ((NEAR, codes.TARGET), (replace(NEAR, red_signal=True), codes.RED_SIGNAL)):
        ride = Ride(authority=authority)
        while not ride.go_to(ride.odometer_m + 5, 20.0).service_brake:
            pass
        assert ride.demands.cause == cause
        assert ride.demands.monitoring == codes.TARGET_MONITORING
        assert ride.demands.target_distance_m == pytest.approx(1010.0 - ride.odometer_m)
        assert ride.demands.target_speed_mps == 0.0


def test_a_lower_limit_is_a_target_and_its_speed_is_permitted_up_to_it_and_behind() -> None:
    track = replace(LEVEL, speed_limit_mps=((-118.0, 80 / 3.6), (1000.0, 60 / 3.6)))
    ride = Ride(track)
    ride.go_to(700.0, 59.5 / 3.6)
    seen = set()
    while ride.odometer_m < 1100.0:
        demands = ride.look(59.5 / 3.6)
        assert not demands.traction_cut
        seen.add(demands.status)
        assert demands.permitted_mps >= 60 / 3.6 - 1e-12
    assert demands.permitted_mps == pytest.approx(60 / 3.6)
    assert seen == {codes.NORMAL}


def test_too_fast_before_a_lower_limit() -> None:
    track = replace(LEVEL, speed_limit_mps=((-118.0, 80 / 3.6), (1000.0, 60 / 3.6)))
    ride = Ride(track)
    while not ride.go_to(ride.odometer_m + 3, 22.0).emergency_brake:
        pass
    assert ride.demands.cause == codes.TARGET
    assert ride.demands.target_speed_mps == pytest.approx(60 / 3.6)
    # EBD through 65 km/h at 1000 m.
    start_mps = 22.0 + (1 + (79.2 - 30) / 50) / 3.6
    emergency_m = 1000.0 - (start_mps**2 - (65 / 3.6) ** 2) / (2 * 0.918) - 1.2 * start_mps
    assert ride.odometer_m / 0.98 + 0.5 == pytest.approx(emergency_m + 1, abs=2.5)


def test_only_the_release_speed_is_supervised_directly_before_the_end_of_authority() -> None:
    ride = Ride(authority=Authority(30.0, 50.0))
    ride.go_to(28.0, 1.2)
    assert ride.demands.monitoring == codes.RELEASE_MONITORING
    assert ride.demands.permitted_mps == ride.demands.release_mps == pytest.approx(5 / 3.6)
    assert demanded(ride.demands) == (False, False, False)
    assert demanded(ride.look(1.45)) == (True, True, True)
    assert ride.demands.cause == codes.RELEASE


def test_passing_the_end_of_authority_for_certain_trips() -> None:
    ride = Ride(authority=Authority(30.0, 50.0))
    ride.go_to(30.5, 1.2)
    assert not ride.demands.emergency_brake
    # d_min = s / 1.02 - 0.5 passes 30 m at 31.11 m.
    ride.go_to(31.0, 1.2)
    assert not ride.demands.emergency_brake
    ride.go_to(31.4, 1.2)
    assert ride.demands.emergency_brake
    assert ride.demands.cause == codes.TRIP


def test_the_service_brake_is_released_at_standstill_before_the_end_of_authority() -> None:
    ride = Ride(authority=NEAR)
    while not ride.go_to(ride.odometer_m + 5, 20.0).service_brake:
        pass
    for speed_mps in (15.0, 10.0, 5.0, 1.0):
        ride.look(speed_mps)
    assert demanded(ride.look(0.0)) == (False, False, False)
    assert ride.demands.status == codes.NORMAL


def test_a_longer_authority_takes_the_target_away() -> None:
    ride = Ride(authority=NEAR)
    while ride.go_to(ride.odometer_m + 5, 20.0).status != codes.INDICATION:
        pass
    ride.authority = FAR
    ride.look(20.0)
    assert ride.demands.status == codes.NORMAL
    assert ride.demands.permitted_mps == pytest.approx(80 / 3.6)
    assert ride.demands.target_distance_m == pytest.approx(5000.0 - ride.odometer_m)


def test_a_train_without_an_authority_may_not_move() -> None:
    ride = Ride(authority=None)
    assert demanded(ride.demands) == (True, False, False)
    assert demanded(ride.look(0.3)) == (True, True, False)
    assert ride.demands.cause == codes.RED_SIGNAL


def test_a_lost_authority_stays_valid_for_a_second_and_brakes_then() -> None:
    ride = Ride()
    ride.go_to(500.0, 15.0)
    ride.authority = None
    assert demanded(ride.look(15.0, looks=10)) == (False, False, False)
    assert demanded(ride.look(15.0)) == (True, True, False)
    assert ride.demands.cause == codes.RED_SIGNAL
    ride.authority = FAR
    # Back again: the service brake still stops the train.
    assert ride.look(14.9).service_brake
    assert demanded(ride.look(0.0)) == (False, False, False)


def test_two_balises_in_a_row_at_wrong_places_stop_the_train() -> None:
    ride = Ride()
    ride.go_to(500.0, 20.0)
    ride.look(20.0, balises=((2, ride.odometer_m),))
    assert not ride.demands.service_brake
    ride.look(20.0, balises=((3, ride.odometer_m),))
    assert demanded(ride.demands) == (True, True, False)
    assert ride.demands.cause == codes.POSITION
    # It is held whatever the speed, and at standstill too: nobody knows where it stands.
    assert ride.look(18.0).service_brake
    assert ride.look(0.0).service_brake
    # A balise within the interval confirms the position.
    ride.look(0.0, balises=((1, ride.odometer_m),))
    assert not ride.look(0.0).service_brake


def test_a_service_brake_that_does_not_slow_the_train_down_is_followed_by_the_emergency_brake() -> None:
    ride = Ride()
    ride.go_to(500.0, 15.0)
    ride.authority = None
    ride.look(15.0, looks=11)
    assert demanded(ride.demands) == (True, True, False)
    assert not ride.look(15.0, looks=29).emergency_brake
    assert ride.look(15.0, looks=2).emergency_brake
    assert ride.demands.cause == codes.RED_SIGNAL


def test_a_service_brake_that_slows_the_train_down_is_enough() -> None:
    ride = Ride()
    ride.go_to(500.0, 15.0)
    ride.authority = None
    for tenth in range(160):
        ride.look(15.0 - max(tenth - 11, 0) * 0.1, looks=1)
        assert not ride.demands.emergency_brake


def test_one_wrong_balise_between_right_ones_changes_nothing() -> None:
    ride = Ride()
    ride.go_to(500.0, 20.0)
    ride.look(20.0, balises=((3, ride.odometer_m),))
    ride.look(20.0, balises=((1, ride.odometer_m),))
    ride.look(20.0, balises=((3, ride.odometer_m),))
    assert demanded(ride.demands) == (False, False, False)


@pytest.mark.parametrize(
    ("speed_kmh", "wanted"), [(0.0, (False, False, False)), (4.9, (True, True, False)), (5.0, (True, False, True))]
)
def test_doors_that_lose_their_lock(speed_kmh: float, wanted: tuple[bool, bool, bool]) -> None:
    ride = Ride()
    if speed_kmh:
        ride.go_to(50.0, speed_kmh / 3.6)
    assert demanded(ride.look(speed_kmh / 3.6, doors_locked=False)) == wanted
    assert ride.demands.cause == (codes.DOORS if speed_kmh else codes.NONE)


def test_a_train_that_creeps_with_an_open_door_is_held_until_the_doors_are_locked() -> None:
    """A brake that is released at each standstill would let it creep on."""
    ride = Ride()
    ride.look(0.0, doors_locked=False)
    ride.look(0.1, doors_locked=False)
    assert demanded(ride.demands) == (True, True, False)
    assert demanded(ride.look(0.0, looks=20, doors_locked=False)) == (True, True, False)
    assert not ride.look(0.0).service_brake


def test_a_held_train_that_rolls_away_is_stopped() -> None:
    ride = Ride()
    ride.go_to(50.0, 2.0)
    # Held before it stands: the way is counted from standstill on.
    ride.look(1.0, train_held=True)
    ride.look(0.0, train_held=True)
    for _ in range(4):
        assert not ride.look(1.0, train_held=True).emergency_brake
    ride.look(1.0, looks=2, train_held=True)
    assert ride.demands.emergency_brake
    assert ride.demands.cause == codes.ROLL_AWAY


def test_a_released_train_does_not_roll_away() -> None:
    ride = Ride()
    ride.look(0.0, looks=5, train_held=True)
    ride.go_to(50.0, 5.0)
    assert not ride.demands.emergency_brake


@pytest.mark.parametrize(
    "changed",
    [
        {"speed_mps": float("nan")},
        {"odometer_m": float("inf")},
        {"speed_mps": -0.1},
        {"time_s": 1e9},
    ],
)
def test_readings_that_cannot_be_are_a_fault_of_its_own(changed: dict[str, float]) -> None:
    ride = Ride()
    ride.go_to(50.0, 10.0)
    assert ride.look(10.0, **changed).emergency_brake
    assert ride.demands.cause == codes.SELF_TEST


@pytest.mark.parametrize("factor", [0.0, 0.9, 1.1])
def test_odometer_and_speed_that_disagree_are_a_fault_of_its_own(factor: float) -> None:
    ride = Ride()
    ride.go_to(200.0, 10.0)
    start_m = ride.odometer_m
    for _ in range(50):
        ride.look(10.0, odometer_m=start_m + (ride.odometer_m + 1.0 - start_m) * factor)
    assert ride.demands.emergency_brake
    assert ride.demands.cause == codes.SELF_TEST


def test_a_reading_of_4_percent_too_much_is_no_fault() -> None:
    ride = Ride()
    ride.go_to(200.0, 10.0)
    start_m = ride.odometer_m
    for _ in range(200):
        ride.look(10.0, odometer_m=start_m + (ride.odometer_m + 1.0 - start_m) * 1.04)
    assert not ride.demands.emergency_brake


def test_an_authority_on_a_grade_that_no_brake_holds_is_a_fault_of_its_own() -> None:
    steep = Track(((-118.0, 0.0), (900.0, -130.0)), LEVEL.speed_limit_mps, ())
    ride = Ride(steep, authority=NEAR)
    assert ride.demands.emergency_brake
    assert ride.demands.cause == codes.SELF_TEST


def test_it_looks_every_100_ms_and_between_nothing_changes() -> None:
    protection = TrainProtection(Protection(), TRAIN, LEVEL, 0.0)
    first = protection.step(Readings(0.0, 0.0, 0.0, (), FAR, True, False))
    for tick in range(1, 10):
        protection.step(Readings(tick * 0.01, 30.0, 0.0, (), FAR, True, False))
        assert not first.emergency_brake
    protection.step(Readings(0.1, 30.0, 0.0, (), FAR, True, False))
    assert first.emergency_brake


def test_another_leg_has_its_own_limits_and_keeps_the_uncertainty() -> None:
    ride = Ride()
    ride.go_to(1000.0, 10.0)
    ride.look(0.0)
    width_m = ride.demands.uncertainty_m
    assert width_m > 20.0
    slow = Track(((-118.0, 0.0),), ((-118.0, 30 / 3.6),), ((1, 2500.0),))
    ride.protection.enter(slow, ride.odometer_m, 2000.0)
    ride.authority = Authority(9000.0, 9020.0)
    ride.look(0.0)
    assert ride.demands.uncertainty_m == pytest.approx(width_m)
    assert ride.demands.permitted_mps == pytest.approx(30 / 3.6)
    assert ride.demands.target_distance_m == pytest.approx(7000.0)
    # The authority of the leg before is not valid on it.
    ride.protection.enter(slow, ride.odometer_m, 2000.0)
    ride.authority = None
    assert ride.look(0.0).traction_cut


@pytest.mark.parametrize(("rolled_m", "is_stopped"), [(0.5, False), (0.502, True)])
def test_rolling_away_by_half_a_metre(rolled_m: float, is_stopped: bool) -> None:
    ride = Ride()
    ride.look(0.0, train_held=True)
    assert ride.look(0.0, train_held=True, odometer_m=rolled_m).emergency_brake is is_stopped


def test_the_acceleration_of_the_last_half_second_counts_for_the_ebi() -> None:
    """0.3 m/s2 for six looks, after a coast: the slope is that of five of them."""
    ride = Ride(authority=NEAR)
    ride.go_to(740.0, 17.0)
    for _ in range(6):
        ride.look(ride.speed_mps + 0.03)
    brake = Protection().brake_model(9.81)
    limits = Braking(brake, ((0.0, 0.0),), 40.0).emergency_limits(1030.0, 0.0, 0.0)
    most_m = ride.protection.place.most_m
    assert ride.demands.ebi_mps == pytest.approx(limits.speed_mps(most_m, 0.0, 40.0, 0.3), abs=1e-6)
    ride.look(ride.speed_mps)
    most_m = ride.protection.place.most_m
    assert ride.demands.ebi_mps == pytest.approx(limits.speed_mps(most_m, 0.0, 40.0, 0.24), abs=1e-6)


def test_without_an_authority_there_is_no_target() -> None:
    demands = Ride(authority=None).demands
    assert (demands.target_distance_m, demands.target_speed_mps, demands.release_mps) == (0.0, 0.0, 0.0)


def test_a_service_brake_stays_applied_to_a_creeping_train() -> None:
    ride = Ride()
    ride.go_to(50.0, 2.0)
    ride.authority = None
    ride.look(2.0, looks=11)
    assert ride.look(0.3).service_brake
    assert not ride.look(0.0).service_brake
