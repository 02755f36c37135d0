"""Exact values of a target speed curve (piecewise-linear acceleration).

On the piece that starts at node ``t_i`` with acceleration ``a_i`` and slope ``j_i`` (jerk), with ``s = t -
t_i``::

    a = a_i + j_i s        v = v_i + a_i s + j_i s^2 / 2        x = x_i + v_i s + a_i s^2 / 2 + j_i s^3 / 6

After the last node the last acceleration continues: the set-point becomes virtually negative after the
planned stop (IPFC reading 5: clamping it at zero costs 5.8 s of punctuality). Before time 0 everything is
0.

The batch compiles :func:`time_in_piece_s` for single numbers (:mod:`railhil.common.compilable`).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypeAlias, overload

import numpy as np
from numpy import maximum, minimum, sqrt
from numpy.typing import ArrayLike, NDArray

from railhil.common.compilable import chosen, compilable, every
from railhil.systems.ato.scenario.model import TargetCurve

Floats: TypeAlias = NDArray[np.float64]


#: Newton's iteration ends when a step is this small.
_SETTLED_S = 1e-12
#: Maximum number of steps, more than bisection alone would need.
_STEPS_MAX = 80


@compilable
def time_in_piece_s(distance_m: Any, longest_s: Any, speed_mps: Any, accel_mps2: Any, jerk_mps3: Any) -> Any:
    """Time into a piece of the curve at which it has covered a distance; numbers, or arrays of one shape.

    Newton's method inside a bisection bracket, starting from the solution without jerk. A converged element no longer
    changes, so a number gives the same result alone as in an array.

    :param longest_s: duration of the piece; the distance is covered within it.
    :param speed_mps: at the start of the piece, like acceleration and jerk; the speed stays above 0 inside it.
    """
    low, high = 0.0 * longest_s, longest_s
    twice_mean = speed_mps + sqrt(maximum(speed_mps * speed_mps + 2.0 * accel_mps2 * distance_m, 0.0))
    moves = twice_mean > 0.0
    time_s = minimum(chosen(moves, 2.0 * distance_m / chosen(moves, twice_mean, 1.0), longest_s), longest_s)
    settled = low > high
    for _ in range(_STEPS_MAX):
        missing = time_s * (speed_mps + time_s * (accel_mps2 / 2 + time_s * jerk_mps3 / 6)) - distance_m
        now_mps = speed_mps + time_s * (accel_mps2 + time_s * jerk_mps3 / 2)
        low = chosen(missing < 0.0, time_s, low)
        high = chosen(missing < 0.0, high, time_s)
        moves = now_mps > 0.0
        newton = time_s - missing / chosen(moves, now_mps, 1.0)
        inside = moves & (newton >= low) & (newton <= high)
        better = chosen(inside, newton, (low + high) / 2)
        step_s = abs(better - time_s)
        time_s = chosen(settled, time_s, better)
        settled = settled | (step_s <= _SETTLED_S)
        if every(settled):
            break
    return time_s


class Target:
    """Evaluates one :class:`~railhil.systems.ato.scenario.model.TargetCurve`.

    Times are seconds from departure, scalar or array of any shape; results are m/s2, m/s, m of the same
    shape. ``stop_time_s`` is the first time after departure at which the speed falls to zero,
    ``stop_position_m`` the position there. Raises ``ValueError`` when the curve has no node or decreasing times, or
    never stops.
    """

    def __init__(self, curve: TargetCurve) -> None:
        nodes = np.asarray(curve.nodes, dtype=np.float64)
        if nodes.ndim != 2 or nodes.shape[1] != 2:
            raise ValueError("a target curve is a list of (time_s, accel_mps2) nodes")
        time_s, accel = nodes[:, 0], nodes[:, 1]
        step = np.diff(time_s)
        if time_s[0] != 0.0 or np.any(step <= 0.0):
            raise ValueError("node times start at 0 and increase")
        jerk = np.append(np.diff(accel) / step, 0.0)
        gain_v = accel[:-1] * step + jerk[:-1] * step**2 / 2
        speed = np.concatenate(([0.0], np.cumsum(gain_v)))
        gain_x = speed[:-1] * step + accel[:-1] * step**2 / 2 + jerk[:-1] * step**3 / 6
        self._time: Floats = time_s
        self._accel: Floats = accel
        self._jerk: Floats = jerk
        self._speed: Floats = speed
        self._position: Floats = np.concatenate(([0.0], np.cumsum(gain_x)))
        self.stop_time_s: float = self._first_stop()
        self.stop_position_m: float = self.position_m(self.stop_time_s)

    def _locate(self, t: ArrayLike) -> tuple[NDArray[np.intp], Floats]:
        time_s = np.asarray(t, dtype=np.float64)
        piece = np.clip(np.searchsorted(self._time, time_s, side="right") - 1, 0, self._time.size - 1)
        return piece, np.maximum(time_s - self._time[piece], 0.0)

    @overload
    def accel_mps2(self, t: float) -> float: ...
    @overload
    def accel_mps2(self, t: Floats) -> Floats: ...
    def accel_mps2(self, t: float | Floats) -> float | Floats:
        """Target acceleration at ``t`` seconds."""
        piece, s = self._locate(t)
        value = np.where(np.asarray(t) < 0.0, 0.0, self._accel[piece] + self._jerk[piece] * s)
        return value if value.ndim else float(value)

    @overload
    def speed_mps(self, t: float) -> float: ...
    @overload
    def speed_mps(self, t: Floats) -> Floats: ...
    def speed_mps(self, t: float | Floats) -> float | Floats:
        """Target speed at ``t`` seconds; negative after the planned stop."""
        piece, s = self._locate(t)
        value = self._speed[piece] + s * (self._accel[piece] + s * self._jerk[piece] / 2)
        return value if value.ndim else float(value)

    @overload
    def position_m(self, t: float) -> float: ...
    @overload
    def position_m(self, t: Floats) -> Floats: ...
    def position_m(self, t: float | Floats) -> float | Floats:
        """Target position at ``t`` seconds (runs backwards after the planned stop, where the speed is negative)."""
        piece, s = self._locate(t)
        value = self._position[piece] + s * (
            self._speed[piece] + s * (self._accel[piece] / 2 + s * self._jerk[piece] / 6)
        )
        return value if value.ndim else float(value)

    def time_s(self, position_m: ArrayLike) -> Floats:
        """Time at which the target first passes each position, between departure and the stop (clipped outside).

        Exact up to rounding; used for the set-point by distance.
        """
        goal = np.clip(np.asarray(position_m, dtype=np.float64), 0.0, self.stop_position_m)
        ahead = self._time < self.stop_time_s
        piece = np.maximum(np.searchsorted(self._position[ahead], goal, side="left") - 1, 0)
        lengths = np.append(self._time[1:], np.inf)
        longest = np.minimum(lengths, self.stop_time_s)[piece] - self._time[piece]
        covered = goal - self._position[piece]
        after = time_in_piece_s(covered, longest, self._speed[piece], self._accel[piece], self._jerk[piece])
        return np.asarray(self._time[piece] + after)

    def _first_stop(self) -> float:
        """First time at which the speed falls to zero after having been positive."""
        lengths = np.append(np.diff(self._time), np.inf)
        moved = False
        for i, length in enumerate(lengths):
            moved = moved or self._peak_mps(i, float(length)) > _REST_MPS
            if moved:
                rest_s = self._rest_in_piece(i, float(length))
                if rest_s is not None:
                    return float(self._time[i]) + rest_s
        raise ValueError("the target curve never comes to a stop")

    def _piece_speed(self, i: int, s: float) -> float:
        return float(self._speed[i] + s * (self._accel[i] + s * self._jerk[i] / 2))

    def _peak_mps(self, i: int, length_s: float) -> float:
        """Highest speed on piece ``i``: at its ends, or where the acceleration falls through zero."""
        if length_s == np.inf:
            return float(self._speed[i]) if self._accel[i] <= 0.0 else np.inf
        inside = [-self._accel[i] / self._jerk[i]] if self._jerk[i] < 0.0 < self._accel[i] else []
        return max(self._piece_speed(i, s) for s in (0.0, length_s, *(min(s, length_s) for s in inside)))

    def _rest_in_piece(self, i: int, length_s: float) -> float | None:
        """Time into piece ``i`` at which the speed falls to zero, ``None`` when it does not."""
        v, a, half_jerk = float(self._speed[i]), float(self._accel[i]), float(self._jerk[i]) / 2
        if half_jerk == 0.0:
            zeros = [-v / a] if a < 0.0 else []
        else:
            discriminant = a * a - 4 * half_jerk * v
            root = discriminant**0.5 if discriminant >= 0.0 else np.nan
            # Of the two zeros, the one with falling speed, in the form without cancellation for a small jerk.
            zeros = [2 * v / (root - a) if a < 0.0 else (-a - root) / (2 * half_jerk)]
        falling = [s for s in zeros if 0.0 < s <= length_s]
        if falling:
            return falling[0]
        return length_s if length_s < np.inf and abs(self._piece_speed(i, length_s)) <= _REST_MPS else None


@lru_cache(maxsize=8)
def target_of(curve: TargetCurve) -> Target:
    """The evaluated curve, made once: for a panel, which asks 5 times a second."""
    return Target(curve)


#: Speeds below this count as standstill: rounding error from summing hundreds of exact pieces.
_REST_MPS = 1e-9
