"""The compiled loop over many trains that stop, with the plant's own functions.

It has the operations of :class:`railhil.plant_sim.stop.train.StopTrain` and its watch in the same order.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from railhil.batch import compiled
from railhil.common.compilable import larger, smaller
from railhil.plant_sim.high_speed import watch
from railhil.plant_sim.high_speed.watch import brake_looked_at
from railhil.plant_sim.stop import brake
from railhil.plant_sim.stop import train as train_module
from railhil.plant_sim.stop.brake import Course, Going, Motion, achieved, gone_on
from railhil.plant_sim.stop.train import SPEED_RAW_MAX, TICK_S
from railhil.wire import stop_counts
from railhil.wire.stop_counts import MM, SAMPLE_S, SAMPLES

#: Sources of the machine code.
_SOURCES = (__file__, brake, train_module, watch, stop_counts, str(stop_counts.TABLE))
#: Columns of the record.
POSITION, SPEED, DRIVE = range(3)


class Common(NamedTuple):
    """The data common to all trains. ``balise_m``: without the ``first_balise`` balises before the start of the run."""

    lag_s: float
    loss: float
    loss_below_mps: float
    notch_mps2: float
    lowest_mps2: float
    highest_mps2: float
    start_m: float
    bounds_m: Any
    balise_m: Any
    first_balise: int
    wander_keep: float
    wander_add: float
    brake_share: float
    answer_ticks: int


class Fleet(NamedTuple):
    """State and record of N trains; the first index is the train.

    ``going`` (N, 5): instant, position, speed, drive, instant of the last standstill. ``coming_s``, ``coming_mps2`` (N,
    Q): commands on their way, ``coming`` of them. ``noise`` (N, samples): of every sample of the run, m/s;
    ``wander_normal`` (N, ticks). ``passed``: number of balises passed, ``passed_m`` the distance by the wheels at the
    last. ``stop_tick``: -1 unless the train stands after a run; ``first_stop``: tick of its first stop, -1.
    ``left``: 1 from the tick on at which the watch has acted. ``over``: 1 when the run has ended. ``record`` (N, ticks,
    columns) is the motion at every tick.
    """

    going: Any
    piece: Any
    slides: Any
    gain: Any
    delay_s: Any
    adhesion_mps2: Any
    wheel: Any
    grades_mps2: Any
    target_mps2: Any
    coming_s: Any
    coming_mps2: Any
    coming: Any
    braking: Any
    wander_mps: Any
    wander_normal: Any
    noise_mps: Any
    samples: Any
    passed: Any
    passed_m: Any
    balise_error_m: Any
    expected_mps2: Any
    silent_ticks: Any
    stop_tick: Any
    first_stop: Any
    first_stop_s: Any
    left: Any
    over: Any
    record: Any


@compiled.part
def _command(common: Any, fleet: Any, train: int, accel_mps2: float, after_s: float) -> None:
    """``StopPlant`` and ``StopTrain.command``."""
    accel_mps2 = smaller(larger(accel_mps2, common.lowest_mps2), common.highest_mps2)
    at_s = fleet.going[train, 0] + after_s + fleet.delay_s[train]
    count = fleet.coming[train]
    while count > 0 and fleet.coming_s[train, count - 1] >= at_s:
        count -= 1
    fleet.coming_s[train, count] = at_s
    fleet.coming_mps2[train, count] = accel_mps2
    fleet.coming[train] = count + 1
    fleet.braking[train] = 1 if accel_mps2 < 0.0 else 0


@compiled.part
def _look(common: Any, fleet: Any, train: int) -> None:
    """The watch at the end of a tick; commands never stay away here."""
    target = fleet.target_mps2[train]
    told = target if target < 0.0 else 0.0
    expected, silent = brake_looked_at(
        fleet.expected_mps2[train], fleet.silent_ticks[train], told, fleet.going[train, 3], common.brake_share
    )
    if fleet.going[train, 2] == 0.0:
        silent = 0
    fleet.expected_mps2[train], fleet.silent_ticks[train] = expected, silent
    if silent >= common.answer_ticks:
        fleet.left[train] = 1


@compiled.part
def _step(common: Any, fleet: Any, train: int, until_s: float, wander_mps2: float) -> None:
    """``StopTrain._step``."""
    row = fleet.going[train]
    course = Course(
        common.lag_s,
        common.loss,
        common.loss_below_mps,
        fleet.adhesion_mps2[train],
        common.bounds_m,
        fleet.grades_mps2[train],
    )
    while row[0] < until_s:
        while fleet.coming[train] > 0 and fleet.coming_s[train, 0] <= row[0]:
            fleet.target_mps2[train] = fleet.coming_mps2[train, 0]
            fleet.coming[train] -= 1
            for place in range(fleet.coming[train]):
                fleet.coming_s[train, place] = fleet.coming_s[train, place + 1]
                fleet.coming_mps2[train, place] = fleet.coming_mps2[train, place + 1]
        end_s = until_s
        if fleet.coming[train] > 0:
            end_s = smaller(until_s, fleet.coming_s[train, 0])
        going = Going(row[0], Motion(row[1], row[2], row[3]), fleet.piece[train], fleet.slides[train] == 1, row[4])
        target = achieved(fleet.target_mps2[train], fleet.gain[train], common.notch_mps2)
        after = gone_on(course, going, target, wander_mps2, end_s)
        row[0], row[4] = after.now_s, after.stopped_s
        row[1], row[2], row[3] = after.motion.position_m, after.motion.speed_mps, after.motion.drive_mps2
        fleet.piece[train] = after.piece
        fleet.slides[train] = 1 if after.slides else 0
        while fleet.passed[train] < common.balise_m.size and row[1] >= common.balise_m[fleet.passed[train]]:
            number = fleet.passed[train]
            metres = common.balise_m[number] - common.start_m + fleet.balise_error_m[train, number]
            fleet.passed_m[train] = larger(0.0, metres * (1.0 + fleet.wheel[train]))
            fleet.passed[train] = number + 1


@compiled.part
def _sample(fleet: Any, train: int, number: int) -> int:
    """``StopTrain._sample``; ``number`` of the sample in the run."""
    speed_mps = fleet.going[train, 2]
    if speed_mps <= 0.0:
        return 0
    read_mps = speed_mps * (1.0 + fleet.wheel[train]) + fleet.noise_mps[train, number]
    return int(smaller(larger(round(read_mps * MM), 0), SPEED_RAW_MAX))


@compiled.cached(*_SOURCES)
def advance_stops(common: Any, fleet: Any, accel_mps2: Any, after_s: Any, tick: int) -> None:
    """Give each train a command at a tick and simulate to the next; runs that are over stay.

    :param accel_mps2, after_s: shape (N,).
    :param tick: -1 records tick 0 and takes its samples.
    """
    for train in range(fleet.left.size):
        if fleet.over[train] == 0:
            row = fleet.going[train]
            if tick < 0:
                for sample in range(SAMPLES):
                    fleet.samples[train, sample] = _sample(fleet, train, sample)
            else:
                _command(common, fleet, train, accel_mps2[train], after_s[train])
                _look(common, fleet, train)
                stood = row[2] == 0.0
                before_mps = fleet.wander_mps[train]
                after_mps = common.wander_keep * before_mps + common.wander_add * fleet.wander_normal[train, tick]
                wander_mps2 = 0.0
                if fleet.braking[train] == 0:
                    wander_mps2 = (after_mps - before_mps) / TICK_S
                fleet.wander_mps[train] = after_mps
                begun_s = row[0]
                for sample in range(SAMPLES):
                    _step(common, fleet, train, begun_s + (sample + 1) * SAMPLE_S, wander_mps2)
                    fleet.samples[train, sample] = _sample(fleet, train, (tick + 1) * SAMPLES + sample)
                stands = row[2] == 0.0
                if stood and not stands:
                    fleet.stop_tick[train] = -1
                    if fleet.first_stop[train] >= 0:
                        fleet.left[train] = 1
                elif stands and not stood:
                    fleet.stop_tick[train] = tick + 1
                    if fleet.first_stop[train] < 0:
                        fleet.first_stop[train] = tick + 1
                        fleet.first_stop_s[train] = row[4]
            record = fleet.record[train, tick + 1]
            record[POSITION], record[SPEED], record[DRIVE] = row[1], row[2], row[3]
