"""Speeds over distance with coasting: full traction, hold, coast, brake, with little traction work in a given time.

Work plus ``multiplier * time`` is to be small; a smaller multiplier gives a slower run. By the maximum principle a
train on the level holds the speed v with ``v^2 R'(v) = multiplier`` (R: running resistance), and coasts before it
brakes. So the run is made in two steps. *Forwards*, the train uses full traction up to that speed and holds it; above
it, which only a descent permits, it coasts. *Backwards*, each stretch with braking is preceded by coasting, which ends
at that place of the stretch where the sum is smallest; on a descent this coasting begins before the descent.

Speeds are known as squares at the edges of cells, linear between them.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from railhil.scenarios.profiles import MeanGrade
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.envelope import CurveError, Piece, Zone
from railhil.systems.ato.scenario.model import Train

if TYPE_CHECKING:
    from railhil.systems.ato.scenario.generate import CurveLimits

#: Length of the cells, but at most so many: coasting begins and ends at their edges (chosen).
_CELL_M, _CELLS_MAX = 15.0, 2000
#: The slowest speed that is held.
_HOLD_LEAST_MPS = 2.0
#: Step of the table of accelerations over speed.
_STEP_MPS = 0.05
#: A deceleration above that of coasting by this is braking.
_BRAKING_MPS2 = 0.02
#: Times that all stretches with braking are gone through: the coasting of one changes the others.
_SWEEPS = 2
#: Squared speeds (m2/s2) may differ by this from straight lines over several cells: 5 mm/s at 15 m/s.
_STRAIGHT_M2PS2 = 0.15


@dataclass(frozen=True, slots=True)
class _Cell:
    """A cell: length (m), squared speed limit (m2/s2), and decelerations by the grade (m/s2): of its middle, and the
    largest within reach of the smoothing window."""

    length_m: float
    limit: float
    climb_mps2: float
    climb_max_mps2: float


class CoastingRuns:
    """The runs with coasting of one section, by their multipliers.

    :param zones: limits of the front, contiguous, from 0 to the beginning of the stop.
    :param grade: mean grade under the train.
    :param reach_m: half the way within the smoothing window.
    :param braking: the pass with brakes, from the stop backwards to the start.
    """

    def __init__(
        self,
        train: Train,
        limits: CurveLimits,
        zones: list[Zone],
        grade: MeanGrade,
        reach_m: float,
        braking: list[Piece],
    ) -> None:
        self._mass_kg, self._accel_max = train.inertial_mass_kg, limits.accel_max_mps2
        self._stop, whole_m = braking[-1], braking[-1].to_m
        # The last piece of the braking pass is the straight end before the stop, in which nothing coasts.
        self._edges = _list_edges(zones, whole_m, self._stop.from_m)
        mass_n_per_permil = train.mass_kg * train.gravity_mps2 / 1000
        self._cells = []
        ends = [zone.to_m for zone in zones]
        for from_m, to_m in pairwise(self._edges):
            middle_m = (from_m + to_m) / 2
            limit = zones[min(bisect_right(ends, middle_m), len(zones) - 1)].limit_mps ** 2
            steepest = grade.extremes(from_m - reach_m, to_m + reach_m)[1]
            climbs = (mass_n_per_permil * permil / self._mass_kg for permil in (float(grade(middle_m)), steepest))
            self._cells.append(_Cell(to_m - from_m, limit, *climbs))
        self._ceiling = _list_squares(braking, self._edges)
        top_mps = sqrt(max(cell.limit for cell in self._cells))
        self._speeds = np.arange(0.0, top_mps + 2 * _STEP_MPS, _STEP_MPS)
        drag = resistance_n(train, self._speeds, 0.0) / self._mass_kg
        pull = limits.traction_utilisation * force_limit_n(train.traction, self._speeds) / self._mass_kg
        self._drag, self._net = drag.tolist(), (pull - drag).tolist()
        #: Multiplier in W whose run holds each speed of the table.
        self._holding_w = self._speeds**2 * np.gradient(drag, _STEP_MPS) * self._mass_kg

    def list_squares(self, multiplier_w: float) -> list[float]:
        """Squared speeds (m2/s2) at the edges for a multiplier in W.

        :raises CurveError: the train cannot climb a grade.
        """
        hold_mps = max(float(np.interp(multiplier_w, self._holding_w, self._speeds)), _HOLD_LEAST_MPS)
        squares = self._pull(hold_mps**2)
        for _ in range(_SWEEPS):
            for stretch in reversed(self._list_braking(squares)):
                self._coast_before(stretch, squares, multiplier_w)
        return squares

    def list_pieces(self, squares: list[float]) -> list[Piece]:
        """The run as pieces with constant acceleration, joined where cells lie on a straight line."""
        kept = [0]
        fixed = [i for i in range(1, len(self._cells)) if self._cells[i].limit != self._cells[i - 1].limit]
        for first, last in pairwise([0, *fixed, len(self._cells)]):
            kept += _thin_out(self._edges, squares, first, last)
        pieces = [Piece(self._edges[i], self._edges[j], squares[i], squares[j]) for i, j in pairwise(kept)]
        return [*pieces, self._stop]

    def _pull(self, hold: float) -> list[float]:
        """The forward pass: full traction up to the squared speed ``hold``."""
        squares = [0.0]
        for cell, ceiling in zip(self._cells, self._ceiling[1:], strict=True):
            before = min(squares[-1], cell.limit)
            coasting = before + 2 * self._coasting_mps2(before, cell) * cell.length_m
            if before < hold:
                accel = min(self._look_up(self._net, before) - cell.climb_max_mps2, self._accel_max)
                middle = min(max(before + accel * cell.length_m, 0.0), hold)
                accel = min(self._look_up(self._net, middle) - cell.climb_max_mps2, self._accel_max)
                after = max(min(before + 2 * accel * cell.length_m, hold), coasting)
            else:
                after = max(hold, coasting)
            if after <= 0.0:
                raise CurveError(f"the train cannot climb near {self._edges[len(squares)]:.0f} m")
            squares.append(min(after, ceiling))
        return squares

    def _list_braking(self, squares: list[float]) -> list[range]:
        """Stretches of cells in which the run brakes."""
        found: list[range] = []
        for i, (cell, (before, after)) in enumerate(zip(self._cells, pairwise(squares), strict=True)):
            coasting = self._coasting_mps2((before + after) / 2, cell)
            if (after - before) / (2 * cell.length_m) < coasting - _BRAKING_MPS2:
                first = found.pop().start if found and found[-1].stop == i else i
                found.append(range(first, i + 1))
        return found

    def _coast_before(self, stretch: range, squares: list[float], multiplier_w: float) -> None:
        """Let the run coast to the best edge within a stretch with braking, if that lowers the sum."""
        best, best_last, most_saved = [0.0], 0, 0.0
        for last in stretch[1:]:
            coasted = self._coast_to(last, squares)
            first = last - len(coasted)
            before, after = squares[first : last + 1], [squares[first], *coasted]
            saved = sum(
                self._cost(cell, *old, multiplier_w) - self._cost(cell, *new, multiplier_w)
                for cell, old, new in zip(self._cells[first:last], pairwise(before), pairwise(after), strict=True)
            )
            if saved > most_saved:
                best, best_last, most_saved = coasted, last, saved
        if most_saved > 0.0:
            squares[best_last + 1 - len(best) : best_last + 1] = best

    def _coast_to(self, last: int, squares: list[float]) -> list[float]:
        """Squared speeds of the coasting that ends on the run at an edge: those of the edges behind the one at which it
        begins, up to that edge. Empty if it does not begin on the run."""
        after, found = squares[last], [squares[last]]
        for i in range(last - 1, -1, -1):
            cell = self._cells[i]
            middle = max(after - self._coasting_mps2(after, cell) * cell.length_m, 0.0)
            before = after - 2 * self._coasting_mps2(middle, cell) * cell.length_m
            if before >= squares[i]:
                return found[::-1]
            if before <= 0.0:
                return []
            found.append(before)
            after = before
        return []

    def _cost(self, cell: _Cell, before: float, after: float, multiplier_w: float) -> float:
        """Traction work plus multiplier times time, J."""
        drag = self._look_up(self._drag, (before + after) / 2)
        force_n = self._mass_kg * ((after - before) / (2 * cell.length_m) + drag + cell.climb_mps2)
        time_s = 2 * cell.length_m / (sqrt(before) + sqrt(after))
        return max(force_n, 0.0) * cell.length_m + multiplier_w * time_s

    def _coasting_mps2(self, square: float, cell: _Cell) -> float:
        return -self._look_up(self._drag, square) - cell.climb_mps2

    @staticmethod
    def _look_up(table: list[float], square: float) -> float:
        place = sqrt(square) / _STEP_MPS
        row = min(int(place), len(table) - 2)
        return table[row] + (place - row) * (table[row + 1] - table[row])


def guess_multiplier_w(mass_kg: float, distance_m: float, running_time_s: float) -> float:
    """A multiplier of time near the best one: ``2 M v^2 / T`` at the mean speed v (measured: within a factor of 3)."""
    return 2 * mass_kg * distance_m**2 / running_time_s**3


def mix_squares(fast: list[float], slow: list[float], share: float) -> list[float]:
    """A run between two: accelerations lie between theirs, and the same limits hold."""
    return [(1 - share) * one + share * other for one, other in zip(fast, slow, strict=True)]


def _list_edges(zones: list[Zone], whole_m: float, stop_m: float) -> list[float]:
    """Edges from the start to the beginning of the straight end; limits change at edges only."""
    cell_m = max(_CELL_M, whole_m / _CELLS_MAX)
    edges = [0.0]
    for zone in zones:
        to_m = min(zone.to_m, stop_m)
        count = int((to_m - edges[-1]) / cell_m) + 1
        if to_m > edges[-1]:
            edges += np.linspace(edges[-1], to_m, count + 1)[1:].tolist()
    return edges


def _list_squares(pieces: list[Piece], edges: list[float]) -> list[float]:
    """Squared speeds of a pass at edges; where it jumps, the lower one."""
    ends = [piece.to_m for piece in pieces]
    found = []
    for edge in edges:
        i = min(bisect_right(ends, edge), len(pieces) - 1)
        near = [pieces[i].u(max(edge, pieces[i].from_m))] + ([pieces[i - 1].to_u] if i and ends[i - 1] == edge else [])
        found.append(min(near))
    return found


def _thin_out(edges: list[float], squares: list[float], first: int, last: int) -> list[int]:
    """Edges behind ``first`` up to ``last`` that are needed (Ramer, Douglas and Peucker): a chord has an acceleration
    between those of its cells."""
    length_m, rise = edges[last] - edges[first], squares[last] - squares[first]
    off = [abs(squares[first] + rise * (edges[i] - edges[first]) / length_m - squares[i]) for i in range(first, last)]
    if max(off) <= _STRAIGHT_M2PS2:
        return [last]
    corner = first + off.index(max(off))
    return _thin_out(edges, squares, first, corner) + _thin_out(edges, squares, corner, last)
