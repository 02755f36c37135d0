"""Target speed curves for any line and train, within speed, force, acceleration and jerk limits.

Method. The fastest run with piecewise-constant acceleration is built over distance (:mod:`.envelope`) under the line's
limits, the train's limit and one common speed cap. Its speed over time is then averaged over a window ``tau``: a moving
average keeps the distance, keeps every acceleration within its bounds, turns piecewise-constant acceleration into
piecewise-linear, and bounds the jerk by ``(a_max + b_max) / tau``. The cap is lowered until the running time is nearly
met; the rest is a stretch of time by ``k >= 1``, which keeps the distance exactly and lowers speed, acceleration and
jerk by k, k^2 and k^3. A curve with coasting (:mod:`.coast`) has no cap; its multiplier of time is lowered instead, and
the run between the last two multipliers that takes the time is smoothed and stretched in the same way.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from railhil.scenarios.profiles import Floats, MeanGrade, find_lowest
from railhil.systems.ato.scenario.coast import CoastingRuns, guess_multiplier_w, mix_squares
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.envelope import (
    CurveError,
    Piece,
    Zone,
    make_pass,
    mirror,
    mirror_zones,
    select_lower,
    speed_knots,
)
from railhil.systems.ato.scenario.model import Line, TargetCurve, Train

#: Acceleration reserve required at the speed of a zone, so that the train can also reach that speed.
_SPARE_MPS2 = 0.05
#: Cells in which the highest speed that the train can hold on the grade is found.
_CELL_M = 25.0
#: Long lines get longer cells: 300 km in cells of 150 m still generates in about half a second.
_CELLS_MAX = 2000
#: Time at constant deceleration before the stop, so that the curve stops straight.
_STRAIGHT_END_S = 1.0
_CAP_STEPS = 14
_CAP_LEAST_MPS = 2.0
#: Search of the multiplier of a curve with coasting: ratio to the first guess on both sides, steps; then steps in which
#: the share of two runs is halved.
_MULTIPLIER_RATIO, _MULTIPLIER_STEPS, _SHARE_STEPS = 200.0, 11, 14


@dataclass(frozen=True, slots=True)
class CurveLimits:
    """Limits of the curve, besides line and train.

    ``traction_utilisation`` and ``brake_utilisation`` are the shares of the train's force limits that the
    curve may use: the rest is reserved for control. ``speed_margin_mps`` is the distance kept to the line's limits.
    Higher limits that would be used for less than ``hold_min_s`` between two lower ones are left unused. With ``coast``
    the curve saves traction work in the same time: the train coasts before it brakes (:mod:`.coast`).
    """

    accel_max_mps2: float = 0.8
    braking_max_mps2: float = 0.7
    jerk_max_mps3: float = 0.6
    end_braking_mps2: float = 0.35
    traction_utilisation: float = 0.8
    brake_utilisation: float = 0.8
    speed_margin_mps: float = 2 / 3.6
    hold_min_s: float = 10.0
    coast: bool = False


def generate(line: Line, train: Train, distance_m: float, running_time_s: float, limits: CurveLimits) -> TargetCurve:
    """A curve that stops after exactly ``distance_m`` and ``running_time_s``, starting at position 0.

    Raises :class:`~.envelope.CurveError` when the running time is shorter than the fastest
    possible, when the train cannot climb or hold a grade, or when the distance is too short for the
    smoothing.
    """
    builder = _Builder(line, train, distance_m, limits)
    fastest = builder.curve(builder.top_mps)
    nodes = fastest
    if running_time_s < fastest[-1][0] - 1e-6:
        raise CurveError(f"running time {running_time_s:g} s is shorter than the fastest, {fastest[-1][0]:.3f} s")
    if limits.coast and (coasting := builder.coast(running_time_s)):
        return _stretch(coasting, running_time_s)
    low, high = _CAP_LEAST_MPS, builder.top_mps
    for _ in range(_CAP_STEPS):
        cap = (low + high) / 2
        slower = builder.curve(cap)
        if slower[-1][0] <= running_time_s:
            high, nodes = cap, slower
        else:
            low = cap
    return _stretch(nodes, running_time_s)


def _stretch(nodes: list[tuple[float, float]], running_time_s: float) -> TargetCurve:
    stretch = max(running_time_s / nodes[-1][0], 1.0)
    return TargetCurve(tuple((round(t * stretch, 9), round(a / stretch**2, 12)) for t, a in nodes))


def fastest_time_s(line: Line, train: Train, distance_m: float, limits: CurveLimits) -> float:
    """Shortest running time under the same limits. Raises :class:`~.envelope.CurveError`."""
    return generate_fastest(line, train, distance_m, limits)[0]


def generate_fastest(line: Line, train: Train, distance_m: float, limits: CurveLimits) -> tuple[float, TargetCurve]:
    """Shortest running time in s under the same limits, and its curve. Raises :class:`~.envelope.CurveError`."""
    builder = _Builder(line, train, distance_m, limits)
    nodes = builder.curve(builder.top_mps)
    return nodes[-1][0], _stretch(nodes, nodes[-1][0])


class _Builder:
    """Builds the curve for a given speed cap; values that do not depend on the cap are computed once."""

    def __init__(self, line: Line, train: Train, distance_m: float, limits: CurveLimits) -> None:
        self._train, self._limits = train, limits
        self._tau_s = (limits.accel_max_mps2 + limits.braking_max_mps2) / limits.jerk_max_mps3
        # Averaging x over the window moves the stop by a tau^2 / 24 (a parabola compared with its moving average).
        self._raw_m = distance_m + limits.end_braking_mps2 * self._tau_s**2 / 24
        self._grade = MeanGrade(line.grade_permil, train.length_m)
        front = find_lowest(line.speed_limit_mps, train.length_m, train.speed_limit_mps)
        self.top_mps = max(limit for _, limit in front) - limits.speed_margin_mps
        if min(limit for _, limit in front) <= limits.speed_margin_mps:
            raise CurveError("a speed limit is not above the speed margin")
        self._reach_m = self.top_mps * self._tau_s / 2
        self._zones = self._line_zones(front)

    def curve(self, cap_mps: float) -> list[tuple[float, float]]:
        """Nodes ``(time_s, accel_mps2)`` of the smoothed fastest run with no speed above the cap."""
        zones = self._join_usable([Zone(z.from_m, z.to_m, min(z.limit_mps, cap_mps)) for z in self._zones])
        forward = make_pass(zones, self._accel)
        return self._smooth(speed_knots(select_lower(forward, self._brake(zones))))

    def coast(self, running_time_s: float) -> list[tuple[float, float]] | None:
        """Nodes of the smoothed run with coasting that takes at most that time, and nearly that; None if all take
        longer, because the time is nearly that of the fastest run."""
        zones = self._join_usable(self._zones)
        braking = self._brake(zones)
        runs = CoastingRuns(self._train, self._limits, zones, self._grade, self._reach_m, braking)
        guess_w = guess_multiplier_w(self._train.inertial_mass_kg, self._raw_m, running_time_s)
        low_w, high_w = guess_w / _MULTIPLIER_RATIO, guess_w * _MULTIPLIER_RATIO
        chosen, slower = runs.list_squares(high_w), None

        def end_s(squares: list[float]) -> float:
            return speed_knots(runs.list_pieces(squares))[-1][0] + self._tau_s / 2

        if end_s(chosen) > running_time_s:
            return None
        for _ in range(_MULTIPLIER_STEPS):
            multiplier_w = (low_w * high_w) ** 0.5
            run = runs.list_squares(multiplier_w)
            if end_s(run) <= running_time_s:
                high_w, chosen = multiplier_w, run
            else:
                low_w, slower = multiplier_w, run
        if slower is not None:
            chosen = _mix(chosen, slower, lambda squares: end_s(squares) <= running_time_s)
        return self._smooth(speed_knots(runs.list_pieces(chosen)))

    def _brake(self, zones: list[Zone]) -> list[Piece]:
        """The pass with brakes, in running order."""
        end_speed = self._limits.end_braking_mps2 * (self._tau_s / 2 + _STRAIGHT_END_S)
        end_m = end_speed**2 / (2 * self._limits.end_braking_mps2)
        if end_m > self._raw_m / 3:
            raise CurveError(f"{self._raw_m:.1f} m is too short for the smoothing window of {self._tau_s:.2f} s")
        last = Piece(0.0, end_m, 0.0, end_speed**2)
        return mirror(make_pass(mirror_zones(zones, self._raw_m), self._braking, last), self._raw_m)

    def _smooth(self, knots: list[tuple[float, float]]) -> list[tuple[float, float]]:
        """Moving average of the speed: ``a(t) = (v(t) - v(t - tau)) / tau``, linear between nodes."""
        tau, slope = self._tau_s, -self._limits.end_braking_mps2
        raw_end = knots[-1][0]
        end = raw_end + tau / 2
        time_s = np.array([t for t, _ in knots] + [raw_end + tau])
        speed = np.array([v for _, v in knots] + [knots[-1][1] + slope * tau])
        edges = np.unique(np.concatenate((time_s, time_s + tau, [end])))
        edges = edges[(edges <= end) & np.append(np.diff(edges) > 1e-6, True)]
        accel = (np.interp(edges, time_s, speed) - np.interp(edges - tau, time_s, speed, left=0.0)) / tau
        nodes = [(float(t), float(a)) for t, a in zip(edges, accel, strict=True)]
        return _remove_straight(nodes)

    def _line_zones(self, front: tuple[tuple[float, float], ...]) -> list[Zone]:
        """Speed that line and grade allow; lower limits begin half a window earlier and end half a window later.

        The averaging window reaches half its length to both sides of a change of limit.
        """
        starts = [row[0] for row in front]
        margin = self._limits.speed_margin_mps
        spread = self._limits.braking_max_mps2 * self._tau_s**2 / 2
        cells = min(int(np.ceil(self._raw_m / _CELL_M)), _CELLS_MAX)
        cell_edges = set(np.linspace(0.0, self._raw_m, cells + 1).tolist())
        widened = [
            (
                -np.inf if i == 0 else from_m - ((limit - margin) * self._tau_s / 2 + spread),
                np.inf if i == len(front) - 1 else starts[i + 1] + (limit - margin) * self._tau_s / 2 + spread,
                limit - margin,
            )
            for i, (from_m, limit) in enumerate(front)
        ]
        inner = {edge for low, high, _ in widened for edge in (low, high) if 0.0 < edge < self._raw_m}
        edges = sorted(cell_edges | inner)
        zones = []
        for left, right in pairwise(edges):
            limit = min(value for low, high, value in widened if low < right and high > left)
            zones.append(Zone(left, right, min(limit, self._find_holdable(left, right, limit))))
        return zones

    def _find_holdable(self, from_m: float, to_m: float, limit_mps: float) -> float:
        """Highest speed (whole km/h below the limit) that the train can hold on the grades there."""
        grade = self._grade.extremes(from_m - self._reach_m, to_m + self._reach_m)[1]
        speeds = np.concatenate(([limit_mps], np.arange(np.floor(limit_mps * 3.6), 0.0, -1.0) / 3.6))
        force = self._limits.traction_utilisation * force_limit_n(self._train.traction, speeds)
        spare = (force - resistance_n(self._train, speeds, grade)) / self._train.inertial_mass_kg
        able = np.flatnonzero(spare >= _SPARE_MPS2)
        if able.size == 0:
            raise CurveError(f"the train cannot climb {grade:.1f} permil between {from_m:.0f} and {to_m:.0f} m")
        return float(speeds[able[0]])

    def _join_usable(self, zones: list[Zone]) -> list[Zone]:
        """Zones joined where limits are equal, without higher ones that would be used too briefly."""
        while True:
            zones = _join(zones)
            for i in range(1, len(zones) - 1):
                zone, beside = zones[i], max(zones[i - 1].limit_mps, zones[i + 1].limit_mps)
                if zone.limit_mps > beside and zone.to_m - zone.from_m < self._limits.hold_min_s * zone.limit_mps:
                    zones[i] = Zone(zone.from_m, zone.to_m, beside)
                    break
            else:
                return zones

    def _accel(self, low_mps: float, high_mps: float, from_m: float, to_m: float) -> float:
        grade = self._grade.extremes(from_m - self._reach_m, to_m + self._reach_m)[1]
        speeds = _samples(low_mps, high_mps, self._train.traction.curve)
        force = self._limits.traction_utilisation * force_limit_n(self._train.traction, speeds)
        able = float(((force - resistance_n(self._train, speeds, grade)) / self._train.inertial_mass_kg).min())
        if able <= 0:
            raise CurveError(f"the train cannot accelerate on {grade:.1f} permil near {from_m:.0f} m")
        return min(able, self._limits.accel_max_mps2)

    def _braking(self, low_mps: float, high_mps: float, from_m: float, to_m: float) -> float:
        """Deceleration on the mirrored line: the backward pass runs from the stop towards the start."""
        near, far = self._raw_m - to_m, self._raw_m - from_m
        grade = self._grade.extremes(near - self._reach_m, far + self._reach_m)[0]
        speeds = _samples(low_mps, high_mps, self._train.brake.curve)
        force = self._limits.brake_utilisation * force_limit_n(self._train.brake, speeds)
        able = float(((force + resistance_n(self._train, speeds, grade)) / self._train.inertial_mass_kg).min())
        if able < _SPARE_MPS2:
            raise CurveError(f"the brake cannot stop the train on {grade:.1f} permil near {near:.0f} m")
        return min(able, self._limits.braking_max_mps2)


def _samples(low_mps: float, high_mps: float, curve: tuple[tuple[float, float], ...]) -> Floats:
    """Speeds at which the minimum force over a band is sought: ends, middle, corners of the curve."""
    corners = [speed for speed, _ in curve]
    inside = corners[bisect_right(corners, low_mps) : bisect_right(corners, high_mps)]
    return np.array([low_mps, (low_mps + high_mps) / 2, high_mps, *inside])


def _mix(faster: list[float], slower: list[float], is_in_time: Callable[[list[float]], bool]) -> list[float]:
    """The slowest run between two that is in time."""
    low, high = 0.0, 1.0
    for _ in range(_SHARE_STEPS):
        share = (low + high) / 2
        low, high = (share, high) if is_in_time(mix_squares(faster, slower, share)) else (low, share)
    return mix_squares(faster, slower, low)


def _join(zones: list[Zone]) -> list[Zone]:
    result: list[Zone] = []
    for zone in zones:
        if result and result[-1].limit_mps == zone.limit_mps:
            result[-1] = Zone(result[-1].from_m, zone.to_m, zone.limit_mps)
        else:
            result.append(zone)
    return result


def _remove_straight(nodes: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Nodes without those that lie on the straight line between their neighbours."""
    result = nodes[:1]
    for i in range(1, len(nodes) - 1):
        (t0, a0), (t1, a1), (t2, a2) = result[-1], nodes[i], nodes[i + 1]
        if abs(a0 + (a2 - a0) * (t1 - t0) / (t2 - t0) - a1) > 1e-12:
            result.append(nodes[i])
    return [*result, nodes[-1]]
