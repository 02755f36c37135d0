"""Computes one chunk, from its task to the bytes of its part; run by every engine, in any process on any machine."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from typing import Any

from railhil.batch.nodes import batch_of, run_nodes
from railhil.campaign.plan import Chunk, Plan, batch_sha256, bench_sha256, law_sha256
from railhil.campaign.results_table import file_bytes, table_of
from railhil.common.exit_codes import INVALID
from railhil.judge.judging import judging_of


class OtherCode(Exception):
    """A worker's code differs from the campaign's: its figures could differ too."""

    exit_code = INVALID


@dataclass(frozen=True, slots=True)
class Task:
    """All that a worker needs; it is small and sent with every chunk. ``origin`` identifies the part."""

    chunk: Chunk
    scenario: Any
    training: tuple[int, ...]
    origin: str
    code_sha256: str
    batch_sha256: str

    @property
    def name(self) -> str:
        """Name of its part."""
        return self.chunk.name


def origin_of(plan: Plan, chunk: Chunk) -> str:
    """The identification of a part: its campaign and runs."""
    entry = chunk.entry
    parameters = "" if entry.parameters is None else entry.parameters.sha256
    return f"{plan.subject_sha256} {entry.law_sha256} {parameters} {chunk.name}"


def task_of(plan: Plan, chunk: Chunk) -> Task:
    """The task of a chunk."""
    training = set(plan.training(chunk.entry))
    return Task(
        chunk,
        plan.scenario,
        tuple(seed for seed in chunk.seeds if seed in training),
        origin_of(plan, chunk),
        bench_sha256(),
        batch_sha256(),
    )


def run_task(task: Task) -> tuple[str, bytes]:
    """Run a chunk; returns its name and the bytes of its part.

    :raises OtherCode: this process runs different code from that of the campaign.
    :raises scenarios.errors.InputError: a library of the extra is missing here.
    """
    entry = task.chunk.entry
    ours = (bench_sha256(), batch_sha256(), law_sha256(entry.law.controller, task.scenario.system))
    if ours != (task.code_sha256, task.batch_sha256, entry.law_sha256):
        raise OtherCode(
            f"worker on {platform.node()} has other code than this campaign: install the same railhil there"
        )
    from railhil.batch import Case

    case = Case(task.scenario, entry.law)
    run = batch_of(task.scenario) or run_nodes
    judging = judging_of(task.scenario)
    result = run(case, list(task.chunk.seeds))
    return task.chunk.name, file_bytes(table_of(entry.label, result, task.training, judging), task.origin)
