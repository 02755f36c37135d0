"""The compiled loop over the ticks of many high-speed trains, with the plant's own functions.

It has the operations of :meth:`railhil.plant_sim.high_speed.train.HighSpeedTrain.advance` in the same order.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from railhil.batch import compiled
from railhil.common.compilable import larger, smaller
from railhil.plant_sim.high_speed import dynamics, watch
from railhil.plant_sim.high_speed import train as train_module
from railhil.plant_sim.high_speed.dynamics import Drive, Grades, UnitMotion, coupler_n, joined, moved
from railhil.plant_sim.high_speed.train import REMEMBERED, STEP_S
from railhil.plant_sim.high_speed.watch import brake_looked_at
from railhil.wire import power_units
from railhil.wire.power_units import TRUE_PER_UNIT

#: Columns of the truth before the columns of units and couplers.
SPEED, DRIVE, STANDS, UNITS = range(4)
COUPLER_MAX = 0x7FFF
#: Sources of the machine code.
_SOURCES = (__file__, dynamics, train_module, watch, power_units)


class Common(NamedTuple):
    """What all trains share; arrays have one entry for each unit.

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
