"""Trains of some runs at their start, and their random numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from railhil.plant_sim.high_speed.watch import answer_ticks, share_of
from railhil.plant_sim.stop.draws import RunDraw, drawn_run, drawn_train
from railhil.plant_sim.stop.train import TICK_S, course_of, start_of, wander_of
from railhil.scenarios import streams
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.stop.kernel import Common, Fleet
from railhil.wire.stop_counts import SAMPLES

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
