"""The score: a pure function of the scenario and the recorded telegrams.

The criteria are defined in :mod:`railhil.judge.criteria`; this module decides whether the record holds a complete
run, and the verdict.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from railhil.bus.codes import Event, ends_run
from railhil.bus.ident import INDEXINGS, CtlIdent
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import text_beside_limit
from railhil.faults import parse_faults
from railhil.judge import measures
from railhil.judge.criteria import ATO_CRITERIA, OVERSPEED, Criterion, limited, scores, unscored
from railhil.judge.invariants import broken
from railhil.judge.journey import Journey, stop_of
from railhil.judge.measures import limits_under_train
from railhil.judge.missed_telegrams import UNCLEAR
from railhil.judge.record_checks import incomplete, standstill_unclear
from railhil.judge.stops import ScoredStop
from railhil.record.status import Status, wrap_failure
from railhil.record.trace import Trace
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth

if TYPE_CHECKING:
    from railhil.faults.model import Fault

#: Criteria with a limit, in the order of their failures.
_LIMITED = tuple(limited(ATO_CRITERIA))
#: The status telegram of the controller of ``ato``; the law defines the notes.
STATUS = Status(CtlStat.PORT, "OverflowFlags")


@dataclass(frozen=True, slots=True)
class Score:
    """Scores of one run by the keys of its criteria; ``None`` if the run ended before (a train that did not stop has no
    stop error).

    ``signed``: the scores that have a sign; positive ``time_error_s`` is late, positive ``stop_error_m`` is past the
    stopping point. ``extras``: the system's own figures by the keys of :attr:`Judging.extras`. ``stops``: the stops
    that the scenario requires, in its order, with their results; empty for a record that does not show a complete run.
    """

    verdict: str
    values: Mapping[str, float | None]
    signed: Mapping[str, float | None]
    failures: tuple[str, ...]
    ended: str
    extras: Mapping[str, float] = field(default_factory=dict)
    stops: tuple[ScoredStop, ...] = ()

    @property
    def listed_stops(self) -> tuple[ScoredStop, ...]:
        """The stops of a run with several; a single stop is fully covered by the criteria."""
        return self.stops if len(self.stops) > 1 else ()

    def with_sign(self, criterion: Criterion) -> float | None:
        """Value of a criterion, with its sign if it has one."""
        return self.values[criterion.key] if criterion.signed is None else self.signed[criterion.signed]

    def as_json(self) -> dict[str, object]:
        """The part of ``score.json`` that comes from the log alone."""
        return {
            "verdict": self.verdict,
            "scores": dict(self.values),
            "signed": dict(self.signed),
            **self.extras,
            "failures": list(self.failures),
            "ended": self.ended,
            "stops": [stop.as_json() for stop in self.stops],
        }


def _events(trace: Trace) -> dict[Event, list[tuple[float, float]]]:
    """``(instant s, true position m)`` of each event, by kind, as often as it was reported."""
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    instants = trace.values(RunEvent.PORT, "EventTime")
    positions = trace.values(RunEvent.PORT, "EventPos")
    found: dict[Event, list[tuple[float, float]]] = {}
    for code, instant_s, position_m in zip(codes, instants, positions, strict=True):
        if int(code) in Event._value2member_map_:
            found.setdefault(Event(int(code)), []).append((float(instant_s), float(position_m)))
    return found


@dataclass(frozen=True, slots=True)
class Measured:
    """Measurements of a complete run.

    ``values``: by criterion, with their sign if they have one. ``stop``: its one stop; ``emergency_s``: instant of the
    first emergency brake; ``wrap``: the failure text if the controller's arithmetic has wrapped; ``broken``: the rules
    of :mod:`railhil.judge.invariants` that the run breaks.
    """

    ended: Event
    values: Mapping[str, float | None]
    overspeed_mps: float
    stop: ScoredStop
    emergency_s: float | None
    wrap: str = ""
    broken: Sequence[str] = ()


def judged(scenario: Scenario, run: Measured) -> Score:
    """Score of a complete run with its verdict and the limits of the plan that it misses."""
    failures = []
    if run.ended is Event.ENDED_CONTROLLER_LOST:
        failures.append("controller lost")
    if run.stop.standstill is None:
        failures.append(f"not stopped {scenario.plan.overtime_max_s:g} s after the timetable")
    for criterion in _LIMITED:
        if missed := criterion.missed(scenario, run.values[criterion.key]):
            failures.append(f"{criterion.title} {missed}")
    if run.overspeed_mps > 0:
        failures.append(f"overspeed {text_beside_limit(run.overspeed_mps * measures.KMH, 0, 2)} km/h, allowed 0")
    if run.emergency_s is not None:
        failures.append(f"emergency brake at {run.emergency_s:.2f} s")
    if run.wrap:
        failures.append(run.wrap)
    failures += run.broken
    values, signed = scores(run.values, ATO_CRITERIA)
    return Score(
        verdict="FAIL" if failures else "PASS",
        values=values,
        signed=signed,
        failures=tuple(failures),
        ended=run.ended.name.lower(),
        extras={OVERSPEED.key: run.overspeed_mps},
        stops=(run.stop,),
    )


def _unscored(reason: str, ended: str) -> Score:
    """The score of a record that does not show a complete run."""
    return Score("INVALID", *unscored(ATO_CRITERIA), (reason,), ended, {OVERSPEED.key: 0.0})


def _silences_controller(fault: Fault) -> bool:
    """Whether a run with this fault may end without a controller."""
    place = fault.place
    if place.level == "node":
        return place.name == "controller"
    return place.level == "bus" or (place.level == "telegram" and place.name == NotchCmd.PORT)


def score(scenario: Scenario, trace: Trace) -> Score:
    """Score a recorded run.

    :param scenario: the *nominal* scenario of the run (its plan, target curve and limits).
    :returns: verdict PASS or FAIL; INVALID if the record does not hold a complete run. A run whose controller a fault
        has silenced is complete when the train stands; its verdict is FAIL.
    """
    events = _events(trace)
    ended = next((event for event in sorted(events, reverse=True) if ends_run(event)), None)
    time_s = trace.times_s(SimTruth.PORT)
    truth = {
        "position": trace.values(SimTruth.PORT, "TruePos"),
        "speed": trace.values(SimTruth.PORT, "TrueSpeed"),
        "accel": trace.values(SimTruth.PORT, "TrueAccel"),
        "traction": trace.values(SimTruth.PORT, "TractionForce"),
        "brake": trace.values(SimTruth.PORT, "BrakeForce"),
    }
    # A telegram that was recorded twice counts once, so that the times are strictly increasing.
    fresh = np.diff(time_s, prepend=-1.0) > 0
    time_s, truth = time_s[fresh], {name: values[fresh] for name, values in truth.items()}
    whole = [Event.ENDED_COMPLETE, Event.ENDED_NOT_STOPPED]
    if any(map(_silences_controller, parse_faults(scenario.faults))):
        # The fault was requested: the train's run without the controller is judged.
        whole.append(Event.ENDED_CONTROLLER_LOST)
    if ended not in whole or len(time_s) < 2:
        name = ended.name.lower() if ended is not None else "record_incomplete"
        return _unscored(f"run {name}", name)
    unclear = incomplete(trace, SimTruth.PORT) or standstill_unclear(
        trace, time_s, truth["position"], truth["speed"]
    )  # fmt: skip
    if unclear:
        return _unscored(unclear, ended.name.lower())
    rules = broken(scenario, trace)
    if unclear := next((said for said in rules if said.startswith(UNCLEAR)), ""):
        return _unscored(unclear, ended.name.lower())
    ident = trace.ident(CtlIdent)
    run = Journey(
        scenario=scenario,
        indexing=INDEXINGS[ident.indexing] if ident is not None and ident.indexing < len(INDEXINGS) else "time",
        time_s=time_s,
        position_m=truth["position"],
        speed_mps=truth["speed"],
        accel_mps2=truth["accel"],
        traction_n=truth["traction"],
        brake_n=truth["brake"],
        stop=stop_of(scenario.plan, events.get(Event.STOPPED, [])),
    )
    over = run.speed_mps - limits_under_train(scenario.line.speed_limit_mps, run.position_m, scenario.train.length_m)
    emergency = events.get(Event.EMERGENCY)
    return judged(
        scenario,
        Measured(
            ended=ended,
            values={criterion.key: criterion.measure(run) for criterion in ATO_CRITERIA},
            overspeed_mps=float(max(0.0, over.max())),
            stop=run.stop,
            emergency_s=emergency[0][0] if emergency else None,
            wrap=wrap_failure(trace, STATUS),
            broken=rules,
        ),
    )
