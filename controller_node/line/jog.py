"""Creeping to a stopping point that the train has stopped short of: a speed loop around a model of the actuator.

::

    v* = min(creep speed, sqrt(2 b d))        a* = [-b while v* falls] + (v* - v) / T_v
    F* = a* + resistance + grade + trim       u  = F + (F* - F) T_a p'      F' = p (u - F)

``d`` is the distance left, ``F`` the model's force of the actuator, ``p`` its pole. The loop runs every
:data:`STEP_MS` on whole numbers: speeds in 0.1 mm/s, lengths in 0.1 mm, forces in 0.1 mm/s2 of the nominal train. The
creep is forward only: behind the stopping point the train brakes. The figures are chosen by simulation.
"""

from __future__ import annotations

from math import exp, isqrt
from typing import Final, NamedTuple

from railhil.systems.ato.scenario.effort import resistance_n
from railhil.systems.ato.scenario.model import Scenario

#: Time between two steps of the loop.
STEP_MS: Final = 100
#: Deceleration towards the stopping point, and the limits of the demand, 0.1 mm/s2.
BRAKING_01MMPS2, DEMAND_MAX_01MMPS2, DEMAND_MIN_01MMPS2 = 1000, 1500, -4000
#: Share of the permitted creep speed that is used, percent.
SPEED_PERCENT: Final = 85
#: Time constant of the speed loop, and of the trim for a grade or mass that the model does not know.
SPEED_MS, TRIM_MS = 1200, 60000
#: The actuator is driven to the wanted force faster than by itself, by this factor.
LEAD: Final = 3
#: Trim up to this force, 0.1 mm/s2.
TRIM_MAX_01MMPS2: Final = 1500
#: Aim this far before the stopping point, 0.1 mm: the last part of the brake comes late.
AIM_SHORT_01MM: Final = 1200
#: Below this distance and speed the train is braked to its stop.
LAST_01MM, LAST_01MMPS, LAST_NOTCHES = 1500, 700, 1
_CODES_PER_NOTCH: Final = 256
_Q: Final = 8


class CreepLimits(NamedTuple):
    """Constants of one scenario: 0.1 mm/s, 0.1 mm/s2, notch codes (1/256 notch).

    ``decay_q16``: share of the way to the notch's force that the actuator goes in :data:`STEP_MS`. ``notch_01mmps2``:
    of one notch. ``grade_q16``: of a grade of 0.01 permil (/ 2^16).
    """

    speed_01mmps: int
    decay_q16: int
    notch_01mmps2: int
    resistance_01mmps2: int
    grade_q16: int
    traction_code: int
    brake_code: int

    @classmethod
    def of(cls, scenario: Scenario, speed_mps: float) -> CreepLimits:
        """Limits of a train that creeps with at most ``speed_mps``."""
        train = scenario.train
        mass_kg = train.inertial_mass_kg
        full_code = round(train.notch_max * _CODES_PER_NOTCH)
        return cls(
            speed_01mmps=round(speed_mps * 1e4) * SPEED_PERCENT // 100,
            decay_q16=round((1 - exp(-train.actuator_pole_per_s * STEP_MS / 1000)) * 65536),
            notch_01mmps2=round(train.force_per_notch_n / mass_kg * 1e4),
            resistance_01mmps2=round(float(resistance_n(train, 0.0, 0.0)) / mass_kg * 1e4),
            grade_q16=round(train.gravity_mps2 * train.mass_kg / mass_kg * 0.1 * 65536),
            traction_code=min(full_code, 2 * _CODES_PER_NOTCH),
            brake_code=-min(full_code, 4 * _CODES_PER_NOTCH),
        )


class Creep:
    """The loop of one train; :meth:`start` begins a creep."""

    def __init__(self, limits: CreepLimits) -> None:
        self._limits = limits
        self._force_q8 = 0
        self._trim_q8 = 0
        self._code = 0

    def start(self) -> None:
        """Begin from standstill, with no force in the actuator."""
        self._force_q8 = self._trim_q8 = self._code = 0

    def step(self, left_01mm: int, speed_01mmps: int, grade_001permil: int) -> int:
        """Notch code for the next :data:`STEP_MS`.

        :param left_01mm: distance to the stopping point, negative behind it.
        :param grade_001permil: under the train; 0 if it is not known.
        """
        limits = self._limits
        self._force_q8 += (self._force_of(self._code) - self._force_q8) * limits.decay_q16 >> 16
        left_01mm -= AIM_SHORT_01MM
        if left_01mm <= LAST_01MM and speed_01mmps <= LAST_01MMPS and (speed_01mmps or left_01mm <= 0):
            self._code = -LAST_NOTCHES * _CODES_PER_NOTCH
            return self._code
        falling_01mmps = isqrt(2 * BRAKING_01MMPS2 * left_01mm) if left_01mm > 0 else 0
        wanted_01mmps = min(falling_01mmps, limits.speed_01mmps)
        error_01mmps = wanted_01mmps - speed_01mmps
        demand = error_01mmps * 1000 // SPEED_MS
        if falling_01mmps <= limits.speed_01mmps and speed_01mmps:
            demand -= BRAKING_01MMPS2
        demand = min(max(demand, DEMAND_MIN_01MMPS2), DEMAND_MAX_01MMPS2)
        against = limits.resistance_01mmps2 + (grade_001permil * limits.grade_q16 >> 16)
        # A train that stands because its force is still small needs no trim.
        if speed_01mmps or self._force_q8 > against << _Q:
            self._trim(error_01mmps)
        force_q8 = (demand + against << _Q) + self._trim_q8
        driven_q8 = self._force_q8 + (force_q8 - self._force_q8) * LEAD
        code = driven_q8 // max(limits.notch_01mmps2, 1)
        self._code = min(max(code, limits.brake_code), limits.traction_code)
        return self._code

    def _force_of(self, code: int) -> int:
        """Steady force of a notch code, Q8."""
        return code * self._limits.notch_01mmps2

    def _trim(self, error_01mmps: int) -> None:
        limit_q8 = TRIM_MAX_01MMPS2 << _Q
        gained_q8 = (error_01mmps << _Q) * 1000 * STEP_MS // (SPEED_MS * TRIM_MS)
        self._trim_q8 = min(max(self._trim_q8 + gained_q8, -limit_q8), limit_q8)
