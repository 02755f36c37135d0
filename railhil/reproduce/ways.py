"""How the entries of a protocol are made, each in one process: a run over the in-process bus, or without a bus."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from railhil import library
from railhil.controller_node.vector.controller import VectorController
from railhil.judge.record import Record
from railhil.run.coupled import coupled_run
from railhil.scenarios.run_spec import RunSpec


@dataclass(frozen=True, slots=True)
class Made:
    """An entry that was made.

    ``reasons``: why the verdict is not PASS. ``sha256``: of its log; empty if it has none. ``outcome``: what
    ``measure`` and ``curves`` of the paper are called with.
    """

    verdict: str
    reasons: tuple[str, ...]
    sha256: str
    outcome: Any


class Way(Protocol):
    """How an entry is made from the run that it is about."""

    def words(self, spec: RunSpec) -> list[str]:
        """Words of the command line, after ``railhil``, that make it alone; none: there is no such command."""

    def make(self, spec: RunSpec, folder: Path) -> Made:
        """Make it.

        :param folder: for its record, if it has one; there is no such folder yet.
        :raises InputError: it cannot be made.
        :raises NeverBegan: the nodes refused a run.
        """


@dataclass(frozen=True, slots=True)
class Recorded:
    """One run over the in-process bus, with a run folder."""

    def words(self, spec: RunSpec) -> list[str]:
        return ["run", *spec.words]

    def make(self, spec: RunSpec, folder: Path) -> Made:
        found = library.run(spec, out=folder)
        return Made(found.verdict, found.reasons, found.frames_sha256, found)


@dataclass(frozen=True, slots=True)
class Coupled:
    """One run without a bus (:mod:`railhil.run.coupled`); it has neither folder nor certificate.

    ``ports``: those that the plant publishes beside the readings of the law.
    """

    ports: tuple[str, ...]

    def words(self, spec: RunSpec) -> list[str]:
        return ["run", *spec.words]

    def make(self, spec: RunSpec, folder: Path) -> Made:
        scenario = spec.load()
        run = coupled_run(scenario, VectorController(scenario, spec.law).step, spec, self.ports)
        outcome = Record(
            Path(), scenario, run.trace, certificate=spec.as_json(), known_score=run.score, known_events=()
        )
        return Made(outcome.verdict, outcome.reasons, "", outcome)
