"""The score: a pure function of the scenario and the recorded telegrams.

Definitions: eqs. (4) to (8) of Wang et al., "An improved predictive function control algorithm for velocity curve of
urban rail vehicle", with the readings of the bench's notes (ITAE in km/h, comfort with the last drop to zero).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bus.ident import INDEXINGS, CtlIdent
from bus.schedule import Schedule
from bus.telegrams import ControllerFlag, CtlStat, Event, RunEvent, SimTruth
from scenarios.model import Profile, Scenario
from scenarios.target import Target
from supervisor.trace import FloatArray, Trace

_KMH = 3.6
#: How the failure of a run begins in which the controller's fixed point has wrapped.
WRAP_FAILURE = "fixed-point wrap in the controller"


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


def limits_under_train(limits: Profile, front_m: FloatArray, length_m: float) -> FloatArray:
    """Speed limit in force for the whole train at each front position, m/s, shape of ``front_m``.

    A lower limit holds from the front's passing, a higher one when the rear has passed.
    """
    allowed = np.full(front_m.shape, np.inf)
    for index, (start_m, limit) in enumerate(limits):
        end_m = limits[index + 1][0] if index + 1 < len(limits) else np.inf
        begin_m = -np.inf if index == 0 else start_m
        touched = (front_m >= begin_m) & (front_m - length_m < end_m)
        allowed = np.where(touched, np.minimum(allowed, limit), allowed)
    return allowed


def _itae(scenario: Scenario, target: Target, indexing: str, time_s: FloatArray, truth: dict[str, FloatArray]) -> float:
    """Eq. (4): sum of k Tc^2 times the mean |e| of cycle k, e in km/h; standstill counts to the timetable's end."""
    period_s = scenario.timing.control_period_ns / 1e9
    cycles = math.ceil(round(scenario.plan.running_time_s / period_s, 9))
    timing = scenario.timing
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns)
    step_s = schedule.ticks(SimTruth.PORT) * timing.base_tick_ns / 1e9
    grid_s: FloatArray = np.asarray(np.arange(1, round(cycles * period_s / step_s) + 1) * step_s, dtype=np.float64)
    index = np.minimum(np.searchsorted(time_s, grid_s - step_s / 2), len(time_s) - 1)
    speed = np.where(grid_s > time_s[-1] + step_s / 2, 0.0, truth["speed"][index])
    if indexing == "distance":
        wanted = np.asarray(target.speed_mps(target.time_s(truth["position"][index])))
    else:
        wanted = np.asarray(target.speed_mps(grid_s))
    cycle = np.ceil(np.round(grid_s / period_s, 9)).astype(int)
    error = np.abs(wanted - speed) * _KMH
    sums = np.bincount(cycle, weights=error, minlength=cycles + 1)[1 : cycles + 1]
    counts = np.bincount(cycle, minlength=cycles + 1)[1 : cycles + 1]
    return float(np.sum(np.arange(1, cycles + 1) * period_s**2 * sums / np.maximum(counts, 1)))


def _energy_kj(scenario: Scenario, time_s: FloatArray, truth: dict[str, FloatArray], stop_s: float) -> float:
    """Eq. (5): traction work / xi_M + auxiliary power * time + xi_B * brake work."""
    moving = time_s <= stop_s
    seconds = time_s[moving]
    traction_j = np.trapezoid((truth["traction"] * truth["speed"])[moving], seconds)
    brake_j = np.trapezoid((truth["brake"] * truth["speed"])[moving], seconds)
    energy = scenario.energy
    return float(traction_j / energy.xi_m + energy.auxiliary_power_w * stop_s + energy.xi_b * brake_j) / 1000


def _comfort(scenario: Scenario, time_s: FloatArray, accel_mps2: FloatArray) -> float:
    """Eq. (6): sum of |a_k - a_(k-1)| over control ticks, with the last drop to zero, per km of the plan."""
    period_s = scenario.timing.control_period_ns / 1e9
    ticks_s = np.arange(0, int(time_s[-1] / period_s) + 1) * period_s
    samples = accel_mps2[np.minimum(np.searchsorted(time_s, ticks_s - 1e-9), len(time_s) - 1)]
    travelled = np.abs(np.diff(samples)).sum() + abs(samples[-1])
    return float(travelled / (scenario.plan.distance_m / 1000))


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
    ended_name = ended.name.lower() if ended is not None else "record_incomplete"
    whole = (Event.ENDED_COMPLETE, Event.ENDED_NOT_STOPPED)
    if ended not in whole or len(time_s) < 2:
        return Score("INVALID", None, None, None, None, None, None, None, 0.0, (f"run {ended_name}",), ended_name)
    ident = trace.ident(CtlIdent)
    indexing = INDEXINGS[ident.indexing] if ident is not None and ident.indexing < len(INDEXINGS) else "time"
    over = truth["speed"] - limits_under_train(
        scenario.line.speed_limit_mps, truth["position"], scenario.train.length_m
    )
    overspeed_mps = float(max(0.0, over.max()))
    stop = events.get(Event.STOPPED)
    plan = scenario.plan
    time_error = stop[0] - plan.running_time_s if stop else None
    stop_error = stop[1] - plan.distance_m if stop else None
    end_s = stop[0] if stop else float(time_s[-1])
    failures = []
    if stop_error is None or time_error is None:
        failures.append(f"not stopped {plan.overtime_max_s:g} s after the timetable")
    else:
        if abs(stop_error) > plan.stop_error_max_m:
            failures.append(f"stop error {stop_error:+.3f} m, allowed +-{plan.stop_error_max_m:g} m")
        if abs(time_error) > plan.time_error_max_s:
            failures.append(f"time error {time_error:+.3f} s, allowed +-{plan.time_error_max_s:g} s")
    if overspeed_mps > 0:
        failures.append(f"overspeed {overspeed_mps * _KMH:.2f} km/h, allowed 0")
    if Event.EMERGENCY in events:
        failures.append(f"emergency brake at {events[Event.EMERGENCY][0]:.2f} s")
    if wrap := _wrap(trace):
        failures.append(wrap)
    return Score(
        verdict="FAIL" if failures else "PASS",
        itae=_itae(scenario, Target(scenario.target), indexing, time_s, truth),
        energy_kj=_energy_kj(scenario, time_s, truth, end_s),
        punctuality_s=None if time_error is None else abs(time_error),
        stop_error_m=None if stop_error is None else abs(stop_error),
        comfort=_comfort(scenario, time_s, truth["accel"]),
        signed_time_error_s=time_error,
        signed_stop_error_m=stop_error,
        overspeed_mps=overspeed_mps,
        failures=tuple(failures),
        ended=ended_name,
    )
