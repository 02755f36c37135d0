"""Random draws for a train and its line, and for one of its runs.

Every number of a stream is drawn in every run, in the same order: a scenario key that switches a draw on does not
change the other draws.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from railhil.scenarios import streams

_KMH = 3.6
#: Smallest gain of a drawn brake.
_GAIN_MIN = 0.1


class TrainDraw(NamedTuple):
    """Draws that are the same in all runs of a sequence: gain without the load, delay, wheel error, error of each piece
    of the map."""

    gain: float
    delay_s: float
    wheel: float
    map_errors_permil: tuple[float, ...]


class RunDraw(NamedTuple):
    """One run: gain and delay of the brake, start speed, load (percent), rail, error of the mark balise.

    ``adhesion_mps2``: largest deceleration, 0: no limit. ``slide_seen``: a slide would be reported. ``wet``: low
    adhesion has been announced.
    """

    gain: float
    delay_s: float
    start_mps: float
    load_percent: float
    adhesion_mps2: float
    slide_seen: bool
    wet: bool
    mark_error_m: float


def drawn_train(task: Any, seed: int) -> TrainDraw:
    """The train and the line of a sequence.

    :param task: a :class:`railhil.systems.stop.task.StopTask`.
    """
    gain, delay, wheel, *errors = (
        streams.generator(seed, streams.SEQUENCE).standard_normal(3 + len(task.grade)).tolist()
    )
    true = task.true
    return TrainDraw(
        true.gain * (1.0 + true.gain_train_sigma * gain),
        true.delay_s + true.delay_train_sigma_s * delay,
        task.sensors.wheel_sigma * wheel,
        tuple(task.map_error_sigma_permil * error for error in errors),
    )


def drawn_run(task: Any, train: TrainDraw, seed: int, run_number: int) -> RunDraw:
    """One run of a train.

    :param task: a :class:`railhil.systems.stop.task.StopTask`.
    :param run_number: from 1.
    """
    source = streams.run_generator(seed, streams.RUN_VALUES, run_number)
    gain, delay, cruise, mark = source.standard_normal(4).tolist()
    spread, load, slides, limit, seen, announced = source.random(6).tolist()
    true, rail = task.true, task.rail
    load_percent = task.load_percent[0] + (task.load_percent[1] - task.load_percent[0]) * load
    loaded = 1.0 + (true.full_load_gain - 1.0) * load_percent / 100.0
    start_mps = task.start_kmh / _KMH
    if start_mps > 0.0:
        start_mps += task.cruise_sigma_mps * cruise + task.start_spread_kmh / _KMH * (2.0 * spread - 1.0)
    is_slide = slides < rail.slide_share
    low, high = rail.adhesion_mps2
    return RunDraw(
        max(_GAIN_MIN, train.gain * (1.0 + true.gain_run_sigma * gain) * loaded),
        max(0.0, train.delay_s + true.delay_run_sigma_s * delay),
        max(0.0, start_mps),
        load_percent,
        low + (high - low) * limit if is_slide else 0.0,
        seen < rail.seen_share,
        is_slide and announced < rail.announced_share,
        task.sensors.mark_sigma_m * mark,
    )
