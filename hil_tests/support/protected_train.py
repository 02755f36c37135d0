"""A train under its protection alone: dynamics of the plant, emergency brake with dead time and lag, faults by numbers.

It is lighter than the plant on the bus: 100 ms steps, no telegrams. Whatever drives it may be as wrong as a fault asks.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from math import exp, inf

from railhil.plant_sim.ato import dynamics
from railhil.plant_sim.ato.dynamics import Motion, Window
from railhil.plant_sim.ato.force_tables import grade_table, train_constants
from railhil.plant_sim.ato.forces import EffortLimit, GradeTable, TrainConstants
from railhil.plant_sim.atp.protection import TrainProtection
from railhil.plant_sim.atp.readings import Authority, Demands, Readings, Track, TrainData
from railhil.scenarios.load import load
from railhil.scenarios.profiles import Profile
from railhil.systems.ato.scenario.model import Train
from railhil.systems.line.scenario.model import EmergencyBrake
from railhil.systems.line.scenario.protection import Protection

STEP_S = 0.1
#: Where the trains start, and where their next stop is: what a real line has, shifted.
STOP_M = 1500.0
#: A driver that starts again after the service brake of the protection may do it so often.
_STANDS_MAX = 4
#: The interval of the position counts this near to the end of authority.
_NEAR_M = 30.0
_TRAIN = "yizhuang_01_songjiazhuang_xiaocun"


def shipped_train() -> Train:
    """The train of the Yizhuang line."""
    return load(_TRAIN).train


TRAIN = shipped_train()


@dataclass(frozen=True, slots=True)
class Worst:
    """One combination of faults; the defaults are none.

    :ivar start_m: where the train is when the driver takes over, and the protection's position there.
    :ivar driver: ``ato`` brakes to its aim, ``frozen`` keeps full traction.
    :ivar aim_m: where the driver means to stop.
    :ivar driver_speed_factor: what it reads of its speed.
    :ivar is_service_dead: the protection's service brake does not act.
    :ivar traction_delay_s: from the cut to no traction.
    :ivar signal: EoA of a red signal, and when it is put to red.
    """

    start_m: float = 0.0
    start_mps: float = 0.0
    driver: str = "ato"
    aim_m: float = STOP_M
    driver_speed_factor: float = 1.0
    is_service_dead: bool = False
    traction_mps2: float = 0.7
    traction_delay_s: float = 0.7
    mass_factor: float = 1.0
    grade_factor: float = 1.0
    grade_offset_permil: float = 0.0
    wheel_factor: float = 1.0
    grade_permil: Profile = ((0.0, 0.0),)
    limits_mps: Profile = ((0.0, 80 / 3.6),)
    balises: tuple[tuple[int, float, float], ...] = ()
    signal: tuple[float, float] | None = None
    emergency: EmergencyBrake = field(default_factory=EmergencyBrake)
    settings: Protection = field(default_factory=Protection)


@dataclass(slots=True)
class Outcome:
    """Where the front has come to stand, and the widest interval of its position near the end of authority."""

    front_m: float
    eoa_m: float
    svl_m: float
    widest_m: float
    demands: Demands
    events: list[tuple[float, int, int]]


def draw(rng: random.Random) -> Worst:
    """One of the combinations of the acceptance bar."""
    edges = sorted(rng.uniform(100.0, STOP_M) for _ in range(rng.randrange(5)))
    grade = ((0.0, rng.uniform(-24.0, 24.0)), *((edge, rng.uniform(-24.0, 24.0)) for edge in edges))
    limits = [(0.0, 80 / 3.6)]
    if rng.random() < 0.4:
        limits.append((rng.uniform(400.0, 1300.0), rng.choice([50, 60, 70]) / 3.6))
    balises = []
    for number, before_m in enumerate((1400.0, 1100.0, 800.0, 500.0, 180.0, 90.0, 40.0, 10.0, 0.0), start=1):
        if rng.random() > 0.2:
            shift_m = rng.uniform(-2.0, 2.0) if rng.random() < 0.2 else rng.uniform(-0.05, 0.05)
            balises.append((number, STOP_M - before_m, STOP_M - before_m + shift_m))
    start_m = rng.uniform(300.0, 700.0)
    signal = None
    if rng.random() < 0.25:
        # Red before the train comes so near that it could not stop.
        signal = (rng.uniform(start_m + 600.0, STOP_M), 0.0)
    return Worst(
        start_m=start_m,
        start_mps=min(limit for _, limit in limits) * rng.random(),
        driver=rng.choice(["ato", "frozen", "frozen"]),
        aim_m=STOP_M + rng.choice([0.0, rng.uniform(20.0, 400.0)]),
        driver_speed_factor=rng.choice([1.0, rng.uniform(0.5, 1.5)]),
        is_service_dead=rng.random() < 0.6,
        traction_mps2=rng.uniform(0.3, 0.9),
        traction_delay_s=rng.uniform(0.1, 0.7),
        mass_factor=rng.uniform(0.9, 1.1),
        grade_factor=rng.uniform(0.9, 1.1),
        grade_offset_permil=rng.uniform(-1.0, 1.0),
        wheel_factor=rng.uniform(0.98, 1.02),
        grade_permil=grade,
        limits_mps=tuple(limits),
        balises=tuple(balises),
        signal=signal,
    )


def run(worst: Worst, is_protected: bool = True, longest_s: float = 120.0) -> Outcome:
    """Drive from standstill at 0 until the emergency brake has stopped the train, the train has stopped often or passed
    SvL by 200 m."""
    settings = worst.settings
    protection = TrainProtection(
        settings,
        TrainData(TRAIN.length_m, TRAIN.speed_limit_mps),
        Track(worst.grade_permil, worst.limits_mps, tuple((number, at_m) for number, at_m, _ in worst.balises)),
        worst.start_m,
    )
    authority = Authority(STOP_M + settings.eoa_overlap_m, STOP_M + settings.svl_overlap_m)
    constants, grades, full_n = _true_train(worst)
    lag = dynamics.lag(constants.pole_per_s, STEP_S)
    motion, demands = Motion(worst.start_m, worst.start_mps, 0.0, 0.0), Demands()
    emergency = _Emergency(worst.emergency)
    ahead = sorted((one for one in worst.balises if one[2] > worst.start_m), key=lambda balise: balise[2])
    widest_m = 0.0
    since_cut_s, tick, stands = 0.0, 0, 0
    events: list[tuple[float, int, int]] = []
    while tick * STEP_S < longest_s:
        time_s = tick * STEP_S
        if worst.signal is not None and time_s >= worst.signal[1] and not authority.red_signal:
            authority = Authority(worst.signal[0], worst.signal[0] + 20.0, red_signal=True)
        passed = []
        while ahead and ahead[0][2] <= motion.position_m:
            number, _, at_m = ahead.pop(0)
            passed.append((number, (at_m - worst.start_m) * worst.wheel_factor))
        if is_protected:
            readings = Readings(
                time_s,
                motion.speed_mps * worst.wheel_factor,
                (motion.position_m - worst.start_m) * worst.wheel_factor,
                tuple(passed),
                authority,
                True,
                False,
            )
            demands = protection.step(readings)
            if motion.position_m > authority.eoa_m - _NEAR_M:
                widest_m = max(widest_m, protection.place.most_m - protection.place.least_m)
            if not events or events[-1][1:] != (demands.status, demands.cause):
                events.append((time_s, demands.status, demands.cause))
        since_cut_s = since_cut_s + STEP_S if demands.traction_cut else 0.0
        is_cut = since_cut_s > worst.traction_delay_s
        wanted_mps2 = _drive(worst, motion)
        brake_n = emergency.step(demands.emergency_brake)
        if demands.service_brake and not worst.is_service_dead:
            brake_n = max(brake_n, TRAIN.service_braking_mps2)
        window = Window(not is_cut, brake_n * TRAIN.inertial_mass_kg)
        before_mps = motion.speed_mps
        motion = dynamics.step(constants, grades, window, motion, wanted_mps2 * full_n, lag).motion
        tick += 1
        if motion.speed_mps <= 0.0 < before_mps:
            stands += 1
        is_at_end = demands.emergency_brake or not is_protected or stands >= _STANDS_MAX
        if motion.position_m > authority.svl_m + 200.0 or (stands and motion.speed_mps <= 0.0 and is_at_end):
            break
    return Outcome(
        motion.position_m,
        authority.eoa_m,
        authority.svl_m,
        widest_m,
        demands,
        events,
    )


def _true_train(worst: Worst) -> tuple[TrainConstants, GradeTable, float]:
    """The train as it is, its grades, and the force of 1 m/s2 on the nominal mass."""
    nominal = train_constants(TRAIN)
    constants = nominal._replace(
        mass_kg=nominal.mass_kg * worst.mass_factor,
        grade_n_per_permil=nominal.grade_n_per_permil * worst.mass_factor,
        traction=EffortLimit(1e7, inf, (), ()),
        brake=EffortLimit(1e7, inf, (), ()),
    )
    true = tuple((at_m, permil * worst.grade_factor + worst.grade_offset_permil) for at_m, permil in worst.grade_permil)
    return constants, grade_table(true, TRAIN.length_m), TRAIN.inertial_mass_kg


def _drive(worst: Worst, motion: Motion) -> float:
    """Acceleration that the driver orders, on the nominal mass."""
    if worst.driver == "frozen":
        return worst.traction_mps2
    speed_mps = motion.speed_mps * worst.driver_speed_factor
    left_m = worst.aim_m - motion.position_m
    allowed_mps = (2 * 0.6 * max(left_m, 0.0)) ** 0.5
    wanted_mps = min(75 / 3.6, allowed_mps)
    return max(-1.0, min(worst.traction_mps2, wanted_mps - speed_mps))


class _Emergency:
    """Emergency brake with dead time and lag; its demand in m/s2 on the nominal mass."""

    def __init__(self, brake: EmergencyBrake) -> None:
        self._brake = brake
        self._since_s = -1.0

    def step(self, is_ordered: bool) -> float:
        if not is_ordered:
            return 0.0
        self._since_s = 0.0 if self._since_s < 0.0 else self._since_s + STEP_S
        acting_s = self._since_s - self._brake.dead_s
        if acting_s < 0.0:
            return 0.0
        return self._brake.braking_mps2 * (1.0 - exp(-acting_s / self._brake.lag_s))
