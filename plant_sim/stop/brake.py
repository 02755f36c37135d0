"""Motion under a brake with a first-order lag (2), solved exactly for a constant target, factor and grade.

::

    lag a' = target - a      v' = factor a + outside      s' = v

``a`` is the acceleration by traction and brake without losses. ``factor`` is 1, less while braking power is lost, and 0
while the adhesion limits the brake (the limit is then part of ``outside``). The pure delay is in the instants at which
targets begin.
"""

from __future__ import annotations

from math import exp
from typing import Any, NamedTuple

from railhil.common.compilable import compilable, compilable_aside

GRAVITY_MPS2 = 9.81
#: Number of halvings of a step in the search for an instant: beyond the resolution of the numbers.
_HALVINGS = 60


class Motion(NamedTuple):
    """Position, speed, acceleration by traction and brake before any loss (``drive_mps2``)."""

    position_m: float
    speed_mps: float
    drive_mps2: float


@compilable
def moved(
    motion: Motion, target_mps2: float, factor: float, outside_mps2: float, lag_s: float, time_s: float
) -> Motion:
    """The motion after a time in which the target is constant (4), (5)."""
    decay = exp(-time_s / lag_s)
    lagging = motion.drive_mps2 - target_mps2
    steady = factor * target_mps2 + outside_mps2
    gone_s = lag_s * (1.0 - decay)
    return Motion(
        motion.position_m
        + motion.speed_mps * time_s
        + 0.5 * steady * time_s * time_s
        + factor * lagging * lag_s * (time_s - gone_s),
        motion.speed_mps + steady * time_s + factor * lagging * gone_s,
        target_mps2 + lagging * decay,
    )


@compilable_aside
def time_at_speed(
    motion: Motion,
    target_mps2: float,
    factor: float,
    outside_mps2: float,
    lag_s: float,
    time_s: float,
    speed_mps: float,
) -> float:
    """The time within ``time_s`` at which the speed has fallen to ``speed_mps``; the speed is below it at the end."""
    low_s, high_s = 0.0, time_s
    for _ in range(_HALVINGS):
        middle_s = 0.5 * (low_s + high_s)
        if moved(motion, target_mps2, factor, outside_mps2, lag_s, middle_s).speed_mps > speed_mps:
            low_s = middle_s
        else:
            high_s = middle_s
    return high_s


@compilable_aside
def time_at_position(
    motion: Motion,
    target_mps2: float,
    factor: float,
    outside_mps2: float,
    lag_s: float,
    time_s: float,
    position_m: float,
) -> float:
    """The time within ``time_s`` at which a position is reached; the train is behind it at the end."""
    low_s, high_s = 0.0, time_s
    for _ in range(_HALVINGS):
        middle_s = 0.5 * (low_s + high_s)
        if moved(motion, target_mps2, factor, outside_mps2, lag_s, middle_s).position_m < position_m:
            low_s = middle_s
        else:
            high_s = middle_s
    return high_s


class Course(NamedTuple):
    """Constants of a run: lag of the brake, its loss at low speed, and the grades.

    ``adhesion_mps2``: largest deceleration that the rail allows, 0: no limit. ``bounds_m``: where each piece of the
    grades but the first begins; ``grades_mps2``: the acceleration by each. Tables in the interpreter, arrays when
    compiled.
    """

    lag_s: float
    loss: float
    loss_below_mps: float
    adhesion_mps2: float
    bounds_m: Any
    grades_mps2: Any


class Going(NamedTuple):
    """The train at an instant: ``piece`` of the grades, whether it ``slides``, and when it last came to a stand.

    ``stopped_s``: negative before the first standstill.
    """

    now_s: float
    motion: Motion
    piece: int
    slides: bool
    stopped_s: float


@compilable
def achieved(target_mps2: float, gain: float, notch_mps2: float) -> float:
    """Acceleration of traction and brake for a target: braking with its notches (0: stepless) and its gain."""
    if target_mps2 >= 0.0:
        return target_mps2
    if notch_mps2 > 0.0:
        target_mps2 = notch_mps2 * round(target_mps2 / notch_mps2)
    return gain * target_mps2


@compilable
def gone_on(course: Course, going: Going, target_mps2: float, wander_mps2: float, end_s: float) -> Going:
    """Continue with a constant target to an instant, or to the point where the grade changes, the braking fades or the
    train stands.

    :param target_mps2: :func:`achieved`.
    :param wander_mps2: further acceleration from outside.
    """
    motion, left_s, lag_s = going.motion, end_s - going.now_s, course.lag_s
    grade = course.grades_mps2[going.piece]
    if motion.speed_mps == 0.0 and not (target_mps2 > 0.0 and motion.drive_mps2 + grade > 0.0):
        # The brake holds a standing train.
        drive = moved(motion, target_mps2, 0.0, 0.0, lag_s, left_s).drive_mps2
        return Going(end_s, Motion(motion.position_m, 0.0, drive), going.piece, False, going.stopped_s)
    factor, outside = 1.0, grade + wander_mps2
    if motion.drive_mps2 < 0.0 and motion.speed_mps <= course.loss_below_mps:
        factor = 1.0 - course.loss
    slides = course.adhesion_mps2 > 0.0 and -factor * motion.drive_mps2 > course.adhesion_mps2
    if slides:
        factor, outside = 0.0, outside - course.adhesion_mps2
    after = moved(motion, target_mps2, factor, outside, lag_s, left_s)
    if motion.speed_mps == 0.0 and after.speed_mps <= 0.0:
        # The traction does not yet move it against the wander: the brake holds it.
        return Going(end_s, Motion(motion.position_m, 0.0, after.drive_mps2), going.piece, False, going.stopped_s)
    slow_mps = 0.0
    if course.loss > 0.0 and motion.speed_mps > course.loss_below_mps:
        slow_mps = course.loss_below_mps
    if after.speed_mps < slow_mps or after.speed_mps <= 0.0:
        left_s = time_at_speed(motion, target_mps2, factor, outside, lag_s, left_s, slow_mps)
        after = moved(motion, target_mps2, factor, outside, lag_s, left_s)
        after = Motion(after.position_m, slow_mps, after.drive_mps2)
    piece = going.piece
    if piece < len(course.bounds_m) and after.position_m >= course.bounds_m[piece]:
        left_s = time_at_position(motion, target_mps2, factor, outside, lag_s, left_s, course.bounds_m[piece])
        after = moved(motion, target_mps2, factor, outside, lag_s, left_s)
        piece += 1
    now_s, stopped_s = going.now_s + left_s, going.stopped_s
    if now_s > end_s:
        now_s = end_s
    if after.speed_mps <= 0.0:
        after, stopped_s = Motion(after.position_m, 0.0, after.drive_mps2), now_s
    return Going(now_s, after, piece, slides, stopped_s)
