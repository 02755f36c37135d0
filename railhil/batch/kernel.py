"""The tick loop of many trains as machine code, for one control period at a time.

It repeats the order defined in :mod:`railhil.plant_sim.cycle`, and ``Plant.advance``: each pass of the loop handles the
end of the run at a tick, watch and motion, then, at the next tick, the readings that are due. The law is computed
before the pass that begins a control period. The bus is healthy: every command is accepted. Trains whose run is steady
are computed side by side (:mod:`railhil.batch.steady`), every other one on its record (:mod:`railhil.batch.alone`); the
tests of the batch compare both with ``coupled_run`` and the nodes.
"""

from __future__ import annotations

from typing import Any

from railhil.batch import alone, compiled, curve, lanes, layout, steady
from railhil.batch.lanes import (
    ERROR,
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
from railhil.plant_sim.sensors import odometer_reading_mm
from railhil.supervisor.measures import error_kmh

#: Sources of the machine code, in addition to the functions shared with the bench.
_SOURCES = (__file__, *(str(module.__file__) for module in (alone, curve, lanes, layout, steady, events, plant)))


@compiled.aside
def _step_alone(
    common: Any, tables: Any, index: int, train: Any, s: Any, lane: int, tick: int, polled: bool, look_due: bool
) -> None:
    """A tick of a train on its record; from the next one on it is in its lane again, if its run is steady."""
    if s[STEADY_RUN + lane] > 0.0:
        store(common, train, s, lane, tick)
    if train.ended != 0:
        return
    grades = alone.grades(common, tables, index, train)
    alone.end(common, train, tick)
    if train.ended == 0:
        alone.advance(common, tables, index, grades, train, tick, polled, look_due)
        load(common, tables, index, train, s, lane, tick + 1)


@compiled.aside
def _sample_alone(common: Any, tables: Any, index: int, train: Any, s: Any, lane: int, tick: int, sample: int) -> None:
    """A sample of a train on its record."""
    if s[STEADY_RUN + lane] > 0.0:
        store(common, train, s, lane, tick)
    if train.ended == 0:
        alone.truth(common, tables, index, alone.grades(common, tables, index, train), train, sample)
        load(common, tables, index, train, s, lane, tick)


@compiled.part
def _sample_all(common: Any, tables: Any, trains: Any, first: int, count: int, tick: int, sample: int) -> None:
    """A SIM_TRUTH of every train of a block, before ``tick``."""
    s = tables.lanes
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
            if s[SAMPLE_LEFT + lane] > 0.0:
                _sample_alone(common, tables, first + lane, trains[first + lane], s, lane, tick, sample)


@compiled.part
def _block(common: Any, tables: Any, trains: Any, first: int, count: int, from_tick: int, to_tick: int) -> None:
    """:func:`run_period` of a block of trains."""
    s = tables.lanes
    for lane in range(LANES):
        s[STEADY_RUN + lane] = 0.0
    if from_tick >= 0:
        for lane in range(count):
            load(common, tables, first + lane, trains[first + lane], s, lane, from_tick)
    odometer_tick = to_tick // common.position_ticks * common.position_ticks
    for tick in range(from_tick, to_tick):
        polled = tick % common.notch_ticks == 0
        look_due = tick % common.checks.look_ticks == 0
        if tick > common.last_tick:
            for lane in range(count):
                if s[STEADY_RUN + lane] > 0.0:
                    store(common, trains[first + lane], s, lane, tick)
        if tick >= 0:
            if look_due:
                steady.look_at_forces(common, s)
            if steady.advance(common, s, tick, look_due) > 0:
                for lane in range(count):
                    if s[STEP_LEFT + lane] > 0.0:
                        look = look_due and (s[LOOK_LEFT + lane] > 0.0 or s[STEADY_RUN + lane] == 0.0)
                        _step_alone(common, tables, first + lane, trains[first + lane], s, lane, tick, polled, look)
        if (tick + 1) % common.truth_ticks == 0:
            sample = (tick + 1) // common.truth_ticks
            _sample_all(common, tables, trains, first, count, tick + 1, sample)
        if tick + 1 == odometer_tick:
            for lane in range(count):
                train = trains[first + lane]
                position_m = s[POSITION + lane] if s[STEADY_RUN + lane] > 0.0 else train.position_m
                if train.ended == 0:
                    odometer_mm = odometer_reading_mm(position_m, train.wheel_factor, common.odometer_lsb_m)
                    train.odometer_01mm = odometer_mm * 10
    for lane in range(count):
        if s[STEADY_RUN + lane] > 0.0:
            store(common, trains[first + lane], s, lane, to_tick)


@compiled.cached(*_SOURCES)
def run_period(
    common: Any, tables: Any, trains: Any, notch_codes: Any, noise: Any, from_tick: int, to_tick: int
) -> None:
    """Advance every running train from the poll at ``from_tick`` to just before that at ``to_tick``.

    Trains are computed in blocks, side by side as far as their runs are steady (:mod:`railhil.batch.steady`).

    :param notch_codes: notches of the law at ``from_tick``, shape (N,). With ``from_tick`` -1 there are none: the train
        stands at tick 0.
    :param noise: standard normal numbers of the speed sensor at ``to_tick``, shape (N,).
    """
    for first in range(0, trains.size, LANES):
        count = smaller(LANES, trains.size - first)
        running = 0
        for index in range(first, first + count):
            if trains[index].ended == 0:
                running += 1
                if from_tick >= 0:
                    alone.command(common, tables, index, trains[index], notch_codes[index], from_tick)
        if running > 0:
            _block(common, tables, trains, first, count, from_tick, to_tick)
    for index in range(trains.size):
        if trains[index].ended == 0:
            alone.read(common, tables, index, trains[index], noise[index])


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
