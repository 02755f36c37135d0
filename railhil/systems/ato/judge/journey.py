"""A complete recorded run as arrays, and its measurements, each a pure function of the journey.

Definitions: eqs. (4) to (8) of Wang et al., "An improved predictive function control algorithm for velocity curve of
urban rail vehicle", as interpreted in the bench's notes (ITAE in km/h, comfort with the last drop to zero).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from railhil.bus.schedule import Schedule
from railhil.judge.stops import PlannedStop, ScoredStop, scored_stops, standstills_of
from railhil.record.trace import FloatArray
from railhil.systems.ato.judge import measures
from railhil.systems.ato.scenario.model import RunPlan, Scenario
from railhil.systems.ato.scenario.target import Target
from railhil.wire.ato import SimTruth

#: Name of the single stop of this train where stops are listed.
STOP_NAME = "stopping point"


def stop_of(plan: RunPlan, reached: Sequence[tuple[float, float]]) -> ScoredStop:
    """The single stop of a plan, from the milestones ``(instant s, position m)``; a train that also stopped on the way
    is scored at the standstill nearest to its stopping point."""
    wanted = PlannedStop(STOP_NAME, plan.distance_m, plan.stop_error_max_m, plan.running_time_s, plan.time_error_max_s)
    (stop,) = scored_stops([wanted], standstills_of(reached))
    return stop


@dataclass(frozen=True, slots=True)
class Journey:
    """The data of SIM_TRUTH and the milestones of a complete run.

    ``indexing``: ``time`` or ``distance``, by which the law found its set-point. Arrays of shape (n,): ``time_s``
    (increasing), ``position_m``, ``speed_mps``, ``accel_mps2``, ``traction_n``, ``brake_n``.
    """

    scenario: Scenario
    indexing: str
    time_s: FloatArray
    position_m: FloatArray
    speed_mps: FloatArray
    accel_mps2: FloatArray
    traction_n: FloatArray
    brake_n: FloatArray
    stop: ScoredStop


def _samples(scenario: Scenario) -> float:
    """Time between two SIM_TRUTH telegrams in s."""
    timing = scenario.timing
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, scenario.installed_system.contract)
    return schedule.ticks(SimTruth.PORT) * timing.base_tick_ns / 1e9


@dataclass(frozen=True, slots=True)
class ErrorGrid:
    """Samples at which the ITAE compares speed and set-point: every SIM_TRUTH until the end of the timetable.

    ``time_s`` and ``cycle`` (control period of each, from 0) have the shape (n,); ``counts`` (cycles,) is their number
    in each cycle, ``shares`` (cycles,) the part of each cycle in the timetable: 1 except for the last one.
    """

    step_s: float
    period_s: float
    time_s: FloatArray
    cycle: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]
    shares: FloatArray

    @classmethod
    def of(cls, scenario: Scenario) -> ErrorGrid:
        """Grid of a scenario."""
        period_s = scenario.timing.control_period_ns / 1e9
        wanted = round(scenario.plan.running_time_s / period_s, 9)
        cycles = math.ceil(wanted)
        step_s = _samples(scenario)
        samples = math.floor(round(scenario.plan.running_time_s / step_s, 9))
        time_s: FloatArray = np.asarray(np.arange(1, samples + 1) * step_s, dtype=np.float64)
        cycle = np.ceil(np.round(time_s / period_s, 9)).astype(np.int64) - 1
        shares = np.ones(cycles)
        shares[-1] = wanted - (cycles - 1)
        return cls(step_s, period_s, time_s, cycle, np.bincount(cycle, minlength=cycles), shares)


def itae_kmh_s2(run: Journey) -> float:
    """Eq. (4), e in km/h; standstill counts until the end of the timetable."""
    grid, target = ErrorGrid.of(run.scenario), Target(run.scenario.target)
    index = np.minimum(np.searchsorted(run.time_s, grid.time_s - grid.step_s / 2), len(run.time_s) - 1)
    speed = np.where(grid.time_s > run.time_s[-1] + grid.step_s / 2, 0.0, run.speed_mps[index])
    if run.indexing == "distance":
        wanted = np.asarray(target.speed_mps(target.time_s(run.position_m[index])))
    else:
        wanted = np.asarray(target.speed_mps(grid.time_s))
    sums = np.bincount(grid.cycle, weights=measures.error_kmh(wanted, speed), minlength=len(grid.counts))
    return float(measures.itae_kmh_s2(sums, grid.counts, grid.period_s, grid.shares))


def energy_kj(run: Journey) -> float:
    """Eq. (5) until the stop, or until the end of a run without one."""
    stood = run.stop.standstill
    end_s = float(run.time_s[-1]) if stood is None else stood.instant_s
    moving = run.time_s <= end_s
    steps_s = np.diff(run.time_s[moving])

    def work_j(force_n: FloatArray) -> FloatArray:
        power_w = (force_n * run.speed_mps)[moving]
        work: FloatArray = measures.total(measures.work_j(steps_s, power_w[:-1], power_w[1:]))
        return work

    return float(measures.energy_kj(run.scenario.energy, work_j(run.traction_n), work_j(run.brake_n), end_s))


def comfort_mps2_per_km(run: Journey) -> float:
    """Eq. (6), from the first SIM_TRUTH of each control period."""
    period_s = run.scenario.timing.control_period_ns / 1e9
    ticks_s = np.arange(0, int(run.time_s[-1] / period_s) + 1) * period_s
    samples = run.accel_mps2[np.searchsorted(run.time_s, ticks_s - 1e-9)]
    return float(measures.comfort_mps2_per_km(samples, run.scenario.plan.distance_m))
