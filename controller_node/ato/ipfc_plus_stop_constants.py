"""Parameters of IPFC+ with its end phase, and the constants that the end phase adds to those of IPFC+."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato.ipfc_plus_constants import (
    ACCEL_Q,
    GAP_Q,
    SHARE_Q,
    TUNABLE,
    UNIT_Q,
    WHEEL_Q,
    Hundred,
    IpfcPlusConstants,
    IpfcPlusParameters,
    ReplanTime,
    Row,
    Ten,
    constant_values,
    rounded,
)
from railhil.controller_node.ato.ipfc_plus_design import DESIGN_SEEDS as DESIGNED_BEFORE
from railhil.controller_node.ato.ipfc_plus_design import (
    StopUncertainty,
    StopWeights,
    lag_twice,
    plan,
    stop_gains,
    stop_observer_gains,
)
from railhil.controller_node.laws.base import SPEED_Q
from railhil.controller_node.laws.constant_table import held
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import Target

#: Gain of the end phase, acceleration per position error of 0.1 mm: a coarser format than in IPFC+, whose gain is
#: smaller.
STOP_GAIN_Q = 36
#: Nearest balise from which the wheel is bounded, as a share of the run: earlier balises give little information.
SHARE_MIN = 1 / 16
#: Limit of a balise's error as a share of the run, for the format of its quotient.
BOUND_MAX = 0.1
TOLERANCE_MAX = 0.01
#: Limit of the error of the acting force in the end phase, for the format: beyond any train's forces.
FORCE_ERROR_MAX_MPS2 = 5.0
_KMH = 3.6
_01MM = 1e4

#: Bounds of a search: as for IPFC+, but the end phase takes the place of the shortest re-planning time, and the
#: disturbance wanders less.
STOP_TUNABLE = {name: bounds for name, bounds in TUNABLE.items() if name != "replan_min_s"} | {
    "drag_sigma": (0.02, 1.0),
    "disturbance_walk_mps2": (0.0002, 0.005),
    "stop_speed_mps": (0.0005, 0.005),
    "stop_demand_mps2": (0.01, 0.3),
}

#: Perturbed runs on which the defaults of the end phase were chosen.
DESIGN_SEEDS = dict.fromkeys(DESIGNED_BEFORE, range(1000))


@dataclass(frozen=True, slots=True)
class IpfcPlusStopParameters(IpfcPlusParameters):
    """Parameters of the law: those of IPFC+, and of the end phase."""

    #: Longer than in IPFC+: the end phase compensates for it, and the ride is smoother.
    replan_max_s: ReplanTime = 12.5
    #: Spread and range of the actuator's time constant (IPFC+: with the loop delay), and of the loop delay, s.
    lag_sigma_s: Ten = 0.2
    lag_error_max_s: Ten = 0.6
    delay_sigma_s: Ten = 0.03
    delay_error_max_s: Ten = 0.15
    #: Random walk of the disturbance: as a share of each change of the planned drag, and of everything else (smaller
    #: than in IPFC+, whose walk also has to cover the unknown lag).
    drag_sigma: Ten = 0.2
    disturbance_walk_mps2: Ten = 0.0007
    #: Largest error of a surveyed balise, m. 0: the fit of IPFC+ from the second balise on.
    survey_tolerance_m: Ten = 0.05
    #: Forces are converted from the measured wheel to the real one.
    wheel_on_forces: bool = True
    #: Planned speed below which the end phase takes over; 0: never.
    handover_kmh: Hundred = 10.0
    #: Largest deviations from the plan for the end phase; beyond them IPFC+ continues.
    capture_m: Annotated[float, Field(ge=0, le=1)] = 0.3
    capture_kmh: Annotated[float, Field(ge=0, le=4)] = 1.0
    #: Largest correction of the end phase. Jerk is at most this times the actuator's pole.
    correction_max_mps2: Annotated[float, Field(ge=0, le=10)] = 0.6
    #: Deviations that weigh as much as each other: position and speed at the stop, demand held for 1 s.
    stop_position_m: Annotated[float, Field(ge=1e-4, le=1)] = 0.001
    stop_speed_mps: Annotated[float, Field(ge=1e-4, le=1)] = 0.0018
    stop_demand_mps2: Annotated[float, Field(ge=1e-2, le=10)] = 0.075


@dataclass(frozen=True)
class IpfcPlusStopConstants(IpfcPlusConstants):
    """Constant table of the law on one scenario."""

    observe_delay: Row = field(metadata=held(UNIT_Q, "Kalman gain of the delay"))
    ending: Row = field(metadata=held(0, "1 in the end phase"))
    stop_by_position: Row = field(metadata=held(STOP_GAIN_Q, "end phase: gain on the position error"))
    stop_by_speed: Row = field(metadata=held(UNIT_Q, "end phase: gain on the speed error"))
    stop_by_force: Row = field(metadata=held(UNIT_Q, "end phase: gain on the error of the acting force"))
    twice: Row = field(metadata=held(UNIT_Q, "actuator over one period, its lag twice"))
    delay_twice: Row = field(metadata=held(UNIT_Q, "actuator over the loop delay, its lag twice"))
    delay_max: Constant = field(metadata=held(UNIT_Q, "largest error of the delay believed"))
    capture_position: Constant = field(metadata=held(GAP_Q, "largest position error of the end phase"))
    capture_speed: Constant = field(metadata=held(SPEED_Q, "largest speed error of the end phase"))
    force_error_max: Constant = field(metadata=held(ACCEL_Q, "largest error of the acting force in the end phase"))
    correction_max: Constant = field(metadata=held(ACCEL_Q, "largest correction of the end phase"))
    tolerance: Constant = field(metadata=held(WHEEL_Q, "survey tolerance as a share of the run"))
    bound_max: Constant = field(metadata=held(WHEEL_Q, "format limit"))
    share_min: Constant = field(metadata=held(SHARE_Q, "share of the run from which balises bound the wheel"))
    half: Constant = field(metadata=held(UNIT_Q, "1/2"))


def _end_phase(p: IpfcPlusStopParameters, scenario: Scenario, speed_kmh: np.ndarray) -> dict[str, ArrayLike]:
    """Rows of the end phase: from the last planned speed above the handover, or the largest one, to the stop."""
    period_s, stop_s = scenario.timing.control_period_ns / 1e9, Target(scenario.target).stop_time_s
    left_s = stop_s - (np.arange(speed_kmh.size, dtype=np.float64) * period_s + p.loop_delay_s)
    before = np.flatnonzero((speed_kmh > p.handover_kmh) & (left_s > 0.0))
    ending = left_s > 0.0
    ending[: before[-1] + 1 if before.size else np.argmax(speed_kmh)] = False
    gains = np.zeros((speed_kmh.size, 3))
    if ending.any():
        weights = StopWeights(p.stop_position_m, p.stop_speed_mps, p.stop_demand_mps2)
        gains[ending] = stop_gains(scenario.train.actuator_pole_per_s, left_s[ending], weights)
    return {
        "ending": ending.astype(np.float64),
        "stop_by_position": gains[:, 0] * _KMH / _01MM,
        "stop_by_speed": gains[:, 1],
        "stop_by_force": gains[:, 2],
    }


def _observer(p: IpfcPlusStopParameters, scenario: Scenario, periods: int) -> dict[str, ArrayLike]:
    """Constants of the observer, which replace or extend the ones of IPFC+."""
    period_s, train = scenario.timing.control_period_ns / 1e9, scenario.train
    now = plan(scenario, np.arange(periods, dtype=np.float64) * period_s, p.drag_fed_forward)
    unknown = StopUncertainty(
        p.gain_sigma,
        p.lag_sigma_s,
        p.delay_sigma_s,
        p.disturbance_sigma_mps2,
        p.disturbance_walk_mps2,
        p.drag_sigma,
        p.speed_noise_mps,
    )
    pole = train.actuator_pole_per_s
    gains = stop_observer_gains(now.force_mps2, now.drag_mps2, pole, period_s, unknown)
    twice = lag_twice(pole, period_s, p.loop_delay_s)
    return {
        "observe_speed": gains[:, 0],
        "observe_disturbance": gains[:, 1],
        "observe_gain": gains[:, 2] * train.force_per_notch_n / train.inertial_mass_kg,
        "observe_lag": gains[:, 3] / _KMH,
        "observe_delay": gains[:, 4] / _KMH,
        "twice": twice.over_period,
        "delay_twice": twice.over_delay,
        "delay_max": p.delay_error_max_s,
    }


def stop_constants(p: IpfcPlusStopParameters, scenario: Scenario) -> IpfcPlusStopConstants:
    """The constant table of a scenario. Raises ``ValueError`` as for IPFC+."""
    base: Mapping[str, ArrayLike] = constant_values(p, scenario)
    distance_m = scenario.plan.distance_m
    added: dict[str, ArrayLike] = {
        "capture_position": p.capture_m * _01MM,
        "capture_speed": p.capture_kmh,
        "force_error_max": FORCE_ERROR_MAX_MPS2 * _KMH,
        "correction_max": p.correction_max_mps2 * _KMH,
        "tolerance": min(p.survey_tolerance_m / distance_m, TOLERANCE_MAX),
        "bound_max": BOUND_MAX,
        "share_min": SHARE_MIN,
        "half": 0.5,
    }
    speed_kmh = np.asarray(base["target_speed"])
    added |= _observer(p, scenario, speed_kmh.size) | _end_phase(p, scenario, speed_kmh)
    return rounded(IpfcPlusStopConstants, {**base, **added})
