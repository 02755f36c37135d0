"""The tick loop of many trains as machine code, for one control period at a time.

It repeats the order defined in :mod:`railhil.plant_sim.cycle`, and ``Plant.advance``: each pass of the loop handles the
end of the run at a tick, watch and motion, then, at the next tick, the readings that are due. The law is computed
before the pass that begins a control period. The bus is healthy: every command is accepted. Trains without other events
than motion are computed side by side (:mod:`railhil.systems.ato.batch.side_by_side`), every other one by itself
(:mod:`railhil.systems.ato.batch.train`); the tests of the batch compare both with ``coupled_run`` and the nodes.
"""

from __future__ import annotations

from math import inf
from typing import Any

from railhil.batch import compiled
from railhil.common.compilable import larger, smaller
from railhil.common.held_code import place_of
from railhil.plant_sim.ato import command_watch, dynamics, forces, plant, plant_readings, train_checks
from railhil.plant_sim.ato.command_watch import (
    GOOD_AFTER_SERVICE_BRAKE,
    CommandWatchState,
    watch_step,
)
from railhil.plant_sim.ato.dynamics import lag
from railhil.plant_sim.ato.plant import SLIVER_TICKS
from railhil.systems.ato.batch import curve, lanes, layout, rows, side_by_side, train
from railhil.systems.ato.batch import lanes as at
from railhil.systems.ato.batch.lanes import LANES
from railhil.systems.ato.judge import measures
from railhil.systems.ato.judge.measures import error_kmh
from railhil.systems.ato.scenario import target
from railhil.wire.ato import WatchLevel

#: Sources of the machine code.
_LOOPS = (curve, lanes, layout, rows, side_by_side, train)
_PLANT = (command_watch, dynamics, forces, plant, plant_readings, train_checks, target, measures)
_SOURCES = (__file__, *_LOOPS, *_PLANT, str(place_of("dbc") / "ports.toml"))

#: Compiled, a level is a number.
_NORMAL: Any = int(WatchLevel.NORMAL)


@compiled.part
def _set_part(s: Any, i: int, part_at: int) -> None:
    """The part of a tick that is computed next; ``part_at``: the first of its three quantities."""
    s[at.PART_S + i], s[at.PART_DECAY + i] = s[part_at + i], s[part_at + LANES + i]
    s[at.PART_MEAN + i] = s[part_at + 2 * LANES + i]


@compiled.part
def _divide(s: Any, i: int, part_at: int, ticks: float, step_s: float) -> None:
    """The factors of a part of a tick; usually they equal the factors of the period before."""
    part_s = ticks * step_s if ticks > SLIVER_TICKS else 0.0
    if ticks == 1.0:
        s[part_at + LANES + i], s[part_at + 2 * LANES + i] = s[at.LAG_DECAY + i], s[at.LAG_MEAN + i]
    elif part_s > 0.0 and part_s != s[part_at + i]:
        found = lag(s[at.POLE + i], part_s)
        s[part_at + LANES + i], s[part_at + 2 * LANES + i] = found.decay, found.mean
    s[part_at + i] = part_s


@compiled.aside
def _whole_ticks(step_s: float, s: Any) -> None:
    for i in range(LANES):
        s[at.PART_S + i], s[at.PART_DECAY + i] = step_s, s[at.LAG_DECAY + i]
        s[at.PART_MEAN + i] = s[at.LAG_MEAN + i]


@compiled.aside
def _begin_split(step_s: float, s: Any, count: int, tick: int) -> None:
    """The first parts of a tick in which the notches of some trains begin to act."""
    for i in range(count):
        due = s[at.DUE + i]
        if due <= tick + 1 and s[at.ORDINARY + i] > 0.0:
            ticks = larger(due - tick, 0.0)
            _divide(s, i, at.FIRST_S, ticks, step_s)
            s[at.SECOND_TICKS + i] = tick + 1 - due if ticks > SLIVER_TICKS else 1.0
            _divide(s, i, at.SECOND_S, s[at.SECOND_TICKS + i], step_s)
            _set_part(s, i, at.FIRST_S)


@compiled.part
def _end_split(common: Any, tables: Any, numbers: Any, s: Any, first: int, count: int, tick: int) -> None:
    """The second parts, with the notches that act."""
    for i in range(LANES):
        s[at.PART_S + i] = 0.0
    for i in range(count):
        # A train that was computed by itself has taken its notch already.
        if s[at.ORDINARY + i] > 0.0 and s[at.TICK_LEFT + i] == 0.0 and s[at.DUE + i] <= tick + 1:
            train.take_notch(tables, first + i, s, i)
            _set_part(s, i, at.SECOND_S)
    if side_by_side.move(numbers, s) > 0:
        for i in range(count):
            if s[at.TICK_LEFT + i] > 0.0:
                ticks = s[at.SECOND_TICKS + i]
                train.move(common, tables, first + i, s, i, tick, tick + 1 - ticks, ticks)
                rows.look_up(common, tables, first + i, s, i)


@compiled.side_by_side
def _next_due(s: Any) -> float:
    """The instant in ticks at which the next notch of a running train of a block begins to act; infinite: none."""
    found = inf
    for i in range(LANES):
        due = s[at.DUE + i]
        found = due if (due < found) & (s[at.ENDED + i] == 0.0) else found
    return found


@compiled.part
def _tick(common: Any, tables: Any, numbers: Any, s: Any, first: int, count: int, tick: int, due: float) -> float:
    """A tick of a block; the instant at which the next notch begins to act.

    :param due: the instant of the next one before it.
    """
    polled, look_due = tick % common.notch_ticks == 0, tick % common.checks.look_ticks == 0
    # The watch of a train in normal motion. Every train gets every command, so they all have its age.
    state = CommandWatchState(_NORMAL, int(s[at.BLOCK_AGE]), GOOD_AFTER_SERVICE_BRAKE)
    watch = watch_step(common.limits, state, polled, _NORMAL, True, True, False)
    if watch.level != _NORMAL:
        for i in range(count):
            if s[at.ORDINARY + i] > 0.0:
                s[at.AGE + i], s[at.ORDINARY + i] = s[at.BLOCK_AGE], 0.0
    if look_due:
        side_by_side.look(numbers, s)
    if due <= tick + 1:
        _begin_split(common.step_s, s, count, tick)
    if side_by_side.advance(numbers, s, look_due) > 0:
        for i in range(count):
            if s[at.TICK_LEFT + i] > 0.0:
                if s[at.ORDINARY + i] > 0.0:
                    s[at.AGE + i] = s[at.BLOCK_AGE]
                looks = look_due and s[at.LOOK_LEFT + i] > 0.0
                train.advance(common, tables, first + i, s, i, tick, polled, looks)
                rows.look_up(common, tables, first + i, s, i)
    if due <= tick + 1:
        _end_split(common, tables, numbers, s, first, count, tick)
        _whole_ticks(common.step_s, s)
        due = _next_due(s)
    s[at.BLOCK_AGE] = watch.age_ticks
    return due


@compiled.part
def _sample(common: Any, tables: Any, numbers: Any, s: Any, first: int, count: int, number: int) -> None:
    """A SIM_TRUTH of every train of a block."""
    judged = 0 < number < common.cycle.size and common.cycle[number] >= 0
    if judged:
        for i in range(LANES):
            s[at.WANTED + i] = common.wanted_mps[number]
        if common.by_distance:
            for i in range(count):
                if s[at.ENDED + i] == 0.0:
                    s[at.WANTED + i] = train.wanted_mps(common, s, i)
    seconds = common.truth_s[number] - common.truth_s[number - 1] if number > 0 else 0.0
    column = common.control_sample[number]
    if column >= 0:
        side_by_side.accelerate(numbers, s)
    if side_by_side.sample(numbers, s, seconds, number, judged) > 0:
        for i in range(count):
            if s[at.TICK_LEFT + i] > 0.0:
                train.sample(common, s, i, number, judged)
                if column >= 0:
                    s[at.NOW + i] = train.acceleration_mps2_of(common, tables, first + i, s, i)
    if judged:
        sums_kmh = tables.error_sums_kmh[common.cycle[number]]
        for i in range(count):
            sums_kmh[first + i] += s[at.ERROR + i]
    if column >= 0:
        for i in range(count):
            if s[at.ENDED + i] == 0.0:
                now = smaller(larger(round(s[at.NOW + i] * 1e4), -0x8000), 0x7FFF)
                tables.control_accel_raw[first + i, column] = now


@compiled.cached(*_SOURCES)
def run_period(common: Any, tables: Any, notch_codes: Any, noise: Any, from_tick: int, to_tick: int) -> None:
    """Advance every running train from the poll at ``from_tick`` to just before that at ``to_tick``.

    :param notch_codes: notches of the law at ``from_tick``, shape (N,). With ``from_tick`` -1 there are none: the train
        stands at tick 0.
    :param noise: standard normal numbers of the speed sensor at ``to_tick``, shape (N,).
    """
    trains, numbers = tables.order.size, side_by_side.numbers_of(common)
    odometer_tick = to_tick // common.position_ticks * common.position_ticks
    for first in range(0, trains, LANES):
        count = smaller(LANES, trains - first)
        s = tables.blocks[first // LANES]
        if from_tick >= 0:
            for i in range(count):
                index = first + i
                if s[at.ENDED + i] == 0.0:
                    train.command(common, tables, index, s, i, notch_codes[tables.order[index]], from_tick)
        _whole_ticks(common.step_s, s)
        due = _next_due(s)
        for tick in range(from_tick, to_tick):
            if tick == common.last_tick + 1:
                for i in range(LANES):
                    s[at.ORDINARY + i] = 0.0
            if tick >= 0:
                due = _tick(common, tables, numbers, s, first, count, tick, due)
            if (tick + 1) % common.truth_ticks == 0:
                _sample(common, tables, numbers, s, first, count, (tick + 1) // common.truth_ticks)
            if tick + 1 == odometer_tick:
                for i in range(count):
                    if s[at.ENDED + i] == 0.0:
                        s[at.SHOWN + i] = s[at.POSITION + i]
        for i in range(count):
            index = first + i
            if s[at.ENDED + i] == 0.0:
                train.read(common, tables, index, s, i, noise[tables.order[index]])
            tables.readings[layout.READ_ENDED, tables.order[index]] = s[at.ENDED + i]


@compiled.cached(*_SOURCES)
def stand_to_the_end(common: Any, tables: Any) -> None:
    """Add the rest of the timetable after the end of each run to the sums: the train stands."""
    for index in range(tables.order.size):
        s, i = tables.blocks[index // LANES], index % LANES
        for number in range(int(s[at.SAMPLES + i]), common.cycle.size):
            if common.cycle[number] >= 0:
                position_m = s[at.TRUE_POSITION + i] * train.TRUTH_LSB
                wanted = (
                    curve.passing_mps(common.target, position_m) if common.by_distance else common.wanted_mps[number]
                )
                tables.error_sums_kmh[common.cycle[number], index] += error_kmh(wanted, 0.0)
