"""The train's own watch of NOTCH_CMD: a reaction ladder that stops the train when commands no longer arrive.

============== ========================================= =================================== ========================
level          entered when                              what the train does                 left on
============== ========================================= =================================== ========================
NORMAL         age <= hold                               follows the commands
HOLD           age > hold                                keeps the last accepted notch       1 good command
TRACTION_CUT   age > traction cut, notch out of range,   no traction, braking kept           5 good in a row
               too large a step, 3 bad in 10
SERVICE_BRAKE  age > service brake, before the first     full service brake, jerk limited    standstill and 1 good, or
               accepted command, two controllers                                             10 good in a row and below
                                                                                             the speed limit
EMERGENCY      age > emergency while moving, overspeed,  all the brake has, at once          never in a run
               emergency command, safety loop open,
               a check of train_checks.py
============== ========================================= =================================== ========================

The age is the simulation time since the last accepted command; "in a row" means that each command came within the hold
limit after the previous one, with nothing suspicious between them. Leaving any level leads to NORMAL. The thresholds
are scenario data (:class:`railhil.systems.ato.scenario.model.WatchLimits`).

The batch compiles the functions that are marked at the end (:mod:`railhil.common.compilable` lists the permitted
language).
"""

from __future__ import annotations

from math import inf
from typing import Final, NamedTuple

from railhil.common.compilable import compilable_functions
from railhil.common.floats import larger, smaller
from railhil.systems.ato.scenario.model import WatchLimits
from railhil.wire.ato import WatchCause, WatchLevel

#: Good commands in a row that end TRACTION_CUT.
GOOD_AFTER_TRACTION_CUT: Final = 5
#: Good commands in a row that end SERVICE_BRAKE of a moving train.
GOOD_AFTER_SERVICE_BRAKE: Final = 10
#: How fast the service brake builds up and is released.
SERVICE_BRAKE_JERK_MPS3: Final = 0.75

_NS_PER_MS: Final = 1_000_000


# Looking up a member of an enum costs as much as a call on CPython 3.11, and the watch is stepped in every tick.
_NORMAL: Final = WatchLevel.NORMAL
_HOLD: Final = WatchLevel.HOLD
_TRACTION_CUT: Final = WatchLevel.TRACTION_CUT
_SERVICE_BRAKE: Final = WatchLevel.SERVICE_BRAKE
_EMERGENCY: Final = WatchLevel.EMERGENCY

#: Level that each finding of the gate (:mod:`railhil.plant_sim.ato.gate`) demands.
SUSPICIONS: Final = {
    WatchCause.NONE: WatchLevel.NORMAL,
    WatchCause.BAD_COMMANDS: WatchLevel.TRACTION_CUT,
    WatchCause.NOTCH_RANGE: WatchLevel.TRACTION_CUT,
    WatchCause.NOTCH_STEP: WatchLevel.TRACTION_CUT,
    WatchCause.TWO_SOURCES: WatchLevel.SERVICE_BRAKE,
}


class WatchTicks(NamedTuple):
    """Largest age in base ticks that is still below each level."""

    hold: int
    traction_cut: int
    service_brake: int
    emergency: int


class CommandWatchState(NamedTuple):
    """Level, age of the last accepted command in ticks, accepted commands in a row (counted up to the largest number
    needed)."""

    level: WatchLevel
    age_ticks: int
    good: int


#: Until the first command is accepted, the brake holds the train.
INITIAL = CommandWatchState(WatchLevel.SERVICE_BRAKE, 0, 0)


def watch_ticks(limits: WatchLimits, base_tick_ns: int) -> WatchTicks:
    """Limits in whole ticks: an age of at most this many ticks is within the limit in ms."""
    return WatchTicks(
        limits.hold_ms * _NS_PER_MS // base_tick_ns,
        limits.traction_cut_ms * _NS_PER_MS // base_tick_ns,
        limits.service_brake_ms * _NS_PER_MS // base_tick_ns,
        limits.emergency_ms * _NS_PER_MS // base_tick_ns,
    )


def watch_step(
    limits: WatchTicks,
    state: CommandWatchState,
    accepted: bool,
    suspicion: WatchLevel,
    moving: bool,
    below_limit: bool,
    emergency: bool,
) -> CommandWatchState:
    """State of the ladder one tick later.

    :param accepted: a command was accepted at this tick.
    :param suspicion: level demanded by the gate's findings in the commands of this tick, NORMAL for none.
    :param moving: the train is not at standstill.
    :param below_limit: the speed is below the limit of the line and the train.
    :param emergency: overspeed, an emergency command, an open safety loop, or a check of the train's forces and place.
    """
    level, age, good = state
    age += 1
    if age > limits.hold:
        good = 0
    if accepted:
        age = 0
        if good < GOOD_AFTER_SERVICE_BRAKE:
            good += 1
    if suspicion > _NORMAL:
        good = 0
    if level == _EMERGENCY or emergency:
        # There is no stronger level. In the batch's code a level is a number, also after the assignment.
        if level < _EMERGENCY:
            level = _EMERGENCY
        return CommandWatchState(level, age, good)
    if _may_leave(level, good, moving, below_limit):
        level = _NORMAL
    demanded: WatchLevel = _NORMAL
    if age > limits.hold:
        demanded = _HOLD
        if age > limits.traction_cut:
            demanded = _TRACTION_CUT
        if age > limits.service_brake:
            demanded = _SERVICE_BRAKE
        if age > limits.emergency and moving:
            demanded = _EMERGENCY
    if suspicion > demanded:
        demanded = suspicion
    if demanded > level:
        level = demanded
    return CommandWatchState(level, age, good)


def _may_leave(level: WatchLevel, good: int, moving: bool, below_limit: bool) -> bool:
    if level <= _HOLD:
        return good >= 1
    if level == _TRACTION_CUT:
        return good >= GOOD_AFTER_TRACTION_CUT
    return (not moving and good >= 1) or (good >= GOOD_AFTER_SERVICE_BRAKE and below_limit)


def watch_brake_mps2(
    level: WatchLevel,
    brake_mps2: float,
    braking_now_mps2: float,
    moving: bool,
    step_s: float,
    service_mps2: float,
) -> float:
    """Deceleration that the watch demands over the next step, in m/s2 on the inertial mass; infinite: full brake force.

    :param brake_mps2: the demand over the last step.
    :param braking_now_mps2: present deceleration, from which the service brake builds up without a dip.
    """
    if level == _EMERGENCY:
        return inf
    if level == _SERVICE_BRAKE:
        if not moving:
            return service_mps2
        return smaller(service_mps2, larger(brake_mps2, braking_now_mps2) + SERVICE_BRAKE_JERK_MPS3 * step_s)
    if not moving:
        return 0.0
    return larger(0.0, brake_mps2 - SERVICE_BRAKE_JERK_MPS3 * step_s)


compilable_functions(watch_step, _may_leave, watch_brake_mps2)
