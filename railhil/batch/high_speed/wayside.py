"""What the wayside tells many trains: the same target speeds, until an emergency gives a train its own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railhil.plant_sim.high_speed.train import Wayside
from railhil.scenarios.high_speed.task import HighSpeedTask


class Waysides:
    """The waysides of N trains.

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
        """Look at the trains at some ticks, one after the other.

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
