"""The criteria of a run over a line: its worst stop, its timetable, energy and comfort."""

from __future__ import annotations

from math import sqrt

from railhil.judge.criteria import DID_NOT_STOP, STOP_ERROR_KEY, Criterion, Extra, Limit
from railhil.systems.ato.energy.record import energy_share_percent as share_percent
from railhil.systems.ato.judge import journey
from railhil.systems.ato.judge.criteria import OVERSPEED
from railhil.systems.line.judge.run import LineRun
from railhil.systems.line.judge.stop import LineStop
from railhil.systems.line.shipped_bounds import has_shipped_bounds

#: Times at a warning of the train protection or above, and at an intervention.
WARNINGS = Extra("atp_warnings", "ATP warnings", "atp_warnings", "ATP\nwarned", tuning_weight=0.0)
INTERVENTIONS = Extra("atp_interventions", "ATP interventions", "atp_interventions", "ATP\nbraked")
EXTRAS = (OVERSPEED, WARNINGS, INTERVENTIONS)


def _arrival_error_s(stop: LineStop) -> float | None:
    """Lateness of an arrival beyond what the run excuses, s; early arrivals are negative."""
    late_s = stop.late_s
    if late_s is None:
        return None
    return max(0.0, late_s - stop.excused_s) if late_s > 0.0 else min(0.0, late_s + stop.early_excused_s)


def rms_m(run: LineRun) -> float | None:
    """Root of the mean square of the stop errors, m; None if a stop was not made."""
    errors_m = [stop.error_m for stop in run.served]
    known = [error_m for error_m in errors_m if error_m is not None]
    return sqrt(sum(error_m**2 for error_m in known) / len(known)) if len(known) == len(errors_m) else None


def _lateness_s(run: LineRun) -> list[tuple[float, float]]:
    """Each arrival and departure with a time in the timetable: lateness and limit, s; infinite if it did not happen."""
    route, found = run.scenario.route, list[tuple[float, float]]()
    for stop in run.stops:
        if stop.planned.service == "stop" and stop.planned.due_s is not None:
            found.append((float("inf") if stop.late_s is None else stop.late_s, route.arrival_error_max_s))
        if stop.planned.departure_due_s is not None:
            late_s = stop.departure_late_s
            found.append((float("inf") if late_s is None else late_s, route.departure_late_max_s))
    return found


def punctuality_percent(run: LineRun) -> float:
    """Share of arrivals and departures within the limits of the route, whoever caused the others, in per cent."""
    lateness_s = _lateness_s(run)
    within = sum(abs(late_s) <= most_s for late_s, most_s in lateness_s)
    return 100.0 * within / max(len(lateness_s), 1)


def largest_lateness_s(run: LineRun) -> float | None:
    """Largest lateness of an arrival or departure, s; None if one did not happen."""
    latest_s = max((late_s for late_s, _ in _lateness_s(run)), default=0.0)
    return None if latest_s == float("inf") else max(0.0, latest_s)


def recovered_s(run: LineRun) -> float:
    """Lateness of departures that the sections after them made up, s."""
    total_s, left_late_s = 0.0, 0.0
    for stop in run.stops:
        if stop.planned.service == "pass":
            continue
        if stop.late_s is not None:
            total_s += max(0.0, left_late_s - max(0.0, stop.late_s))
        left_late_s = max(0.0, stop.departure_late_s or 0.0)
    return total_s


def own_delay_s(run: LineRun) -> float | None:
    """Longest time for which the controller held a departure back without need, s; None if one did not happen."""
    leaving = [stop for stop in run.stops if stop.planned.departure_due_s is not None]
    if any(stop.departed_s is None for stop in leaving):
        return None
    return max((stop.delay.controller for stop in leaving if stop.departure_late_s), default=0.0)


def returned_kj(run: LineRun) -> float | None:
    """Energy that was fed back in all sections, kJ; None if the train's electric brake is not known."""
    parts = [stop.section.regenerated_kj for stop in run.stops if stop.section is not None]
    known = [part for part in parts if part is not None]
    return sum(known) if len(known) == len(parts) else None


def energy_share_percent(run: LineRun) -> float | None:
    """Traction work of all sections as a share of the least work in the times that they took, in per cent; None if a
    section was not driven, or has no bound in its time."""
    parts = [stop.section for stop in run.stops if stop.section is not None]
    bounds_kj = [part.bound_kj for part in parts]
    known_kj = [bound_kj for bound_kj in bounds_kj if bound_kj is not None]
    if len(known_kj) < len(run.scenario.sections):
        return None
    return share_percent(sum(part.traction_kj for part in parts), sum(known_kj))


#: The largest limit of a stop: where stops have different ones, each is judged by its own.
STOP_ERROR = Criterion(
    STOP_ERROR_KEY, "stop error", "m", 4, lambda run: run.worst(lambda stop: stop.error_m),
    limit=Limit(lambda scenario: max(stop.stop_error_max_m for stop in scenario.stops), 0), signed=STOP_ERROR_KEY,
    tuning_digits=3, audit_allowed=0.01, without=DID_NOT_STOP,
)  # fmt: skip
#: Arrival with the largest difference from the timetable, without the lateness that the run excuses.
ARRIVAL_ERROR = Criterion(
    "arrival_error_s", "arrival error", "s", 3, lambda run: run.worst(_arrival_error_s),
    limit=Limit(lambda scenario: scenario.route.arrival_error_max_s, 1), signed="arrival_error_s",
    audit_allowed=0.01, without=DID_NOT_STOP,
)  # fmt: skip
OWN_DELAY = Criterion(
    "own_delay_s", "own delay", "s", 2, own_delay_s,
    limit=Limit(lambda scenario: scenario.route.departure_late_max_s, 2), without="did not depart",
)  # fmt: skip
#: ``stop_rms_m`` is of all stops, ``lateness_s`` the largest one of arrivals and departures; the energy that came back
#: is an estimate beside the energy, which does not count it.
CRITERIA = (
    STOP_ERROR,
    Criterion("stop_rms_m", "RMS error", "m", 4, rms_m, without=DID_NOT_STOP),
    ARRIVAL_ERROR,
    Criterion("lateness_s", "lateness", "s", 2, largest_lateness_s, without="did not end"),
    Criterion("recovered_s", "made up", "s", 2, recovered_s, better="high"),
    Criterion("punctuality_percent", "on time", "%", 1, punctuality_percent, better="high"),
    OWN_DELAY,
    Criterion("energy_kj", "energy", "kJ", 0, lambda run: journey.energy_kj(run.whole)),
    Criterion(
        "regenerated_kj",
        "returned",
        "kJ",
        0,
        returned_kj,
        better="high",
        applies=lambda scenario: scenario.train.electric_brake is not None,
        on_terminal=False,
    ),
    Criterion(
        "energy_share_percent",
        "energy share",
        "%",
        1,
        energy_share_percent,
        applies=has_shipped_bounds,
        without="no bound",
    ),
    Criterion("comfort", "comfort", "m/s2/km", 3, lambda run: journey.comfort_mps2_per_km(run.whole)),
)
