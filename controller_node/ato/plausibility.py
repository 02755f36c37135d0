"""Plausibility of the measured speed, in integers: against what a train can do, the odometer, and the notch sent.

==================== ================================================== ================================================
check                found when                                         limit of detection
==================== ================================================== ================================================
jump                 a speed differs from that of the last sample by    accelerations below that plus the noise in
                     more than noise and ``speed_change_max``: slip,    100 ms: 2.9 m/s2 with the shipped scenarios
                     slide, garbage
stuck                the reading has not changed at all while the train readings above 0, and an acceleration due
                     should have changed its speed by                   of at least 0.1 m/s2
                     ``stuck_change``
scale                speed and odometer disagree by more than           both wrong by the same; a larger disagreement is
                     ``scale_error_max`` over 5 s                       found as a position that jumps
brake not answering  the train is braked by less than                   brakes above that share, demands below 0.3 m/s2
                     ``brake_share_min`` of the demand for about 1 s
runaway              at a notch of at most 0 the train accelerates and  a traction that was there before and decays as
                     has become faster than the model by ``runaway``    the actuator does
==================== ================================================== ================================================

A speed that jumps is refused, and never reaches the law; the band around the last sample opens with time.

The model: the notch sent passes the actuator's lag, its force is limited, nominal resistance and the grade of TRK_INFO
are subtracted. Inexactly known quantities count as less brake. All but the first check are made ten times a second.

Units: speeds 0.1 mm/s, accelerations 0.1 mm/s2, positions 0.1 mm, times ms.
"""

from __future__ import annotations

from math import exp
from typing import Final, NamedTuple

import numpy as np

from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlCause

#: Time between two checks of the motion; the speeds in between are only checked for jumps.
SAMPLE_MS: Final = 100
#: After a longer pause the checks begin again.
PAUSE_MAX_MS: Final = 1000
#: Samples between two entries of the ring compared with the odometer, and its entries: 5 s.
RING_EVERY, RING = 5, 10
#: Age of a position up to which it is carried forward with the speed.
POSITION_AGE_MAX_MS = 100
#: Time of additional braking after which a brake that does not answer is an emergency.
MORE_BRAKE_MS: Final = 1000
#: Smallest demand (0.1 mm/s2) for which the brake is judged, and the shortfall allowed with any demand.
DEMAND_MIN, SHORTFALL = 3000, 1500
#: Smallest acceleration (0.1 mm/s2) that makes a change of the reading due: below it the model may be wrong.
DUE_MIN: Final = 1000
#: Speed (0.1 mm/s) below which brake and runaway are not judged: the train is about to stand.
SLOW: Final = 5000
#: Part of the tolerance of a jump, and of the disagreement over 5 s, for sensors without resolution and noise.
JUMP_01MMPS, DISAGREEMENT_01MM = 500, 1000
_NOISE_SIGMAS: Final = 12
#: Longer times count as this one.
_LONG_NS: Final = 100_000_000_000
_NS_PER_S: Final = 1_000_000_000
_NS_PER_MS: Final = 1_000_000


class MotionLimits(NamedTuple):
    """Thresholds and model of one scenario, whole numbers. Forces are accelerations of the nominal train.

    ``decay_q16``: share of the way to the notch's force that the actuator goes in :data:`SAMPLE_MS`; ``notch_01mmps2``:
    of one notch; ``davis_*``: resistance at 0, per speed (/ 2^20) and per its square (/ 2^40); ``grade_q16``: of a
    grade of 0.01 permil (/ 2^16).
    """

    jump_01mmps: int
    accel_01mmps2: int
    tick_ns: int
    stuck_01mmps: int
    scale_permil: int
    disagreement_01mm: int
    brake_share_permil: int
    runaway_01mmps: int
    decay_q16: int
    notch_01mmps2: int
    brake_01mmps2: int
    traction_01mmps2: int
    weak_traction_01mmps2: int
    davis_a: int
    davis_b_q20: int
    davis_c_q40: int
    grade_q16: int

    @classmethod
    def of(cls, scenario: Scenario) -> MotionLimits:
        """Limits of a scenario; a train stronger than ``speed_change_max`` gets the limit from its own forces."""
        watch, train, sensors = scenario.watch, scenario.train, scenario.sensors
        mass_kg = train.inertial_mass_kg
        speeds = np.arange(0.0, min(train.speed_limit_mps, 150.0) + 1.0)
        brake_n, traction_n = (force_limit_n(effort, speeds) for effort in (train.brake, train.traction))
        strongest_mps2 = float(max(brake_n.max(), traction_n.max())) / mass_kg
        standing_n, slow_n, fast_n = (float(resistance_n(train, kmh / 3.6, 0.0)) for kmh in (0, 100, 200))
        # Through three points: a + b V + c V2 with V in units of 100 km/h.
        c_n = (fast_n - 2 * slow_n + standing_n) / 2
        b_n = slow_n - standing_n - c_n
        unit_01mmps = 100 / 3.6 * 1e4
        noise_mps = sensors.speed_lsb_mps + _NOISE_SIGMAS * sensors.speed_noise_sigma_mps
        return cls(
            jump_01mmps=JUMP_01MMPS + round(noise_mps * 1e4),
            accel_01mmps2=round(max(watch.speed_change_max_mps2, 1.5 * strongest_mps2) * 1e4),
            tick_ns=scenario.timing.base_tick_ns,
            stuck_01mmps=round((watch.stuck_change_mps + 2 * sensors.speed_lsb_mps) * 1e4),
            scale_permil=round(watch.scale_error_max_percent * 10),
            disagreement_01mm=DISAGREEMENT_01MM + round(2e4 * sensors.odometer_lsb_m),
            brake_share_permil=round(watch.brake_share_min_percent * 10),
            runaway_01mmps=round(watch.runaway_mps * 1e4),
            decay_q16=round((1 - exp(-train.actuator_pole_per_s * SAMPLE_MS / 1000)) * 65536),
            notch_01mmps2=round(train.force_per_notch_n / mass_kg * 1e4),
            brake_01mmps2=round(float(brake_n.min()) / mass_kg * 1e4),
            traction_01mmps2=round(float(traction_n.max()) / mass_kg * 1e4),
            weak_traction_01mmps2=round(float(traction_n.min()) / mass_kg * 1e4),
            davis_a=round(standing_n / mass_kg * 1e4),
            davis_b_q20=round(b_n / mass_kg * 1e4 / unit_01mmps * 2**20),
            davis_c_q40=round(c_n / mass_kg * 1e4 / unit_01mmps**2 * 2**40),
            grade_q16=round(train.gravity_mps2 * train.mass_kg / mass_kg * 0.1 * 65536),
        )

    @property
    def step_01mmps(self) -> int:
        """Largest change within one tick."""
        return self.jump_01mmps + self.accel_01mmps2 * self.tick_ns // _NS_PER_S

    def fits(self, change_01mmps: int, elapsed_ns: int) -> bool:
        """Whether a train can have changed its speed by this amount in this time, at least one tick."""
        elapsed_ns = min(max(elapsed_ns, self.tick_ns), _LONG_NS)
        return abs(change_01mmps) <= self.jump_01mmps + self.accel_01mmps2 * elapsed_ns // _NS_PER_S


class Motion:
    """The checks that need more than two speeds.

    After each :meth:`sample`, ``is_stuck``, ``is_off_scale``, ``is_runaway`` and ``weak_ms`` (time without an answer of
    the brake, 0: it answers) hold the findings.
    """

    def __init__(self, limits: MotionLimits) -> None:
        self.is_stuck = self.is_off_scale = self.is_runaway = False
        self.weak_ms = 0
        self._limits = limits
        self._begun = False
        self._at_ns = 0
        self._speed = 0
        # Force of the actuator in the model, notch codes (1/256 notch) times 256.
        self._force = 0
        # Sums over the samples, in units in which no product is rounded. Excess of the train's speed over the model's
        # since the notch is at most 0, with a time constant of 1 s; 1e-7 m/s.
        self._off = 0
        # Change of speed that is due since the reading has changed, 1e-7 m/s.
        self._due = 0
        # Way by the speeds, 0.5e-7 m; entries (way, position) of the last 5 s.
        self._way = 0
        self._count = 0
        self._ring = [(0, 0)] * RING

    @property
    def is_suspicious(self) -> bool:
        """Whether anything was found."""
        return self.is_stuck or self.is_off_scale or self.is_runaway or self.weak_ms > 0

    def sample(
        self, now_ns: int, speed: int, code: int, grade_001permil: int | None, changed_ns: int, position: int | None
    ) -> None:
        """Take the speed of now, at least :data:`SAMPLE_MS` after the last one.

        :param code: notch sent, 1/256.
        :param changed_ns: when the reading has last changed.
        :param position: of now by the odometer, None if there is none.
        """
        limits = self._limits
        before_ns, before = self._at_ns, self._speed
        # Both ends are rounded, so that over many samples no time is lost.
        step_ms = now_ns // _NS_PER_MS - before_ns // _NS_PER_MS
        self._at_ns, self._speed = now_ns, speed
        if not self._begun or not 0 < step_ms <= PAUSE_MAX_MS:
            self._begun = True
            self._off = self._due = self._count = 0
            self.is_stuck = self.is_off_scale = self.is_runaway = False
            self.weak_ms = 0
            return
        # The normal case takes as few operations as possible from here on: this runs ten times a second.
        force = self._force
        self._force = force = force + (
            ((code << 8) - force) * min(limits.decay_q16 * step_ms // SAMPLE_MS, 65536) >> 16
        )
        unchanged, forceless = changed_ns <= before_ns, code <= 0 and speed >= SLOW and grade_001permil is not None
        if unchanged or forceless:
            wanted = force * limits.notch_01mmps2 >> 16
            against = limits.davis_a + (limits.davis_b_q20 * speed >> 20) + (limits.davis_c_q40 * speed * speed >> 40)
            if grade_001permil is not None:
                against += grade_001permil * limits.grade_q16 >> 16
        if unchanged:
            self._judge_stuck(min(wanted, limits.weak_traction_01mmps2), against, step_ms)
        else:
            self._due = 0
            self.is_stuck = False
        if forceless:
            self._judge_force(min(wanted, limits.traction_01mmps2), against, step_ms, speed - before)
        else:
            self._off = self.weak_ms = 0
            self.is_runaway = False
        self._way += (speed + before) * step_ms
        if position is None:
            self._count = 0
            self.is_off_scale = False
            return
        self._count += 1
        if not self._count % RING_EVERY:
            self._judge_scale(position)

    def _judge_stuck(self, force: int, against: int, step_ms: int) -> None:
        accel = max(force, -self._limits.brake_01mmps2) - against
        if self._speed == 0:
            self._due = 0
        elif abs(accel) >= DUE_MIN:
            self._due += accel * step_ms
        self.is_stuck = abs(self._due) > self._limits.stuck_01mmps * 1000

    def _judge_force(self, force: int, against: int, step_ms: int, change: int) -> None:
        limits = self._limits
        force = max(force, -limits.brake_01mmps2)
        accel = force - against
        self._off = off = self._off - self._off * step_ms // 1000 + change * 1000 - accel * step_ms
        # The excess over 1 s is the unexplained acceleration.
        self.is_runaway = off > limits.runaway_01mmps * 1000 and accel * 1000 + off > 0
        missing = -force * (1000 - limits.brake_share_permil) // 1000 + SHORTFALL
        self.weak_ms = self.weak_ms + step_ms if force < -DEMAND_MIN and off > missing * 1000 else 0

    def _judge_scale(self, position: int) -> None:
        entry = self._count // RING_EVERY
        way, place = self._ring[entry % RING]
        self._ring[entry % RING] = self._way, position
        if entry <= RING:
            return
        by_speed, by_odometer = (self._way - way) // 2000, position - place
        allowed = max(by_speed, by_odometer) * self._limits.scale_permil // 1000 + self._limits.disagreement_01mm
        self.is_off_scale = abs(by_speed - by_odometer) > allowed


def found(motion: Motion) -> tuple[CtlCause, bool]:
    """The strongest finding, and whether it is an emergency; ``CtlCause.NONE`` for none."""
    if motion.is_runaway:
        return CtlCause.RUNAWAY, True
    if motion.weak_ms:
        return CtlCause.BRAKE_NOT_ANSWERING, motion.weak_ms > MORE_BRAKE_MS
    if motion.is_stuck or motion.is_off_scale:
        return CtlCause.SPEED_IMPLAUSIBLE, False
    return CtlCause.NONE, False
