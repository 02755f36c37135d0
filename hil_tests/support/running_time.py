"""Shortest running time: a flat-out run under speed limits and braking curves.

The train accelerates at its traction limit until it reaches the speed ceiling, follows the ceiling within its force
limit, and brakes at its service deceleration so that every lower limit and the stop are met. Braking is kinematic (the
deceleration is given, the force results from it), resistance and traction are those of
:mod:`railhil.plant_sim.ato.forces`. There is no actuator lag: the result is a lower bound, to be compared with
published running times.

Integration over distance: ``d(v^2)/dx = 2 a(v, x)``, midpoint rule; cells end at every change of limit and at every
point where braking from one limit to another begins, and are finer after the departure, where speed changes fastest.
"""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

from railhil.plant_sim.ato.force_tables import grade_table, train_constants
from railhil.plant_sim.ato.forces import GradeTable, TrainConstants, effort_limit_n, mean_grade_permil, resistance_n
from railhil.scenarios.profiles import Profile, find_lowest
from railhil.systems.ato.scenario.model import Line, Train

#: Length of an integration cell; halving it moves the railtoolkit times by less than 0.002 %.
CELL_M = 2.0
#: Cells after the departure: their number and total length in metres; their lengths grow linearly.
_DEPARTURE_CELLS = 50
_DEPARTURE_M = 20.0


class CannotMove(ValueError):
    """The traction of the train does not overcome its resistance somewhere on the line."""


class RunPoint(NamedTuple):
    """One point of a run: front position, time since departure, speed."""

    position_m: float
    time_s: float
    speed_mps: float


def flat_out_run(train: Train, line: Line, distance_m: float, cell_m: float = CELL_M) -> tuple[RunPoint, ...]:
    """The fastest run from standstill at position 0 to a stop at ``distance_m``.

    :returns: points at the cell ends, from departure to stop; the last one holds the running time.
    :raises CannotMove: the train cannot start, or comes to a standstill on a grade.
    :raises ValueError: ``distance_m`` or ``cell_m`` is not above 0.
    """
    if not distance_m > 0.0 or not cell_m > 0.0:
        raise ValueError(f"distance {distance_m} m and cell {cell_m} m must be above 0")
    constants = train_constants(train)
    grades = grade_table(line.grade_permil, train.length_m)
    limit = find_lowest(line.speed_limit_mps, train.length_m, train.speed_limit_mps)
    drops = _drops(limit, distance_m)
    edges = _edges(limit, drops, distance_m, train.service_braking_mps2, cell_m)
    points = [RunPoint(0.0, 0.0, 0.0)]
    time_s = speed_mps = 0.0
    for from_m, to_m in pairwise(edges):
        free_mps = _pulled_mps(constants, grades, from_m, to_m, speed_mps)
        next_mps = min(free_mps, _ceiling_mps(limit, drops, from_m, to_m, train.service_braking_mps2))
        time_s += 2.0 * (to_m - from_m) / (speed_mps + next_mps)
        speed_mps = next_mps
        points.append(RunPoint(to_m, time_s, speed_mps))
    return tuple(points)


def running_time_s(train: Train, line: Line, distance_m: float) -> float:
    """Time of :func:`flat_out_run` in s; raises the same errors."""
    return flat_out_run(train, line, distance_m)[-1].time_s


def _drops(limit: Profile, distance_m: float) -> list[tuple[float, float]]:
    """Braking targets ``(position, speed^2)``: every lower limit on the way, and the stop."""
    drops = [(at_m, after**2) for (_, before), (at_m, after) in pairwise(limit) if after < before]
    return [drop for drop in drops if 0.0 < drop[0] < distance_m] + [(distance_m, 0.0)]


def _edges(
    limit: Profile, drops: list[tuple[float, float]], distance_m: float, braking_mps2: float, cell_m: float
) -> list[float]:
    """Cell ends: a uniform grid, a finer one at the start, the changes of limit, the points where braking begins."""
    cells = max(1, round(distance_m / cell_m))
    edges = {distance_m * cell / cells for cell in range(cells + 1)}
    edges.update(_DEPARTURE_M * (cell / _DEPARTURE_CELLS) ** 2 for cell in range(1, _DEPARTURE_CELLS))
    edges.update(at_m for at_m, _ in limit)
    edges.update(at_m - (speed**2 - target) / (2 * braking_mps2) for at_m, target in drops for _, speed in limit)
    return sorted(edge for edge in edges if 0.0 <= edge <= distance_m)


def _ceiling_mps(
    limit: Profile, drops: list[tuple[float, float]], from_m: float, to_m: float, braking_mps2: float
) -> float:
    """Highest speed at the end of a cell: the limit inside the cell and every braking curve ahead."""
    row = max(0, bisect_right(limit, from_m, key=lambda entry: entry[0]) - 1)
    squared = limit[row][1] ** 2
    for at_m, target in drops:
        if at_m >= to_m:
            squared = min(squared, target + 2 * braking_mps2 * (at_m - to_m))
    return sqrt(squared)


def _pulled_mps(constants: TrainConstants, grades: GradeTable, from_m: float, to_m: float, speed_mps: float) -> float:
    """Speed at the end of a cell under full traction.

    :raises CannotMove: it would be zero.
    """
    grade = mean_grade_permil(grades, (from_m + to_m) / 2)
    squared = speed_mps**2
    middle_mps = speed_mps
    # Two passes: first with the speed at the start, then with the speed in the middle of the cell.
    for _ in range(2):
        net_n = effort_limit_n(constants.traction, middle_mps) - resistance_n(constants, middle_mps, grade)
        end = squared + 2.0 * net_n / constants.mass_kg * (to_m - from_m)
        if end <= 0.0:
            raise CannotMove(
                f"{net_n / 1000:.1f} kN are left for the train at {from_m:.0f} m, {middle_mps * 3.6:.1f} km/h, "
                f"{grade:.1f} permil: it comes to a standstill"
            )
        middle_mps = sqrt((squared + end) / 2)
    return sqrt(end)
