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

from railhil.scenarios.profiles import Profile
from railhil.systems.line.braking.brake import BrakeModel
from railhil.systems.line.braking.curve import BrakingCurve, braking_curve

#: Largest acceleration that is assumed to go on while the emergency brake builds up.
GROWTH_MAX_MPS2 = 0.4
#: Accuracy of a speed found by bisection.
_SPEED_TOLERANCE_MPS = 1e-9
#: Or its limit lies so near to the position: less than 1e-8 m/s at any speed above 0.02 m/s.
_PLACE_TOLERANCE_M = 1e-10

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


@dataclass(frozen=True, slots=True)
class LimitTimes:
    """Times between the limits of one curve in s, each before the next: SBI before EBI, warning, permitted speed,
    indication."""

    service_s: float
    warning_s: float
    permitted_s: float
    indication_s: float

    @classmethod
    def of(cls, brake: BrakeModel, t_bs_s: float) -> LimitTimes:
        """Those of a brake, counted from the EBI or the SBD."""
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

    def speed_mps(self, position_m: float, lead_s: float, fastest_mps: float, accel_mps2: float = 0.0) -> float:
        """Speed of a limit at a position: between the target's and ``fastest_mps``.

        Bisection with steps of the secant where they stay inside (Illinois), to 1e-9 m/s.
        """
        low_mps, high_mps = self.target_mps, fastest_mps
        low_gap_m = self.place_m(low_mps, lead_s, accel_mps2) - position_m
        if low_gap_m <= 0.0 or high_mps <= low_mps:
            return low_mps
        high_gap_m = self.place_m(high_mps, lead_s, accel_mps2) - position_m
        if high_gap_m >= 0.0:
            return high_mps
        side = 0
        while high_mps - low_mps > _SPEED_TOLERANCE_MPS:
            middle_mps = low_mps + (high_mps - low_mps) * low_gap_m / (low_gap_m - high_gap_m)
            gap_m = self.place_m(middle_mps, lead_s, accel_mps2) - position_m
            if abs(gap_m) < _PLACE_TOLERANCE_M:
                return middle_mps
            if gap_m > 0.0:
                low_mps, low_gap_m = middle_mps, gap_m
                high_gap_m *= 0.5 if side > 0 else 1.0
                side = 1
            else:
                high_mps, high_gap_m = middle_mps, gap_m
                low_gap_m *= 0.5 if side < 0 else 1.0
                side = -1
        return low_mps

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
        curve = braking_curve(end_m, 0.0, brake.expected_steps(), self.gradients, self.fastest_mps)
        return LimitCurve(curve, 0.0, LimitTimes.of(brake, brake.t_bs1_s))


def release_mps(emergency: LimitCurve, end_m: float, trip_m: float, most_mps: float) -> float:
    """Release speed: at most ``most_mps``, and so small that the EBI lies ``trip_m`` or more behind the end of
    authority; 0 if there is none."""
    return emergency.speed_mps(end_m + trip_m, 0.0, most_mps)
