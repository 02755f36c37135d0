"""Dense sweeps of the controller's guard against independently written models.

As in :mod:`hil_tests.support.gate_sweeps` each sweep takes the module under test.
"""

from __future__ import annotations

import random
from dataclasses import replace
from types import ModuleType, SimpleNamespace
from typing import Any

from hil_tests.support.plain_guard import MS, SCENARIO, PlainGuard
from railhil.controller_node.ato.odometer import Odometer
from railhil.controller_node.ato.safe_speed import SafeSpeed
from railhil.controller_node.ato.speed_watch import (
    Ladder,
)
from railhil.controller_node.ecan import BitCounter
from railhil.wire.ato import CtlCause, SpeedSdt, TrkInfo, TrnSpeed, WatchLevel


def sweep_guard_random(module: ModuleType) -> None:
    """Seeded traffic with every fault at once, against the plain guard after every step."""
    for seed in range(30):
        draw = random.Random(seed)
        subject, model = module.Guard(SCENARIO), PlainGuard()
        now_ns, life, told = 0, 0, 0
        speeds = [0, 0, 1, 100_000, 150_000, 1_499_999, 1_500_000, 1_500_001, -1]
        for _ in range(300):
            now_ns += draw.choice([0, 10, 10, 10, 10, 16, 21, 65, 257, 1001]) * MS if draw.random() < 0.4 else 10 * MS
            kind = draw.random()
            if kind < 0.75:
                life += draw.choice([1] * 14 + [0, 2, 7, 8, 15])
                check = draw.choice([1] * 12 + [0, 2, 3])
                speed = draw.choice(speeds) if draw.random() < 0.2 else 90_000
                subject.speed(TrnSpeed(speed, check=check, life=life % 16), now_ns)
                model.speed(speed, check, life % 16, now_ns)
            elif kind < 0.78:
                limit = draw.choice([1402, 1403, 2000, 3400, 60_000])
                check = draw.randrange(4)
                told += 1
                subject.limit(TrkInfo(speed_limit_4mmps=limit, limit_check=check, life=told % 4), now_ns)
                if check == 1:
                    model.limits.append(limit)
            else:
                law = draw.choice([1792, 500, 0, -500, -1792])
                assert subject.notch(law, now_ns) == model.notch(law, now_ns)
            assert (subject.level, subject.cause) == (model.state.level, model.state.cause)
            assert subject.counters == model.counters
            assert subject.speed_01mmps == (model.good[-1][1] if model.good else None)
            assert subject.accepted == len(model.good)


def sweep_guard_boundaries(module: ModuleType) -> None:
    """Speed range, overspeed and age at their exact limits."""
    assert module.SPEED_MAX_01MMPS == 1_500_000
    for speed in (-1, 0, 1, 1_499_999, 1_500_000, 1_500_001):
        subject = module.Guard(SCENARIO)
        subject.speed(TrnSpeed(speed), 0)
        assert subject.speed_01mmps == (speed if 0 <= speed <= 1_500_000 else None)
        assert subject.level is (WatchLevel.NORMAL if 0 <= speed <= 1_500_000 else WatchLevel.HOLD)
    limit = 5000
    edge = limit * 40 + round(SCENARIO.watch.overspeed_margin_mps * 10_000)
    for speed in range(edge - 3, edge + 4):
        subject = module.Guard(SCENARIO)
        subject.limit(TrkInfo(speed_limit_4mmps=limit), 0)
        subject.speed(TrnSpeed(speed), 0)
        assert (subject.level is WatchLevel.EMERGENCY) == (speed > edge)
    for age_ms in range(1100):
        for extra_ns in (0, MS - 1):
            subject = module.Guard(SCENARIO)
            subject.speed(TrnSpeed(100_000), 7 * MS)
            subject.notch(500, (7 + age_ms) * MS + extra_ns)
            expected = sum(age_ms > edge_ms for edge_ms in (20, 64, 256, 1000))
            assert subject.level == expected
    # Before the first telegram the age and the ramp count from time 0, the age in whole milliseconds.
    for age_ms in (20, 21, *range(300, 304)):
        level = (WatchLevel.NORMAL, WatchLevel.HOLD, WatchLevel.SERVICE_BRAKE)[(age_ms > 20) + (age_ms > 256)]
        subject = module.Guard(SCENARIO)
        code = -command_ramp((age_ms + 1) * MS - 1) if level is WatchLevel.SERVICE_BRAKE else 0
        assert subject.notch(0, (age_ms + 1) * MS - 1) == (code, False)
        assert subject.level is level
    # The first poll may come at once, and the ramp has not gone anywhere.
    subject = module.Guard(SCENARIO)
    subject.wait(True)
    for poll_ns in (0, 20 * MS, 40 * MS):
        assert subject.notch(0, poll_ns) == (-command_ramp(poll_ns), False)
    # A limit that arrives after the speed of the same tick applies in that tick.
    subject = module.Guard(SCENARIO)
    subject.speed(TrnSpeed(edge + 1), 0)
    subject.limit(TrkInfo(speed_limit_4mmps=limit), 0)
    assert subject.notch(500, 0)[1]
    # An hour without a telegram at standstill is not an emergency, and time 0 is an ordinary time.
    subject = module.Guard(SCENARIO)
    subject.speed(TrnSpeed(0), 0)
    assert subject.notch(500, 3_600_000 * MS) == (-command_ramp(3_600_000 * MS), False)
    assert subject.level is WatchLevel.SERVICE_BRAKE


def sweep_guard_rows(module: ModuleType) -> None:
    """A silence ends a row of good telegrams, also one that no poll has seen."""
    for silence_ns in (20 * MS, 21 * MS - 1, 21 * MS, 22 * MS):
        subject = module.Guard(SCENARIO)
        for tick in range(8):
            subject.speed(TrnSpeed(100_000, check=int(tick not in (1, 2, 3)), life=tick), 10 * tick * MS)
        assert subject.level is WatchLevel.TRACTION_CUT
        subject.speed(TrnSpeed(100_000, life=8), 70 * MS + silence_ns)
        assert subject.level is (WatchLevel.NORMAL if silence_ns < 21 * MS else WatchLevel.TRACTION_CUT)


def sweep_guard_findings(module: ModuleType) -> None:
    """What the other checks find comes into the watch, and leaves it again: overruns, latency, a stuck reading."""
    cut, normal = WatchLevel.TRACTION_CUT, WatchLevel.NORMAL

    def ride(subject: Any, ticks: range, *, noise: int = 1, polls: int = 1, law: int = 0) -> None:
        for tick in ticks:
            subject.speed(TrnSpeed(100_000 + noise * (tick % 2), life=tick % 16), 10 * tick * MS)
            for _ in range(polls if tick % 2 == 0 else 0):
                subject.notch(law, 10 * tick * MS)

    most = SCENARIO.watch.overruns_max
    subject = module.Guard(SCENARIO)
    ride(subject, range(100))
    fresh = module.Guard(SCENARIO)
    for _ in range(most):
        fresh.period(True)
    assert fresh._findings.strongest is None
    for late in [False, *[True] * most, False, *[True] * most]:
        subject.period(late)
        ride(subject, range(100, 116))
        assert subject.level is normal
    subject.period(True)
    ride(subject, range(116, 132))
    assert (subject.level, subject.cause) == (cut, CtlCause.OVERRUNS)
    subject.period(False)
    ride(subject, range(132, 137))
    assert subject.level is normal
    subject.period(True)
    ride(subject, range(137, 147))
    assert subject.level is normal

    subject = module.Guard(SCENARIO)
    ride(subject, range(100))
    ride(subject, range(100, 110), polls=2)
    assert (subject.level, subject.cause) == (cut, CtlCause.SPEED_LATENCY)
    for life in range(110, 120):
        subject.speed(TrnSpeed(100_000 + life % 2, life=life % 16), 1100 * MS)
    ride(subject, range(120, 136))
    assert subject.level is normal

    # Polls before the first speed say nothing about its latency, whatever its life sign is.
    for first in range(16):
        subject = module.Guard(SCENARIO)
        for tick in range(0, 100, 2):
            subject.notch(0, 10 * tick * MS)
        for tick in range(100, 130):
            subject.speed(TrnSpeed(100_000 + tick % 2, life=(first + tick) % 16), 10 * tick * MS)
            if tick % 2 == 0:
                subject.notch(0, 10 * tick * MS)
        assert subject.level is normal

    # Full traction: 0.46 m/s2 at least, so that 0.1056 m/s are due after three samples.
    for start in (1000, 1003):
        subject = module.Guard(SCENARIO)
        ride(subject, range(start), law=1792)
        assert subject.level is normal
        ride(subject, range(start, start + 19), noise=0, law=1792)
        assert subject.level is normal
        ride(subject, range(start + 19, start + 41), noise=0, law=1792)
        assert (subject.level, subject.cause) == (cut, CtlCause.SPEED_IMPLAUSIBLE)
        ride(subject, range(start + 41, start + 60), law=0)
        assert subject.level is normal


def sweep_guard_order(module: ModuleType) -> None:
    """Old telegrams between good ones are a second sender; repeated ones, and old ones in a row, are not."""
    for shift, olds, level in ((5, 1, 3), (0, 1, 0), (5, 3, 0)):
        subject, now_ns = module.Guard(SCENARIO), 0
        for life in range(30):
            subject.speed(TrnSpeed(100_000, life=life % 16), now_ns)
            for _ in range(olds):
                subject.speed(TrnSpeed(100_000, life=(life - shift) % 16), now_ns)
            now_ns += 10 * MS if olds == 1 else 20 * MS
            assert subject.level in (0, level)
        assert subject.level == level
    # Late control periods count from the first.
    subject = module.Guard(SCENARIO)
    for _ in range(SCENARIO.watch.overruns_max + 1):
        subject.period(True)
    subject.speed(TrnSpeed(100_000), 0)
    assert subject.level is WatchLevel.TRACTION_CUT


def sweep_guard_wait(module: ModuleType) -> None:
    """A moving train without the time brakes; ten good telegrams in a row after it is known end that."""
    subject = module.Guard(SCENARIO)
    assert subject.waits is False
    subject.wait(False)
    for tick in range(40):
        if tick in (10, 20):
            subject.wait(tick == 10)
        assert subject.waits is (10 <= tick < 20)
        subject.speed(TrnSpeed(100_000 + tick % 2, life=tick % 16), 10 * tick * MS)
        assert subject.level == (WatchLevel.SERVICE_BRAKE if 10 <= tick < 29 else WatchLevel.NORMAL)
        assert tick != 10 or subject.cause is CtlCause.CLOCK


def sweep_guard_may_move(module: ModuleType) -> None:
    """By the last speed, or above the age of the service brake in whole milliseconds, from the beginning if there is no
    speed."""
    subject = module.Guard(SCENARIO)
    for now_ns, may in ((0, False), (257 * MS - 1, False), (257 * MS, True), (3_600_000 * MS, True)):
        assert subject.may_move(now_ns) is may
    # A refused speed is none.
    subject.speed(TrnSpeed(100_000, check=0), 257 * MS)
    assert subject.may_move(257 * MS)
    for life, speed in enumerate((0, 1, 0), 1):
        subject.speed(TrnSpeed(speed, life=life), 260 * MS)
        for now_ns, is_old in ((260 * MS, False), (517 * MS - 1, False), (517 * MS, True)):
            assert subject.may_move(now_ns) is (speed > 0 or is_old)
    # A speed that no safe telegram confirms is as old as its last confirmation.
    subject = module.Guard(replace(SCENARIO, safety=replace(SCENARIO.safety, sdt=True)))
    subject.safe = SimpleNamespace(age_ns=lambda now_ns: now_ns - 10 * MS)
    subject.speed(TrnSpeed(0), 200 * MS)
    assert not subject.may_move(267 * MS - 1)
    assert subject.may_move(267 * MS)


def sweep_guard_overrun(module: ModuleType) -> None:
    """A train beyond its end of authority brakes; ten good telegrams in a row after it is not end that."""
    subject = module.Guard(SCENARIO)
    for tick in range(40):
        subject.overrun(10 <= tick < 20)
        subject.speed(TrnSpeed(100_000 + tick % 2, life=tick % 16), 10 * tick * MS)
        assert subject.level == (WatchLevel.SERVICE_BRAKE if 10 <= tick < 29 else WatchLevel.NORMAL)
        assert tick != 10 or subject.cause is CtlCause.POSITION_IMPLAUSIBLE


def sweep_guard_samples(module: ModuleType) -> None:
    """When the motion is sampled, and with what."""
    odometer = SimpleNamespace(fitted=(5000, 0), speed=lambda *given: None, lost=lambda now_ns: CtlCause.NONE)
    subject, seen = module.Guard(SCENARIO, None, odometer), []
    subject._motion.sample = lambda *given: seen.append(given)

    def at(now_ns: int, speed: int, age_ns: int) -> tuple[Any, ...]:
        """What a telegram's sample is given; nothing for no sample."""
        odometer.fitted = (5000, now_ns - age_ns)
        subject.speed(TrnSpeed(speed, life=(subject._life._last + 1) % 16), now_ns)
        found = seen[-1] if seen else ()
        seen.clear()
        return found

    # The first speed, whenever it comes.
    assert at(150 * MS, 100_000, 0)[:2] == (150 * MS, 100_000)
    at_ns = 1000 * MS
    assert at(at_ns, 100_000, 0) == (at_ns, 100_000, 0, None, 0, 5000)
    subject.limit(TrkInfo(grade_001permil=77, grade_check=2), at_ns)
    assert at(at_ns, 100_000, 0) == ()
    assert at(at_ns + 100 * MS - 1, 100_000, 0) == ()
    assert at(at_ns + 100 * MS, 100_000, 100 * MS) == (at_ns + 100 * MS, 100_000, 0, None, 0, 15_000)
    subject.limit(TrkInfo(grade_001permil=-88, life=1), at_ns)
    # Set back by the smallest step.
    assert at(at_ns + 100 * MS - 1, 100_001, 101 * MS)[3:] == (-88, at_ns + 100 * MS - 1, None)
    assert at(at_ns + 300 * MS, 100_001, 99 * MS)[3:] == (-88, at_ns + 100 * MS - 1, 5000 + 9900)
    assert at(at_ns + 500 * MS, 100_001, MS)[5] == 5100
    assert at(at_ns + 700 * MS, 100_001, -MS)[5] is None


def sweep_guard_position(module: ModuleType) -> None:
    """A required position that does not arrive brakes the train; every good speed enters the dead reckoning."""
    for needed in (False, True):
        counter, odometer = BitCounter(500_000), Odometer(SCENARIO, needed=needed)
        subject = module.Guard(SCENARIO, counter, odometer)
        for tick in range(120):
            now_ns = 10 * tick * MS
            # Each telegram was received one tick before it is read.
            subject.speed(TrnSpeed(50_000 + 100 * tick, life=tick % 16), now_ns, counter.at(max(now_ns - 10 * MS, 0)))
            assert subject.level is (WatchLevel.SERVICE_BRAKE if needed and tick > 100 else WatchLevel.NORMAL)
        # From 0 to 1.18 s the mean speed, then the last speed for one tick; 0.1 mm.
        assert odometer.reckoned(1_190 * MS)[0] == 50_100 * 118 // 100 + 59 * 118 + 619


def sweep_guard_safe(module: ModuleType) -> None:
    """The older of the two ages counts, and is named; a safe telegram is compared with the speed of its instant."""
    scenario = replace(SCENARIO, safety=replace(SCENARIO.safety, sdt=True))
    assert module.Guard(SCENARIO).safe is None
    assert isinstance(module.Guard(scenario).safe, SafeSpeed)
    seen: list[tuple[Any, ...]] = []
    unconfirmed_ns = 0

    def prepared() -> Any:
        subject = module.Guard(scenario)
        subject.safe = SimpleNamespace(take=lambda *given: seen.append(given), age_ns=lambda now_ns: unconfirmed_ns)
        return subject

    subject, telegram = prepared(), SpeedSdt()
    subject.confirm(telegram, 0, 3)
    subject.speed(TrnSpeed(100_000), 10 * MS)
    subject.confirm(telegram, 10 * MS, 4)
    subject.speed(TrnSpeed(100_000, check=0, life=1), 20 * MS)
    subject.confirm(telegram, 20 * MS, 5)
    speeds = (None, 100_000, None)
    assert seen == [(telegram, 10 * place * MS, 3 + place, speed) for place, speed in enumerate(speeds)]
    edges_ms = (20, 64, 256, 1000)
    ages_ns = [0, *(edge_ms * MS + extra_ns for edge_ms in edges_ms for extra_ns in (0, MS - 1, MS))]
    for own_ns in (0, *(age_ms * MS for edge_ms in edges_ms for age_ms in (edge_ms, edge_ms + 1))):
        for safe_ns in ages_ns:
            unconfirmed_ns, subject = 0, prepared()
            subject.speed(TrnSpeed(100_000), 0)
            unconfirmed_ns = safe_ns
            subject.look(own_ns)
            level = sum(max(own_ns, safe_ns) // MS > edge_ms for edge_ms in edges_ms)
            cause = CtlCause.SAFETY_CODE if safe_ns > own_ns else CtlCause.SPEED_AGE
            assert (subject.level, subject.cause) == (level, cause if level else CtlCause.NONE)
            # The cause is that with which the level was entered.
            unconfirmed_ns = safe_ns + 1 if level else 0
            subject.look(own_ns)
            assert subject.cause is (cause if level else CtlCause.NONE)
    # Another cause of a new level is named as it is.
    unconfirmed_ns, subject = 21 * MS, prepared()
    subject.limit(TrkInfo(speed_limit_4mmps=1), 0)
    subject.speed(TrnSpeed(100_000), 0)
    assert subject.cause is CtlCause.OVERSPEED


def command_ramp(elapsed_ns: int) -> int:
    """Service brake after some time of its ramp from notch 0, as a positive code."""
    ladder = Ladder.of(SCENARIO)
    return min(ladder.service_code, ladder.ramp_code_per_s * elapsed_ns // 10**9)


#: The quick ones first: a mutant meets them up to the first that notices it.
GUARD_SWEEPS = (
    sweep_guard_wait,
    sweep_guard_may_move,
    sweep_guard_overrun,
    sweep_guard_samples,
    sweep_guard_position,
    sweep_guard_order,
    sweep_guard_safe,
    sweep_guard_findings,
    sweep_guard_random,
    sweep_guard_rows,
    sweep_guard_boundaries,
)
