"""A recorded run of a high-speed train as arrays, and its measurements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from railhil.bus.telegrams import RunEvent
from railhil.record.trace import FloatArray, Trace
from railhil.systems.high_speed import EVENTS
from railhil.wire.power_units import Wire, wire

#: Below this target speed the run is not scored: the holding brake acts, and no linear model is valid.
SCORED_FROM_MPS = 0.5
#: The slope of the command is taken over this time: the sampling period of the papers.
_SLOPE_S = 1.0
_KMH = 3.6
_J_PER_KWH = 3.6e6


@dataclass(frozen=True)
class Ride:
    """Arrays of shape (n,) at the instants of TRUTH.

    ``drive_mps2``: acceleration by traction and brake. ``command_mps2``: mean of the units' last commands.
    ``coupler_n``: force of each coupler, shape (couplers, n).
    """

    scenario: Any
    time_s: FloatArray
    position_m: FloatArray
    speed_mps: FloatArray
    drive_mps2: FloatArray
    target_mps: FloatArray
    command_mps2: FloatArray
    coupler_n: FloatArray
    #: Speed of each unit, shape (units, n).
    unit_mps: FloatArray
    #: Time and position of the reached milestones.
    emergency: tuple[float, float] | None
    arrived: tuple[float, float] | None

    @classmethod
    def of(cls, scenario: Any, trace: Trace) -> Ride:
        """The ride of a record."""
        ports: Wire = wire(len(scenario.task.unit))
        truth = ports.truth.PORT
        time_s = trace.times_s(truth)
        commands = [_held(trace, kind.PORT, kind.signals()[0][1].name, time_s) for kind in ports.commands]
        couplers = [trace.values(truth, f"Coupler{unit}") * 1000.0 for unit in range(1, len(ports.commands))]
        return cls(
            scenario,
            time_s,
            trace.values(truth, "TruePos"),
            trace.values(truth, "TrueSpeed"),
            trace.values(truth, "TrueDrive"),
            trace.values(truth, "Target"),
            np.mean(commands, axis=0),
            np.array(couplers),
            np.array([trace.values(truth, name) for name in _speed_names(len(ports.commands))]),
            milestone(trace, "emergency_called"),
            milestone(trace, "arrived"),
        )

    @property
    def error_kmh(self) -> FloatArray:
        """Speed less target."""
        return (self.speed_mps - self.target_mps) * _KMH

    @property
    def scored(self) -> Any:
        """Mask of the scored part of the run."""
        return self.target_mps >= SCORED_FROM_MPS

    def rmse_kmh(self) -> float | None:
        """Root mean square of the error of the speed."""
        return _rms(self.error_kmh[self.scored])

    def max_error_kmh(self) -> float | None:
        """Largest error of the speed."""
        error = np.abs(self.error_kmh[self.scored])
        return float(error.max()) if len(error) else None

    def emergency_rmse_kmh(self) -> float | None:
        """RMSE from the trigger of the emergency on."""
        if self.emergency is None:
            return None
        return _rms(self.error_kmh[self.scored & (self.time_s >= self.emergency[0])])

    def slope_mps3(self) -> float | None:
        """Root mean square of the slope of the mean command, over steps of one second."""
        at_s = np.arange(self.time_s[0], self.time_s[-1], _SLOPE_S)
        rows = np.searchsorted(self.time_s, at_s + 1e-9, side="right") - 1
        return _rms(np.diff(self.command_mps2[rows]) / _SLOPE_S)

    def energy_kwh(self) -> float:
        """Work of the traction at the wheels; nothing is regained by braking."""
        task = self.scenario.task
        power_w = np.clip(self.drive_mps2, 0.0, None) * self.speed_mps
        power_w *= task.mass_t * 1000.0 * (1.0 + task.rotating_mass_share)
        return float(np.sum((power_w[1:] + power_w[:-1]) * np.diff(self.time_s)) / (2.0 * _J_PER_KWH))

    def arrival_error_m(self) -> float | None:
        """Standstill less stopping point; None after an emergency or without a standstill."""
        if self.arrived is None or self.emergency is not None:
            return None
        target_m: float = self.scenario.task.curve.distance_km * 1000.0
        return self.arrived[1] - target_m

    def emergency_stop_m(self) -> float | None:
        """Distance from the trigger of the emergency to the standstill."""
        if self.arrived is None or self.emergency is None:
            return None
        return self.arrived[1] - self.emergency[1]

    def units_rmse_kmh(self) -> float | None:
        """Root mean square of the errors of all units."""
        errors = (self.unit_mps - self.target_mps)[:, self.scored] * _KMH
        return _rms(errors.ravel())

    def spread_kmh(self) -> float | None:
        """Largest difference between the speeds of two units."""
        apart = (self.unit_mps.max(axis=0) - self.unit_mps.min(axis=0))[self.scored]
        return float(apart.max()) * _KMH if len(apart) else None

    def coupler_peak_kn(self) -> float | None:
        """Largest force of any coupler; None for a train without couplers."""
        return float(np.abs(self.coupler_n).max()) / 1000.0 if self.coupler_n.size else None


def milestone(trace: Trace, name: str) -> tuple[float, float] | None:
    """Time in s and position in m of one of the system's milestones; None: it was not reached."""
    rows = np.flatnonzero(trace.raw(RunEvent.PORT, "RunEvent") == EVENTS[name])
    if not len(rows):
        return None
    found = (trace.values(RunEvent.PORT, signal)[rows[0]] for signal in ("EventTime", "EventPos"))
    time_s, position_m = map(float, found)
    return time_s, position_m


def _held(trace: Trace, port: str, signal: str, time_s: FloatArray) -> FloatArray:
    """A signal at given instants, each time its last value; 0 before the first."""
    values = np.concatenate(([0.0], trace.values(port, signal)))
    return values[np.searchsorted(trace.times_s(port), time_s + 1e-9, side="right")]


def _speed_names(units: int) -> list[str]:
    return ["TrueSpeed"] if units == 1 else [f"TrueSpeed{unit}" for unit in range(1, units + 1)]


def _rms(values: FloatArray) -> float | None:
    return float(np.sqrt(np.mean(values * values))) if len(values) else None
