"""The score: a pure function of the scenario and the recorded telegrams.

Definitions: eqs. (4) to (8) of Wang et al., "An improved predictive function control algorithm for velocity curve of
urban rail vehicle", with the readings of the bench's notes (ITAE in km/h, comfort with the last drop to zero).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from railhil.bus.ident import INDEXINGS, CtlIdent
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import ControllerFlag, CtlStat, Event, RunEvent, SimTruth
from railhil.scenarios.model import Scenario
from railhil.scenarios.target import Target
from railhil.supervisor import measures
from railhil.supervisor.measures import limits_under_train
from railhil.supervisor.trace import FloatArray, Trace
from railhil.supervisor.witness import milestone_missing, standstill_unclear

#: A record without SIM_TRUTH for longer than this shows no run: what the train did meanwhile is not in it. A bus that
#: fails for moments leaves shorter gaps.
HOLE_MAX_S = 1.0
#: How the failure of a run begins in which the controller's fixed point has wrapped.
WRAP_FAILURE = "fixed-point wrap in the controller"

#: Stop errors, in m, by which runs are counted beside the scenario's own limit: the stricter figures stay visible.
STOP_WITHIN_M = (0.1, 0.2, 0.3)


@dataclass(frozen=True, slots=True)
class Score:
    """Scores of one run; ``None`` where the run never got there (a train that did not stop has no stop error).

    ``itae`` km/h s^2, ``energy_kj`` kJ, ``punctuality_s`` s, ``stop_error_m`` m, ``comfort`` m/s^2 per km;
    signed: positive ``time_error_s`` is late, positive ``stop_error_m`` is past the stopping point.
    """

    verdict: str
    itae: float | None
    energy_kj: float | None
    punctuality_s: float | None
    stop_error_m: float | None
    comfort: float | None
    signed_time_error_s: float | None
    signed_stop_error_m: float | None
    overspeed_mps: float
    failures: tuple[str, ...]
    ended: str

    def as_json(self) -> dict[str, object]:
        """The part of ``score.json`` that comes from the log alone."""
        return {
            "verdict": self.verdict,
            "scores": {
                "itae": self.itae,
                "energy_kj": self.energy_kj,
                "punctuality_s": self.punctuality_s,
                "stop_error_m": self.stop_error_m,
                "comfort": self.comfort,
            },
            "signed": {"time_error_s": self.signed_time_error_s, "stop_error_m": self.signed_stop_error_m},
            "overspeed_mps": self.overspeed_mps,
            "failures": list(self.failures),
            "ended": self.ended,
        }


def _samples(scenario: Scenario) -> float:
    """Time between two SIM_TRUTH telegrams in s."""
    timing = scenario.timing
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns)
    return schedule.ticks(SimTruth.PORT) * timing.base_tick_ns / 1e9


@dataclass(frozen=True, slots=True)
class ErrorGrid:
    """Where the ITAE compares speed and set-point: at every SIM_TRUTH until the timetable's end.

    ``time_s`` and ``cycle`` (control period of each, from 0) have the shape (n,), ``counts`` (cycles,) says how many
    there are in each cycle.
    """

    step_s: float
    period_s: float
    time_s: FloatArray
    cycle: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]

    @classmethod
    def of(cls, scenario: Scenario) -> ErrorGrid:
        """Grid of a scenario."""
        period_s = scenario.timing.control_period_ns / 1e9
        cycles = math.ceil(round(scenario.plan.running_time_s / period_s, 9))
        step_s = _samples(scenario)
        time_s: FloatArray = np.asarray(np.arange(1, round(cycles * period_s / step_s) + 1) * step_s, dtype=np.float64)
        cycle = np.ceil(np.round(time_s / period_s, 9)).astype(np.int64) - 1
        inside = (cycle >= 0) & (cycle < cycles)
        time_s, cycle = time_s[inside], cycle[inside]
        return cls(step_s, period_s, time_s, cycle, np.bincount(cycle, minlength=cycles))


def _itae(scenario: Scenario, target: Target, indexing: str, time_s: FloatArray, truth: dict[str, FloatArray]) -> float:
    """Eq. (4), e in km/h; standstill counts to the timetable's end."""
    grid = ErrorGrid.of(scenario)
    index = np.minimum(np.searchsorted(time_s, grid.time_s - grid.step_s / 2), len(time_s) - 1)
    speed = np.where(grid.time_s > time_s[-1] + grid.step_s / 2, 0.0, truth["speed"][index])
    if indexing == "distance":
        wanted = np.asarray(target.speed_mps(target.time_s(truth["position"][index])))
    else:
        wanted = np.asarray(target.speed_mps(grid.time_s))
    sums = np.bincount(grid.cycle, weights=measures.error_kmh(wanted, speed), minlength=len(grid.counts))
    return float(measures.itae_kmh_s2(sums, grid.counts, grid.period_s))


def _energy_kj(scenario: Scenario, time_s: FloatArray, truth: dict[str, FloatArray], stop_s: float) -> float:
    """Eq. (5) up to the stop."""
    moving = time_s <= stop_s
    steps_s = np.diff(time_s[moving])

    def work_j(force: str) -> Any:
        power_w = (truth[force] * truth["speed"])[moving]
        return measures.total(measures.work_j(steps_s, power_w[:-1], power_w[1:]))

    return float(measures.energy_kj(scenario.energy, work_j("traction"), work_j("brake"), stop_s))


def _comfort(scenario: Scenario, time_s: FloatArray, accel_mps2: FloatArray) -> float:
    """Eq. (6), from the first SIM_TRUTH of each control period on."""
    period_s = scenario.timing.control_period_ns / 1e9
    ticks_s = np.arange(0, int(time_s[-1] / period_s) + 1) * period_s
    samples = accel_mps2[np.minimum(np.searchsorted(time_s, ticks_s - 1e-9), len(time_s) - 1)]
    return float(measures.comfort_mps2_per_km(samples, scenario.plan.distance_m))


def _events(trace: Trace) -> dict[Event, tuple[float, float]]:
    """First ``(instant s, true position m)`` of each kind of event."""
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    instants = trace.values(RunEvent.PORT, "EventTime")
    positions = trace.values(RunEvent.PORT, "EventPos")
    found: dict[Event, tuple[float, float]] = {}
    for code, instant_s, position_m in zip(codes, instants, positions, strict=True):
        if int(code) in Event._value2member_map_:
            found.setdefault(Event(int(code)), (float(instant_s), float(position_m)))
    return found


def _wrap(trace: Trace) -> str:
    """The failure of a controller that says its arithmetic has wrapped: a notch after that means nothing."""
    wrapped = np.flatnonzero(trace.raw(CtlStat.PORT, "OverflowFlags") & ControllerFlag.WRAP)
    return f"{WRAP_FAILURE}, reported at {trace.times_s(CtlStat.PORT)[wrapped[0]]:.2f} s" if len(wrapped) else ""


@dataclass(frozen=True, slots=True)
class Measured:
    """What a whole run has been measured to be: see :class:`Score`.

    ``stop``: instant in s and true position in m of the first stop, ``emergency_s`` instant of the first emergency
    brake, ``wrap`` the failure of a controller whose arithmetic has wrapped.
    """

    ended: Event
    itae: float
    energy_kj: float
    comfort: float
    overspeed_mps: float
    stop: tuple[float, float] | None
    emergency_s: float | None
    wrap: str = ""


def judged(scenario: Scenario, run: Measured) -> Score:
    """Score of a whole run with its verdict: what of the limits in the plan it misses."""
    plan = scenario.plan
    time_error = run.stop[0] - plan.running_time_s if run.stop else None
    stop_error = run.stop[1] - plan.distance_m if run.stop else None
    failures = []
    if stop_error is None or time_error is None:
        failures.append(f"not stopped {plan.overtime_max_s:g} s after the timetable")
    else:
        if abs(stop_error) > plan.stop_error_max_m:
            failures.append(f"stop error {stop_error:+.3f} m, allowed +-{plan.stop_error_max_m:g} m")
        if abs(time_error) > plan.time_error_max_s:
            failures.append(f"time error {time_error:+.3f} s, allowed +-{plan.time_error_max_s:g} s")
    if run.overspeed_mps > 0:
        failures.append(f"overspeed {run.overspeed_mps * measures.KMH:.2f} km/h, allowed 0")
    if run.emergency_s is not None:
        failures.append(f"emergency brake at {run.emergency_s:.2f} s")
    if run.wrap:
        failures.append(run.wrap)
    return Score(
        verdict="FAIL" if failures else "PASS",
        itae=run.itae,
        energy_kj=run.energy_kj,
        punctuality_s=None if time_error is None else abs(time_error),
        stop_error_m=None if stop_error is None else abs(stop_error),
        comfort=run.comfort,
        signed_time_error_s=time_error,
        signed_stop_error_m=stop_error,
        overspeed_mps=run.overspeed_mps,
        failures=tuple(failures),
        ended=run.ended.name.lower(),
    )


def _unscored(reason: str, ended: str) -> Score:
    """What is said of a record that does not show a whole run."""
    return Score("INVALID", None, None, None, None, None, None, None, 0.0, (reason,), ended)


def score(scenario: Scenario, trace: Trace) -> Score:
    """Score a recorded run.

    :param scenario: the *nominal* scenario of the run (its plan, target curve and limits).
    :returns: verdict PASS or FAIL; INVALID when the record does not hold a whole run.
    """
    events = _events(trace)
    ended = next((event for event in sorted(events, reverse=True) if event.ends_run), None)
    time_s = trace.times_s(SimTruth.PORT)
    truth = {
        "position": trace.values(SimTruth.PORT, "TruePos"),
        "speed": trace.values(SimTruth.PORT, "TrueSpeed"),
        "accel": trace.values(SimTruth.PORT, "TrueAccel"),
        "traction": trace.values(SimTruth.PORT, "TractionForce"),
        "brake": trace.values(SimTruth.PORT, "BrakeForce"),
    }
    # A telegram that was recorded twice counts once: the times of the rest increase.
    fresh = np.diff(time_s, prepend=-1.0) > 0
    time_s, truth = time_s[fresh], {name: values[fresh] for name, values in truth.items()}
    whole = (Event.ENDED_COMPLETE, Event.ENDED_NOT_STOPPED)
    if ended not in whole or len(time_s) < 2:
        name = ended.name.lower() if ended is not None else "record_incomplete"
        return _unscored(f"run {name}", name)
    gaps_s = np.diff(time_s)
    if gaps_s.max() > HOLE_MAX_S:
        longest = int(gaps_s.argmax())
        return _unscored(
            f"record: no SIM_TRUTH for {gaps_s[longest]:.2f} s from {time_s[longest]:.2f} s on, "
            f"allowed {HOLE_MAX_S:g} s",
            ended.name.lower(),
        )
    unclear = milestone_missing(trace) or standstill_unclear(trace, time_s, truth["position"], truth["speed"])
    if unclear:
        return _unscored(unclear, ended.name.lower())
    ident = trace.ident(CtlIdent)
    indexing = INDEXINGS[ident.indexing] if ident is not None and ident.indexing < len(INDEXINGS) else "time"
    over = truth["speed"] - limits_under_train(
        scenario.line.speed_limit_mps, truth["position"], scenario.train.length_m
    )
    stop = events.get(Event.STOPPED)
    emergency = events.get(Event.EMERGENCY)
    return judged(
        scenario,
        Measured(
            ended=ended,
            itae=_itae(scenario, Target(scenario.target), indexing, time_s, truth),
            energy_kj=_energy_kj(scenario, time_s, truth, stop[0] if stop else float(time_s[-1])),
            comfort=_comfort(scenario, time_s, truth["accel"]),
            overspeed_mps=float(max(0.0, over.max())),
            stop=stop,
            emergency_s=emergency[0] if emergency else None,
            wrap=_wrap(trace),
        ),
    )
