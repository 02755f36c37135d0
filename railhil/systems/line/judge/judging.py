"""Judging and presentation of records of the system ``line``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from railhil.common.command_line import LAW_WITH_POSITION
from railhil.common.digits import count_of, text_beside_limit
from railhil.judge.judging import Judging, Noted
from railhil.judge.record import Record
from railhil.judge.score import Score
from railhil.judge.stops import worst_stop
from railhil.record.notes import WRAP_FAILURE
from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.judge import judging as of_train
from railhil.systems.ato.judge.criteria import OVERSPEED
from railhil.systems.ato.judge.events import STATUS
from railhil.systems.line.judge.course import course_of
from railhil.systems.line.judge.criteria import CRITERIA, EXTRAS, INTERVENTIONS, WARNINGS
from railhil.systems.line.judge.events import INTERLOCKS, WATCHES, received
from railhil.systems.line.judge.invariants import limits_at
from railhil.systems.line.judge.milestones import milestones_of
from railhil.systems.line.judge.places import shown_places, shown_profiles
from railhil.systems.line.judge.score import score
from railhil.systems.line.planned import planned_motion
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.ato import SimTruth, TrkInfo
from railhil.wire.line import AtoStat, AtpLim, AtpStat, DoorStat, StnInfo

#: Columns of ``signals.csv`` after those of a train.
COLUMNS = (
    *of_train.COLUMNS,
    ("station", StnInfo.PORT, "StationHere"),
    ("section", StnInfo.PORT, "Section"),
    ("left_doors", DoorStat.PORT, "LeftState"),
    ("right_doors", DoorStat.PORT, "RightState"),
    ("dwell_left_s", DoorStat.PORT, "DwellLeft"),
    ("permitted_mps", AtpLim.PORT, "PermittedSpeed"),
    ("ebi_mps", AtpStat.PORT, "EbiSpeed"),
    ("distance_left_m", AtoStat.PORT, "DistanceLeft"),
)


#: Columns that the panel shows at first sight.
_GAUGES = (
    "permitted_mps",
    "distance_left_m",
    "lateness_s",
    "ato_state",
    "left_doors",
    "right_doors",
)


def reckoned(scenario: LineScenario, trace: Trace) -> list[tuple[str, str, FloatArray]]:
    """Lateness of the train at its place."""
    port = SimTruth.PORT
    place_m, speed_mps = trace.values(port, "TruePos"), trace.values(port, "TrueSpeed")
    return [("lateness_s", "s", planned_motion(scenario).lateness_s(trace.times_s(port), place_m, speed_mps))]


def quantities(scenario: LineScenario, trace: Trace) -> list[tuple[str, str, FloatArray]]:
    """The speed limit of line and train, in force for the whole train on its leg."""
    course = course_of(scenario, milestones_of(scenario, trace)[0])
    time_s, position_m = trace.times_s(SimTruth.PORT), trace.values(SimTruth.PORT, "TruePos")
    limits_mps = limits_at(scenario, course, time_s, position_m)
    return [("limit_at_train", "m/s", np.minimum(limits_mps, scenario.train.speed_limit_mps))]


def asked(scenario: LineScenario) -> str:
    """The requirements on the run."""
    route, served = scenario.route, [stop for stop in scenario.stops if stop.service != "pass"]
    passed = len(scenario.stops) - len(served)
    errors_m = sorted({stop.stop_error_max_m for stop in served[1:]})
    allowed_m = " to ".join(f"{error_m:.10g}" for error_m in errors_m[:: max(1, len(errors_m) - 1)])
    return (
        f"{scenario.plan.distance_m:g} m in {scenario.plan.running_time_s:g} s, "
        f"{count_of(len(served), 'stop')}{f', {passed} passed' if passed else ''}; allowed ±{allowed_m} m and "
        f"±{route.arrival_error_max_s:.10g} s at each, {route.departure_late_max_s:.10g} s of own delay"
    )


def checks(scenario: LineScenario, found: Score) -> list[tuple[str, str]]:
    """Requirements besides the limits of the stops."""
    over_mps = found.extras[OVERSPEED.key]

    def first(*words: str) -> str:
        return next((text for text in found.failures if any(word in text for word in words)), "")

    return [
        ("overspeed", f"{text_beside_limit(over_mps, 0, 3)} m/s" if over_mps > 0 else ""),
        ("no_protection_intervention", first("train protection intervened")),
        ("no_emergency_brake", first("emergency brake at")),
        ("doors_only_in_the_window", first("invariant 8")),
        ("invariants", first("invariant")),
        ("no_wrap", first(WRAP_FAILURE)),
    ]


def counted(found: Sequence[Score]) -> dict[str, object]:
    """The worst stop of each run, in the form of ``compare.json``."""
    stops = [worst_stop(one.stops) for one in found]
    return {"worst_stops": [None if stop is None else stop.as_json() for stop in stops]}


def find_worst_stop(found: Score) -> tuple[str, float | None] | None:
    """Name and stop error in m of the worst stop; None for a record that does not show a complete run."""
    stop = worst_stop(found.stops)
    return None if stop is None else (stop.planned.name, stop.error_m)


def facts(run: Record) -> list[tuple[str, str]]:
    """Train, line, timetable and protection of the run."""
    scenario, extras = run.scenario, run.score.extras
    atp = scenario.atp
    curves = (
        f"warned {count_of(int(extras[WARNINGS.key]), 'time')}, "
        f"intervened {count_of(int(extras[INTERVENTIONS.key]), 'time')}"
        if atp.enabled
        else "off"
    )
    return [
        ("Train", f"{scenario.train.name}, line {scenario.line.name}"),
        ("Regulation", {"retime": "exact time left at each departure", "profiles": "fast, normal, economy"}.get(
            scenario.route.regulation, "none")),
        ("Train protection", curves),
        ("Telegrams counted", of_train.counted_sentence(run)),
    ]  # fmt: skip


def advice(run: Record, folder: Path) -> str:
    """Advice after a FAIL, depending on the cause."""
    failures = run.score.failures
    if any(text.startswith(WRAP_FAILURE) for text in failures):
        return ""
    only_stops = all(text.startswith("stop ") for text in failures)
    if only_stops and run.controller != LAW_WITH_POSITION and LAW_WITH_POSITION in run.system.law_names():
        return f"next: the same with --controller {LAW_WITH_POSITION}, which knows its position"
    return ""


JUDGING = Judging(
    criteria=CRITERIA,
    extras=EXTRAS,
    score=score,
    truth=SimTruth.PORT,
    columns=COLUMNS,
    told=of_train.told,
    asked=asked,
    checks=checks,
    facts=facts,
    counted=counted,
    status=STATUS,
    advice=advice,
    reckoned=reckoned,
    quantities=quantities,
    shown=(
        ("speed_limit_mps", TrkInfo.PORT, "SpeedLimit"),
        ("ato_state", AtoStat.PORT, "AtoState"),
        ("signal_next", StnInfo.PORT, "SignalNext"),
        of_train.APPLIED,
    ),
    noted=(Noted("worst_stop", "worst stop", "worst_stop_error_m", "m", 4, find_worst_stop),),
    stop_events=("stopped", "arrived"),
    watches=WATCHES,
    interlocks=INTERLOCKS,
    received=received,
    ends_at_m=lambda scenario: scenario.plan.distance_m,
    places=shown_places,
    profiles=shown_profiles,
    strip=("true_speed_mps", "permitted_mps", "ebi_mps"),
    gauges=_GAUGES,
    applied=of_train.APPLIED[0],
)
