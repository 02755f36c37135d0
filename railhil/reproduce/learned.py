"""Sets of sequences in a protocol: runs of a law that learns from run to run, as ``railhil learn`` makes them.

The runs of all sequences are made at once where the system can do so, in one process for each set.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.campaign.extras import need
from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.reproduce.ways import Made
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    # Needs the extra [campaign].
    from railhil.sequences.one import OneRun


@dataclass(frozen=True)
class MadeSequences:
    """Sequences that were made: ``runs`` of each in order, with scenario and a run of the protocol."""

    scenario: AnyScenario
    spec: RunSpec
    runs: Sequence[Sequence[OneRun]]


@dataclass(frozen=True, slots=True)
class Sequences:
    """``count`` sequences of ``runs`` runs, each beginning without a memory.

    ``first``: seed of the first one; the others follow as those of ``railhil learn``.
    """

    first: int
    count: int
    runs: int

    def words(self, spec: RunSpec) -> list[str]:
        words = ["learn", *spec.scenario_words, *spec.law.words, *([] if spec.perturbed else ["--nominal"])]
        return [*words, "--runs", f"{self.runs}", "--sequences", f"{self.count}", "--seed", f"{self.first}"]

    def make(self, spec: RunSpec, folder: Path) -> Made:
        need("pyarrow", "campaign")
        from railhil.sequences.one import sequences
        from railhil.sequences.plan import run_specs, sequence_seeds

        scenario = spec.load()
        seeds = sequence_seeds(scenario, self.first, self.count, self.runs)
        wanted = [run_specs(spec, scenario, seed, self.runs) for seed in seeds]
        made: dict[tuple[int, int], Any] = {}
        for place, number, run in sequences(scenario, wanted):
            made[place, number] = run
        runs = [[made[place, number + 1] for number in range(self.runs)] for place in range(len(wanted))]
        return made_of(runs, MadeSequences(scenario, spec, runs))


def made_of(runs: Sequence[Sequence[OneRun]], outcome: Any) -> Made:
    """The entry of some sequences: the worst verdict of their runs, and a hash over their commands and memories."""
    flat = [run for sequence in runs for run in sequence]
    verdicts = ["INVALID" if run.missed else run.score.verdict for run in flat]
    counts = {verdict: verdicts.count(verdict) for verdict in ("INVALID", "FAIL") if verdict in verdicts}
    reasons = tuple(f"{count} of {count_of(len(flat), 'run')} {verdict}" for verdict, count in counts.items())
    return Made(next(iter(counts), "PASS"), reasons, _sha256(flat), outcome)


def _sha256(runs: Iterable[OneRun]) -> str:
    digest = hashlib.sha256()
    for run in runs:
        left = "-" if run.record is None else run.record.sha256
        digest.update(f"{run.spec.seed} {run.spec.run_number} {run.digest} {left}\n".encode())
    return digest.hexdigest()


def check_consecutive(seeds: Sequence[int]) -> None:
    """Refuse seeds that no ``railhil learn`` could make together.

    :raises InputError: they do not follow each other.
    """
    if list(seeds) != list(range(seeds[0], seeds[0] + len(seeds))):
        found = ",".join(map(str, seeds))
        raise InputError(
            "command line", "--seeds", found, f"seeds that follow each other, as {seeds[0]}-{seeds[0] + 9}"
        )
