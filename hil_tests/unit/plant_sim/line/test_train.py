"""The train on a line of four stops: its stops, doors, departures and the end of its run."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hil_tests.support.lines import STOPS, Driver, four_stops
from railhil.bus.codes import Event
from railhil.bus.layout import CHECK_ERRONEOUS, FLAG_ERROR, FLAG_FALSE, FLAG_TRUE, FLAG_UNDEFINED
from railhil.plant_sim.line.train import LineTrain
from railhil.systems.line.scenario.model import RouteSignal
from railhil.wire.ato import TrkInfo
from railhil.wire.line import DoorCmd, DoorOrder, DoorStat, DoorState, SignalAspect, StnInfo


def begun(seed: int = 0, **line: object) -> Driver:
    scenario = four_stops(**line)
    return Driver(LineTrain(scenario, seed), scenario)


def ended(driver: Driver) -> Event | None:
    """The event that ends the run, as the tick loop asks for it."""
    train = driver.train
    return train.ending.reached(train.tick, False) if train.tick >= train.ending.due_tick else None


def at_stop(driver: Driver) -> bool:
    """Whether the train stands at its second stop."""
    return driver.train.station_here == 1


def station(driver: Driver) -> StnInfo:
    found = driver.train.makers[StnInfo.PORT]()
    assert isinstance(found, StnInfo)
    return found


def doors(driver: Driver) -> DoorStat:
    found = driver.train.makers[DoorStat.PORT]()
    assert isinstance(found, DoorStat)
    return found


def test_a_train_serves_its_stops_and_the_run_ends_with_open_doors() -> None:
    driver = begun()
    driver.run(lambda: ended(driver) is not None)
    assert ended(driver) is Event.ENDED_COMPLETE
    assert driver.kinds() == [
        *("departure", "departed", "stopped", "arrived", "doors_open", "doors_locked"),
        *("departure", "passed", "stopped", "arrived", "doors_open"),
    ]
    opened = driver.events[-1]
    assert opened.kind == "doors_open"
    assert driver.train.tick * 100 == opened.instant_01ms + 10_000
    assert [event.balise.number for event in driver.events if event.balise] == list(range(1, 11))


def test_events_of_a_line_are_in_the_order_of_their_instants() -> None:
    driver = begun()
    driver.run(lambda: ended(driver) is not None)
    instants = [event.instant_01ms for event in driver.events]
    assert instants == sorted(instants)


def test_a_passed_stop_is_reported_at_its_place() -> None:
    driver = begun()
    driver.run(lambda: "passed" in driver.kinds())
    assert driver.events[-1].position_01mm == 23_000_000
    assert station(driver).station_next == 4


def test_station_information_follows_the_train() -> None:
    driver = begun()
    first = station(driver)
    assert (first.station_here, first.station_next, first.section, first.next_stop_mm) == (1, 2, 0, 0)
    assert first.due_departure_ds == 50
    driver.run(lambda: not driver.train.is_standing)
    under_way = station(driver)
    assert (under_way.station_here, under_way.station_next, under_way.section) == (0, 2, 1)
    assert (under_way.next_stop_mm, under_way.due_arrival_ds) == (1_200_000, 1370)
    track = driver.train.makers[TrkInfo.PORT]()
    assert isinstance(track, TrkInfo)
    assert (track.target_mm, track.target_time_ds) == (1_200_000, 1370)
    driver.run(lambda: at_stop(driver))
    there = station(driver)
    assert (there.station_here, there.station_next, there.section, there.due_departure_ds) == (2, 3, 1, 1670)


def test_the_dwell_counts_down_from_open_doors() -> None:
    driver = begun()
    driver.run(lambda: at_stop(driver))
    whole = doors(driver).dwell_left_ds
    # The least dwell of 20 s, less the times of opening, warning and closing.
    assert whole == 122
    driver.run(lambda: "doors_open" in driver.kinds())
    assert doors(driver).dwell_left_ds == whole
    ticks = driver.train.tick + 700
    driver.run(lambda: driver.train.tick == ticks)
    assert doors(driver).dwell_left_ds == whole - 70


def test_a_dwell_is_drawn_with_the_seed() -> None:
    def drawn(seed: int) -> int:
        driver = begun(seed, disturbance_s=8.0)
        driver.run(lambda: at_stop(driver))
        return doors(driver).dwell_left_ds

    left = {drawn(seed) for seed in range(3)}
    assert len(left) == 3
    assert all(122 <= value <= 202 for value in left)


@pytest.mark.parametrize(
    ("order", "number"),
    [(DoorOrder.OPEN_RIGHT, 2), (DoorOrder.OPEN_BOTH, 2), (DoorOrder.OPEN_LEFT, 1), (DoorOrder.OPEN_LEFT, 4)],
)
def test_doors_stay_shut_for_the_wrong_side_or_station(order: DoorOrder, number: int) -> None:
    driver = begun()
    driver.run(lambda: at_stop(driver))
    driver.orders = lambda: {"order": order, "station": number, "hold_brake": FLAG_TRUE}  # type: ignore[method-assign]
    ticks = driver.train.tick + 300
    driver.run(lambda: driver.train.tick == ticks)
    assert driver.kinds().count("door_refused") == 1
    assert driver.train.doors.are_locked


def test_doors_stay_shut_under_way() -> None:
    driver = begun()
    driver.run(lambda: driver.train.true_speed_01mmps > 100_000)
    driver.orders = lambda: {"order": DoorOrder.OPEN_LEFT, "station": 2}  # type: ignore[method-assign]
    ticks = driver.train.tick + 300
    driver.run(lambda: driver.train.tick == ticks)
    assert driver.kinds().count("door_refused") == 1
    assert driver.train.doors.are_locked


def test_open_doors_cut_traction_and_hold_the_train() -> None:
    driver = begun()
    driver.run(lambda: "doors_open" in driver.kinds())
    driver.notch = lambda: 7.0  # type: ignore[method-assign]
    driver.orders = lambda: {"hold_brake": FLAG_FALSE, "station": 2}  # type: ignore[method-assign]
    place, ticks = driver.train.position_01mm, driver.train.tick + 1000
    driver.run(lambda: driver.train.tick == ticks)
    assert driver.train.position_01mm == place
    assert driver.train.traction_n == 0.0
    assert not driver.train.status.traction_enabled


def test_open_doors_hold_a_train_whose_brake_nobody_has_demanded() -> None:
    driver = begun()
    driver.run(lambda: at_stop(driver) and driver.train.docking.is_in_window)
    driver.orders = lambda: {"hold_brake": FLAG_FALSE, "order": DoorOrder.OPEN_LEFT, "station": 2}  # type: ignore[method-assign]
    driver.notch = lambda: 0.0 if "doors_open" in driver.kinds() else -7.0  # type: ignore[method-assign]
    driver.run(lambda: "doors_open" in driver.kinds())
    place, ticks = driver.train.position_01mm, driver.train.tick + 2000
    driver.run(lambda: driver.train.tick == ticks)
    # On a grade of 8 per mille.
    assert driver.train.position_01mm == place
    assert driver.train.holding.is_applied


def test_doors_that_open_while_the_train_begins_to_move_close_again() -> None:
    driver = begun()
    driver.run(lambda: driver.train.doors.left.state == DoorState.OPENING)
    train = driver.train
    ticks = train.tick + 100
    driver.run(lambda: train.tick == ticks)
    assert train.doors.left.state == DoorState.OPENING
    ticks += 250
    while train.tick < ticks:
        train._motion = train._motion._replace(speed_mps=0.3)
        driver.tick()
        assert train.doors.left.state in (DoorState.CLOSING, DoorState.LOCKED)
    assert "doors_open" not in driver.kinds()


def test_a_train_leaves_with_permission_only() -> None:
    driver = begun()
    driver.run(lambda: "doors_open" in driver.kinds())
    departing = {"depart_ready": FLAG_TRUE, "station": 2, "hold_brake": FLAG_TRUE}
    driver.orders = lambda: departing  # type: ignore[method-assign]
    ticks = driver.train.tick + 300
    driver.run(lambda: driver.train.tick == ticks)
    assert driver.kinds().count("door_refused") == 1
    assert driver.train.journey.section == 0


def refused_at_second_stop(driver: Driver) -> None:
    """The order to depart that it is given now is refused, and its authority stays."""
    train = driver.train
    authority = train.journey.authority(train.position_01mm / 1e4, train.tick)
    ready = {"depart_ready": FLAG_TRUE, "station": 2, "hold_brake": FLAG_TRUE}
    driver.orders = lambda: ready  # type: ignore[method-assign]
    ticks = train.tick + 100
    driver.run(lambda: train.tick == ticks)
    assert driver.kinds()[-1] == "door_refused"
    assert train.journey.section == 0
    assert train.journey.authority(train.position_01mm / 1e4, train.tick) == authority


def test_a_train_with_open_doors_does_not_leave_although_the_track_side_permits_it() -> None:
    driver = begun(stops=(STOPS[0], replace(STOPS[1], psd=False), *STOPS[2:]))
    driver.run(lambda: "doors_open" in driver.kinds())
    opened = {"order": DoorOrder.OPEN_LEFT, "station": 2, "hold_brake": FLAG_TRUE}
    driver.orders = lambda: opened  # type: ignore[method-assign]
    driver.run(lambda: driver.train.is_departure_permitted)
    refused_at_second_stop(driver)


def test_a_train_does_not_leave_before_the_exchange_of_passengers_is_over() -> None:
    driver = begun()
    driver.run(lambda: "doors_open" in driver.kinds())
    closing = {"order": DoorOrder.CLOSE, "station": 2, "hold_brake": FLAG_TRUE}
    driver.orders = lambda: closing  # type: ignore[method-assign]
    driver.run(lambda: "doors_locked" in driver.kinds())
    assert driver.train.journey.dwell_left_s(driver.train.tick) > 2.0
    refused_at_second_stop(driver)


def test_a_train_does_not_leave_towards_a_red_signal() -> None:
    driver = begun(signals=(RouteSignal(1500.0, 400.0),))
    driver.run(lambda: "doors_locked" in driver.kinds())
    assert driver.train.journey.dwell_left_s(driver.train.tick) == 0.0
    refused_at_second_stop(driver)


def test_doors_of_the_platform_that_lose_their_lock_keep_the_permission_back() -> None:
    driver = begun()
    driver.run(lambda: "doors_locked" in driver.kinds())
    driver.train.doors.psd.has_lost_lock = True
    driver.train.show_doors()
    assert (doors(driver).doors_locked, doors(driver).psd_locked) == (FLAG_TRUE, FLAG_FALSE)
    assert station(driver).depart_permit == FLAG_FALSE
    assert not driver.train.status.traction_enabled
    driver.run(lambda: driver.train.tick == 20_000)
    assert driver.kinds().count("departure") == 1


def test_a_red_signal_keeps_the_permission_back() -> None:
    driver = begun(signals=(RouteSignal(1300.0, 200.0),))
    driver.run(lambda: driver.train.tick == 17_500)
    assert station(driver).depart_permit == FLAG_FALSE
    assert station(driver).signal_next == SignalAspect.RED
    driver.run(lambda: driver.kinds().count("departure") == 2)
    assert 20_000 <= driver.train.tick <= 20_051


def test_a_stop_without_open_doors_is_missed() -> None:
    beyond = (STOPS[0], replace(STOPS[1], position_m=1190.0), *STOPS[2:])
    driver = begun(stops=beyond)
    driver.aim_m = 1200.0
    driver.run(lambda: driver.aim_m > 0.0 and not driver.train.is_standing)
    driver.aim_m = 1200.0
    driver.run(lambda: ended(driver) is not None)
    assert driver.kinds()[:6] == ["departure", "departed", "stopped", "arrived", "missed", "departure"]
    assert ended(driver) is Event.ENDED_COMPLETE


def test_a_train_short_of_its_stop_creeps_to_it() -> None:
    driver = begun()
    driver.run(lambda: not driver.train.is_standing)
    driver.aim_m = 1197.0
    driver.run(lambda: at_stop(driver))
    driver.aim_m = 1200.0
    driver.run(lambda: "doors_open" in driver.kinds())
    assert driver.kinds()[-5:] in (
        ["stopped", "arrived", "jog", "stopped", "doors_open"],
        ["arrived", "jog", "stopped", "jog", "doors_open"],
    )


def test_a_train_that_stands_far_short_counts_as_arrived_after_ten_seconds() -> None:
    driver = begun()
    driver.run(lambda: not driver.train.is_standing)
    driver.aim_m = 1150.0
    driver.run(lambda: driver.train.is_standing)
    driver.orders = lambda: {"hold_brake": FLAG_TRUE}  # type: ignore[method-assign]
    driver.notch = lambda: 0.0  # type: ignore[method-assign]
    stood = driver.train.tick
    driver.run(lambda: at_stop(driver))
    assert 1000 <= driver.train.tick - stood <= 1011


def test_a_train_that_leaves_has_not_arrived_at_a_next_stop_nearer_than_its_length() -> None:
    stops = (STOPS[0], replace(STOPS[1], position_m=80.0), *(replace(one, position_m=180.0) for one in STOPS[3:]))
    driver = begun(stops=(stops[0], stops[1], stops[2]))
    driver.heeds_due = False
    driver.run(lambda: driver.kinds().count("departure") == 2)
    driver.run(lambda: driver.train.position_01mm > 1_000_000)
    assert driver.kinds().count("arrived") == 1


def test_the_holding_brake_keeps_a_train_on_a_grade_until_traction_exceeds_it() -> None:
    driver = begun()
    driver.run(lambda: "departed" in driver.kinds())
    # A train that has just begun to move had a traction above its resistance.
    assert driver.train.traction_n > 0.0
    driver = begun()
    driver.notch = lambda: 0.0  # type: ignore[method-assign]
    driver.run(lambda: driver.train.tick == 2000)
    assert driver.train.position_01mm == 0
    assert driver.train.holding.is_applied


def test_a_run_without_its_terminal_ends_after_the_overtime() -> None:
    driver = begun()
    driver.heeds_due = True
    driver.notch = lambda: 0.0  # type: ignore[method-assign]
    driver.run(lambda: ended(driver) is not None)
    assert ended(driver) is Event.ENDED_NOT_STOPPED
    assert driver.train.tick == 64_001


def test_orders_that_fail_their_checks_are_counted_and_not_carried_out() -> None:
    driver = begun()
    driver.run(lambda: at_stop(driver) and driver.train.docking.is_in_window)
    train, order = driver.train, {"order": DoorOrder.OPEN_LEFT, "station": 2, "hold_brake": FLAG_TRUE}
    accepted, _ = train.judged[DoorCmd.PORT]
    # A check variable that is not correct, an old life sign, and the same telegram again.
    for values in ({"check": CHECK_ERRONEOUS, "life": 1}, {"life": 0}, {"life": 1}):
        life = (driver.door_life + values.pop("life") - 1) % 16
        train.take(DoorCmd(**order, **values, life=life))
    assert train.judged[DoorCmd.PORT] == (accepted, {"check_variable": 1, "out_of_order": 1, "duplicate": 1})
    assert train.refused["door_check_variable"] == 1
    assert train.doors.are_locked


@pytest.mark.parametrize("hold", [FLAG_ERROR, FLAG_UNDEFINED])
def test_a_demand_for_the_holding_brake_that_says_nothing_holds(hold: int) -> None:
    driver = begun()
    driver.orders = lambda: {"hold_brake": hold}  # type: ignore[method-assign]
    driver.notch = lambda: 7.0  # type: ignore[method-assign]
    driver.run(lambda: driver.train.tick == 1000)
    assert driver.train.position_01mm == 0


def test_a_run_whose_controller_is_lost_at_a_stop_ends_there() -> None:
    driver = begun()
    driver.run(lambda: "doors_open" in driver.kinds())
    assert driver.train.ending.reached(driver.train.tick, True) is Event.ENDED_NOT_STOPPED
    driver.run(lambda: driver.kinds().count("departure") == 2 and not driver.train.is_standing)
    assert driver.train.ending.reached(driver.train.tick, True) is None


def test_a_terminal_without_open_doors_ends_the_run_after_ten_seconds() -> None:
    driver = begun()
    driver.run(lambda: driver.kinds().count("departure") == 2)
    driver.aim_m = 3421.0
    driver.run(lambda: ended(driver) is not None)
    assert ended(driver) is Event.ENDED_COMPLETE
    assert driver.kinds()[-1] == "arrived"
    assert driver.train.tick - driver.train.stood_from_tick in range(1000, 1012)


def test_doors_that_open_slowly_at_the_terminal_keep_the_run_going() -> None:
    driver = begun()
    driver.run(lambda: driver.kinds().count("departure") == 2)
    driver.train.doors.right.slowness = 6.0
    driver.run(lambda: ended(driver) is not None)
    # They take 15 s. Without them, the run is over after ten.
    assert driver.kinds()[-2:] == ["arrived", "doors_open"]
    opened, arrived = (
        next(one for one in driver.events[::-1] if one.kind == kind) for kind in ("doors_open", "arrived")
    )
    assert opened.instant_01ms - arrived.instant_01ms > 150_000
    assert driver.train.tick * 100 == opened.instant_01ms + 10_000
