"""One run of a sequence, and a whole sequence in one process; each run begins with the memory that the last one has
left."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from railhil.batch.coupled import command_digest
from railhil.batch.nodes import DIGITS
from railhil.controller_node.arithmetic import make
from railhil.controller_node.law_controller import maker_of
from railhil.judge.result import Result
from railhil.judge.score import Score
from railhil.plant_sim.faults.plants import needs_nodes
from railhil.record.telemetry import Kept, kept_of
from railhil.record.trace import Trace
from railhil.run.local import unrecorded_run
from railhil.run.memory import record_after
from railhil.scenarios.memory import Memory, MemoryRecord, no_memory
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: Makes one run.
Runner = Callable[[AnyScenario, RunSpec], "OneRun"]


@dataclass(frozen=True, slots=True)
class OneRun:
    """One run of a sequence.

    :param scenario, spec: of the run; the law of ``spec`` has the memory that it began with.
    :param missed: the reason why it says nothing about the controller; empty: there is none.
    :param digest: of its commands, or of its frames where the system has no digest.
    :param kept: the values that the law keeps.
    :param trace: its telegrams; None of a run that was made together with others.
    """

    scenario: AnyScenario
    spec: RunSpec
    score: Score
    counts: dict[str, int]
    missed: str
    digest: str
    kept: Kept | None
    trace: Trace | None = field(default=None, repr=False, compare=False)

    @property
    def began(self) -> Memory:
        """The memory that it began with."""
        assert self.spec.law.memory is not None
        return self.spec.law.memory

    @property
    def record(self) -> MemoryRecord | None:
        """The record that it leaves; None if it cannot be trusted, or was learned from before."""
        if self.kept is None or self.missed or self.score.verdict not in ("PASS", "FAIL"):
            return None
        return record_after(self.scenario, self.spec, self.kept)

    @property
    def left(self) -> Memory:
        """The memory for the next run."""
        if self.record is None or self.kept is None:
            return self.began
        return self.began.after(self.record, self.kept.used, self.kept.refused)


def sequence_batch_of(scenario: AnyScenario) -> Callable[..., Any] | None:
    """The part ``sequence_batch`` of a scenario's system; None: it has none, or a fault needs the nodes."""
    if needs_nodes(scenario):
        return None
    batch: Callable[..., Any] | None = scenario.installed_system.optional_part("sequence_batch")
    return batch


def sequences(
    scenario: AnyScenario, wanted: Sequence[list[RunSpec]], begun: Sequence[Memory] | None = None
) -> Iterator[tuple[int, int, OneRun]]:
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
        for place, (spec, one) in enumerate(zip(specs, batch(scenario, specs), strict=True)):
            kept = None if one.kept is None else kept_of(one.kept)
            run = OneRun(scenario, spec, one.score, dict(one.counts), "", one.digest, kept)
            memories[place] = run.left
            yield place, number + 1, run


def runner_of(scenario: AnyScenario) -> Runner:
    """The fastest way to make a run: without a bus if the system can, else through the nodes."""
    system = scenario.installed_system
    comparable = system.digest is not None or system.interface is not None
    is_direct = system.direct is not None and comparable and not needs_nodes(scenario)
    return _direct if is_direct else through_nodes


def sequence(
    scenario: AnyScenario, specs: list[RunSpec], runner: Runner, memory: Memory | None = None
) -> Iterator[OneRun]:
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


def _direct(scenario: AnyScenario, spec: RunSpec) -> OneRun:
    system = scenario.installed_system
    controller: Any = maker_of(system, scenario)(scenario, spec.law, make(spec.law.arithmetic))
    run: Result = system.part("direct")(scenario, spec, controller=controller)
    run.arithmetic = controller.counters
    return _one_of(run, controller.kept())


def through_nodes(scenario: AnyScenario, spec: RunSpec) -> OneRun:
    """One run through the nodes of the bench, in this process."""
    run = unrecorded_run(scenario, spec)
    return _one_of(run, run.telemetry.get("memory"))


def _one_of(run: Result, found: Mapping[str, Any] | None) -> OneRun:
    """:param found: values that the law keeps."""
    kept = None if found is None else kept_of(found)
    return OneRun(run.scenario, run.spec, run.score, run.counts, run.missed, _digest(run), kept, run.trace)


def _digest(run: Result) -> str:
    system = run.scenario.installed_system
    if system.digest is not None:
        return str(system.part("digest")(run.scenario, run.trace))
    if system.interface is not None:
        return command_digest(run.scenario, run.trace)
    return run.frames_sha256[:DIGITS]
