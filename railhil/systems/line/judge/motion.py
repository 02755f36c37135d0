"""The train's motion as SIM_TRUTH shows it: arrays, standstills, and whether its telegrams fit together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Final

import numpy as np

from railhil.judge.record_checks import STAMP_ERROR_MAX_S, UNCLEAR
from railhil.judge.stops import Standstill
from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.judge.score import ACCEL_MAX_MPS2, STANDING_S
from railhil.wire.ato import SimTruth

#: Resolution of positions and speeds on the wire, with some margin.
_LSB_M: Final = 1e-3


@dataclass(frozen=True, slots=True)
class Motion:
    """Arrays of shape (n,), one entry for each SIM_TRUTH: time in s (increasing), position in m, speed in m/s,
    acceleration in m/s2, forces in N."""

    time_s: FloatArray
    position_m: FloatArray
    speed_mps: FloatArray
    accel_mps2: FloatArray
    traction_n: FloatArray
    brake_n: FloatArray

    @classmethod
    def of(cls, trace: Trace) -> Motion:
        """From a record. A telegram that was recorded twice counts once, so that the times increase."""
        time_s = trace.times_s(SimTruth.PORT)
        names = ("TruePos", "TrueSpeed", "TrueAccel", "TractionForce", "BrakeForce")
        fresh = np.diff(time_s, prepend=-1.0) > 0
        return cls(time_s[fresh], *(trace.values(SimTruth.PORT, name)[fresh] for name in names))

    def between(self, from_s: float, until_s: float) -> Motion:
        """The part of an interval of time, both ends included."""
        first, after = np.searchsorted(self.time_s, [from_s, np.nextafter(until_s, np.inf)])
        return Motion(*(getattr(self, item.name)[first:after] for item in fields(self)))

    def speeds_at(self, time_s: FloatArray) -> FloatArray:
        """Speed at each of some instants, m/s, shape of ``time_s``."""
        return np.interp(time_s, self.time_s, self.speed_mps)

    def positions_at(self, time_s: FloatArray) -> FloatArray:
        """Position at each of some instants, m, shape of ``time_s``."""
        return np.interp(time_s, self.time_s, self.position_m)

    def standstills(self) -> Iterator[tuple[float, Standstill]]:
        """Each standstill of at least :data:`~railhil.systems.ato.judge.score.STANDING_S` with the instant of its end
        in s."""
        rest = (self.speed_mps == 0.0).astype(np.int8)
        edges = np.flatnonzero(np.diff(rest, prepend=0, append=0))
        for first, after in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            begun_s, until_s = float(self.time_s[first]), float(self.time_s[after - 1])
            if until_s - begun_s >= STANDING_S:
                yield until_s, Standstill(begun_s, float(self.position_m[first]))

    def jump(self) -> str:
        """The first two telegrams that no train can have sent one after the other, as a reason; empty if there are
        none.

        A time stamp may be wrong by :data:`~railhil.judge.record_checks.STAMP_ERROR_MAX_S`.
        """
        gap_s = np.diff(self.time_s)
        mean_mps = (self.speed_mps[1:] + self.speed_mps[:-1]) / 2
        allowed_m = np.abs(mean_mps) * STAMP_ERROR_MAX_S + ACCEL_MAX_MPS2 / 8 * gap_s**2 + _LSB_M
        allowed_mps = ACCEL_MAX_MPS2 * np.maximum(gap_s, STAMP_ERROR_MAX_S)
        far = np.abs(np.diff(self.position_m) - mean_mps * gap_s) > allowed_m
        fast = np.abs(np.diff(self.speed_mps)) > allowed_mps
        wrong = np.flatnonzero(far | fast)
        if not len(wrong):
            return ""
        before, after = int(wrong[0]), int(wrong[0]) + 1
        shown = [
            f"{self.position_m[at]:.2f} m with {self.speed_mps[at]:.2f} m/s at {self.time_s[at]:.2f} s"
            for at in (before, after)
        ]
        return f"{UNCLEAR}SIM_TRUTH shows the train at {shown[0]} and at {shown[1]}"
