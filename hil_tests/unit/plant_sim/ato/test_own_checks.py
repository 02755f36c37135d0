"""The train's own checks at their limits, look by look, with numbers of no train."""

from __future__ import annotations

from dataclasses import replace
from math import exp, inf
from typing import Any

import pytest

from railhil.plant_sim.ato import train_checks as checks_of_train
from railhil.plant_sim.ato.dynamics import Motion
from railhil.plant_sim.ato.force_tables import train_constants
from railhil.plant_sim.ato.train_checks import (
    FREE_FORCES,
    ForceState,
    OwnChecks,
    TrainChecks,
    forces_step,
    is_beyond_authority,
    is_running,
    is_weak,
    slow_decay,
    train_checks,
)
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Effort
from railhil.wire.ato import WatchCause

SCENARIO = load("lvshun_tieshan")
CHECKS = TrainChecks(5, 1000.0, 0.5, 100.0, 2, 0.5, 0.25, 20)
#: 1000 kg; at 10 m/s a brake of 2000 N.
CONSTANTS = train_constants(replace(SCENARIO.train, inertial_mass_kg=1000.0, brake=Effort(1e6, power_max_w=20_000.0)))
NONE = WatchCause.NONE


def test_the_limits_of_a_scenario() -> None:
    watch = replace(
        SCENARIO.watch, end_of_authority=True, end_of_authority_margin_m=7.0, end_of_authority_braking_mps2=0.61,
        traction_left_max_percent=13.0, brake_share_min_percent=47.0, grade_allowance_permil=31.0,
    )  # fmt: skip
    train = replace(SCENARIO.train, traction=Effort(2000.0), gravity_mps2=10.0)
    for tick_ms, look_ticks, running, weak in (
        (10, 5, 2, 20),
        (20, 2, 2, 25),
        (0.1, 500, 2, 20),
        (34, 1, 3, 29),
        (200, 1, 0, 5),
    ):
        timing = replace(SCENARIO.timing, base_tick_ns=round(tick_ms * 1e6))
        scenario = replace(SCENARIO, watch=watch, train=train, timing=timing)
        found = train_checks(scenario)
        assert found == pytest.approx(
            (look_ticks, SCENARIO.plan.distance_m + 7.0, 0.61, 260.0, running, 0.47, 0.31, weak)
        )
    assert train_checks(SCENARIO).end_m == inf
    assert checks_of_train.SLOWEST == 0.9
    assert slow_decay(CHECKS, 3.4, 0.01) == pytest.approx(exp(-0.9 * 3.4 * 0.05), rel=1e-12)


def test_the_end_of_authority_at_its_edge() -> None:
    # 9 m before the end: 3 m/s with 0.5 m/s2.
    assert not is_beyond_authority(CHECKS, 991.0, 3.0)
    assert is_beyond_authority(CHECKS, 991.0, 3.0001)
    for place_m in (1000.0, 1100.0):
        assert is_beyond_authority(CHECKS, place_m, 0.1)
        assert not is_beyond_authority(CHECKS, place_m, 0.0)


def step(state: ForceState = FREE_FORCES, **given: Any) -> ForceState:
    values = {
        "decay": 0.5, "steady_n": 0.0, "actuator_n": 0.0, "brake_min_n": 0.0, "speed_mps": 10.0, "accel_mps2": 0.0,
    }  # fmt: skip
    return forces_step(CHECKS, CONSTANTS, state, **{**values, **given})


def test_traction_that_is_left_decays() -> None:
    assert (inf, 0, 0.0, 0) == FREE_FORCES
    state = step(actuator_n=400.0)
    assert state == (400.0, 0, 0.0, 0)
    # Half of it is explained, and 100 N beside it.
    assert step(state, actuator_n=300.0) == (200.0, 0, 0.0, 0)
    state = step(state, actuator_n=300.5)
    assert state == (200.0, 1, 0.0, 0)
    assert step(state, actuator_n=250.0) == (100.0, 2, 0.0, 0)
    assert step(state, actuator_n=50.0) == (50.0, 0, 0.0, 0)
    assert step(state, actuator_n=-50.0) == (0.0, 0, 0.0, 0)
    assert step(ForceState(0.8, 0, 0.0, 0), actuator_n=0.2) == (0.2, 0, 0.0, 0)
    assert [is_running(CHECKS, ForceState(0.0, looks, 0.0, 9)) for looks in (0, 2, 3)] == [False, False, True]


def test_the_braking_that_is_due() -> None:
    """Half the demand, of 1000 kg, less 250 N."""
    # The acting notch demands 1600 N, of which half is reached at a look: then 3/4.
    state = step(steady_n=-1600.0, accel_mps2=-0.15)
    assert state == (0.0, 0, 800.0, 0)
    state = step(steady_n=-1600.0, accel_mps2=-0.15)
    assert step(state, steady_n=-1600.0, accel_mps2=-0.35) == (0.0, 0, 1200.0, 0)
    assert step(state, steady_n=-1600.0, accel_mps2=-0.349) == (0.0, 0, 1200.0, 1)
    assert step(state._replace(weak_looks=7), steady_n=-1600.0, accel_mps2=-0.349).weak_looks == 8
    assert step(state._replace(weak_looks=7), steady_n=-1600.0, accel_mps2=-0.35).weak_looks == 0
    # A smaller demand counts at once.
    assert step(state, steady_n=-300.0).floor_n == 300.0
    # A demand that half of the allowance hides, and one just above: 500 N and 502 N.
    assert step(brake_min_n=500.0, accel_mps2=1.0).weak_looks == 0
    assert step(brake_min_n=502.0, accel_mps2=-0.0005).weak_looks == 1
    assert step(brake_min_n=502.0, accel_mps2=-0.0015).weak_looks == 0
    # Never more than half of what the brake can: 2000 N at 10 m/s, 400 N at 50 m/s.
    assert step(brake_min_n=inf, accel_mps2=-0.75).weak_looks == 0
    assert step(brake_min_n=inf, accel_mps2=-0.749).weak_looks == 1
    assert step(brake_min_n=inf, accel_mps2=9.0, speed_mps=50.0).weak_looks == 0
    # At the allowance exactly nothing is due: 250 N.
    assert step(brake_min_n=inf, accel_mps2=9.0, speed_mps=40.0).weak_looks == 0
    assert [is_weak(CHECKS, ForceState(0.0, 99, 0.0, looks)) for looks in (0, 20, 21)] == [False, False, True]


def own(end: bool = False) -> OwnChecks:
    watch = replace(SCENARIO.watch, end_of_authority=end)
    scenario = replace(SCENARIO, watch=watch)
    return OwnChecks(scenario, train_constants(scenario.train))


def test_what_is_looked_at_and_when() -> None:
    assert (own().every_ticks, own(True).every_ticks) == (5, 1)
    end_m = SCENARIO.plan.distance_m
    beyond = Motion(end_m + 50.0, 10.0, 0.0, 0.0)
    assert own().finding(1, 0, beyond, 0.0) is NONE
    assert own(True).finding(1, 0, beyond, 0.0) is WatchCause.END_OF_AUTHORITY
    assert own(True).finding(1, 0, beyond._replace(position_m=0.0), 0.0) is NONE
    # Traction of one notch that nobody demands, from its third look on; the first one tells what is left.
    train = SCENARIO.train
    moving = Motion(0.0, 10.0, 0.0, 0.0)
    pushed = moving._replace(actuator_n=train.traction.force_max_n)
    for begin, code, speed_mps, found in ((0, 0, 10.0, True), (0, 1, 10.0, False), (0, 0, 0.0, False)):
        subject = own()
        assert subject.finding(begin, 0, moving, 0.0) is NONE
        causes = [subject.finding(tick, code, pushed._replace(speed_mps=speed_mps), 0.0) for tick in range(1, 5 * 4)]
        assert causes == [WatchCause.RUNAWAY if found and tick == 15 else NONE for tick in range(1, 20)]
    # Full service brake by the notch: weak after a second of looks.
    subject = own()
    hard = -round(train.service_braking_mps2 * train.inertial_mass_kg / train.force_per_notch_n * 256)
    looks = [subject.finding(5 * look, hard, moving, 0.0) for look in range(200)]
    first = looks.index(WatchCause.BRAKE_NOT_ANSWERING)
    checks, floors_n = train_checks(SCENARIO), [0.0]
    decay = slow_decay(checks, train.actuator_pole_per_s, 0.01)
    for _ in looks:
        floors_n.append(floors_n[-1] * decay - hard * train.force_per_notch_n / 256 * (1 - decay))
    # The look that finds it is the first after 20 at which half of the demand exceeded what a grade may take.
    assert (
        sum(floor_n * 0.5 > checks.allowance_mps2 * train.inertial_mass_kg for floor_n in floors_n[1 : first + 1]) == 20
    )
    assert subject._decay == decay
    assert subject._forces.floor_n == pytest.approx(floors_n[-1], rel=1e-9)
    # Slow is not standing.
    subject.finding(5 * 200, hard, moving._replace(speed_mps=0.3), 0.0)
    assert subject._forces.weak_looks > 100
    assert subject.finding(5 * 201, 0, moving._replace(speed_mps=0.0), 0.0) is NONE
    assert subject._forces == FREE_FORCES
