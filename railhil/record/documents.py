"""Reads ``certificate.json``, ``score.json``, ``compare.json`` and ``faults.json``; they are checked only here."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

from railhil.common.errors import InputError
from railhil.common.user_files import given_json
from railhil.record.target import Target
from railhil.scenarios.validation import validate

#: Names in a run folder.
CERTIFICATE, SCORE = "certificate.json", "score.json"
#: Name in the folder of a comparison.
COMPARISON = "compare.json"
#: Name in the folder of ``railhil faults --out``.
FAULT_TABLE = "faults.json"
#: Names in the folder of a study: the folder of its parts, and its results.
PARTS, SUMMARY = "parts", "summary.json"
_WRITTEN = "what railhil run has written"


class _Part(BaseModel):
    """Part of a document; keys that are not read here may hold anything."""

    model_config = ConfigDict(defer_build=True, extra="ignore", strict=True, allow_inf_nan=False)


class _Training(_Part):
    scenario: str
    seeds: list[int]


class _Parameters(_Part):
    sha256: str
    values: dict[str, Any]
    training: _Training | None = None


class _StoredRecord(_Part):
    key: str
    runs: int


class _Stored(_Part):
    slot: str
    record: _StoredRecord | None


class _Memory(_Part):
    law: str
    stored: list[_Stored]
    sha256: str


class _OwnParameters(_Part):
    origin: str


class _Note(_Part):
    signal: Literal["Note1", "Note2", "Note3"]
    name: str
    title: str
    symbol: str
    unit: str
    scale: float
    signed: bool
    bits: list[str]


class _Injected(_Part):
    number: int
    fault: str
    begun_s: float | None
    effect_s: float | None
    ended_s: float | None
    hits: int


class _PortCount(_Part):
    committed: int
    accepted: int = 0
    refused: dict[str, int] = {}


class _Missed(_Part):
    first: int
    count: int


class _Gap(_Part):
    restarted: bool
    ports: dict[str, _Missed]


class _Reception(_Part):
    ports: dict[str, _PortCount]
    frames: dict[str, int]
    gaps: list[_Gap]
    by_task: bool = False


class _Received(_Part):
    exact: bool
    nodes: dict[str, _Reception]


class _MadeBy(_Part):
    """:func:`railhil.judge.folder.made_by`, with its arguments."""

    system: str | None = None
    controller: str | None = None
    railhil: str | None = None
    code_sha256: str | None = None
    system_sha256: str | None = None
    law_sha256: str | None = None


class _FaultRow(_Part):
    entry: str
    begun_s: float | None
    effective_s: float | None
    detected_by: str
    detected_s: float | None
    reaction: str
    reaction_s: float | None
    verdict: str
    failures: list[str]
    refused: str
    shown_s: dict[str, float | None] = {}
    safe_s: float | None = None
    requirements: dict[str, str] = {}


class _FaultPair(_Part):
    number: int
    faults: list[str] = Field(min_length=2, max_length=2)
    verdict: str
    failures: list[str]


class Recorded(_Part):
    """When, on which host and by whom a document was recorded (:func:`railhil.record.run_folder.recorded_by`)."""

    utc: str
    host: str
    operator: str


class _FaultTable(_MadeBy):
    scenario: str = ""
    seed: int | None = None
    recorded: Recorded | None = None
    entries: list[str] = []
    pairs: list[_FaultPair] = []
    sentences: dict[str, str] = {}
    rows: list[_FaultRow]


class _Certificate(_MadeBy):
    scenario: str | None = None
    scenario_sha256: str | None = None
    judged_sha256: str | None = None
    settings: list[str] = []
    faults: list[str] = []
    asked: dict[str, str] | None = None
    parameters: _Parameters | None = None
    own_parameters: _OwnParameters | None = None
    memory: _Memory | None = None
    memory_used: str | None = None
    memory_refused: dict[str, list[str]] = {}
    memory_after_sha256: str | None = None
    notes: list[_Note] | None = None
    seed_was_trained: bool | None = None
    arithmetic: str | None = None
    arithmetic_profile: str | None = None
    indexing: str | None = None
    task_period_ms: int | None = None
    seed: int | None = None
    perturbed: bool | None = None
    run_number: int | None = None
    pace: str | None = None
    rate: float | None = None
    patience_s: float | None = None
    bus: str | None = None
    attached: bool | None = None
    foreign: bool | None = None
    not_witnessed: list[str] = []
    injected: list[_Injected] = []
    received: _Received | None = None
    transport: str | None = None
    frames: int | None = None
    frames_sha256: str | None = None
    telegrams_sha256: str | None = None
    other_frames: int | None = None
    verdict: str | None = None
    line: str | None = None
    command: str | None = None
    command_needs: str | None = None
    dbc_sha256: str | None = None
    hash_list: str | None = None
    recorded: Recorded | None = None
    target: Target | None = None


class _Headroom(_Part):
    name: str
    bits: int


class _Summary(_Part):
    wraps: int
    saturations: int
    zero_divisions: int
    least_headroom: _Headroom | None
    cycles: int
    cycles_flash: int
    cycle_share: float
    lost_messages: int


class _Shown(_Part):
    source: str
    happened: list[str]
    least_headroom: _Headroom | None
    cycles: int
    quantities: list[dict[str, Any]]


class _Jitter(_Part):
    cycles: int
    p50_ms: float
    p99_ms: float
    p999_ms: float
    max_ms: float


class _Lateness(_Jitter):
    late_share: float


class _Histogram(_Part):
    edges_ms: list[float]
    counts: list[int]

    @model_validator(mode="after")
    def _bins(self) -> _Histogram:
        rising = all(low < high for low, high in itertools.pairwise([0.0, *self.edges_ms]))
        if not self.counts or len(self.edges_ms) != len(self.counts) + 1 or not rising or min(self.counts) < 0:
            raise ValueError("rising edges above 0, a count between each two")
        return self


class _Answers(_Part):
    port: str
    p50_ms: float
    p99_ms: float
    max_ms: float


class _Timing(_Part):
    source: str
    polls: int
    missed_polls: int


class _RealtimeTiming(_Timing):
    lateness: _Lateness
    histogram: _Histogram
    answers: list[_Answers]
    scheduling: dict[str, str]
    pace: str | None = None


def _timing_tag(document: Any) -> str:
    return "lockstep" if isinstance(document, dict) and document.get("source") == "none" else "realtime"


class _Run(_Part):
    sim_time_s: float
    wall_time_s: float
    timing: (
        Annotated[
            Annotated[_Timing, Tag("lockstep")] | Annotated[_RealtimeTiming, Tag("realtime")],
            Discriminator(_timing_tag),
        ]
        | None
    ) = None


def _telemetry_tag(document: Any) -> str:
    return "shown" if isinstance(document, dict) and "source" in document else "summary"


_Telemetry = Annotated[
    Annotated[_Shown, Tag("shown")] | Annotated[_Summary, Tag("summary")], Discriminator(_telemetry_tag)
]


class _Outcome(_Part):
    id: str
    says: str
    verdict: str


class _Score(_Part):
    telemetry: _Telemetry | None
    run: _Run
    requirements: list[_Outcome] = Field(default_factory=list)
    jitter: _Jitter | None = None


class _ComparedRun(_Part):
    folder: str


class _Comparison(_Part):
    runs: list[_ComparedRun] = Field(min_length=1)
    notes: list[str] = Field(default_factory=list)
    recorded: Recorded | None = None
    hash_list: str | None = None


def _read(path: Path, model: type[_Part], allowed: str) -> dict[str, Any] | None:
    try:
        document = given_json(path, allowed)
    except InputError as error:
        if isinstance(error.__cause__, FileNotFoundError):
            return None
        raise
    validate(model, document, lambda keys: path, ("shown", "summary", "lockstep", "realtime"))
    return document


def read_certificate(folder: Path, allowed: str = _WRITTEN) -> dict[str, Any] | None:
    """``certificate.json`` of a run folder, or the certificate itself; None if there is none.

    :raises InputError: it cannot be read, or one of its keys has a value that no certificate has.
    """
    return _read(folder if folder.is_file() else folder / CERTIFICATE, _Certificate, allowed)


def read_score(folder: Path) -> dict[str, Any] | None:
    """``score.json`` of a run folder; None if there is none.

    :raises InputError: as :func:`read_certificate`.
    """
    return _read(folder / SCORE, _Score, _WRITTEN)


def read_comparison(folder: Path) -> dict[str, Any] | None:
    """``compare.json`` in the folder of a comparison; None if there is none.

    :raises InputError: as :func:`read_certificate`.
    """
    return _read(folder / COMPARISON, _Comparison, "what railhil compare has written")


def read_fault_table(folder: Path) -> dict[str, Any] | None:
    """``faults.json`` in a folder; None if there is none.

    :raises InputError: as :func:`read_certificate`.
    """
    return _read(folder / FAULT_TABLE, _FaultTable, "what railhil faults has written")


def fault_entries_missing(document: Mapping[str, Any]) -> list[str]:
    """Entries of a fault table that its command was stopped before."""
    done = {row["entry"] for row in document["rows"]}
    return [key for key in document.get("entries", ()) if key not in done]


def fault_table_verdict(document: Mapping[str, Any]) -> str:
    """PASS, FAIL if a reaction is not as it must be or a pair breaks a rule, or INVALID if nothing was run or the
    command was stopped."""
    pairs = document.get("pairs", ())
    if any(one["failures"] for one in (*document["rows"], *pairs)):
        return "FAIL"
    made = any(row["verdict"] for row in document["rows"])
    return "PASS" if (made and not fault_entries_missing(document)) or pairs else "INVALID"
