"""The checks of the measured speed: at their limits, and against trains that do not do what they are told."""

from __future__ import annotations

from typing import Any

import pytest

from railhil.controller_node.ato.guard import Guard
from railhil.controller_node.ato.odometer import Odometer
from railhil.controller_node.ato.plausibility import MotionLimits
from railhil.scenarios.load import load
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


@pytest.mark.parametrize(("scale", "is_found"), [(1000, False), (980, False), (1020, False), (950, True), (1050, True)])
def test_speed_and_odometer_disagree(scale: int, is_found: bool) -> None:
    """At 3 m/s; a train that is faster is found by the position, see below."""
    ride = Ride(30_000)
    ride.scale = scale
    passed = ride.go(1200, until=TRACTION_CUT)
    assert ride.found == ((TRACTION_CUT, CtlCause.SPEED_IMPLAUSIBLE) if is_found else (WatchLevel.NORMAL, 0))
    assert not is_found or 500 <= passed <= 600


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
