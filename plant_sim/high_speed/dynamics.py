"""Motion of a power unit as pure functions on plain numbers and tuples.

::

    x' = v        v' = d - r(v) - g i(x) + w + f/m        tau d' = K clip(u_t(t - T_t) + u_b(t - T_b)) - d

``u_t`` and ``u_b`` are the traction part (positive) and the braking part (negative) of the commanded acceleration. Each
side has its own delay and both add, so at a change of the mode they overlap or leave a gap. ``clip`` keeps to the
largest traction, to power by speed and to the largest braking. ``r`` is the running resistance (Davis), ``i`` the grade
averaged over the train, ``w`` the wind, ``f`` the force of the couplers. The holding brake keeps a standing train until
traction acts; a train never rolls backwards.

Source: plants of the two papers on nonlinear generalized predictive control of high-speed trains (lag, transport delay,
integrator, gain), with resistance, power limit, grade and wind added.

Within a step the commands are constant, so the lag is solved exactly with its mean; the motion uses the midpoint rule
with the speed at the midpoint predicted from the last step's acceleration: second order.
"""

from __future__ import annotations

from bisect import bisect_right
from math import exp
from typing import NamedTuple

from railhil.common.compilable import compilable, larger, smaller

#: Standard gravity.
GRAVITY_MPS2 = 9.80665
#: Below this speed the power limit is the same as at this speed.
POWER_FROM_MPS = 1.0


class UnitLimits(NamedTuple):
    """Constants of a unit: largest traction and braking, power by mass, resistance ``a + b v + c v^2`` (v in m/s)."""

    traction_mps2: float
    braking_mps2: float
    power_w_per_kg: float
    resistance_a: float
    resistance_b: float
    resistance_c: float


class Drive(NamedTuple):
    """Traction and brake over one step: gain, and the lag's decay and mean (:func:`drive`)."""

    gain: float
    decay: float
    mean: float


class UnitMotion(NamedTuple):
    """State of a unit: position, speed, acceleration by traction and brake; mean acceleration of the last step."""

    position_m: float
    speed_mps: float
    drive_mps2: float
    accel_mps2: float


class Coupler(NamedTuple):
    """A coupler: stiffness, damping, and half of its slack."""

    stiffness_n_per_m: float
    damping_ns_per_m: float
    play_m: float


class Grades(NamedTuple):
    """Grade over position, linear between points: ``permil[i] + slope[i] (x - from_m[i])`` from ``from_m[i]`` on."""

    from_m: tuple[float, ...]
    permil: tuple[float, ...]
    slope_permil_per_m: tuple[float, ...]


def drive(gain: float, lag_s: float, step_s: float) -> Drive:
    """The constants of a step: ``d1 = t + (d0 - t) decay``, mean ``t + (d0 - t) mean``, t the steady acceleration."""
    decay = exp(-step_s / lag_s)
    return Drive(gain, decay, (1.0 - decay) * lag_s / step_s)


@compilable
def resistance_of(limits: UnitLimits, speed_mps: float) -> float:
    """Deceleration by the running resistance."""
    return limits.resistance_a + (limits.resistance_b + limits.resistance_c * speed_mps) * speed_mps


@compilable
def available_of(limits: UnitLimits, speed_mps: float) -> float:
    """Largest traction at a speed."""
    return smaller(limits.traction_mps2, limits.power_w_per_kg / larger(speed_mps, POWER_FROM_MPS))


@compilable
def grade_mps2(grades: Grades, position_m: float) -> float:
    """Deceleration by the grade."""
    row = larger(bisect_right(grades.from_m, position_m) - 1, 0)
    permil = grades.permil[row] + grades.slope_permil_per_m[row] * (position_m - grades.from_m[row])
    return permil * (GRAVITY_MPS2 / 1000.0)


@compilable
def joined(traction_mps2: float, braking_mps2: float) -> float:
    """The delayed commands of traction and braking: each counts for its own side, and both add."""
    return (traction_mps2 if traction_mps2 > 0.0 else 0.0) + (braking_mps2 if braking_mps2 < 0.0 else 0.0)


@compilable
def coupler_n(coupler: Coupler, front: UnitMotion, rear: UnitMotion, step_s: float) -> float:
    """Force between two units at the middle of a step, tension positive; none within the slack.

    Positions of the units are counted from their places in a train at rest.
    """
    half_s = 0.5 * step_s
    apart_mps = front.speed_mps - rear.speed_mps
    gap_m = front.position_m - rear.position_m + apart_mps * half_s
    apart_mps += (front.accel_mps2 - rear.accel_mps2) * half_s
    if gap_m > coupler.play_m:
        return (gap_m - coupler.play_m) * coupler.stiffness_n_per_m + apart_mps * coupler.damping_ns_per_m
    if gap_m < -coupler.play_m:
        return (gap_m + coupler.play_m) * coupler.stiffness_n_per_m + apart_mps * coupler.damping_ns_per_m
    return 0.0


@compilable
def moved(
    limits: UnitLimits,
    side: Drive,
    grades: Grades,
    now: UnitMotion,
    command_mps2: float,
    outside_mps2: float,
    step_s: float,
) -> UnitMotion:
    """The state one step later.

    :param command_mps2: sum of the two delayed commands.
    :param outside_mps2: acceleration by wind and couplers.
    """
    half_s = 0.5 * step_s
    mid_mps = larger(now.speed_mps + now.accel_mps2 * half_s, 0.0)
    wanted = smaller(larger(command_mps2, -limits.braking_mps2), available_of(limits, mid_mps)) * side.gain
    short = now.drive_mps2 - wanted
    drive_mps2 = wanted + short * side.decay
    if now.speed_mps == 0.0 and command_mps2 <= 0.0:
        # Held by the brake.
        return UnitMotion(now.position_m, 0.0, drive_mps2, 0.0)
    accel = wanted + short * side.mean - resistance_of(limits, mid_mps) + outside_mps2
    accel -= grade_mps2(grades, now.position_m + now.speed_mps * half_s)
    speed_mps = now.speed_mps + accel * step_s
    if speed_mps <= 0.0:
        # The train stops within the step, or the traction does not move it yet.
        stop_m = 0.5 * now.speed_mps * now.speed_mps / -accel if accel < 0.0 else 0.0
        return UnitMotion(now.position_m + stop_m, 0.0, drive_mps2, 0.0)
    position_m = now.position_m + (now.speed_mps + speed_mps) * half_s
    return UnitMotion(position_m, speed_mps, drive_mps2, accel)
