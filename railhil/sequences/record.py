"""Records a sequence: one run folder after another, each run beginning with the memory that the last one has left."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import INVALID
from railhil.common.user_files import refuse_unwritable
from railhil.judge.rerun import certified_run, changes
from railhil.judge.result import Result
from railhil.record.run_folder import run_folder
from railhil.run.make import record_run
from railhil.scenarios.memory import Memory
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.sequences.evidence import (
    SEQUENCE,
    Evidence,
    Made,
    differences,
    left,
    read_evidence,
    run_name,
    write_evidence,
)
from railhil.sequences.plan import run_specs
from railhil.study.claim import claimed

#: Called with the number of a run and its result.
Told = Callable[[int, Result], None]


class Broken(Exception):
    """A run that cannot be trusted ends the sequence; the runs before it are kept."""

    def __init__(self, text: str, exit_code: int = INVALID) -> None:
        super().__init__(text)
        self.exit_code = exit_code


@contextmanager
def begin(first: RunSpec, scenario: AnyScenario, runs: int, out: str | None) -> Iterator[tuple[Path, Evidence]]:
    """The folder of a sequence, new or with the runs that it has, with exclusive access.

    :param first: the first run, with the memory that the sequence begins with, if any.
    :raises InputError: the folder cannot be used or is in use, has another sequence, or runs of other code.
    """
    if out is None or not (Path(out) / SEQUENCE).exists():
        folder, _ = run_folder(out, scenario.name, "sequence")
    else:
        folder = Path(out)
    with claimed(folder, "sequence"):
        if (folder / SEQUENCE).exists():
            evidence = read_evidence(folder)
            _check_same(evidence, first, runs, folder)
        else:
            evidence = Evidence(first, runs, ())
            with refuse_unwritable("--out", folder, "folder"):
                write_evidence(evidence, folder)
        yield folder, evidence


def _check_same(evidence: Evidence, first: RunSpec, runs: int, folder: Path) -> None:
    """Refuse to resume with another request. Raises InputError."""
    if (evidence.first.as_json(), evidence.runs) != (first.as_json(), runs):
        allowed = "the same one to go on, or another --out"
        raise InputError(folder / SEQUENCE, "", Words("is of another sequence"), allowed)
    for difference in differences(folder, evidence):
        raise InputError(folder / SEQUENCE, "made", Words("has changed runs"), f"them as they were made: {difference}")
    if evidence.made and (changed := changes(certified_run(str(folder / run_name(len(evidence.made)))))):
        found = Words(f"has runs of other code: {'; '.join(changed)}")
        raise InputError(folder / SEQUENCE, "", found, "that code to go on, or another --out")


def record(folder: Path, evidence: Evidence, scenario: AnyScenario, first: RunSpec, told: Told) -> Evidence:
    """Make the runs that are missing.

    :param first: first run of the evidence, with the settings with which the runs are made.
    :raises Broken: a run is not trustworthy, or was stopped.
    :raises NeverBegan: a run was refused.
    :raises RecordFailed: the folder cannot be written.
    """
    memory = evidence.began
    for one in evidence.made:
        memory, _ = left(folder / run_name(one.run), memory)
    specs = run_specs(first, scenario, first.seed, evidence.runs)
    for number, spec in enumerate(specs[len(evidence.made) :], len(evidence.made) + 1):
        place = folder / run_name(number)
        # A run that was broken off before it was entered is made again.
        shutil.rmtree(place, ignore_errors=True)
        made, result = _one(spec, memory, number, place, scenario)
        memory, _ = left(place, memory)
        evidence = replace(evidence, made=(*evidence.made, made))
        write_evidence(evidence, folder)
        told(number, result)
    return evidence


def _one(spec: RunSpec, memory: Memory, number: int, place: Path, scenario: AnyScenario) -> tuple[Made, Result]:
    """:raises Broken: the run is not trustworthy, or was stopped."""
    spec = replace(spec, law=replace(spec.law, memory=memory), out=place)
    result = record_run(spec, scenario=scenario)
    if result.stopped_exit_code or not result.trusted:
        why = f"run {number} is not part of the sequence: {result.line or 'stopped'}; it goes on with the same command"
        raise Broken(why, result.stopped_exit_code or result.exit_code)
    kept = None if result.memory is None else result.memory.record
    after = None if kept is None else kept.sha256
    made = Made(
        run=number,
        verdict=result.verdict,
        memory_before_sha256=memory.sha256,
        frames_sha256=result.frames_sha256,
        memory_after_sha256=after,
    )
    return made, result
