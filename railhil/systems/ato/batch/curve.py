"""The target speed curve over the distance, for the score of runs with set-points by distance."""

from __future__ import annotations

from bisect import bisect_right
from math import inf
from typing import Any

from railhil.batch import compiled
from railhil.common.compilable import larger, smaller
from railhil.systems.ato.scenario.target import time_in_piece_s


@compiled.part
def _piece(target: Any, time_s: float) -> Any:
    """``Target._locate``: the piece of the curve at a time >= 0, and the time since its start."""
    piece = larger(bisect_right(target.time_s, time_s) - 1, 0)
    return piece, larger(time_s - target.time_s[piece], 0.0)


@compiled.aside
def passing_mps(target: Any, position_m: float) -> float:
    """``Target.speed_mps(Target.time_s(position_m))``."""
    goal_m = smaller(larger(position_m, 0.0), target.stop_position_m)
    piece = 0
    while piece + 1 < target.moving and target.position_m[piece + 1] < goal_m:
        piece += 1
    end_s = target.time_s[piece + 1] if piece + 1 < target.time_s.size else inf
    after_s = time_in_piece_s(
        goal_m - target.position_m[piece],
        smaller(end_s, target.stop_time_s) - target.time_s[piece],
        target.speed_mps[piece],
        target.accel_mps2[piece],
        target.jerk_mps3[piece],
    )
    i, s = _piece(target, target.time_s[piece] + after_s)
    speed_mps: float = target.speed_mps[i] + s * (target.accel_mps2[i] + s * target.jerk_mps3[i] / 2)
    return speed_mps
