"""One train at one tick on its record, in the order of ``Plant.advance``, for whatever is not a steady run.

Dynamics, watch and readings are the plant's own functions; only their order is repeated here.
"""

from __future__ import annotations

from bisect import bisect_right
from math import inf
from typing import Any

from railhil.batch import compiled, curve
from railhil.batch.layout import READ_BALISES, READ_ODOMETER, READ_SPEED
from railhil.bus.codes import Event
from railhil.bus.telegrams import STOP_LEG_MIN_M
from railhil.common.compilable import larger, smaller
from railhil.plant_sim.command_watch import CommandWatchLevel, CommandWatchState, watch_brake_mps2, watch_step
from railhil.plant_sim.dynamics import Lag, Motion, Window, acceleration_mps2, applied_n, lag, step
from railhil.plant_sim.forces import GradeTable, TrainConstants
from railhil.plant_sim.plant import NOTCH_LSB_PER_NOTCH, SLIVER_TICKS
from railhil.plant_sim.sensors import odometer_reading_mm, speed_reading_01mmps
from railhil.plant_sim.train_checks import ForceState, forces_step, is_beyond_authority, is_running, is_weak
from railhil.supervisor.measures import error_kmh, limits_under_train, work_j

_COMPLETE, _NOT_STOPPED = int(Event.ENDED_COMPLETE), int(Event.ENDED_NOT_STOPPED)
#: Raw SIM_TRUTH: scales of position, speed and forces.
TRUTH_LSB, FORCE_LSB_N = 1e-4, 20


@compiled.part
def _constants(common: Any, train: Any) -> Any:
    return TrainConstants(
        train.mass_kg,
        train.resistance_a_n,
        train.resistance_b_n_per_mps,
        train.resistance_c_n_per_mps2,
        train.grade_n_per_permil,
        train.pole_per_s,
        common.traction,
        common.brake,
    )


@compiled.part
def grades(common: Any, tables: Any, index: int, train: Any) -> Any:
    """The table of the mean grade from the train's position on: rows behind it are not searched again."""
    from_m, row = common.grade_from_m, train.grade_row
    while row + 1 < from_m.size and from_m[row + 1] <= train.position_m:
        row += 1
    train.grade_row = row
    return GradeTable(from_m[row:], tables.permil[index, row:], tables.permil_per_m[index, row:])


@compiled.part
def _motion(train: Any) -> Any:
    return Motion(train.position_m, train.speed_mps, train.actuator_n, train.accel_mps2)


@compiled.part
def _window(train: Any) -> Any:
    return Window(train.traction != 0, train.brake_min_n)


@compiled.aside
def _change_limit(common: Any, train: Any) -> None:
    """``_limit_from``: the speed limit at the train's position, and the position up to which it applies."""
    row = bisect_right(common.front_limit_from_m, train.position_m)
    train.limit_mps = common.front_limit_mps[larger(row - 1, 0)]
    train.limit_to_m = common.front_limit_from_m[row] if row < common.front_limit_from_m.size else inf


@compiled.aside
def _restrain(common: Any, train: Any, before: int, tick: int) -> None:
    """The forces allowed by the train's watch while it brakes, or has just released the brake."""
    if (
        train.level == CommandWatchLevel.EMERGENCY
        and before != CommandWatchLevel.EMERGENCY
        and train.emergency_01ms < 0
    ):
        train.emergency_01ms = round((tick * common.step_s + 0.0) * 1e4)
    force_n = applied_n(_constants(common, train), _window(train), _motion(train))
    train.watch_brake_mps2 = watch_brake_mps2(
        train.level,
        train.watch_brake_mps2,
        larger(0.0, -force_n / train.mass_kg),
        train.speed_mps > 0.0,
        common.step_s,
        common.service_mps2,
    )
    train.traction = 1 if train.level < CommandWatchLevel.TRACTION_CUT else 0
    train.brake_min_n = train.watch_brake_mps2 * train.mass_kg
    if train.traction == 0 and train.actuator_n > 0.0:
        train.actuator_n = 0.0


@compiled.aside
def _look(common: Any, train: Any) -> bool:
    """``OwnChecks.finding`` at a tick at which the forces are looked at."""
    if train.acting_code > 0 or train.speed_mps <= 0.0:
        train.left_n, train.running_looks, train.floor_n, train.weak_looks = inf, 0, 0.0, 0
        return False
    forces = forces_step(
        common.checks,
        _constants(common, train),
        ForceState(train.left_n, train.running_looks, train.floor_n, train.weak_looks),
        train.slow_decay,
        train.acting_code * train.force_per_notch_n / NOTCH_LSB_PER_NOTCH,
        train.actuator_n,
        train.brake_min_n,
        train.speed_mps,
        train.accel_mps2,
    )
    train.left_n, train.running_looks = forces.left_n, forces.running_looks
    train.floor_n, train.weak_looks = forces.floor_n, forces.weak_looks
    return is_running(common.checks, forces) or is_weak(common.checks, forces)


@compiled.part
def _protect(common: Any, train: Any, tick: int, polled: bool, look_due: bool) -> None:
    """``Plant._protect`` of a train whose equipment is healthy."""
    found = look_due and _look(common, train)
    if common.checks.end_m < inf:
        found = found or is_beyond_authority(common.checks, train.position_m, train.speed_mps)
    if train.position_m >= train.limit_to_m:
        _change_limit(common, train)
    before = train.level
    watch = watch_step(
        common.limits,
        CommandWatchState(before, train.age_ticks, train.good),
        polled,
        CommandWatchLevel.NORMAL,
        train.speed_mps > 0.0,
        train.speed_mps < train.limit_mps,
        found or train.speed_mps > train.limit_mps + common.overspeed_margin_mps,
    )
    train.level, train.age_ticks, train.good = watch.level, watch.age_ticks, watch.good
    if watch.level < CommandWatchLevel.TRACTION_CUT and train.watch_brake_mps2 == 0.0:
        train.traction, train.brake_min_n = 1, 0.0
    else:
        _restrain(common, train, before, tick)


@compiled.part
def _move(common: Any, grades: Any, train: Any, tick: int, now: float, ticks: float) -> None:
    """``Plant._move``: a tick or a part of it with the present notch."""
    if ticks == 1.0:
        lag_step = Lag(common.step_s, train.lag_decay, train.lag_mean)
    else:
        lag_step = lag(train.pole_per_s, ticks * common.step_s)
    notch = train.acting_code if train.traction != 0 else smaller(train.acting_code, 0)
    steady_n = notch * train.force_per_notch_n / NOTCH_LSB_PER_NOTCH
    before_mps = train.speed_mps
    after = step(_constants(common, train), grades, _window(train), _motion(train), steady_n, lag_step)
    motion = after.motion
    train.position_m, train.speed_mps = motion.position_m, motion.speed_mps
    train.actuator_n, train.accel_mps2 = motion.actuator_n, motion.accel_mps2
    if motion.speed_mps <= 0.0 < before_mps and motion.position_m - train.leg_from_m >= STOP_LEG_MIN_M:
        train.leg_from_m = motion.position_m
        if train.stop_tick < 0:
            after_s = (now - tick) * common.step_s + after.moving_to_s
            train.stop_tick = tick + 1
            train.stop_01ms = round((tick * common.step_s + after_s) * 1e4)
            train.stop_01mm = round(motion.position_m * 1e4)


@compiled.part
def slot_after(tables: Any, slot: int, count: int) -> int:
    """The slot of a delayed notch, ``count`` after another, at most as many as there are."""
    slot += count
    return slot if slot < tables.staged_due.shape[1] else slot - tables.staged_due.shape[1]


@compiled.part
def advance(
    common: Any, tables: Any, index: int, grades: Any, train: Any, tick: int, polled: bool, look_due: bool
) -> None:
    """``Plant.advance``: one tick."""
    _protect(common, train, tick, polled, look_due)
    now, end = float(tick), tick + 1
    due, codes = tables.staged_due, tables.staged_code
    while True:
        staged = train.staged_count > 0 and due[index, train.staged_first] <= end
        to = due[index, train.staged_first] if staged else float(end)
        if to - now > SLIVER_TICKS:
            _move(common, grades, train, tick, now, to - now)
            now = to
        if not staged:
            return
        train.acting_code = codes[index, train.staged_first]
        train.staged_first = slot_after(tables, train.staged_first, 1)
        train.staged_count -= 1


@compiled.part
def truth(common: Any, tables: Any, index: int, grades: Any, train: Any, sample: int) -> None:
    """Add a SIM_TRUTH to the sums of the score, quantised to its raw integers."""
    train.samples = sample + 1
    train.true_position_01mm = round(train.position_m * 1e4)
    position_m = train.true_position_01mm * TRUTH_LSB
    speed_mps = round(train.speed_mps * 1e4) * TRUTH_LSB
    force_n = applied_n(_constants(common, train), _window(train), _motion(train))
    traction_w = smaller(round(larger(0.0, force_n) / FORCE_LSB_N), 0xFFFF) * FORCE_LSB_N * speed_mps
    brake_w = smaller(round(larger(0.0, -force_n) / FORCE_LSB_N), 0xFFFF) * FORCE_LSB_N * speed_mps
    if sample > 0:
        now_s = common.truth_s[sample]
        if train.stop_tick < 0 or now_s <= train.stop_01ms * TRUTH_LSB:
            seconds = now_s - common.truth_s[sample - 1]
            train.traction_j += work_j(seconds, train.traction_w, traction_w)
            train.brake_j += work_j(seconds, train.brake_w, brake_w)
        if sample < common.cycle.size and common.cycle[sample] >= 0:
            wanted = curve.passing_mps(common.target, position_m) if common.by_distance else common.wanted_mps[sample]
            tables.error_sums_kmh[common.cycle[sample], index] += error_kmh(wanted, speed_mps)
    train.traction_w, train.brake_w = traction_w, brake_w
    train.overspeed_mps = larger(
        train.overspeed_mps, speed_mps - limits_under_train(common.line_limits, position_m, common.length_m)
    )
    column = common.control_sample[sample]
    if column >= 0:
        now = acceleration_mps2(_constants(common, train), grades, _window(train), _motion(train))
        tables.control_accel_raw[index, column] = smaller(larger(round(now * 1e4), -0x8000), 0x7FFF)


@compiled.part
def end(common: Any, train: Any, tick: int) -> None:
    """``RunEnd.reached``, with a live controller."""
    if train.stop_tick >= 0:
        if tick >= train.stop_tick + common.after_stop_ticks:
            train.ended, train.end_tick = _COMPLETE, tick
    elif tick > common.last_tick:
        train.ended, train.end_tick = _NOT_STOPPED, tick


@compiled.part
def command(common: Any, tables: Any, index: int, train: Any, notch_code: int, tick: int) -> None:
    """``Plant.command`` with the law's notch; later polls repeat the code."""
    code = smaller(larger(notch_code, -common.notch_max_code), common.notch_max_code)
    if code != train.staged_last:
        train.staged_last = code
        slot = slot_after(tables, train.staged_first, train.staged_count)
        tables.staged_due[index, slot] = tick + train.delay_ticks
        tables.staged_code[index, slot] = code
        train.staged_count += 1


@compiled.part
def pass_balises(tables: Any, index: int, position_m: float) -> None:
    """Count the balises passed at a position."""
    readings, balises, place = tables.readings, tables.balise_m, tables.order[index]
    while (
        readings[READ_BALISES, place] < balises.shape[1] and balises[index, readings[READ_BALISES, place]] <= position_m
    ):
        readings[READ_BALISES, place] += 1


@compiled.part
def read(common: Any, tables: Any, index: int, train: Any, noise: float) -> None:
    """The law's inputs at a poll: balises passed, and the speed with its noise."""
    pass_balises(tables, index, train.position_m)
    noise_mps = noise * train.noise_sigma_mps
    tables.readings[READ_SPEED, tables.order[index]] = speed_reading_01mmps(
        train.speed_mps, noise_mps, train.wheel_factor, common.speed_lsb_mps
    )


@compiled.part
def show(common: Any, tables: Any, index: int, train: Any, position_m: float) -> None:
    """The odometer at a position."""
    shown_mm = odometer_reading_mm(position_m, train.wheel_factor, common.odometer_lsb_m)
    tables.readings[READ_ODOMETER, tables.order[index]] = shown_mm * 10
