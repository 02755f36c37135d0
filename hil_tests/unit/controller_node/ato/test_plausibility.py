"""The checks of the measured speed: at their limits, and against trains that do not do what they are told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from railhil.controller_node.ato.guard import Guard
from railhil.controller_node.ato.odometer import Odometer
from railhil.controller_node.ato.plausibility import MotionLimits
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Effort
from railhil.wire.ato import CtlCause, TrkInfo, TrnPos, TrnSpeed, WatchLevel

SCENARIO = load("lvshun_tieshan")
LIMITS = MotionLimits.of(SCENARIO)
MS = 1_000_000
TRACTION_CUT, SERVICE_BRAKE, EMERGENCY = (
    WatchLevel.TRACTION_CUT,
    WatchLevel.SERVICE_BRAKE,
    WatchLevel.EMERGENCY,
)


class Ride:
    """A guard on a train with any acceleration: a speed every 10 ms, a position and a poll every 20 ms.

    ``accel`` 0.1 mm/s2; ``law`` the law's notch code; ``scale`` of the measured speed, permil.
    """

    def __init__(self, speed_01mmps: int = 150_000, scenario: Any = SCENARIO, grade: int | None = 0) -> None:
        self.odometer = Odometer(scenario)
        self.guard = Guard(scenario, odometer=self.odometer)
        self.tick = 0
        self.speed = speed_01mmps * 1000
        self.place = 0
        self.scale = 1000
        self.held: int | None = None
        self.sent = 0
        if grade is not None:
            self.guard.limit(TrkInfo(speed_limit_4mmps=60_000, grade_001permil=grade), 0)

    @property
    def now_ns(self) -> int:
        return self.tick * 10 * MS

    def go(self, ticks: int, accel: int = 0, law: int = 0, *, until: WatchLevel | None = None) -> int:
        """Further ticks, at most to a level; returns how many passed."""
        for passed in range(ticks):
            # The sensor is never quite still, unless it is stuck.
            reading = self.held if self.held is not None else self.speed // 1000 * self.scale // 1000 + self.tick % 2
            self.guard.speed(TrnSpeed(reading, life=self.tick % 16), self.now_ns)
            if self.tick % 2 == 0:
                self.odometer.position(TrnPos(self.place // 10**6, life=self.tick // 2 % 16), self.now_ns)
                self.sent = self.guard.notch(law, self.now_ns)[0]
            if until is not None and self.guard.level >= until:
                return passed
            self.place += self.speed + accel * 5
            self.speed = max(self.speed + accel * 10, 0)
            self.tick += 1
        return ticks

    @property
    def found(self) -> tuple[WatchLevel, CtlCause]:
        return self.guard.level, self.guard.cause


def steady(law: int, speed_01mmps: int = 150_000) -> int:
    """Acceleration of the nominal train with a notch that has acted for long, on the level."""
    force = max(min(law * LIMITS.notch_01mmps2 // 256, LIMITS.traction_01mmps2), -LIMITS.brake_01mmps2)
    return force - LIMITS.davis_a


def test_numbers_of_the_scenario() -> None:
    train = SCENARIO.train
    mass_kg = train.inertial_mass_kg
    assert LIMITS.jump_01mmps == 500 + round((0.01 + 12 * 0.01) / 3.6 * 1e4)
    assert LIMITS.accel_01mmps2 == 20_000
    assert LIMITS.notch_01mmps2 == 2088
    assert LIMITS.brake_01mmps2 == round(270e3 / mass_kg * 1e4)
    assert LIMITS.traction_01mmps2 == round(215e3 / mass_kg * 1e4)
    assert LIMITS.weak_traction_01mmps2 == round(2550e3 / 22 / mass_kg * 1e4)
    # Davis at 20 m/s, in N/kN of weight.
    wanted = (2.0 + 0.008 * 72 + 0.00045 * 72**2) * 211 * 9.81 / mass_kg * 1e4
    v = 200_000
    found = LIMITS.davis_a + (LIMITS.davis_b_q20 * v >> 20) + (LIMITS.davis_c_q40 * v * v >> 40)
    assert found == pytest.approx(wanted, abs=2)
    assert 1000 * LIMITS.grade_q16 / 65536 == pytest.approx(9.81 / 1.06 * 0.01 * 1e4, rel=1e-3)
    strong = replace(train, brake=Effort(1e6))
    assert MotionLimits.of(replace(SCENARIO, train=strong)).accel_01mmps2 == round(1.5e10 / mass_kg)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_speed_no_train_can_have_is_refused(sign: int) -> None:
    """At the limit of every time since the last one; what is refused is not used."""
    for elapsed_ms in (0, 1, 10, 20, 50, 300):
        largest = LIMITS.jump_01mmps + 20_000 * max(elapsed_ms, 10) // 1000
        for change in (largest, largest + 1):
            guard = Guard(SCENARIO)
            guard.speed(TrnSpeed(100_000, life=1), 50 * MS)
            guard.speed(TrnSpeed(100_000 + sign * change, life=2), (50 + elapsed_ms) * MS)
            fits = change == largest
            assert guard.speed_01mmps == 100_000 + sign * change * fits
            assert guard.counters == ({} if fits else {"speed_jump": 1})
            if not fits and elapsed_ms <= 20:
                assert (guard.level, guard.cause) == (WatchLevel.HOLD, CtlCause.SPEED_IMPLAUSIBLE)


def test_garbage_cuts_traction_at_the_third() -> None:
    ride = Ride()
    ride.go(100, law=500)
    ride.held = 10_000
    assert ride.go(50, law=500, until=TRACTION_CUT) == 2
    assert ride.found == (TRACTION_CUT, CtlCause.SPEED_IMPLAUSIBLE)


@pytest.mark.parametrize("accel", [40_000, -60_000])
def test_slip_gives_no_more_traction_and_slide_keeps_the_brake(accel: int) -> None:
    law = 500 if accel > 0 else -500
    ride = Ride()
    ride.go(101, law=law)
    assert ride.go(50, accel, law, until=WatchLevel.HOLD) <= 15
    assert ride.found == (WatchLevel.HOLD, CtlCause.SPEED_IMPLAUSIBLE)
    ride.go(2, accel, law + 300)
    assert ride.sent <= law
    # When the wheels roll again, 5 good telegrams give the notch back.
    ride.speed = 150_000_000
    ride.go(100, 0, law)
    assert ride.guard.level is WatchLevel.NORMAL


@pytest.mark.parametrize("notches", [2, 4, -2, -4])
def test_a_stuck_reading_is_found_in_half_a_second(notches: int) -> None:
    """From 0.3 m/s2 on; before, it changes with what the sensor has of noise."""
    law = notches * 256
    ride = Ride(grade=None)
    accel = steady(law)
    assert abs(accel) > 3000
    ride.go(1200, 0, law)
    assert ride.guard.level is WatchLevel.NORMAL
    ride.held = ride.speed // 1000
    assert ride.go(100, accel, law, until=TRACTION_CUT) <= 50
    assert ride.found == (TRACTION_CUT, CtlCause.SPEED_IMPLAUSIBLE)
    # It ends with the first change and five good telegrams.
    ride.speed, ride.held = ride.held * 1000, None
    ride.go(40, accel // 20, law)
    assert ride.guard.level is WatchLevel.NORMAL


def test_a_reading_of_a_standing_or_coasting_train_may_stay() -> None:
    standing = Ride(0)
    standing.held = 0
    standing.go(500, law=300)
    assert standing.guard.level is WatchLevel.NORMAL
    # In balance: nothing is due.
    coasting = Ride(grade=-round(LIMITS.davis_a * 65536 / LIMITS.grade_q16))
    coasting.speed = 10_000_000
    coasting.held = 10_000
    coasting.go(200)
    assert coasting.guard.level is WatchLevel.NORMAL


@pytest.mark.parametrize(("scale", "is_found"), [(1000, False), (980, False), (1020, False), (950, True), (1050, True)])
def test_speed_and_odometer_disagree(scale: int, is_found: bool) -> None:
    """At 3 m/s; a train that is faster is found by the position, see below."""
    ride = Ride(30_000)
    ride.scale = scale
    passed = ride.go(1200, until=TRACTION_CUT)
    assert ride.found == ((TRACTION_CUT, CtlCause.SPEED_IMPLAUSIBLE) if is_found else (WatchLevel.NORMAL, 0))
    assert not is_found or 500 <= passed <= 600


def test_a_wrong_scale_at_speed_is_an_implausible_position() -> None:
    ride = Ride()
    ride.go(700)
    # The scale comes on slowly enough to be no jump.
    for ride.scale in range(1000, 950, -1):
        ride.go(2)
    assert ride.go(300, until=SERVICE_BRAKE) < 300
    assert ride.found == (SERVICE_BRAKE, CtlCause.POSITION_IMPLAUSIBLE)


def test_a_silent_position_says_nothing_of_the_speed() -> None:
    ride = Ride(30_000)
    ride.scale = 950
    ride.go(300)
    ride.odometer.position = lambda *given: None  # type: ignore[method-assign]
    ride.go(1000)
    assert ride.guard.level is WatchLevel.NORMAL


@pytest.mark.parametrize(("share", "is_found"), [(100, False), (70, False), (25, True), (0, True)])
def test_a_brake_that_does_not_answer(share: int, is_found: bool) -> None:
    """Percent of the braking demanded with -4 notches: first more brake, then the emergency brake."""
    law = -4 * 256
    ride = Ride(300_000)
    force = 0.0
    for _ in range(700):
        force += (law * LIMITS.notch_01mmps2 / 256 - force) * 0.34 / 100
        speed = ride.speed // 1000
        against = LIMITS.davis_a + (LIMITS.davis_b_q20 * speed >> 20) + (LIMITS.davis_c_q40 * speed * speed >> 40)
        accel = round(force * share / 100) - against
        ride.go(1, accel, law)
        if ride.guard.level is not WatchLevel.NORMAL:
            break
    if not is_found:
        assert ride.guard.level is WatchLevel.NORMAL
        return
    assert ride.found == (SERVICE_BRAKE, CtlCause.BRAKE_NOT_ANSWERING)
    assert ride.go(300, accel, law, until=EMERGENCY) <= 111
    assert ride.found == (EMERGENCY, CtlCause.BRAKE_NOT_ANSWERING)


def test_a_share_of_nothing_switches_the_check_of_the_brake_off() -> None:
    free = replace(SCENARIO, watch=replace(SCENARIO.watch, brake_share_min_percent=0.0))
    ride = Ride(scenario=free)
    ride.go(600, -LIMITS.davis_a, -4 * 256)
    assert ride.guard.level is WatchLevel.NORMAL


@pytest.mark.parametrize("accel", [10_000, 7000])
def test_a_runaway_is_an_emergency_within_half_a_second(accel: int) -> None:
    ride = Ride()
    ride.go(700, -LIMITS.davis_a)
    assert ride.guard.level is WatchLevel.NORMAL
    assert ride.go(200, accel, until=EMERGENCY) <= (50 if accel > 8000 else 70)
    assert ride.found == (EMERGENCY, CtlCause.RUNAWAY)


def test_a_train_that_rolls_down_a_known_grade_is_no_runaway() -> None:
    grade = -4500
    down = -grade * LIMITS.grade_q16 // 65536 - LIMITS.davis_a
    for known, level in ((grade, WatchLevel.NORMAL), (0, EMERGENCY), (None, WatchLevel.NORMAL)):
        ride = Ride(100_000, grade=known)
        ride.go(500, down)
        assert ride.guard.level is level, known


def test_sampling_begins_again_after_a_pause_and_a_clock_set_back() -> None:
    ride = Ride()
    ride.go(700, 3000)
    for off in (160, -160):
        assert ride.guard._motion._off > 500_000
        ride.tick += off
        ride.go(1, 3000)
        assert ride.guard._motion._off == 0
        ride.go(60, 3000)


# -- the channel ------------------------------------------------------------------------------------------------------


def test_lost_telegrams_are_no_delay() -> None:
    """Of every number: through the guard, which refuses those that seem old."""
    for lost in range(60):
        ride = Ride()
        ride.go(200)
        life = ride.tick
        for tick in range(life, life + lost):
            if tick % 2 == 0:
                ride.guard.notch(0, tick * 10 * MS)
        ride.tick += lost
        ride.go(60)
        assert ride.guard.level is WatchLevel.NORMAL, lost


def test_stale_telegrams_cut_traction() -> None:
    ride = Ride()
    ride.go(200, law=500)
    for _ in range(6):
        ride.guard.notch(500, ride.now_ns)
    ride.go(1, law=500)
    assert ride.found == (TRACTION_CUT, CtlCause.SPEED_LATENCY)


def test_too_many_bad_telegrams_brake_though_they_come_one_by_one() -> None:
    """One in twelve: never three in ten, but 8 in a second. This train does not brake, which is not looked at here."""
    ride = Ride(scenario=replace(SCENARIO, watch=replace(SCENARIO.watch, brake_share_min_percent=0.0)))
    levels = set()
    for tick in range(1200):
        if tick % 12 == 11:
            ride.guard.speed(TrnSpeed(0, check=3, life=ride.tick % 16), ride.now_ns)
            ride.place += ride.speed
            ride.tick += 1
        else:
            ride.go(1)
        levels.add((tick // 400, ride.guard.level))
    assert max(level for part, level in levels if part == 0) is WatchLevel.HOLD
    assert max(level for part, level in levels if part == 2) is SERVICE_BRAKE
    assert ride.guard.counters == {"check_variable": 100}


@pytest.mark.parametrize("offset", [3, 8, 12])
def test_two_senders_brake(offset: int) -> None:
    ride = Ride()
    ride.go(100)
    for _ in range(20):
        ride.go(1)
        ride.guard.speed(TrnSpeed(ride.speed // 1000, life=(ride.tick - 1 + offset) % 16), ride.now_ns)
        if ride.guard.level >= SERVICE_BRAKE:
            break
    assert ride.found == (SERVICE_BRAKE, CtlCause.TWO_SOURCES)


def test_late_control_periods_in_a_row() -> None:
    ride = Ride()
    ride.go(100)
    for late in (True, True, True, False, True, True, True):
        ride.guard.period(late)
        ride.go(20)
        assert ride.guard.level is WatchLevel.NORMAL
    ride.guard.period(True)
    ride.go(20)
    assert ride.found == (TRACTION_CUT, CtlCause.OVERRUNS)
    ride.guard.period(False)
    ride.go(5)
    assert ride.guard.level is WatchLevel.NORMAL
