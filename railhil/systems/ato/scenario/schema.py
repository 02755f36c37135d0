"""Schema of scenario, line, train and target files of ``ato`` (TOML), checked with pydantic.

Keys carry their unit (``mass_t``, ``distance_m``, ``speed_limit_kmh``); unknown keys are refused. This module only
defines the contents of a file: :mod:`.train_files` resolves references and turns it into :mod:`.model`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Strict, Tag

from railhil.scenarios.schema import (
    RUNNING_TIME_MAX_S,
    DefineTable,
    FaultRows,
    HuntTable,
    Name,
    NotNegative,
    Number,
    Pair,
    Pairs,
    Positive,
    RequirementRows,
    Table,
    Text,
    TimingTable,
)
from railhil.systems.ato.scenario.model import DISTANCE_MAX_M

#: Notches, on the grid of the command (1/256 notch), so that law, watch and train agree on the largest value.
NotchRange = Annotated[float, Field(gt=0, le=127, multiple_of=1 / 256)]


class DavisTable(Table):
    """Running resistance ``a + b V + c V^2`` in N per kN of weight, V in km/h (Davis)."""

    a_n_per_kn: NotNegative
    b_n_per_kn_kmh: NotNegative
    c_n_per_kn_kmh2: NotNegative


class EffortTable(Table):
    """Largest force over speed: the minimum of a constant, a power limit and a curve ``[[km/h, kN], ...]``."""

    force_max_kn: Positive
    power_max_kw: Positive | None = None
    curve_kmh_kn: Pairs | None = None


class TrainTable(Table):
    """A train given by its own data.

    Exactly one of each pair: ``rotating_mass_factor`` or ``inertial_mass_t``, ``force_per_notch_n`` or
    ``accel_per_notch_mps2`` (of the inertial mass).
    """

    name: Text
    mass_t: Positive
    rotating_mass_factor: NotNegative | None = None
    inertial_mass_t: Positive | None = None
    length_m: Positive
    davis: DavisTable
    traction: EffortTable
    brake: EffortTable
    actuator_pole_per_s: Positive
    force_per_notch_n: Positive | None = None
    accel_per_notch_mps2: Positive | None = None
    notch_max: NotchRange = 7.0
    speed_limit_kmh: Positive = 3600.0
    service_braking_mps2: Positive = 1.0
    gravity_mps2: Annotated[float, Field(gt=9.0, lt=10.0)] = 9.81
    electric_brake: EffortTable | None = None
    assumptions: list[Text] = []


class ImportedTrainTable(Table):
    """A train from a railtoolkit rolling-stock 2022.05 file, plus the data that the format does not contain."""

    railtoolkit: Text
    train_id: Text | None = None
    actuator_pole_per_s: Positive
    accel_per_notch_mps2: Positive
    notch_max: NotchRange = 7.0
    assumptions: list[Text] = []


def train_kind(table: Any) -> str:
    """Tag of a table of a train, before it is checked."""
    return "imported" if isinstance(table, dict) and "railtoolkit" in table else "own"


#: Either kind of train; the tags never appear in messages.
TRAIN_TAGS = ("own", "imported")


AnyTrain = Annotated[
    Annotated[TrainTable, Tag("own")] | Annotated[ImportedTrainTable, Tag("imported")],
    Discriminator(train_kind),
]


class BaliseTable(Table):
    """One balise; ``true_m`` defaults to the surveyed position."""

    # 0 on the wire means that no balise has been passed.
    number: Annotated[int, Field(ge=1, le=255)]
    surveyed_m: Annotated[float, Field(ge=-2_000_000, le=2_000_000)]
    true_m: Number | None = None


class StopTable(Table):
    """A stopping point of a line, for :class:`LineTable` sections."""

    name: Text
    position_m: Number


class TrackTable(Table):
    """A line: either its profiles, or a reference to an importable file."""

    BESIDE: ClassVar[Mapping[str, str]] = {
        "path_id": "railtoolkit",
        "track_ids": "railml",
        "track_direction": "railml",
        "default_limit_kmh": "railml",
    }
    name: Text | None = None
    grade_permil: Pairs | None = None
    speed_limit_kmh: Pairs | None = None
    balises: list[BaliseTable] = []
    stops: list[StopTable] = []
    railtoolkit: Text | None = None
    path_id: Text | None = None
    ttobench: Text | None = None
    railml: Text | None = None
    track_ids: Annotated[list[Text], Field(min_length=1)] | None = None
    track_direction: Literal["normal", "reverse"] = "normal"
    default_limit_kmh: Positive | None = None


#: Distances before a stop at which there are balises, in running order.
BalisesBeforeStop = Annotated[list[NotNegative], Field(max_length=9)]


class LineTable(TrackTable):
    """A line, optionally cut between two stops."""

    from_stop: Text | int | None = None
    to_stop: Text | int | None = None
    balises_before_stop_m: BalisesBeforeStop = []
    assumptions: list[Text] = []


class GenerateTable(Table):
    """Limits of a generated target speed curve (see :mod:`railhil.systems.ato.scenario.generate`)."""

    accel_max_mps2: Positive = 0.8
    braking_max_mps2: Positive = 0.7
    jerk_max_mps3: Positive = 0.6
    end_braking_mps2: Positive = 0.35
    traction_utilisation: Annotated[float, Field(gt=0, le=1)] = 0.8
    brake_utilisation: Annotated[float, Field(gt=0, le=1)] = 0.8
    speed_margin_kmh: NotNegative = 2.0
    hold_min_s: NotNegative = 10.0
    coast: bool = False


class TargetTable(Table):
    """Target speed curve: nodes ``[[t s, a m/s2], ...]``, limits to generate them from, or both."""

    nodes_s_mps2: Pairs | None = None
    generate: GenerateTable | None = None


class PlanTable(Table):
    """The requirements on the run; exactly one of ``running_time_s`` and ``running_time_reserve_percent``."""

    # 400 km and 8 h; the wire format can represent 536 km (TRK_INFO, target) and 14 h (planned arrival).
    distance_m: Annotated[float, Field(gt=0, le=DISTANCE_MAX_M)]
    running_time_s: Annotated[float, Field(gt=0, le=RUNNING_TIME_MAX_S)] | None = None
    running_time_reserve_percent: NotNegative | None = None
    stop_error_max_m: Positive
    time_error_max_s: Positive
    overtime_max_s: Annotated[float, Field(gt=0, le=600)] = 10.0


class SensorsTable(Table):
    """Axle speed sensor and odometer."""

    speed_lsb_kmh: Positive = 0.01
    speed_noise_sigma_kmh: NotNegative = 0.0
    odometer_lsb_m: Positive = 0.01
    wheel_factor: Annotated[float, Field(gt=0.5, lt=2.0)] = 1.0


class EnergyTable(Table):
    """Coefficients of eq. (5) of the IPFC paper, which does not print them, and of the regenerated work: the defaults
    are chosen."""

    xi_m: Annotated[float, Field(gt=0, le=1)] = 0.88
    xi_b: Number = 0.0
    auxiliary_power_kw: NotNegative = 40.0
    regenerative_efficiency: Annotated[float, Field(ge=0, le=1)] = 0.7


class WatchTable(Table):
    """Reaction ladder: ages in ms (increasing), the overspeed margin, and limits of the other checks."""

    BESIDE: ClassVar[Mapping[str, str]] = {
        "end_of_authority_margin_m": "end_of_authority",
        "end_of_authority_braking_mps2": "end_of_authority",
    }
    hold_ms: Annotated[int, Field(gt=0)] = 20
    traction_cut_ms: Annotated[int, Field(gt=0)] = 64
    service_brake_ms: Annotated[int, Field(gt=0)] = 256
    emergency_ms: Annotated[int, Field(gt=0)] = 1000
    overspeed_margin_kmh: Positive = 5.0
    speed_change_max_mps2: Positive = 2.0
    stuck_change_kmh: Positive = 0.36
    scale_error_max_percent: Annotated[float, Field(gt=0, le=100)] = 3.0
    channel_bad_max: Annotated[int, Field(ge=1, le=10_000)] = 30
    brake_share_min_percent: Annotated[float, Field(ge=0, le=100)] = 50.0
    runaway_kmh: Positive = 1.08
    overruns_max: Annotated[int, Field(ge=0, le=1_000_000)] = 3
    # Twice the largest notch range: no limit.
    notch_step_max: Annotated[float, Field(gt=0, le=254)] = 254.0
    two_sources_max: Annotated[int, Field(ge=1, le=16)] = 6
    traction_left_max_percent: Annotated[float, Field(gt=0, le=1000)] = 5.0
    grade_allowance_permil: Annotated[float, Field(ge=0, le=1000)] = 35.0
    end_of_authority: bool = False
    end_of_authority_margin_m: NotNegative = 5.0
    end_of_authority_braking_mps2: Positive = 0.8


class SafetyTable(Table):
    """Safe data transmission (SDTv2) of speed and command, in addition to their telegrams."""

    BESIDE: ClassVar[Mapping[str, str]] = {"n_rxsafe": "sdt", "cmthr": "sdt"}
    sdt: bool = False
    n_rxsafe: Annotated[int, Field(ge=2, le=20)] = 3
    cmthr: Annotated[int, Field(ge=1, le=100_000)] = 1000


class PerturbationsTable(Table):
    """Uniform distributions ``[low, high]`` from which a perturbed run draws; a missing key stays nominal."""

    mass_factor: Pair | None = None
    davis_factor: Pair | None = None
    grade_offset_permil: Pair | None = None
    grade_factor: Pair | None = None
    actuator_pole_factor: Pair | None = None
    force_gain_factor: Pair | None = None
    speed_noise_sigma_kmh: Pair | None = None
    loop_delay_s: Pair | None = None
    wheel_factor: Pair | None = None
    balise_position_error_m: Pair | None = None


#: A row ``[seed, coefficient]``.
Sequence = Annotated[tuple[Annotated[int, Field(ge=0, le=0xFFFF_FFFF)], Number], Strict(False)]


#: A row ``[instant, seed]``.
NoiseChange = Annotated[tuple[NotNegative, Annotated[int, Field(ge=0, le=0xFFFF_FFFF)]], Strict(False)]


class PublishedTable(Table):
    """One row of a published result table."""

    controller: Text
    itae: Number
    energy_kj: Number
    punctuality_s: Number
    stop_error_m: Number
    comfort: Number


class ScenarioFile(Table):
    """A scenario file after its references have been read."""

    schema_version: Literal[1]
    system: Literal["ato"] = "ato"
    name: Name
    title: Text
    assumptions: list[Text] = []
    train: AnyTrain
    line: LineTable
    target: TargetTable
    plan: PlanTable
    timing: TimingTable = TimingTable()
    sensors: SensorsTable = SensorsTable()
    energy: EnergyTable = EnergyTable()
    watch: WatchTable = WatchTable()
    safety: SafetyTable = SafetyTable()
    perturbations: PerturbationsTable = PerturbationsTable()
    draws: list[Number] = []
    noise: Annotated[list[Sequence], Field(max_length=1000)] = []
    noise_from: NoiseChange | None = None
    published: list[PublishedTable] = []
    fault: FaultRows = []
    requirement: RequirementRows
    define: DefineTable
    hunt: HuntTable = HuntTable()
