"""Exact deceleration curve through a foot: along it ``d(V^2)/dd = -2 A(V, d)``.

Between neighbouring steps of speed and position the deceleration is constant, so ``V^2`` is linear in position. The
curve is walked from step to step, once; afterwards a value is a bisection and the last piece in closed form.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from math import inf, sqrt

from railhil.scenarios.profiles import Profile

#: Least deceleration along a curve: below it a brake does not hold the train on the grade.
DECELERATION_MIN_MPS2 = 0.05


class GradeNotHeldError(ValueError):
    """The deceleration is too small somewhere along a curve.

    :ivar found_mps2: the deceleration there.
    :ivar position_m: where the curve enters the piece, walked from the foot.
    :ivar speed_mps: its speed there.
    :ivar brake: the word for the brake.
    """

    def __init__(self, found_mps2: float, position_m: float, speed_mps: float, brake: str = "emergency") -> None:
        super().__init__(found_mps2, position_m, speed_mps, brake)
        self.found_mps2 = found_mps2
        self.position_m = position_m
        self.speed_mps = speed_mps
        self.brake = brake

    def __str__(self) -> str:
        return f"{self.found_mps2:.3f} m/s2 at {self.position_m:g} m, {self.speed_mps * 3.6:g} km/h"


@dataclass(frozen=True, slots=True)
class BrakingCurve:
    """A deceleration curve as pieces, in order of rising speed and falling position.

    Piece ``i`` goes from ``squares[i]`` (m2/s2) at ``positions_m[i]`` to the rear with ``decelerations_mps2[i]``; the
    first also goes on to the front, the last one to the rear.
    """

    squares: tuple[float, ...]
    positions_m: tuple[float, ...]
    decelerations_mps2: tuple[float, ...]

    def position_m(self, speed_mps: float) -> float:
        """Where the curve has a speed >= 0."""
        return self.piece(speed_mps)[0]

    def piece(self, speed_mps: float) -> tuple[float, float]:
        """Where the curve has a speed >= 0, and the deceleration of its piece to the rear."""
        square = speed_mps * speed_mps
        row = bisect_right(self.squares, square, 1) - 1
        rate_mps2 = self.decelerations_mps2[row]
        return self.positions_m[row] - (square - self.squares[row]) / (2.0 * rate_mps2), rate_mps2

    def speed_mps(self, position_m: float) -> float:
        """Speed of the curve at a position; 0 behind its end."""
        piece = bisect_right(self.positions_m, -position_m, 1, key=lambda at_m: -at_m) - 1
        square = self.squares[piece] + 2.0 * self.decelerations_mps2[piece] * (self.positions_m[piece] - position_m)
        return sqrt(max(square, 0.0))


def braking_curve(
    foot_m: float,
    foot_mps: float,
    decelerations: Profile,
    gradients: Profile,
    fastest_mps: float,
    slowest_mps: float = 0.0,
) -> BrakingCurve:
    """The curve through a foot, between two speeds.

    :param decelerations: on the level, rows ``(from_mps, m/s2)``, the first from 0.
    :param gradients: added to it, rows ``(from_m, m/s2)``; the first also applies before its position.
    :raises GradeNotHeldError: the sum is not above :data:`DECELERATION_MIN_MPS2` somewhere along it.
    """
    front = _walk_to_front(foot_m, foot_mps, decelerations, gradients, slowest_mps)
    rear = _walk_to_rear(foot_m, foot_mps, decelerations, gradients, fastest_mps)
    rows = [*reversed(front), *rear]
    return BrakingCurve(tuple(row[0] for row in rows), tuple(row[1] for row in rows), tuple(row[2] for row in rows))


def _walk_to_rear(
    foot_m: float, foot_mps: float, decelerations: Profile, gradients: Profile, fastest_mps: float
) -> list[tuple[float, float, float]]:
    """Rows ``(square, position, deceleration)`` of the pieces that begin at the foot and behind it."""
    speed_row = bisect_right(decelerations, foot_mps, key=_first) - 1
    place_row = max(bisect_left(gradients, foot_m, key=_first) - 1, 0)
    square, at_m = foot_mps * foot_mps, foot_m
    rows: list[tuple[float, float, float]] = []
    while not rows or square < fastest_mps * fastest_mps:
        rate = _held(decelerations[speed_row][1] + gradients[place_row][1], at_m, square)
        rows.append((square, at_m, rate))
        next_square = decelerations[speed_row + 1][0] ** 2 if speed_row + 1 < len(decelerations) else inf
        next_m = gradients[place_row][0] if place_row > 0 else -inf
        if next_square == inf and next_m == -inf:
            break
        at_speed_step_m = at_m - (next_square - square) / (2.0 * rate)
        is_speed_step, is_place_step = at_speed_step_m >= next_m, at_speed_step_m <= next_m
        square = next_square if is_speed_step else square + 2.0 * rate * (at_m - next_m)
        at_m = next_m if is_place_step else at_speed_step_m
        speed_row += is_speed_step
        place_row -= is_place_step
    return rows


def _walk_to_front(
    foot_m: float, foot_mps: float, decelerations: Profile, gradients: Profile, slowest_mps: float
) -> list[tuple[float, float, float]]:
    """Rows of the pieces that end at the foot and before it, in order of falling speed."""
    speed_row = max(bisect_left(decelerations, foot_mps, key=_first) - 1, 0)
    place_row = max(bisect_right(gradients, foot_m, key=_first) - 1, 0)
    square, at_m, end = foot_mps * foot_mps, foot_m, slowest_mps * slowest_mps
    rows: list[tuple[float, float, float]] = []
    while square > end:
        rate = _held(decelerations[speed_row][1] + gradients[place_row][1], at_m, square)
        next_square = max(decelerations[speed_row][0] ** 2, end)
        next_m = gradients[place_row + 1][0] if place_row + 1 < len(gradients) else inf
        at_speed_step_m = at_m + (square - next_square) / (2.0 * rate)
        is_speed_step, is_place_step = at_speed_step_m <= next_m, at_speed_step_m >= next_m
        square = next_square if is_speed_step else square - 2.0 * rate * (next_m - at_m)
        at_m = next_m if is_place_step else at_speed_step_m
        rows.append((square, at_m, rate))
        speed_row -= is_speed_step
        place_row += is_place_step
    return rows


def _held(rate_mps2: float, at_m: float, square: float) -> float:
    if not rate_mps2 > DECELERATION_MIN_MPS2:
        raise GradeNotHeldError(rate_mps2, at_m, sqrt(square))
    return rate_mps2


def _first(row: tuple[float, float]) -> float:
    return row[0]
