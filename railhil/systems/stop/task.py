"""The keys of a scenario of precise stopping, ``[task]``.

A law knows :class:`StopTask` without ``true``, ``rail``, ``map_error_sigma_permil`` and the sensors' errors. Draws for
the train and its line (once for a seed): gain, delay, wheels, errors of the grade map. Draws that differ from run to
run (for seed and run number): further gain and delay, cruising speed, load, adhesion, all noise. Every draw is from a
normal distribution with the given standard deviation unless a key says otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import exp, sqrt
from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field, Strict

from railhil.scenarios.carried import SIGMAS, Reach
from railhil.scenarios.schema import Name, Table
from railhil.scenarios.task import Task

_KMH, _GRAVITY_MPS2 = 3.6, 9.81
#: One tick: five samples of the speed.
_TICK_S = 0.016
_Accel = Annotated[float, Field(gt=0, le=3)]
_Share = Annotated[float, Field(ge=0, le=1)]
_Sigma = Annotated[float, Field(ge=0, le=0.2)]
_Metres = Annotated[float, Field(ge=0, le=100_000)]
_Permil = Annotated[float, Field(ge=-60, le=60)]
_Percent = Annotated[float, Field(ge=0, le=100)]


def _rising(pair: tuple[float, float]) -> tuple[float, float]:
    if pair[0] > pair[1]:
        raise ValueError("the smallest value first")
    return pair


def _along(rows: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(before[0] >= after[0] for before, after in pairwise(rows)):
        raise ValueError("positions in rising order")
    return rows


def _towards(rows: tuple[float, ...]) -> tuple[float, ...]:
    if any(before <= after for before, after in pairwise(rows)):
        raise ValueError("distances in falling order")
    return rows


class BrakeTable(Table):
    """The laws' model of traction and brake: ``exp(-delay s) / (lag s + 1)``."""

    braking_mps2: Annotated[_Accel, Field(description="planned deceleration on a dry rail")] = 0.8
    wet_braking_mps2: Annotated[_Accel, Field(description="planned deceleration when low adhesion is announced")] = 0.55
    delay_s: Annotated[float, Field(ge=0, le=3, description="pure delay of the laws' model")] = 0.6
    lag_s: Annotated[float, Field(gt=0, le=5, description="lag of the laws' model")] = 0.4
    braking_max_mps2: Annotated[_Accel, Field(description="largest deceleration that can be commanded")] = 1.2
    traction_max_mps2: Annotated[_Accel, Field(description="largest acceleration that can be commanded")] = 1.0
    notch_mps2: Annotated[
        float, Field(ge=0, le=0.5, description="step of a brake with notches: rounded to the nearest; 0: stepless")
    ] = 0.0


class TrueBrakeTable(Table):
    """The real brake."""

    BESIDE: ClassVar[Mapping[str, str]] = {"low_speed_mps": "low_speed_loss"}
    delay_s: Annotated[float, Field(ge=0, le=3, description="pure delay")]
    lag_s: Annotated[float, Field(gt=0, le=5, description="lag")]
    gain: Annotated[float, Field(gt=0, le=2, description="share of the commanded deceleration that is achieved")] = 1.0
    gain_train_sigma: Annotated[_Sigma, Field(description="gain from train to train, relative")] = 0.0
    gain_run_sigma: Annotated[_Sigma, Field(description="gain from run to run, relative")] = 0.0
    delay_train_sigma_s: Annotated[_Sigma, Field(description="delay from train to train")] = 0.0
    delay_run_sigma_s: Annotated[_Sigma, Field(description="delay from run to run")] = 0.0
    full_load_gain: Annotated[
        float, Field(gt=0, le=2, description="factor of the gain at full load; linear between empty and full")
    ] = 1.0
    low_speed_loss: Annotated[_Share, Field(description="share of the braking that is lost at low speed")] = 0.0
    low_speed_mps: Annotated[float, Field(ge=0, le=10, description="below this speed")] = 2.0


class RailTable(Table):
    """Runs on a rail that limits the braking: the wheels slide."""

    BESIDE: ClassVar[Mapping[str, str]] = {
        "adhesion_mps2": "slide_share",
        "seen_share": "slide_share",
        "announced_share": "slide_share",
    }
    slide_share: Annotated[_Share, Field(description="share of these runs")] = 0.0
    adhesion_mps2: Annotated[
        tuple[_Accel, _Accel],
        Strict(False),
        AfterValidator(_rising),
        Field(description="largest deceleration in such a run, uniform between these"),
    ] = (0.55, 0.75)
    seen_share: Annotated[_Share, Field(description="share of these runs in which the slide is reported")] = 1.0
    announced_share: Annotated[
        _Share, Field(description="share of these runs in which low adhesion is known before")
    ] = 0.0


class SensorTable(Table):
    """Errors of the laws' readings."""

    speed_noise_mps: Annotated[_Sigma, Field(description="noise of each speed sample")] = 0.01
    wheel_sigma: Annotated[_Sigma, Field(description="error of the wheel diameter, relative")] = 0.0
    balise_sigma_m: Annotated[float, Field(ge=0, le=5, description="error of the place at which a balise is read")] = (
        0.03
    )
    mark_sigma_m: Annotated[
        float, Field(ge=0, le=5, description="error of the stop as the mark balise measures it")
    ] = 0.03


class StopTask(Task):
    """The section ``[task]``: a train stops at a platform."""

    JUDGING: ClassVar[tuple[str, ...]] = ("stop_error_max_m",)
    BESIDE: ClassVar[Mapping[str, str]] = {"wander_time_s": "wander_sigma_mps"}

    train: Annotated[Name, Field(description="the train: its memory is its own")] = "train_1"
    platform: Annotated[Name, Field(description="the platform")]
    direction: Annotated[Name, Field(description="direction of travel")]
    stop_m: Annotated[_Metres, Field(description="position of the stopping point")]
    start_m: Annotated[_Metres, Field(description="position at which the run begins")]
    start_kmh: Annotated[
        float, Field(ge=0, le=200, description="mean speed at which the run begins; 0: from standstill")
    ]
    approach_kmh: Annotated[float, Field(gt=0, le=200, description="planned speed of the approach")] = 60.0
    cruise_sigma_mps: Annotated[float, Field(ge=0, le=5, description="start speed from run to run")] = 0.0
    start_spread_kmh: Annotated[
        float, Field(ge=0, le=60, description="start speed from run to run, uniform within plus and minus this")
    ] = 0.0
    wander_sigma_mps: Annotated[
        float, Field(ge=0, le=1, description="slow wander of the speed until the brake is commanded")
    ] = 0.0
    wander_time_s: Annotated[float, Field(gt=0, le=1000, description="correlation time of the wander")] = 5.0
    after_stop_s: Annotated[float, Field(ge=1.5, le=600, description="the run ends this long after the standstill")] = (
        4.0
    )
    grade: Annotated[
        tuple[Annotated[tuple[_Metres, _Permil], Strict(False)], ...],
        Strict(False),
        AfterValidator(_along),
        Field(min_length=1, description="grade map: position and grade (permil) from there on"),
    ]
    map_error_sigma_permil: Annotated[
        float, Field(ge=0, le=5, description="error of the grade map, drawn for each of its pieces")
    ] = 0.0
    balises_m: Annotated[
        tuple[Annotated[float, Field(gt=0, le=1000)], ...],
        Strict(False),
        AfterValidator(_towards),
        Field(max_length=20, description="balises before the stopping point, by distance; the first one has id 1"),
    ] = ()
    load_percent: Annotated[
        tuple[_Percent, _Percent],
        Strict(False),
        AfterValidator(_rising),
        Field(description="load of a run, uniform between these"),
    ] = (0.0, 0.0)
    service_braking_mps2: Annotated[_Accel, Field(description="deceleration of a train that brakes by itself")] = 0.8
    emergency_braking_mps2: Annotated[
        _Accel, Field(description="deceleration of the emergency brake, which has neither delay of the valve nor gain")
    ] = 1.2
    stop_error_max_m: Annotated[float, Field(gt=0, le=100, description="largest stop error for a PASS")] = 0.3
    brake: BrakeTable = BrakeTable()
    true: TrueBrakeTable
    rail: RailTable = RailTable()
    sensors: SensorTable = SensorTable()

    def reaches(self) -> Iterator[Reach]:
        """See :meth:`railhil.scenarios.task.Task.reaches`; the train stops at the stopping point, or by its own
        brake."""
        true, sensors, brake = self.true, self.sensors, self.brake
        wheel, gain = 1.0 + SIGMAS * sensors.wheel_sigma, self.gain_max
        cruise_mps = (self.start_kmh + self.start_spread_kmh) / _KMH + SIGMAS * self.cruise_sigma_mps
        fastest_mps = max(cruise_mps, self.approach_kmh / _KMH) + SIGMAS * self.wander_sigma_mps
        read_mps = fastest_mps * wheel + SIGMAS * sensors.speed_noise_mps
        start, wheel_key = ("task", "start_kmh"), ("task", "sensors", "wheel_sigma")
        yield Reach("SPEED_RAW.Speed5", 0.0, read_mps, start, self.start_kmh)
        yield Reach("TRUE_DATA.TrueCruise", 0.0, cruise_mps, start, self.start_kmh)
        yield Reach("TRUE_DATA.TrueWheel", 1.0 - wheel, wheel - 1.0, wheel_key, sensors.wheel_sigma)
        # Distance behind the stopping point for the train's own brake, after a second without commands.
        slowest_mps2 = self.service_braking_mps2 / 2
        end_m = self.stop_m + fastest_mps * (1.0 + true.delay_s + true.lag_s) + fastest_mps**2 / (2 * slowest_mps2)
        stop = ("task", "stop_m")
        yield Reach("TRUTH.TruePos", self.start_m, end_m, stop, self.stop_m)
        for signal in ("ODO.OdoDistance", "ODO.BaliseDistance"):
            yield Reach(signal, 0.0, (end_m - self.start_m) * wheel, stop, self.stop_m)
        yield Reach("TRUE_DATA.TrueGain", 0.0, gain, ("task", "true", "gain"), true.gain)
        delay_s = true.delay_s + SIGMAS * (true.delay_train_sigma_s + true.delay_run_sigma_s)
        yield Reach("TRUE_DATA.TrueDelay", 0.0, delay_s, ("task", "true", "delay_s"), true.delay_s)
        yield Reach("TRUE_DATA.TrueLag", 0.0, true.lag_s, ("task", "true", "lag_s"), true.lag_s)
        # Accelerations: the strongest brake with its gain and the traction, each with grade and wander.
        permil = max(abs(value) for _, value in self.grade) + SIGMAS * self.map_error_sigma_permil
        keep = exp(-_TICK_S / self.wander_time_s)
        beside_mps2 = permil * _GRAVITY_MPS2 / 1000 + (
            SIGMAS * self.wander_sigma_mps * (sqrt(1.0 - keep * keep) + 1.0 - keep) / _TICK_S
        )
        pushes = {
            ("task", "brake", "braking_max_mps2"): (brake.braking_max_mps2, gain),
            ("task", "service_braking_mps2"): (self.service_braking_mps2, gain),
            ("task", "emergency_braking_mps2"): (self.emergency_braking_mps2, 1.0),
        }
        for keys, (value, factor) in pushes.items():
            yield Reach("TRUTH.TrueDrive", -value * factor, 0.0, keys, value)
            yield Reach("TRUTH.TrueAccel", -value * factor - beside_mps2, 0.0, keys, value)
        pull_mps2 = brake.traction_max_mps2
        pull = ("task", "brake", "traction_max_mps2")
        yield Reach("TRUTH.TrueDrive", 0.0, pull_mps2 + permil * _GRAVITY_MPS2 / 1000, pull, pull_mps2)
        yield Reach("TRUTH.TrueAccel", 0.0, pull_mps2 + beside_mps2, pull, pull_mps2)

    @property
    def gain_max(self) -> float:
        """Largest share of the commanded braking that a drawn train achieves in a run."""
        true = self.true
        loaded = max(1.0 + (true.full_load_gain - 1.0) * percent / 100.0 for percent in self.load_percent)
        return true.gain * (1.0 + SIGMAS * true.gain_train_sigma) * (1.0 + SIGMAS * true.gain_run_sigma) * loaded

    @property
    def can_be_perturbed(self) -> bool:
        """Every run draws with the seed and its run number; a perturbed run draws nothing else."""
        return True
