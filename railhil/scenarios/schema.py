"""Schema of the parts of a scenario file (TOML) that all systems share, checked with pydantic.

Keys carry their unit (``mass_t``, ``distance_m``, ``speed_limit_kmh``); unknown keys are refused. Ranges
and types of keys stand here; :mod:`railhil.scenarios.load` reads the files.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Strict, Tag

from railhil.scenarios.model import Timing

#: Far beyond any railway, yet small enough that no sum or square of it overflows.
_LARGEST = 1e7
#: The least positive value.
SMALLEST = 1e-9

#: Longest run that a scenario may ask for.
RUNNING_TIME_MAX_S = 28_800.0


Number = Annotated[float, Field(ge=-_LARGEST, le=_LARGEST)]
#: A row ``[x, y]`` of a table; TOML writes it as an array of two numbers.
Pair = Annotated[tuple[Number, Number], Strict(False)]
Pairs = Annotated[list[Pair], Field(min_length=1, max_length=100_000)]
Positive = Annotated[float, Field(ge=SMALLEST, le=_LARGEST)]
NotNegative = Annotated[float, Field(ge=0, le=_LARGEST)]
Text = Annotated[str, Field(min_length=1, max_length=200)]
Name = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_\-]*$", max_length=80)]


class Table(BaseModel):
    """Base of the tables of a file: no unknown keys, strict types."""

    #: Key that is used only beside another one -> the other key.
    BESIDE: ClassVar[Mapping[str, str]] = {}

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False, defer_build=True)


def nanoseconds(period_ms: float) -> int:
    """Whole nanoseconds of a period in ms (a 3.2 ms tick is exactly 3 200 000 ns)."""
    return round(period_ms * 1e6)


class TimingTable(Table):
    """Ticks and periods; every period is a whole multiple of the base tick."""

    base_tick_ms: Positive = 10.0
    control_period_ms: Positive = 500.0
    loop_delay_s: NotNegative = 0.04
    port_period_ms: dict[Text, Positive] = {}

    def in_ns(self) -> Timing:
        """The same in ns."""
        return Timing(
            base_tick_ns=nanoseconds(self.base_tick_ms),
            control_period_ns=nanoseconds(self.control_period_ms),
            loop_delay_s=self.loop_delay_s,
            port_period_ns={port: nanoseconds(period) for port, period in sorted(self.port_period_ms.items())},
        )


class WhenTable(Table):
    """When a fault begins: exactly one condition."""

    time: Text | NotNegative | None = None
    position: Text | Number | None = None
    speed: Text | NotNegative | None = None
    event: Text | None = None
    telegram: Annotated[int, Field(ge=1)] | None = None
    manual: Literal[True] | None = None
    edge: Literal["rising", "falling"] | None = None
    delay: Text | NotNegative | None = None


class ExpectTable(Table):
    """The expected reaction to a fault."""

    level: Text | None = None
    within: Text | NotNegative | None = None
    detected_by: Text | None = None
    verdict: Text | None = None


class FaultTable(Table):
    """One fault (:mod:`railhil.faults.tables`); times and other values are texts with a unit, or numbers in base
    units."""

    where: Text
    what: Text
    when: Text | NotNegative | WhenTable
    duration: Annotated[Text | NotNegative | None, Field(alias="for")] = None
    count: Annotated[int, Field(ge=1)] | None = None
    until: Text | None = None
    values: Annotated[dict[Text, Text | Number] | None, Field(alias="with")] = None
    after: Text | None = None
    expect: ExpectTable | None = None
    unit: Annotated[int, Field(ge=1, le=255)] | None = None
    units: list[Annotated[int, Field(ge=1, le=255)]] = []
    seed: Annotated[int, Field(ge=0, le=0xFFFF_FFFF)] | None = None
    combine: bool = False
    id: Text | None = None


def _fault_kind(row: Any) -> str:
    return "FaultText" if isinstance(row, str) else "FaultTable"


#: Either form of a fault; the tags never appear in messages.
FAULT_TAGS = ("FaultTable", "FaultText")
FaultRows = list[
    Annotated[
        Annotated[FaultTable, Tag("FaultTable")]
        | Annotated[str, Field(min_length=1, max_length=500), Tag("FaultText")],
        Discriminator(_fault_kind),
    ]
]


class RequiredRunsTable(Table):
    """``when`` of a requirement: the runs that it is about."""

    faults: Literal["any", "none"] = "any"


class RequirementTable(Table):
    """One ``[[requirement]]`` of a scenario file or of a file of requirements
    (:mod:`railhil.judge.requirements.requirement`)."""

    id: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_.\-]*$", max_length=40)]
    says: Annotated[str, Field(min_length=1)]
    title: Annotated[str, Field(max_length=200)] = ""
    note: Annotated[str, Field(max_length=1000)] = ""
    source: Annotated[str, Field(max_length=500)] = ""
    when: RequiredRunsTable = RequiredRunsTable()


RequirementRows = Annotated[list[RequirementTable], Field(default_factory=list)]
#: ``[define]``: names that sentences may use, with their texts.
DefineTable = Annotated[
    dict[Annotated[str, Field(pattern=r"^[a-z_][a-z0-9_]*$", max_length=80)], str], Field(default_factory=dict)
]


class HuntTable(Table):
    """Bounds of the cases of ``railhil hunt``, which change nothing of a run."""

    faults_max: Annotated[int, Field(ge=1, le=20)] = 5
    longest_s: Positive | None = None
    left_out: list[Text] = []
    largest: list[Text] = []
