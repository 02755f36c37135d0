"""The tick loop of many trains as machine code, for one control period at a time.

It repeats the order defined in :mod:`railhil.plant_sim.cycle`, and ``Plant.advance``: each pass of the loop handles the
end of the run at a tick, watch and motion, then, at the next tick, the readings that are due. The law is computed
before the pass that begins a control period. The bus is healthy: every command is accepted. Trains whose run is steady
are computed side by side (:mod:`railhil.batch.steady`), every other one on its record (:mod:`railhil.batch.alone`); the
tests of the batch compare both with ``coupled_run`` and the nodes.
"""

from __future__ import annotations

from typing import Any

from railhil.batch import alone, calm, compiled, curve, lanes, layout, steady, window
from railhil.batch.lanes import (
    CALM,
    ERROR,
    JOINS,
    LANES,
    LOOK_LEFT,
    NOW,
    POSITION,
    SAMPLE_LEFT,
    STEADY_RUN,
    STEP_LEFT,
    WANTED,
    load,
    store,
)
from railhil.common.compilable import larger, smaller
from railhil.plant_sim import events, plant
from railhil.supervisor.measures import error_kmh

#: Sources of the machine code, in addition to the functions shared with the bench.
_SOURCES = (
    __file__,
    *(str(module.__file__) for module in (alone, calm, curve, lanes, layout, steady, window, events, plant)),
)


@compiled.part
def _is_not_calm(s: Any, lane: int, tick: int) -> bool:
    return bool(s[CALM + lane] == 0.0 and tick >= s[JOINS + lane])


@compiled.aside
def _step_alone(common: Any, tables: Any, index: int, train: Any, s: Any, lane: int, tick: int, look_due: bool) -> None:
    """A tick of a train on its record; from the next one on it is in its lane again, if its run is steady."""
    if s[STEADY_RUN + lane] > 0.0:
        store(common.truth_ticks, common.notch_ticks, train, s, lane, tick)
    if train.ended != 0:
        return
    grades = alone.grades(common, tables, index, train)
    alone.end(common, train, tick)
    if train.ended == 0:
        alone.advance(common, tables, index, grades, train, tick, tick % common.notch_ticks == 0, look_due)
        if train.speed_mps > 0.0:
            load(common, tables, index, train, s, lane, tick + 1)


@compiled.aside
def _sample_alone(common: Any, tables: Any, index: int, train: Any, s: Any, lane: int, tick: int, sample: int) -> None:
    """A sample of a train on its record."""
    if s[STEADY_RUN + lane] > 0.0:
        store(common.truth_ticks, common.notch_ticks, train, s, lane, tick)
    if train.ended == 0:
        alone.truth(common, tables, index, alone.grades(common, tables, index, train), train, sample)
        if train.speed_mps > 0.0:
            load(common, tables, index, train, s, lane, tick)


@compiled.part
def _sample_all(common: Any, tables: Any, trains: Any, first: int, count: int, tick: int, sample: int) -> None:
    """A SIM_TRUTH of every train of a block, before ``tick``."""
    s = tables.lanes[first // LANES]
    judged = sample < common.cycle.size and common.cycle[sample] >= 0
    if judged and common.by_distance:
        for lane in range(count):
            if s[STEADY_RUN + lane] > 0.0:
                s[WANTED + lane] = curve.passing_mps(common.target, round(s[POSITION + lane] * 1e4) * alone.TRUTH_LSB)
    elif judged:
        for lane in range(LANES):
            s[WANTED + lane] = common.wanted_mps[sample]
    seconds = common.truth_s[sample] - common.truth_s[sample - 1] if sample > 0 else 0.0
    marked = steady.sample(common, s, seconds, judged and sample > 0)
    if judged:
        sums_kmh = tables.error_sums_kmh[common.cycle[sample]]
        for lane in range(count):
            sums_kmh[first + lane] += s[ERROR + lane]
    column = common.control_sample[sample]
    if column >= 0:
        for lane in range(count):
            if s[SAMPLE_LEFT + lane] == 0.0:
                now = round(s[NOW + lane] * 1e4)
                tables.control_accel_raw[first + lane, column] = smaller(larger(now, -0x8000), 0x7FFF)
    if marked > 0:
        for lane in range(count):
            if s[SAMPLE_LEFT + lane] > 0.0 and _is_not_calm(s, lane, tick - 1):
                index = first + lane
                _sample_alone(common, tables, index, trains[index], s, lane, tick, sample)


@compiled.part
def _block(common: Any, tables: Any, trains: Any, s: Any, first: int, count: int, from_tick: int, to_tick: int) -> None:
    """:func:`run_period` of the trains of a block that are not calm."""
    for lane in range(LANES):
        s[STEADY_RUN + lane] = 0.0
    if from_tick >= 0:
        for lane in range(count):
            if _is_not_calm(s, lane, from_tick):
                index = first + lane
                load(common, tables, index, trains[index], s, lane, from_tick)
    odometer_tick = to_tick // common.position_ticks * common.position_ticks
    for tick in range(from_tick, to_tick):
        look_due = tick % common.checks.look_ticks == 0
        if tick > common.last_tick:
            for lane in range(count):
                if s[STEADY_RUN + lane] > 0.0:
                    store(common.truth_ticks, common.notch_ticks, trains[first + lane], s, lane, tick)
        if tick >= 0:
            if look_due:
                steady.look_at_forces(common, s)
            if steady.advance(common, s, tick, look_due) > 0:
                for lane in range(count):
                    if s[STEP_LEFT + lane] > 0.0 and _is_not_calm(s, lane, tick):
                        index = first + lane
                        look = look_due and (s[LOOK_LEFT + lane] > 0.0 or s[STEADY_RUN + lane] == 0.0)
                        _step_alone(common, tables, index, trains[index], s, lane, tick, look)
        if (tick + 1) % common.truth_ticks == 0:
            sample = (tick + 1) // common.truth_ticks
            _sample_all(common, tables, trains, first, count, tick + 1, sample)
        if tick + 1 == odometer_tick:
            for lane in range(count):
                index = first + lane
                position_m = s[POSITION + lane] if s[STEADY_RUN + lane] > 0.0 else trains[index].position_m
                if trains[index].ended == 0 and _is_not_calm(s, lane, tick):
                    alone.show(common, tables, index, trains[index], position_m)
    for lane in range(count):
        if s[STEADY_RUN + lane] > 0.0:
            store(common.truth_ticks, common.notch_ticks, trains[first + lane], s, lane, to_tick)


@compiled.cached(*_SOURCES)
def run_period(
    common: Any, tables: Any, trains: Any, notch_codes: Any, noise: Any, from_tick: int, to_tick: int
) -> None:
    """Advance every running train from the poll at ``from_tick`` to just before that at ``to_tick``.

    Trains are computed in blocks: those of which nothing else can happen in the period by :mod:`railhil.batch.window`,
    and stay in their lanes; the others side by side as far as their runs are steady (:mod:`railhil.batch.steady`).

    :param notch_codes: notches of the law at ``from_tick``, shape (N,). With ``from_tick`` -1 there are none: the train
        stands at tick 0.
    :param noise: standard normal numbers of the speed sensor at ``to_tick``, shape (N,).
    """
    for first in range(0, trains.size, LANES):
        count = smaller(LANES, trains.size - first)
        s = tables.lanes[first // LANES]
        running = 0
        for lane in range(LANES):
            s[JOINS + lane] = from_tick
        for lane in range(count):
            index = first + lane
            if trains[index].ended == 0:
                running += 1
                if from_tick >= 0:
                    alone.command(common, tables, index, trains[index], notch_codes[tables.order[index]], from_tick)
        if running > 0 and from_tick >= 0:
            found, fast = window.enter(common, tables, trains, s, first, count, from_tick, to_tick)
            running -= found
            if found > 0:
                running += window.run(common, tables, trains, s, first, count, from_tick, to_tick, fast)
        if running > 0:
            _block(common, tables, trains, s, first, count, from_tick, to_tick)
        window.read(common, tables, trains, s, first, count, noise)
        for lane in range(count):
            index = first + lane
            train = trains[index]
            if train.ended == 0 and s[CALM + lane] == 0.0:
                alone.read(common, tables, index, train, noise[tables.order[index]])
            tables.readings[layout.READ_ENDED, tables.order[index]] = train.ended


@compiled.cached(*_SOURCES)
def stand_to_the_end(common: Any, tables: Any, trains: Any) -> None:
    """Add the rest of the timetable after the end of each run to the sums: the train stands."""
    for index in range(trains.size):
        train = trains[index]
        for sample in range(train.samples, common.cycle.size):
            if common.cycle[sample] >= 0:
                position_m = train.true_position_01mm * alone.TRUTH_LSB
                wanted = (
                    curve.passing_mps(common.target, position_m) if common.by_distance else common.wanted_mps[sample]
                )
                tables.error_sums_kmh[common.cycle[sample], index] += error_kmh(wanted, 0.0)
