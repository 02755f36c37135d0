"""A campaign as a study: bounds of its requests, the work of a chunk, and the record for the engine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from typing import Annotated, Any

import pyarrow as pa
from pydantic import Field

from railhil.campaign.plan import ALL_LAWS, CHUNK_MAX, RUNS_MAX, Chunk, Plan, Request, make_plan
from railhil.campaign.rows import check_rows, schema, table_of
from railhil.campaign.summary import summary
from railhil.common.command_line import INDEXINGS, SEED_MAX
from railhil.controller_node.arithmetic import names as arithmetics
from railhil.judge.judging import judging_of
from railhil.scenarios import system as systems
from railhil.study.manifest import Bounds, machine_and_list, one_of
from railhil.study.perturbed_runs import run_seeds
from railhil.study.plan import Study, batch_sha256, bench_sha256, law_sha256

_LIBRARIES = ("numpy", "numba", "pyarrow", "scipy")


def _known_laws() -> list[str]:
    """Laws of all installed systems; whether one fits the scenario is seen when the plan is made."""
    return [*dict.fromkeys(law for name in systems.names() for law in systems.system_named(name).law_names()), ALL_LAWS]


class _Bounds(Bounds):
    """:class:`~railhil.campaign.plan.Request` as JSON."""

    scenario: str = Field(min_length=1)
    settings: list[str] = Field(default=[])
    runs: int = Field(ge=1, le=RUNS_MAX)
    first_seed: int = Field(ge=0, le=SEED_MAX)
    laws: list[Annotated[str, one_of(_known_laws)]]
    both: bool
    arithmetic: Annotated[str, one_of(arithmetics)]
    indexing: Annotated[str, one_of(lambda: INDEXINGS)]
    parameters: list[str]
    chunk: int = Field(ge=1, le=CHUNK_MAX)
    allow_training_seeds: bool


@dataclass(frozen=True, slots=True)
class ChunkWork:
    """The runs of a chunk; ``training``: seeds on which the parameters were tuned or chosen."""

    chunk: Chunk
    scenario: Any
    training: tuple[int, ...]

    def code(self) -> tuple[str, ...]:
        return bench_sha256(), batch_sha256(), law_sha256(self.chunk.entry.law.controller, self.scenario.system)

    def rows(self) -> pa.Table:
        entry = self.chunk.entry
        result = run_seeds(self.scenario, entry.law, list(self.chunk.seeds))
        return table_of(entry.label, result, self.training, judging_of(self.scenario))


def _work(plan: Plan, chunk: Chunk) -> ChunkWork:
    training = set(plan.training(chunk.entry))
    return ChunkWork(chunk, plan.scenario, tuple(seed for seed in chunk.seeds if seed in training))


def _explained(plan: Plan) -> Mapping[str, Any]:
    sets = {entry.label: entry.parameters for entry in plan.entries}
    return {
        "parameters": {label: dict(one.values) for label, one in sets.items() if one is not None},
        **machine_and_list(),
        "libraries": {name: version(name) for name in _LIBRARIES},
    }


CAMPAIGN: Study[Plan, Chunk] = Study(
    command="railhil campaign",
    kind="campaign",
    manifest="campaign.json",
    folder="campaign",
    request=Request,
    bounds=_Bounds,
    make_plan=make_plan,
    columns=lambda plan: schema(plan.judging),
    check_rows=check_rows,
    work=_work,
    summary=summary,
    explained=_explained,
)
