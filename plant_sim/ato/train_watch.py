"""The train's own watch of its commands (:mod:`railhil.plant_sim.ato.command_watch`), tick by tick."""

from __future__ import annotations

from typing import Final

from railhil.plant_sim.ato.command_watch import (
    INITIAL,
    SUSPICIONS,
    CommandWatchState,
    watch_brake_mps2,
    watch_step,
    watch_ticks,
)
from railhil.systems.ato.scenario.model import WatchLimits
from railhil.wire.ato import WatchCause, WatchLevel

# Looking up a member of an enum costs as much as a call on CPython 3.11, and these are needed in every tick.
_NOTHING: Final = WatchCause.NONE
_NO_DEMAND: Final = WatchLevel.NORMAL


class TrainWatch:
    """The watch of one train: it takes what the commands of a tick say, then it is stepped.

    :param service_braking_mps2: demand at the beginning, when the brake holds the train.
    :ivar state: its level, and the age of the last accepted command.
    :ivar cause: for which it has entered its level.
    :ivar brake_mps2: deceleration that it demands, on the inertial mass; infinite: full brake force.
    """

    def __init__(self, limits: WatchLimits, base_tick_ns: int, service_braking_mps2: float) -> None:
        self.state = INITIAL
        self.cause: WatchCause = WatchCause.NO_COMMAND
        self.brake_mps2 = service_braking_mps2
        self._limits = watch_ticks(limits, base_tick_ns)
        self._step_s = base_tick_ns * 1e-9
        self._accepted = False
        self._emergency_commanded = False
        self._suspicion: WatchCause = _NOTHING

    def command(self, emergency: bool) -> None:
        """Take an accepted command of the present tick; an emergency is latched."""
        self._accepted = True
        if emergency:
            self._emergency_commanded = True

    def suspect(self, cause: WatchCause) -> None:
        """Take the gate's finding in a command of the present tick; the strongest of several counts."""
        if SUSPICIONS[cause] > SUSPICIONS[self._suspicion]:
            self._suspicion = cause

    def step(self, moving: bool, below_limit: bool, emergency: WatchCause) -> None:
        """Advance the watch by a tick.

        :param below_limit: the speed is below the limit of the line and the train.
        :param emergency: what demands the emergency brake besides the commands; NONE: nothing does.
        """
        before, suspicion, is_commanded = self.state, self._suspicion, self._emergency_commanded
        self.state = state = watch_step(
            self._limits,
            before,
            self._accepted,
            SUSPICIONS[suspicion] if suspicion else _NO_DEMAND,
            moving,
            below_limit,
            is_commanded or emergency is not _NOTHING,
        )
        self._accepted = False
        self._suspicion = _NOTHING
        if state.level == before.level:
            return
        if state.level == WatchLevel.NORMAL:
            self.cause = _NOTHING
        elif is_commanded:
            self.cause = WatchCause.EMERGENCY_COMMAND
        else:
            self.cause = emergency or self._cause_of_commands(state, suspicion)

    def _cause_of_commands(self, state: CommandWatchState, suspicion: WatchCause) -> WatchCause:
        # The age of the command is named if it demands this level, too.
        by_age = state.age_ticks > self._limits.service_brake or (
            state.age_ticks > self._limits.traction_cut and state.level <= WatchLevel.TRACTION_CUT
        )
        return suspicion if suspicion and not by_age else WatchCause.COMMAND_AGE

    def brake(self, braking_now_mps2: float, moving: bool, service_braking_mps2: float) -> None:
        """Find the demand of the coming tick.

        :param braking_now_mps2: present deceleration, from which the service brake builds up without a dip.
        """
        self.brake_mps2 = watch_brake_mps2(
            self.state.level, self.brake_mps2, braking_now_mps2, moving, self._step_s, service_braking_mps2
        )
