"""Hash of a scenario of ``line``: limits that only judge a run change no frame, and so do not change it."""

from __future__ import annotations

from dataclasses import replace

from railhil.systems.ato.scenario import canonical
from railhil.systems.line.scenario.model import LineScenario, Route, StationStop

_ROUTE, _STOP = Route(), StationStop("", 0.0)


def scenario_sha256(scenario: LineScenario) -> str:
    """SHA-256 (hex) of the data that the run uses."""
    route = replace(
        scenario.route,
        arrival_error_max_s=_ROUTE.arrival_error_max_s,
        departure_late_max_s=_ROUTE.departure_late_max_s,
    )
    stops = tuple(replace(stop, stop_error_max_m=_STOP.stop_error_max_m) for stop in scenario.stops)
    return canonical.scenario_sha256(replace(scenario, route=route, stops=stops))
