"""Makes the entries of a protocol, each in one process: a run over the in-process bus, a run without a bus, or a set of
sequences of a law that learns."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from railhil import library
from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.common.extras import need
from railhil.judge.record import Record
from railhil.run.coupled import direct_run
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    # Needs the extra [campaign].
    from railhil.batch.case import SequenceRun


@dataclass(frozen=True, slots=True)
class EntryResult:
    """An entry that was made.

    ``reasons``: the reasons why the verdict is not PASS. ``sha256``: of its log; empty if it has none. ``outcome``: the
    argument of ``measure`` and ``curves`` of the paper.
    """

    verdict: str
    reasons: tuple[str, ...]
    sha256: str
    outcome: Any


class Experiment(Protocol):
    """The way in which an entry is made from its run."""

    def words(self, spec: RunSpec) -> list[str]:
        """Words of the command line, after ``railhil``, that make it alone; none: there is no such command."""

    def make(self, spec: RunSpec, folder: Path) -> EntryResult:
        """Make it.

        :param folder: for its record, if it has one; there is no such folder yet.
        :raises InputError: it cannot be made.
        :raises NeverBegan: the nodes refused a run.
        """


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """One run over the in-process bus, with a run folder."""

    def words(self, spec: RunSpec) -> list[str]:
        return ["run", *spec.words]

    def make(self, spec: RunSpec, folder: Path) -> EntryResult:
        found = library.run(spec, out=folder)
        return EntryResult(found.verdict, found.reasons, found.frames_sha256, found)


@dataclass(frozen=True, slots=True)
class CoupledRun:
    """One run without a bus (:mod:`railhil.run.coupled`); it has neither folder nor certificate.

    ``ports``: published by the plant beside the readings of the law.
    """

    ports: tuple[str, ...]

    def words(self, spec: RunSpec) -> list[str]:
        return ["run", *spec.words]

    def make(self, spec: RunSpec, folder: Path) -> EntryResult:
        scenario = spec.load()
        run = direct_run(scenario, spec, ports=self.ports)
        record = Record(Path(), scenario, run.trace, certificate=spec.as_json())
        outcome = record.copy_with(score=run.score, events=())
        return EntryResult(outcome.verdict, outcome.reasons, "", outcome)


@dataclass(frozen=True)
class SequenceRuns:
    """``runs`` of each sequence in order, with scenario and a run of the protocol."""

    scenario: AnyScenario
    spec: RunSpec
    runs: Sequence[Sequence[SequenceRun]]


@dataclass(frozen=True, slots=True)
class SequenceSet:
    """``count`` sequences of ``runs`` runs, each beginning without a memory, as ``railhil learn`` makes them.

    The runs of all sequences are made at once where the system can do so. ``first``: seed of the first one; the others
    follow as in ``railhil learn``.
    """

    first: int
    count: int
    runs: int

    def words(self, spec: RunSpec) -> list[str]:
        words = ["learn", *spec.scenario_words, *spec.law.words, *([] if spec.perturbed else ["--nominal"])]
        return [*words, "--runs", f"{self.runs}", "--sequences", f"{self.count}", "--seed", f"{self.first}"]

    def make(self, spec: RunSpec, folder: Path) -> EntryResult:
        need("pyarrow", "campaign")
        from railhil.sequences.one import sequences
        from railhil.sequences.plan import run_specs, sequence_seeds

        scenario = spec.load()
        seeds = sequence_seeds(scenario, self.first, self.count, self.runs)
        wanted = [run_specs(spec, scenario, seed, self.runs) for seed in seeds]
        made = {(place, number): run for place, number, run in sequences(scenario, wanted)}
        runs = [[made[place, number + 1] for number in range(self.runs)] for place in range(len(wanted))]
        return summarize_sequences(runs, SequenceRuns(scenario, spec, runs))


def summarize_sequences(runs: Sequence[Sequence[SequenceRun]], outcome: Any) -> EntryResult:
    """The entry of some sequences: the worst verdict of their runs, and a hash over their commands and memories."""
    flat = [run for sequence in runs for run in sequence]
    verdicts = ["INVALID" if run.missed else run.score.verdict for run in flat]
    counts = {verdict: verdicts.count(verdict) for verdict in ("INVALID", "FAIL") if verdict in verdicts}
    reasons = tuple(f"{count} of {count_of(len(flat), 'run')} {verdict}" for verdict, count in counts.items())
    digest = hashlib.sha256()
    for run in flat:
        left = "-" if run.record is None else run.record.sha256
        digest.update(f"{run.spec.seed} {run.spec.run_number} {run.digest} {left}\n".encode())
    return EntryResult(next(iter(counts), "PASS"), reasons, digest.hexdigest(), outcome)


def check_consecutive(seeds: Sequence[int]) -> None:
    """Refuse seeds that no ``railhil learn`` could make together.

    :raises InputError: they do not follow each other.
    """
    if list(seeds) != list(range(seeds[0], seeds[0] + len(seeds))):
        found = ",".join(map(str, seeds))
        raise InputError(
            "command line", "--seeds", found, f"seeds that follow each other, as {seeds[0]}-{seeds[0] + 9}"
        )
