"""The criteria by which runs of precise stopping are judged."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.judge.criteria import DID_NOT_STOP, STOP_ERROR_KEY, Criterion, Limit, scores, unscored
from railhil.judge.declared import Place, ShownProfile, Watch
from railhil.judge.judging import Judging, SequenceMeasure
from railhil.judge.record_checks import incomplete
from railhil.judge.score import Score
from railhil.record.notes import Status, wrap_failure
from railhil.record.trace import Trace
from railhil.scenarios.profiles import clip_profile
from railhil.systems.stop.approach import Approach
from railhil.wire.stop import BrakeCommand, BrakeLevel, BrakeStatus, Odo, SpeedRaw, StopReport, Truth

#: Median in fixed point against float64: a stop is as exact as lengths on the bus, with any law.
_AUDIT_ALLOWED_M = 0.001
#: Interval of the planned speed on the panel, m.
_STEP_M = 2.0
STOP_ERROR = Criterion(
    STOP_ERROR_KEY,
    "stop error",
    "m",
    3,
    Approach.stop_error_m,
    limit=Limit(lambda scenario: scenario.task.stop_error_max_m, 0),
    signed=STOP_ERROR_KEY,
    audit_allowed=_AUDIT_ALLOWED_M,
    without=DID_NOT_STOP,
)
CRITERIA = (
    STOP_ERROR,
    Criterion(
        "overshoot_m",
        "overshoot",
        "m",
        3,
        Approach.overshoot_m,
        audit_allowed=_AUDIT_ALLOWED_M,
        without=DID_NOT_STOP,
    ),
    Criterion("running_time_s", "running time", "s", 2, Approach.running_time_s, without=DID_NOT_STOP),
    Criterion("jerk_mps3", "largest jerk", "m/s3", 3, Approach.jerk_mps3),
    Criterion("brake_travel_mps2", "brake travel", "m/s2", 3, Approach.brake_travel_mps2),
)
#: The telegram in which the controller reports on its arithmetic.
_ARITHMETIC = Status("ATO_STATE", "LawFlags")
#: Ends of a complete record, with the failure that each means.
_ENDINGS = {
    Event.ENDED_COMPLETE: "",
    Event.ENDED_NOT_STOPPED: "the train did not stop",
    Event.ENDED_CONTROLLER_LOST: "controller lost",
}
#: The wire has no code for the safety loop, and nothing else has the train act without a cause.
_SAID: Mapping[str, str] = {
    "none": "the safety loop is open",
    "command_age": "no new command for three periods",
    "controller_safe": "the controller has no readings",
    "brake_not_answering": "the brake does not answer",
}
_WATCH = Watch(
    "train",
    "",
    BrakeStatus.PORT,
    "BrakeLevel",
    "BrakeCause",
    tuple(map(int, BrakeLevel)),
    said=lambda scenario, level, cause: _SAID.get(cause, cause),
    uncaused=_SAID["none"],
)


def score(scenario: Any, trace: Trace) -> Score:
    """PASS or FAIL by the limit of the scenario; INVALID for a record without a normal end."""
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    ended = next((event for event in _ENDINGS if event in codes), None)
    if ended is None or trace.count(Truth.PORT) < 2:
        return Score("INVALID", *unscored(CRITERIA), ("run did not come to its end",), "record_incomplete")
    approach = Approach.of(scenario, trace)
    if unclear := incomplete(trace, Truth.PORT) or approach.end_unclear(trace.end_s):
        return Score("INVALID", *unscored(CRITERIA), (unclear,), ended.name.lower())
    measured = {criterion.key: criterion.measure(approach) for criterion in CRITERIA}
    missed = [f"{item.title} {text}" for item in CRITERIA if (text := item.missed(scenario, measured[item.key]))]
    if ended is Event.ENDED_COMPLETE and measured[STOP_ERROR.key] is None:
        missed.append("the train moved again after its stop")
    missed += filter(None, [_alone(trace), wrap_failure(trace, _ARITHMETIC), _ENDINGS[ended]])
    return Score("FAIL" if missed else "PASS", *scores(measured, CRITERIA), tuple(missed), ended.name.lower())


def _alone(trace: Trace) -> str:
    """The failure of a train that had to act by itself; empty if it never had."""
    port = BrakeStatus.PORT
    rows = np.flatnonzero(trace.raw(port, "BrakeLevel") != BrakeLevel.NORMAL)
    if not len(rows):
        return ""
    cause = trace.word(port, "BrakeCause", int(trace.raw(port, "BrakeCause")[rows[0]]))
    return f"the train acted by itself from {trace.times_s(port)[rows[0]]:.2f} s ({_SAID.get(cause, cause)})"


def _facts(run: Any) -> list[tuple[str, str]]:
    """Train, brake and platform of a run, for the report."""
    task = run.scenario.task
    brake, true = task.brake, task.true
    balises = ", ".join(f"{before_m:g}" for before_m in task.balises_m)
    scatter = (
        f"gain {true.gain_train_sigma:.1%} from train to train and {true.gain_run_sigma:.1%} from run to run, "
        f"wheels {task.sensors.wheel_sigma:.2%}, grade map {task.map_error_sigma_permil:g} permil, "
        f"start speed {task.cruise_sigma_mps:g} m/s, drawn with seed and run number"
    )
    return [
        ("Stop", f"{task.platform}, {task.direction}, at {task.stop_m:g} m; {task.train}"),
        ("Brake of the laws' model", f"delay {brake.delay_s:g} s, lag {brake.lag_s:g} s"),
        ("Brake of the train", f"delay {true.delay_s:g} s, lag {true.lag_s:g} s, gain {true.gain:g}"),
        ("Scatter", scatter),
        ("Balises", f"{balises} m before the stopping point" if balises else "none"),
    ]


def _places(scenario: Any) -> list[Place]:
    """Balises by their id, and the stopping point."""
    task = scenario.task
    balises = [
        Place(str(number), task.stop_m - before_m, "balise") for number, before_m in enumerate(task.balises_m, 1)
    ]
    return [*balises, Place(task.platform, task.stop_m)]


def _profiles(scenario: Any) -> list[ShownProfile]:
    """Planned speed of the approach in km/h, with the planned deceleration of the brake; grade map in permil."""
    task = scenario.task
    left_m = np.append(np.arange(task.stop_m - task.start_m, 0.0, -_STEP_M), 0.0)
    speed_kmh = np.minimum(task.approach_kmh, np.sqrt(2.0 * task.brake.braking_mps2 * left_m) * 3.6)
    planned = tuple(zip((task.stop_m - left_m).tolist(), speed_kmh.tolist(), strict=True))
    return [
        ShownProfile("planned", "km/h", planned, is_step=False),
        ShownProfile("grade", "‰", clip_profile(task.grade, task.start_m, task.stop_m)),
    ]


STOP = Judging(
    criteria=CRITERIA,
    learned=(SequenceMeasure(STOP_ERROR, within=(0.1, 0.3), converged=0.3),),
    score=score,
    truth=Truth.PORT,
    columns=(
        ("position_m", Truth.PORT, "TruePos"),
        ("true_speed_mps", Truth.PORT, "TrueSpeed"),
        ("accel_mps2", Truth.PORT, "TrueAccel"),
        ("drive_mps2", Truth.PORT, "TrueDrive"),
        ("speed_mps", SpeedRaw.PORT, "Speed5"),
        ("odometer_m", Odo.PORT, "OdoDistance"),
        ("balise", Odo.PORT, "BaliseId"),
        ("command_mps2", BrakeCommand.PORT, "CmdAccel"),
        ("report_run", StopReport.PORT, "ReportRun"),
        ("report_error_m", StopReport.PORT, "ReportError"),
    ),
    asked=lambda scenario: (
        f"stop at {scenario.task.platform} within {scenario.task.stop_error_max_m:g} m of {scenario.task.stop_m:g} m"
    ),
    published="figures of He and Tang, one run each",
    facts=_facts,
    watches=(_WATCH,),
    ends_at_m=lambda scenario: scenario.task.stop_m,
    places=_places,
    profiles=_profiles,
    applied="drive_mps2",
)
