"""Offline part of IPFC+ and its end phase: quantities tabulated over the control period before a run, in SI units.

Between two control periods the train is modelled as the lag of its actuator and an integrator; everything else that
acts on it (running resistance, grade) is known along the timetable and enters the feed-forward. The law's gains
therefore depend only on time, and no matrix computation remains during the run.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhil.controller_node.ato.pfc_model import Matrix, morlet
from railhil.scenarios.profiles import MeanGrade
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import Target

#: Scale and shift (s) of the wavelets of IPFC.
_WAVELETS = ((1.0, 0.0), (2.0, 5.0))

#: Perturbed runs on which the defaults of the law were chosen and checked: name of the scenario, seeds.
DESIGN_SEEDS = dict.fromkeys(
    (
        "lvshun_tieshan",
        "lvshun_tieshan_worn_wheels",
        "yizhuang_01_songjiazhuang_xiaocun",
        "yizhuang_02_xiaocun_xiaohongmen",
        "yizhuang_03_xiaohongmen_jiugong",
        "yizhuang_04_jiugong_yizhuang_qiao",
        "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan",
        "yizhuang_06_yizhuang_wenhuayuan_wanyuan_jie",
        "yizhuang_07_wanyuan_jie_rongjing_dongjie",
        "yizhuang_08_rongjing_dongjie_rongchang_dongjie",
        "yizhuang_09_rongchang_dongjie_tongji_nanlu",
        "yizhuang_10_tongji_nanlu_jinghai_lu",
        "yizhuang_11_jinghai_lu_ciqu_nan",
        "yizhuang_12_ciqu_nan_ciqu",
        "yizhuang_13_ciqu_yizhuang_railway_station",
    ),
    range(200),
)


@dataclass(frozen=True)
class PlannedRun:
    """The planned run at the instants ``times_s`` (arrays of their shape): the requirements on the actuator.

    ``force_mps2`` is the target acceleration plus ``drag_mps2``, from running resistance and grade, both per inertial
    mass. ``traction_n`` and ``brake_n`` are the available forces at the speed.
    """

    times_s: Matrix
    position_m: Matrix
    speed_mps: Matrix
    drag_mps2: Matrix
    force_mps2: Matrix
    traction_n: Matrix
    brake_n: Matrix


def plan(scenario: Scenario, times_s: Matrix, drag_known: bool = True) -> PlannedRun:
    """The target curve with the forces that the nominal train needs on the nominal line.

    After the stop the last deceleration continues, position and speed run backwards, and the drag stays at its value at
    standstill. ``drag_known`` False: drag is taken as zero.
    """
    train, target = scenario.train, Target(scenario.target)
    position_m, speed_mps = target.position_m(times_s), target.speed_mps(times_s)
    front_m = np.where(times_s < target.stop_time_s, position_m, target.stop_position_m)
    forward_mps = np.maximum(speed_mps, 0.0)
    grade_permil = MeanGrade(scenario.line.grade_permil, train.length_m)(front_m)
    drag = resistance_n(train, forward_mps, grade_permil) / train.inertial_mass_kg * float(drag_known)
    return PlannedRun(
        times_s,
        position_m,
        speed_mps,
        drag,
        target.accel_mps2(times_s) + drag,
        force_limit_n(train.traction, forward_mps),
        force_limit_n(train.brake, forward_mps),
    )


@dataclass(frozen=True)
class Uncertainty:
    """Assumptions of the observer: standard deviations of the unknowns at the start, a random walk, noise.

    ``gain`` relative, ``lag_s`` of the actuator and the loop together, ``disturbance_mps2`` and its random walk per
    square root of a second, ``noise_mps`` of one speed reading.
    """

    gain: float
    lag_s: float
    disturbance_mps2: float
    disturbance_walk_mps2: float
    noise_mps: float


def observer_gains(force_mps2: Matrix, period_s: float, uncertainty: Uncertainty) -> Matrix:
    """Kalman gains of [speed, disturbance, relative gain, lag] along the plan; shape (periods, 4).

    Units: 1, 1/s, s/m, s^2/m. The prediction error of a speed over one period is linear in the unknowns: a wrong gain
    scales the force, a wrong lag shifts it in time, a disturbance adds to it.
    """
    u = uncertainty
    covariance = np.diag([u.noise_mps**2, u.disturbance_mps2**2, u.gain**2, u.lag_s**2])
    walk = np.diag([0.0, u.disturbance_walk_mps2**2, 0.0, 0.0]) * period_s
    gains = np.zeros((force_mps2.size, 4))
    for k in range(force_mps2.size):
        if k > 0:
            change = np.eye(4)
            change[0, 1:] = (
                period_s,
                period_s * (force_mps2[k] + force_mps2[k - 1]) / 2,
                force_mps2[k - 1] - force_mps2[k],
            )
            covariance = change @ covariance @ change.T + walk
        gains[k] = covariance[:, 0] / (covariance[0, 0] + u.noise_mps**2)
        covariance = covariance - np.outer(gains[k], covariance[0])
    return gains


def basis_functions(name: str, horizon: int, period_s: float) -> Matrix:
    """Basis functions at i = 0..horizon-1, shape (functions, horizon).

    ``step``; ``ramp``: step and ramp; ``wavelets``: step and the two wavelets of IPFC.
    """
    periods = np.arange(horizon, dtype=np.float64)
    if name == "wavelets":
        return np.vstack([np.ones(horizon), *(morlet(scale, b, 0.5, periods * period_s) for scale, b in _WAVELETS)])
    return np.vstack([np.ones(horizon), periods])[: 1 if name == "step" else 2]


def replanning_gains(
    weights: Matrix, pole_per_s: float, fit_points: tuple[int, ...], period_s: float, left_s: Matrix
) -> Matrix:
    """Gains on [position error, speed error, error of the acting force] with the time left to remove them.

    The speed error should follow e_v (1 - s/R) - q s (R - s), q = 6 (e_x + e_v R / 2) / R^3, which is zero at s = R
    together with the position error. d(h) at a fitting point is the required reduction of the error beyond what it
    loses by itself, and u = U . d (eq. 19 of the IPFC paper).

    :param weights: U of the drag-free train (acceleration in, speed out), shape (fitting points,).
    :param left_s: R, shape (periods,).
    :returns: accelerations per unit of each error, 1/s^2, 1/s and 1, shape (periods, 3).
    """
    at_s = np.array(fit_points) * period_s
    left = left_s[:, None]
    inside = np.maximum(left - at_s, 0.0)
    by_position = 6 / left**3 * at_s * inside
    by_speed = np.minimum(at_s, left) / left + 3 / left**2 * at_s * inside
    by_force = (1 - np.exp(-pole_per_s * at_s)) / pole_per_s
    return np.column_stack([by_position @ weights, by_speed @ weights, np.full(left_s.size, by_force @ weights)])


@dataclass(frozen=True)
class ActuatorWeights:
    """Actuator with pole p between two control periods, as weights on [lagged notch, notch before, notch now].

    A notch acts ``delay_s`` after its control period begins. ``over_period``: the lagged notch one period later, and
    its integral; ``over_delay``: the same until the notch now begins to act, weights on [lagged notch, notch before].
    """

    over_period: tuple[tuple[float, float, float], tuple[float, float, float]]
    over_delay: tuple[tuple[float, float], tuple[float, float]]


def lag(pole_per_s: float, period_s: float, delay_s: float) -> ActuatorWeights:
    """Exact for notches that are constant between the instants at which they begin to act."""

    def part(length_s: float) -> tuple[float, float]:
        decay = math.exp(-pole_per_s * length_s)
        return decay, (1 - decay) / pole_per_s

    first, first_sum = part(delay_s)
    rest_s = period_s - delay_s
    rest, rest_sum = part(rest_s)
    lagged = (first * rest, (1 - first) * rest, 1 - rest)
    integral = (
        first_sum + first * rest_sum,
        delay_s - first_sum + (1 - first) * rest_sum,
        rest_s - rest_sum,
    )
    return ActuatorWeights((lagged, integral), ((first, 1 - first), (first_sum, delay_s - first_sum)))


@dataclass(frozen=True)
class StopWeights:
    """Deviations that count as much as each other: position and speed at the planned stop, demand held for 1 s."""

    position_m: float
    speed_mps: float
    demand_mps2: float


def stop_gains(pole_per_s: float, left_s: Matrix, weights: StopWeights) -> Matrix:
    """Gains on the deviations of position, speed and acting force; shape (periods, 3), units 1/s^2, 1/s and 1.

    Between two control periods the deviations from the plan obey, with actuator pole p, acting force f and demanded
    force u (all as accelerations), for a period h::

        f' = e f + (1 - e) u      v' = v + A f + (h - A) u      x' = x + h v + B f + (h^2 / 2 - B) u
        e = exp(-p h)             A = (1 - e) / p               B = (h - A) / p

    The commands already on their way are inside f. The stopping place depends on x, v and f at the aim alone, so the
    gains follow backwards from the stop by the finite-horizon linear quadratic regulator (Riccati recursion, e.g.
    Bryson and Ho 1975, section 2.6).

    :param left_s: time left to the planned stop when the notch of each period begins to act, falling, above 0.
    """
    cost = np.diag([weights.position_m**-2, weights.speed_mps**-2, 0.0])
    gains = np.zeros((left_s.size, 3))
    until_s = np.append(left_s[1:], 0.0)
    for k in range(left_s.size - 1, -1, -1):
        h = float(left_s[k] - until_s[k])
        decay = math.exp(-pole_per_s * h)
        once = (1 - decay) / pole_per_s
        twice = (h - once) / pole_per_s
        free = np.array([[1.0, h, twice], [0.0, 1.0, once], [0.0, 0.0, decay]])
        forced = np.array([h * h / 2 - twice, h - once, 1 - decay])
        by_demand = forced @ cost
        gains[k] = by_demand @ free / (h * weights.demand_mps2**-2 + by_demand @ forced)
        cost = free.T @ cost @ (free - np.outer(forced, gains[k]))
        cost = (cost + cost.T) / 2
    return gains


@dataclass(frozen=True)
class StopUncertainty:
    """Assumptions of the observer: standard deviations of the unknowns at the start, a random walk, noise.

    ``gain`` relative, ``lag_s`` of the actuator's time constant, ``delay_s`` of the loop, ``disturbance_mps2``; its
    random walk per square root of a second, and as a share ``drag`` of each change of the planned drag (resistance and
    grade that are not quite those of the plan); ``noise_mps`` of one speed reading.
    """

    gain: float
    lag_s: float
    delay_s: float
    disturbance_mps2: float
    disturbance_walk_mps2: float
    drag: float
    noise_mps: float


def lagged_force(force_mps2: Matrix, pole_per_s: float, period_s: float) -> Matrix:
    """A force that is linear between the control periods, after a lag that begins at rest; shape (periods,)."""
    decay = math.exp(-pole_per_s * period_s)
    lagged = np.zeros_like(force_mps2)
    for k in range(1, force_mps2.size):
        behind = (force_mps2[k] - force_mps2[k - 1]) / (period_s * pole_per_s)
        lagged[k] = force_mps2[k] - behind * (1 - decay) + (lagged[k - 1] - force_mps2[k - 1]) * decay
    return lagged


def stop_observer_gains(
    force_mps2: Matrix, drag_mps2: Matrix, pole_per_s: float, period_s: float, uncertainty: StopUncertainty
) -> Matrix:
    """Kalman gains of [speed, disturbance, relative gain, lag, delay] along the plan; shape (periods, 5).

    An actuator of time constant 1/p + l behind an additional delay t turns a notch u into a force; with m = u after the
    nominal lag p / (s + p), and mm = m after the same lag once more, to the first order in l and t::

        u e^(-t s) / ((1/p + l) s + 1) = m - l p (m - mm) - t m'       p (m - mm) = mm'

    Both shift a steadily rising force by l + t, but they differ in how a change of the rise shows, and a train's last
    seconds are such a change.

    Units: 1, 1/s, s/m, s^2/m, s^2/m. As :func:`~railhil.controller_node.ato.ipfc_plus_design.observer_gains`, but
    time constant and delay are two unknowns, and the disturbance wanders where the planned drag changes.

    :param force_mps2: planned force at the beginning of each period, ``drag_mps2`` the drag in it, shape (periods,).
    """
    u = uncertainty
    lagged = lagged_force(force_mps2, pole_per_s, period_s)
    covariance = np.diag([u.noise_mps**2, u.disturbance_mps2**2, u.gain**2, u.lag_s**2, u.delay_s**2])
    gains = np.zeros((force_mps2.size, 5))
    for k in range(force_mps2.size):
        if k > 0:
            change = np.eye(5)
            change[0, 1:] = (
                period_s,
                period_s * (force_mps2[k] + force_mps2[k - 1]) / 2,
                lagged[k - 1] - lagged[k],
                force_mps2[k - 1] - force_mps2[k],
            )
            covariance = change @ covariance @ change.T
            change_mps2 = u.drag * (drag_mps2[k] - drag_mps2[k - 1])
            covariance[1, 1] += u.disturbance_walk_mps2**2 * period_s + change_mps2**2
        gains[k] = covariance[:, 0] / (covariance[0, 0] + u.noise_mps**2)
        covariance = covariance - np.outer(gains[k], covariance[0])
        covariance = (covariance + covariance.T) / 2
    return gains


@dataclass(frozen=True)
class TwiceWeights:
    """The notch after two lags, as weights: ``over_period`` on [itself, lagged notch, notch before, notch now], one
    period later; ``over_delay`` on [itself, lagged notch, notch before], when the notch now begins to act."""

    over_period: tuple[float, float, float, float]
    over_delay: tuple[float, float, float]


def lag_twice(pole_per_s: float, period_s: float, delay_s: float) -> TwiceWeights:
    """Exact for notches that are constant between the instants at which they begin to act."""

    def part(length_s: float) -> tuple[float, float]:
        decay = math.exp(-pole_per_s * length_s)
        return decay, pole_per_s * length_s * decay

    first, first_once = part(delay_s)
    rest, rest_once = part(period_s - delay_s)
    before = rest * (1 - first - first_once) + rest_once * (1 - first)
    once = rest * first_once + rest_once * first
    return TwiceWeights(
        (rest * first, once, before, 1 - rest * first - once - before),
        (first, first_once, 1 - first - first_once),
    )
