"""Ticks of a block without other events than motion, all trains side by side, with the plant's own functions.

The plant's functions are compiled here without those that are seldom needed (:func:`railhil.batch.compiled.straight`),
and with tables of one row, so that a loop over them has no calls and no branches that the processor cannot replace by a
choice. A train that leaves its rows, or needs a seldom function, stays as it is and is marked: :mod:`.train` computes
it.
"""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

from railhil.batch import compiled
from railhil.plant_sim.ato import dynamics, train_checks
from railhil.plant_sim.ato.dynamics import FREE, Lag
from railhil.plant_sim.ato.forces import EffortLimit, GradeTable
from railhil.systems.ato.batch import lanes as at
from railhil.systems.ato.batch.lanes import LANES
from railhil.systems.ato.batch.train import constants_of, forces_of, motion_of, truth_of

_step = compiled.straight(dynamics.step)
_applied_n = compiled.straight(dynamics.applied_n)
_forces_step = compiled.straight(train_checks.forces_step)
_is_running = compiled.straight(train_checks.is_running)
_is_weak = compiled.straight(train_checks.is_weak)
_is_beyond_authority = compiled.straight(train_checks.is_beyond_authority)
_acceleration_mps2 = compiled.straight(dynamics.acceleration_mps2)


class Numbers(NamedTuple):
    """The numbers of :class:`.layout.Common` that are needed here: a call with all of its tables takes as
    long as a loop."""

    step_s: float
    traction_max_n: float
    traction_max_w: float
    brake_max_n: float
    brake_max_w: float
    overspeed_margin_mps: float
    checks: Any


@compiled.part
def numbers_of(common: Any) -> Any:
    """The numbers that are needed here."""
    return Numbers(
        common.step_s,
        common.traction.force_max_n,
        common.traction.power_max_w,
        common.brake.force_max_n,
        common.brake.power_max_w,
        common.overspeed_margin_mps,
        common.checks,
    )


@compiled.side_by_side_part
def _constants(numbers: Any, s: Any, i: int) -> Any:
    """The constants of a train with the rows of the effort curves in which its speed lies."""
    return constants_of(
        s,
        i,
        EffortLimit(
            numbers.traction_max_n,
            numbers.traction_max_w,
            (s[at.TRACTION_FROM + i], s[at.TRACTION_TO + i]),
            (s[at.TRACTION_FIRST + i], s[at.TRACTION_LAST + i]),
        ),
        EffortLimit(
            numbers.brake_max_n,
            numbers.brake_max_w,
            (s[at.BRAKE_FROM + i], s[at.BRAKE_TO + i]),
            (s[at.BRAKE_FIRST + i], s[at.BRAKE_LAST + i]),
        ),
    )


@compiled.side_by_side_part
def _grades(s: Any, i: int) -> Any:
    """The row of the grades in which a train is."""
    return GradeTable((s[at.GRADE_FROM + i],), (s[at.PERMIL + i],), (s[at.PERMIL_PER_M + i],))


@compiled.side_by_side_part
def _moved(numbers: Any, s: Any, i: int) -> Any:
    """The motion of a train after the part of a tick that is computed."""
    lag = Lag(s[at.PART_S + i], s[at.PART_DECAY + i], s[at.PART_MEAN + i])
    return _step(_constants(numbers, s, i), _grades(s, i), FREE, motion_of(s, i), s[at.STEADY + i], lag).motion


@compiled.side_by_side_part
def _is_in_its_rows(s: Any, i: int, step_s: float) -> Any:
    """Whether speed and place stay in their rows for a time in which the acceleration is at most the present one."""
    position_m, speed_mps, _, accel_mps2 = motion_of(s, i)
    change_mps = abs(accel_mps2) * step_s
    return (
        (s[at.ORDINARY + i] > 0.0)
        & (speed_mps - change_mps >= s[at.SPEED_FROM + i])
        & (speed_mps + change_mps < s[at.SPEED_TO + i])
        & (position_m + speed_mps * step_s < s[at.PLACE_TO + i])
    )


@compiled.side_by_side
def look(numbers: Any, s: Any) -> None:
    """``OwnChecks.finding`` at a tick at which the forces are checked; a finding is marked."""
    checks = numbers.checks
    for i in range(LANES):
        before = forces_of(s, i)
        forces = _forces_step(
            checks,
            _constants(numbers, s, i),
            before,
            s[at.SLOW_DECAY + i],
            s[at.STEADY + i],
            s[at.ACTUATOR + i],
            0.0,
            s[at.SPEED + i],
            s[at.ACCEL + i],
        )
        pulls = s[at.ACTING + i] > 0.0
        known = _is_in_its_rows(s, i, 0.0) & (pulls | (not (_is_running(checks, forces) or _is_weak(checks, forces))))
        s[at.LEFT + i] = (inf if pulls else forces.left_n) if known else before.left_n
        s[at.RUNNING + i] = (0.0 if pulls else forces.running_looks) if known else before.running_looks
        s[at.FLOOR + i] = (0.0 if pulls else forces.floor_n) if known else before.floor_n
        s[at.WEAK + i] = (0.0 if pulls else forces.weak_looks) if known else before.weak_looks
        s[at.LOOK_LEFT + i] = 0.0 if known else 1.0


@compiled.side_by_side
def advance(numbers: Any, s: Any, looked: bool) -> int:
    """``Plant.advance`` of every train by a tick, or by the first part of it; returns the number of trains left.

    :param looked: :func:`look` was called in this tick.
    """
    step_s, margin_mps, checks = numbers.step_s, numbers.overspeed_margin_mps, numbers.checks
    marked = 0
    for i in range(LANES):
        before = motion_of(s, i)
        after = _moved(numbers, s, i)
        known = (
            _is_in_its_rows(s, i, step_s)
            & (before.speed_mps <= s[at.LIMIT + i] + margin_mps)
            & (not _is_beyond_authority(checks, before.position_m, before.speed_mps))
            & (after.position_m == after.position_m)
            & ((s[at.LOOK_LEFT + i] == 0.0) | (not looked))
        )
        moves = known & (s[at.PART_S + i] > 0.0)
        s[at.POSITION + i] = after.position_m if moves else before.position_m
        s[at.SPEED + i] = after.speed_mps if moves else before.speed_mps
        s[at.ACTUATOR + i] = after.actuator_n if moves else before.actuator_n
        s[at.ACCEL + i] = after.accel_mps2 if moves else before.accel_mps2
        left = (not known) & (s[at.ENDED + i] == 0.0)
        s[at.TICK_LEFT + i] = 1.0 if left else 0.0
        marked += 1 if left else 0
    return marked


@compiled.side_by_side
def move(numbers: Any, s: Any) -> int:
    """``Plant._move`` of every train by the second part of a tick, if it has one; returns the number of trains left."""
    step_s = numbers.step_s
    marked = 0
    for i in range(LANES):
        before = motion_of(s, i)
        after = _moved(numbers, s, i)
        moves = s[at.PART_S + i] > 0.0
        known = moves & _is_in_its_rows(s, i, step_s) & (after.position_m == after.position_m)
        s[at.POSITION + i] = after.position_m if known else before.position_m
        s[at.SPEED + i] = after.speed_mps if known else before.speed_mps
        s[at.ACTUATOR + i] = after.actuator_n if known else before.actuator_n
        s[at.ACCEL + i] = after.accel_mps2 if known else before.accel_mps2
        left = moves & (not known)
        s[at.TICK_LEFT + i] = 1.0 if left else 0.0
        marked += 1 if left else 0
    return marked


@compiled.side_by_side
def sample(numbers: Any, s: Any, seconds: float, number: int, judged: bool) -> int:
    """Add a SIM_TRUTH of every train to the sums of the score; returns the number of trains left."""
    marked = 0
    for i in range(LANES):
        force_n = _applied_n(_constants(numbers, s, i), FREE, motion_of(s, i))
        truth = truth_of(s, i, force_n, seconds, s[at.ALLOWED + i])
        known = _is_in_its_rows(s, i, 0.0)
        s[at.SAMPLES + i] = number + 1.0 if known else s[at.SAMPLES + i]
        s[at.TRUE_POSITION + i] = truth.position_01mm if known else s[at.TRUE_POSITION + i]
        s[at.TRACTION_J + i] = truth.traction_j if known else s[at.TRACTION_J + i]
        s[at.BRAKE_J + i] = truth.brake_j if known else s[at.BRAKE_J + i]
        s[at.TRACTION_W + i] = truth.traction_w if known else s[at.TRACTION_W + i]
        s[at.BRAKE_W + i] = truth.brake_w if known else s[at.BRAKE_W + i]
        s[at.OVERSPEED + i] = truth.overspeed_mps if known else s[at.OVERSPEED + i]
        s[at.ERROR + i] = truth.error_kmh if known & judged else 0.0
        left = (not known) & (s[at.ENDED + i] == 0.0)
        s[at.TICK_LEFT + i] = 1.0 if left else 0.0
        marked += 1 if left else 0
    return marked


@compiled.side_by_side
def accelerate(numbers: Any, s: Any) -> None:
    """``SIM_TRUTH.TrueAccel`` of every train that :func:`sample` knows, in m/s2."""
    for i in range(LANES):
        s[at.NOW + i] = _acceleration_mps2(_constants(numbers, s, i), _grades(s, i), FREE, motion_of(s, i))
