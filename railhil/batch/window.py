"""A control period of the calm trains of a block (:mod:`railhil.batch.calm`): who is calm, the next notch, grades,
samples, and a train that its watch takes out of its lane.
"""

from __future__ import annotations

from math import ceil, inf
from typing import Any

from railhil.batch import alone, calm, compiled, curve, steady
from railhil.batch.lanes import (
    CALM,
    DECAY,
    FIRST_S,
    GRADE_FROM,
    GRADE_TO,
    JOINS,
    LANES,
    LOOK_LEFT,
    MEAN,
    NEXT_STEADY,
    NOISE_MPS,
    NOW,
    ODOMETER_READ,
    PERMIL,
    PERMIL_PER_M,
    POSITION,
    SECOND_S,
    SHOWN,
    SPEED,
    SPEED_READ,
    SPLIT,
    STEADY,
    STEADY_RUN,
    STEEPEST,
    SUM_KMH,
    WANTED,
    WHEEL,
    load,
    store,
)
from railhil.batch.layout import READ_ODOMETER, READ_SPEED
from railhil.common.compilable import larger, smaller
from railhil.plant_sim.dynamics import lag
from railhil.plant_sim.plant import NOTCH_LSB_PER_NOTCH, SLIVER_TICKS


@compiled.part
def _steepest_permil(tables: Any, from_m: Any, index: int) -> float:
    """The largest mean grade of a train's line, up or down."""
    steepest = 0.0
    for row in range(from_m.size):
        permil, slope = tables.permil[index, row], tables.permil_per_m[index, row]
        end = permil + slope * (from_m[row + 1] - from_m[row]) if row + 1 < from_m.size else permil
        steepest = larger(steepest, larger(abs(permil), abs(end)))
        if row + 1 == from_m.size and slope != 0.0:
            return inf
    return steepest


@compiled.aside
def _part_of_tick(s: Any, lane: int, at: int, pole_per_s: float, ticks: float, step_s: float) -> None:
    """Duration, decay and mean of a part of a tick; ``at``: the first of these quantities."""
    part_s = ticks * step_s if ticks > SLIVER_TICKS else 0.0
    if part_s == s[at + lane]:
        return
    s[at + lane] = part_s
    if ticks == 1.0:
        s[at + LANES + lane], s[at + 2 * LANES + lane] = s[DECAY + lane], s[MEAN + lane]
    elif part_s > 0.0:
        found = lag(pole_per_s, part_s)
        s[at + LANES + lane], s[at + 2 * LANES + lane] = found.decay, found.mean


@compiled.part
def _next_notch(common: Any, tables: Any, index: int, train: Any, s: Any, lane: int, from_tick: int,
                to_tick: int) -> bool:  # fmt: skip
    """Note the notch that begins to act in the period; False if there are several."""
    s[NEXT_STEADY + lane], s[SPLIT + lane] = s[STEADY + lane], inf
    slot = train.staged_first
    due = tables.staged_due[index, slot]
    if train.staged_count == 0 or due > to_tick:
        return True
    tick = larger(ceil(due) - 1, from_tick)
    s[SPLIT + lane] = tick
    s[NEXT_STEADY + lane] = tables.staged_code[index, slot] * train.force_per_notch_n / NOTCH_LSB_PER_NOTCH
    before = due - tick
    _part_of_tick(s, lane, FIRST_S, train.pole_per_s, before, common.step_s)
    after = tick + 1 - due if before > SLIVER_TICKS else 1.0
    _part_of_tick(s, lane, SECOND_S, train.pole_per_s, after, common.step_s)
    alone_here: bool = train.staged_count == 1 or tables.staged_due[index, alone.slot_after(tables, slot, 1)] > to_tick
    return alone_here


@compiled.aside
def leave(truth_ticks: int, notch_ticks: int, train: Any, s: Any, lane: int, tick: int) -> None:
    """Put a train that was calm until ``tick`` onto its record."""
    if s[CALM + lane] > 0.0:
        store(truth_ticks, notch_ticks, train, s, lane, tick)
        s[CALM + lane] = 0.0


@compiled.aside
def enter(common: Any, tables: Any, trains: Any, s: Any, first: int, count: int, from_tick: int, to_tick: int) -> Any:
    """Put the trains of a block that are calm in a period into their lanes, and the others that were there onto their
    records; the number of calm ones, and of those that may exceed a speed limit of the score."""
    for lane in range(LANES):
        s[STEADY_RUN + lane] = 0.0
    if to_tick <= common.last_tick + 1:
        for lane in range(count):
            index = first + lane
            train = trains[index]
            if s[CALM + lane] > 0.0:
                s[STEADY_RUN + lane] = 1.0
            elif train.speed_mps > 0.0:
                load(common, tables, index, train, s, lane, from_tick)
                s[WHEEL + lane] = train.wheel_factor
                s[STEEPEST + lane] = _steepest_permil(tables, common.grade_from_m, index)
            if s[STEADY_RUN + lane] > 0.0 and not _next_notch(
                common, tables, index, train, s, lane, from_tick, to_tick
            ):
                s[STEADY_RUN + lane] = 0.0
    fast, found = calm.judge(common, s, to_tick - from_tick), 0
    for lane in range(count):
        if s[STEADY_RUN + lane] > 0.0:
            s[CALM + lane] = 1.0
            found += 1
        else:
            leave(common.truth_ticks, common.notch_ticks, trains[first + lane], s, lane, from_tick)
    return found, fast


@compiled.part
def read(common: Any, tables: Any, trains: Any, s: Any, first: int, count: int, noise: Any) -> None:
    """The readings of the calm trains of a block at a poll; ``noise`` as for the kernel."""
    for lane in range(count):
        s[NOISE_MPS + lane] = noise[tables.order[first + lane]] * trains[first + lane].noise_sigma_mps
    calm.read(s, common.speed_lsb_mps, common.odometer_lsb_m)
    readings = tables.readings
    for lane in range(count):
        if s[CALM + lane] > 0.0:
            place = tables.order[first + lane]
            readings[READ_SPEED, place] = int(s[SPEED_READ + lane])
            readings[READ_ODOMETER, place] = int(s[ODOMETER_READ + lane]) * 10
            alone.pass_balises(tables, first + lane, s[POSITION + lane])


@compiled.part
def _next_split(s: Any, after: int) -> float:
    """The first tick after ``after`` in which a notch of a calm train begins to act; infinite: none."""
    found = inf
    for lane in range(LANES):
        split = s[SPLIT + lane]
        if s[CALM + lane] > 0.0 and after < split < found:
            found = split
    return found


@compiled.aside
def _follow_grades(from_m: Any, permil: Any, permil_per_m: Any, trains: Any, s: Any, first: int, count: int,
                   step_s: float, tick: int, second: bool) -> None:  # fmt: skip
    """The row of the grades in the middle of a step.

    :param tick: trains whose notch begins to act in it make the first or the ``second`` part of it as their step.
    """
    for lane in range(count):
        part_s = step_s
        if s[SPLIT + lane] == tick:
            part_s = s[SECOND_S + lane] if second else s[FIRST_S + lane]
        place_m = s[POSITION + lane] + s[SPEED + lane] * (0.5 * part_s)
        if s[CALM + lane] == 0.0 or place_m < s[GRADE_TO + lane]:
            continue
        index = first + lane
        row = trains[index].grade_row
        while row + 1 < from_m.size and from_m[row + 1] <= place_m:
            row += 1
        trains[index].grade_row = row
        s[GRADE_FROM + lane] = from_m[row]
        s[GRADE_TO + lane] = from_m[row + 1] if row + 1 < from_m.size else inf
        s[PERMIL + lane], s[PERMIL_PER_M + lane] = permil[index, row], permil_per_m[index, row]


@compiled.part
def _split(tables: Any, trains: Any, s: Any, first: int, count: int, tick: int) -> None:
    """The notches that begin to act in a tick act."""
    for lane in range(count):
        if s[CALM + lane] > 0.0 and s[SPLIT + lane] == tick:
            train = trains[first + lane]
            train.acting_code = tables.staged_code[first + lane, train.staged_first]
            train.staged_first = alone.slot_after(tables, train.staged_first, 1)
            train.staged_count -= 1
            s[STEADY + lane] = s[NEXT_STEADY + lane]


@compiled.aside
def _keep_sums(sums_kmh: Any, s: Any, first: int, count: int) -> None:
    """The speed errors of a cycle from the lanes into its row of the table."""
    for lane in range(count):
        if s[CALM + lane] > 0.0:
            sums_kmh[first + lane] = s[SUM_KMH + lane]


@compiled.part
def _leave_found(common: Any, tables: Any, trains: Any, s: Any, first: int, count: int, tick: int,
                 odometer_tick: int) -> int:  # fmt: skip
    """Put the trains that their watch has found onto their records; their number."""
    found = 0
    for lane in range(count):
        if s[CALM + lane] > 0.0 and s[LOOK_LEFT + lane] > 0.0:
            index = first + lane
            train = trains[index]
            if tick >= odometer_tick:
                alone.show(common, tables, index, train, s[SHOWN + lane])
            leave(common.truth_ticks, common.notch_ticks, train, s, lane, tick)
            s[JOINS + lane] = tick
            found += 1
    return found


@compiled.part
def _set_wanted(common: Any, s: Any, sample: int) -> None:
    if common.by_distance:
        for lane in range(LANES):
            if s[CALM + lane] > 0.0:
                s[WANTED + lane] = curve.passing_mps(common.target, round(s[POSITION + lane] * 1e4) * alone.TRUTH_LSB)
    else:
        for lane in range(LANES):
            s[WANTED + lane] = common.wanted_mps[sample]


@compiled.part
def _keep_acceleration(tables: Any, s: Any, first: int, count: int, column: int) -> None:
    """The acceleration at a control tick of the score."""
    calm.accelerate(s)
    for lane in range(count):
        if s[CALM + lane] > 0.0:
            now = smaller(larger(round(s[NOW + lane] * 1e4), -0x8000), 0x7FFF)
            tables.control_accel_raw[first + lane, column] = now


@compiled.aside
def run(common: Any, tables: Any, trains: Any, s: Any, first: int, count: int, from_tick: int, to_tick: int,
        fast: int) -> int:  # fmt: skip
    """Advance the calm trains of a block through a period; the number of those that leave their lanes in it.

    :param fast: number of trains that may exceed a speed limit of the score.
    """
    step_s, look_ticks, truth_ticks = common.step_s, common.checks.look_ticks, common.truth_ticks
    from_m, permil, slope = common.grade_from_m, tables.permil, tables.permil_per_m
    sums_kmh = tables.error_sums_kmh
    odometer_tick = to_tick // common.position_ticks * common.position_ticks
    split, near, cycle, left = _next_split(s, from_tick - 1), 1, -1, 0
    # A look at trains in traction finds nothing, and a second one changes nothing.
    looks, all_pull = True, calm.brakes(s) == 0
    for tick in range(from_tick, to_tick):
        if looks and tick % look_ticks == 0:
            if calm.look_at_forces(common.checks, s) > 0:
                if cycle >= 0:
                    _keep_sums(sums_kmh[cycle], s, first, count)
                left += _leave_found(common, tables, trains, s, first, count, tick, odometer_tick)
            looks = not all_pull
        if tick == split:
            _follow_grades(from_m, permil, slope, trains, s, first, count, step_s, tick, False)
            calm.part_of_tick(s, step_s, tick, False)
            _split(tables, trains, s, first, count, tick)
            _follow_grades(from_m, permil, slope, trains, s, first, count, 0.0, tick, True)
            calm.part_of_tick(s, step_s, tick, True)
            split, near = _next_split(s, tick), 1
            looks, all_pull = True, calm.brakes(s) == 0
        else:
            if near != 0:
                _follow_grades(from_m, permil, slope, trains, s, first, count, step_s, -1, False)
            near = calm.tick(s, step_s)
        if (tick + 1) % truth_ticks == 0:
            sample = (tick + 1) // truth_ticks
            judged = sample < common.cycle.size and common.cycle[sample] >= 0
            if judged:
                if common.cycle[sample] != cycle:
                    if cycle >= 0:
                        _keep_sums(sums_kmh[cycle], s, first, count)
                    cycle = common.cycle[sample]
                    for lane in range(count):
                        s[SUM_KMH + lane] = sums_kmh[cycle, first + lane]
                _set_wanted(common, s, sample)
            calm.sample(s, common.truth_s[sample] - common.truth_s[sample - 1], judged)
            if fast > 0:
                steady.allow(common, s)
                calm.exceed(s)
            if common.control_sample[sample] >= 0:
                _follow_grades(from_m, permil, slope, trains, s, first, count, 0.0, -1, False)
                _keep_acceleration(tables, s, first, count, common.control_sample[sample])
        if tick + 1 == odometer_tick:
            for lane in range(LANES):
                s[SHOWN + lane] = s[POSITION + lane]
    if cycle >= 0:
        _keep_sums(sums_kmh[cycle], s, first, count)
    return left
