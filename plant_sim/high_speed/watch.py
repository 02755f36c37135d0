"""The watch of a power unit: its own reactions when commands stay away, or its brake does not answer.

============================================== ==================================================================
seen                                           reaction
============================================== ==================================================================
no new command for three periods               as the scenario says: traction cut, or the service brake
the controller says that it has no readings    the same, until it has readings again
braking told, less than 0.4 of it done for 2 s  traction cut to the end of the run: the unit takes no more commands
============================================== ==================================================================
"""

from __future__ import annotations

from railhil.plant_sim.brake_watch import answer_ticks, brake_looked_at, share_of
from railhil.wire.high_speed import UnitCause, UnitLevel
from railhil.wire.power_units import SAFE


class UnitWatch:
    """The watch of one unit.

    :param stale_ticks: age of the last command at which the unit acts by itself.
    :param alone: level and command of a unit that acts by itself.
    :param tick_s: duration of a tick.
    :param lag_s: lag of the unit, by its data.
    """

    def __init__(self, stale_ticks: int, alone: tuple[UnitLevel, float], tick_s: float, lag_s: float) -> None:
        self.level = UnitLevel.NORMAL
        self.cause = UnitCause.NONE
        self._stale_ticks = stale_ticks
        self._alone = alone
        self._heard = -1
        self._answer_ticks = answer_ticks(tick_s)
        self._share = share_of(tick_s, lag_s)
        self._expected_mps2 = 0.0
        self._silent_ticks = 0

    def command(self, tick: int, accel_mps2: float, mode: int) -> float | None:
        """Take a command accepted at a tick; returns the command that the unit carries out, None to keep the present
        one."""
        self._heard = tick
        if self.cause is UnitCause.BRAKE_NOT_ANSWERING:
            return None
        if mode == SAFE:
            return self._act(UnitCause.CONTROLLER_SAFE)
        self.level, self.cause = UnitLevel.NORMAL, UnitCause.NONE
        return accel_mps2

    def look(self, tick: int, told_mps2: float, drive_mps2: float) -> float | None:
        """End a tick; returns a command that the unit gives itself, None to keep the present one.

        :param told_mps2: braking that should act, <= 0.
        :param drive_mps2: acceleration by traction and brake.
        """
        if self.cause is UnitCause.BRAKE_NOT_ANSWERING:
            return None
        self._expected_mps2, self._silent_ticks = brake_looked_at(
            self._expected_mps2, self._silent_ticks, told_mps2, drive_mps2, self._share
        )
        if self._silent_ticks >= self._answer_ticks:
            self.level, self.cause = UnitLevel.TRACTION_CUT, UnitCause.BRAKE_NOT_ANSWERING
            return 0.0
        if self.level is UnitLevel.NORMAL and tick - self._heard >= self._stale_ticks:
            return self._act(UnitCause.COMMAND_AGE)
        return None

    def _act(self, cause: UnitCause) -> float:
        self.level, accel_mps2 = self._alone
        self.cause = cause
        return accel_mps2
