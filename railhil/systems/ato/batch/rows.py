"""The rows of all tables in which a train is, for the ticks that are computed side by side."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

import numpy as np

from railhil.batch import compiled
from railhil.common.compilable import larger, smaller
from railhil.plant_sim.ato.command_watch import GOOD_AFTER_SERVICE_BRAKE
from railhil.systems.ato.batch import lanes as at
from railhil.systems.ato.batch.train import TRUTH_LSB, grades_of
from railhil.systems.ato.judge.measures import limits_under_train
from railhil.wire.ato import WatchLevel

#: A limit of the score is looked up this long before it changes.
_SPARE_M = 0.001


@compiled.part
def _set_effort(s: Any, i: int, row_at: int, table: Any) -> None:
    """Note the row of an effort curve in which a speed lies; ``row_at``: the first of its four quantities."""
    speeds, forces = table.curve_mps, table.curve_n
    count, row = len(speeds), bisect_right(table.curve_mps, s[at.SPEED + i])
    # Beyond its ends a curve is constant; without a curve it is above every other limit.
    first_mps, last_mps, first_n, last_n = -1e9, 1e9, 1e300, 1e300
    if row > 0:
        first_mps, first_n = speeds[row - 1], forces[row - 1]
        last_n = first_n
    if row < count:
        last_mps, last_n = speeds[row], forces[row]
        if row == 0:
            first_n = last_n
    s[row_at + i], s[row_at + at.LANES + i] = first_mps, last_mps
    s[row_at + 2 * at.LANES + i], s[row_at + 3 * at.LANES + i] = first_n, last_n


@compiled.aside
def look_up(common: Any, tables: Any, index: int, s: Any, i: int) -> None:
    """Note the rows of all tables in which a train is, and whether it has no other events than motion."""
    position_m = s[at.POSITION + i]
    ordinary = (
        common.side_by_side
        and s[at.ENDED + i] == 0.0
        and int(s[at.LEVEL + i]) == WatchLevel.NORMAL
        and s[at.WATCH_BRAKE + i] == 0.0
        and s[at.TRACTION + i] != 0.0
        and s[at.BRAKE_MIN + i] == 0.0
        and s[at.SPEED + i] > 0.0
        and s[at.STOP_TICK + i] < 0.0
        and s[at.GOOD + i] == GOOD_AFTER_SERVICE_BRAKE
    )
    s[at.ORDINARY + i] = 1.0 if ordinary else 0.0
    if not ordinary:
        return
    _set_effort(s, i, at.TRACTION_FROM, common.traction)
    _set_effort(s, i, at.BRAKE_FROM, common.brake)
    s[at.SPEED_FROM + i] = larger(s[at.TRACTION_FROM + i], s[at.BRAKE_FROM + i])
    s[at.SPEED_TO + i] = smaller(s[at.TRACTION_TO + i], s[at.BRAKE_TO + i])
    grades = grades_of(common, tables, index, s, i)
    s[at.GRADE_FROM + i], s[at.PERMIL + i] = grades.from_m[0], grades.permil[0]
    s[at.PERMIL_PER_M + i] = grades.permil_per_m[0]
    place_to_m = s[at.LIMIT_TO + i]
    if len(grades.from_m) > 1:
        place_to_m = smaller(place_to_m, grades.from_m[1])
    if position_m < grades.from_m[0]:
        place_to_m = position_m
    limits, front_m = common.line_limits, np.rint(position_m * 1e4) * TRUTH_LSB
    s[at.ALLOWED + i] = limits_under_train(limits, front_m, common.length_m)
    for row in range(1, len(limits)):
        begin_m = limits[row, 0]
        if front_m < begin_m:
            place_to_m = smaller(place_to_m, begin_m - _SPARE_M)
        if front_m - common.length_m < begin_m:
            place_to_m = smaller(place_to_m, begin_m + common.length_m - _SPARE_M)
    s[at.PLACE_TO + i] = place_to_m
