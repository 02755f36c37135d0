"""The criteria by which runs of high-speed trains are judged."""

from __future__ import annotations

from typing import Any

import numpy as np

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import count_of
from railhil.judge.criteria import DID_NOT_STOP, Criterion, Limit, scores, unscored
from railhil.judge.declared import Place, ShownProfile, Watch
from railhil.judge.judging import Judging
from railhil.judge.record_checks import incomplete
from railhil.judge.score import Score
from railhil.record.notes import Status, wrap_failure
from railhil.record.trace import Trace
from railhil.systems.high_speed.ride import SCORED_FROM_MPS, Ride
from railhil.systems.high_speed.target import journey_curve
from railhil.wire.high_speed import UnitCause, UnitLevel
from railhil.wire.power_units import Wire, wire

_KMH = 3.6
#: Points of the target curve on the panel.
_POINTS = 1000
#: Columns that the panel draws over the position; the last one is for the panel only.
_TRUE_SPEED, _TARGET, _GRADE = "true_speed_mps", "target_mps", "true_grade_permil"
RMSE = Criterion(
    "rmse_kmh", "RMSE", "km/h", 4, Ride.rmse_kmh, limit=Limit(lambda scenario: scenario.task.rmse_max_kmh, 0)
)


def _has_emergency(scenario: Any) -> bool:
    return scenario.task.emergency is not None


def _arrives(scenario: Any) -> bool:
    """Whether a run lasts until the train has to stand at the end of its journey."""
    task = scenario.task
    return not _has_emergency(scenario) and task.start_s + task.duration_s >= journey_curve(task).duration_s


EMERGENCY_STOP = Criterion(
    "emergency_stop_m",
    "emergency stop",
    "m",
    1,
    Ride.emergency_stop_m,
    limit=Limit(lambda scenario: scenario.task.emergency_stop_max_m, 1),
    applies=_has_emergency,
    without=DID_NOT_STOP,
)
CRITERIA = (
    RMSE,
    Criterion("max_error_kmh", "largest error", "km/h", 3, Ride.max_error_kmh),
    Criterion("slope_mps3", "command slope", "m/s3", 4, Ride.slope_mps3),
    Criterion("energy_kwh", "energy", "kWh", 1, Ride.energy_kwh),
    Criterion(
        "arrival_m",
        "arrival error",
        "m",
        2,
        Ride.arrival_error_m,
        signed="arrival_error_m",
        applies=_arrives,
        without=DID_NOT_STOP,
    ),
    Criterion("emergency_rmse_kmh", "emergency RMSE", "km/h", 4, Ride.emergency_rmse_kmh, applies=_has_emergency),
    EMERGENCY_STOP,
)
#: Further criteria of a train of several units.
OF_UNITS = (
    Criterion("units_rmse_kmh", "RMSE of units", "km/h", 4, Ride.units_rmse_kmh),
    Criterion("spread_kmh", "speed spread", "km/h", 3, Ride.spread_kmh),
    Criterion("coupler_peak_kn", "coupler force", "kN", 1, Ride.coupler_peak_kn),
)
#: Largest difference of a command from that in float64 on the same readings, before it is rounded for the bus, m/s2.
AUDIT_LIMITS = {"accel": 1e-4}
#: The wire has no code for the safety loop, and nothing else has a unit act without a cause.
_UNCAUSED = "the safety loop is open"
#: The telegram in which the controller reports on its arithmetic.
_STATUS = Status("LAW_STAT", "LawFlags")
#: No unit has this level of the ladder.
_HOLD = 1
#: Ends of a complete record, with the failure that each means.
_ENDINGS = {Event.ENDED_COMPLETE: "", Event.ENDED_CONTROLLER_LOST: "controller lost"}


def score(scenario: Any, trace: Trace) -> Score:
    """PASS or FAIL by the limits of the scenario; INVALID for a record without a normal end."""
    criteria = _criteria(len(scenario.task.unit))
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    ended = next((event for event in _ENDINGS if event in codes), None)
    truth = wire(len(scenario.task.unit)).truth.PORT
    if ended is None or trace.count(truth) < 2:
        return Score("INVALID", *unscored(criteria), ("run did not come to its end",), "record_incomplete")
    if unclear := incomplete(trace, truth):
        return Score("INVALID", *unscored(criteria), (unclear,), ended.name.lower())
    ride = Ride.of(scenario, trace)
    measured = {criterion.key: criterion.measure(ride) for criterion in criteria}
    missed = [f"{item.title} {text}" for item in criteria if (text := item.missed(scenario, measured[item.key]))]
    if EMERGENCY_STOP.applies(scenario) and measured[EMERGENCY_STOP.key] is None:
        missed.append(f"no emergency stop, allowed at most {scenario.task.emergency_stop_max_m:g} m")
    missed += [text for unit in range(1, len(scenario.task.unit) + 1) if (text := _alone(trace, truth, unit))]
    missed += filter(None, [wrap_failure(trace, _STATUS), _ENDINGS[ended]])
    if not missed and measured[RMSE.key] is None:
        # A run without a score cannot miss a limit.
        never = f"nothing to score: the target stays below {SCORED_FROM_MPS:g} m/s"
        return Score("INVALID", *unscored(criteria), (never,), ended.name.lower())
    verdict = "FAIL" if missed else "PASS"
    return Score(verdict, *scores(measured, criteria), tuple(missed), ended.name.lower())


def _alone(trace: Trace, truth: str, unit: int) -> str:
    """The failure of a unit that had to act by itself; empty if it never had."""
    levels = trace.raw(truth, f"Level{unit}")
    rows = np.flatnonzero(levels != UnitLevel.NORMAL)
    if not len(rows):
        return ""
    raw = int(trace.raw(truth, f"Cause{unit}")[rows[0]])
    cause = trace.word(truth, f"Cause{unit}", raw).replace("_", " ") if raw != UnitCause.NONE else _UNCAUSED
    return f"unit {unit} acted by itself from {trace.times_s(truth)[rows[0]]:.2f} s ({cause})"


def _criteria(units: int) -> tuple[Criterion, ...]:
    return CRITERIA if units == 1 else CRITERIA + OF_UNITS


def _said(scenario: Any, level: str, cause: str) -> str:
    """Cause for which a unit acted by itself, in words."""
    if cause == "command_age":
        return "no new command for three periods"
    words = {"controller_safe": "the controller has no readings", "brake_not_answering": "its brake does not answer"}
    return words.get(cause, cause)


def _facts(run: Any) -> list[tuple[str, str]]:
    """Train and drive of a run, for the report."""
    task = run.scenario.task
    delays = ", ".join(f"{unit.traction_delay_s:g} / {unit.braking_delay_s:g} s" for unit in task.unit)
    between = task.between_units
    couplers = "none" if between is None else f"{between.stiffness_kn_per_m:g} kN/m, slack {between.slack_mm:g} mm"
    units = [("Couplers", couplers)] if len(task.unit) > 1 else []
    return [
        ("Train", f"{task.mass_t:g} t, {task.power_kw:g} kW, {count_of(len(task.unit), 'power unit')}"),
        ("Delay of traction / braking", delays),
        *units,
        ("Disturbances", f"grades within {task.gradient_permil:g} permil, wind {task.wind_sigma_mps2:g} m/s2, "
                         f"noise {task.noise_sigma_mps:g} m/s, all drawn with the seed"),
    ]  # fmt: skip


def _covered_m(task: Any) -> tuple[float, float]:
    """The part of the journey that a run along the target curve covers: its two ends."""
    curve = journey_curve(task)
    return curve.position_m(task.start_s), curve.position_m(task.start_s + task.duration_s)


def _places(scenario: Any) -> list[Place]:
    """What the run can reach: both ends of coasting, where the emergency is triggered, and the stopping point."""
    task, coasting = scenario.task, scenario.task.curve.coasting
    low_m, high_m = _covered_m(task)
    marks = [("coasting", coasting.from_km), ("end of coasting", coasting.to_km)]
    marks += [("emergency", task.emergency.at_km)] if task.emergency is not None else []
    found = [Place(name, at_km * 1000.0, "mark") for name, at_km in marks if low_m <= at_km * 1000.0 <= high_m]
    if _arrives(scenario):
        found.append(Place("stopping point", journey_curve(task).positions_m[-1]))
    return sorted(found, key=lambda place: place.position)


def _profiles(scenario: Any) -> list[ShownProfile]:
    """The target curve over the part that the run covers, and the speed restriction of the line, km/h.

    The grades are drawn in each run: the wire tells that under the train (:data:`_GRADE`).
    """
    task, curve, slow = scenario.task, journey_curve(scenario.task), scenario.task.curve.restriction
    times_s = np.linspace(task.start_s, task.start_s + task.duration_s, _POINTS)
    rows = tuple((curve.position_m(time_s), curve.speed_mps(time_s) * _KMH) for time_s in times_s.tolist())
    low_m, high_m = _covered_m(task)
    ends_m = [min(max(at_km * 1000.0, low_m), high_m) for at_km in (slow.from_km, slow.to_km)]
    limit = [ShownProfile("limit", "km/h", tuple((at_m, slow.speed_kmh) for at_m in ends_m))]
    return [ShownProfile("target curve", "km/h", rows, is_step=False), *(limit if ends_m[0] < ends_m[1] else [])]


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
            (_TRUE_SPEED, truth, "TrueSpeed"),
            (_TARGET, truth, "Target"),
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
        published="figures of the NGPC papers, which print no RMSE of the speed",
        applied="drive_mps2",
        shown=((_GRADE, ports.mutation.PORT, "TrueGrade"),),
        strip=(_TRUE_SPEED, _TARGET, _GRADE),
        places=_places,
        profiles=_profiles,
        facts=_facts,
        watches=tuple(
            Watch(
                f"unit{unit}",
                f"unit {unit}" if units > 1 else "",
                truth,
                f"Level{unit}",
                f"Cause{unit}",
                (UnitLevel.NORMAL, _HOLD, UnitLevel.TRACTION_CUT, UnitLevel.SERVICE_BRAKE),
                said=_said,
                uncaused=_UNCAUSED,
            )
            for unit in range(1, units + 1)
        ),
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
