"""The odometer's arithmetic against a plain model on any ride, to the last digit."""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import replace

from railhil.controller_node.ato import odometer as checked
from railhil.controller_node.ato.odometer import Odometer
from railhil.scenarios.load import load
from railhil.wire.ato import CtlCause, TrnPos

MS = 1_000_000
S = 1_000_000_000
BASE = load("lvshun_tieshan")
#: Tolerance 0.1123 m, hold age 21 ms, speed to 0.0283 m/s; TRN_POS every 20 ms.
SCENARIO = replace(
    BASE,
    sensors=replace(BASE.sensors, odometer_lsb_m=0.0123, speed_lsb_mps=0.014, speed_noise_sigma_mps=0.0213),
    watch=replace(BASE.watch, hold_ms=21),
)
TASK_NS = 3 * MS


class Plain:
    """What the module's text says: lengths in 1e-13 m."""

    def __init__(self, needed: bool) -> None:
        self.needed, self.counters, self.accepted = needed, Counter[str](), 0
        self.begun = False
        self.life: int | None = None
        self.good = 10
        self.heard = False
        self.reading = self.fitted = self.trusted = 0
        self.jumped: int | None = None
        self.jumping = 0
        self.place = self.slack = self.now = self.speed = self.speed_at = 0

    def reckon(self, now: int) -> None:
        if not self.begun or now <= self.now:
            return
        step, self.now = now - self.now, now
        self.place += self.speed * step
        if self.speed:
            old = max(now - self.speed_at, 0)
            self.slack += (283 + 20_000 * old // S) * step

    def measured(self, speed: int, now: int) -> None:
        if not self.begun:
            self.begun = True
            self.now = self.fitted = self.trusted = self.speed_at = now
            self.speed = speed
        self.reckon(now)
        if now > self.speed_at:
            self.place += (speed - self.speed) * (now - self.speed_at) // 2
        self.speed, self.speed_at = speed, now

    @property
    def tolerance(self) -> int:
        return 1123 * S + self.speed * 21 * MS + self.slack if self.heard else 2_000_000_000 * S

    def position(self, reading_mm: int, life: int, check: int, now: int) -> None:
        step = 1 if self.life is None else (life - self.life) % 16
        if step == 0 or step > 7:
            self.counters["position_out_of_order" if step else "position_duplicate"] += 1
            return
        self.life = life
        if check != 1:
            self.counters["position_check"] += 1
            self.good = 0
            return
        self.reckon(now)
        reading = min(max(10 * reading_mm, -4_000_000_000), 4_000_000_000)
        if not self.heard or not self.begun:
            self.heard, self.place, self.fitted = True, reading * S, now
        off = reading * S - self.place
        if abs(off) > self.tolerance:
            self.counters["position_jump"] += 1
            self.good = 0
            self.jumped = now if self.jumped is None or now - self.jumping > S else self.jumped
            self.jumping = now
            return
        self.accepted += 1
        since = max(now - self.fitted, 0)
        share = min(since, S)
        self.place += off * share // S
        self.slack -= self.slack * share // S
        self.good = 1 if since > 41 * MS + TASK_NS else min(self.good + 1, 10)
        self.reading, self.fitted = reading, now
        if self.good == 10:
            self.trusted, self.jumped = now, None

    def at(self, now: int) -> int:
        if self.heard and self.good == 10 and now - self.fitted <= 23 * MS:
            return min(max(self.reading, -2_000_000_000), 2_000_000_000)
        return self.reckoned(now)[0]

    def reckoned(self, now: int) -> tuple[int, int]:
        self.reckon(now)
        return min(max(self.place // S, -2_000_000_000), 2_000_000_000), self.tolerance // S

    def lost(self, now: int) -> CtlCause:
        if self.jumped is not None:
            since = self.trusted if self.needed else self.jumped
            silent = not self.needed and now - self.jumping > 20 * MS + TASK_NS
            return CtlCause.POSITION_IMPLAUSIBLE if now - since > S and not silent else CtlCause.NONE
        return CtlCause.POSITION_LOST if self.needed and self.begun and now - self.trusted > S else CtlCause.NONE


def ride(draw: random.Random) -> set[CtlCause]:
    """Phases of a ride; which reasons of a lost position it has seen."""
    needed = draw.random() < 0.5
    odometer, plain = Odometer(SCENARIO, TASK_NS, needed=needed), Plain(needed)
    now, speed, true_mm, life, seen = draw.choice([0, 77 * S]), 0, draw.choice([0, -5, 123_456]), 0, set[CtlCause]()
    for _ in range(14):
        slope, off_mm = draw.choice([0, 0, 90, -90]), draw.choice([0, 0, 0, 60, 300, -300, 20_000, 10**9])
        steps, bad = draw.choice([[10], [10], [10, 11], [30], [300], [10, -4]]), draw.random() < 0.15
        told, positions = draw.random() < 0.85, draw.random() < 0.85
        for number in range(draw.choice([5, 25, 125])):
            now += draw.choice(steps) * MS + draw.choice([0, 0, 1])
            speed = max(speed + slope + draw.randrange(-9, 10), 0) if speed or slope > 0 else draw.choice([0, 0, 5])
            true_mm += speed // 1000
            if told:
                odometer.speed(speed, now)
                plain.measured(speed, now)
            if positions and number % 2:
                life = (life + draw.choice([1] * 12 + [0, 2, 9])) % 16
                check = draw.choice([0, 1, 1]) if bad else 1
                odometer.position(TrnPos(true_mm + off_mm, check=check, life=life), now)
                plain.position(true_mm + off_mm, life, check, now)
            look = now + draw.choice([0, 0, 3 * MS, 23 * MS])
            if draw.random() < 0.4:
                assert odometer.at(look) == plain.at(look)
            if draw.random() < 0.3:
                assert odometer.reckoned(look) == plain.reckoned(look)
            assert odometer.lost(look) == plain.lost(look)
            seen.add(plain.lost(look))
            assert (odometer._place, odometer._slack) == (plain.place, plain.slack)
            assert (odometer._tolerance(), odometer._run) == (plain.tolerance, plain.good)
            assert odometer.fitted == (plain.reading, plain.fitted)
            assert (odometer.accepted, odometer.counters) == (plain.accepted, plain.counters)
    return seen


def test_any_ride_against_the_plain_model() -> None:
    seen = set().union(*(ride(random.Random(seed)) for seed in range(24)))
    assert seen == {CtlCause.NONE, CtlCause.POSITION_LOST, CtlCause.POSITION_IMPLAUSIBLE}


def test_a_position_is_lost_after_more_than_a_second() -> None:
    assert (checked.RECKONING_MAX_NS, checked.GOOD_RUN, checked.FOLLOWING_NS) == (S, 10, S)
    odometer = Odometer(SCENARIO, needed=True)
    assert odometer.fitted == (0, 0)
    assert odometer.lost(10 * S) is CtlCause.NONE
    odometer.speed(0, 5 * S)
    assert odometer.lost(6 * S) is CtlCause.NONE
    assert odometer.lost(6 * S + 1) is CtlCause.POSITION_LOST
    # Implausible ones are told after a second also where no position is needed.
    other = Odometer(SCENARIO)
    other.speed(0, 0)
    other.position(TrnPos(0, life=1), 0)
    other.position(TrnPos(10**6, life=2), 3)
    other.position(TrnPos(10**6, life=3), 9)
    assert other.lost(S + 4) is CtlCause.NONE
    for life, now in enumerate((S - 20 * MS, S), 4):
        other.position(TrnPos(10**6, life=life), now)
    assert other.lost(S + 3) is CtlCause.NONE
    assert other.lost(S + 4) is CtlCause.POSITION_IMPLAUSIBLE
    # A silence of more than a second between them begins the second anew.
    assert other.lost(S + 20 * MS) is CtlCause.POSITION_IMPLAUSIBLE
    assert other.lost(S + 20 * MS + 1) is CtlCause.NONE
    other.position(TrnPos(10**6, life=6), 2 * S)
    assert other.lost(2 * S) is CtlCause.POSITION_IMPLAUSIBLE
    other.position(TrnPos(10**6, life=7), 3 * S + 1)
    assert other.lost(3 * S + 1) is CtlCause.NONE


def test_without_a_task_a_telegram_is_in_time_for_its_period() -> None:
    odometer = Odometer(SCENARIO)
    odometer.speed(10_000, 0)
    odometer.position(TrnPos(500, life=1), 0)
    assert odometer.at(20 * MS) == 5000
    assert odometer.at(20 * MS + 1) == 5200


def test_the_edge_of_the_tolerance_and_of_the_period() -> None:
    """0.112 m at rest, and ten telegrams each exactly a period after the other."""
    sensors = replace(SCENARIO.sensors, odometer_lsb_m=0.012, speed_lsb_mps=0.0, speed_noise_sigma_mps=0.0)
    odometer = Odometer(replace(SCENARIO, sensors=sensors))
    odometer.speed(0, 0)
    odometer.position(TrnPos(0, life=0), 0)
    odometer.position(TrnPos(113, life=1), 0)
    assert odometer.counters == {"position_jump": 1}
    odometer.position(TrnPos(112, life=2), 0)
    assert odometer.counters == {"position_jump": 1}
    for number in range(1, 11):
        assert odometer._run == number
        odometer.position(TrnPos(100, life=(2 + number) % 16), 20 * MS * number)
    assert odometer.at(200 * MS) == 1000


def test_before_the_first_speed_the_newest_position_counts() -> None:
    """As after a restart in motion without a speed: nothing tells how far the train has gone since the last one."""
    odometer = Odometer(SCENARIO, needed=True)
    odometer.position(TrnPos(0, life=1, check=0), 0)
    for number in range(2, 14):
        odometer.position(TrnPos(300 * number, life=number), 20 * MS * number)
        assert odometer.at(20 * MS * number) == 3000 * number
    odometer.speed(150_000, 280 * MS)
    odometer.position(TrnPos(300 * 14, life=14), 280 * MS)
    assert odometer.counters == {"position_check": 1}
    assert odometer.at(280 * MS) == 3000 * 14
    assert odometer.lost(10 * S) is CtlCause.POSITION_LOST
    # From then on it is compared.
    odometer.position(TrnPos(10**6, life=15), 300 * MS)
    assert odometer.counters["position_jump"] == 1


def test_the_units_of_the_sensors() -> None:
    """Values so large that the last digit of each factor counts."""
    sensors = replace(SCENARIO.sensors, odometer_lsb_m=9.9, speed_lsb_mps=20.0, speed_noise_sigma_mps=0.0)
    odometer = Odometer(replace(SCENARIO, sensors=sensors))
    # Where the train is, nobody knows before the first telegram.
    assert odometer.reckoned(0) == (0, 2_000_000_000)
    odometer.position(TrnPos(0), 0)
    assert odometer.reckoned(0) == (0, 100_000)
    odometer.speed(1, 0)
    # 10 m/s of the sensor and 2 m/s of a change within a second.
    assert odometer.reckoned(S)[1] == 100_000 + 100_000 + 20_000
