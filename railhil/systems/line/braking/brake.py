"""Brake model of the train protection: guaranteed and expected deceleration over speed and position.

::

    A_safe(V, d)     = min(k_dry (k_wet + m_avadh (1 - k_wet)) A_emergency, a_max_reduced) + A_g(d)
    A_expected(V, d) = A_service + A_g(d)              A_g = g G / 1000 / (1 + M / 100)

All are step functions; each value is valid from its speed or position on. ``G`` is the **lowest** grade under the
train. Structure as published for SUBSET-026-3, 3.13 (see the package); ATP values of a metro are chosen.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from railhil.scenarios.profiles import Profile, find_lowest, profile_value

#: Rotating masses in percent when they are not known: the most uphill, the least downhill.
ROTATING_UPHILL_PERCENT = 15.0
ROTATING_DOWNHILL_PERCENT = 2.0
#: Share of a time T_bs in the time between indication and permitted speed.
_INDICATION_SHARE = 0.8


@dataclass(frozen=True, slots=True)
class BrakeModel:
    """Brakes and times of one train, as the protection counts on them.

    Step functions over speed are rows ``(from_mps, value)``, the first from 0. Times are s: ``t_be_s`` is the
    equivalent dead time of the emergency brake, ``t_bs1_s`` and ``t_bs2_s`` those of the service brake.

    :ivar cut_at_warning: the traction is cut off already at the warning, so most of ``t_cut_s`` has passed.
    :ivar rotating_percent: rotating masses; None: not known.
    """

    emergency_mps2: Profile
    service_mps2: Profile
    k_dry: Profile
    k_wet: Profile
    m_avadh: float
    a_max_reduced_mps2: float
    t_be_s: float
    t_bs1_s: float
    t_bs2_s: float
    t_cut_s: float
    t_warning_s: float
    t_driver_s: float
    t_ind_min_s: float
    rotating_percent: float | None
    gravity_mps2: float = 9.81
    cut_at_warning: bool = True

    @property
    def t_traction_s(self) -> float:
        """Time for which traction may still act after the emergency brake is ordered."""
        if not self.cut_at_warning:
            return self.t_cut_s
        return max(self.t_cut_s - (self.t_warning_s + self.t_bs2_s), 0.0)

    @property
    def t_berem_s(self) -> float:
        """Rest of the emergency brake's dead time behind the traction's."""
        return max(self.t_be_s - self.t_traction_s, 0.0)

    def t_indication_s(self, t_bs_s: float) -> float:
        """Time between indication and permitted speed, for one of the times of the service brake."""
        return max(_INDICATION_SHARE * t_bs_s, self.t_ind_min_s) + self.t_driver_s

    def safe_steps(self) -> Profile:
        """``A_safe`` on the level: guaranteed deceleration over speed."""
        rows = []
        for speed_mps in _edges(self.emergency_mps2, self.k_dry, self.k_wet):
            wet = profile_value(self.k_wet, speed_mps)
            share = profile_value(self.k_dry, speed_mps) * (wet + self.m_avadh * (1.0 - wet))
            rows.append(
                (speed_mps, min(share * profile_value(self.emergency_mps2, speed_mps), self.a_max_reduced_mps2))
            )
        return tuple(rows)

    def expected_steps(self) -> Profile:
        """``A_expected`` on the level: deceleration of the service brake over speed."""
        return self.service_mps2

    def gradient_steps(self, grade_permil: Profile, length_m: float) -> Profile:
        """``A_g`` over the position of the front: rows ``(from_m, m/s2)``, the first also before its position."""
        lowest = find_lowest(grade_permil, length_m, inf)
        return tuple((from_m, self._gradient_mps2(permil)) for from_m, permil in lowest)

    def _gradient_mps2(self, permil: float) -> float:
        rotating = self.rotating_percent
        if rotating is None:
            rotating = ROTATING_UPHILL_PERCENT if permil > 0.0 else ROTATING_DOWNHILL_PERCENT
        return self.gravity_mps2 * permil / 1000.0 / (1.0 + rotating / 100.0)


def _edges(*profiles: Profile) -> list[float]:
    return sorted({row[0] for profile in profiles for row in profile})


def constant(value: float) -> Profile:
    """A step function with one value."""
    return ((0.0, value),)
