"""Set-points of the target speed curve for the control law, now and over the law's horizon.

Tables are made before the run from the exact curve; in an IQ arithmetic a look-up uses only integers.

``time``: v*(k Ts), as eqs. (11) to (19) of the IPFC paper are printed. After the planned stop the last deceleration
continues (virtual negative speed) down to -100 km/h, which requests the strongest brake, as any lower speed would.

``distance``: v*(x) and preview v*(t*(x) + i Ts), where t*(x) is the time at which the target passes x. The target's
positions are tabulated every sixteenth of a control period, and t* is interpolated linearly between them: off by at
most a (Ts/16)^2 / 8 in position, 0.1 mm at 1 m/s2 and 0.5 s. At rest the distance does not advance, so the first metres
are indexed by time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Generic

import numpy as np
from numpy.typing import NDArray

from railhil.common.command_line import INDEXINGS
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.laws.base import SPEED_Q
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import Target

#: Position from which the distance indexing uses the distance.
DISTANCE_FROM_M = 5.0

#: Table entries per control period of the distance indexing.
_PER_PERIOD = 16
#: Fraction of a table cell.
_FRACTION_Q = 20
#: Lower limit of the virtual speeds after the stop, km/h.
_VIRTUAL_MIN_KMH = -100.0
#: Half an LSB of the format: a value that is zero in fixed point is zero in float64 too.
_REST_KMH = 0.5**SPEED_Q / 2
_KMH = 3.6
_01MM = 1e4


def _speed_constants(name: str, target: Target, times_s: NDArray[np.float64]) -> list[Constant]:
    speeds = np.maximum(target.speed_mps(times_s) * _KMH, _VIRTUAL_MIN_KMH)
    # Summing the curve's pieces leaves about 1e-14 km/h of either sign at the stop. It is set to zero in every
    # arithmetic, because a law may test whether the set-point is below zero.
    speeds[abs(speeds) < _REST_KMH] = 0.0
    return [Constant(f"{name}[{i}]", float(speed), SPEED_Q) for i, speed in enumerate(speeds)]


class SetPoints(Generic[T]):
    """Set-points in km/h (Q ``SPEED_Q``) on one arithmetic.

    Raises :class:`~railhil.common.errors.InputError` for an unknown indexing, and for the distance indexing of a run
    that is shorter than ``DISTANCE_FROM_M``.
    """

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, indexing: str, horizon: int) -> None:
        if indexing not in INDEXINGS:
            raise InputError("indexing", "name", indexing, f"one of {', '.join(INDEXINGS)}")
        self._ar = arithmetic
        self._horizon = horizon
        period_s = scenario.timing.control_period_ns / 1e9
        target = Target(scenario.target)
        end_s = max(scenario.plan.running_time_s, target.stop_time_s) + scenario.plan.overtime_max_s
        count = math.ceil(end_s / period_s) + horizon + 1
        times_s = np.arange(count, dtype=np.float64) * period_s
        self._by_time = arithmetic.table("v_of_t", _speed_constants("v_of_t", target, times_s))
        self._last_k = count - horizon - 1
        self._distance = _DistanceTable(arithmetic, target, period_s, horizon) if indexing == "distance" else None

    def at(self, k: Any, position_01mm: T) -> tuple[T, Sequence[T]]:
        """Set-point of control period ``k`` and those of the next ``horizon`` periods.

        ``position_01mm`` is the measured position in 0.1 mm (whole numbers in every arithmetic). Beyond the end of the
        timetable plus the overtime of the plan, and before 0, the last or first entries apply.
        """
        ar = self._ar
        first = ar.index(k, self._last_k)
        by_time = [ar.at(self._by_time, first, i) for i in range(self._horizon + 1)]
        if self._distance is None:
            return by_time[0], by_time[1:]
        by_distance = self._distance.at(position_01mm)
        under_way = ar.gt(position_01mm, self._distance.from_01mm)
        points = [ar.where(under_way, d, t) for d, t in zip(by_distance, by_time, strict=True)]
        return points[0], points[1:]


class _DistanceTable(Generic[T]):
    """v*(t*(x) + i Ts); times are counted backwards from the stop, so that the last entry is the stopping point."""

    def __init__(self, arithmetic: Arithmetic[T], target: Target, period_s: float, horizon: int) -> None:
        if target.stop_position_m <= DISTANCE_FROM_M:
            raise InputError(
                "scenario", "target", f"{target.stop_position_m:g} m to the stop", f"more than {DISTANCE_FROM_M:g} m"
            )
        self._ar = arithmetic
        cell_s = period_s / _PER_PERIOD
        before = math.ceil((target.stop_time_s - float(target.time_s(DISTANCE_FROM_M))) / cell_s)
        times_s: NDArray[np.float64] = target.stop_time_s + np.arange(-before, 1, dtype=np.float64) * cell_s
        positions = target.position_m(times_s) * _01MM
        distances = [Constant(f"x_of_t[{i}]", round(x), 0) for i, x in enumerate(positions)]
        self._position = arithmetic.table("x_of_t", distances)
        after = np.arange(1, horizon * _PER_PERIOD + 1)
        all_times_s: NDArray[np.float64] = np.append(times_s, target.stop_time_s + after * cell_s)
        self._speed = arithmetic.table("v_of_x", _speed_constants("v_of_x", target, all_times_s))
        self._offsets = [i * _PER_PERIOD for i in range(horizon + 1)]
        self._zero = arithmetic.const(Constant("zero", 0.0, 0))
        self._one = arithmetic.const(Constant("one", 1.0, _FRACTION_Q))
        self._one_01mm = arithmetic.const(Constant("one_01mm", 1.0, 0))
        #: Position at which the distance indexing begins, 0.1 mm.
        self.from_01mm = arithmetic.const(Constant("from", DISTANCE_FROM_M * _01MM, 0))

    def at(self, position_01mm: T) -> list[Any]:
        ar = self._ar
        index = ar.locate(self._position, position_01mm)
        begin = ar.at(self._position, index)
        # Close to the stop, neighbouring entries may have the same position (0.1 mm).
        length = ar.maximum(ar.sub(ar.at(self._position, index, 1), begin), self._one_01mm)
        fraction = ar.div(ar.clip(ar.sub(position_01mm, begin), length, self._zero), length, _FRACTION_Q)
        # Already at most 1; repeated for the interval analysis of the product below.
        fraction = ar.minimum(fraction, self._one)
        points = []
        for offset in self._offsets:
            left, right = ar.at(self._speed, index, offset), ar.at(self._speed, index, offset + 1)
            points.append(ar.add(left, ar.rmpy(ar.sub(right, left), fraction, _FRACTION_Q)))
        return points
