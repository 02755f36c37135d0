"""A tick of all trains in their lanes: the formulas of the bench without the cases that do not occur in a steady run.

The sums and products are those of :mod:`railhil.plant_sim.dynamics`, :mod:`railhil.plant_sim.forces`,
:mod:`railhil.plant_sim.train_checks` and :mod:`railhil.supervisor.measures`, in their order, so the results have the
same bits; the tests of the batch compare them. A loop here has no calls and no branches that the processor cannot
replace by a choice. Where a case occurs that it does not know, the lane is left as it was and marked.
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
    DECAY,
    DUE,
    ERROR,
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
    NOW,
    OVERSPEED,
    PERMIL,
    PERMIL_PER_M,
    POSITION,
    RESISTANCE_A,
    RESISTANCE_B,
    RESISTANCE_C,
    RUNNING,
    SAMPLE_LEFT,
    SLOW_DECAY,
    SPEED,
    STEADY,
    STEADY_RUN,
    STEP_LEFT,
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
)
from railhil.supervisor.measures import KMH

#: Raw SIM_TRUTH: scales of position, speed and forces.
TRUTH_LSB, FORCE_LSB_N = 1e-4, 20.0
FORCE_MAX = 65535.0


@compiled.side_by_side_part
def _limit_n(force_max_n: float, power_max_w: float, curved: bool, v: float, start: float, width: float, force: float,
             rise: float) -> float:  # fmt: skip
    """``effort_limit_n`` inside a row of its curve."""
    limit_n = force_max_n
    if limit_n * v > power_max_w:
        limit_n = power_max_w / v
    if curved:
        curve_n = force + (v - start) / width * rise
        limit_n = curve_n if curve_n < limit_n else limit_n
    return limit_n


@compiled.side_by_side
def look_at_forces(common: Any, s: Any) -> int:
    """``_look`` of every lane; the number of lanes that are left to their records."""
    checks, brake = common.checks, common.brake
    share, allowance_mps2, left_max_n = checks.share, checks.allowance_mps2, checks.left_max_n
    running_looks, weak_looks = float(checks.running_looks), float(checks.weak_looks)
    force_max_n, power_max_w, curved = brake.force_max_n, brake.power_max_w, len(brake.curve_mps) > 0
    marked = 0
    for i in range(LANES):
        v, force_n, steady_n, decay = s[SPEED + i], s[ACTUATOR + i], s[STEADY + i], s[SLOW_DECAY + i]
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
        wanted_n = share * (0.0 if floor_n < 0.0 else floor_n)
        allowance_n = allowance_mps2 * s[MASS + i]
        most_n = share * _limit_n(force_max_n, power_max_w, curved, v, s[BRAKE_START + i], s[BRAKE_WIDTH + i],
                                  s[BRAKE_N + i], s[BRAKE_RISE + i])  # fmt: skip
        demanded = wanted_n > allowance_n
        wanted_n = most_n if demanded and most_n < wanted_n else wanted_n
        missing = (wanted_n > allowance_n) & (-s[ACCEL + i] * s[MASS + i] < wanted_n - allowance_n)
        weak = weak_before + 1.0 if missing else 0.0
        traction = steady_n > 0.0
        left_n = inf if traction else left_n
        floor_n = 0.0 if traction else floor_n
        running = 0.0 if traction else running
        weak = 0.0 if traction else weak
        known = (
            (s[STEADY_RUN + i] > 0.0)
            & (running <= running_looks)
            & (weak <= weak_looks)
            & (v >= s[BRAKE_FROM + i])
            & (v < s[BRAKE_TO + i])
        )
        s[LEFT + i] = left_n if known else left_before_n
        s[RUNNING + i] = running if known else running_before
        s[FLOOR + i] = floor_n if known else floor_before_n
        s[WEAK + i] = weak if known else weak_before
        s[LOOK_LEFT + i] = 0.0 if known else 1.0
        marked += 0 if known else 1
    return marked


@compiled.side_by_side
def advance(common: Any, s: Any, tick: int, looked: bool) -> int:
    """``_advance`` of every lane by one tick; the number of lanes that are left to their records.

    :param looked: :func:`look_at_forces` was called in this tick.
    """
    step_s, end, end_m = common.step_s, float(tick + 1), common.checks.end_m
    braking_mps2 = 2.0 * common.checks.end_braking_mps2
    traction, brake = common.traction, common.brake
    traction_max_n, traction_max_w, traction_curved = (
        traction.force_max_n,
        traction.power_max_w,
        len(traction.curve_mps) > 0,
    )
    brake_max_n, brake_max_w, brake_curved = brake.force_max_n, brake.power_max_w, len(brake.curve_mps) > 0
    half_s = 0.5 * step_s
    marked = 0
    for i in range(LANES):
        x, v, force_n, accel_before = s[POSITION + i], s[SPEED + i], s[ACTUATOR + i], s[ACCEL + i]
        offset_n = force_n - s[STEADY + i]
        next_n = s[STEADY + i] + offset_n * s[DECAY + i]
        mean_n = s[STEADY + i] + offset_n * s[MEAN + i]
        middle = v + accel_before * half_s
        middle = 0.0 if middle < 0.0 else middle
        high_n = _limit_n(traction_max_n, traction_max_w, traction_curved, middle, s[TRACTION_START + i],
                          s[TRACTION_WIDTH + i], s[TRACTION_N + i], s[TRACTION_RISE + i])  # fmt: skip
        low_n = -_limit_n(brake_max_n, brake_max_w, brake_curved, middle, s[BRAKE_START + i], s[BRAKE_WIDTH + i],
                          s[BRAKE_N + i], s[BRAKE_RISE + i])  # fmt: skip
        inside = (low_n <= force_n) & (force_n <= high_n) & (low_n <= next_n) & (next_n <= high_n)
        above = (force_n >= high_n) & (next_n >= high_n)
        below = (force_n <= low_n) & (next_n <= low_n)
        mean_n = mean_n if inside else high_n if above else low_n
        place_m = x + v * half_s
        permil = s[PERMIL + i] + s[PERMIL_PER_M + i] * (place_m - s[GRADE_FROM + i])
        running_n = s[RESISTANCE_A + i] + middle * (s[RESISTANCE_B + i] + middle * s[RESISTANCE_C + i])
        net_n = mean_n - (running_n + s[GRADE_N + i] * permil)
        accel = net_n / s[MASS + i]
        next_mps = v + accel * step_s
        moved_m = (v + next_mps) * 0.5 * step_s
        to_go_m = end_m - x
        to_go_m = to_go_m if to_go_m > 0.0 else 0.0
        known = (
            (s[STEADY_RUN + i] > 0.0)
            & (inside | above | below)
            & (middle >= s[TRACTION_FROM + i])
            & (middle < s[TRACTION_TO + i])
            & (middle >= s[BRAKE_FROM + i])
            & (middle < s[BRAKE_TO + i])
            & (place_m >= s[GRADE_FROM + i])
            & (place_m < s[GRADE_TO + i])
            & (next_mps > 0.0)
            & (v <= s[TRIP + i])
            & (x < s[LIMIT_TO + i])
            & (s[DUE + i] > end)
            & (v * v <= braking_mps2 * to_go_m)
        )
        known = known & ((s[LOOK_LEFT + i] == 0.0) | (not looked))
        s[POSITION + i] = x + moved_m if known else x
        s[SPEED + i] = next_mps if known else v
        s[ACTUATOR + i] = next_n if known else force_n
        s[ACCEL + i] = accel if known else accel_before
        s[STEP_LEFT + i] = 0.0 if known else 1.0
        marked += 0 if known else 1
    return marked


@compiled.side_by_side
def allow(common: Any, s: Any) -> None:
    """``limits_under_train`` of every lane."""
    limits, length_m = common.line_limits, common.length_m
    for i in range(LANES):
        s[ALLOWED + i] = inf
    for row in range(len(limits)):
        end_m = limits[row + 1, 0] if row + 1 < len(limits) else inf
        begin_m = -inf if row == 0 else limits[row, 0]
        limit_mps = limits[row, 1]
        for i in range(LANES):
            front_m = np.rint(s[POSITION + i] * 1e4) * TRUTH_LSB
            before_mps = s[ALLOWED + i]
            touched = (front_m >= begin_m) & (front_m - length_m < end_m) & (limit_mps < before_mps)
            s[ALLOWED + i] = limit_mps if touched else before_mps


@compiled.side_by_side
def sample(common: Any, s: Any, seconds: float, judged: bool) -> int:
    """``_truth`` of every lane but for its table entries; the number of lanes that are left to their records.

    :param seconds: since the sample before; 0 for the first.
    :param judged: whether the error counts; the wanted speed is in the lanes.
    """
    traction, brake = common.traction, common.brake
    traction_max_n, traction_max_w, traction_curved = (
        traction.force_max_n,
        traction.power_max_w,
        len(traction.curve_mps) > 0,
    )
    brake_max_n, brake_max_w, brake_curved = brake.force_max_n, brake.power_max_w, len(brake.curve_mps) > 0
    allow(common, s)
    marked = 0
    for i in range(LANES):
        v, force_n = s[SPEED + i], s[ACTUATOR + i]
        traction_before_j, traction_before_w = s[TRACTION_J + i], s[TRACTION_W + i]
        brake_before_j, brake_before_w = s[BRAKE_J + i], s[BRAKE_W + i]
        over_before_mps, true_before_01mm = s[OVERSPEED + i], s[TRUE_POSITION + i]
        high_n = _limit_n(traction_max_n, traction_max_w, traction_curved, v, s[TRACTION_START + i],
                          s[TRACTION_WIDTH + i], s[TRACTION_N + i], s[TRACTION_RISE + i])  # fmt: skip
        low_n = -_limit_n(brake_max_n, brake_max_w, brake_curved, v, s[BRAKE_START + i], s[BRAKE_WIDTH + i],
                          s[BRAKE_N + i], s[BRAKE_RISE + i])  # fmt: skip
        force_n = low_n if low_n > force_n else force_n
        force_n = high_n if high_n < force_n else force_n
        permil = s[PERMIL + i] + s[PERMIL_PER_M + i] * (s[POSITION + i] - s[GRADE_FROM + i])
        running_n = s[RESISTANCE_A + i] + v * (s[RESISTANCE_B + i] + v * s[RESISTANCE_C + i])
        s[NOW + i] = (force_n - (running_n + s[GRADE_N + i] * permil)) / s[MASS + i]
        true_01mm = np.rint(s[POSITION + i] * 1e4)
        speed_mps = np.rint(v * 1e4) * TRUTH_LSB
        up = np.rint((force_n if force_n > 0.0 else 0.0) / FORCE_LSB_N)
        down = np.rint((-force_n if -force_n > 0.0 else 0.0) / FORCE_LSB_N)
        traction_w = (FORCE_MAX if up > FORCE_MAX else up) * FORCE_LSB_N * speed_mps
        brake_w = (FORCE_MAX if down > FORCE_MAX else down) * FORCE_LSB_N * speed_mps
        known = (
            (s[STEADY_RUN + i] > 0.0)
            & (v >= s[TRACTION_FROM + i])
            & (v < s[TRACTION_TO + i])
            & (v >= s[BRAKE_FROM + i])
            & (v < s[BRAKE_TO + i])
            & (s[POSITION + i] < s[GRADE_TO + i])
        )
        traction_j = traction_before_j + seconds * (traction_w + traction_before_w) / 2.0
        brake_j = brake_before_j + seconds * (brake_w + brake_before_w) / 2.0
        over_mps = speed_mps - s[ALLOWED + i]
        over_mps = over_mps if over_mps > over_before_mps else over_before_mps
        error_kmh = abs(s[WANTED + i] - speed_mps) * KMH
        s[TRACTION_J + i] = traction_j if known else traction_before_j
        s[BRAKE_J + i] = brake_j if known else brake_before_j
        s[TRACTION_W + i] = traction_w if known else traction_before_w
        s[BRAKE_W + i] = brake_w if known else brake_before_w
        s[OVERSPEED + i] = over_mps if known else over_before_mps
        s[TRUE_POSITION + i] = true_01mm if known else true_before_01mm
        # Adding 0 to a sum does not change it.
        s[ERROR + i] = error_kmh if known & judged else 0.0
        s[SAMPLE_LEFT + i] = 0.0 if known else 1.0
        marked += 0 if known else 1
    return marked
