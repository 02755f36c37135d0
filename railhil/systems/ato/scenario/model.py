"""The data of a run of ``ato``, as frozen dataclasses in SI units.

Plant, laws and judging read these classes; files and their validation stay in :mod:`.schema`.
Positions are metres from the stopping point at which the run starts (increasing along the run), grades are
permil (up positive), speeds are m/s unless the name says otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

from railhil.scenarios.model import PublishedScore, Timing
from railhil.scenarios.profiles import Profile
from railhil.scenarios.streams import Chain
from railhil.scenarios.system import OfSystem

#: Longest run, by the train's own odometer.
DISTANCE_MAX_M = 400_000.0
#: The event STOPPED is a standstill after at least this distance.
STOP_LEG_MIN_M = 1.0
#: Longest time without a position.
POSITION_AGE_MAX_MS = 1000


@dataclass(frozen=True, slots=True)
class Effort:
    """Limit of a force over speed: ``min(force_max_n, power_max_w / v, curve(v))``.

    ``curve`` is a table ``(speed_mps, force_n)`` with linear interpolation, held at both ends; empty means
    none.
    """

    force_max_n: float
    power_max_w: float | None = None
    curve: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Train:
    """One train as a rigid mass with length.

    Resistance in N is ``weight_kn * (a + b V + c V^2 + grade)``, coefficients in N/kN (Davis), ``V`` in km/h,
    ``weight_kn = mass_kg * gravity / 1000``. ``inertial_mass_kg`` already includes the rotating masses.
    """

    name: str
    mass_kg: float
    inertial_mass_kg: float
    length_m: float
    davis_a_n_per_kn: float
    davis_b_n_per_kn_kmh: float
    davis_c_n_per_kn_kmh2: float
    traction: Effort
    brake: Effort
    actuator_pole_per_s: float
    force_per_notch_n: float
    notch_max: float = 7.0
    speed_limit_mps: float = 1000.0
    service_braking_mps2: float = 1.0
    gravity_mps2: float = 9.81
    #: The part of the brake that is electric and can feed back; None: not known. It moves no train.
    electric_brake: Effort | None = None


@dataclass(frozen=True, slots=True)
class Balise:
    """A balise: its number, the surveyed position that its telegram carries, and its true position."""

    number: int
    surveyed_m: float
    true_m: float


@dataclass(frozen=True, slots=True)
class Line:
    """The section of line that the run uses; profiles may start below 0 (under the standing train)."""

    name: str
    grade_permil: Profile
    speed_limit_mps: Profile
    balises: tuple[Balise, ...] = ()


@dataclass(frozen=True, slots=True)
class TargetCurve:
    """Target speed curve as piecewise-linear acceleration, nodes ``(time_s, accel_mps2)`` from time 0.

    After the last node the last acceleration continues, so the speed becomes virtually negative after the
    planned stop (design decision: clamping at zero costs seconds of punctuality). Values are exact
    polynomials per piece: see :mod:`railhil.systems.ato.scenario.target`.
    """

    nodes: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class RunPlan:
    """The requirements on the run: place and time of the stop, and the tolerances for a PASS."""

    distance_m: float
    running_time_s: float
    stop_error_max_m: float
    time_error_max_s: float
    #: Time after the end of the timetable at which a run that has not stopped has failed.
    overtime_max_s: float = 10.0


@dataclass(frozen=True, slots=True)
class Sensors:
    """Speed sensor and odometer of the train.

    The axle sensor reads ``true * wheel_factor`` (a worn wheel reads too fast: factor above 1), adds
    Gaussian noise and rounds to the resolution; the odometer integrates the same factor.
    """

    speed_lsb_mps: float
    speed_noise_sigma_mps: float
    odometer_lsb_m: float
    wheel_factor: float = 1.0


@dataclass(frozen=True, slots=True)
class Energy:
    """Eq. (5) of the IPFC paper: traction work / xi_m + auxiliary power * time + xi_b * brake work.

    Eq. (5) does not use ``regenerative_efficiency``, the share of the electric brake's work that is fed back.
    """

    xi_m: float
    xi_b: float
    auxiliary_power_w: float
    regenerative_efficiency: float = 0.7


@dataclass(frozen=True, slots=True)
class WatchLimits:
    """Limits of both watches: age of the last accepted telegram at which each level is entered, and the other checks.

    The defaults are those of the shipped scenarios; a watch with a higher limit, or a lower share of the brake, is
    weaker. The documentation of the keys is in :mod:`railhil.systems.ato.scenario.keys`.
    """

    hold_ms: int = 20
    traction_cut_ms: int = 64
    service_brake_ms: int = 256
    emergency_ms: int = 1000
    overspeed_margin_mps: float = 5 / 3.6
    speed_change_max_mps2: float = 2.0
    stuck_change_mps: float = 0.36 / 3.6
    scale_error_max_percent: float = 3.0
    channel_bad_max: int = 30
    brake_share_min_percent: float = 50.0
    runaway_mps: float = 1.08 / 3.6
    overruns_max: int = 3
    notch_step_max: float = 254.0
    two_sources_max: int = 6
    traction_left_max_percent: float = 5.0
    grade_allowance_permil: float = 35.0
    end_of_authority: bool = False
    end_of_authority_margin_m: float = 5.0
    end_of_authority_braking_mps2: float = 0.8

    @property
    def weakened(self) -> str:
        """Limits that are weaker than usual, by their keys in a scenario file; empty if there are none."""
        usual = WatchLimits()
        rows = []
        for item in fields(self):
            if item.name == "end_of_authority":
                # Off is usual.
                continue
            key, factor = (item.name.replace("_mps", "_kmh"), 3.6) if item.name.endswith("_mps") else (item.name, 1)
            value, most = (round(getattr(limits, item.name) * factor, 6) for limits in (self, usual))
            if (value < most) if "_min" in item.name else (value > most):
                rows.append(f"{key} {value:g} (usual {most:g})")
        return ", ".join(rows)


@dataclass(frozen=True, slots=True)
class Safety:
    """Safe data transmission (SDTv2, :mod:`railhil.bus.sdt`).

    ``sdt``: speed and command count only if SPEED_SDT and NOTCH_SDT confirm them. ``n_rxsafe``: cycles without a fresh
    safe telegram that are tolerated. ``cmthr``: telegrams within which a second CRC error fails the channel.
    """

    sdt: bool = False
    n_rxsafe: int = 3
    cmthr: int = 1000


@dataclass(frozen=True, slots=True)
class Uniform:
    """A uniform distribution between two bounds (factor or offset, as the perturbation's name says)."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Perturbations:
    """Distributions from which a perturbed run draws; ``None`` leaves the nominal value."""

    mass_factor: Uniform | None = None
    davis_factor: Uniform | None = None
    grade_offset_permil: Uniform | None = None
    grade_factor: Uniform | None = None
    actuator_pole_factor: Uniform | None = None
    force_gain_factor: Uniform | None = None
    speed_noise_sigma_mps: Uniform | None = None
    loop_delay_s: Uniform | None = None
    wheel_factor: Uniform | None = None
    balise_position_error_m: Uniform | None = None


@dataclass(frozen=True, slots=True)
class Scenario(OfSystem):
    """A complete run: train, line, target speed curve, plan, sensors, timing, limits.

    ``sha256`` is the hash of the canonical form of all data that change the run; the three nodes compare it before they
    start.
    """

    name: str
    title: str
    train: Train
    line: Line
    target: TargetCurve
    plan: RunPlan
    timing: Timing
    sensors: Sensors
    energy: Energy
    watch: WatchLimits
    perturbations: Perturbations
    published: tuple[PublishedScore, ...] = ()
    #: Sentences about values that are chosen rather than published or measured; every report repeats them.
    assumptions: tuple[str, ...] = ()
    sha256: str = ""
    system: str = "ato"
    #: The faults, as canonical texts (:mod:`railhil.faults.language`), in the order of their numbers.
    faults: tuple[str, ...] = ()
    safety: Safety = Safety()
    #: The law of its runs when none is asked for; empty: that of its system.
    law: str = ""
    #: Standard normal numbers that its perturbations and its faults are drawn with, in the order of
    #: :func:`railhil.systems.ato.scenario.perturb.name_draws`; empty: the seed draws them, perturbations in perturbed
    #: runs only.
    draws: tuple[float, ...] = ()
    #: The sequences whose sum is the noise of its speed sensor, in standard deviations, and of which the samples of its
    #: faults are made; empty: those of the seed.
    noise: Chain = ()
    #: An instant in s, from which the noise is that of another seed, and this seed.
    noise_from: tuple[float, int] | None = None

    @property
    def noise_change(self) -> tuple[int, int] | None:
        """The first tick with the noise of another seed, and this seed; None: there is none."""
        if self.noise_from is None:
            return None
        from_s, seed = self.noise_from
        return -(-round(from_s * 1e9) // self.timing.base_tick_ns), seed

    @property
    def usual_law(self) -> str:
        """The law of its runs when none is asked for."""
        return self.law or self.installed_system.law

    @property
    def wheel_factor_max(self) -> float:
        """Largest share of the true distance that the odometer can read, at least 1."""
        drawn = self.perturbations.wheel_factor
        return max(1.0, self.sensors.wheel_factor, 1.0 if drawn is None else drawn.high)

    @property
    def planned_s(self) -> float:
        """Running time by the timetable, in s."""
        return self.plan.running_time_s

    @property
    def watch_weakened(self) -> str:
        """See :attr:`WatchLimits.weakened`."""
        return self.watch.weakened

    @property
    def described(self) -> Mapping[str, object]:
        """Train and distance."""
        return {"train": self.train.name, "distance_m": self.plan.distance_m}

    @property
    def can_be_perturbed(self) -> bool:
        """Whether there is a distribution to draw from."""
        return any(getattr(self.perturbations, item.name) is not None for item in fields(self.perturbations))

    @property
    def every_run_is_drawn(self) -> bool:
        """No: without perturbations the seed only draws the noise of the sensors."""
        return False
