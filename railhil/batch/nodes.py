"""Runs of many seeds of a system: by its batch, or else one by one through the nodes of the bench, in this process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from railhil.batch.case import Batch, Case
from railhil.plant_sim.faults.plants import needs_nodes
from railhil.run.local import unrecorded_run
from railhil.scenarios.model import AnyScenario

#: Number of hexadecimal digits of the frame log's hash that are used instead of a digest of the commands.
DIGITS = 16


def batch_of(scenario: AnyScenario) -> Callable[..., Any] | None:
    """The batch of a scenario's system; None when it has none, or when a fault of
    the scenario needs the nodes."""
    if needs_nodes(scenario):
        return None
    batch: Callable[..., Any] | None = scenario.installed_system.optional_part("batch")
    return batch


def one_by_one(scenario: AnyScenario) -> str:
    """Sentence on why the batch of a scenario makes each run by itself; empty: it makes many at once, or there is no
    batch."""
    system = scenario.installed_system
    if batch_of(scenario) is None or system.one_by_one is None:
        return ""
    why = system.part("one_by_one")(scenario)
    return f"the batch of system {system.name} makes the runs one by one: {why}" if why else ""


def kernel_of(scenario: AnyScenario) -> str | None:
    """Module with the compiled loops of a scenario's batch; None: there is no batch, or it compiles nothing."""
    if batch_of(scenario) is None or one_by_one(scenario):
        return None
    return scenario.installed_system.kernel


def run_nodes(case: Case, seeds: Sequence[int]) -> Batch:
    """Run a case with each seed; the digest of a run is the beginning of the SHA-256 of its frame log.

    :raises InputError: law, arithmetic, indexing or parameters do not fit.
    """
    runs = [unrecorded_run(case.scenario, case.run(int(seed))) for seed in seeds]
    return Batch.of_results(case.scenario, seeds, runs, [run.frames_sha256[:DIGITS] for run in runs])
