"""Trains of some seeds at the start of their runs, and their random numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.batch.high_speed.kernel import UNITS, Common, Fleet
from railhil.plant_sim.high_speed.dynamics import Coupler
from railhil.plant_sim.high_speed.train import REMEMBERED, STEP_S, HighSpeedTrain
from railhil.plant_sim.high_speed.watch import answer_ticks, share_of
from railhil.scenarios import streams
from railhil.scenarios.high_speed.task import HighSpeedTask

Floats: TypeAlias = NDArray[np.float64]


def made(task: HighSpeedTask, seeds: Sequence[int], tick_s: float, ticks: int) -> tuple[Common, Fleet]:
    """The trains of some seeds at tick 0.

    :param ticks: number of ticks that are recorded.
    """
    trains = [HighSpeedTrain(task, seed, tick_s) for seed in seeds]
    one = trains[0]
    units, shape = len(task.unit), (len(seeds), len(task.unit))
    common = Common(
        limits=one.limits,
        **{
            name: np.array([getattr(unit.drive, name) for unit in one.units], dtype=np.float64)
            for name in ("gain", "decay", "mean")
        },
        traction_steps=np.array([unit.traction_steps for unit in one.units], dtype=np.int64),
        braking_steps=np.array([unit.braking_steps for unit in one.units], dtype=np.int64),
        mass_kg=np.array(one.mass_kg, dtype=np.float64),
        brake_share=np.array([share_of(tick_s, unit.lag_s) for unit in task.unit], dtype=np.float64),
        coupled=one.coupler is not None,
        coupler=one.coupler or Coupler(0.0, 0.0, 0.0),
        steps_per_tick=round(tick_s / STEP_S),
        answer_ticks=answer_ticks(tick_s),
        wind_keep=one.wind.keep,
        wind_add=one.wind.add,
    )
    starts = np.array([[unit.motion.drive_mps2 / unit.data.gain for unit in train.units] for train in trains])
    rows = max(len(train.grades.from_m) for train in trains)
    columns = UNITS + (2 * units - 1 if units > 1 else 0)
    fleet = Fleet(
        motion=np.array([[unit.motion for unit in train.units] for train in trains], dtype=np.float64),
        sent=np.repeat(starts[:, :, None], REMEMBERED, axis=2),
        grade_row=np.zeros(shape, dtype=np.int64),
        told_mps2=np.zeros(shape),
        expected_mps2=np.zeros(shape),
        silent_ticks=np.zeros(shape, dtype=np.int64),
        coupler_n=np.zeros((len(seeds), max(units - 1, 1))),
        wind_mps2=np.array([train.wind.accel_mps2 for train in trains]),
        # No train gets as far as the rows that fill the table.
        from_m=_table([train.grades.from_m for train in trains], rows, np.inf),
        permil=_table([train.grades.permil for train in trains], rows, 0.0),
        slope_permil_per_m=_table([train.grades.slope_permil_per_m for train in trains], rows, 0.0),
        left=np.zeros(len(seeds), dtype=np.int64),
        position_m=np.zeros((len(seeds), ticks)),
        truth=np.zeros((len(seeds), ticks, columns), dtype=np.int32),
    )
    return common, fleet


def _table(rows: Sequence[Sequence[float]], length: int, rest: float) -> Floats:
    found = np.full((len(rows), length), rest)
    for index, row in enumerate(rows):
        found[index, : len(row)] = row
    return found


def wind_normals(seeds: Sequence[int], ticks: int) -> Floats:
    """Standard normal numbers of the wind after each tick, shape (N, ticks); its first value has had the first."""
    return np.stack([streams.generator(seed, streams.WIND).standard_normal(ticks + 1)[1:] for seed in seeds])


def noise_normals(seeds: Sequence[int], units: int, ticks: int, every: int) -> Floats:
    """Standard normal numbers of the readings at every so many ticks, shape (N, readings, units).

    Every tick draws one for each unit, in the order of the units.
    """

    def one(seed: int) -> Any:
        numbers = streams.generator(seed, streams.SPEED_NOISE).standard_normal(ticks * units)
        return numbers.reshape(ticks, units)[::every].copy()

    return np.stack([one(seed) for seed in seeds])
