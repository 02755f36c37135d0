"""Judging and presentation of records of the system ``ato``: one train, five scores, one stop."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from railhil.common.command_line import LAW_WITH_POSITION
from railhil.common.digits import text_beside_limit
from railhil.controller_node.ato.laws import ORDER
from railhil.controller_node.laws import load as load_law
from railhil.judge.counters import unchecked, unreconciled
from railhil.judge.criteria import STOP_WITHIN_M
from railhil.judge.judging import Judging
from railhil.judge.record import Record
from railhil.judge.score import Score
from railhil.record.notes import WRAP_FAILURE
from railhil.record.trace import FloatArray, Trace
from railhil.report.deviations import Deviation, read_deviations
from railhil.systems.ato.judge.criteria import CRITERIA, OVERSPEED, STOP_ERROR, TIME_ERROR
from railhil.systems.ato.judge.curves import wanted_mps
from railhil.systems.ato.judge.events import INTERLOCKS, STATUS, WATCHES, received
from railhil.systems.ato.judge.measures import limits_under_train
from railhil.systems.ato.judge.places import shown_places, shown_profiles
from railhil.systems.ato.judge.score import score
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth, TrkInfo, TrnPos, TrnSpeed

#: Columns of ``signals.csv``: header and its signal.
COLUMNS = (
    ("true_position_m", SimTruth.PORT, "TruePos"),
    ("true_speed_mps", SimTruth.PORT, "TrueSpeed"),
    ("true_accel_mps2", SimTruth.PORT, "TrueAccel"),
    ("traction_n", SimTruth.PORT, "TractionForce"),
    ("brake_n", SimTruth.PORT, "BrakeForce"),
    ("grade_permil", SimTruth.PORT, "TrueGrade"),
    ("measured_speed_mps", TrnSpeed.PORT, "TrainSpeed"),
    ("odometer_m", TrnPos.PORT, "TrainPos"),
    ("notch_command", NotchCmd.PORT, "NotchCmd"),
    ("controller_mode", NotchCmd.PORT, "CtlMode"),
)

#: What the train makes of the notch command, as a column of the panel.
APPLIED = ("notch_applied", TrnPos.PORT, "NotchActual")


def told(trace: Trace, notes: Any) -> list[tuple[str, str, FloatArray]]:
    """The ladder."""
    return [("ladder_level", CtlStat.PORT, trace.values(CtlStat.PORT, "LadderLevel"))]


def reckoned(scenario: Scenario, trace: Trace) -> list[tuple[str, str, FloatArray]]:
    """The speed that the law was to follow."""
    return [("target_speed_mps", "m/s", wanted_mps(scenario, trace))]


def quantities(scenario: Scenario, trace: Trace) -> list[tuple[str, str, FloatArray]]:
    """The speed limit of line and train, in force for the whole train."""
    position_m, train = trace.values(SimTruth.PORT, "TruePos"), scenario.train
    limits_mps = limits_under_train(scenario.line.speed_limit_mps, position_m, train.length_m)
    return [("limit_at_train", "m/s", np.minimum(limits_mps, train.speed_limit_mps))]


def asked(scenario: Scenario) -> str:
    """The requirements on the run."""
    plan = scenario.plan
    return (
        f"{plan.distance_m:g} m in {plan.running_time_s:g} s; allowed ±{plan.stop_error_max_m:.10g} m and "
        f"±{plan.time_error_max_s:.10g} s"
    )


def checks(scenario: Scenario, found: Score) -> list[tuple[str, str]]:
    """Requirements besides the limits of the plan."""
    over_mps = found.extras[OVERSPEED.key]
    stood = any(stop.standstill is not None for stop in found.stops)
    return [
        ("stops", "" if stood else "did not stop"),
        ("overspeed", f"{text_beside_limit(over_mps, 0, 3)} m/s" if over_mps > 0 else ""),
        ("no_emergency_brake", next((text for text in found.failures if "emergency" in text), "")),
        ("no_wrap", next((text for text in found.failures if text.startswith(WRAP_FAILURE)), "")),
    ]


def facts(run: Record) -> list[tuple[str, str]]:
    """Train and line, and the stop of the run."""
    scenario = run.scenario
    return [
        ("Train", f"{scenario.train.name}, line {scenario.line.name}"),
        ("Stopped", _signed(run)),
        ("Telegrams counted", counted_sentence(run)),
    ]


def counted_sentence(run: Record) -> str:
    """Whether the nodes' own counters of telegrams agree with the record."""
    if silent := unchecked(run.trace):
        return f"not checked against the record: the {silent} did not report"
    said = unreconciled(run.scenario, run.trace)
    return "; ".join(said) or "by controller and plant, as the record shows"


def _signed(run: Record) -> str:
    late_s, past_m = (run.score.with_sign(criterion) for criterion in (TIME_ERROR, STOP_ERROR))
    if late_s is None or past_m is None:
        return "did not stop"
    return (
        f"{abs(late_s):.4f} s {'late' if late_s > 0 else 'early'}, "
        f"{abs(past_m):.4f} m {'past' if past_m > 0 else 'short of'} the stopping point"
    )


def stopped_within(found: Sequence[Score]) -> dict[float, int]:
    """Number of runs that stopped within each of ``STOP_WITHIN_M``; a run that never stopped counts for none."""
    errors_m = [error for score in found if (error := score.values[STOP_ERROR.key]) is not None]
    return {limit: sum(error <= limit for error in errors_m) for limit in STOP_WITHIN_M}


def stops_sentence(found: Sequence[Score]) -> str:
    """:func:`stopped_within` in words."""
    parts = (f"{limit:g} m: {count} of {len(found)}" for limit, count in stopped_within(found).items())
    return f"stopped within {', '.join(parts)}"


def counted(found: Sequence[Score]) -> dict[str, Any]:
    """:func:`stopped_within` in the form of ``compare.json``."""
    shares = {
        f"{limit:g}": {"runs": count, "share": count / len(found)} for limit, count in stopped_within(found).items()
    }
    return {"stopped_within_m": shares}


def advice(run: Record, folder: Path) -> str:
    """Advice after a FAIL, depending on the cause; a law of the user is not replaced by one of ours."""
    certificate, scenario = run.certificate, run.scenario
    name = certificate.get("scenario") or scenario.name
    if any(text.startswith(WRAP_FAILURE) for text in run.score.failures):
        return f"next: railhil audit {name} --controller {run.controller} says which quantity wraps"
    only_errors = all(text.startswith(("stop error", "time error")) for text in run.score.failures)
    if not only_errors or run.controller == LAW_WITH_POSITION or certificate.get("indexing") != "time":
        return ""
    installed, steps = scenario.installed_system.law_names(), []
    if run.controller in ORDER and LAW_WITH_POSITION in installed:
        steps.append(f"the same with --controller {LAW_WITH_POSITION}, which knows its position")
    if run.controller in installed and not certificate.get("parameters") and load_law(run.controller).tunable:
        steps.append(f"railhil tune {run.controller} {name}, which searches its parameters")
    return f"next: {'; or '.join(steps)}" if steps else ""


def deviations() -> tuple[str, tuple[Deviation, ...]]:
    """The paper of the published rows, and the places where the bench reads it otherwise than printed."""
    return read_deviations("railhil.systems.ato")


JUDGING = Judging(
    criteria=CRITERIA,
    extras=(OVERSPEED,),
    score=score,
    truth=SimTruth.PORT,
    columns=COLUMNS,
    told=told,
    asked=asked,
    checks=checks,
    facts=facts,
    counted=counted,
    remark=stops_sentence,
    status=STATUS,
    published="Published: Table 2 of the paper, on another train model",
    deviations=deviations,
    advice=advice,
    reckoned=reckoned,
    quantities=quantities,
    shown=(("speed_limit_mps", TrkInfo.PORT, "SpeedLimit"), APPLIED),
    watches=WATCHES,
    interlocks=INTERLOCKS,
    received=received,
    ends_at_m=lambda scenario: scenario.plan.distance_m,
    places=shown_places,
    profiles=shown_profiles,
    applied=APPLIED[0],
)
