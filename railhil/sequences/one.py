"""Sequences of runs in one process; each run begins with the memory that the last one has
left."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from railhil.batch.case import SequenceRun
from railhil.batch.coupled import digest_of_run, direct_sequence_run
from railhil.plant_sim.faults.plants import needs_nodes
from railhil.run.local import unrecorded_run
from railhil.scenarios.memory import Memory, no_memory
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: Makes one run.
Runner = Callable[[AnyScenario, RunSpec], SequenceRun]


def sequence_batch_of(scenario: AnyScenario) -> Callable[..., Any] | None:
    """The part ``sequence_batch`` of a scenario's system; None: it has none, or a fault needs the nodes."""
    if needs_nodes(scenario):
        return None
    batch: Callable[..., Any] | None = scenario.installed_system.optional_part("sequence_batch")
    return batch


def sequences(
    scenario: AnyScenario, wanted: Sequence[list[RunSpec]], begun: Sequence[Memory] | None = None
) -> Iterator[tuple[int, int, SequenceRun]]:
    """The runs of several sequences in any order: place of the sequence, number of the run from 1, the run.

    :param wanted: runs of each sequence, equally many.
    :param begun: memory for the first of the runs of each sequence; None: none.
    :raises InputError: as :func:`sequence`.
    """
    batch = sequence_batch_of(scenario)
    memories = list(begun or [no_memory(specs[0].law.controller, Path("memory")) for specs in wanted])
    if batch is None:
        runner = runner_of(scenario)
        for place, specs in enumerate(wanted):
            for number, run in enumerate(sequence(scenario, specs, runner, memories[place]), 1):
                yield place, number, run
        return
    for number in range(len(wanted[0])):
        specs = [
            replace(sequence[number], law=replace(sequence[number].law, memory=memory))
            for sequence, memory in zip(wanted, memories, strict=True)
        ]
        for place, run in enumerate(batch(scenario, specs)):
            memories[place] = run.left
            yield place, number + 1, run


def runner_of(scenario: AnyScenario) -> Runner:
    """The fastest way to make a run: without a bus if the system can, else through the nodes."""
    system = scenario.installed_system
    comparable = system.digest is not None or system.interface is not None
    is_direct = system.direct is not None and comparable and not needs_nodes(scenario)
    return direct_sequence_run if is_direct else through_nodes


def sequence(
    scenario: AnyScenario, specs: list[RunSpec], runner: Runner, memory: Memory | None = None
) -> Iterator[SequenceRun]:
    """The runs of a sequence, each with the memory that the last one has left.

    :param specs: of the runs, in order.
    :param memory: for the first one; None: none.
    :raises InputError: the law keeps no memory, or cannot be made.
    """
    law = specs[0].law.controller
    memory = memory or no_memory(law, Path("memory"))
    for spec in specs:
        run = runner(scenario, replace(spec, law=replace(spec.law, memory=memory)))
        memory = run.left
        yield run


def through_nodes(scenario: AnyScenario, spec: RunSpec) -> SequenceRun:
    """One run through the nodes of the bench, in this process."""
    run = unrecorded_run(scenario, spec)
    return SequenceRun.of(run, digest_of_run(run), run.telemetry.get("memory"))
