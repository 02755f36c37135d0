"""The compiled loop over many trains that stop, and these trains at their start, with the plant's own functions.

It has the operations of :class:`railhil.plant_sim.stop.train.StopTrain` and its watch in the same order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from railhil.batch import compiled
from railhil.common.compilable import larger, smaller
from railhil.plant_sim import brake_watch
from railhil.plant_sim.brake_watch import answer_ticks, brake_looked_at, share_of
from railhil.plant_sim.stop import brake
from railhil.plant_sim.stop import train as train_module
from railhil.plant_sim.stop.brake import Course, Going, Motion, achieved, gone_on
from railhil.plant_sim.stop.draws import RunDraw, drawn_run, drawn_train
from railhil.plant_sim.stop.train import SPEED_RAW_MAX, TICK_S, course_of, start_of, wander_of
from railhil.scenarios import streams
from railhil.scenarios.run_spec import RunSpec
from railhil.wire import stop_counts
from railhil.wire.stop_counts import MM, SAMPLE_S, SAMPLES

#: Sources of the machine code.
_SOURCES = (__file__, brake, train_module, brake_watch, stop_counts, str(stop_counts.TABLE))
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


#: Commands that may be on their way besides the delay's: one begins within a tick, one has just come.
_MORE = 4


def made(task: Any, specs: Sequence[RunSpec], ticks: int) -> tuple[Common, Fleet, list[RunDraw]]:
    """The trains of some runs at tick 0, and the random draws for each.

    :param task: a :class:`railhil.systems.stop.task.StopTask`.
    :param ticks: number of ticks that are recorded.
    """
    trains = [drawn_train(task, spec.seed) for spec in specs]
    runs = [drawn_run(task, train, spec.seed, spec.run_number) for train, spec in zip(trains, specs, strict=True)]
    courses = [course_of(task, train, run) for train, run in zip(trains, runs, strict=True)]
    starts = [start_of(task, course, run) for course, run in zip(courses, runs, strict=True)]
    balises_m = [at_m for before_m in task.balises_m if (at_m := task.stop_m - before_m) > task.start_m]
    keep, add = wander_of(task)
    brake, one, count = task.brake, courses[0], len(specs)
    common = Common(
        lag_s=one.lag_s,
        loss=one.loss,
        loss_below_mps=one.loss_below_mps,
        notch_mps2=brake.notch_mps2,
        lowest_mps2=-max(brake.braking_max_mps2, task.service_braking_mps2),
        highest_mps2=brake.traction_max_mps2,
        start_m=float(task.start_m),
        bounds_m=np.array(one.bounds_m, dtype=np.float64),
        balise_m=np.array(balises_m, dtype=np.float64),
        first_balise=len(task.balises_m) - len(balises_m),
        wander_keep=keep,
        wander_add=add,
        brake_share=share_of(TICK_S, brake.lag_s),
        answer_ticks=answer_ticks(TICK_S),
    )
    normals = [_normals(spec, streams.RUN_WANDER, ticks + 1) for spec in specs]
    wander = np.stack(normals)
    queue = int(max(run.delay_s for run in runs) / TICK_S) + _MORE
    fleet = Fleet(
        going=np.array([(going.now_s, *going.motion, going.stopped_s) for going in starts], dtype=np.float64),
        piece=np.array([going.piece for going in starts], dtype=np.int64),
        slides=np.zeros(count, dtype=np.int64),
        gain=np.array([run.gain for run in runs]),
        delay_s=np.array([run.delay_s for run in runs]),
        adhesion_mps2=np.array([run.adhesion_mps2 for run in runs], dtype=np.float64),
        wheel=np.array([train.wheel for train in trains]),
        grades_mps2=np.array([course.grades_mps2 for course in courses], dtype=np.float64),
        target_mps2=np.array([going.motion.drive_mps2 for going in starts], dtype=np.float64),
        coming_s=np.zeros((count, queue)),
        coming_mps2=np.zeros((count, queue)),
        coming=np.zeros(count, dtype=np.int64),
        braking=np.zeros(count, dtype=np.int64),
        wander_mps=task.wander_sigma_mps * wander[:, 0],
        wander_normal=np.ascontiguousarray(wander[:, 1:]),
        noise_mps=task.sensors.speed_noise_mps
        * np.stack([_normals(spec, streams.RUN_SPEED_NOISE, SAMPLES * (ticks + 1)) for spec in specs]),
        samples=np.zeros((count, SAMPLES), dtype=np.int64),
        passed=np.zeros(count, dtype=np.int64),
        passed_m=np.zeros(count),
        balise_error_m=task.sensors.balise_sigma_m
        * np.stack([_normals(spec, streams.RUN_BALISES, max(1, len(balises_m))) for spec in specs]),
        expected_mps2=np.zeros(count),
        silent_ticks=np.zeros(count, dtype=np.int64),
        stop_tick=np.full(count, -1, dtype=np.int64),
        first_stop=np.full(count, -1, dtype=np.int64),
        first_stop_s=np.zeros(count),
        left=np.zeros(count, dtype=np.int64),
        over=np.zeros(count, dtype=np.int64),
        record=np.zeros((count, ticks, 3)),
    )
    return common, fleet, runs


def _normals(spec: RunSpec, stream: int, count: int) -> Any:
    return streams.run_generator(spec.seed, stream, spec.run_number).standard_normal(count)
