"""Makes the tables of the compiled loop from scenarios: once for a case, and once for each train."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.bus.schedule import Schedule
from railhil.controller_node.ato.control_loop import POSITION_MAX_01MM, limited_01mm
from railhil.plant_sim.ato import force_tables
from railhil.plant_sim.ato.command_watch import INITIAL, watch_ticks
from railhil.plant_sim.ato.dynamics import lag
from railhil.plant_sim.ato.faults.mismatch import Mismatch, constant_mismatches
from railhil.plant_sim.ato.forces import EffortLimit
from railhil.plant_sim.ato.plant import NOTCH_LSB_PER_NOTCH
from railhil.plant_sim.ato.train import RunEnd
from railhil.plant_sim.ato.train_checks import slow_decay, train_checks
from railhil.scenarios.profiles import find_lowest, grade_rows
from railhil.scenarios.streams import Chain
from railhil.systems.ato.batch import lanes as at
from railhil.systems.ato.batch.layout import Common, PerTrain
from railhil.systems.ato.coupled import coupled_schedule
from railhil.systems.ato.judge.journey import ErrorGrid
from railhil.systems.ato.scenario.model import Effort, Scenario
from railhil.systems.ato.scenario.perturb import apply_draws, unit_draws, unit_numbers
from railhil.systems.ato.scenario.target import Target
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth, TrnPos

Ints: TypeAlias = NDArray[np.int64]


class TargetPieces(NamedTuple):
    """Pieces of a target curve as arrays, as :class:`~railhil.systems.ato.scenario.target.Target` computes them;
    ``moving``: pieces that begin before the stop."""

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
    limit = find_lowest(scenario.line.speed_limit_mps, train.length_m, train.speed_limit_mps)
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
        grade_from_m=grade_rows(scenario.line.grade_permil, train.length_m)[0],
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
        side_by_side=True,
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

    tables: PerTrain
    balises: BalisePasses

    def column(self, quantity: int) -> NDArray[np.float64]:
        """A quantity of :mod:`railhil.systems.ato.batch.lanes` of all trains, shape (N,)."""
        count = self.tables.order.size
        return np.array(self.tables.blocks[:, quantity : quantity + at.LANES].reshape(-1)[:count])


@dataclass(frozen=True, slots=True)
class Vectors:
    """N runs as vectors, which replace the random numbers of their seeds.

    :param draws: standard normal numbers, shape (N, draws), as the ``draws`` of a scenario.
    :param noise: of each run, as the ``noise`` of a scenario, but the squares of its coefficients are not checked.
    """

    draws: NDArray[np.float64]
    noise: Sequence[Chain]


def trains(
    scenario: Scenario, seeds: Sequence[int], drawn: bool, times: Times, cycles: int, vectors: Vectors | None = None
) -> Trains:
    """The trains of some seeds, made together from a scenario whose perturbed quantities are arrays.

    :param vectors: draws of these trains, instead of those of their seeds.
    """
    count, timing = len(seeds), scenario.timing
    actual = scenario
    if vectors is not None:
        actual = apply_draws(scenario, list(unit_numbers(vectors.draws).T))
    elif drawn or scenario.draws:
        actual = apply_draws(scenario, list(np.array([unit_draws(scenario, seed) for seed in seeds]).T))
    if scenario.faults:
        actual = Mismatch.over(
            constant_mismatches(scenario, seeds, None if vectors is None else vectors.draws)
        ).applied(actual)
    train, sensors = actual.train, actual.sensors
    constants = force_tables.train_constants(train)
    step_s, checks = timing.base_tick_ns * 1e-9, train_checks(scenario)
    poles = np.broadcast_to(constants.pole_per_s, count).tolist()
    full = [lag(pole, step_s) for pole in poles]
    delay_ticks = np.broadcast_to(actual.timing.loop_delay_s * 1e9 / timing.base_tick_ns, count)
    wheel_factor = np.broadcast_to(np.asarray(sensors.wheel_factor, dtype=np.float64), count)
    numbers = {
        at.MASS: constants.mass_kg,
        at.RESISTANCE_A: constants.resistance_a_n,
        at.RESISTANCE_B: constants.resistance_b_n_per_mps,
        at.RESISTANCE_C: constants.resistance_c_n_per_mps2,
        at.GRADE_N: constants.grade_n_per_permil,
        at.POLE: poles,
        at.LAG_DECAY: [one.decay for one in full],
        at.LAG_MEAN: [one.mean for one in full],
        at.SLOW_DECAY: [slow_decay(checks, pole, step_s) for pole in poles],
        at.FORCE_PER_NOTCH: train.force_per_notch_n,
        at.WHEEL: wheel_factor,
        at.NOISE: sensors.speed_noise_sigma_mps,
        at.DELAY_TICKS: delay_ticks,
        at.LEVEL: INITIAL.level,
        at.WATCH_BRAKE: train.service_braking_mps2,
        at.BRAKE_MIN: train.service_braking_mps2 * constants.mass_kg,
        at.LEFT: inf,
        # The limit is looked up in the first tick.
        at.LIMIT_TO: -inf,
        at.DUE: inf,
        at.STOP_TICK: -1,
        at.EMERGENCY_01MS: -1,
    }
    _, permil, permil_per_m = grade_rows(actual.line.grade_permil, train.length_m)
    # A notch is delayed by at most the loop delay, and there is one new notch per control period.
    slots = ceil(delay_ticks.max() * timing.base_tick_ns / timing.control_period_ns) + 2
    balises = _balises(actual, wheel_factor)
    # In a block of similar delays, notches begin to act in the same ticks.
    order = np.argsort(delay_ticks, kind="stable")
    tables = PerTrain(
        np.broadcast_to(permil, (count, permil.shape[-1]))[order],
        np.broadcast_to(permil_per_m, (count, permil.shape[-1]))[order],
        balises.true_m[order],
        np.zeros((count, slots)),
        np.zeros((count, slots), dtype=np.int64),
        np.zeros((cycles, count)),
        np.zeros((count, int(times.control_columns.max()) + 1), dtype=np.int64),
        order,
        _blocks({place: np.broadcast_to(values, count)[order] for place, values in numbers.items()}, count),
        np.zeros((4, count), dtype=np.int64),
    )
    return Trains(tables, balises)


def _blocks(numbers: dict[int, NDArray[Any]], count: int) -> NDArray[np.float64]:
    """The numbers of all trains, zero where none is given. A lane without a train has ended."""
    blocks = np.zeros((-(-count // at.LANES), at.SIZE))
    blocks[:, at.ENDED : at.ENDED + at.LANES] = 1.0
    # A divisor, and ends of a row.
    for place in (at.MASS, at.TRACTION_TO, at.BRAKE_TO):
        blocks[:, place : place + at.LANES] = 1.0
    for place, values in {**numbers, at.ENDED: np.zeros(count)}.items():
        for block, first in enumerate(range(0, count, at.LANES)):
            part = values[first : first + at.LANES]
            blocks[block, place : place + part.size] = part
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
