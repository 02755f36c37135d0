"""Speeds that a high-speed train has to follow: the target curve of the journey, and the emergency profile.

Both are computed at load by explicit steps of :data:`GRID_S`, with the operations ``+ - * /`` only, so every CPython
gives the same bits. Neither the papers nor another public source prints the curve: the scenario file has the
assumptions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import accumulate, pairwise

from railhil.systems.high_speed.task import CurveTable, EmergencyTable, HighSpeedTask

#: Spacing of the points of a curve.
GRID_S = 0.05
_KMH = 3.6


@dataclass(frozen=True, slots=True)
class SpeedCurve:
    """A speed over time and over distance, at multiples of :data:`GRID_S`; after the last point the train stands.

    ``speeds_mps``: shape (n,), at the times 0, 0.05, ... ``positions_m``: the distance covered by then (trapezia).
    """

    speeds_mps: tuple[float, ...]
    positions_m: tuple[float, ...]

    @classmethod
    def of(cls, speeds_mps: list[float], start_m: float = 0.0) -> SpeedCurve:
        """The curve of these speeds.

        :param start_m: position at time 0.
        """
        steps = ((a + b) * (0.5 * GRID_S) for a, b in pairwise(speeds_mps))
        return cls(tuple(speeds_mps), tuple(accumulate(steps, initial=start_m)))

    @property
    def duration_s(self) -> float:
        """Time of the last point."""
        return (len(self.speeds_mps) - 1) * GRID_S

    @property
    def length_m(self) -> float:
        """Distance from the first point to the last."""
        return self.positions_m[-1] - self.positions_m[0]

    def speed_mps(self, time_s: float) -> float:
        """Speed at any time >= 0, linear between the points."""
        place = time_s / GRID_S
        index = int(place)
        if index >= len(self.speeds_mps) - 1:
            return self.speeds_mps[-1]
        low, high = self.speeds_mps[index], self.speeds_mps[index + 1]
        return low + (high - low) * (place - index)

    def position_m(self, time_s: float) -> float:
        """Position of a train that follows the curve, at a time >= 0, linear between the points."""
        place = time_s / GRID_S
        index = int(place)
        if index >= len(self.positions_m) - 1:
            return self.positions_m[-1]
        low, high = self.positions_m[index], self.positions_m[index + 1]
        return low + (high - low) * (place - index)


def resistance_mps2(davis_n_per_t: tuple[float, float, float], speed_mps: float) -> float:
    """Deceleration by the running resistance ``a + b V + c V^2`` (N/t, V in km/h; Davis)."""
    a, b, c = davis_n_per_t
    speed_kmh = speed_mps * _KMH
    return (a + b * speed_kmh + c * speed_kmh * speed_kmh) / 1000.0


@cache
def journey_curve(task: HighSpeedTask) -> SpeedCurve:
    """The target curve of a task: traction, cruise, speed restriction, coasting, braking, averaged over some seconds.

    The average is taken over the past, so it limits the jerk and keeps the distance.
    """
    curve, coast, slow = task.curve, task.curve.coasting, task.curve.restriction
    peak_mps = curve.peak_kmh / _KMH
    end_m = curve.distance_km * 1000.0
    slow_mps, slow_from_m, slow_to_m = slow.speed_kmh / _KMH, slow.from_km * 1000.0, slow.to_km * 1000.0
    coast_mps, coast_from_m, coast_to_m = coast.speed_kmh / _KMH, coast.from_km * 1000.0, coast.to_km * 1000.0
    speed_mps = position_m = 0.0
    speeds = [0.0]
    while True:
        braked = _braking_mps2(curve, speed_mps, 0.0, end_m - position_m)
        if not braked and position_m < slow_from_m:
            braked = _braking_mps2(curve, speed_mps, slow_mps, slow_from_m - position_m)
        if braked:
            accel_mps2 = -braked
        else:
            limit_mps = slow_mps if slow_from_m <= position_m < slow_to_m else peak_mps
            coasts = coast_from_m <= position_m < coast_to_m
            if coasts:
                limit_mps = coast_mps
            left_mps2 = (limit_mps - speed_mps) / GRID_S
            if left_mps2 >= 0.0:
                accel_mps2 = min(_traction_mps2(task, speed_mps), left_mps2)
            else:
                free_mps2 = resistance_mps2(task.davis_n_per_t, speed_mps) if coasts else curve.braking_mps2
                accel_mps2 = max(-free_mps2, left_mps2)
        after_mps = max(0.0, speed_mps + accel_mps2 * GRID_S)
        position_m += (speed_mps + after_mps) * (0.5 * GRID_S)
        speed_mps = after_mps
        speeds.append(speed_mps)
        if speed_mps == 0.0:
            return SpeedCurve.of(_averaged(speeds, round(curve.average_s / GRID_S)))


def _traction_mps2(task: HighSpeedTask, speed_mps: float) -> float:
    """Acceleration that the curve uses: a constant, or a share of the power less the running resistance."""
    curve = task.curve
    power_mps2 = curve.power_share * task.power_w_per_kg / max(speed_mps, 1.0)
    return min(curve.traction_mps2, power_mps2 - resistance_mps2(task.davis_n_per_t, speed_mps))


def _braking_mps2(curve: CurveTable, speed_mps: float, to_mps: float, left_m: float) -> float:
    """Deceleration that ends with a speed at the end of the distance left, 0 while it is too early to brake."""
    squares = speed_mps * speed_mps - to_mps * to_mps
    if squares <= 0.0 or squares < 2.0 * curve.braking_mps2 * left_m:
        return 0.0
    last_mps2 = (speed_mps - to_mps) / GRID_S
    return min(squares / (2.0 * left_m), last_mps2) if left_m > 0.0 else last_mps2


def _averaged(speeds: list[float], count: int) -> list[float]:
    """Each point the mean of the last ``count`` intervals, by the sums of the trapezia; the train stood before."""
    if count < 1:
        return speeds
    speeds = speeds + [0.0] * count
    sums = list(accumulate(((a + b) * 0.5 for a, b in pairwise(speeds)), initial=0.0))
    return [(sums[i] - (sums[i - count] if i >= count else 0.0)) / count for i in range(len(speeds))]


@cache
def emergency_curve(emergency: EmergencyTable, speed_mps: float) -> SpeedCurve:
    """The emergency profile from a speed to a standstill; positions from the trigger.

    The deceleration grows linearly between two speeds as the speed falls, and is built up over ``build_up_s``.
    """
    high_mps, low_mps = emergency.high_kmh / _KMH, emergency.low_kmh / _KMH
    slope = (emergency.at_low_mps2 - emergency.at_high_mps2) / (high_mps - low_mps)
    speeds, braking_mps2 = [speed_mps], 0.0
    while speeds[-1] > 0.0:
        mid_mps = speeds[-1] - braking_mps2 * (0.5 * GRID_S)
        now_mps = min(max(mid_mps, low_mps), high_mps)
        wanted_mps2 = emergency.at_high_mps2 + slope * (high_mps - now_mps)
        mid_s = (len(speeds) - 0.5) * GRID_S
        built = min(1.0, mid_s / emergency.build_up_s) if emergency.build_up_s > 0.0 else 1.0
        braking_mps2 = wanted_mps2 * built
        speeds.append(max(0.0, speeds[-1] - braking_mps2 * GRID_S))
    return SpeedCurve.of(speeds)
