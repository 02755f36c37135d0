"""The station automaton: standstill, doors, dwell and departure, told by telegrams."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.unit.controller_node.line.world import OPENS, PERIOD_MS, World
from railhil.bus.layout import CHECK_ERRONEOUS, flag
from railhil.controller_node.line.stations import Drive
from railhil.wire.line import AtoState, DoorOrder, DoorSide, DoorStat, DoorState, ModeOrder, SignalAspect

STOP_01MM = 10_000_000


def at_stop(error_01mm: int = 0, here: int = 3) -> World:
    world = World()
    world.leave()
    world.stand_at(STOP_01MM + error_01mm, here)
    return world


def with_open_doors() -> World:
    world = at_stop()
    world.run(1000)
    world.door, world.dwell_left_ds = DoorState.OPEN, 100
    world.run(100)
    return world


def with_closed_doors() -> World:
    world = with_open_doors()
    world.dwell_left_ds = 0
    world.run(160_000 - world.now_ms)
    world.door = DoorState.LOCKED
    return world


def test_the_first_departure_is_at_its_time_in_a_whole_control_period() -> None:
    world = World()
    world.run(30_000)
    assert (world.stations.state, world.stations.drive, world.stations.holds) == (AtoState.READY, Drive.NONE, True)
    world.tick()
    assert world.stations.departed
    assert (world.stations.state, world.stations.drive) == (AtoState.RUN, Drive.LAW)
    assert (world.stations.is_ready, world.stations.station, world.stations.holds) == (True, 1, False)
    world.tick()
    assert not world.stations.departed


def test_the_departure_is_no_longer_ordered_when_the_train_has_left() -> None:
    world = World()
    world.leave()
    assert (world.stations.is_ready, world.stations.station) == (False, 0)


@pytest.mark.parametrize(
    ("attribute", "value"),
    [
        ("permit", False), ("door", DoorState.CLOSING), ("is_sound", False), ("tells_doors", False),
        ("tells_info", False), ("speed_01mmps", 10), ("here", 3),
    ],
)  # fmt: skip
def test_nothing_departs_while_one_condition_is_missing(attribute: str, value: object) -> None:
    world = World()
    world.run(25_000)
    usual = getattr(world, attribute)
    setattr(world, attribute, value)
    world.run(8000)
    assert world.stations.state is AtoState.READY
    setattr(world, attribute, usual)
    world.run(PERIOD_MS + 300)
    assert world.stations.state is AtoState.RUN


def test_a_departure_that_is_not_accepted_is_ordered_again() -> None:
    world = World()
    world.run(30_020)
    assert world.stations.state is AtoState.RUN
    world.run(1700)
    assert world.stations.counters["departures_refused"] == 1
    assert world.stations.holds
    world.run(2 * PERIOD_MS)
    assert world.stations.state is AtoState.RUN


def test_doors_open_at_the_stop_and_close_for_the_departure() -> None:
    world = at_stop()
    world.run(1000)
    assert (world.stations.state, world.stations.order) == (AtoState.OPENING, DoorOrder.OPEN_LEFT)
    assert (world.stations.station, world.stations.holds) == (3, True)
    world.door, world.dwell_left_ds = DoorState.OPEN, 200
    world.run(200)
    assert (world.stations.state, world.stations.order) == (AtoState.OPEN, DoorOrder.NONE)
    world.dwell_left_ds = 0
    world.run(160_000 - 500 - 3000 - 2000 - world.now_ms)
    assert world.stations.state is AtoState.OPEN
    world.tick()
    assert world.stations.state is AtoState.WARN
    world.run(2000)
    assert (world.stations.state, world.stations.order) == (AtoState.CLOSING, DoorOrder.CLOSE)
    world.door = DoorState.CLOSING
    world.run(3000)
    world.door = DoorState.LOCKED
    world.run(160_000 - world.now_ms)
    assert world.stations.state is AtoState.READY
    world.tick()
    assert world.stations.departed
    assert world.stations.stop == 1


def test_a_late_train_keeps_its_doors_open_for_the_exchange() -> None:
    world = with_open_doors()
    world.run(200_000 - world.now_ms)
    assert world.stations.state is AtoState.OPEN
    world.dwell_left_ds = 0
    world.run(40)
    assert world.stations.state is AtoState.WARN


def test_a_train_short_of_the_window_creeps_until_the_attempts_are_used() -> None:
    world = at_stop(-20_000)
    world.run(400)
    for jogs in (1, 2):
        assert (world.stations.state, world.stations.drive) == (AtoState.JOG, Drive.CREEP)
        assert world.stations.counters["jogs"] == jogs
        assert not world.stations.holds
        world.speed_01mmps, world.here = 3000, 0
        world.run(1000)
        world.stand_at(STOP_01MM - 8000)
        world.run(400)
    assert world.stations.state is AtoState.MISSED
    assert world.stations.counters["missed_stops"] == 1


def test_a_creep_that_ends_inside_the_window_opens_the_doors() -> None:
    world = at_stop(-20_000)
    world.run(400)
    world.speed_01mmps, world.here = 3000, 0
    world.run(1000)
    world.stand_at(STOP_01MM - 500)
    world.run(1000)
    assert world.stations.state is AtoState.OPENING


def test_a_train_beyond_the_window_keeps_its_doors_shut_and_goes_on() -> None:
    world = at_stop(6000)
    world.run(9000)
    assert (world.stations.state, world.stations.order) == (AtoState.MISSED, DoorOrder.NONE)
    world.run(3000)
    assert world.stations.state is AtoState.READY


def test_a_train_that_halts_between_stops_drives_on_when_the_signal_is_clear() -> None:
    world = at_stop(-5_000_000, here=0)
    world.signal = SignalAspect.RED
    world.run(20_000)
    assert (world.stations.state, world.stations.drive, world.stations.holds) == (AtoState.RUN, Drive.NONE, True)
    world.signal = SignalAspect.CLEAR
    for _ in range(PERIOD_MS // 20):
        world.tick()
        if world.stations.resumed:
            break
    assert world.stations.resumed
    assert (world.stations.drive, world.stations.stop) == (Drive.LAW, 0)


def test_a_train_that_the_track_side_takes_for_arrived_far_from_the_stop_misses_it() -> None:
    world = at_stop(-140_000, here=0)
    world.run(5000)
    assert world.stations.state is AtoState.RUN
    world.here = 3
    world.run(100)
    assert world.stations.state is AtoState.MISSED


def test_doors_stay_shut_where_the_track_side_has_another_side() -> None:
    world = at_stop()
    world.side = DoorSide.RIGHT
    world.run(5000)
    assert world.stations.state is AtoState.WRONG_SIDE
    assert world.stations.counters["wrong_sides"] == 1
    world.run(10_000)
    assert world.stations.state is AtoState.READY


def test_a_train_that_the_docking_loop_does_not_see_misses_the_stop() -> None:
    world = at_stop(1000)
    world.in_window = False
    world.run(13_000)
    assert world.stations.state is AtoState.READY
    assert world.stations.counters["missed_stops"] == 1


def test_doors_that_reopen_are_closed_again_and_doors_that_fail_hold_the_train() -> None:
    world = with_open_doors()
    world.dwell_left_ds = 0
    world.run(160_000 - 3000 - world.now_ms)
    assert world.stations.state is AtoState.CLOSING
    for door, state in (
        (DoorState.CLOSING, AtoState.CLOSING),
        (DoorState.OBSTRUCTED, AtoState.REOPEN),
        (DoorState.OPEN, AtoState.REOPEN),
        (DoorState.CLOSING, AtoState.CLOSING),
    ):
        world.door = door
        world.run(100)
        assert (world.stations.state, world.stations.order) == (state, DoorOrder.CLOSE)
    world.reopened, world.door = 4, DoorState.FAULT
    world.run(100_000)
    assert world.stations.state is AtoState.DOOR_FAULT
    world.door = DoorState.LOCKED
    world.run(40)
    assert world.stations.state in (AtoState.READY, AtoState.DOOR_FAULT)


@pytest.mark.parametrize("lost", ["tells_doors", "tells_info"])
def test_no_door_is_ordered_without_telegrams(lost: str) -> None:
    world = World()
    world.leave()
    setattr(world, lost, False)
    world.run(2000)
    world.stand_at(STOP_01MM)
    world.run(5000)
    assert (world.stations.order, world.stations.state) == (DoorOrder.NONE, AtoState.UNLOCK)
    setattr(world, lost, True)
    world.run(100)
    assert world.stations.order is DoorOrder.OPEN_LEFT


def test_in_motion_lost_telegrams_change_nothing() -> None:
    world = World()
    world.leave()
    world.tells_doors = world.tells_info = False
    world.run(60_000)
    assert (world.stations.state, world.stations.drive) == (AtoState.RUN, Drive.LAW)


def test_the_terminal_keeps_its_doors_open() -> None:
    world = with_closed_doors()
    world.run(1000)
    world.here, world.speed_01mmps = 0, 100_000
    world.run(1000)
    world.side = DoorSide.RIGHT
    world.stand_at(20_000_000, here=4)
    world.run(1000)
    assert world.stations.order is DoorOrder.OPEN_RIGHT
    world.door = DoorState.OPEN
    world.run(60_000)
    assert (world.stations.state, world.stations.order) == (AtoState.ENDED, DoorOrder.NONE)


def test_a_telegram_without_a_correct_check_or_a_new_life_sign_is_not_used() -> None:
    stations = World().stations
    stations.take_doors(DoorStat(in_window=flag(True), check=CHECK_ERRONEOUS, life=1), 0)
    assert stations.doors is None
    stations.take_doors(DoorStat(in_window=flag(True), life=2), 0)
    stations.take_doors(DoorStat(in_window=flag(False), life=2), 40)
    assert stations.doors is not None
    assert stations.doors.in_window == flag(True)


def test_a_node_that_comes_late_to_open_doors_closes_them_for_the_departure() -> None:
    world = World()
    world.here, world.door, world.now_ms, world.place_01mm = 3, DoorState.OPEN, 140_000, STOP_01MM
    world.run(100)
    assert (world.stations.state, world.stations.stop) == (AtoState.OPEN, 1)
    world.run(18_000)
    assert world.stations.state is AtoState.CLOSING


FIELDS = {
    "speed_01mmps": st.sampled_from((0, 0, 0, 3, 3000, 60_000)),
    "place_01mm": st.sampled_from((0, STOP_01MM - 600_000, STOP_01MM - 20_000, STOP_01MM - 300, STOP_01MM + 4000,
                                   STOP_01MM + 9000, 20_000_000)),
    "here": st.sampled_from((0, 1, 3, 3, 4)),
    "side": st.sampled_from(tuple(DoorSide)),
    "in_window": st.booleans(),
    "door": st.sampled_from(tuple(DoorState)),
    "permit": st.booleans(),
    "is_sound": st.booleans(),
    "dwell_left_ds": st.sampled_from((0, 0, 100)),
    "reopened": st.sampled_from((0, 1, 4)),
    "signal": st.sampled_from((0, 1, 2)),
    "tells_doors": st.sampled_from((True, True, False)),
    "tells_info": st.sampled_from((True, True, False)),
}  # fmt: skip
CHANGES = st.lists(
    st.tuples(st.sampled_from(sorted(FIELDS)).flatmap(lambda key: st.tuples(st.just(key), FIELDS[key])),
              st.sampled_from((20, 300, 1500, 12_000))),
    max_size=40,
)  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(CHANGES)
def test_no_sequence_orders_doors_or_a_departure_that_is_not_safe(
    changes: list[tuple[tuple[str, object], int]],
) -> None:
    world = World()
    world.run(1000)
    heard_ms = {"tells_doors": 0, "tells_info": 0}
    for (key, value), time_ms in changes:
        setattr(world, key, value)
        for _ in range(min(time_ms, 40_000) // 20):
            before, stood = world.stations.state, world.speed_01mmps == 0
            heard_ms |= {key: world.now_ms for key in heard_ms if getattr(world, key)}
            now_ms = world.now_ms
            world.tick()
            stations = world.stations
            is_fresh = all(now_ms - at_ms <= 1000 for at_ms in heard_ms.values())
            if stations.order:
                assert stood
                assert is_fresh
                assert stations.station == stations.here.number
                assert stations.holds
            if stations.order in OPENS:
                assert abs(world.place_01mm - stations.here.position_01mm) <= 5000
                assert OPENS[stations.order] is stations.here.side
                assert stations.doors is not None
                assert stations.doors.in_window == flag(True)
                assert stations.info is not None
                assert (stations.info.station_here, stations.info.platform_side) == (
                    stations.station,
                    stations.here.side,
                )
            if stations.departed:
                assert before in (AtoState.READY, AtoState.TURN_BACK)
                assert stood
                assert is_fresh
                assert now_ms % PERIOD_MS == 0
                assert stations.doors is not None
                assert stations.doors.doors_locked == stations.doors.psd_locked == flag(True)
                assert stations.info is not None
                assert stations.info.depart_permit == flag(True)
                assert world.is_sound
            assert stations.holds == (stations.drive is Drive.NONE)
            assert 0 <= stations.stop < len(world.rules.stops)
            assert stations.counters["jogs"] <= 2 * len(world.rules.stops)


@pytest.mark.parametrize(
    ("told", "here", "order"),
    [
        (ModeOrder.ECONOMY, 3, ModeOrder.ECONOMY),
        (ModeOrder.FAST, 3, ModeOrder.FAST),
        (ModeOrder.ECONOMY, 4, ModeOrder.TIMETABLE),
        (5, 3, ModeOrder.TIMETABLE),
    ],
)
def test_an_order_of_the_track_side_counts_for_this_stop_and_if_it_has_a_meaning(
    told: int, here: int, order: ModeOrder
) -> None:
    world = at_stop()
    world.run(1000)
    world.mode, world.here = told, here
    world.run(100)
    assert world.stations.mode_order is order
