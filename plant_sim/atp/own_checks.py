"""Checks of the protection's own readings: finite, in time, odometer and speed of one axle in agreement."""

from __future__ import annotations

from math import isfinite

#: Longest time between two looks: three of them, and a tick.
_GAP_MAX_S = 0.35
#: Odometer and speed are compared over this way, and may differ by this much in it: 5 %.
_WAY_M = 20.0
_DIFFERENCE_MAX_M = 1.0


class OwnChecks:
    """Looks at the readings of every supervision. All limits are chosen."""

    __slots__ = ("_began", "_by_odometer_m", "_by_speed_m", "_odometer_m", "_speed_mps", "_time_s")

    def __init__(self) -> None:
        self._began = False
        self._time_s = self._speed_mps = self._odometer_m = 0.0
        self._by_speed_m = self._by_odometer_m = 0.0

    def is_healthy(self, time_s: float, speed_mps: float, odometer_m: float) -> bool:
        """False: the protection cannot trust itself."""
        if not isfinite(time_s + speed_mps + odometer_m) or speed_mps < 0.0:
            return False
        if not self._began:
            self._began = True
        else:
            step_s = time_s - self._time_s
            if not 0.0 < step_s <= _GAP_MAX_S:
                return False
            self._by_speed_m += 0.5 * (speed_mps + self._speed_mps) * step_s
            self._by_odometer_m += odometer_m - self._odometer_m
            if abs(self._by_speed_m - self._by_odometer_m) > _DIFFERENCE_MAX_M:
                return False
            if self._by_speed_m > _WAY_M:
                self._by_speed_m = self._by_odometer_m = 0.0
        self._time_s, self._speed_mps, self._odometer_m = time_s, speed_mps, odometer_m
        return True
