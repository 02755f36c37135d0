"""Schema of the scenario files of ``line``: the tables that differ from those of ``ato``.

``[route]`` replaces ``[target]`` and ``[plan]``. This module only defines the contents of a file: :mod:`.files` turns
it into :mod:`.model`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from railhil.scenarios.schema import (
    RUNNING_TIME_MAX_S,
    DefineTable,
    FaultRows,
    HuntTable,
    Name,
    NotNegative,
    Pair,
    Positive,
    RequirementRows,
    Table,
    Text,
    TimingTable,
)
from railhil.systems.ato.scenario import schema
from railhil.systems.ato.scenario.model import DISTANCE_MAX_M
from railhil.systems.line.scenario.model import Mode, Regulation, Service, Side
from railhil.systems.line.scenario.protection import AtpTable

#: A time of the run.
Time = Annotated[float, Field(ge=0, le=RUNNING_TIME_MAX_S)]
Duration = Annotated[float, Field(gt=0, le=RUNNING_TIME_MAX_S)]
#: The number of a leg has two bits on the wire.
LEGS_MAX = 4
#: Numbers of stops and sections have one byte, and 0 means none.
STOPS_MAX = 255


def _count(value: Any) -> str:
    return "each" if isinstance(value, list) else "all"


#: One value for all stops, or an array with one for each; the tags never appear in messages.
COUNT_TAGS = ("all", "each")
Durations = Annotated[
    Annotated[NotNegative, Tag("all")] | Annotated[list[NotNegative], Tag("each")], Discriminator(_count)
]
Sides = Annotated[Annotated[Side, Tag("all")] | Annotated[list[Side], Tag("each")], Discriminator(_count)]
Modes = Annotated[Annotated[Mode, Tag("all")] | Annotated[list[Mode], Tag("each")], Discriminator(_count)]
Flags = Annotated[Annotated[bool, Tag("all")] | Annotated[list[bool], Tag("each")], Discriminator(_count)]


class EmergencyTable(Table):
    """The train's emergency brake: a force on the nominal inertial mass, after a dead time, with a lag."""

    braking_mps2: Positive = 1.2
    dead_s: Annotated[float, Field(ge=0, le=10)] = 0.3
    lag_s: Annotated[float, Field(ge=0, le=10)] = 0.6


class TrainTable(schema.TrainTable):
    """A train given by its own data."""

    emergency: EmergencyTable | None = None


class ImportedTrainTable(schema.ImportedTrainTable):
    """A train from a file of another tool."""

    emergency: EmergencyTable | None = None


AnyTrain = Annotated[
    Annotated[TrainTable, Tag("own")] | Annotated[ImportedTrainTable, Tag("imported")],
    Discriminator(schema.train_kind),
]


class LineTable(schema.TrackTable):
    """The line of the first leg; the route says from which stop to which."""

    direction: Literal["forward", "return"] = "forward"
    balises_before_stop_m: schema.BalisesBeforeStop = []
    assumptions: list[Text] = []


class RouteStopTable(Table):
    """A stop of the route. ``running_time_s``, from the departure before, may replace ``arrive_s``."""

    name: Text
    position_m: Annotated[float, Field(ge=-DISTANCE_MAX_M, le=DISTANCE_MAX_M)]
    service: Service | None = None
    platform: Side | None = None
    psd: bool | None = None
    mode: Mode | None = None
    arrive_s: Time | None = None
    running_time_s: Duration | None = None
    depart_s: Time | None = None
    stop_error_max_m: Positive | None = None
    dwell_min_s: NotNegative | None = None
    eoa_overlap_m: NotNegative | None = None
    svl_overlap_m: NotNegative | None = None


class LegTable(Table):
    """A leg behind a turn-back: the same line in the other direction (``return``), or another line file."""

    line: Text
    turn_back_s: NotNegative = 120.0
    from_stop: Text | int | None = None
    to_stop: Text | int | None = None
    running_time_s: list[Duration] = []
    dwell_s: Durations | None = None
    platform: Sides | None = None
    psd: Flags | None = None
    mode: Modes | None = None
    target_files: list[Text] = []


class SignalTable(Table):
    """A signal that shows red until a time of the run."""

    position_m: Annotated[float, Field(ge=-DISTANCE_MAX_M, le=DISTANCE_MAX_M)]
    clear_s: Time
    leg: Annotated[int, Field(ge=1, le=LEGS_MAX)] = 1


class HoldTable(Table):
    """An additional dwell that is drawn at each stop."""

    probability: Annotated[float, Field(ge=0, le=1)] = 0.0
    extra_s: Pair = (0.0, 0.0)


class DoorsTable(Table):
    """Times of the doors, and how often they reopen for an obstacle."""

    open_s: Annotated[float, Field(gt=0, le=60)] = 2.5
    close_s: Annotated[float, Field(gt=0, le=60)] = 3.0
    warn_s: Annotated[float, Field(ge=0, le=60)] = 2.0
    reopen_max: Annotated[int, Field(ge=0, le=100)] = 3


class JogTable(Table):
    """Creeping to a stopping point that the train has stopped short of."""

    attempts: Annotated[int, Field(ge=0, le=10)] = 2
    reach_m: Annotated[float, Field(ge=0, le=50)] = 5.0
    speed_kmh: Annotated[float, Field(gt=0, le=5)] = 3.0


class RouteTable(Table):
    """Stops, timetable and rules of the run.

    The stops are given here (``stops``), or they are those of the line's file between two of them (``from_stop``,
    ``to_stop``), with their times in arrays.
    """

    stops: list[RouteStopTable] = []
    from_stop: Text | int | None = None
    to_stop: Text | int | None = None
    first_departure_s: Time = 30.0
    running_time_s: list[Duration] = []
    running_time_reserve_percent: NotNegative | None = None
    dwell_s: Durations = 30.0
    platform: Sides | None = None
    psd: Flags = False
    mode: Modes = "timetable"
    target_files: list[Text] = []
    stop_error_max_m: Positive = 0.3
    door_window_m: Positive = 0.5
    arrival_error_max_s: Positive = 5.0
    departure_late_max_s: Positive = 10.0
    overtime_max_s: Annotated[float, Field(gt=0, le=3600)] = 300.0
    regulation: Regulation = "retime"
    profiles_percent: Annotated[tuple[NotNegative, NotNegative, NotNegative], Field(strict=False)] = (0.0, 5.0, 12.0)
    dwell_min_s: NotNegative = 20.0
    dwell_disturbance_s: Pair = (0.0, 0.0)
    hold: HoldTable = HoldTable()
    doors: DoorsTable = DoorsTable()
    jog: JogTable = JogTable()
    generate: schema.GenerateTable = schema.GenerateTable()
    leg: Annotated[list[LegTable], Field(max_length=LEGS_MAX - 1)] = []
    signal: list[SignalTable] = []


class PerturbationsTable(schema.PerturbationsTable):
    """Additional distributions: mass in each section, wheel of the train protection's own axle."""

    section_mass_factor: Pair | None = None
    atp_wheel_factor: Pair | None = None


class LineScenarioFile(Table):
    """A scenario file of ``line`` after its references have been read."""

    schema_version: Literal[1]
    system: Literal["line"]
    name: Name
    title: Text
    section: Annotated[int, Field(ge=1, le=STOPS_MAX)] | None = None
    assumptions: list[Text] = []
    train: AnyTrain
    line: LineTable
    route: RouteTable
    atp: AtpTable = AtpTable()
    timing: TimingTable = TimingTable()
    sensors: schema.SensorsTable = schema.SensorsTable()
    energy: schema.EnergyTable = schema.EnergyTable()
    watch: schema.WatchTable = schema.WatchTable()
    safety: schema.SafetyTable = schema.SafetyTable()
    perturbations: PerturbationsTable = PerturbationsTable()
    published: list[schema.PublishedTable] = []
    fault: FaultRows = []
    requirement: RequirementRows
    define: DefineTable
    hunt: HuntTable = HuntTable()
