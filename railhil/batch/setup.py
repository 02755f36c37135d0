"""Makes the tables of the compiled loop from scenarios: once for a case, and once for each train."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.batch import lanes
from railhil.batch.layout import TRAIN, Common, PerTrain
from railhil.bench import coupled_schedule
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import CtlStat, NotchCmd, SimTruth, TrnPos
from railhil.controller_node.loop import POSITION_MAX_01MM, limited_01mm
from railhil.plant_sim import force_tables
from railhil.plant_sim.command_watch import INITIAL, watch_ticks
from railhil.plant_sim.dynamics import lag
from railhil.plant_sim.faults.mismatch import Mismatch
from railhil.plant_sim.faults.plants import constant_mismatches
from railhil.plant_sim.forces import EffortLimit
from railhil.plant_sim.plant import NOTCH_LSB_PER_NOTCH
from railhil.plant_sim.run_end import RunEnd
from railhil.plant_sim.train_checks import slow_decay, train_checks
from railhil.scenarios.model import Effort, Scenario
from railhil.scenarios.perturb import unit_draws, with_draws
from railhil.scenarios.profiles import front_speed_limit
from railhil.scenarios.target import Target
from railhil.supervisor.journey import ErrorGrid

Ints: TypeAlias = NDArray[np.int64]


class TargetPieces(NamedTuple):
    """Pieces of a target curve as arrays, as :class:`railhil.scenarios.target.Target` computes them; ``moving``:
    pieces that begin before the stop."""

    time_s: Any
    accel_mps2: Any
    jerk_mps3: Any
    speed_mps: Any
    position_m: Any
    stop_time_s: float
    stop_position_m: float
    moving: int


@dataclass(frozen=True, slots=True)
class Times:
    """Schedule of any run of a scenario.

    ``steps``, ``ends`` and ``periods`` are, for each control period, its first poll, the first poll of the next one,
    and its number, shape (steps,), the polls in ticks; the last period ends when all runs have ended.
    ``control_columns`` gives for each control tick of the score the column of the kept accelerations.
    """

    schedule: Schedule
    last_tick: int
    after_stop_ticks: int
    steps: Ints
    ends: Ints
    periods: Ints
    truth_s: NDArray[np.float64]
    control_columns: Ints
    control_sample: Ints

    @classmethod
    def of(cls, scenario: Scenario) -> Times:
        """Times of a scenario; perturbations do not change them."""
        timing = scenario.timing
        tick_ns, period_ns = timing.base_tick_ns, timing.control_period_ns
        schedule = coupled_schedule(scenario)
        run_end = RunEnd(scenario)
        last_tick, after_stop = run_end.last_tick, run_end.after_stop_ticks
        end = last_tick + 1 + after_stop
        polls = np.arange(0, end + 1, schedule.ticks(NotchCmd.PORT), dtype=np.int64)
        periods = polls * tick_ns // period_ns
        first = np.diff(periods, prepend=-1) > 0
        truth_s = np.arange(0, end + 1, schedule.ticks(SimTruth.PORT)) * tick_ns / 1e9
        period_s = period_ns / 1e9
        # Determined as in the score.
        wanted_s = np.arange(0, int(truth_s[-1] / period_s) + 1) * period_s
        samples = np.minimum(np.searchsorted(truth_s, wanted_s - 1e-9), truth_s.size - 1)
        kept, columns = np.unique(samples, return_inverse=True)
        control_sample = np.full(truth_s.size, -1, dtype=np.int64)
        control_sample[kept] = np.arange(kept.size)
        steps, ends = polls[first], np.append(polls[first][1:], end + 1)
        return cls(schedule, last_tick, after_stop, steps, ends, periods[first], truth_s, columns, control_sample)


def _effort(effort: Effort) -> EffortLimit:
    table = force_tables.effort_table(effort)
    return table._replace(curve_mps=np.array(table.curve_mps), curve_n=np.array(table.curve_n))  # type: ignore[arg-type]


def common(scenario: Scenario, by_distance: bool, times: Times) -> Common:
    """The data common to all trains, from the nominal scenario."""
    train, timing = scenario.train, scenario.timing
    grid = ErrorGrid.of(scenario)
    target = Target(scenario.target)
    limit = front_speed_limit(scenario.line, train)
    cycle = np.full(grid.time_s.size + 1, -1, dtype=np.int64)
    cycle[1:] = grid.cycle
    return Common(
        step_s=timing.base_tick_ns * 1e-9,
        truth_ticks=times.schedule.ticks(SimTruth.PORT),
        position_ticks=times.schedule.ticks(TrnPos.PORT),
        notch_ticks=times.schedule.ticks(NotchCmd.PORT),
        last_tick=times.last_tick,
        after_stop_ticks=times.after_stop_ticks,
        notch_max_code=round(train.notch_max * NOTCH_LSB_PER_NOTCH),
        traction=_effort(train.traction),
        brake=_effort(train.brake),
        limits=watch_ticks(scenario.watch, timing.base_tick_ns),
        checks=train_checks(scenario),
        grade_from_m=force_tables.grade_rows(scenario.line.grade_permil, train.length_m)[0],
        front_limit_from_m=np.array([row[0] for row in limit]),
        front_limit_mps=np.array([row[1] for row in limit]),
        overspeed_margin_mps=scenario.watch.overspeed_margin_mps,
        service_mps2=train.service_braking_mps2,
        speed_lsb_mps=scenario.sensors.speed_lsb_mps,
        odometer_lsb_m=scenario.sensors.odometer_lsb_m,
        line_limits=np.array(scenario.line.speed_limit_mps),
        length_m=train.length_m,
        by_distance=by_distance,
        truth_s=times.truth_s,
        wanted_mps=np.concatenate(([0.0], target.speed_mps(grid.time_s))),
        cycle=cycle,
        control_sample=times.control_sample,
        target=TargetPieces(
            target._time,
            target._accel,
            target._jerk,
            target._speed,
            target._position,
            target.stop_time_s,
            target.stop_position_m,
            int(np.count_nonzero(target._time < target.stop_time_s)),
        ),
    )


@dataclass(frozen=True, slots=True)
class BalisePasses:
    """Balises of N trains in the order of passing.

    ``true_m`` has the shape (N, balises). The others are inputs of the law, with a first column of zeros for "none
    passed": (N, balises + 1).
    """

    true_m: NDArray[np.float64]
    number: Ints
    surveyed_01mm: Ints
    passing_01mm: Ints


@dataclass(frozen=True, slots=True)
class Trains:
    """N trains at rest at tick 0, in the order of their lanes; balises in the order of the seeds."""

    records: NDArray[Any]
    tables: PerTrain
    balises: BalisePasses


def trains(scenario: Scenario, seeds: Sequence[int], drawn: bool, times: Times, cycles: int) -> Trains:
    """The trains of some seeds, made together from a scenario whose perturbed quantities are arrays."""
    count, timing = len(seeds), scenario.timing
    actual = scenario
    if drawn:
        actual = with_draws(scenario, list(np.array([unit_draws(scenario, seed) for seed in seeds]).T))
    if scenario.faults:
        actual = Mismatch.over(constant_mismatches(scenario, seeds)).applied(actual)
    train, sensors = actual.train, actual.sensors
    records = np.zeros(count, dtype=TRAIN)
    constants = force_tables.train_constants(train)
    for name in ("mass_kg", "resistance_a_n", "resistance_b_n_per_mps", "resistance_c_n_per_mps2"):
        records[name] = getattr(constants, name)
    records["grade_n_per_permil"], records["pole_per_s"] = constants.grade_n_per_permil, constants.pole_per_s
    full = [lag(pole, timing.base_tick_ns * 1e-9) for pole in records["pole_per_s"].tolist()]
    records["lag_decay"], records["lag_mean"] = [one.decay for one in full], [one.mean for one in full]
    step_s = timing.base_tick_ns * 1e-9
    checks = train_checks(scenario)
    records["slow_decay"] = [slow_decay(checks, pole, step_s) for pole in records["pole_per_s"].tolist()]
    records["left_n"] = inf
    records["force_per_notch_n"] = train.force_per_notch_n
    records["wheel_factor"], records["noise_sigma_mps"] = sensors.wheel_factor, sensors.speed_noise_sigma_mps
    records["delay_ticks"] = actual.timing.loop_delay_s * 1e9 / timing.base_tick_ns
    records["watch_brake_mps2"] = train.service_braking_mps2
    records["brake_min_n"] = records["watch_brake_mps2"] * records["mass_kg"]
    # The limit is looked up in the first tick.
    records["limit_to_m"] = -inf
    records["level"] = INITIAL.level
    for name in ("stop_tick", "emergency_01ms"):
        records[name] = -1
    _, permil, permil_per_m = force_tables.grade_rows(actual.line.grade_permil, train.length_m)
    # A notch is delayed by at most the loop delay, and there is one new notch per control period.
    slots = ceil(records["delay_ticks"].max() * timing.base_tick_ns / timing.control_period_ns) + 2
    balises = _balises(actual, records["wheel_factor"])
    # In a block of similar delays, notches begin to act in the same ticks.
    order = np.argsort(records["delay_ticks"], kind="stable")
    tables = PerTrain(
        np.broadcast_to(permil, (count, permil.shape[-1]))[order],
        np.broadcast_to(permil_per_m, (count, permil.shape[-1]))[order],
        balises.true_m[order],
        np.zeros((count, slots)),
        np.zeros((count, slots), dtype=np.int64),
        np.zeros((cycles, count)),
        np.zeros((count, int(times.control_columns.max()) + 1), dtype=np.int64),
        order,
        _empty_lanes(count),
        np.zeros((4, count), dtype=np.int64),
    )
    return Trains(records[order], tables, balises)


def _empty_lanes(count: int) -> NDArray[np.float64]:
    """Blocks without trains: numbers with which a lane can be computed, and nothing comes of it."""
    blocks = np.ones((-(-count // lanes.LANES), lanes.SIZE))
    blocks[:, lanes.CALM : lanes.CALM + lanes.LANES] = 0.0
    return blocks


def _balises(actual: Scenario, wheel_factor: NDArray[np.float64]) -> BalisePasses:
    """Balises of all trains; a position is one number for all or an array."""
    rows, shape = actual.line.balises, (len(actual.line.balises), wheel_factor.size)
    true_m = np.empty(shape)
    for row, balise in enumerate(rows):
        true_m[row] = balise.true_m
    numbers = np.array([balise.number for balise in rows], dtype=np.int64)
    surveyed = np.array([limited_01mm(round(balise.surveyed_m * 1000)) for balise in rows], dtype=np.int64)
    order = np.lexsort((np.broadcast_to(numbers[:, None], shape), true_m), axis=0)
    true_m = np.take_along_axis(true_m, order, axis=0).T.copy()
    # Rounded as in the train's balise reader.
    passing_mm = np.rint(true_m * wheel_factor[:, None] * 1000).astype(np.int64)
    passing = np.clip(passing_mm * 10, -POSITION_MAX_01MM, POSITION_MAX_01MM)

    def behind_none(values: Ints) -> Ints:
        return np.concatenate((np.zeros((wheel_factor.size, 1), dtype=np.int64), values), axis=1)

    return BalisePasses(true_m, *(behind_none(values) for values in (numbers[order].T, surveyed[order].T, passing)))


def status_tick(times: Times, tick: int, end_tick: int) -> int:
    """Tick of the first CTL_STAT that reports an event of ``tick``: a regular poll, or the one at the end."""
    period = times.schedule.ticks(CtlStat.PORT)
    return min(-(-tick // period) * period, end_tick)
