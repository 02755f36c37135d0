"""Checks of the protection's own readings: finite, in time, odometer and speed of one axle in agreement."""

from __future__ import annotations

from math import isfinite

#: Longest time between two looks: three of them, and a tick.
_GAP_MAX_S = 0.35
#: Odometer and speed are compared over this way, and may differ by this much in it: 5 %.
_WAY_M = 20.0
_DIFFERENCE_MAX_M = 1.0


class SelfTest:
    """Looks at the readings of every supervision. All limits are chosen."""

    __slots__ = ("_by_odometer_m", "_by_speed_m", "_last")

    def __init__(self) -> None:
        self._last: tuple[float, float, float] | None = None
        self._by_speed_m = self._by_odometer_m = 0.0

    def is_healthy(self, time_s: float, speed_mps: float, odometer_m: float) -> bool:
        """False: the protection cannot trust itself."""
        if not (isfinite(time_s) and isfinite(speed_mps) and isfinite(odometer_m)) or speed_mps < 0.0:
            return False
        if self._last is not None:
            last_s, last_mps, last_m = self._last
            step_s = time_s - last_s
            if not 0.0 < step_s <= _GAP_MAX_S:
                return False
            self._by_speed_m += 0.5 * (speed_mps + last_mps) * step_s
            self._by_odometer_m += odometer_m - last_m
            if abs(self._by_speed_m - self._by_odometer_m) > _DIFFERENCE_MAX_M:
                return False
            if self._by_speed_m > _WAY_M:
                self._by_speed_m = self._by_odometer_m = 0.0
        self._last = time_s, speed_mps, odometer_m
        return True
