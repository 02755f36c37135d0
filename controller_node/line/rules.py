"""The rules of a route for the station automaton: its served stops, lengths in 0.1 mm and times in ms."""

from __future__ import annotations

from typing import Final, NamedTuple

from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.line import DoorSide

_SIDES: Final = {"none": DoorSide.NONE, "left": DoorSide.LEFT, "right": DoorSide.RIGHT, "both": DoorSide.BOTH}


class ServedStop(NamedTuple):
    """A stop at which the train stands, as whole numbers: its number on the wire, 0.1 mm of the run, ms."""

    number: int
    position_01mm: int
    side: DoorSide
    is_terminal: bool
    turns_back: bool
    dwell_min_ms: int
    depart_ms: int


class StationRules(NamedTuple):
    """Rules of a route: its served stops, lengths in 0.1 mm and times in ms.

    ``platform_01mm``: a train that stands within this length before the stopping point is at the platform.
    """

    stops: tuple[ServedStop, ...]
    window_01mm: int
    reach_01mm: int
    platform_01mm: int
    attempts: int
    open_ms: int
    close_ms: int
    warn_ms: int
    reopen_max: int

    @classmethod
    def of(cls, scenario: LineScenario) -> StationRules:
        """Rules of a line."""
        route = scenario.route
        stops = [
            ServedStop(
                number,
                round(stop.position_m * 1e4),
                _SIDES[stop.platform],
                stop.service == "terminal",
                stop.turn_back,
                round(stop.dwell_min_s * 1000),
                round((stop.depart_s or 0.0) * 1000),
            )
            for number, stop in enumerate(scenario.stops, 1)
            if stop.service != "pass"
        ]
        doors, jog = route.doors, route.jog
        open_ms, close_ms, warn_ms = (round(time_s * 1000) for time_s in (doors.open_s, doors.close_s, doors.warn_s))
        return cls(
            tuple(stops),
            round(route.door_window_m * 1e4),
            round(jog.reach_m * 1e4),
            round(scenario.train.length_m * 1e4),
            jog.attempts,
            open_ms,
            close_ms,
            warn_ms,
            doors.reopen_max,
        )
