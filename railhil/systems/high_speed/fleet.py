"""Trains of some seeds at the start of their runs, their random numbers, and the targets from the wayside."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.plant_sim.high_speed.dynamics import Coupler
from railhil.plant_sim.high_speed.train import REMEMBERED, STEP_S, HighSpeedTrain, Wayside
from railhil.plant_sim.high_speed.watch import answer_ticks, share_of
from railhil.scenarios import streams
from railhil.systems.high_speed.kernel import UNITS, Common, Fleet
from railhil.systems.high_speed.task import HighSpeedTask

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
    """Standard normal numbers of the readings at a fixed interval of ticks, shape (N, readings, units).

    Every tick draws one for each unit, in the order of the units.
    """

    def one(seed: int) -> Any:
        numbers = streams.generator(seed, streams.SPEED_NOISE).standard_normal(ticks * units)
        return numbers.reshape(ticks, units)[::every].copy()

    return np.stack([one(seed) for seed in seeds])


class Waysides:
    """The waysides of N trains: the same target speeds, until an emergency gives a train its own.

    :param tick_s: duration of a tick.
    """

    def __init__(self, task: HighSpeedTask, tick_s: float, trains: int) -> None:
        self._task = task
        self._tick_s = tick_s
        self._trains = trains
        self._common = Wayside(task, tick_s)
        #: Trains with an emergency: the tick of the trigger, and their own wayside.
        self.called: dict[int, tuple[int, Wayside]] = {}

    def look(self, first_tick: int, position_m: NDArray[np.float64]) -> None:
        """Check the trains at some ticks, one after the other.

        :param position_m: shape (N, ticks).
        """
        if self._task.emergency is None:
            return
        reached = position_m >= self._task.emergency.at_km * 1000.0
        for train in np.flatnonzero(reached.any(axis=1)).tolist():
            if train not in self.called:
                place = int(np.argmax(reached[train]))
                own = Wayside(self._task, self._tick_s)
                own.look(first_tick + place, float(position_m[train, place]))
                self.called[train] = first_tick + place, own

    def readings(self, tick: int) -> list[NDArray[np.int64]]:
        """Readings of a law in the order of the interface: the targets ahead, the present one, the emergency."""
        now, *ahead = self._common.preview_raw(tick)
        rows = [np.full(self._trains, raw, dtype=np.int64) for raw in (*ahead, now, 0)]
        for train, (_, own) in self.called.items():
            now, *ahead = own.preview_raw(tick)
            for row, raw in zip(rows, (*ahead, now, 1), strict=True):
                row[train] = raw
        return rows

    def targets_mps(self, ticks: int) -> NDArray[np.float64]:
        """Target speeds of a train without an emergency at all ticks, shape (ticks,)."""
        return np.array([self._common.target_mps(tick) for tick in range(ticks)])

    def own_targets_mps(self, train: int, common_mps: NDArray[np.float64]) -> NDArray[np.float64]:
        """Target speeds of a train at all ticks, shape (ticks,).

        :param common_mps: :meth:`targets_mps`.
        """
        if train not in self.called:
            return common_mps
        first, own = self.called[train]
        rest = [own.target_mps(tick) for tick in range(first, len(common_mps))]
        return np.concatenate((common_mps[:first], rest))
