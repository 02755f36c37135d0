"""The data of a run over a line with stations, as frozen dataclasses in SI units.

A position is that of the train's front from the first stop (*run position*): it grows over the whole run, as the
odometer does. A leg behind a turn-back continues it, so the positions of its stops begin at that of the turn-back.
Times of the timetable are seconds from the start of the run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from railhil.systems.ato.scenario.generate import CurveLimits
from railhil.systems.ato.scenario.model import Line, Perturbations, Scenario, TargetCurve, Uniform
from railhil.systems.line.scenario.protection import Protection

Side = Literal["none", "left", "right", "both"]
Service = Literal["stop", "pass", "terminal"]
#: How a section is run: by the timetable, or in the time of a profile that the track side orders.
Mode = Literal["timetable", "fast", "normal", "economy"]
Regulation = Literal["retime", "profiles", "none"]
_NOTHING = Uniform(0.0, 0.0)
_GENERATOR = CurveLimits()
_PROTECTION = Protection()


@dataclass(frozen=True, slots=True)
class StationStop:
    """A stop of the route, in the order of the run.

    ``leg``: number of the leg on which the train arrives, from 0 (of the first stop: on which it departs).
    ``arrive_s`` is None at the first stop and where the train passes, ``depart_s`` also at the terminal. After a
    ``turn_back`` the train departs on the next leg. ``mode``: what the track side orders for the section that begins
    here (ModeOrder of STN_INFO); a profile is kept whatever the timetable says.
    """

    name: str
    position_m: float
    leg: int = 0
    service: Service = "stop"
    platform: Side = "none"
    psd: bool = False
    arrive_s: float | None = None
    depart_s: float | None = None
    stop_error_max_m: float = 0.3
    dwell_min_s: float = 20.0
    eoa_overlap_m: float = 10.0
    svl_overlap_m: float = 30.0
    turn_back: bool = False
    mode: Mode = "timetable"


@dataclass(frozen=True, slots=True)
class RouteSignal:
    """A signal that shows red until a time of the run."""

    position_m: float
    clear_s: float
    leg: int = 0


@dataclass(frozen=True, slots=True)
class Doors:
    """Times of the doors, and how often they reopen for an obstacle before they count as failed."""

    open_s: float = 2.5
    close_s: float = 3.0
    warn_s: float = 2.0
    reopen_max: int = 3


@dataclass(frozen=True, slots=True)
class Jog:
    """Creeping to a stopping point that the train has stopped short of."""

    attempts: int = 2
    reach_m: float = 5.0
    speed_mps: float = 3.0 / 3.6


@dataclass(frozen=True, slots=True)
class Hold:
    """An additional dwell, drawn at each stop."""

    probability: float = 0.0
    extra_s: Uniform = _NOTHING


@dataclass(frozen=True, slots=True)
class Route:
    """The rules of the run: limits of a PASS, dwell, regulation, doors.

    ``profiles_percent``: reserves of the profiles fast, normal and economy over the generator's fastest run.
    """

    door_window_m: float = 0.5
    arrival_error_max_s: float = 5.0
    departure_late_max_s: float = 10.0
    regulation: Regulation = "retime"
    profiles_percent: tuple[float, float, float] = (0.0, 5.0, 12.0)
    dwell_disturbance_s: Uniform = _NOTHING
    hold: Hold = Hold()
    doors: Doors = Doors()
    jog: Jog = Jog()
    generate: CurveLimits = _GENERATOR


@dataclass(frozen=True, slots=True)
class Section:
    """The run between two served stops, by their numbers in ``LineScenario.stops``, from 0.

    ``running_time_s`` is that of the timetable and of ``target``, whose time begins at the departure. ``fastest_s``:
    shortest running time of the generator. ``profiles``: curves fast, normal and economy, if the route is regulated by
    profiles, or the track side orders one of them.
    """

    departure: int
    arrival: int
    leg: int
    running_time_s: float
    fastest_s: float
    target: TargetCurve
    profiles: tuple[TargetCurve, ...] = ()


@dataclass(frozen=True, slots=True)
class EmergencyBrake:
    """The train's emergency brake: a force on the nominal inertial mass, after a dead time, with a first-order lag."""

    braking_mps2: float = 1.2
    dead_s: float = 0.3
    lag_s: float = 0.6


@dataclass(frozen=True, slots=True)
class LinePerturbations(Perturbations):
    """Additional distributions: mass drawn for each section, wheel of the train protection's own axle."""

    section_mass_factor: Uniform | None = None
    atp_wheel_factor: Uniform | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LineScenario(Scenario):
    """A run over a line with stations.

    Of the fields of :class:`~railhil.systems.ato.scenario.model.Scenario`, ``line`` is that of the first leg and
    ``target`` that of the first section. ``plan`` spans the whole run: position of the last stop, and arrival there.
    """

    legs: tuple[Line, ...]
    stops: tuple[StationStop, ...]
    sections: tuple[Section, ...]
    route: Route = Route()
    signals: tuple[RouteSignal, ...] = ()
    atp: Protection = _PROTECTION
    #: None: the emergency brake of ``ato``, the full service brake at once.
    emergency: EmergencyBrake | None = None
    perturbations: LinePerturbations = field(default_factory=LinePerturbations)
    system: str = "line"

    @property
    def every_run_is_drawn(self) -> bool:
        """Whether dwell times are drawn in nominal runs, too."""
        disturbed, hold = self.route.dwell_disturbance_s, self.route.hold
        return disturbed.high > 0.0 or hold.probability > 0.0

    @property
    def marks(self) -> Mapping[str, Sequence[float | None]]:
        """Arrival at each stop, and departure into each section, in s; numbers count from 1.

        The run begins at the first stop. A stop that the train passes has no time.
        """
        return find_marks(self.stops)


def find_marks(stops: Sequence[StationStop]) -> Mapping[str, Sequence[float | None]]:
    """Planned instants of a line, at which faults may begin: ``@stop 3``, ``@section 5 40s``; see
    :attr:`LineScenario.marks`."""
    return {
        "stop": (0.0, *(stop.arrive_s for stop in stops[1:])),
        "section": tuple(stop.depart_s for stop in stops if stop.depart_s is not None),
    }
