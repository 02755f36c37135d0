"""Limits before a target: positions of EBI, SBI, warning, permitted speed and indication over speed, and their inverse.

::

    V1 = V_delta0(V)     V2 = max(A_est, 0) T_traction     V3 = clamp(A_est, 0, 0.4) T_berem     V_t target speed
    V_bec = max(V + V1 + V2, V_t) + V3
    D_bec = max(V + V1 + V2/2, V_t) T_traction + (max(V + V1 + V2, V_t) + V3/2) T_berem
    d_EBI(V) = d_EBD(V_bec) - D_bec        d_SBI2(V) = d_EBI(V) - V T_bs2        d_SBI1(V) = d_SBD(V) - V T_bs1
    d_W = d_SBI - V T_warning              d_P = d_SBI - V T_driver              d_I = d_P - V T_ind

A target has one or two :class:`LimitCurve`: from the EBD, whose limits are compared with the most advanced position of
the front, and for an end of authority from the SBD, compared with the estimated position. From the SBD the allowances
are zero, so that its ``d_EBI`` is ``d_SBD``.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

from railhil.scenarios.profiles import Profile
from railhil.systems.line.braking.brake import BrakeModel
from railhil.systems.line.braking.curve import BrakingCurve, GradeNotHeldError, braking_curve

#: Largest acceleration that is assumed to go on while the emergency brake builds up.
GROWTH_MAX_MPS2 = 0.4
#: A speed at a position is found when it changes by less.
_SPEED_TOLERANCE_MPS = 1e-9
#: More steps than bisection alone needs.
_STEPS_MAX = 80

#: Rows ``(speed_mps, allowance_mps)`` with linear interpolation, held at both ends.
SpeedTable = tuple[tuple[float, float], ...]

#: Allowance for the error of the own speed: 0.3, 1.0, 2.0 km/h at 0, 30, 80 km/h (chosen).
SPEED_ALLOWANCE: SpeedTable = ((0.0, 0.3 / 3.6), (30 / 3.6, 1.0 / 3.6), (80 / 3.6, 2.0 / 3.6))


def interpolate(table: SpeedTable, speed_mps: float) -> float:
    """Value of a table at a speed, linear between rows and held at both ends."""
    before_mps, before = table[0]
    if speed_mps <= before_mps:
        return before
    for at_mps, value in table:
        if speed_mps < at_mps:
            return before + (value - before) * (speed_mps - before_mps) / (at_mps - before_mps)
        before_mps, before = at_mps, value
    return before


def slope_at(table: SpeedTable, speed_mps: float) -> float:
    """Slope of a table behind a speed."""
    for (before_mps, before), (at_mps, value) in pairwise(table):
        if before_mps <= speed_mps < at_mps:
            return (value - before) / (at_mps - before_mps)
    return 0.0


@dataclass(frozen=True, slots=True)
class Increments:
    """Speeds above a ceiling at which warning, service brake and emergency brake begin, each as a table."""

    warning: SpeedTable
    service: SpeedTable
    emergency: SpeedTable


def _between(low_kmh: float, low: float, high_kmh: float, high: float) -> SpeedTable:
    return ((low_kmh / 3.6, low / 3.6), (high_kmh / 3.6, high / 3.6))


#: ``metro`` is chosen; ``subset026`` as in the public programs.
INCREMENTS = {
    "metro": Increments(((0.0, 2 / 3.6),), ((0.0, 3 / 3.6),), ((0.0, 5 / 3.6),)),
    "subset026": Increments(_between(110, 4, 140, 5), _between(110, 5.5, 210, 10), _between(110, 7.5, 210, 15)),
}


class LimitTimes(NamedTuple):
    """Times in s by which the limits lie before the EBI or the SBD."""

    service_s: float
    warning_s: float
    permitted_s: float
    indication_s: float

    @classmethod
    def of(cls, brake: BrakeModel, t_bs_s: float) -> LimitTimes:
        """Those of a brake, with one of the times of its service brake."""
        permitted_s = t_bs_s + brake.t_driver_s
        return cls(t_bs_s, t_bs_s + brake.t_warning_s, permitted_s, permitted_s + brake.t_indication_s(t_bs_s))


class LimitCurve:
    """Limits before one deceleration curve; a ``lead_s`` of :class:`LimitTimes` says which, 0 is the EBI.

    Speeds below the target's are not limited: there every limit is the target speed.
    """

    __slots__ = ("_allowance", "_t_berem_s", "_t_traction_s", "curve", "target_mps", "times")

    def __init__(
        self,
        curve: BrakingCurve,
        target_mps: float,
        times: LimitTimes,
        allowance: SpeedTable = ((0.0, 0.0),),
        t_traction_s: float = 0.0,
        t_berem_s: float = 0.0,
    ) -> None:
        self.curve = curve
        self.target_mps = target_mps
        self.times = times
        self._allowance = allowance
        self._t_traction_s, self._t_berem_s = t_traction_s, t_berem_s

    def place_m(self, speed_mps: float, lead_s: float, accel_mps2: float = 0.0) -> float:
        """Position at which a limit is reached at a speed, with an estimated acceleration."""
        start_mps, run_m = self._start(speed_mps, accel_mps2)
        return self.curve.position_m(start_mps) - run_m - speed_mps * lead_s

    def speed_mps(
        self,
        position_m: float,
        lead_s: float,
        fastest_mps: float,
        accel_mps2: float = 0.0,
        near_mps: float | None = None,
    ) -> float:
        """Speed of a limit at a position: between the target's and ``fastest_mps``, to 1e-9 m/s.

        Between the steps of the curve the position is a parabola of the speed, so one step finds the root of its piece;
        bisection finds the piece where that fails.

        :param near_mps: where to begin.
        """
        low_mps, high_mps = self.target_mps, fastest_mps
        if high_mps <= low_mps:
            return low_mps
        speed_mps = high_mps if near_mps is None else min(max(near_mps, low_mps), high_mps)
        is_low_seen = is_high_seen = False
        for _ in range(_STEPS_MAX):
            place_m, slope, bend = self._parabola(speed_mps, lead_s, accel_mps2)
            gap_m = place_m - position_m
            if gap_m > 0.0:
                if speed_mps >= high_mps:
                    return high_mps
                low_mps, is_low_seen = speed_mps, True
            else:
                if speed_mps <= low_mps:
                    return low_mps
                high_mps, is_high_seen = speed_mps, True
            square = slope * slope - 2.0 * bend * gap_m
            divisor = sqrt(square) - slope if square > 0.0 else 0.0
            better_mps = speed_mps + 2.0 * gap_m / divisor if divisor > 0.0 else -1.0
            if abs(better_mps - speed_mps) < _SPEED_TOLERANCE_MPS:
                return speed_mps
            if better_mps <= low_mps:
                better_mps = 0.5 * (low_mps + high_mps) if is_low_seen else low_mps
            elif better_mps >= high_mps:
                better_mps = 0.5 * (low_mps + high_mps) if is_high_seen else high_mps
            speed_mps = better_mps
        return speed_mps

    def _parabola(self, speed_mps: float, lead_s: float, accel_mps2: float) -> tuple[float, float, float]:
        """:meth:`place_m`, and its first and second derivative by speed."""
        start_mps, run_m = self._start(speed_mps, accel_mps2)
        place_m, rate_mps2 = self.curve.piece(start_mps)
        growth = 1.0 + slope_at(self._allowance, speed_mps)
        run_slope = growth * (self._t_traction_s + self._t_berem_s)
        if start_mps < self.target_mps:
            growth = run_slope = 0.0
        slope = -growth * start_mps / rate_mps2 - run_slope - lead_s
        return place_m - run_m - speed_mps * lead_s, slope, -growth * growth / rate_mps2

    def _start(self, speed_mps: float, accel_mps2: float) -> tuple[float, float]:
        """``V_bec`` and ``D_bec``."""
        known_mps = speed_mps + interpolate(self._allowance, speed_mps)
        t_traction_s, t_berem_s = self._t_traction_s, self._t_berem_s
        target_mps = self.target_mps
        if accel_mps2 <= 0.0:
            start_mps = known_mps if known_mps > target_mps else target_mps
            return start_mps, start_mps * (t_traction_s + t_berem_s)
        gain_mps = accel_mps2 * t_traction_s
        growth_mps = min(accel_mps2, GROWTH_MAX_MPS2) * t_berem_s
        start_mps = max(known_mps + gain_mps, target_mps)
        run_m = max(known_mps + gain_mps / 2.0, target_mps) * t_traction_s
        return start_mps + growth_mps, run_m + (start_mps + growth_mps / 2.0) * t_berem_s


@dataclass(frozen=True, slots=True)
class Braking:
    """All on which the curves of one train on one line depend.

    :ivar gradients: ``A_g`` over the position of the front, m/s2.
    :ivar fastest_mps: up to this speed curves are made.
    """

    brake: BrakeModel
    gradients: Profile
    fastest_mps: float
    allowance: SpeedTable = SPEED_ALLOWANCE

    def emergency_limits(self, foot_m: float, foot_mps: float, target_mps: float) -> LimitCurve:
        """Limits before the EBD through a foot.

        :raises GradeNotHeldError: the emergency brake does not hold a grade on the way.
        """
        brake = self.brake
        slowest_mps, fastest_mps = min(target_mps, foot_mps), max(self.fastest_mps, foot_mps)
        curve = braking_curve(foot_m, foot_mps, brake.safe_steps(), self.gradients, fastest_mps, slowest_mps)
        times = LimitTimes.of(brake, brake.t_bs2_s)
        return LimitCurve(curve, target_mps, times, self.allowance, brake.t_traction_s, brake.t_berem_s)

    def service_limits(self, end_m: float) -> LimitCurve:
        """Limits before the SBD that ends at an end of authority.

        :raises GradeNotHeldError: the service brake does not hold a grade on the way.
        """
        brake = self.brake
        try:
            curve = braking_curve(end_m, 0.0, brake.expected_steps(), self.gradients, self.fastest_mps)
        except GradeNotHeldError as error:
            raise GradeNotHeldError(error.found_mps2, error.position_m, error.speed_mps, "service") from None
        return LimitCurve(curve, 0.0, LimitTimes.of(brake, brake.t_bs1_s))


def release_mps(emergency: LimitCurve, end_m: float, trip_m: float, most_mps: float) -> float:
    """Release speed: at most ``most_mps``, and so small that the EBI lies ``trip_m`` or more behind the end of
    authority; 0 if there is none."""
    return emergency.speed_mps(end_m + trip_m, 0.0, most_mps)
