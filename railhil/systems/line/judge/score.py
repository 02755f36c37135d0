"""The score of a run over a line: a pure function of the scenario and the recorded telegrams.

A run is PASS if each of these holds (section 6 of the specification); each limit that it misses is one line.

* Each served stop is made inside its limit, and its doors opened.
* Each arrival is inside the limit. It may be later by the lateness of the departure before it that is not the
  controller's, less what the section could make up.
* The controller held no departure back for longer than the limit.
* No intervention of the train protection, no emergency brake, no overspeed, no wrap.
* Doors were open only in the window, on the side of the platform (:mod:`.invariants`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import text_beside_limit
from railhil.faults import parse_faults
from railhil.judge.criteria import scores, unscored
from railhil.judge.record_checks import UNCLEAR, incomplete
from railhil.judge.score import Score
from railhil.record.notes import wrap_failure
from railhil.record.trace import Trace
from railhil.systems.ato.judge.criteria import OVERSPEED
from railhil.systems.ato.judge.events import STATUS
from railhil.systems.ato.judge.measures import KMH
from railhil.systems.ato.judge.score import silences_controller
from railhil.systems.line.judge.course import Course, course_of
from railhil.systems.line.judge.criteria import CRITERIA, EXTRAS, INTERVENTIONS, WARNINGS
from railhil.systems.line.judge.cross_check import contradiction
from railhil.systems.line.judge.doors import Doors
from railhil.systems.line.judge.events import protection_cause
from railhil.systems.line.judge.invariants import broken, limits_at
from railhil.systems.line.judge.milestones import Milestone, milestones_of
from railhil.systems.line.judge.motion import Motion
from railhil.systems.line.judge.protection import ProtectionRecord
from railhil.systems.line.judge.run import LineRun, forged_ports
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.ato import SimTruth


@dataclass(frozen=True, slots=True)
class Opened:
    """A record that holds a complete run, or the reason why it does not.

    ``ended``: name of the milestone that ended it. ``run``: None with a reason.
    """

    ended: str
    run: LineRun | None
    reason: str = ""


def open_run(scenario: LineScenario, trace: Trace) -> Opened:
    """The run of a record, checked for what a verdict needs."""
    codes = trace.raw(RunEvent.PORT, "RunEvent").tolist()
    ended = next((event for event in sorted(Event, reverse=True) if event in codes and event in _ENDS), None)
    name = ended.name.lower() if ended is not None else "record_incomplete"
    whole = [Event.ENDED_COMPLETE, Event.ENDED_NOT_STOPPED]
    if any(map(silences_controller, parse_faults(scenario.faults))):
        whole.append(Event.ENDED_CONTROLLER_LOST)
    if ended not in whole or trace.count(SimTruth.PORT) < 2:
        return Opened(name, None, f"run {name}")
    milestones, unclear = milestones_of(scenario, trace)
    unclear = incomplete(trace, SimTruth.PORT) or unclear
    course = course_of(scenario, milestones) if not unclear else Course(())
    unclear = unclear or course.contradiction
    if unclear:
        return Opened(name, None, unclear)
    forged, motion = forged_ports(scenario), Motion.of(trace)
    run = LineRun(scenario, trace, course, motion, Doors(trace), ProtectionRecord(trace, forged), forged)
    unclear = contradiction(run)
    return Opened(name, None if unclear else run, unclear)


_ENDS = frozenset(event for event in Event if event >= Event.ENDED_COMPLETE)


def score(scenario: LineScenario, trace: Trace) -> Score:
    """Score a recorded run.

    :param scenario: the *nominal* scenario of the run.
    :returns: verdict PASS or FAIL; INVALID if the record does not hold a complete run, or contradicts itself.
    """
    opened = open_run(scenario, trace)
    if opened.run is None:
        return _unscored(opened.reason, opened.ended)
    rules = broken(opened.run)
    if unclear := next((said for said in rules if said.startswith(UNCLEAR)), ""):
        return _unscored(unclear, opened.ended)
    return _judged(opened.run, opened.ended, rules)


def _unscored(reason: str, ended: str) -> Score:
    """The score of a record that does not show a complete run."""
    return Score("INVALID", *unscored(CRITERIA), (reason,), ended, {extra.key: 0.0 for extra in EXTRAS})


def _judged(run: LineRun, ended: str, rules: list[str]) -> Score:
    scenario, motion = run.scenario, run.motion
    over_mps = motion.speed_mps - limits_at(scenario, run.course, motion.time_s, motion.position_m)
    most_over_mps = float(max(0.0, over_mps.max()))
    interventions = run.protection.interventions()
    failures = ["controller lost"] if ended == Event.ENDED_CONTROLLER_LOST.name.lower() else []
    failures += [f"stop {stop.planned.name}: {missed}" for stop in run.stops for missed in stop.misses]
    if most_over_mps > 0.0:
        at_s = motion.time_s[int(np.argmax(over_mps))]
        found = text_beside_limit(most_over_mps * KMH, 0, 2)
        failures.append(f"overspeed {found} km/h at {at_s:.2f} s, allowed 0")
    failures += [
        f"train protection intervened at {spell.begun_s:.2f} s ({protection_cause(spell.cause)}), allowed never"
        for spell in interventions
    ]
    failures += [f"emergency brake at {told.instant_s:.2f} s, allowed never" for told in _emergencies(run)]
    if wrap := wrap_failure(run.trace, STATUS):
        failures.append(wrap)
    failures += rules
    measured = {criterion.key: criterion.measure(run) for criterion in CRITERIA}
    values, signed = scores(measured, CRITERIA)
    return Score(
        verdict="FAIL" if failures else "PASS",
        values=values,
        signed=signed,
        failures=tuple(failures),
        ended=ended,
        extras={
            OVERSPEED.key: most_over_mps,
            WARNINGS.key: float(len(run.protection.warnings())),
            INTERVENTIONS.key: float(len(interventions)),
        },
        stops=run.stops,
    )


def _emergencies(run: LineRun) -> tuple[Milestone, ...]:
    return run.course.emergencies[:1]
