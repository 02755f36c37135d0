"""The criteria by which a run of two carts is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.judge.criteria import Criterion, Limit, scores, unscored
from railhil.judge.judging import Judging
from railhil.judge.score import Score
from railhil.judge.stops import PlannedStop, ScoredStop, Standstill, missed_stops
from railhil.record.notes import interface_status, wrap_failure
from railhil.record.trace import Trace
from two_carts import SYSTEM
from two_carts.wire import COMMANDS, INTERFACE, STATS, TRUTH

#: Telegram in which the laws report on themselves and on their arithmetic.
STATUS = interface_status(INTERFACE)


@dataclass(frozen=True)
class Ride:
    """A complete run as arrays: times (n,), positions (2, n)."""

    task: Any
    time_s: Any
    position_m: Any


def _error_m(ride: Ride) -> float:
    """Largest distance of either cart from its target over the last second."""
    last = ride.time_s >= ride.time_s[-1] - 1.0
    target_m = np.array(ride.task.target_m)[:, None]
    return float(np.abs(ride.position_m[:, last] - target_m).max())


def _stretch_m(ride: Ride) -> float:
    """Largest extension or compression of the spring."""
    return float(np.abs(ride.position_m[1] - ride.position_m[0]).max())


CRITERIA = (
    Criterion(
        "error_m",
        "end error",
        "m",
        4,
        _error_m,
        limit=Limit(lambda scenario: scenario.task.error_max_m, 0),
        # The resolution of a reading.
        audit_allowed=0.0001,
    ),
    Criterion("stretch_m", "stretch", "m", 3, _stretch_m),
)


def score(scenario: Any, trace: Trace) -> Score:
    """PASS or FAIL by the end error; INVALID for a record without a normal end."""
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    if Event.ENDED_COMPLETE not in codes or trace.count(TRUTH.PORT) < 2:
        return Score("INVALID", *unscored(CRITERIA), ("run did not come to its end",), "record_incomplete")
    places = np.array([trace.values(TRUTH.PORT, f"TruePos{unit}") for unit in (1, 2)])
    ride = Ride(scenario.task, trace.times_s(TRUTH.PORT), places)
    measured = {criterion.key: criterion.measure(ride) for criterion in CRITERIA}
    missed = [f"{item.title} {text}" for item in CRITERIA if (text := item.missed(scenario, measured[item.key]))]
    stops = _stops(ride)
    missed += missed_stops(stops)
    missed += filter(None, [wrap_failure(trace, STATUS)])
    verdict = "FAIL" if missed else "PASS"
    return Score(verdict, *scores(measured, CRITERIA), tuple(missed), "ended_complete", stops=stops)


def _stops(ride: Ride) -> tuple[ScoredStop, ...]:
    """The task: each cart is at its target at the end of the run."""
    return tuple(
        ScoredStop(
            PlannedStop(f"of cart {unit + 1}", target_m, ride.task.error_max_m),
            Standstill(float(ride.time_s[-1]), float(ride.position_m[unit, -1])),
        )
        for unit, target_m in enumerate(ride.task.target_m)
    )


def _facts(run: Any) -> list[tuple[str, str]]:
    task = run.scenario.task
    arrived = SYSTEM.events["arrived"] in run.trace.raw(RunEvent.PORT, "RunEvent")
    return [
        ("Carts", f"{task.mass_kg[0]:g} kg and {task.mass_kg[1]:g} kg"),
        ("Arrived", "yes" if arrived else "no"),
    ]


JUDGING = Judging(
    criteria=CRITERIA,
    score=score,
    truth=TRUTH.PORT,
    columns=(
        ("true_position1_m", TRUTH.PORT, "TruePos1"),
        ("true_position2_m", TRUTH.PORT, "TruePos2"),
        ("position1_m", STATS[0].PORT, "Unit1Pos"),
        ("force1_n", COMMANDS[0].PORT, "Unit1Force"),
        ("force2_n", COMMANDS[1].PORT, "Unit2Force"),
    ),
    asked=lambda scenario: f"{scenario.task.duration_s:g} s; allowed ±{scenario.task.error_max_m:g} m",
    facts=_facts,
)
