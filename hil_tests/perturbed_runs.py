"""Hundreds of perturbed runs on all processors, for statistics of the scores."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from hil_tests.bench import direct_run
from scenarios.model import Scenario
from supervisor.score import Score

#: Seed of the first run; the others follow.
FIRST_SEED = 1000
#: The five scores, and the unit of each.
SCORES = {"itae": "km/h s2", "energy_kj": "kJ", "punctuality_s": "s", "stop_error_m": "m", "comfort": "m/s2/km"}
#: Runs that a process takes at a time.
_CHUNK = 4


@dataclass(frozen=True, slots=True)
class Job:
    """One perturbed run."""

    scenario: Scenario
    seed: int
    controller: str
    arithmetic: str
    indexing: str


def _score(job: Job) -> Score:
    return direct_run(
        job.scenario,
        seed=job.seed,
        drawn=True,
        controller=job.controller,
        arithmetic=job.arithmetic,
        indexing=job.indexing,
    ).score


def jobs(
    scenario: Scenario, runs: int, *, controller: str = "ipfc", arithmetic: str = "iq", indexing: str = "time"
) -> list[Job]:
    """``runs`` jobs with seeds from :data:`FIRST_SEED` on: the same draws for every controller and arithmetic."""
    return [Job(scenario, FIRST_SEED + i, controller, arithmetic, indexing) for i in range(runs)]


def scores(work: Sequence[Job], processes: int | None = None) -> Iterator[Score]:
    """Scores of the jobs in their order, each as soon as it is there.

    :param processes: default: one per processor.
    """
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from pool.imap(_score, work, chunksize=_CHUNK)
