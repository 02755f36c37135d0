"""Parameters of IPFC+ and the constants made from them and from the scenario.

Unlike the table of IPFC this one contains the run: target, feed-forward and gains over the control period number. It is
therefore computed for each scenario. Its values are rounded to their formats in every arithmetic, so no constant
differs between fixed point and float64, or with the last bit of a mathematical library.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Annotated, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato.ipfc_plus_design import (
    Uncertainty,
    basis_functions,
    lag,
    observer_gains,
    plan,
    replanning_gains,
)
from railhil.controller_node.ato.pfc_model import (
    BASIS_STEP,
    BASIS_WAVELET,
    SATISFACTION_Q,
    SOFTENING_Q,
    InternalModel,
    on_grid,
)
from railhil.controller_node.laws.base import BALISE_ERROR_MAX_M, NOTCH_RAW_Q, SPEED_Q, WHEEL_ERROR_MAX
from railhil.controller_node.laws.constant_table import build, flatten, held
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import Target

#: Lagged notch, its integral over a period (notch s), lag error (s), weights and most gains.
UNIT_Q = 24
#: Accelerations, disturbance, acceleration per notch: km/h/s.
ACCEL_Q = 22
#: Share of the run already covered, 0..1.25.
SHARE_Q = 28
#: Error of the odometer as a share of the run, correction of the wheel.
WHEEL_Q = 30
#: Sums over balises.
SUM_Q = 26
#: Differences of positions, in 0.1 mm.
GAP_Q = 6
#: Acceleration per position error of 0.1 mm.
POSITION_GAIN_Q = 40
#: Distance run during the loop delay, 0.1 mm per km/h.
ADVANCE_Q = 16

#: Longest run, m: a wheel error over its distance has to fit ``GAP_Q``.
DISTANCE_MAX_M = 100_000.0
#: The odometer is used up to a quarter beyond the planned distance; further positions do not matter.
SHARE_MAX = 1.25
#: Sum of squared shares above which further balises are ignored (its format ends at 32).
SUM_MAX = 30.0
#: Weight of the nominal wheel on very long runs, where the format would round it to zero.
PRIOR_MIN = 2.0**-20
#: Speeds in the observer, km/h: the range of the wire, and some negative ones.
SPEED_MAX_KMH = 540.0
#: Lower limit of the virtual speeds after the stop, km/h.
VIRTUAL_MIN_KMH = -100.0
_KMH = 3.6
_01MM = 1e4

#: Lower limit of the re-planning time: the gains grow with the cube of its inverse.
ReplanTime = Annotated[float, Field(ge=0.1, le=120)]
#: A spread or a limit, in any unit: from 0 to far beyond any train.
Hundred = Annotated[float, Field(ge=0, le=100)]
Ten = Annotated[float, Field(ge=0, le=10)]


@dataclass(frozen=True, slots=True)
class IpfcPlusParameters:
    """Parameters of the law. The ``*_sigma`` are standard deviations of a run from its plan."""

    #: Mean delay from a speed's sampling to the notch's effect, s (0.02 to 0.20 s in the perturbed runs).
    loop_delay_s: Annotated[float, Field(gt=0, le=1)] = 0.11
    #: Basis functions of the future notch, and fitting points after the notch takes effect, s.
    basis: Literal["step", "ramp", "wavelets"] = "ramp"
    fit_points_s: Annotated[tuple[Annotated[float, Field(gt=0, le=30)], ...], Field(min_length=1, max_length=8)] = (
        1.0,
        2.0,
        3.0,
    )
    #: False: resistance and grade are covered only by the observer's disturbance.
    drag_fed_forward: bool = True
    #: Time in which speed and position errors are removed, s: the time left in the timetable, limited to this range.
    replan_max_s: ReplanTime = 10.0
    replan_min_s: ReplanTime = 2.0
    #: Limits of the errors that the law reacts to.
    position_error_max_m: Hundred = 6.0
    speed_error_max_kmh: Hundred = 10.0
    innovation_max_kmh: Hundred = 2.0
    #: Above this expected speed a reading of 0 is treated as a fault.
    standstill_kmh: Hundred = 3.0
    #: Force per notch over mass, relative, and the range of its estimate.
    gain_sigma: Ten = 0.065
    gain_error_max: Annotated[float, Field(ge=0, le=0.9)] = 0.2
    #: Actuator's time constant and loop delay together, s.
    lag_sigma_s: Ten = 0.26
    lag_error_max_s: Ten = 0.4
    #: The requested notch exceeds the nominal train's forces at the planned speed by at most this share.
    force_limit_margin: Ten = 0.1
    #: Disturbance acceleration, m/s2: initial spread, random walk per square root of a second, range.
    disturbance_sigma_mps2: Ten = 0.015
    disturbance_walk_mps2: Ten = 0.002
    disturbance_max_mps2: Ten = 0.5
    speed_noise_mps: Annotated[float, Field(ge=1e-5, le=10)] = 0.004
    #: Balise position, m, and wheel circumference, relative; the largest errors accepted.
    balise_sigma_m: Ten = 0.03
    balise_error_max_m: Hundred = BALISE_ERROR_MAX_M
    wheel_sigma: Annotated[float, Field(ge=1e-6, le=1)] = 0.003
    wheel_error_max: Annotated[float, Field(ge=0, le=0.1)] = WHEEL_ERROR_MAX


#: Bounds of a search.
TUNABLE: dict[str, tuple[float, float]] = {
    "replan_max_s": (5.0, 20.0),
    "replan_min_s": (1.5, 5.0),
    "position_error_max_m": (0.5, 12.0),
    "gain_sigma": (0.01, 0.2),
    "lag_sigma_s": (0.05, 1.0),
    "disturbance_sigma_mps2": (0.003, 0.05),
    "disturbance_walk_mps2": (0.0005, 0.01),
    "speed_noise_mps": (0.002, 0.012),
}

Row = tuple[Constant, ...]
Kind = TypeVar("Kind", bound="IpfcPlusConstants")


@dataclass(frozen=True)
class IpfcPlusConstants:
    """Constant table of the law on one scenario. The first rows run over the control period number k = 0, 1, ...

    The instant when the notch of period k begins to act is its beginning plus the loop delay.
    """

    target_position: Row = field(metadata=held(0, "target when the notch acts"))
    target_speed: Row = field(metadata=held(SPEED_Q, "target when the notch acts"))
    feed_forward: Row = field(metadata=held(ACCEL_Q, "steady force that brings the lagged one to that of the plan"))
    planned_force: Row = field(metadata=held(ACCEL_Q, "target acceleration and drag when the notch acts"))
    notch_upper: Row = field(metadata=held(NOTCH_RAW_Q, "notch beyond which the traction gives no more"))
    notch_lower: Row = field(metadata=held(NOTCH_RAW_Q, "notch beyond which the brake gives no more"))
    force_rate: Row = field(metadata=held(ACCEL_Q, "its rise over the period"))
    drag_over_period: Row = field(metadata=held(SPEED_Q, "speed that the drag took since the period before"))
    drag_over_delay: Row = field(metadata=held(SPEED_Q, "speed that it takes until the notch acts"))
    observe_speed: Row = field(metadata=held(UNIT_Q, "Kalman gain of the speed"))
    observe_disturbance: Row = field(metadata=held(UNIT_Q, "Kalman gain of the disturbance"))
    observe_gain: Row = field(metadata=held(UNIT_Q, "Kalman gain of the acceleration per notch"))
    observe_lag: Row = field(metadata=held(UNIT_Q, "Kalman gain of the lag"))
    by_position: Row = field(metadata=held(POSITION_GAIN_Q, "PFC gain on the position error"))
    by_speed: Row = field(metadata=held(UNIT_Q, "PFC gain on the speed error"))
    by_force: Constant = field(metadata=held(UNIT_Q, "PFC gain on the error of the acting force"))
    lagged: Row = field(metadata=held(UNIT_Q, "actuator over one period"))
    integral: Row = field(metadata=held(UNIT_Q, "its integral"))
    delay_lagged: Row = field(metadata=held(UNIT_Q, "actuator over the loop delay"))
    delay_integral: Row = field(metadata=held(UNIT_Q, "its integral"))
    pole: Constant = field(metadata=held(UNIT_Q, "actuator pole"))
    period: Constant = field(metadata=held(UNIT_Q, "control period"))
    delay: Constant = field(metadata=held(UNIT_Q, "loop delay"))
    advance: Constant = field(metadata=held(ADVANCE_Q, "half the loop delay"))
    gain: Constant = field(metadata=held(ACCEL_Q, "nominal acceleration per notch"))
    gain_max: Constant = field(metadata=held(ACCEL_Q, "largest gain believed"))
    gain_min: Constant = field(metadata=held(ACCEL_Q, "smallest gain believed"))
    lag_max: Constant = field(metadata=held(UNIT_Q, "largest lag error believed"))
    disturbance_max: Constant = field(metadata=held(ACCEL_Q, "largest disturbance believed"))
    innovation_max: Constant = field(metadata=held(SPEED_Q, "largest surprise in one reading"))
    standstill: Constant = field(metadata=held(SPEED_Q, "largest expected speed at which a reading of 0 is believed"))
    speed_max: Constant = field(metadata=held(SPEED_Q, "speeds on the wire"))
    speed_error_max: Constant = field(metadata=held(SPEED_Q, "limit of the law"))
    position_error_max: Constant = field(metadata=held(GAP_Q, "limit of the law"))
    gap_max: Constant = field(metadata=held(0, "largest error with the largest wheel error, and ten metres"))
    odometer_max: Constant = field(metadata=held(0, "distance followed"))
    wheel_max: Constant = field(metadata=held(WHEEL_Q, "largest wheel error believed"))
    balise_slack: Constant = field(metadata=held(WHEEL_Q, "largest balise error believed"))
    prior: Constant = field(metadata=held(SUM_Q, "weight of the nominal wheel among the balises"))
    sum_max: Constant = field(metadata=held(SUM_Q, "format limit"))
    basis: Constant = field(metadata=held(0, "code of CTL_STAT"))
    one_softening: Constant = field(metadata=held(SOFTENING_Q, "1"))
    zero: Constant = field(metadata=held(SATISFACTION_Q, "0"))

    def entries(self) -> tuple[Constant, ...]:
        """All constants, in the order of the fields."""
        return flatten(self)


def per_distance(distance_m: float) -> Constant:
    """1 / planned distance, per 0.1 mm, in the finest format that can represent it."""
    value = 1 / (distance_m * _01MM)
    return Constant("per_distance", value, 30 - math.frexp(value)[1], "1 / planned distance")


def fit_points(parameters: IpfcPlusParameters, period_s: float) -> tuple[int, ...]:
    """Fitting points in control periods, each at least one and all different."""
    return tuple(sorted({max(1, round(at_s / period_s)) for at_s in parameters.fit_points_s}))


def _over_time(p: IpfcPlusParameters, scenario: Scenario) -> dict[str, ArrayLike]:
    period_s, delay_s = scenario.timing.control_period_ns / 1e9, p.loop_delay_s
    target = Target(scenario.target)
    end_s = max(scenario.plan.running_time_s, target.stop_time_s) + scenario.plan.overtime_max_s
    train = scenario.train
    begins_s = np.arange(math.ceil(end_s / period_s) + 1, dtype=np.float64) * np.float64(period_s)
    instants_s = (begins_s, begins_s + delay_s, begins_s + delay_s + period_s, np.maximum(begins_s - period_s / 2, 0.0))
    now, acting, after, middle = (plan(scenario, at_s, p.drag_fed_forward) for at_s in instants_s)
    # Before the first period nothing moves.
    drag_before_mps = np.where(begins_s > 0.0, middle.drag_mps2 * period_s, 0.0)
    pole = train.actuator_pole_per_s
    decay = math.exp(-pole * period_s)
    unknown = Uncertainty(
        p.gain_sigma, p.lag_sigma_s, p.disturbance_sigma_mps2, p.disturbance_walk_mps2, p.speed_noise_mps
    )
    observe = observer_gains(now.force_mps2, period_s, unknown)
    points = fit_points(p, period_s)
    basis = basis_functions(p.basis, max(points), period_s)
    if len(points) < len(basis):
        raise ValueError(f"{len(basis)} basis functions need as many fitting points, there are {len(points)}")
    weights = InternalModel.sampled(pole, pole, 0.0, period_s).gains(basis, points)
    left_s = np.clip(target.stop_time_s - acting.times_s, p.replan_min_s, p.replan_max_s)
    replan = replanning_gains(weights, pole, points, period_s, left_s)
    limit = (1 + p.force_limit_margin) / train.force_per_notch_n
    per_notch = train.force_per_notch_n / train.inertial_mass_kg
    return {
        "target_position": acting.position_m * _01MM,
        "target_speed": np.maximum(acting.speed_mps * _KMH, VIRTUAL_MIN_KMH),
        "feed_forward": (after.force_mps2 - decay * acting.force_mps2) / (1 - decay) * _KMH,
        "planned_force": acting.force_mps2 * _KMH,
        "force_rate": (after.force_mps2 - acting.force_mps2) / period_s * _KMH,
        "notch_upper": np.minimum(acting.traction_n * limit, train.notch_max),
        "notch_lower": -np.minimum(acting.brake_n * limit, train.notch_max),
        "drag_over_period": drag_before_mps * _KMH,
        "drag_over_delay": now.drag_mps2 * delay_s * _KMH,
        "observe_speed": observe[:, 0],
        "observe_disturbance": observe[:, 1],
        "observe_gain": observe[:, 2] * per_notch,
        "observe_lag": observe[:, 3] / _KMH,
        "by_position": replan[:, 0] * _KMH / _01MM,
        "by_speed": replan[:, 1],
        "by_force": replan[0, 2],
    }


def compute_constants(p: IpfcPlusParameters, scenario: Scenario) -> IpfcPlusConstants:
    """The constant table of a scenario.

    Raises ``ValueError`` as :func:`constant_values`, and if a constant does not fit its format.
    """
    return rounded(IpfcPlusConstants, constant_values(p, scenario))


def rounded(kind: type[Kind], values: Mapping[str, ArrayLike]) -> Kind:
    """A table whose values are rounded to the formats of its fields."""
    formats = {item.name: item.metadata["q"] for item in fields(kind)}
    return build(kind, {name: on_grid(value, formats[name]).tolist() for name, value in values.items()})


def constant_values(p: IpfcPlusParameters, scenario: Scenario) -> dict[str, ArrayLike]:
    """The values of the constant table, by field.

    Raises ``ValueError`` if the loop delay, the fitting points or the re-planning times are inconsistent with the
    control period, the basis or each other, or if the run is too long.
    """
    period_s = scenario.timing.control_period_ns / 1e9
    if p.replan_min_s > p.replan_max_s:
        raise ValueError(f"replan_min_s {p.replan_min_s:g} is above replan_max_s {p.replan_max_s:g}")
    if not 0.0 < p.loop_delay_s < period_s:
        raise ValueError(f"a loop delay of {p.loop_delay_s} s is not inside the control period of {period_s} s")
    train, distance_m = scenario.train, scenario.plan.distance_m
    if distance_m > DISTANCE_MAX_M:
        raise ValueError(f"a run of {distance_m} m is longer than {DISTANCE_MAX_M:.0f} m")
    actuator = lag(train.actuator_pole_per_s, period_s, p.loop_delay_s)
    gain = train.force_per_notch_n / train.inertial_mass_kg * _KMH
    return _over_time(p, scenario) | {
        "lagged": actuator.over_period[0],
        "integral": actuator.over_period[1],
        "delay_lagged": actuator.over_delay[0],
        "delay_integral": actuator.over_delay[1],
        "pole": train.actuator_pole_per_s,
        "period": period_s,
        "delay": p.loop_delay_s,
        "advance": p.loop_delay_s / 2 / _KMH * _01MM,
        "gain": gain,
        "gain_max": gain * (1 + p.gain_error_max),
        "gain_min": gain * (1 - p.gain_error_max),
        "lag_max": p.lag_error_max_s,
        "disturbance_max": p.disturbance_max_mps2 * _KMH,
        "innovation_max": p.innovation_max_kmh,
        "standstill": p.standstill_kmh,
        "speed_max": SPEED_MAX_KMH,
        "speed_error_max": p.speed_error_max_kmh,
        "position_error_max": p.position_error_max_m * _01MM,
        "gap_max": (p.position_error_max_m + p.wheel_error_max * SHARE_MAX * distance_m + 10) * _01MM,
        "odometer_max": distance_m * SHARE_MAX * _01MM,
        "wheel_max": p.wheel_error_max,
        "balise_slack": p.balise_error_max_m / distance_m,
        "prior": max((p.balise_sigma_m / (p.wheel_sigma * distance_m)) ** 2, PRIOR_MIN),
        "sum_max": SUM_MAX,
        "basis": BASIS_STEP | BASIS_WAVELET if p.basis == "wavelets" else BASIS_STEP,
        "one_softening": 1.0,
        "zero": 0.0,
    }
