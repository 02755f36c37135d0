"""Calm trains side by side: a control period of which bounds say beforehand that nothing happens in it but motion.

:func:`judge` bounds forces, speed and position of each lane over the period. Where no force, no speed and no place of
these bounds meets a limit, no effort curve changes its row, and the train neither stops nor ends its run, each case
that :mod:`railhil.batch.steady` looks for in every tick is decided. What is left has no cases: the sums and products of
:mod:`railhil.plant_sim.dynamics`, :mod:`railhil.plant_sim.train_checks` and :mod:`railhil.supervisor.measures` in their
order, with the same bits. Grades and the next notch, which change in most periods, are looked after by
:mod:`railhil.batch.window`. A lane that is not calm is computed as well, and its numbers are not used.
"""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from railhil.batch import compiled
from railhil.batch.lanes import (
    ACCEL,
    ACTUATOR,
    ALLOWED,
    BRAKE_FROM,
    BRAKE_J,
    BRAKE_N,
    BRAKE_RISE,
    BRAKE_START,
    BRAKE_TO,
    BRAKE_W,
    BRAKE_WIDTH,
    CALM,
    DECAY,
    FIRST_S,
    FLOOR,
    GRADE_FROM,
    GRADE_N,
    GRADE_TO,
    LANES,
    LEFT,
    LIMIT_TO,
    LOOK_LEFT,
    MASS,
    MEAN,
    NEXT_STEADY,
    NOISE_MPS,
    NOW,
    ODOMETER_READ,
    OVERSPEED,
    PERMIL,
    PERMIL_PER_M,
    POSITION,
    REACH,
    RESISTANCE_A,
    RESISTANCE_B,
    RESISTANCE_C,
    RUNNING,
    SECOND_S,
    SHOWN,
    SLOW_DECAY,
    SPEED,
    SPEED_READ,
    SPLIT,
    STEADY,
    STEADY_RUN,
    STEEPEST,
    SUM_KMH,
    TRACTION_FROM,
    TRACTION_J,
    TRACTION_N,
    TRACTION_RISE,
    TRACTION_START,
    TRACTION_TO,
    TRACTION_W,
    TRACTION_WIDTH,
    TRIP,
    TRUE_POSITION,
    WANTED,
    WEAK,
    WHEEL,
)
from railhil.batch.steady import FORCE_LSB_N, FORCE_MAX, TRUTH_LSB
from railhil.supervisor.measures import KMH

#: A calm train changes its speed by less in a period, and is never slower than this.
_CHANGE_MPS, _SLOWEST_MPS = 10.0, 0.1
#: What bounds keep away from limits: far more than the rounding of a period's sums.
_SPARE_N, _SPARE_M, _SPARE_MPS = 1.0, 1.0, 0.001


@compiled.side_by_side_part
def _most_n(force_max_n: float, power_max_w: float, curved: bool, low: float, high: float, start: float, width: float,
            force: float, rise: float) -> float:  # fmt: skip
    """At most the ``effort_limit_n`` of any speed from ``low`` to ``high`` inside a row of its curve."""
    most_n = power_max_w / high
    most_n = force_max_n if force_max_n < most_n else most_n
    if curved:
        first_n = force + (low - start) / width * rise
        last_n = force + (high - start) / width * rise
        first_n = last_n if last_n < first_n else first_n
        most_n = first_n if first_n < most_n else most_n
    return most_n


@compiled.side_by_side
def judge(common: Any, s: Any, ticks: int) -> int:
    """Keep those lanes in their steady run that are calm; how many of them may exceed a speed limit of the score.

    Force: it tends to the steady force of one notch, then to that of the next, and of the way to it at most the share
    ``1 - decay`` in a tick; with it and the largest resistance the acceleration is bounded, with that the speed, with
    that the position.

    :param ticks: of the period, at most to the last tick of the timetable.
    """
    step_s, end_m, braking_mps2 = common.step_s, common.checks.end_m, 2.0 * common.checks.end_braking_mps2
    seconds = ticks * step_s
    limits, length_m = common.line_limits, common.length_m
    traction, brake = common.traction, common.brake
    traction_max_n, traction_max_w, traction_curved = (
        traction.force_max_n,
        traction.power_max_w,
        len(traction.curve_mps) > 0,
    )
    brake_max_n, brake_max_w, brake_curved = brake.force_max_n, brake.power_max_w, len(brake.curve_mps) > 0
    for i in range(LANES):
        x, v, force_n, steady_n, next_n = (
            s[POSITION + i],
            s[SPEED + i],
            s[ACTUATOR + i],
            s[STEADY + i],
            s[NEXT_STEADY + i],
        )
        most_n = next_n if next_n > steady_n else steady_n
        least_n = next_n if next_n < steady_n else steady_n
        moved = ticks * (1.0 - s[DECAY + i])
        moved = moved if moved < 1.0 else 1.0
        high_n = force_n + (most_n - force_n if most_n > force_n else 0.0) * moved + _SPARE_N
        low_n = force_n - (force_n - least_n if least_n < force_n else 0.0) * moved - _SPARE_N
        top = v + _CHANGE_MPS
        running_n = s[RESISTANCE_A + i] + top * (s[RESISTANCE_B + i] + top * s[RESISTANCE_C + i])
        grade_n = abs(s[GRADE_N + i]) * s[STEEPEST + i]
        up, down = (high_n + grade_n) / s[MASS + i], (running_n + grade_n - low_n) / s[MASS + i]
        # A tick more, because the middle of a tick is estimated from its start.
        before = abs(s[ACCEL + i]) * step_s
        up = (up if up > 0.0 else 0.0) * (seconds + step_s) + before
        down = (down if down > 0.0 else 0.0) * (seconds + step_s) + before
        low, high = v - down, v + up
        far_m = x + high * seconds + _SPARE_M
        to_go_m = end_m - far_m
        to_go_m = to_go_m if to_go_m > 0.0 else 0.0
        traction_n = _most_n(traction_max_n, traction_max_w, traction_curved, low, high, s[TRACTION_START + i],
                             s[TRACTION_WIDTH + i], s[TRACTION_N + i], s[TRACTION_RISE + i])  # fmt: skip
        brake_n = _most_n(brake_max_n, brake_max_w, brake_curved, low, high, s[BRAKE_START + i],
                          s[BRAKE_WIDTH + i], s[BRAKE_N + i], s[BRAKE_RISE + i])  # fmt: skip
        calm = (
            (s[STEADY_RUN + i] > 0.0)
            & (s[RESISTANCE_A + i] >= 0.0)
            & (s[RESISTANCE_B + i] >= 0.0)
            & (s[RESISTANCE_C + i] >= 0.0)
            & (up <= _CHANGE_MPS)
            & (low >= _SLOWEST_MPS)
            & (low >= s[TRACTION_FROM + i])
            & (high < s[TRACTION_TO + i])
            & (low >= s[BRAKE_FROM + i])
            & (high < s[BRAKE_TO + i])
            & (high <= s[TRIP + i])
            & (far_m < s[LIMIT_TO + i])
            & (high_n <= traction_n)
            & (-low_n <= brake_n)
            & (-least_n <= brake_n)
            & (high_n < FORCE_MAX * FORCE_LSB_N)
            & (-low_n < FORCE_MAX * FORCE_LSB_N)
            & (high * high <= braking_mps2 * to_go_m)
        )
        s[STEADY_RUN + i] = 1.0 if calm else 0.0
        s[REACH + i] = high * step_s + _SPARE_MPS * step_s
        s[NOW + i] = high + _SPARE_MPS
        s[ALLOWED + i] = inf
    for row in range(len(limits)):
        end_m = limits[row + 1, 0] if row + 1 < len(limits) else inf
        begin_m = -inf if row == 0 else limits[row, 0]
        limit_mps = limits[row, 1]
        for i in range(LANES):
            x, before_mps = s[POSITION + i], s[ALLOWED + i]
            far_m = x + s[NOW + i] * seconds + _SPARE_M
            touched = (far_m >= begin_m) & (x - _SPARE_M - length_m < end_m) & (limit_mps < before_mps)
            s[ALLOWED + i] = limit_mps if touched else before_mps
    fast = 0
    for i in range(LANES):
        fast += 1 if (s[STEADY_RUN + i] > 0.0) & (s[NOW + i] > s[ALLOWED + i]) else 0
    return fast


@compiled.side_by_side
def tick(s: Any, step_s: float) -> int:
    """``dynamics.step``; not 0 if a lane may leave its row of the grades in the next tick."""
    half_s = 0.5 * step_s
    near = 0
    for i in range(LANES):
        x, v, steady_n = s[POSITION + i], s[SPEED + i], s[STEADY + i]
        offset_n = s[ACTUATOR + i] - steady_n
        middle = v + s[ACCEL + i] * half_s
        permil = s[PERMIL + i] + s[PERMIL_PER_M + i] * (x + v * half_s - s[GRADE_FROM + i])
        running_n = s[RESISTANCE_A + i] + middle * (s[RESISTANCE_B + i] + middle * s[RESISTANCE_C + i])
        net_n = (steady_n + offset_n * s[MEAN + i]) - (running_n + s[GRADE_N + i] * permil)
        accel = net_n / s[MASS + i]
        next_mps = v + accel * step_s
        x += (v + next_mps) * 0.5 * step_s
        s[POSITION + i] = x
        s[SPEED + i] = next_mps
        s[ACTUATOR + i] = steady_n + offset_n * s[DECAY + i]
        s[ACCEL + i] = accel
        near |= 1 if x + s[REACH + i] >= s[GRADE_TO + i] else 0
    return near


@compiled.side_by_side
def part_of_tick(s: Any, step_s: float, number: int, second: bool) -> None:
    """:func:`tick` in two parts for the lanes whose next notch begins to act in tick ``number``: the first part, with a
    full tick of the other lanes, or the second."""
    at, others_s = (SECOND_S, 0.0) if second else (FIRST_S, step_s)
    splitting = float(number)
    for i in range(LANES):
        x, v, force_n, steady_n, accel_before = (
            s[POSITION + i],
            s[SPEED + i],
            s[ACTUATOR + i],
            s[STEADY + i],
            s[ACCEL + i],
        )
        split = s[SPLIT + i] == splitting
        own_s, own_decay, own_mean = s[at + i], s[at + LANES + i], s[at + 2 * LANES + i]
        full_decay, full_mean = s[DECAY + i], s[MEAN + i]
        part_s = own_s if split else others_s
        decay = own_decay if split else full_decay
        mean = own_mean if split else full_mean
        half_s = 0.5 * part_s
        offset_n = force_n - steady_n
        middle = v + accel_before * half_s
        permil = s[PERMIL + i] + s[PERMIL_PER_M + i] * (x + v * half_s - s[GRADE_FROM + i])
        running_n = s[RESISTANCE_A + i] + middle * (s[RESISTANCE_B + i] + middle * s[RESISTANCE_C + i])
        net_n = (steady_n + offset_n * mean) - (running_n + s[GRADE_N + i] * permil)
        accel = net_n / s[MASS + i]
        next_mps = v + accel * part_s
        next_m = x + (v + next_mps) * 0.5 * part_s
        next_n = steady_n + offset_n * decay
        moves = part_s > 0.0
        s[POSITION + i] = next_m if moves else x
        s[SPEED + i] = next_mps if moves else v
        s[ACTUATOR + i] = next_n if moves else force_n
        s[ACCEL + i] = accel if moves else accel_before


@compiled.side_by_side
def look_at_forces(checks: Any, s: Any) -> int:
    """``OwnChecks.finding``; the number of calm lanes that it finds, which are left as they were and marked."""
    share, allowance_mps2, left_max_n = checks.share, checks.allowance_mps2, checks.left_max_n
    running_looks, weak_looks = float(checks.running_looks), float(checks.weak_looks)
    marked = 0
    for i in range(LANES):
        force_n, steady_n, decay, mass_kg = s[ACTUATOR + i], s[STEADY + i], s[SLOW_DECAY + i], s[MASS + i]
        left_before_n, running_before, floor_before_n, weak_before = (
            s[LEFT + i],
            s[RUNNING + i],
            s[FLOOR + i],
            s[WEAK + i],
        )
        left_n = left_before_n * decay
        above_n = force_n if force_n > 0.0 else 0.0
        left_n = above_n if above_n < left_n else left_n
        running = running_before + 1.0 if force_n > left_n + left_max_n else 0.0
        floor_n = floor_before_n * decay - steady_n * (1.0 - decay)
        floor_n = floor_n if floor_n < -steady_n else -steady_n
        # Never more than the brake can: neither is the steady force of a calm train.
        wanted_n = share * (0.0 if floor_n < 0.0 else floor_n)
        allowance_n = allowance_mps2 * mass_kg
        missing = (wanted_n > allowance_n) & (-s[ACCEL + i] * mass_kg < wanted_n - allowance_n)
        weak = weak_before + 1.0 if missing else 0.0
        traction = steady_n > 0.0
        left_n = inf if traction else left_n
        floor_n = 0.0 if traction else floor_n
        running = 0.0 if traction else running
        weak = 0.0 if traction else weak
        known = (running <= running_looks) & (weak <= weak_looks)
        s[LEFT + i] = left_n if known else left_before_n
        s[RUNNING + i] = running if known else running_before
        s[FLOOR + i] = floor_n if known else floor_before_n
        s[WEAK + i] = weak if known else weak_before
        s[LOOK_LEFT + i] = 0.0 if known else 1.0
        marked += 1 if (s[CALM + i] > 0.0) & (not known) else 0
    return marked


@compiled.side_by_side
def sample(s: Any, seconds: float, judged: bool) -> None:
    """A SIM_TRUTH: work and speed error.

    :param seconds: since the sample before.
    :param judged: whether the error counts; the wanted speed is in the lanes.
    """
    for i in range(LANES):
        speed_mps = np.rint(s[SPEED + i] * 1e4) * TRUTH_LSB
        raw = np.rint(s[ACTUATOR + i] / FORCE_LSB_N)
        traction_w = (raw if raw > 0.0 else 0.0) * FORCE_LSB_N * speed_mps
        brake_w = (-raw if raw < 0.0 else 0.0) * FORCE_LSB_N * speed_mps
        s[TRACTION_J + i] += seconds * (traction_w + s[TRACTION_W + i]) / 2.0
        s[BRAKE_J + i] += seconds * (brake_w + s[BRAKE_W + i]) / 2.0
        s[TRACTION_W + i] = traction_w
        s[BRAKE_W + i] = brake_w
        s[TRUE_POSITION + i] = np.rint(s[POSITION + i] * 1e4)
        error_kmh = abs(s[WANTED + i] - speed_mps) * KMH
        s[SUM_KMH + i] += error_kmh if judged else 0.0


@compiled.side_by_side
def exceed(s: Any) -> None:
    """Largest excess over the limits of a SIM_TRUTH, which are in the lanes."""
    for i in range(LANES):
        over_mps = np.rint(s[SPEED + i] * 1e4) * TRUTH_LSB - s[ALLOWED + i]
        s[OVERSPEED + i] = over_mps if over_mps > s[OVERSPEED + i] else s[OVERSPEED + i]


@compiled.side_by_side
def accelerate(s: Any) -> None:
    """``dynamics.acceleration_mps2``."""
    for i in range(LANES):
        v = s[SPEED + i]
        permil = s[PERMIL + i] + s[PERMIL_PER_M + i] * (s[POSITION + i] - s[GRADE_FROM + i])
        running_n = s[RESISTANCE_A + i] + v * (s[RESISTANCE_B + i] + v * s[RESISTANCE_C + i])
        s[NOW + i] = (s[ACTUATOR + i] - (running_n + s[GRADE_N + i] * permil)) / s[MASS + i]


@compiled.side_by_side
def brakes(s: Any) -> int:
    """The number of calm lanes without traction."""
    found = 0
    for i in range(LANES):
        found += 1 if (s[CALM + i] > 0.0) & (s[STEADY + i] <= 0.0) else 0
    return found


@compiled.side_by_side
def read(s: Any, speed_lsb_mps: float, odometer_lsb_m: float) -> None:
    """``speed_reading_01mmps`` and ``odometer_reading_mm``."""
    for i in range(LANES):
        counts = np.rint((s[SPEED + i] * s[WHEEL + i] + s[NOISE_MPS + i]) / speed_lsb_mps)
        read_01mmps = np.rint(counts * speed_lsb_mps * 1e4)
        s[SPEED_READ + i] = read_01mmps if counts > 0.0 else 0.0
        s[ODOMETER_READ + i] = np.rint(np.rint(s[SHOWN + i] * s[WHEEL + i] / odometer_lsb_m) * odometer_lsb_m * 1000)
