"""The train's own watch: its reactions when commands stay away, or when its brake does not answer.

================================================ ================================================================
seen                                             reaction
================================================ ================================================================
no new command for three periods, or the         braking: the last command is held for a second, then at least the
controller says that it has no readings          service brake; not braking: traction is cut for a second, then the
                                                 service brake. New commands end it
braking told, less than 0.4 of it done for 2 s   emergency brake to the end of the run
================================================ ================================================================
"""

from __future__ import annotations

from railhil.plant_sim.brake_watch import STALE_PERIODS, answer_ticks, brake_looked_at, share_of
from railhil.wire.stop import BrakeCause, BrakeLevel

#: Commands below this are braking.
BRAKING_MPS2 = -0.02
#: How long the last command is held, or the train coasts, before the service brake.
HOLD_NS = 1_000_000_000


class StopWatch:
    """The watch of the train.

    :param period_ns: of the commands.
    :param service_mps2: deceleration of the service brake.
    :param lag_s: of the brake, by its data.
    """

    def __init__(self, tick_ns: int, period_ns: int, service_mps2: float, lag_s: float) -> None:
        self.level = BrakeLevel.NORMAL
        self.cause = BrakeCause.NONE
        self._service_mps2 = service_mps2
        self._stale_ticks = STALE_PERIODS * period_ns // tick_ns
        self._hold_ticks = HOLD_NS // tick_ns
        self._answer_ticks = answer_ticks(tick_ns / 1e9)
        self._share = share_of(tick_ns / 1e9, lag_s)
        self._heard = -1
        self._since = 0
        self._last_mps2 = 0.0
        self._expected_mps2 = 0.0
        self._silent_ticks = 0

    def command(self, tick: int, accel_mps2: float, valid: bool) -> float | None:
        """Take a command accepted at a tick; returns the command to carry out, None to keep the present one."""
        self._heard = tick
        if self.level is BrakeLevel.EMERGENCY:
            return None
        if not valid:
            return self._alone(tick, BrakeCause.CONTROLLER_SAFE)
        self.level, self.cause, self._last_mps2 = BrakeLevel.NORMAL, BrakeCause.NONE, accel_mps2
        return accel_mps2

    def look(self, tick: int, told_mps2: float, drive_mps2: float, stands: bool) -> float | None:
        """End a tick; returns a command that the train gives itself, None to keep the present one.

        :param told_mps2: braking that should act, <= 0.
        :param drive_mps2: acceleration by traction and brake.
        :param stands: a standing train has nothing left to do.
        """
        if self.level is BrakeLevel.EMERGENCY:
            return None
        self._expected_mps2, self._silent_ticks = brake_looked_at(
            self._expected_mps2, self._silent_ticks, told_mps2, drive_mps2, self._share
        )
        if stands:
            self._silent_ticks = 0
        if self._silent_ticks >= self._answer_ticks:
            self.level, self.cause = BrakeLevel.EMERGENCY, BrakeCause.BRAKE_NOT_ANSWERING
            return min(self._last_mps2, -self._service_mps2)
        if tick - self._heard >= self._stale_ticks:
            return self._alone(tick, BrakeCause.COMMAND_AGE)
        return None

    def _alone(self, tick: int, cause: BrakeCause) -> float:
        """The train's reaction without usable commands."""
        if self.level is BrakeLevel.NORMAL:
            self._since, self.cause = tick, cause
        brakes = self._last_mps2 < BRAKING_MPS2
        if tick - self._since >= self._hold_ticks:
            self.level = BrakeLevel.SERVICE_BRAKE
            return min(self._last_mps2, -self._service_mps2)
        self.level = BrakeLevel.HOLD if brakes else BrakeLevel.TRACTION_CUT
        return self._last_mps2 if brakes else 0.0
