"""The criteria by which runs of high-speed trains are judged."""

from __future__ import annotations

from typing import Any

from railhil.bus.codes import Event
from railhil.bus.high_speed import Wire, wire
from railhil.bus.telegrams import RunEvent
from railhil.supervisor.criteria import Criterion, Limit, scores, unscored
from railhil.supervisor.high_speed.ride import Ride
from railhil.supervisor.judging import Judging
from railhil.supervisor.score import Score
from railhil.supervisor.trace import Trace

RMSE = Criterion(
    "rmse_kmh", "RMSE", "km/h", 4, Ride.rmse_kmh, limit=Limit(lambda scenario: scenario.task.rmse_max_kmh, 0)
)
EMERGENCY_STOP = Criterion(
    "emergency_stop_m", "emergency stop", "m", 1, Ride.emergency_stop_m,
    limit=Limit(lambda scenario: scenario.task.emergency_stop_max_m, 1),
)  # fmt: skip
CRITERIA = (
    RMSE,
    Criterion("max_error_kmh", "largest error", "km/h", 3, Ride.max_error_kmh),
    Criterion("slope_mps3", "command slope", "m/s3", 4, Ride.slope_mps3),
    Criterion("energy_kwh", "energy", "kWh", 1, Ride.energy_kwh),
    Criterion("arrival_m", "arrival error", "m", 2, Ride.arrival_error_m, signed="arrival_error_m"),
    Criterion("emergency_rmse_kmh", "emergency RMSE", "km/h", 4, Ride.emergency_rmse_kmh),
    EMERGENCY_STOP,
)
#: Further criteria of a train of several units.
OF_UNITS = (
    Criterion("units_rmse_kmh", "RMSE of units", "km/h", 4, Ride.units_rmse_kmh),
    Criterion("spread_kmh", "speed spread", "km/h", 3, Ride.spread_kmh),
    Criterion("coupler_peak_kn", "coupler force", "kN", 1, Ride.coupler_peak_kn),
)
#: How a complete record may end, with the failure that it means.
_ENDINGS = {Event.ENDED_COMPLETE: "", Event.ENDED_NOT_STOPPED: "no commands from the controller any more"}


def score(scenario: Any, trace: Trace) -> Score:
    """PASS or FAIL by the limits of the scenario; INVALID for a record without a normal end."""
    criteria = _criteria(len(scenario.task.unit))
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    ended = next((event for event in _ENDINGS if event in codes), None)
    truth = wire(len(scenario.task.unit)).truth.PORT
    if ended is None or trace.count(truth) < 2:
        return Score("INVALID", *unscored(criteria), ("run did not come to its end",), "record_incomplete")
    ride = Ride.of(scenario, trace)
    measured = {criterion.key: criterion.measure(ride) for criterion in criteria}
    missed = [f"{item.title} {text}" for item in criteria if (text := item.missed(scenario, measured[item.key]))]
    if ride.emergency is not None and ride.arrived is None:
        missed.append("did not stop after the emergency was triggered")
    missed += filter(None, [_ENDINGS[ended]])
    verdict = "FAIL" if missed else "PASS"
    return Score(verdict, *scores(measured, criteria), tuple(missed), ended.name.lower())


def _criteria(units: int) -> tuple[Criterion, ...]:
    return CRITERIA if units == 1 else CRITERIA + OF_UNITS


def _judging(units: int) -> Judging:
    ports = wire(units)
    truth, reference = ports.truth.PORT, ports.reference.PORT
    command = ports.commands[0]
    signal = command.signals()[0][1].name
    return Judging(
        criteria=_criteria(units),
        score=score,
        truth=truth,
        columns=(
            ("position_m", truth, "TruePos"),
            ("true_speed_mps", truth, "TrueSpeed"),
            ("target_mps", truth, "Target"),
            ("accel_mps2", truth, "TrueAccel"),
            ("drive_mps2", truth, "TrueDrive"),
            ("speed_kmh", ports.feedback[0].PORT, ports.feedback[0].signals()[0][1].name),
            ("target_sent_kmh", reference, "RefNow"),
            ("command_mps2", command.PORT, signal),
            *_unit_columns(ports),
        ),
        asked=lambda scenario: (
            f"{scenario.task.duration_s:g} s; RMSE of the speed at most {scenario.task.rmse_max_kmh:g} km/h"
        ),
        published="figures of the papers",
    )


def _unit_columns(ports: Wire) -> list[tuple[str, str, str]]:
    """Columns of the units of a train that has several."""
    truth, found = ports.truth.PORT, []
    if len(ports.commands) > 1:
        for unit, command in enumerate(ports.commands, 1):
            found.append((f"true_speed{unit}_mps", truth, f"TrueSpeed{unit}"))
            found.append((f"command{unit}_mps2", command.PORT, command.signals()[0][1].name))
        found += [(f"coupler{unit}_kn", truth, f"Coupler{unit}") for unit in range(1, len(ports.commands))]
    return found


HST1 = _judging(1)
EMU3 = _judging(3)
