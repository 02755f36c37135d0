"""Makes the entries of a protocol, each in one process: a run over the in-process bus, a run without a bus, or a set of
sequences of a law that learns."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

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


class Experiment(Protocol):
    """The way in which an entry is made from its run."""

    def words(self, spec: RunSpec) -> list[str]:
        """Words of the command line, after ``railhil``, that make it alone; none: there is no such command."""

    def make(self, spec: RunSpec, folder: Path) -> Record | SequenceRuns:
        """Make it; the result is the argument of ``measure`` and ``curves`` of the paper.

        :param folder: for its record, if it has one; there is no such folder yet.
        :raises InputError: it cannot be made.
        :raises NeverBegan: the nodes refused a run.
        """


@dataclass(frozen=True, slots=True)
class SingleRun:
    """One run over the in-process bus, with a run folder.

    ``ports``: if given, the run is made without a bus (:mod:`railhil.run.coupled`), and has neither folder nor log; the
    plant publishes these ports beside the readings of the law.
    """

    ports: tuple[str, ...] = ()

    def words(self, spec: RunSpec) -> list[str]:
        return ["run", *spec.words]

    def make(self, spec: RunSpec, folder: Path) -> Record:
        if not self.ports:
            return library.run(spec, out=folder)
        scenario = spec.load()
        run = direct_run(scenario, spec, ports=self.ports)
        record = Record(Path(), scenario, run.trace, certificate=spec.as_json())
        return record.copy_with(score=run.score, events=())


@dataclass(frozen=True)
class SequenceRuns:
    """``runs`` of each sequence in order, with scenario and a run of the protocol.

    ``figures``: those that the experiment itself has measured; None: there are none.
    """

    scenario: AnyScenario
    spec: RunSpec
    runs: Sequence[Sequence[SequenceRun]]
    figures: Mapping[str, float | None] | None = None

    @property
    def _verdicts(self) -> list[str]:
        return ["INVALID" if run.missed else run.score.verdict for sequence in self.runs for run in sequence]

    @property
    def verdict(self) -> str:
        """The worst verdict of a run."""
        return next((verdict for verdict in ("INVALID", "FAIL") if verdict in self._verdicts), "PASS")

    @property
    def reasons(self) -> tuple[str, ...]:
        """How many runs are INVALID or FAIL."""
        counts = Counter(self._verdicts)
        of_all = count_of(counts.total(), "run")
        return tuple(f"{counts[verdict]} of {of_all} {verdict}" for verdict in ("INVALID", "FAIL") if counts[verdict])

    @property
    def frames_sha256(self) -> str:
        """In place of frames: a hash over the commands of the runs, and the memories that they leave."""
        digest = hashlib.sha256()
        for run in (run for sequence in self.runs for run in sequence):
            left = "-" if run.record is None else run.record.sha256
            digest.update(f"{run.spec.seed} {run.spec.run_number} {run.digest} {left}\n".encode())
        return digest.hexdigest()


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

    def make(self, spec: RunSpec, folder: Path) -> SequenceRuns:
        need("pyarrow", "campaign")
        from railhil.sequences.one import sequences
        from railhil.sequences.plan import run_specs, sequence_seeds

        scenario = spec.load()
        seeds = sequence_seeds(scenario, self.first, self.count, self.runs)
        wanted = [run_specs(spec, scenario, seed, self.runs) for seed in seeds]
        made = {(place, number): run for place, number, run in sequences(scenario, wanted)}
        runs = [[made[place, number + 1] for number in range(self.runs)] for place in range(len(wanted))]
        return SequenceRuns(scenario, spec, runs)


def check_consecutive(seeds: Sequence[int]) -> None:
    """Refuse seeds that no ``railhil learn`` could make together.

    :raises InputError: they do not follow each other.
    """
    if list(seeds) != list(range(seeds[0], seeds[0] + len(seeds))):
        found = ",".join(map(str, seeds))
        raise InputError(
            "command line", "--seeds", found, f"seeds that follow each other, as {seeds[0]}-{seeds[0] + 9}"
        )
