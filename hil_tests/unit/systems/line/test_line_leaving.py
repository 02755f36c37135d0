"""A train that leaves a stop without a departure, or towards a red signal, or that passes one: found in the record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from hil_tests.support.line_records import Told, drive, driven_run, milestones_in, trace_of
from hil_tests.support.lines import LIMITS, OUT_AND_BACK, STOPS, Driver, four_stops, make_leg
from railhil.bus.layout import FLAG_FALSE
from railhil.bus.telegrams import RunEvent
from railhil.systems.line.judge.score import score
from railhil.systems.line.scenario.model import LineScenario, RouteSignal
from railhil.wire.ato import SimTruth
from railhil.wire.line import DoorStat, SignalAspect, StnInfo

#: The second stop is on a grade of 20 per mille.
GRADES = ((-118.0, 0.0), (60.0, -20.0), (300.0, 0.0))


@cache
def line() -> LineScenario:
    """A line of 342 m without train protection."""
    stops = [replace(stop, position_m=stop.position_m * 0.1) for stop in STOPS]
    stops[1] = replace(stops[1], arrive_s=50.0, depart_s=80.0)
    stops[3] = replace(stops[3], arrive_s=200.0)
    made = tuple(stops)
    found = four_stops(stops=made, legs=(make_leg(0, made, GRADES, LIMITS),))
    return replace(found, atp=replace(found.atp, enabled=False))


def left_without(found: LineScenario, told: tuple[Told, ...]) -> list[str]:
    """What the score says of invariant 11."""
    return [said for said in score(found, trace_of(found, told)).failures if said.startswith("invariant 11")]


class Rolling:
    """Drives to the second stop; there the train rolls for so many metres when something is true, and is caught."""

    def __init__(self, begins: Callable[[Driver], bool], for_m: float, stand_m: float = 120.0) -> None:
        self._begins, self._for_m, self._stand_m = begins, for_m, stand_m
        self._from_m: float | None = None
        self.is_over = False

    def act(self, driver: Driver) -> None:
        train = driver.train
        place_m = train.position_01mm / 1e4
        if place_m > 5.0 and train.journey.section == 0 and self._from_m is None:
            driver.aim_m = self._stand_m
        if self._from_m is None and self._begins(driver):
            self._from_m = place_m
            driver.notch = lambda: 0.0  # type: ignore[method-assign]
            train.holding.share = 0.0
        if self._from_m is not None and place_m - self._from_m >= self._for_m:
            train.holding.share = 1.0
            train._motion = train._motion._replace(speed_mps=0.0, accel_mps2=0.0)
            self.is_over = True


def reports_creep(found: LineScenario, told: tuple[Told, ...]) -> bool:
    return bool(milestones_in(told, "jog", found))


def test_a_train_that_rolls_with_open_doors_is_named_although_it_reports_a_creep() -> None:
    rolling = Rolling(lambda driver: "doors_open" in driver.kinds(), 3.0)
    told, _ = drive(line(), rolling.act, lambda _: rolling.is_over)
    assert reports_creep(line(), told)
    (said,) = left_without(line(), told)
    assert said.startswith("invariant 11: the train moved 3."), said


def test_a_roll_with_open_doors_is_no_creep_and_the_stop_error_is_that_of_the_standstill_before() -> None:
    rolling = Rolling(lambda driver: "doors_open" in driver.kinds(), 3.0)
    told, _ = drive(line(), rolling.act, lambda _: rolling.is_over)
    stop = score(line(), trace_of(line(), told)).stops[1]
    assert stop.standstill is not None
    assert abs(stop.standstill.position_m - 120.0) < 0.5
    assert stop.jogs == 0


def test_a_train_that_rolls_on_far_before_its_stop_is_named_although_it_reports_a_creep() -> None:
    """It has stood there for 10 s, and counts as arrived."""
    rolling = Rolling(lambda driver: "arrived" in driver.kinds(), 3.0, stand_m=100.0)
    told, _ = drive(line(), rolling.act, lambda _: rolling.is_over)
    assert reports_creep(line(), told)
    (said,) = left_without(line(), told)
    assert said.startswith("invariant 11: the train moved 3."), said


def test_a_train_that_rolls_beyond_its_stop_is_named_although_it_reports_a_creep() -> None:
    rolling = Rolling(lambda driver: "arrived" in driver.kinds(), 5.5, stand_m=116.5)
    told, _ = drive(line(), rolling.act, lambda _: rolling.is_over)
    assert reports_creep(line(), told)
    (said,) = left_without(line(), told)
    assert said.startswith("invariant 11: the train moved 5."), said


def test_a_train_that_creeps_to_its_stop_has_not_left_it() -> None:
    def act(driver: Driver) -> None:
        if driver.train.journey.section == 0:
            driver.aim_m = 120.0 if "arrived" in driver.kinds() else 116.5

    told, _ = drive(line(), act, lambda driver: "doors_locked" in driver.kinds())
    assert reports_creep(line(), told)
    assert left_without(line(), told) == []


# -- red signals ------------------------------------------------------------------------------------------------------

LINE, TOLD = driven_run(short=True)
#: On the way from stop 2 at 120 m to the terminal, clear by the timetable.
SIGNAL_M = 250.0
SIGNALLED = replace(LINE, signals=(RouteSignal(SIGNAL_M, 0.0),))


def seen(red: Callable[[float, float], bool]) -> list[str]:
    """What the invariants say of a run whose STN_INFO show a red signal as a fault sets it.

    :param red: whether, by time in s and place of the front in m.
    """
    truth = [(one.time_ns, SimTruth.decode(one.data).position_01mm / 1e4) for one in TOLD if one.port == "SIM_TRUTH"]
    times_ns, places_m = zip(*truth, strict=True)

    def change(told: Told) -> Told:
        if told.port != StnInfo.PORT:
            return told
        place_m = float(np.interp(told.time_ns, times_ns, places_m))
        aspect = SignalAspect.NONE
        if place_m <= SIGNAL_M:
            aspect = SignalAspect.RED if red(told.time_ns / 1e9, place_m) else SignalAspect.CLEAR
        return told._replace(data=replace(StnInfo.decode(told.data), signal_next=aspect).encode())

    failures = score(SIGNALLED, trace_of(SIGNALLED, map(change, TOLD))).failures
    return [said for said in failures if said.startswith("invariant")]


def departed_s() -> float:
    number = milestones_in(TOLD, "departure", LINE)[1]
    events = [RunEvent.decode(one.data) for one in TOLD if one.port == RunEvent.PORT]
    return next(one.instant_01ms / 1e4 for one in events if one.number == number)


def test_a_signal_that_a_fault_has_set_to_red_is_not_passed() -> None:
    (said,) = seen(lambda time_s, place_m: place_m > 125.0)
    assert said.startswith("invariant 9: the front was at 3")
    assert "supervised location 270.00 m behind a signal that showed red from 8" in said


def test_a_signal_that_is_clear_again_may_be_passed() -> None:
    assert seen(lambda time_s, place_m: 125.0 < place_m < 240.0) == []
    assert seen(lambda time_s, place_m: False) == []


def test_a_signal_that_falls_to_red_right_before_the_train_cannot_be_obeyed() -> None:
    assert seen(lambda time_s, place_m: place_m > 235.0) == []


def test_a_train_does_not_leave_towards_a_signal_that_a_fault_holds_red() -> None:
    at_s = departed_s()
    (said,) = seen(lambda time_s, place_m: at_s - 5.0 < time_s < at_s + 0.5)
    assert said == f"invariant 11: the train left stop 2 B at {at_s:.2f} s towards a red signal"
    assert seen(lambda time_s, place_m: at_s - 5.0 < time_s < at_s) == []
    assert seen(lambda time_s, place_m: at_s < time_s < at_s + 0.5) == []


def test_a_train_does_not_leave_while_a_fault_holds_its_exit_red() -> None:
    at_s = departed_s()

    def said(is_red: Callable[[float], bool], scenario: LineScenario = LINE) -> list[str]:
        changed = [
            one._replace(data=replace(StnInfo.decode(one.data), signal_next=SignalAspect.RED).encode())
            if one.port == StnInfo.PORT and is_red(one.time_ns / 1e9)
            else one
            for one in TOLD
        ]
        failures = score(scenario, trace_of(scenario, changed)).failures
        return [one for one in failures if one.startswith("invariant")]

    wanted = [f"invariant 11: the train left stop 2 B at {at_s:.2f} s while its exit was red"]
    assert said(lambda time_s: at_s - 5.0 < time_s < at_s + 0.5) == wanted
    assert said(lambda time_s: at_s - 5.0 < time_s < at_s) == []
    assert said(lambda time_s: at_s < time_s < at_s + 0.5) == []
    # A signal behind the section's end that is red is none of the departure, one that cannot be red is.
    beyond = replace(LINE, signals=(RouteSignal(360.0, at_s + 9.0),))
    assert said(lambda time_s: at_s - 5.0 < time_s < at_s + 0.5, beyond) == []
    assert (
        said(lambda time_s: at_s - 5.0 < time_s < at_s + 0.5, replace(beyond, faults=("signal red only 1 @1s",))) == []
    )
    clear = replace(LINE, signals=(RouteSignal(360.0, 0.0),), faults=("signal red @1s",))
    assert said(lambda time_s: at_s - 5.0 < time_s < at_s + 0.5, clear) == wanted


def test_a_platform_on_the_way_whose_doors_are_not_locked_is_not_passed() -> None:
    stops = list(LINE.stops)
    (passed,) = (number for number, stop in enumerate(stops) if stop.service == "pass")
    stops[passed] = replace(stops[passed], psd=True)
    found = replace(LINE, stops=tuple(stops), train=replace(LINE.train, length_m=20.0))
    truth = [(one.time_ns, SimTruth.decode(one.data).position_01mm / 1e4) for one in TOLD if one.port == "SIM_TRUTH"]
    times_ns, places_m = zip(*truth, strict=True)

    def said(is_unlocked: Callable[[float], bool]) -> list[str]:
        changed = [
            one._replace(data=replace(DoorStat.decode(one.data), psd_locked=FLAG_FALSE).encode())
            if one.port == DoorStat.PORT and is_unlocked(float(np.interp(one.time_ns, times_ns, places_m)))
            else one
            for one in TOLD
        ]
        failures = score(found, trace_of(found, changed)).failures
        return [one for one in failures if one.startswith("invariant")]

    (breach,) = said(lambda place_m: 125.0 < place_m < 290.0)
    assert breach.startswith("invariant 9: the front was at 3")
    assert "supervised location 230.00 m behind the beginning of a platform with doors shown unlocked from" in breach
    assert said(lambda place_m: 125.0 < place_m < 200.0) == []
    assert said(lambda place_m: 208.0 < place_m < 290.0) == []


def test_a_train_does_not_leave_a_turn_back_towards_a_red_signal_of_the_way_back() -> None:
    """Standing there it has the number of the leg on which it came, and sees the signals of the next one."""
    stops = tuple(replace(stop, position_m=stop.position_m * 0.1) for stop in OUT_AND_BACK)
    stops = (stops[0], replace(stops[1], arrive_s=50.0, depart_s=80.0), replace(stops[2], arrive_s=130.0))
    legs = tuple(make_leg(number, stops, ((-118.0, 0.0),), ((-118.0, 60 / 3.6),)) for number in (0, 1))
    found = four_stops(stops=stops, legs=legs, signals=(RouteSignal(200.0, 0.0, 1),))
    told, _ = drive(found)
    number = milestones_in(told, "departure", found)[1]
    events = [RunEvent.decode(one.data) for one in told if one.port == RunEvent.PORT]
    at_s = next(one.instant_01ms / 1e4 for one in events if one.number == number)

    def said(is_red: Callable[[float], bool]) -> list[str]:
        changed = [
            one._replace(data=replace(StnInfo.decode(one.data), signal_next=SignalAspect.RED).encode())
            if one.port == StnInfo.PORT and is_red(one.time_ns / 1e9)
            else one
            for one in told
        ]
        failures = score(found, trace_of(found, changed)).failures
        return [one for one in failures if one.startswith("invariant")]

    assert said(lambda time_s: abs(time_s - at_s) < 0.5) == [
        f"invariant 11: the train left stop 2 B at {at_s:.2f} s towards a red signal"
    ]
    assert said(lambda time_s: at_s - 0.5 < time_s < at_s) == []
    assert said(lambda time_s: False) == []
