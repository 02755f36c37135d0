"""``railhil learn`` as a study: bounds of its requests, the work of a chunk, and the record for the engine."""

from __future__ import annotations

from dataclasses import dataclass

import pyarrow as pa
from pydantic import Field

from railhil.common.command_line import SEED_MAX
from railhil.judge.judging import judging_of
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.sequences.one import sequences
from railhil.sequences.plan import (
    CHUNK_MAX,
    RUNS_MAX,
    SEQUENCES_MAX,
    Chunk,
    Plan,
    Request,
    learning_sha256,
    make_plan,
    run_specs,
)
from railhil.sequences.summary import summary
from railhil.sequences.table import check_rows, row, schema
from railhil.study.manifest import Bounds, machine_and_list
from railhil.study.plan import Study, bench_sha256, law_sha256


class _Bounds(Bounds):
    """:class:`~railhil.sequences.plan.Request` as JSON."""

    scenario: str = Field(min_length=1)
    settings: list[str]
    faults: list[str]
    controller: str
    arithmetic: str
    indexing: str
    parameters: str | None
    nominal: bool
    runs: int = Field(ge=1, le=RUNS_MAX)
    sequences: int = Field(ge=1, le=SEQUENCES_MAX)
    seed: int = Field(ge=0, le=SEED_MAX)
    chunk: int = Field(ge=1, le=CHUNK_MAX)


@dataclass(frozen=True, slots=True)
class ChunkWork:
    """The sequences of a chunk; ``base``: any of their runs."""

    chunk: Chunk
    scenario: AnyScenario
    base: RunSpec

    def code(self) -> tuple[str, ...]:
        return bench_sha256(), learning_sha256(), law_sha256(self.base.law.controller, self.scenario.system)

    def rows(self) -> pa.Table:
        scenario, chunk = self.scenario, self.chunk
        judging = judging_of(scenario)
        wanted = [run_specs(self.base, scenario, seed, chunk.runs_each) for seed in chunk.sequences]
        rows = {
            (place, number): row(chunk.sequences[place], number, run, judging)
            for place, number, run in sequences(scenario, wanted)
        }
        return pa.concat_tables([rows[key] for key in sorted(rows)])


LEARN: Study[Plan, Chunk] = Study(
    command="railhil learn",
    kind="study",
    manifest="learn.json",
    folder="learn",
    request=Request,
    bounds=_Bounds,
    make_plan=make_plan,
    columns=lambda plan: schema(plan.judging),
    check_rows=check_rows,
    work=lambda plan, chunk: ChunkWork(chunk, plan.scenario, plan.base),
    summary=summary,
    explained=lambda plan: machine_and_list(),
)
