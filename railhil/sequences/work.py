"""Computes one chunk of sequences, from its task to the bytes of its part; run by every engine, on any machine."""

from __future__ import annotations

import platform
from dataclasses import dataclass

import pyarrow as pa

from railhil.campaign.plan import bench_sha256, law_sha256
from railhil.campaign.results_table import file_bytes
from railhil.campaign.work import OtherCode
from railhil.judge.judging import judging_of
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.sequences.one import sequences
from railhil.sequences.plan import Chunk, Plan, learning_sha256, run_specs
from railhil.sequences.table import row


@dataclass(frozen=True, slots=True)
class Task:
    """All that a worker needs; ``origin`` identifies the part, ``code`` the code that must make it."""

    chunk: Chunk
    scenario: AnyScenario
    base: RunSpec
    origin: str
    code: tuple[str, str, str]

    @property
    def name(self) -> str:
        """Name of its part."""
        return self.chunk.name


def origin_of(plan: Plan, chunk: Chunk) -> str:
    """The identification of a part: its request and sequences."""
    return f"{plan.sha256} {chunk.name}"


def _code(law: str, system: str) -> tuple[str, str, str]:
    return bench_sha256(), learning_sha256(), law_sha256(law, system)


def task_of(plan: Plan, chunk: Chunk) -> Task:
    """The task of a chunk."""
    code = _code(plan.law.controller, plan.scenario.system)
    return Task(chunk, plan.scenario, plan.base, origin_of(plan, chunk), code)


def run_task(task: Task) -> tuple[str, bytes]:
    """Run a chunk; returns its name and the bytes of its part.

    :raises OtherCode: this process runs different code from that which the task was made with.
    :raises InputError: the law has failed.
    """
    scenario, chunk = task.scenario, task.chunk
    if _code(task.base.law.controller, scenario.system) != task.code:
        raise OtherCode(f"worker on {platform.node()} has other code than this machine: install the same railhil there")
    judging = judging_of(scenario)
    wanted = [run_specs(task.base, scenario, seed, chunk.runs_each) for seed in chunk.sequences]
    rows = {
        (place, number): row(chunk.sequences[place], number, run, judging)
        for place, number, run in sequences(scenario, wanted)
    }
    return chunk.name, file_bytes(pa.concat_tables([rows[key] for key in sorted(rows)]), task.origin)
