"""One train of a block at one tick, in the order of ``Plant.advance``, with the plant's own functions.

:mod:`railhil.systems.ato.batch.side_by_side` computes the ticks without other events than motion.
"""

from __future__ import annotations

from bisect import bisect_right
from math import inf
from typing import Any, NamedTuple

import numpy as np

from railhil.batch import compiled
from railhil.bus.codes import Event
from railhil.common.compilable import larger, smaller
from railhil.plant_sim.ato.command_watch import (
    CommandWatchState,
    watch_brake_mps2,
    watch_step,
)
from railhil.plant_sim.ato.dynamics import Lag, Motion, Window, acceleration_mps2, applied_n, lag, step
from railhil.plant_sim.ato.forces import GradeTable, TrainConstants
from railhil.plant_sim.ato.plant import NOTCH_LSB_PER_NOTCH, SLIVER_TICKS
from railhil.plant_sim.ato.plant_readings import odometer_reading_mm, speed_reading_01mmps
from railhil.plant_sim.ato.train_checks import ForceState, forces_step, is_beyond_authority, is_running, is_weak
from railhil.systems.ato.batch import curve
from railhil.systems.ato.batch import lanes as at
from railhil.systems.ato.batch.layout import READ_BALISES, READ_ODOMETER, READ_SPEED
from railhil.systems.ato.judge.measures import error_kmh, limits_under_train, work_j
from railhil.systems.ato.scenario.model import STOP_LEG_MIN_M
from railhil.wire.ato import WatchLevel

_COMPLETE, _NOT_STOPPED = float(Event.ENDED_COMPLETE), float(Event.ENDED_NOT_STOPPED)
#: Raw SIM_TRUTH: scales of position, speed and forces, and the largest force.
TRUTH_LSB, FORCE_LSB_N, FORCE_MAX = 1e-4, 20.0, 65535.0


@compiled.side_by_side_part
def motion_of(s: Any, i: int) -> Any:
    """The motion of the train in lane ``i``."""
    return Motion(s[at.POSITION + i], s[at.SPEED + i], s[at.ACTUATOR + i], s[at.ACCEL + i])


@compiled.side_by_side_part
def set_motion(s: Any, i: int, motion: Any) -> None:
    """Note the motion of a train."""
    s[at.POSITION + i], s[at.SPEED + i] = motion.position_m, motion.speed_mps
    s[at.ACTUATOR + i], s[at.ACCEL + i] = motion.actuator_n, motion.accel_mps2


@compiled.side_by_side_part
def constants_of(s: Any, i: int, traction: Any, brake: Any) -> Any:
    """The constants of a train with its effort tables."""
    return TrainConstants(
        s[at.MASS + i],
        s[at.RESISTANCE_A + i],
        s[at.RESISTANCE_B + i],
        s[at.RESISTANCE_C + i],
        s[at.GRADE_N + i],
        s[at.POLE + i],
        traction,
        brake,
    )


@compiled.side_by_side_part
def forces_of(s: Any, i: int) -> Any:
    """Data of a train's watch on its forces."""
    return ForceState(s[at.LEFT + i], s[at.RUNNING + i], s[at.FLOOR + i], s[at.WEAK + i])


@compiled.part
def _constants(common: Any, s: Any, i: int) -> Any:
    return constants_of(s, i, common.traction, common.brake)


@compiled.part
def _window(s: Any, i: int) -> Any:
    return Window(s[at.TRACTION + i] != 0.0, s[at.BRAKE_MIN + i])


@compiled.part
def grades_of(common: Any, tables: Any, index: int, s: Any, i: int) -> Any:
    """The table of the mean grade from the train's position on: rows behind it are not searched again."""
    from_m, row = common.grade_from_m, int(s[at.GRADE_ROW + i])
    while row + 1 < from_m.size and from_m[row + 1] <= s[at.POSITION + i]:
        row += 1
    s[at.GRADE_ROW + i] = row
    return GradeTable(from_m[row:], tables.permil[index, row:], tables.permil_per_m[index, row:])


@compiled.aside
def _change_limit(common: Any, s: Any, i: int) -> None:
    """``_limit_from``: the speed limit at the train's position, and the position up to which it applies."""
    row = bisect_right(common.front_limit_from_m, s[at.POSITION + i])
    s[at.LIMIT + i] = common.front_limit_mps[larger(row - 1, 0)]
    s[at.LIMIT_TO + i] = common.front_limit_from_m[row] if row < common.front_limit_from_m.size else inf


@compiled.aside
def _restrain(common: Any, s: Any, i: int, before: float, tick: int) -> None:
    """The forces allowed by the train's watch while it brakes, or has just released the brake."""
    # Compiled, a level is a number.
    level: Any = int(s[at.LEVEL + i])
    mass_kg = s[at.MASS + i]
    if level == WatchLevel.EMERGENCY and before != WatchLevel.EMERGENCY and s[at.EMERGENCY_01MS + i] < 0:
        s[at.EMERGENCY_01MS + i] = round((tick * common.step_s + 0.0) * 1e4)
    force_n = applied_n(_constants(common, s, i), _window(s, i), motion_of(s, i))
    demand_mps2 = watch_brake_mps2(
        level,
        s[at.WATCH_BRAKE + i],
        larger(0.0, -force_n / mass_kg),
        s[at.SPEED + i] > 0.0,
        common.step_s,
        common.service_mps2,
    )
    s[at.WATCH_BRAKE + i] = demand_mps2
    s[at.TRACTION + i] = 1.0 if level < WatchLevel.TRACTION_CUT else 0.0
    s[at.BRAKE_MIN + i] = demand_mps2 * mass_kg
    if s[at.TRACTION + i] == 0.0 and s[at.ACTUATOR + i] > 0.0:
        s[at.ACTUATOR + i] = 0.0


@compiled.aside
def _look(common: Any, s: Any, i: int) -> bool:
    """``OwnChecks.finding`` at a tick at which the forces are checked."""
    if s[at.ACTING + i] > 0.0 or s[at.SPEED + i] <= 0.0:
        s[at.LEFT + i], s[at.RUNNING + i], s[at.FLOOR + i], s[at.WEAK + i] = inf, 0.0, 0.0, 0.0
        return False
    forces = forces_step(
        common.checks,
        _constants(common, s, i),
        forces_of(s, i),
        s[at.SLOW_DECAY + i],
        s[at.STEADY + i],
        s[at.ACTUATOR + i],
        s[at.BRAKE_MIN + i],
        s[at.SPEED + i],
        s[at.ACCEL + i],
    )
    s[at.LEFT + i], s[at.RUNNING + i] = forces.left_n, forces.running_looks
    s[at.FLOOR + i], s[at.WEAK + i] = forces.floor_n, forces.weak_looks
    return is_running(common.checks, forces) or is_weak(common.checks, forces)


@compiled.part
def _protect(common: Any, s: Any, i: int, tick: int, polled: bool, look_due: bool) -> None:
    """``Plant._protect`` of a train whose equipment is healthy."""
    position_m, speed_mps = s[at.POSITION + i], s[at.SPEED + i]
    found = look_due and _look(common, s, i)
    if common.checks.end_m < inf:
        found = found or is_beyond_authority(common.checks, position_m, speed_mps)
    if position_m >= s[at.LIMIT_TO + i]:
        _change_limit(common, s, i)
    before: Any = int(s[at.LEVEL + i])
    limit_mps = s[at.LIMIT + i]
    watch = watch_step(
        common.limits,
        CommandWatchState(before, int(s[at.AGE + i]), int(s[at.GOOD + i])),
        polled,
        WatchLevel.NORMAL,
        speed_mps > 0.0,
        speed_mps < limit_mps,
        found or speed_mps > limit_mps + common.overspeed_margin_mps,
    )
    s[at.LEVEL + i], s[at.AGE + i], s[at.GOOD + i] = watch.level, watch.age_ticks, watch.good
    if watch.level < WatchLevel.TRACTION_CUT and s[at.WATCH_BRAKE + i] == 0.0:
        s[at.TRACTION + i], s[at.BRAKE_MIN + i] = 1.0, 0.0
    else:
        _restrain(common, s, i, before, tick)


@compiled.aside
def move(common: Any, tables: Any, index: int, s: Any, i: int, tick: int, now: float, ticks: float) -> None:
    """``Plant._move``: a tick or a part of it with the present notch."""
    if ticks == 1.0:
        lag_step = Lag(common.step_s, s[at.LAG_DECAY + i], s[at.LAG_MEAN + i])
    else:
        lag_step = lag(s[at.POLE + i], ticks * common.step_s)
    acting = s[at.ACTING + i] if s[at.TRACTION + i] != 0.0 else smaller(s[at.ACTING + i], 0.0)
    steady_n = acting * s[at.FORCE_PER_NOTCH + i] / NOTCH_LSB_PER_NOTCH
    before_mps = s[at.SPEED + i]
    after = step(
        _constants(common, s, i),
        grades_of(common, tables, index, s, i),
        _window(s, i),
        motion_of(s, i),
        steady_n,
        lag_step,
    )
    motion = after.motion
    set_motion(s, i, motion)
    if motion.speed_mps <= 0.0 < before_mps and motion.position_m - s[at.LEG_FROM + i] >= STOP_LEG_MIN_M:
        s[at.LEG_FROM + i] = motion.position_m
        if s[at.STOP_TICK + i] < 0.0:
            after_s = (now - tick) * common.step_s + after.moving_to_s
            s[at.STOP_TICK + i] = tick + 1
            s[at.STOP_01MS + i] = round((tick * common.step_s + after_s) * 1e4)
            s[at.STOP_01MM + i] = round(motion.position_m * 1e4)


@compiled.part
def _slot_after(tables: Any, slot: int, count: int) -> int:
    """The slot of a delayed notch, ``count`` after another, at most as many as there are."""
    slot += count
    return slot if slot < tables.staged_due.shape[1] else slot - tables.staged_due.shape[1]


@compiled.part
def take_notch(tables: Any, index: int, s: Any, i: int) -> None:
    """The next notch begins to act."""
    slot = int(s[at.STAGED_FIRST + i])
    s[at.ACTING + i] = tables.staged_code[index, slot]
    s[at.STEADY + i] = s[at.ACTING + i] * s[at.FORCE_PER_NOTCH + i] / NOTCH_LSB_PER_NOTCH
    slot = _slot_after(tables, slot, 1)
    s[at.STAGED_FIRST + i] = slot
    s[at.STAGED_COUNT + i] -= 1.0
    s[at.DUE + i] = tables.staged_due[index, slot] if s[at.STAGED_COUNT + i] > 0.0 else inf


@compiled.aside
def advance(common: Any, tables: Any, index: int, s: Any, i: int, tick: int, polled: bool, look_due: bool) -> None:
    """``RunEnd.reached`` with a live controller, then ``Plant.advance``."""
    if s[at.STOP_TICK + i] >= 0.0:
        if tick >= s[at.STOP_TICK + i] + common.after_stop_ticks:
            s[at.ENDED + i], s[at.END_TICK + i] = _COMPLETE, tick
    elif tick > common.last_tick:
        s[at.ENDED + i], s[at.END_TICK + i] = _NOT_STOPPED, tick
    if s[at.ENDED + i] != 0.0:
        return
    _protect(common, s, i, tick, polled, look_due)
    now, end = float(tick), tick + 1
    while True:
        due = s[at.DUE + i]
        to = smaller(due, float(end))
        if to - now > SLIVER_TICKS:
            move(common, tables, index, s, i, tick, now, to - now)
            now = to
        if due > end:
            return
        take_notch(tables, index, s, i)


class Truth(NamedTuple):
    """A SIM_TRUTH, quantised to its raw integers, and the sums of the score with it."""

    position_01mm: float
    speed_mps: float
    traction_w: float
    brake_w: float
    traction_j: float
    brake_j: float
    overspeed_mps: float
    error_kmh: float


@compiled.side_by_side_part
def truth_of(s: Any, i: int, force_n: float, seconds: float, allowed_mps: float) -> Any:
    """The SIM_TRUTH of a train.

    :param force_n: on the train; ``seconds`` since the one before.
    """
    speed_mps = np.rint(s[at.SPEED + i] * 1e4) * TRUTH_LSB
    traction_w = smaller(np.rint(larger(0.0, force_n) / FORCE_LSB_N), FORCE_MAX) * FORCE_LSB_N * speed_mps
    brake_w = smaller(np.rint(larger(0.0, -force_n) / FORCE_LSB_N), FORCE_MAX) * FORCE_LSB_N * speed_mps
    return Truth(
        np.rint(s[at.POSITION + i] * 1e4),
        speed_mps,
        traction_w,
        brake_w,
        s[at.TRACTION_J + i] + work_j(seconds, s[at.TRACTION_W + i], traction_w),
        s[at.BRAKE_J + i] + work_j(seconds, s[at.BRAKE_W + i], brake_w),
        larger(s[at.OVERSPEED + i], speed_mps - allowed_mps),
        error_kmh(s[at.WANTED + i], speed_mps),
    )


@compiled.aside
def sample(common: Any, s: Any, i: int, number: int, judged: bool) -> None:
    """Add a SIM_TRUTH to the sums of the score.

    :param judged: the speed error counts; the wanted speed is in the lane.
    """
    s[at.SAMPLES + i] = number + 1
    force_n = applied_n(_constants(common, s, i), _window(s, i), motion_of(s, i))
    seconds = common.truth_s[number] - common.truth_s[number - 1] if number > 0 else 0.0
    front_m = np.rint(s[at.POSITION + i] * 1e4) * TRUTH_LSB
    truth = truth_of(s, i, force_n, seconds, limits_under_train(common.line_limits, front_m, common.length_m))
    if number > 0:
        if s[at.STOP_TICK + i] < 0.0 or common.truth_s[number] <= s[at.STOP_01MS + i] * TRUTH_LSB:
            s[at.TRACTION_J + i], s[at.BRAKE_J + i] = truth.traction_j, truth.brake_j
        s[at.ERROR + i] = truth.error_kmh if judged else 0.0
    s[at.TRUE_POSITION + i], s[at.OVERSPEED + i] = truth.position_01mm, truth.overspeed_mps
    s[at.TRACTION_W + i], s[at.BRAKE_W + i] = truth.traction_w, truth.brake_w


@compiled.aside
def acceleration_mps2_of(common: Any, tables: Any, index: int, s: Any, i: int) -> float:
    """The acceleration of a SIM_TRUTH."""
    grades = grades_of(common, tables, index, s, i)
    now: float = acceleration_mps2(_constants(common, s, i), grades, _window(s, i), motion_of(s, i))
    return now


@compiled.part
def wanted_mps(common: Any, s: Any, i: int) -> float:
    """The set-point by distance at the position of a SIM_TRUTH."""
    return curve.passing_mps(common.target, np.rint(s[at.POSITION + i] * 1e4) * TRUTH_LSB)


@compiled.part
def command(common: Any, tables: Any, index: int, s: Any, i: int, notch_code: int, tick: int) -> None:
    """``Plant.command`` with the law's notch; later polls repeat the code."""
    code = smaller(larger(notch_code, -common.notch_max_code), common.notch_max_code)
    if code != s[at.LAST_CODE + i]:
        s[at.LAST_CODE + i] = code
        slot = _slot_after(tables, int(s[at.STAGED_FIRST + i]), int(s[at.STAGED_COUNT + i]))
        due = tick + s[at.DELAY_TICKS + i]
        tables.staged_due[index, slot], tables.staged_code[index, slot] = due, code
        if s[at.STAGED_COUNT + i] == 0.0:
            s[at.DUE + i] = due
        s[at.STAGED_COUNT + i] += 1.0


@compiled.part
def read(common: Any, tables: Any, index: int, s: Any, i: int, noise: float) -> None:
    """The law's inputs at a poll: balises passed, the speed with its noise, the odometer."""
    readings, balises, place = tables.readings, tables.balise_m, tables.order[index]
    passed = readings[READ_BALISES, place]
    while passed < balises.shape[1] and balises[index, passed] <= s[at.POSITION + i]:
        passed += 1
    readings[READ_BALISES, place] = passed
    readings[READ_SPEED, place] = speed_reading_01mmps(
        s[at.SPEED + i], noise * s[at.NOISE + i], s[at.WHEEL + i], common.speed_lsb_mps
    )
    shown_mm = odometer_reading_mm(s[at.SHOWN + i], s[at.WHEEL + i], common.odometer_lsb_m)
    readings[READ_ODOMETER, place] = shown_mm * 10
