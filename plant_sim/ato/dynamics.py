"""Longitudinal dynamics of a train as pure functions on plain numbers and tuples.

::

    x' = v          M v' = clip(F) - W(v, grade)          F' = -p F + p K u

``F`` is the signed force of the actuator (first-order lag with pole ``p``), ``u`` the notch and ``K`` the force per
notch; ``W`` is Davis resistance plus grade averaged over the train length. ``clip`` keeps the force within the
traction limit ``smaller(F_max, P_max / v, curve(v))`` and the brake limit. A brake holds the train and never moves it
backwards: ``v >= 0``.

Source: plant of Wang et al., DOI 10.19650/j.cnki.cjsi.J2108765, with Davis resistance, force limits and grade added.

Within a step the notch is constant, so the actuator is solved exactly (mean force included); the motion uses the
midpoint rule with a predicted midpoint (second order). Departure, stop and the crossing of a force limit are located
within the step, so the whole run is of second order in the step.

The batch compiles all functions here (:mod:`railhil.common.compilable` lists the permitted language).
"""

from __future__ import annotations

from math import exp, log
from typing import Final, NamedTuple

from railhil.common.compilable import compilable_functions
from railhil.common.floats import larger, smaller
from railhil.plant_sim.ato.forces import GradeTable, TrainConstants, effort_limit_n, mean_grade_permil, resistance_n


class Lag(NamedTuple):
    """Actuator over one step: ``F1 = G + (F0 - G) decay``, mean force ``G + (F0 - G) mean``, G the steady force."""

    step_s: float
    decay: float
    mean: float


class Window(NamedTuple):
    """Limits of the forces set by the train's protection.

    ``traction`` False removes all traction; ``brake_min_n`` is a braking force applied whatever the actuator does
    (infinite: full brake force).
    """

    traction: bool
    brake_min_n: float


FREE: Final = Window(True, 0.0)


class Motion(NamedTuple):
    """State of the train: front position, speed, actuator force before clipping (traction positive).

    ``accel_mps2`` is the mean acceleration of the previous step; it is only used to predict the speed at the midpoint
    of the next.
    """

    position_m: float
    speed_mps: float
    actuator_n: float
    accel_mps2: float


AT_REST: Final = Motion(0.0, 0.0, 0.0, 0.0)


class Step(NamedTuple):
    """Result of one step: the state at its end and the duration (s from its start) for which the train moved."""

    motion: Motion
    moving_from_s: float
    moving_to_s: float


def lag(pole_per_s: float, step_s: float) -> Lag:
    """Actuator factors of a step of any length > 0."""
    decay = exp(-pole_per_s * step_s)
    return Lag(step_s, decay, (1.0 - decay) / (pole_per_s * step_s))


def force_bounds_n(constants: TrainConstants, window: Window, speed_mps: float) -> tuple[float, float]:
    """Smallest and largest force on the train at a speed, traction positive."""
    low_n = -effort_limit_n(constants.brake, speed_mps)
    traction, brake_min_n = window
    if brake_min_n > 0.0:
        return low_n, larger(low_n, -brake_min_n)
    return low_n, effort_limit_n(constants.traction, speed_mps) if traction else 0.0


def clipped_mean_n(first_n: float, last_n: float, mean_n: float, low_n: float, high_n: float) -> float:
    """Mean of a force clipped to ``low_n..high_n`` while it runs from ``first_n`` to ``last_n`` with mean ``mean_n``.

    Exact if no bound is crossed; otherwise the force is taken as linear in time (second order).
    """
    if low_n <= first_n <= high_n and low_n <= last_n <= high_n:
        return mean_n
    if first_n >= high_n and last_n >= high_n:
        return high_n
    if first_n <= low_n and last_n <= low_n:
        return low_n
    return _crossing_mean_n(first_n, last_n, low_n, high_n)


def _crossing_mean_n(first_n: float, last_n: float, low_n: float, high_n: float) -> float:
    """Mean of a force, linear in time, that crosses a bound."""
    mean_n = (first_n + last_n) / 2
    span_n = abs(last_n - first_n)
    over_n = larger(first_n, last_n) - high_n
    under_n = low_n - smaller(first_n, last_n)
    if over_n > 0.0:
        mean_n -= over_n * over_n / (2 * span_n)
    if under_n > 0.0:
        mean_n += under_n * under_n / (2 * span_n)
    return mean_n


def applied_n(constants: TrainConstants, window: Window, motion: Motion) -> float:
    """Force on the train at this instant after all limits, traction positive."""
    low_n, high_n = force_bounds_n(constants, window, motion.speed_mps)
    return smaller(larger(motion.actuator_n, low_n), high_n)


def acceleration_mps2(constants: TrainConstants, grades: GradeTable, window: Window, motion: Motion) -> float:
    """Acceleration at this instant; 0 for a standing train that the brake or its own resistance holds."""
    grade = mean_grade_permil(grades, motion.position_m)
    net_n = applied_n(constants, window, motion) - resistance_n(constants, motion.speed_mps, grade)
    if motion.speed_mps <= 0.0 and net_n <= 0.0:
        return 0.0
    return net_n / constants.mass_kg


def step(
    constants: TrainConstants, grades: GradeTable, window: Window, motion: Motion, steady_n: float, lag_step: Lag
) -> Step:
    """The train one step later, with the notch's steady force ``steady_n`` = K u constant over the step."""
    position_m, speed_mps, actuator_n, _ = motion
    step_s, decay, mean = lag_step
    if speed_mps <= 0.0:
        waiting_s = _waiting_s(constants, grades, window, motion, steady_n, lag_step)
        if waiting_s > 0.0:
            return _from_rest(constants, grades, window, motion, steady_n, lag_step, waiting_s)
    offset_n = actuator_n - steady_n
    next_n = steady_n + offset_n * decay
    accel_mps2 = _mean_acceleration(constants, grades, window, motion, next_n, steady_n + offset_n * mean, step_s)
    next_mps = speed_mps + accel_mps2 * step_s
    if next_mps <= 0.0:
        return _to_rest(constants, grades, window, motion, steady_n, next_n, accel_mps2, step_s)
    moved_m = (speed_mps + next_mps) * 0.5 * step_s
    return Step(Motion(position_m + moved_m, next_mps, next_n, accel_mps2), 0.0, step_s)


def _mean_acceleration(
    constants: TrainConstants,
    grades: GradeTable,
    window: Window,
    motion: Motion,
    next_n: float,
    mean_n: float,
    step_s: float,
) -> float:
    """Mean acceleration over a step: mean force, with resistance and limits at the speed and position of its
    midpoint."""
    position_m, speed_mps, actuator_n, accel_mps2 = motion
    half_s = 0.5 * step_s
    middle_mps = speed_mps + accel_mps2 * half_s
    if middle_mps < 0.0:
        middle_mps = 0.0
    low_n, high_n = force_bounds_n(constants, window, middle_mps)
    if not (low_n <= actuator_n <= high_n and low_n <= next_n <= high_n):
        mean_n = clipped_mean_n(actuator_n, next_n, mean_n, low_n, high_n)
    grade = mean_grade_permil(grades, position_m + speed_mps * half_s)
    return (mean_n - resistance_n(constants, middle_mps, grade)) / constants.mass_kg


def _to_rest(
    constants: TrainConstants,
    grades: GradeTable,
    window: Window,
    motion: Motion,
    steady_n: float,
    next_n: float,
    accel_mps2: float,
    step_s: float,
) -> Step:
    """A step inside which the speed reaches zero; the train stands for the rest of it."""
    position_m, speed_mps, actuator_n, _ = motion
    stop_s = step_s
    if accel_mps2 < 0.0 < speed_mps:
        stop_s = smaller(step_s, -speed_mps / accel_mps2)
        part = lag(constants.pole_per_s, stop_s)
        offset_n = actuator_n - steady_n
        part_n = steady_n + offset_n * part.decay
        mean_n = steady_n + offset_n * part.mean
        accel_mps2 = _mean_acceleration(constants, grades, window, motion, part_n, mean_n, stop_s)
        if accel_mps2 < 0.0:
            stop_s = smaller(step_s, -speed_mps / accel_mps2)
    return Step(Motion(position_m + speed_mps * 0.5 * stop_s, 0.0, next_n, 0.0), 0.0, stop_s)


def _waiting_s(
    constants: TrainConstants, grades: GradeTable, window: Window, motion: Motion, steady_n: float, lag_step: Lag
) -> float:
    """How long a standing train remains standing in this step (the whole step if it does not depart)."""
    against_n = resistance_n(constants, 0.0, mean_grade_permil(grades, motion.position_m))
    low_n, high_n = force_bounds_n(constants, window, 0.0)
    actuator_n = motion.actuator_n
    if smaller(larger(actuator_n, low_n), high_n) > against_n:
        return 0.0
    last_n = steady_n + (actuator_n - steady_n) * lag_step.decay
    if smaller(larger(last_n, low_n), high_n) <= against_n:
        return lag_step.step_s
    return smaller(log((actuator_n - steady_n) / (against_n - steady_n)) / constants.pole_per_s, lag_step.step_s)


def _from_rest(
    constants: TrainConstants,
    grades: GradeTable,
    window: Window,
    motion: Motion,
    steady_n: float,
    lag_step: Lag,
    waiting_s: float,
) -> Step:
    """A step that begins at rest: only the actuator advances until the force overcomes the resistance."""
    position_m, _, actuator_n, _ = motion
    step_s = lag_step.step_s
    next_n = steady_n + (actuator_n - steady_n) * lag_step.decay
    moving_s = step_s - waiting_s
    if moving_s <= 0.0:
        return Step(Motion(position_m, 0.0, next_n, 0.0), step_s, step_s)
    offset_n = (actuator_n - steady_n) * exp(-constants.pole_per_s * waiting_s)
    standing = Motion(position_m, 0.0, steady_n + offset_n, 0.0)
    mean_n = steady_n + offset_n * lag(constants.pole_per_s, moving_s).mean
    accel_mps2 = _mean_acceleration(constants, grades, window, standing, next_n, mean_n, moving_s)
    speed_mps = larger(0.0, accel_mps2 * moving_s)
    return Step(Motion(position_m + speed_mps * 0.5 * moving_s, speed_mps, next_n, accel_mps2), waiting_s, step_s)


compilable_functions(force_bounds_n, clipped_mean_n, applied_n, acceleration_mps2, step, _mean_acceleration)
compilable_functions(lag, _crossing_mean_n, _to_rest, _waiting_s, _from_rest, aside=True)
