"""Plausibility of TRN_POS, telegram by telegram, and the odometer reading to which a balise telegram refers."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.controller_node.ato.balises import Balises
from railhil.controller_node.ato.control_loop import NO_BALISE
from railhil.controller_node.ato.odometer import Odometer
from railhil.controller_node.laws.base import BaliseReading
from railhil.scenarios.load import load
from railhil.wire.ato import BalisePassed, CtlCause, TrnPos

SCENARIO = load("lvshun_tieshan")
MS = 1_000_000
CRUISE_01MMPS = 180_000


class Ride:
    """A train at constant speed from 0: a speed every 10 ms, TRN_POS every 20 ms unless it is left out or changed."""

    def __init__(self, speed_01mmps: int = CRUISE_01MMPS) -> None:
        self.odometer = Odometer(SCENARIO, needed=True)
        self.speed_01mmps = speed_01mmps
        self.tick = -1

    @property
    def now_ns(self) -> int:
        return self.tick * 10 * MS

    @property
    def true_mm(self) -> int:
        return self.speed_01mmps * self.tick // 1000

    def go(self, ticks: int, off_mm: int | None = 0, **changed: int) -> None:
        """Further ticks; ``off_mm`` what the odometer is off by, None for no telegram."""
        for _ in range(ticks):
            self.tick += 1
            self.odometer.speed(self.speed_01mmps, self.now_ns)
            if self.tick % 2 == 0 and off_mm is not None:
                telegram = TrnPos(self.true_mm + off_mm, life=self.tick // 2 % 16)
                self.odometer.position(replace(telegram, **changed), self.now_ns)

    @property
    def off_01mm(self) -> int:
        """What the law is given, beside the truth."""
        return self.odometer.at(self.now_ns) - 10 * self.true_mm

    @property
    def lost(self) -> bool:
        return self.odometer.lost(self.now_ns) is not CtlCause.NONE


@pytest.fixture
def ride() -> Ride:
    started = Ride()
    started.go(201)
    assert started.off_01mm == 0
    return started


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        ({"off_mm": None}, None),
        ({"check": 0}, "position_check"),
        ({"check": 3, "off_mm": -9_000_000}, "position_check"),
        ({"off_mm": -20_000}, "position_jump"),
        ({"off_mm": 20_000}, "position_jump"),
        ({"off_mm": 2**31 - 5_000_000}, "position_jump"),
        ({"life": 4}, "position_duplicate"),
    ],
)
def test_a_second_on_the_reckoned_position_and_then_lost(ride: Ride, fault: dict[str, int], cause: str | None) -> None:
    for tick in range(1, 301):
        ride.go(1, **fault)
        # Between two telegrams the odometer is up to 20 ms old.
        assert abs(ride.off_01mm) <= CRUISE_01MMPS // 50
        assert ride.lost == (tick > 100)
    lost = CtlCause.POSITION_IMPLAUSIBLE if cause == "position_jump" else CtlCause.POSITION_LOST
    assert ride.odometer.lost(ride.now_ns) is lost
    assert ride.odometer.counters == ({cause: 150} if cause else {})
    # Ten telegrams in a row that fit, and it counts again; the first of them come with old life signs.
    fitted = 0
    while ride.lost:
        ride.go(2)
        fitted += 1
    assert 10 <= fitted <= 10 + 8
    assert ride.off_01mm == 0


@pytest.mark.parametrize(("missing", "is_used"), [(1, True), (2, False)])
def test_one_missing_telegram_ends_no_row_and_two_do(ride: Ride, missing: int, is_used: bool) -> None:
    ride.go(2 * missing, off_mm=None)
    ride.go(2, off_mm=50)
    assert (ride.off_01mm == 500) is is_used


@given(lags=st.lists(st.integers(0, 2), min_size=300, max_size=300))
def test_a_node_whose_time_is_late_by_no_more_than_the_hold_age_keeps_its_position(lags: list[int]) -> None:
    """It tells its time by TRN_SPEED, which may be up to 20 ms old without a reaction."""
    odometer, now_ns = Odometer(SCENARIO, needed=True), 0
    for tick, lag in enumerate(lags):
        now_ns = max(now_ns, (tick - lag) * 10 * MS)
        odometer.speed(CRUISE_01MMPS, now_ns)
        if tick % 2 == 0:
            odometer.position(TrnPos(CRUISE_01MMPS * tick // 1000, life=tick // 2 % 16), now_ns)
        assert odometer.lost(now_ns) is CtlCause.NONE
    assert odometer.counters == {}
    assert odometer._run == 10


# -- balises ----------------------------------------------------------------------------------------------------------


def passed(number: int, odometer_mm: int, check: int = 1) -> BalisePassed:
    return BalisePassed(number, 1000 * number, odometer_mm & 0xFFFF, check=check)


def test_every_passing_within_reach_is_placed_exactly() -> None:
    """Balise 1 was repeated every 3.6 m, the last time before balise 2; that one's telegram comes later and later."""
    at_mm = 1_234_567
    for late_mm in range(-300, 70_000, 97):
        balises = Balises()
        for heard_mm in range(0, at_mm, 3600):
            balises.take(passed(1, 0), 10 * heard_mm, 4000)
        balises.take(passed(2, at_mm), 10 * (at_mm + late_mm), 4000)
        silent_mm = at_mm + late_mm - heard_mm
        used = silent_mm + 2 * 401 < 0x10000
        assert balises.last == (BaliseReading(2, 20_000, 10 * at_mm) if used else BaliseReading(1, 10_000, 0))
        assert balises.counters == ({} if used else {"balise_late": 1})
        # Repeated: nothing new, and no second chance.
        balises.take(passed(2, at_mm), 10 * (at_mm + late_mm + 3600), 4000)
        assert balises.last.number == 1 + used


def test_a_passing_outside_of_the_stretch_is_refused() -> None:
    balises = Balises()
    balises.take(passed(1, 100_000), 1_000_100, 4000)
    balises.take(passed(1, 100_000), 1_036_000, 4000)
    for wrong_mm in (103_600 - 2000, 107_200 + 2000):
        balises.take(passed(9, wrong_mm), 1_072_000, 0)
        assert balises.last.number == 1
        balises.take(passed(1, 100_000), 1_036_000, 4000)
    assert balises.counters == {"balise_late": 2}


@pytest.mark.parametrize(
    ("telegram", "cause"),
    [(passed(0, 5_000), "balise_number"), *((passed(3, 0, c), "balise_check") for c in (0, 2, 3))],
)
def test_a_telegram_that_says_nothing_is_not_used(telegram: BalisePassed, cause: str) -> None:
    balises = Balises()
    balises.take(telegram, 50_000, 1000)
    assert balises.last == NO_BALISE
    assert balises.counters == {cause: 1}


def test_balises_under_the_waiting_train() -> None:
    """All are read before it moves, also those behind its front; what lies before the start is where it is."""
    balises = Balises()
    for number, at_mm in ((1, -40_000), (2, -5_000), (3, 0)):
        balises.take(passed(number, at_mm), 0, 1100)
        assert balises.last == BaliseReading(number, 10_000 * number, 10 * at_mm)
    assert balises.counters == {}


@settings(max_examples=300)
@given(
    at_mm=st.integers(0, 12_000_000),
    wheel=st.integers(-12_500, 12_500),
    survey_mm=st.integers(-500, 500),
    late_mm=st.integers(0, 400_000),
    more=st.lists(st.integers(0, 3_000_000), max_size=3),
)
def test_a_balise_is_placed_where_it_was_passed_or_not_used(
    at_mm: int, wheel: int, survey_mm: int, late_mm: int, more: list[int]
) -> None:
    """After a silence of the port nobody knows of, on any wheel and survey that the laws believe."""
    balises = Balises()
    for number, since_mm in enumerate([0, *more], 1):
        at_mm += since_mm
        # The error of a wheel is a share of the distance by the odometer.
        surveyed_mm = at_mm + at_mm * wheel // 1_000_000 + survey_mm
        told = BalisePassed(number, surveyed_mm, at_mm & 0xFFFF)
        at_mm += late_mm
        balises.take(told, 10 * at_mm, 4000)
        if balises.last.number == number:
            assert balises.last.odometer_01mm == 10 * (at_mm - late_mm)
        late_mm = 0


def test_a_first_balise_near_the_start_is_always_used() -> None:
    for at_mm in range(0, 2_500_000, 49_999):
        for wheel in (0.9876, 1.0, 1.0124):
            balises = Balises()
            balises.take(BalisePassed(1, round(at_mm / wheel), at_mm & 0xFFFF), 10 * at_mm, 4000)
            assert balises.last.odometer_01mm == 10 * at_mm, (at_mm, wheel)


def test_a_balise_says_nothing_to_a_train_without_a_position() -> None:
    """A controller that has just been started again: TRN_POS comes after BALISE."""
    odometer, balises = Odometer(SCENARIO, needed=True), Balises()
    odometer.speed(CRUISE_01MMPS, 0)
    balises.take(BalisePassed(3, 6_000_000, 6_000_000 & 0xFFFF), *odometer.reckoned(0))
    assert balises.last == NO_BALISE
    assert balises.counters == {"balise_late": 1}


def test_beyond_a_place_for_certain() -> None:
    """By the last balise that a worn wheel explains, with 1.25 % of the way since then and 0.5 m of survey."""
    balises = Balises()
    place_01mm = 10_000_0000
    assert not balises.is_beyond(place_01mm + 1_260_000, place_01mm)
    assert balises.is_beyond(place_01mm + 1_280_000, place_01mm)
    balises.take(BalisePassed(9, 9_890_000, 9_940_000 & 0xFFFF), 9_940_0000, 1)
    for number, surveyed_mm in ((1, 9_900_000), (2, 9_800_000)):
        balises.take(BalisePassed(number, surveyed_mm, 9_950_000 & 0xFFFF), 9_950_0000, 1)
        assert not balises.is_beyond(10_051_0000, place_01mm)
        assert balises.is_beyond(10_052_0000, place_01mm)


def test_a_law_without_a_position_is_not_stopped_by_a_long_way() -> None:
    """Beyond 200 km only what a law would get is limited: readings and dead reckoning stay together."""
    ride = Ride(1_000_000)
    ride.odometer = Odometer(SCENARIO, needed=False)
    ride.tick = 199_901
    for ticks in range(1, 400):
        ride.go(1)
        place_01mm, tolerance_01mm = ride.odometer.reckoned(ride.now_ns)
        assert not ride.lost, ticks
        assert abs(place_01mm - min(10 * ride.true_mm, 2_000_000_000)) <= tolerance_01mm
    assert ride.odometer.counters == {}
    assert ride.true_mm > 200_000_000
    assert ride.odometer.at(ride.now_ns) == 2_000_000_000
