"""A recorded run of the system ``stop`` as arrays, and its measurements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.judge.record_checks import STAMP_ERROR_MAX_S
from railhil.record.trace import FloatArray, Trace
from railhil.wire.stop import BrakeCommand, Truth

#: The jerk is taken over this time.
_JERK_S = 0.192


@dataclass(frozen=True)
class Approach:
    """Arrays of shape (n,) at the instants of TRUTH.

    ``drive_mps2``: acceleration by traction and brake. ``command_mps2``: shape (m,), one number for each BRAKE_CMD.
    ``stopped_s``: time of the first standstill; None: the train did not stop.
    """

    scenario: Any
    time_s: FloatArray
    position_m: FloatArray
    speed_mps: FloatArray
    drive_mps2: FloatArray
    command_mps2: FloatArray
    stopped_s: float | None

    @classmethod
    def of(cls, scenario: Any, trace: Trace) -> Approach:
        """The approach of a record."""
        truth = Truth.PORT
        stops = np.flatnonzero(trace.raw(RunEvent.PORT, "RunEvent") == Event.STOPPED)
        return cls(
            scenario,
            trace.times_s(truth),
            trace.values(truth, "TruePos"),
            trace.values(truth, "TrueSpeed"),
            trace.values(truth, "TrueDrive"),
            trace.values(BrakeCommand.PORT, "CmdAccel"),
            float(trace.values(RunEvent.PORT, "EventTime")[stops[0]]) if len(stops) else None,
        )

    @property
    def error_m(self) -> FloatArray:
        """Position less stopping point."""
        stop_m: float = self.scenario.task.stop_m
        return self.position_m - stop_m

    def end_unclear(self, end_s: float) -> str:
        """The gap of the record at the standstill, as a reason; empty if the record shows the standstill.

        :param end_s: end of the record.
        """
        unseen_s = end_s - float(self.time_s[-1])
        if self.stopped_s is None or self.speed_mps[-1] == 0.0 or unseen_s <= STAMP_ERROR_MAX_S:
            return ""
        return f"record: no {Truth.PORT} for {unseen_s:.2f} s before its end shows where the train stands"

    def stop_error_m(self) -> float | None:
        """Standstill less stopping point, overshoot positive; None if the train does not stand at the end."""
        stands = self.stopped_s is not None and self.speed_mps[-1] == 0.0
        return float(self.error_m[-1]) if stands else None

    def overshoot_m(self) -> float | None:
        """Distance of the standing train behind the stopping point; 0 before it."""
        error_m = self.stop_error_m()
        return None if error_m is None else max(0.0, error_m)

    def running_time_s(self) -> float | None:
        """Time from the start of the run to the standstill."""
        return self.stopped_s

    def jerk_mps3(self) -> float | None:
        """Largest change of the acceleration by traction and brake, over :data:`_JERK_S`, until the standstill.

        The instants are found by their times: a missing telegram does not change the time between the others.
        """
        moves = self.speed_mps > 0.0
        time_s, drive_mps2 = self.time_s[moves], self.drive_mps2[moves]
        if len(time_s) < 2:
            return None
        step_s = float(np.median(np.diff(self.time_s)))
        later_s = time_s + max(1, round(_JERK_S / step_s)) * step_s
        later = np.searchsorted(time_s, later_s - step_s / 2)
        there = np.flatnonzero(later < len(time_s))
        there = there[np.abs(time_s[later[there]] - later_s[there]) < step_s / 2]
        if not len(there):
            return None
        return float(np.abs(drive_mps2[later[there]] - drive_mps2[there]).max()) / _JERK_S

    def brake_travel_mps2(self) -> float | None:
        """Sum of all changes of the command: a brake that is commanded once travels its rate."""
        return float(np.abs(np.diff(self.command_mps2)).sum()) if len(self.command_mps2) else None
