"""The train protection in the train: what it demands acts on the train itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import pytest

from hil_tests.support.lines import LIMITS, STOPS, Driver, four_stops, make_leg
from railhil.bus.layout import FLAG_FALSE, FLAG_TRUE
from railhil.plant_sim.atp.readings import Authority
from railhil.plant_sim.line.onboard import EMERGENCY_BRAKE, NO_REACTION
from railhil.plant_sim.line.train import LineTrain
from railhil.systems.line.judge.invariants import ROLL_MAX_M
from railhil.systems.line.scenario.model import LineScenario, RouteSignal
from railhil.wire.line import AtpCause, AtpLim, AtpStat, AtpStatus, DoorStat, SignalAspect, StnInfo


def begun(line: LineScenario | None = None) -> Driver:
    line = line or four_stops()
    return Driver(LineTrain(line, 0), line)


def told(driver: Driver) -> AtpStat:
    found = driver.train.makers[AtpStat.PORT]()
    assert isinstance(found, AtpStat)
    return found


def under_way(driver: Driver, speed_mps: float = 14.0) -> None:
    driver.run(lambda: driver.train.true_speed_01mmps > speed_mps * 1e4)


def frozen(driver: Driver, notch: float = 7.0) -> None:
    """From now on the controller sends one notch."""
    driver.notch = lambda: notch  # type: ignore[method-assign]


def standing(driver: Driver) -> Callable[[], bool]:
    return lambda: driver.train.is_standing


def test_a_train_that_keeps_to_its_curve_meets_no_reaction() -> None:
    driver = begun()
    reactions = set()

    def watched() -> bool:
        assert driver.train.onboard is not None
        reactions.add(driver.train.onboard.reaction)
        return driver.kinds().count("doors_open") == 2

    driver.run(watched)
    assert reactions == {NO_REACTION}
    assert "atp" not in driver.kinds()


@pytest.mark.parametrize("notch", [7.0, 1.0, 0.0])
def test_a_frozen_controller_passes_no_supervised_location(notch: float) -> None:
    driver = begun()
    under_way(driver)
    frozen(driver, notch)
    driver.run(standing(driver))
    stop = driver.line.stops[1]
    assert driver.train.position_01mm / 1e4 < stop.position_m + stop.svl_overlap_m
    assert "atp" in driver.kinds()


def test_without_protection_a_frozen_controller_passes_it() -> None:
    line = four_stops()
    driver = begun(replace(line, atp=replace(line.atp, enabled=False)))
    under_way(driver)
    frozen(driver, 0.0)
    driver.run(lambda: driver.train.position_01mm > 12_310_000)
    assert (told(driver).traction_cut, told(driver).emergency_brake) == (FLAG_FALSE, FLAG_FALSE)


def test_a_train_that_leaves_without_permission_is_stopped_before_the_supervised_location() -> None:
    driver = begun()
    frozen(driver)
    driver.orders = lambda: {"hold_brake": FLAG_FALSE, "station": 1}  # type: ignore[method-assign]
    driver.run(lambda: driver.train.position_01mm > 10_000)
    driver.run(standing(driver))
    assert driver.train.position_01mm < 300_000
    assert told(driver).emergency_brake == FLAG_TRUE


def test_a_dead_protection_applies_the_emergency_brake_within_half_a_second() -> None:
    driver = begun()
    under_way(driver)
    onboard, ticks = driver.train.onboard, driver.train.tick
    assert onboard is not None
    onboard.is_dead = True
    driver.run(lambda: onboard.reaction == EMERGENCY_BRAKE)
    assert 40 <= driver.train.tick - ticks <= 51
    assert driver.kinds()[-2:] == ["atp", "emergency"]
    onboard.is_dead = False
    driver.run(standing(driver))
    assert (told(driver).emergency_brake, told(driver).cause) == (FLAG_TRUE, AtpCause.SELF_TEST)


def test_doors_that_lose_their_lock_at_speed_stop_the_train() -> None:
    driver = begun()
    under_way(driver)
    driver.train.doors.left.has_lost_lock = True
    driver.train.show_doors()
    driver.run(lambda: "atp" in driver.kinds(), most_s=300)
    assert told(driver).cause == AtpCause.DOORS
    assert not driver.train.status.traction_enabled
    driver.run(standing(driver))
    assert driver.train.position_01mm < 12_000_000


def test_the_emergency_brake_reaches_its_deceleration_after_dead_time_and_lag() -> None:
    driver = begun()
    under_way(driver)
    frozen(driver, 0.0)
    onboard = driver.train.onboard
    assert onboard is not None
    onboard.is_dead = True
    driver.run(lambda: onboard.reaction == EMERGENCY_BRAKE)
    from_mps = driver.train.true_speed_01mmps / 1e4
    ticks = driver.train.tick
    driver.run(standing(driver))
    # Dead time and lag add up to 0.9 s; grade and resistance are small.
    assert (driver.train.tick - ticks) / 100 == pytest.approx(from_mps / 1.2 + 0.9, rel=0.1)


def test_the_protection_knows_its_place_between_the_stops() -> None:
    driver = begun()
    driver.run(lambda: driver.train.position_01mm > 9_000_000)
    onboard = driver.train.onboard
    assert onboard is not None
    # Half a metre, and 2 % of 300 m to each side.
    assert onboard.demands.uncertainty_m < 7.0


def test_a_lock_that_is_lost_under_way_is_told() -> None:
    driver = begun()
    under_way(driver)
    driver.train.makers[DoorStat.PORT]()
    driver.train.doors.left.has_lost_lock = True
    driver.train.show_doors()
    driver.tick()
    found = driver.train.makers[DoorStat.PORT]()
    assert isinstance(found, DoorStat)
    assert found.doors_locked == FLAG_FALSE


def test_a_red_signal_in_the_section_ends_the_authority_of_a_train_that_passes_it() -> None:
    driver = begun(four_stops(signals=(RouteSignal(900.0, 400.0),)))
    journey = driver.train.journey
    journey.depart(driver.train.tick)
    assert journey.authority(0.0, 1000) == Authority(900.0, 920.0, True)
    assert journey.authority(950.0, 39_999) == Authority(900.0, 920.0, True)
    assert journey.authority(0.0, 40_000) == Authority(1210.0, 1230.0)


def with_platform_doors_at_a_passed_stop() -> LineScenario:
    line = four_stops()
    (passed,) = (number for number, stop in enumerate(line.stops) if stop.service == "pass")
    stops = list(line.stops)
    stops[passed] = replace(stops[passed], psd=True)
    return replace(line, stops=tuple(stops))


def test_platform_doors_on_the_way_that_are_not_locked_end_the_authority_before_their_platform() -> None:
    line = with_platform_doors_at_a_passed_stop()
    journey = begun(line).train.journey
    (passed,) = (stop for stop in line.stops if stop.service == "pass")
    begin_m = passed.position_m - line.train.length_m
    journey.depart(0)
    assert journey.passed_platforms == ()
    journey.depart(0)
    assert journey.passed_platforms == (passed,)
    whole = journey.authority(begin_m - 1.0, 0, are_platforms_locked=True)
    assert whole == journey.authority(begin_m - 1.0, 0)
    ended = journey.authority(begin_m - 1.0, 0, are_platforms_locked=False)
    assert (ended.eoa_m, ended.red_signal) == (begin_m, True)
    # Of a train that has passed its end the authority stays ended; of one that was at the platform before, it does not.
    assert journey.authority(begin_m + 1.0, 0, are_platforms_locked=False) == ended
    assert journey.authority(begin_m + 1.0, 0, are_platforms_locked=True) == whole
    assert journey.authority(begin_m + 1.0, 0, are_platforms_locked=False) == whole


def test_a_train_stops_before_a_platform_on_the_way_whose_doors_lose_their_lock() -> None:
    line = with_platform_doors_at_a_passed_stop()
    (passed,) = (stop for stop in line.stops if stop.service == "pass")
    driver = begun(line)
    driver.run(lambda: driver.kinds().count("departure") == 2)

    def told() -> tuple[int, int]:
        found = driver.train.makers[DoorStat.PORT]()
        assert isinstance(found, DoorStat)
        return found.psd_present, found.psd_locked

    for _ in range(500):
        driver.tick()
    assert told() == (0, FLAG_TRUE)
    driver.train.doors.psd.has_lost_lock = True
    assert told() == (0, FLAG_FALSE)
    driver.run(lambda: "atp" in driver.kinds() and driver.train.is_standing)
    assert driver.train.position_01mm < (passed.position_m - line.train.length_m + 20.0) * 1e4


def test_platform_doors_that_have_been_passed_are_no_longer_told() -> None:
    line = with_platform_doors_at_a_passed_stop()
    driver = begun(line)
    driver.run(lambda: "passed" in driver.kinds())
    driver.train.doors.psd.has_lost_lock = True
    found = driver.train.makers[DoorStat.PORT]()
    assert isinstance(found, DoorStat)
    assert found.psd_locked == FLAG_TRUE


def test_an_exit_that_a_fault_holds_red_is_shown_until_the_train_has_left_it() -> None:
    driver = begun()
    driver.run(lambda: driver.kinds().count("departure") == 2)

    def aspect() -> int:
        found = driver.train.makers[StnInfo.PORT]()
        assert isinstance(found, StnInfo)
        return found.signal_next

    left = driver.line.stops[1]
    assert aspect() == SignalAspect.NONE
    driver.train.journey.held_red.add(0)
    assert aspect() == SignalAspect.RED
    driver.run(lambda: driver.train.position_01mm / 1e4 > left.position_m + left.eoa_overlap_m - 0.5)
    assert aspect() == SignalAspect.RED
    driver.run(lambda: driver.train.position_01mm / 1e4 > left.position_m + left.eoa_overlap_m)
    assert aspect() == SignalAspect.NONE


def test_a_signal_that_falls_red_behind_the_train_does_not_stop_it() -> None:
    driver = begun(four_stops(signals=(RouteSignal(300.0, 1.0),)))
    driver.run(lambda: driver.train.position_01mm > 4_000_000)
    driver.train.journey.held_red.add(1)
    driver.run(lambda: "doors_open" in driver.kinds())
    assert "atp" not in driver.kinds()


def test_the_service_brake_of_the_protection_is_released_over_some_time() -> None:
    driver = begun(four_stops(signals=(RouteSignal(700.0, 1.0),)))
    train, onboard = driver.train, driver.train.onboard
    assert onboard is not None
    frozen(driver, 0.0)
    driver.notch = lambda: 7.0 if train.position_01mm < 3_000_000 else 0.0  # type: ignore[method-assign]
    driver.run(lambda: train.position_01mm > 3_000_000)
    train.journey.held_red.add(1)
    driver.run(lambda: train._window.brake_min_n > 200_000)
    train.journey.held_red.clear()
    driver.run(lambda: onboard.reaction == NO_REACTION)
    braked_n = [train._window.brake_min_n]
    while braked_n[-1] > 0.0:
        driver.tick()
        braked_n.append(train._window.brake_min_n)
    assert 0.5 < len(braked_n) * 0.01 < 3.0
    assert max(one - other for one, other in pairwise(braked_n)) < 0.05 * braked_n[0]


def test_the_permitted_speed_is_told_to_the_driver() -> None:
    driver = begun()
    under_way(driver)
    found = driver.train.makers[AtpLim.PORT]()
    assert isinstance(found, AtpLim)
    assert found.status == AtpStatus.NORMAL
    assert 15.0 < found.permitted_4mmps / 250 <= 80 / 3.6 + 0.004


@pytest.mark.parametrize("grade_permil", [-24.0, -40.0])
def test_a_train_that_its_protection_catches_rolls_no_further_than_the_judge_allows(grade_permil: float) -> None:
    line = four_stops(legs=(make_leg(0, STOPS, ((-118.0, grade_permil), (300.0, 0.0)), LIMITS),))
    driver = begun(line)
    frozen(driver, 0.0)
    driver.orders = lambda: {"hold_brake": FLAG_TRUE, "station": 1}  # type: ignore[method-assign]
    train = driver.train
    train.holding.share = 0.0
    driver.run(lambda: "emergency" in driver.kinds())
    driver.run(standing(driver))
    assert told(driver).cause == AtpCause.ROLL_AWAY
    assert 0.5 < train.position_01mm / 1e4 < ROLL_MAX_M


def test_a_warning_of_the_protection_cuts_the_traction_of_a_train_at_full_power() -> None:
    driver = begun(four_stops(signals=(RouteSignal(700.0, 400.0),)))
    train, onboard = driver.train, driver.train.onboard
    assert onboard is not None
    train.journey.depart(train.tick)
    frozen(driver)
    driver.run(lambda: onboard.reaction > NO_REACTION)
    assert onboard.reaction < EMERGENCY_BRAKE
    driver.tick()
    assert train.traction_n == 0.0
