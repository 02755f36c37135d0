"""Motion under a brake with a first-order lag (2), solved exactly for a constant target, factor and grade.

::

    lag a' = target - a      v' = factor a + outside      s' = v

``a`` is what traction and brake would do; ``factor`` is 1, less while braking power is lost, 0 while the adhesion
limits the brake (the limit is then part of ``outside``). The pure delay is in the instants at which targets begin.
"""

from __future__ import annotations

from math import exp
from typing import NamedTuple

from railhil.common.compilable import compilable

GRAVITY_MPS2 = 9.81
#: Halvings of a step in which an instant is looked for: beyond the resolution of the numbers.
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


@compilable
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


@compilable
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
