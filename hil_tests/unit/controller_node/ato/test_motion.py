"""The arithmetic of the motion's checks against a plain model that keeps the history, and the limits of a scenario."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import product
from math import exp

import pytest

from railhil.controller_node.ato import plausibility
from railhil.controller_node.ato.plausibility import Motion, MotionLimits, found
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Effort
from railhil.wire.ato import CtlCause

SCENARIO = load("lvshun_tieshan")
MS = 1_000_000
LIMITS = MotionLimits(
    jump_01mmps=861, accel_01mmps2=20_003, tick_ns=10 * MS, stuck_01mmps=40, scale_permil=30, disagreement_01mm=90,
    brake_share_permil=499, runaway_01mmps=300, decay_q16=19_000, notch_01mmps2=2088, brake_01mmps2=9000,
    traction_01mmps2=9500, weak_traction_01mmps2=4100, davis_a=190, davis_b_q20=1300, davis_c_q40=70_000,
    grade_q16=60_001,
)  # fmt: skip


class PlainMotion:
    """The checks as their definitions say; entries of the comparison with the odometer are all kept."""

    def __init__(self, limits: MotionLimits) -> None:
        self.limits = limits
        self.last: tuple[int, int] | None = None
        self.force = 0
        self.way = 0
        self.begin()

    def begin(self) -> None:
        self.off = self.due = self.weak_ms = self.count = 0
        self.stuck = self.off_scale = self.runaway = False
        self.entries: list[tuple[int, int]] = []

    def sample(
        self, now_ns: int, speed: int, code: int, grade: int | None, changed_ns: int, position: int | None
    ) -> None:
        limits, last = self.limits, self.last
        self.last = now_ns, speed
        step_ms = now_ns // 1_000_000 - last[0] // 1_000_000 if last else 0
        if last is None or step_ms <= 0 or step_ms > 1000:
            return self.begin()
        share = min(limits.decay_q16 * step_ms // 100, 65536)
        self.force += (code * 256 - self.force) * share // 65536
        against = limits.davis_a + limits.davis_b_q20 * speed // 2**20 + limits.davis_c_q40 * speed**2 // 2**40
        against += (grade or 0) * limits.grade_q16 // 65536
        force = max(self.force * limits.notch_01mmps2 // 65536, -limits.brake_01mmps2)
        if changed_ns > last[0] or speed == 0:
            self.due = 0
        elif abs(min(force, limits.weak_traction_01mmps2) - against) >= 1000:
            self.due += (min(force, limits.weak_traction_01mmps2) - against) * step_ms
        self.stuck = changed_ns <= last[0] and abs(self.due) / 1000 > limits.stuck_01mmps
        if code <= 0 and speed >= 5000 and grade is not None:
            force = min(force, limits.traction_01mmps2)
            accel = force - against
            self.off += -(self.off * step_ms // 1000) + (speed - last[1]) * 1000 - accel * step_ms
            off = self.off / 1000
            self.runaway = off > limits.runaway_01mmps and off > -accel
            is_weak = force < -3000 and off > -force * (1000 - limits.brake_share_permil) // 1000 + 1500
            self.weak_ms = self.weak_ms + step_ms if is_weak else 0
        else:
            self.off, self.runaway, self.weak_ms = 0, False, 0
        self.way += (speed + last[1]) * step_ms
        if position is None:
            self.entries, self.count, self.off_scale = [], 0, False
            return None
        self.count += 1
        if self.count % 5:
            return None
        self.entries.append((self.way, position))
        if len(self.entries) > 10:
            way, place = self.entries[-11]
            ways = (self.way - way) // 2000, position - place
            allowed = max(ways) * limits.scale_permil // 1000 + limits.disagreement_01mm
            self.off_scale = abs(ways[0] - ways[1]) > allowed
        return None

    @property
    def found(self) -> tuple[bool, bool, bool, int]:
        return self.stuck, self.off_scale, self.runaway, self.weak_ms


def test_any_motion_against_the_plain_model() -> None:
    seen = set().union(*(compared_with_the_model(random.Random(seed)) for seed in range(24)))
    assert seen == set("abcd")


def compared_with_the_model(draw: random.Random) -> set[str]:
    """Phases of a ride; returns what was found in it."""
    motion, model = Motion(LIMITS), PlainMotion(LIMITS)
    now_ns, speed, place, seen = 5000 * MS, draw.choice([0, 4990, 60_000]), 0, set[str]()
    assert not motion.is_suspicious
    for phase in range(25):
        code = draw.choice([-1792, -1792, -900, -300, -1, 0, 0, 1, 700, 1792])
        grade = draw.choice([None, 0, 0, -300, 700, -3000])
        # With the model, slower, faster, or not at all.
        slope = draw.choice([0, 0, draw.randrange(-1200, 300), draw.randrange(-200, 1500)])
        held, scale = draw.random() < 0.3, draw.choice([1000, 1000, 969, 970, 1030, 1031])
        odometer = draw.random() < 0.9
        steps = draw.choice([[100], [100], [100, 110, 130], [100, 100, 1000, 400], [100, 100, 100, 100, 1001, 0, -30]])
        for _ in range(draw.choice([8, 20, 75])):
            step_ms = draw.choice(steps)
            before_ns, before = now_ns, speed
            now_ns += step_ms * MS + draw.choice([0, 0, 999_999])
            speed = speed if held else max(speed + slope + draw.randrange(-3, 4), 0)
            place += (speed + before) * step_ms // 2000 * scale // 1000
            changed_ns = before_ns + (draw.choice([0, 0, -1]) if held else draw.choice([1, step_ms * MS]))
            given = (now_ns, speed, code, grade, changed_ns, place if odometer else None)
            motion.sample(*given)
            model.sample(*given)
            one = motion.is_stuck, motion.is_off_scale, motion.is_runaway, motion.weak_ms
            assert one == model.found, (phase, given)
            assert (motion._off, motion._due) == (model.off, model.due)
            assert motion.is_suspicious == any(model.found)
            seen |= {name for name, value in zip("abcd", one, strict=True) if value}
    return seen


#: Forces are at once there and, in 0.1 mm/s2, as many as the notch's code; nothing resists.
SIMPLE = LIMITS._replace(
    decay_q16=65_536, notch_01mmps2=256, davis_a=0, davis_b_q20=0, davis_c_q40=0, brake_share_permil=500,
)  # fmt: skip


def two_samples(
    code: int,
    change: int = 0,
    limits: MotionLimits = SIMPLE,
    speed: int = 60_000,
    step_ms: int = 100,
    held: bool = False,
) -> Motion:
    """The first two samples of a motion."""
    motion = Motion(limits)
    motion.sample(50 * MS, speed, code, 0, 50 * MS, None)
    now_ns = (50 + step_ms) * MS
    motion.sample(now_ns, speed + change, code, 0, 50 * MS if held else now_ns, None)
    return motion


def test_the_first_sample_finds_nothing() -> None:
    motion = Motion(SIMPLE)
    assert found(motion) == (CtlCause.NONE, False)
    # Soon after the start, and far from a speed of 0.
    motion.sample(100 * MS, 60_000, 0, 0, 0, None)
    assert not motion.is_suspicious


def test_a_change_that_is_due_at_its_edges() -> None:
    """100 ms: a tenth of the acceleration."""
    for sign in (1, -1):
        for accel, limit, stuck in ((1000, 99, True), (1000, 100, False), (999, 0, False)):
            assert two_samples(sign * accel, 0, SIMPLE._replace(stuck_01mmps=limit), held=True).is_stuck == stuck
        assert two_samples(sign * 1001, 0, SIMPLE._replace(stuck_01mmps=100), held=True).is_stuck
    # Nothing is due at standstill, whatever was before.
    motion = two_samples(1000, 0, SIMPLE._replace(stuck_01mmps=99), held=True)
    motion.sample(250 * MS, 0, 1000, 0, 50 * MS, None)
    assert not motion.is_stuck


def test_runaway_at_its_edge() -> None:
    for step_ms in (1, 100, 1000):
        assert not two_samples(0, 300, step_ms=step_ms).is_runaway
        assert two_samples(0, 301, step_ms=step_ms).is_runaway
    # Less than 0.1 mm/s counts.
    assert two_samples(-1, 300).is_runaway
    assert two_samples(-1001, 1000, step_ms=1).is_runaway
    # The model begins without any force.
    held_force = SIMPLE._replace(decay_q16=0, notch_01mmps2=65_536)
    assert [two_samples(0, change, held_force, step_ms=1000).is_runaway for change in (300, 301)] == [False, True]


def test_a_weak_brake_at_its_edge() -> None:
    """A demand of 3001 (300.1 in 100 ms), of which 1500 may be missing, and 1500 beside it."""
    assert [two_samples(-4000, change).weak_ms for change in (3100, 3101)] == [0, 100]
    assert two_samples(-3001, 3001 - 301).weak_ms == 100
    assert two_samples(-3001, 3000 - 301).weak_ms == 0
    assert two_samples(-3000, 9999).weak_ms == 0


def test_speed_and_odometer_at_the_edge() -> None:
    """1 m/s for 5 s, of which 3 % may be missing, and 9 mm beside it."""
    for way_01mm, off_scale in ((51_639, False), (51_640, True), (48_410, False), (48_409, True)):
        motion = Motion(SIMPLE)
        for number in range(56):
            now_ns = number * 100 * MS
            motion.sample(now_ns, 10_000, 0, 0, now_ns, way_01mm if number == 55 else 0)
            assert number == 55 or not motion.is_off_scale
        assert motion.is_off_scale == off_scale


def test_what_was_found_by_weight() -> None:
    motion = Motion(LIMITS)
    for stuck, scale, runaway, weak_ms in product((False, True), (False, True), (False, True), (0, 1, 1000, 1001)):
        motion.is_stuck, motion.is_off_scale, motion.is_runaway, motion.weak_ms = stuck, scale, runaway, weak_ms
        if runaway:
            wanted = CtlCause.RUNAWAY, True
        elif weak_ms:
            wanted = CtlCause.BRAKE_NOT_ANSWERING, weak_ms == 1001
        else:
            wanted = (CtlCause.SPEED_IMPLAUSIBLE if stuck or scale else CtlCause.NONE), False
        assert found(motion) == wanted
        assert motion.is_suspicious == any((stuck, scale, runaway, weak_ms))


def test_changes_that_fit_their_time() -> None:
    assert (plausibility.SAMPLE_MS, plausibility.POSITION_AGE_MAX_MS) == (100, 100)
    limits = MotionLimits(*LIMITS)
    # 0.1 mm/s in one tick: 200.03.
    assert limits.step_01mmps == 861 + 200
    for elapsed_ns, largest in (
        (-5 * MS, 1061), (0, 1061), (10 * MS, 1061), (10 * MS + 50_000, 1062), (1000 * MS, 20_864),
        (100_000 * MS, 861 + 2_000_300), (100_050 * MS, 861 + 2_000_300), (10**9 * MS, 861 + 2_000_300),
    ):  # fmt: skip
        for sign in (1, -1):
            assert limits.fits(sign * largest, elapsed_ns)
            assert not limits.fits(sign * (largest + 1), elapsed_ns)
    # 100 s is the longest time, to the ns.
    strong = limits._replace(accel_01mmps2=10**9)
    assert strong.fits(861 + 10**11, 10**12)
    assert not strong.fits(861 + 10**11 + 1, 10**12)


@pytest.mark.parametrize("strong", [False, True])
@pytest.mark.parametrize("speed_limit_mps", [22.0, 1000.0])
def test_the_limits_of_a_scenario(strong: bool, speed_limit_mps: float) -> None:
    """Forces at the speeds from 0 to the train's limit, at most 150 m/s, in whole m/s."""
    top = 22 if speed_limit_mps == 22.0 else 150
    falling, rising = ((0.0, 411e3), (1.0, 300e3), (200.0, 101e3)), ((0.0, 97e3), (200.0, 399e3))
    train = replace(
        SCENARIO.train, mass_kg=211e3, inertial_mass_kg=223_457.0, gravity_mps2=9.807, speed_limit_mps=speed_limit_mps,
        davis_a_n_per_kn=2.137, davis_b_n_per_kn_kmh=0.00831, davis_c_n_per_kn_kmh2=0.000457,
        actuator_pole_per_s=3.17, force_per_notch_n=43_217.0,
        brake=Effort(1e9, curve=rising if strong else falling),
        traction=Effort(1e9, curve=falling if strong else rising),
    )  # fmt: skip
    sensors = replace(SCENARIO.sensors, speed_lsb_mps=0.0137, speed_noise_sigma_mps=0.0213, odometer_lsb_m=0.0317)
    watch = replace(
        SCENARIO.watch, speed_change_max_mps2=1.837, stuck_change_mps=0.1234, scale_error_max_percent=3.17,
        brake_share_min_percent=47.3, runaway_mps=0.3127,
    )  # fmt: skip
    limits = MotionLimits.of(replace(SCENARIO, train=train, sensors=sensors, watch=watch))
    to_accel = 1e4 / 223_457.0
    slowest_n = 300e3 - (300e3 - 101e3) * (top - 1) / 199
    fastest_n = 97e3 + (399e3 - 97e3) * top / 200
    weight_kn = 211 * 9.807
    assert limits == MotionLimits(
        jump_01mmps=500 + (137 + 12 * 213),
        accel_01mmps2=round(1.5 * 411e3 * to_accel),
        tick_ns=10 * MS,
        stuck_01mmps=1234 + 2 * 137,
        scale_permil=32,
        disagreement_01mm=1000 + 634,
        brake_share_permil=473,
        runaway_01mmps=3127,
        decay_q16=round((1 - exp(-0.317)) * 65536),
        notch_01mmps2=round(43_217 * to_accel),
        brake_01mmps2=round((97e3 if strong else slowest_n) * to_accel),
        traction_01mmps2=round((411e3 if strong else fastest_n) * to_accel),
        weak_traction_01mmps2=round((slowest_n if strong else 97e3) * to_accel),
        davis_a=round(weight_kn * 2.137 * to_accel),
        davis_b_q20=round(weight_kn * 0.00831 * 3.6e-4 * 2**20 * to_accel),
        davis_c_q40=round(weight_kn * 0.000457 * 3.6e-4**2 * 2**40 * to_accel),
        grade_q16=round(weight_kn * 0.01 * 65536 * to_accel),
    )
    weak = replace(train, brake=Effort(50e3), traction=Effort(60e3))
    assert MotionLimits.of(replace(SCENARIO, train=weak, watch=watch)).accel_01mmps2 == 18_370


def test_the_units_of_the_limits() -> None:
    """Values so large that the last digit of each factor counts: 1 t, 10 kN."""
    train = replace(
        SCENARIO.train, mass_kg=1000.0, inertial_mass_kg=1000.0, gravity_mps2=10.0, force_per_notch_n=1e7,
        davis_a_n_per_kn=1e3, davis_b_n_per_kn_kmh=1e3, davis_c_n_per_kn_kmh2=0.0, actuator_pole_per_s=1e3,
    )  # fmt: skip
    sensors = replace(SCENARIO.sensors, speed_lsb_mps=10.0, speed_noise_sigma_mps=0.0, odometer_lsb_m=10.0)
    watch = replace(SCENARIO.watch, stuck_change_mps=0.0, runaway_mps=10.0)
    limits = MotionLimits.of(replace(SCENARIO, train=train, sensors=sensors, watch=watch))
    assert limits.jump_01mmps == 500 + 100_000
    assert limits.disagreement_01mm == 1000 + 200_000
    assert (limits.stuck_01mmps, limits.runaway_01mmps) == (200_000, 100_000)
    assert limits.decay_q16 == 65_536
    assert limits.notch_01mmps2 == 10**8
    assert (limits.davis_a, limits.davis_b_q20, limits.davis_c_q40) == (100_000, 36 * 2**20, 0)
