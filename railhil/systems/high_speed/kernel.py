"""The compiled loop over the ticks of many high-speed trains, with the plant's own functions.

It has the operations of :meth:`railhil.plant_sim.high_speed.train.HighSpeedTrain.advance` in the same order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.batch import compiled
from railhil.common.compilable import larger, smaller
from railhil.plant_sim import brake_watch
from railhil.plant_sim.brake_watch import answer_ticks, brake_looked_at, share_of
from railhil.plant_sim.high_speed import dynamics
from railhil.plant_sim.high_speed import train as train_module
from railhil.plant_sim.high_speed.dynamics import Coupler, Drive, Grades, UnitMotion, coupler_n, joined, moved
from railhil.plant_sim.high_speed.train import REMEMBERED, STEP_S, HighSpeedTrain, Wayside
from railhil.scenarios import streams
from railhil.systems.high_speed.task import HighSpeedTask
from railhil.wire import power_units
from railhil.wire.power_units import TRUE_PER_UNIT

#: Columns of the truth before the columns of units and couplers.
SPEED, DRIVE, STANDS, UNITS = range(4)
COUPLER_MAX = 0x7FFF
#: Sources of the machine code.
_SOURCES = (__file__, dynamics, train_module, brake_watch, power_units)


class Common(NamedTuple):
    """Values that all trains share; arrays have one entry for each unit.

    ``coupler``: of no use unless ``coupled``.
    """

    limits: Any
    gain: Any
    decay: Any
    mean: Any
    traction_steps: Any
    braking_steps: Any
    mass_kg: Any
    brake_share: Any
    coupled: bool
    coupler: Any
    steps_per_tick: int
    answer_ticks: int
    wind_keep: float
    wind_add: float


class Fleet(NamedTuple):
    """State and record of N trains of U units; the first index is the train, the second the unit.

    ``motion`` (N, U, 4): a :class:`UnitMotion` each. ``sent`` (N, U, ``REMEMBERED``): the commands on their way.
    ``grade_row``: row of the grades (N, rows) under the unit. ``told_mps2``, ``expected_mps2``, ``silent_ticks``: of
    the watch. ``left``: 1 from the tick on at which a watch has acted. ``position_m`` (N, ticks) and ``truth`` (N,
    ticks, columns; counts of TRUTH) are the record at every tick.
    """

    motion: Any
    sent: Any
    grade_row: Any
    told_mps2: Any
    expected_mps2: Any
    silent_ticks: Any
    coupler_n: Any
    wind_mps2: Any
    from_m: Any
    permil: Any
    slope_permil_per_m: Any
    left: Any
    position_m: Any
    truth: Any


@compiled.part
def _motion(fleet: Any, train: int, unit: int) -> Any:
    row = fleet.motion[train, unit]
    return UnitMotion(row[0], row[1], row[2], row[3])


@compiled.part
def _grades(fleet: Any, train: int, unit: int, position_m: float) -> Any:
    """The grades from the unit's position on: the rows behind it are never needed again."""
    from_m = fleet.from_m[train]
    first = fleet.grade_row[train, unit]
    while first + 1 < from_m.size and from_m[first + 1] <= position_m:
        first += 1
    fleet.grade_row[train, unit] = first
    return Grades(from_m[first:], fleet.permil[train, first:], fleet.slope_permil_per_m[train, first:])


@compiled.part
def _couple(common: Any, fleet: Any, train: int) -> None:
    """Forces of the couplers in the present step."""
    for unit in range(common.gain.size - 1):
        front, rear = _motion(fleet, train, unit), _motion(fleet, train, unit + 1)
        fleet.coupler_n[train, unit] = coupler_n(common.coupler, front, rear, STEP_S)


@compiled.part
def _outside_mps2(common: Any, fleet: Any, train: int, unit: int) -> float:
    """Acceleration of a unit by wind and couplers."""
    outside_mps2: float = fleet.wind_mps2[train]
    if common.coupled:
        pushed_n = fleet.coupler_n[train, unit - 1] if unit > 0 else 0.0
        pulled_n = fleet.coupler_n[train, unit] if unit + 1 < common.gain.size else 0.0
        outside_mps2 += (pushed_n - pulled_n) / common.mass_kg[unit]
    return outside_mps2


@compiled.part
def _step(common: Any, fleet: Any, train: int, unit: int, step: int, command_mps2: float) -> None:
    """A step of one unit: ``PowerUnit.acting_mps2`` and its motion."""
    sent = fleet.sent[train, unit]
    sent[step % REMEMBERED] = command_mps2
    traction = sent[(step - common.traction_steps[unit]) % REMEMBERED]
    braking = sent[(step - common.braking_steps[unit]) % REMEMBERED]
    fleet.told_mps2[train, unit] = braking if braking < 0.0 else 0.0
    now = _motion(fleet, train, unit)
    grades = _grades(fleet, train, unit, now.position_m)
    side = Drive(common.gain[unit], common.decay[unit], common.mean[unit])
    outside_mps2 = _outside_mps2(common, fleet, train, unit)
    after = moved(common.limits, side, grades, now, joined(traction, braking), outside_mps2, STEP_S)
    row = fleet.motion[train, unit]
    row[0], row[1], row[2], row[3] = after.position_m, after.speed_mps, after.drive_mps2, after.accel_mps2


@compiled.part
def _look(common: Any, fleet: Any, train: int) -> None:
    """The watches of the units at the end of a tick; commands never stay away here."""
    for unit in range(common.gain.size):
        expected_mps2, silent = brake_looked_at(
            fleet.expected_mps2[train, unit],
            fleet.silent_ticks[train, unit],
            fleet.told_mps2[train, unit],
            fleet.motion[train, unit, 2],
            common.brake_share[unit],
        )
        fleet.expected_mps2[train, unit], fleet.silent_ticks[train, unit] = expected_mps2, silent
        if silent >= common.answer_ticks:
            fleet.left[train] = 1


@compiled.part
def _record(common: Any, fleet: Any, train: int, tick: int) -> None:
    """The true motion at a tick; sums in the order of the units, as in the plant."""
    units = common.gain.size
    speed = drive = mass_kg = 0.0
    for unit in range(units):
        speed += fleet.motion[train, unit, 1]
        drive += fleet.motion[train, unit, 2] * common.mass_kg[unit]
        mass_kg += common.mass_kg[unit]
    truth = fleet.truth[train, tick]
    speed /= units
    truth[SPEED] = round(speed * TRUE_PER_UNIT)
    truth[DRIVE] = round(drive / mass_kg * TRUE_PER_UNIT)
    truth[STANDS] = 1 if speed == 0.0 else 0
    fleet.position_m[train, tick] = fleet.motion[train, 0, 0]
    if units > 1:
        for unit in range(units):
            truth[UNITS + unit] = round(fleet.motion[train, unit, 1] * TRUE_PER_UNIT)
        for unit in range(units - 1):
            force = round(fleet.coupler_n[train, unit] / 10.0)
            truth[UNITS + units + unit] = smaller(larger(force, -COUPLER_MAX), COUPLER_MAX)


@compiled.cached(*_SOURCES)
def advance_fleet(common: Any, fleet: Any, commands_mps2: Any, normals: Any, from_tick: int, to_tick: int) -> None:
    """Advance every train from one tick to another under one command for each unit.

    :param commands_mps2: shape (N, U).
    :param normals: standard normal numbers of the wind after each tick, shape (N, ticks of the run).
    :param from_tick: -1 records tick 0 and advances nothing.
    """
    for train in range(commands_mps2.shape[0]):
        if from_tick < 0:
            _record(common, fleet, train, 0)
        for tick in range(larger(from_tick, 0), to_tick):
            _look(common, fleet, train)
            for step in range(tick * common.steps_per_tick, (tick + 1) * common.steps_per_tick):
                if common.coupled:
                    _couple(common, fleet, train)
                for unit in range(common.gain.size):
                    _step(common, fleet, train, unit, step, commands_mps2[train, unit])
            fleet.wind_mps2[train] = common.wind_keep * fleet.wind_mps2[train] + common.wind_add * normals[train, tick]
            _record(common, fleet, train, tick + 1)


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
