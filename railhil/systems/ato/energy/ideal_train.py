"""An ideal train on a section: a point that follows any force at once, in cells of the line, and its fastest run.

The ideal train has neither the lag of the actuator nor a limit of the jerk. Its traction is a share of the force limit,
its deceleration is limited whatever the grade, and its speed stays below the limits for the whole train by a margin.
No driving of the same train, under the same limits, is faster or needs less work.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import Literal

import numpy as np

from railhil.common.arrays import distinct
from railhil.scenarios.profiles import Floats, MeanGrade, find_lowest
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.generate import CurveLimits
from railhil.systems.ato.scenario.model import Scenario, Train

#: ``ideal``: all that train and line permit; ``comfort``: the limits that generated target curves have by default.
Kind = Literal["ideal", "comfort"]

#: Step of the table of forces over speed (chosen: a force between two rows is then exact to 1e-5 of it).
_TABLE_STEP_MPS = 0.02
#: Positions are rounded to 1 mm, so that no cell is shorter.
_DIGITS = 3
#: Cells of the fastest run, and of its first and last metres, in which the speed changes most (chosen: 0.2 ms).
_CELL_M, _END_CELL_M, _END_M = 1.0, 0.02, 2.0


@dataclass(frozen=True, slots=True)
class Driving:
    """Limits of a driving: share of the traction force, deceleration, and distance to the speed limits."""

    traction_share: float
    braking_mps2: float
    speed_margin_mps: float


def driving_of(train: Train, kind: Kind) -> Driving:
    """The limits of ``kind``; ``comfort`` has the defaults of generated target curves
    (:class:`railhil.systems.ato.scenario.generate.CurveLimits`), without their jerk limit."""
    if kind == "ideal":
        return Driving(1.0, train.service_braking_mps2, 0.0)
    usual = CurveLimits()
    return Driving(usual.traction_utilisation, usual.braking_max_mps2, usual.speed_margin_mps)


@dataclass(frozen=True, slots=True)
class Forces:
    """Tables over speed: largest traction (N) and running resistance (N), and what turns them into accelerations."""

    speed_mps: Floats
    traction_n: Floats
    resistance_n: Floats
    weight_kn: float
    mass_kg: float

    @classmethod
    def of(cls, train: Train, driving: Driving, top_mps: float) -> Forces:
        """The tables up to a speed.

        :param top_mps: largest speed that is asked for.
        """
        speed = np.arange(0.0, top_mps + 2 * _TABLE_STEP_MPS, _TABLE_STEP_MPS)
        return cls(
            speed_mps=speed,
            traction_n=driving.traction_share * force_limit_n(train.traction, speed),
            resistance_n=resistance_n(train, speed, 0.0),
            weight_kn=train.mass_kg * train.gravity_mps2 / 1000,
            mass_kg=train.inertial_mass_kg,
        )


@dataclass(frozen=True, slots=True)
class Cells:
    """A section in cells: edges (n + 1), and of each cell (n) the highest permitted speed and the mean grade."""

    edges_m: Floats
    limit_mps: Floats
    grade_permil: Floats

    @property
    def lengths_m(self) -> Floats:
        """Length of each cell, shape (n,)."""
        return np.diff(self.edges_m)


def make_cells(scenario: Scenario, driving: Driving, cell_m: float, end_cell_m: float, end_m: float) -> Cells:
    """The cells of a section, shorter in its first and last ``end_m``; the limit changes at edges only.

    :raises CurveError: a speed limit is not above the margin.
    """
    train, distance_m = scenario.train, scenario.plan.distance_m
    front = find_lowest(scenario.line.speed_limit_mps, train.length_m, train.speed_limit_mps)
    changes_m = [from_m for from_m, _ in front]
    near = np.arange(0.0, min(end_m, distance_m / 2), end_cell_m)
    inner = np.concatenate((np.arange(0.0, distance_m, cell_m), near, distance_m - near, changes_m))
    inner = distinct(inner.round(_DIGITS))
    least_m = 10.0**-_DIGITS
    inner = inner[(inner >= least_m) & (inner <= distance_m - least_m)]
    edges = np.concatenate(([0.0], inner, [distance_m]))
    middle = (edges[1:] + edges[:-1]) / 2
    rows = [max(bisect_right(changes_m, x) - 1, 0) for x in middle.tolist()]
    limit = np.array([front[row][1] for row in rows]) - driving.speed_margin_mps
    if limit.min() <= 0.0:
        raise CurveError("a speed limit is not above the speed margin")
    return Cells(edges, limit, MeanGrade(scenario.line.grade_permil, train.length_m)(middle))


def top_speeds_mps(cells: Cells, forces: Forces, driving: Driving) -> Floats:
    """Speed of the fastest run at each edge, m/s, shape (n + 1,): no driving from rest to rest is faster anywhere.

    The lower of two passes: traction forwards, where the midpoint rule integrates ``d(v^2)/dx = 2 a(v, x)``, and
    braking backwards, where the deceleration is constant.

    :raises CurveError: the train cannot climb a grade.
    """
    lengths, ceiling = cells.lengths_m, cells.limit_mps**2
    count = len(lengths)
    forward, backward = np.zeros(count + 1), np.zeros(count + 1)
    net_n = forces.traction_n - forces.resistance_n
    climb_mps2 = (forces.weight_kn * cells.grade_permil / forces.mass_kg).tolist()
    squared = 0.0
    for i, (length_m, limit) in enumerate(zip(lengths.tolist(), ceiling.tolist(), strict=True)):
        squared = min(squared, limit)
        accel = float(np.interp(squared**0.5, forces.speed_mps, net_n)) / forces.mass_kg - climb_mps2[i]
        middle = max(squared + accel * length_m, 0.0) ** 0.5
        accel = float(np.interp(middle, forces.speed_mps, net_n)) / forces.mass_kg - climb_mps2[i]
        squared = min(squared + 2 * accel * length_m, limit)
        if squared <= 0.0:
            raise CurveError(f"the train cannot climb {cells.grade_permil[i]:.1f} permil at {cells.edges_m[i]:.0f} m")
        forward[i + 1] = squared
    squared = 0.0
    for i in range(count - 1, -1, -1):
        squared = min(squared + 2 * driving.braking_mps2 * float(lengths[i]), float(ceiling[i]))
        backward[i] = squared
    # np.minimum also lowers an edge between a lower and a higher limit: both passes end there at the lower one.
    return np.asarray(np.sqrt(np.minimum(forward, backward)))


def shortest_time_s(scenario: Scenario, comfort: bool = False) -> float:
    """Shortest time of the ideal train between the two stops of a scenario, s.

    Full traction, limits for the whole train, and the service brake's deceleration; exact to about 1 ms.

    :param comfort: under the limits of ``comfort`` instead (:func:`driving_of`).
    :raises CurveError: the train cannot climb a grade, or a speed limit is not above the margin.
    """
    driving = driving_of(scenario.train, "comfort" if comfort else "ideal")
    cells = make_cells(scenario, driving, _CELL_M, _END_CELL_M, _END_M)
    forces = Forces.of(scenario.train, driving, float(cells.limit_mps.max()))
    speed = top_speeds_mps(cells, forces, driving)
    return float((2 * cells.lengths_m / (speed[1:] + speed[:-1])).sum())
