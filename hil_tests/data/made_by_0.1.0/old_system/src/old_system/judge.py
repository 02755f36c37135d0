"""The criteria by which a run of the cart is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.supervisor.criteria import Criterion, Limit, scores, unscored
from railhil.supervisor.judging import Judging
from railhil.supervisor.score import Score
from railhil.supervisor.status import interface_status, wrap_failure
from railhil.supervisor.trace import Trace

from old_system import SYSTEM
from old_system.wire import COMMAND, INTERFACE, STAT, TRUTH

#: Telegram in which the law reports on itself and on its arithmetic.
STATUS = interface_status(INTERFACE)


@dataclass(frozen=True)
class Ride:
    """A complete run as arrays of shape (n,)."""

    task: Any
    time_s: Any
    position_m: Any


def _error_m(ride: Ride) -> float:
    """Largest distance from the target over the last second."""
    last = ride.time_s >= ride.time_s[-1] - 1.0
    return float(np.abs(ride.position_m[last] - ride.task.target_m).max())


def _overshoot_m(ride: Ride) -> float:
    """Largest distance past the target."""
    beyond = (ride.position_m - ride.task.target_m) * np.sign(ride.task.target_m)
    return max(0.0, float(beyond.max()))


#: Allowed difference of a median of railhil audit from that of float64: one step of the measured position, m.
_STEP_M = 0.0001
CRITERIA = (
    Criterion(
        "error_m",
        "end error",
        "m",
        4,
        _error_m,
        limit=Limit(lambda scenario: scenario.task.error_max_m, 0),
        audit_allowed=_STEP_M,
    ),
    Criterion("overshoot_m", "overshoot", "m", 3, _overshoot_m, audit_allowed=_STEP_M),
)


def score(scenario: Any, trace: Trace) -> Score:
    """PASS or FAIL by the limits; INVALID for a record without a normal end."""
    ended = Event.ENDED_COMPLETE in trace.raw(RunEvent.PORT, "RunEvent")
    if not ended or trace.count(TRUTH.PORT) < 2:
        return Score("INVALID", *unscored(CRITERIA), ("run did not come to its end",), "record_incomplete")
    ride = Ride(scenario.task, trace.times_s(TRUTH.PORT), trace.values(TRUTH.PORT, "TruePos"))
    measured = {criterion.key: criterion.measure(ride) for criterion in CRITERIA}
    missed = [f"{item.title} {text}" for item in CRITERIA if (text := item.missed(scenario, measured[item.key]))]
    missed += filter(None, [wrap_failure(trace, STATUS)])
    return Score("FAIL" if missed else "PASS", *scores(measured, CRITERIA), tuple(missed), "ended_complete")


def _facts(run: Any) -> list[tuple[str, str]]:
    arrived = SYSTEM.events["arrived"] in run.trace.raw(RunEvent.PORT, "RunEvent")
    return [("Cart", f"{run.scenario.task.mass_kg:g} kg"), ("Arrived", "yes" if arrived else "no")]


JUDGING = Judging(
    criteria=CRITERIA,
    score=score,
    truth=TRUTH.PORT,
    # Columns of signals.csv, each with its port and signal.
    columns=(
        ("true_position_m", TRUTH.PORT, "TruePos"),
        ("true_speed_mps", TRUTH.PORT, "TrueSpeed"),
        ("position_m", STAT.PORT, "CartPos"),
        ("force_n", COMMAND.PORT, "CartForce"),
    ),
    asked=lambda scenario: f"{scenario.task.duration_s:g} s; allowed ±{scenario.task.error_max_m:g} m",
    facts=_facts,
)
