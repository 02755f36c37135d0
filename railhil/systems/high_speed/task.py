"""The keys of a scenario of a high-speed train, ``[task]``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import fsum
from typing import Annotated, ClassVar, Literal

from pydantic import Field, Strict

from railhil.scenarios.carried import SIGMAS, Reach
from railhil.scenarios.schema import Table
from railhil.scenarios.task import Task

_KMH, _GRAVITY_MPS2 = 3.6, 9.80665
_Share = Annotated[float, Field(gt=0, le=1)]
_Kmh = Annotated[float, Field(gt=0, le=600)]
_Km = Annotated[float, Field(ge=0, le=10_000)]
_Accel = Annotated[float, Field(gt=0, le=3)]
_Delay = Annotated[float, Field(ge=0, le=5)]
_Coefficient = Annotated[float, Field(ge=0, le=1000)]
_Three = Annotated[tuple[_Coefficient, _Coefficient, _Coefficient], Strict(False)]
_Metres = Annotated[float, Field(gt=0, le=100_000)]


class UnitTable(Table):
    """One power unit: ``v = gain exp(-delay s) / (s (lag s + 1)) u``, u its target acceleration."""

    mass_t: Annotated[float, Field(gt=0, le=2000, description="mass of the unit, loaded")]
    lag_s: Annotated[float, Field(gt=0, le=10, description="time constant of traction and brake")]
    gain: Annotated[float, Field(gt=0, le=10, description="achieved share of the commanded acceleration")] = 1.0
    traction_delay_s: Annotated[_Delay, Field(description="from the command to the traction force")]
    braking_delay_s: Annotated[_Delay, Field(description="from the command to the braking force")]


class RestrictionTable(Table):
    """A speed restriction of the line."""

    from_km: Annotated[_Km, Field(description="where the restriction begins")]
    to_km: Annotated[_Km, Field(description="where it ends")]
    speed_kmh: Annotated[_Kmh, Field(description="allowed speed there")]


class CoastingTable(Table):
    """A stretch on which the train coasts down to a speed, and then keeps it."""

    from_km: Annotated[_Km, Field(description="where the train begins to coast")]
    to_km: Annotated[_Km, Field(description="where it accelerates again")]
    speed_kmh: Annotated[_Kmh, Field(description="speed to which it coasts")]


class CurveTable(Table):
    """The target curve, see :func:`railhil.systems.high_speed.target.journey_curve`."""

    distance_km: Annotated[float, Field(gt=0, le=3000, description="from the start to the stopping point")]
    peak_kmh: Annotated[_Kmh, Field(description="highest speed")]
    traction_mps2: Annotated[_Accel, Field(description="largest acceleration")]
    power_share: Annotated[_Share, Field(description="share of the power that the curve uses")]
    braking_mps2: Annotated[_Accel, Field(description="deceleration at the restriction and at the end")]
    average_s: Annotated[
        float, Field(ge=0, le=60, description="the curve is averaged over this time, which limits the jerk")
    ]
    restriction: RestrictionTable
    coasting: CoastingTable


class EmergencyTable(Table):
    """An emergency brake application, carried out by the speed controller along a profile."""

    at_km: Annotated[_Km, Field(description="position of the train at which the emergency is triggered")]
    high_kmh: Annotated[_Kmh, Field(description="at this speed and above the profile has its smallest deceleration")]
    low_kmh: Annotated[_Kmh, Field(description="at this speed and below the profile has its largest deceleration")]
    at_high_mps2: Annotated[_Accel, Field(description="smallest deceleration")]
    at_low_mps2: Annotated[_Accel, Field(description="largest deceleration")]
    build_up_s: Annotated[float, Field(ge=0, le=10, description="time in which the deceleration is built up")] = 1.0


class CouplerTable(Table):
    """A coupler: a spring and a damper, without force within its slack."""

    stiffness_kn_per_m: Annotated[float, Field(gt=0, le=100_000, description="of the spring")]
    damping_kn_per_mps: Annotated[float, Field(ge=0, le=10_000, description="of the damper")]
    slack_mm: Annotated[float, Field(ge=0, le=100, description="play between tension and compression")] = 0.0


class HighSpeedTask(Task):
    """The section ``[task]``: a train of one or several power units follows a target curve."""

    JUDGING: ClassVar[tuple[str, ...]] = ("rmse_max_kmh", "emergency_stop_max_m")
    BESIDE: ClassVar[Mapping[str, str]] = {
        "stale_braking_mps2": "stale_command",
        "emergency_stop_max_m": "emergency",
    }

    start_s: Annotated[
        float,
        Field(ge=0, le=28_800, description="time of the target curve at which the run begins, the train at its speed"),
    ] = 0.0
    unit: Annotated[tuple[UnitTable, ...], Strict(False), Field(description="the power units, the leading one first")]
    length_m: Annotated[float, Field(gt=0, le=1000, description="length of the train: the grade is averaged over it")]
    power_kw: Annotated[float, Field(gt=0, le=100_000, description="power of the train")]
    rotating_mass_share: Annotated[float, Field(ge=0, le=1, description="rotating masses, as a share of the mass")]
    davis_n_per_t: Annotated[_Three, Field(description="running resistance a, b, c in N/t over V in km/h")]
    traction_max_mps2: Annotated[_Accel, Field(description="largest traction")]
    braking_max_mps2: Annotated[_Accel, Field(description="largest braking")]
    gradient_permil: Annotated[
        float, Field(ge=0, le=40, description="grades are drawn between plus and minus this, 0: flat")
    ]
    gradient_piece_m: Annotated[
        tuple[_Metres, _Metres], Strict(False), Field(description="shortest and longest piece of one grade")
    ] = (1000.0, 4000.0)
    wind_sigma_mps2: Annotated[
        float, Field(ge=0, le=1, description="standard deviation of the wind's acceleration, 0: none")
    ]
    wind_time_s: Annotated[float, Field(gt=0, le=1000, description="correlation time of the wind")] = 20.0
    noise_sigma_mps: Annotated[float, Field(ge=0, le=1, description="standard deviation of each reading of the speed")]
    stale_command: Annotated[
        Literal["coast", "brake"], Field(description="what a unit does without a new command for three periods")
    ] = "coast"
    stale_braking_mps2: Annotated[_Accel, Field(description="its deceleration if it brakes")] = 0.5
    curve: CurveTable
    emergency: EmergencyTable | None = None
    rmse_max_kmh: Annotated[float, Field(gt=0, le=100, description="largest RMSE of the speed for a PASS")]
    emergency_stop_max_m: Annotated[
        float, Field(gt=0, le=20_000, description="largest distance from the trigger to the standstill for a PASS")
    ] = 4500.0

    def reaches(self) -> Iterator[Reach]:
        """See :meth:`railhil.scenarios.task.Task.reaches`; the train follows its curve."""
        curve, unit_words = self.curve, [f"UNIT{number + 1}" for number in range(len(self.unit))]
        peak_mps, end_m = curve.peak_kmh / _KMH, curve.distance_km * 1000.0
        noise, noise_key = SIGMAS * self.noise_sigma_mps, ("task", "noise_sigma_mps")
        peak, end = ("task", "curve", "peak_kmh"), ("task", "curve", "distance_km")
        yield Reach("REF.RefNow", 0.0, curve.peak_kmh, peak, curve.peak_kmh)
        for word in unit_words:
            yield Reach(
                f"{word}_FB.{word.capitalize()}Speed", 0.0, (peak_mps + noise) * _KMH, noise_key, noise / SIGMAS
            )
        yield Reach("TRAIN.TrainPos", 0.0, end_m, end, curve.distance_km)
        yield Reach("TRUTH.TruePos", 0.0, end_m, end, curve.distance_km)
        time_s = self.duration_s
        yield Reach("TRAIN.TrainTime", 0.0, time_s, ("task", "duration_s"), time_s)
        # Accelerations: what is commanded with the gain of the unit, and what acts from outside.
        wind_mps2, grade_mps2 = SIGMAS * self.wind_sigma_mps2, self.gradient_permil * _GRAVITY_MPS2 / 1000
        a, b, c = self.davis_n_per_t
        drag_mps2 = (a + b * curve.peak_kmh + c * curve.peak_kmh**2) / 1000
        yield Reach("MUTATION.TrueWind", -wind_mps2, wind_mps2, ("task", "wind_sigma_mps2"), self.wind_sigma_mps2)
        yield Reach("MUTATION.TrueGrade", 0.0, self.gradient_permil, ("task", "gradient_permil"), self.gradient_permil)
        for row, (word, unit) in enumerate(zip(unit_words, self.unit, strict=True)):
            gain = ("task", "unit", row, "gain")
            pull_mps2, push_mps2 = self.traction_max_mps2 * unit.gain, self.braking_max_mps2 * unit.gain
            drive = f"{word}_FORCE.{word.capitalize()}Drive"
            for signal, more, less in (
                (drive, 0.0, 0.0),
                ("TRUTH.TrueDrive", 0.0, 0.0),
                ("TRUTH.TrueAccel", wind_mps2 + grade_mps2, wind_mps2 + grade_mps2 + drag_mps2),
            ):
                yield Reach(signal, -push_mps2 - less, pull_mps2 + more, gain, unit.gain)
            yield Reach("MUTATION.TrueGain", 0.0, unit.gain, gain, unit.gain)

    @property
    def can_be_perturbed(self) -> bool:
        """Grades, wind and noise are drawn with the seed in every run; a perturbed run draws nothing else."""
        return max(self.gradient_permil, self.wind_sigma_mps2, self.noise_sigma_mps) > 0.0

    @property
    def every_run_is_drawn(self) -> bool:
        """See :attr:`can_be_perturbed`."""
        return self.can_be_perturbed

    @property
    def mass_t(self) -> float:
        """Mass of the train, t."""
        return fsum(unit.mass_t for unit in self.unit)

    @property
    def power_w_per_kg(self) -> float:
        """Power by mass, with the rotating masses."""
        return self.power_kw / (self.mass_t * (1.0 + self.rotating_mass_share))

    @property
    def between_units(self) -> CouplerTable | None:
        """The couplers between the units; None: the units are free."""
        return None


class SingleUnitTask(HighSpeedTask):
    """A train as one unit."""

    unit: Annotated[tuple[UnitTable], Strict(False), Field(description="the train as one power unit")]


class ThreeUnitsTask(HighSpeedTask):
    """A train of three units."""

    unit: Annotated[
        tuple[UnitTable, UnitTable, UnitTable],
        Strict(False),
        Field(description="three power units, the leading one first"),
    ]
    coupler: Annotated[CouplerTable | None, Field(description="between the units; without it they are free")] = None

    @property
    def between_units(self) -> CouplerTable | None:
        """See :class:`HighSpeedTask`."""
        return self.coupler
