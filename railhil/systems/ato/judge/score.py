"""The score: a pure function of the scenario and the recorded telegrams.

:mod:`.criteria` has the criteria; this module decides whether the record holds a complete run, and the verdict. A
standstill of the train is a milestone, and is also visible in SIM_TRUTH: if the two disagree, the record is INVALID.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from railhil.bus.codes import Event, ends_run
from railhil.bus.ident import INDEXINGS, CtlIdent
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import text_beside_limit
from railhil.faults import parse_faults
from railhil.judge.criteria import limited, scores, unscored
from railhil.judge.record_checks import STAMP_ERROR_MAX_S, UNCLEAR, incomplete
from railhil.judge.score import Score
from railhil.judge.stops import ScoredStop
from railhil.record.notes import wrap_failure
from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.judge import measures
from railhil.systems.ato.judge.criteria import CRITERIA, OVERSPEED
from railhil.systems.ato.judge.events import STATUS
from railhil.systems.ato.judge.invariants import broken
from railhil.systems.ato.judge.journey import Journey, stop_of
from railhil.systems.ato.judge.measures import limits_under_train
from railhil.systems.ato.scenario.model import STOP_LEG_MIN_M, Scenario
from railhil.wire.ato import NotchCmd, SimTruth

if TYPE_CHECKING:
    from railhil.faults.model import Fault

#: Criteria with a limit, in the order of their failures.
_LIMITED = tuple(limited(CRITERIA))
#: A train that SIM_TRUTH shows at rest for this long has stopped. Speeds below half an LSB (0.05 mm/s) also appear as
#: rest, but no train creeps so slowly for so long.
STANDING_S = 0.5
#: Maximum acceleration of a train: limits the speed that SIM_TRUTH may show shortly after a standstill.
ACCEL_MAX_MPS2 = 10.0
#: Resolution of positions on the wire, rounded once in the milestone and once in the truth.
_LSB_M = 1e-4


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
    of :mod:`.invariants` that the run breaks.
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
    values, signed = scores(run.values, CRITERIA)
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
    return Score("INVALID", *unscored(CRITERIA), (reason,), ended, {OVERSPEED.key: 0.0})


def silences_controller(fault: Fault) -> bool:
    """Whether a run with this fault may end without a controller."""
    place = fault.place
    if place.level == "node":
        return place.name == "controller"
    return place.level == "bus" or (place.level == "telegram" and place.name == NotchCmd.PORT)


def standstill_unclear(trace: Trace, time_s: FloatArray, position_m: FloatArray, speed_mps: FloatArray) -> str:
    """The contradiction between STOPPED and SIM_TRUTH, as a reason; empty if they agree.

    :param time_s: of each SIM_TRUTH in s, increasing, shape (n,); ``position_m`` and ``speed_mps`` are its values.
    """
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    stopped = np.flatnonzero(codes == Event.STOPPED)
    instants_s, places_m = (trace.values(RunEvent.PORT, name)[stopped] for name in ("EventTime", "EventPos"))
    for instant_s, place_m in zip(instants_s, places_m, strict=True):
        if unclear := standstill_denied("STOPPED", instant_s, place_m, time_s, position_m, speed_mps):
            return unclear
    stands_s = _first_stand_s(time_s, position_m, speed_mps)
    # The milestone may lie anywhere within the standstill: a creeping train reads 0 before it has stopped.
    if stands_s is not None and not np.any(instants_s <= stands_s[1] + STAMP_ERROR_MAX_S):
        return f"{UNCLEAR}no STOPPED, but SIM_TRUTH shows that the train stands from {stands_s[0]:.2f} s on"
    return ""


def standstill_denied(
    name: str, instant_s: float, place_m: float, time_s: FloatArray, position_m: FloatArray, speed_mps: FloatArray
) -> str:
    """The contradiction between a milestone that says the train stands and SIM_TRUTH, as a reason; empty if they agree.

    :param name: of the milestone.
    :param instant_s, place_m: what it says.
    :param time_s: of each SIM_TRUTH, as in :func:`standstill_unclear`.
    """
    after = min(int(np.searchsorted(time_s, instant_s + STAMP_ERROR_MAX_S)), len(time_s) - 1)
    before = max(int(np.searchsorted(time_s, instant_s - STAMP_ERROR_MAX_S)) - 1, 0)
    allowed_mps = ACCEL_MAX_MPS2 * max(STAMP_ERROR_MAX_S, time_s[after] - instant_s)
    if speed_mps[after] > allowed_mps:
        return (
            f"{UNCLEAR}{name} at {instant_s:.2f} s, but SIM_TRUTH shows {speed_mps[after]:.2f} m/s "
            f"at {time_s[after]:.2f} s"
        )
    if not position_m[before] - 2 * _LSB_M <= place_m <= position_m[after] + 2 * _LSB_M:
        return (
            f"{UNCLEAR}{name} at {place_m:.2f} m, but SIM_TRUTH shows the train at {position_m[after]:.2f} m "
            f"at {time_s[after]:.2f} s"
        )
    return ""


def _first_stand_s(time_s: FloatArray, position_m: FloatArray, speed_mps: FloatArray) -> tuple[float, float] | None:
    """First and last SIM_TRUTH of the first standstill that counts as a stop; None if there is none."""
    rest = (speed_mps == 0.0) & (position_m >= position_m[0] + STOP_LEG_MIN_M + _LSB_M)
    edges = np.flatnonzero(np.diff(rest.astype(np.int8), prepend=0, append=0))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        if time_s[end - 1] - time_s[first] >= STANDING_S:
            return float(time_s[first]), float(time_s[end - 1])
    return None


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
    if any(map(silences_controller, parse_faults(scenario.faults))):
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
            values={criterion.key: criterion.measure(run) for criterion in CRITERIA},
            overspeed_mps=float(max(0.0, over.max())),
            stop=run.stop,
            emergency_s=emergency[0][0] if emergency else None,
            wrap=wrap_failure(trace, STATUS),
            broken=rules,
        ),
    )
