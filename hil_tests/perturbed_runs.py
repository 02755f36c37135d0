"""Hundreds of perturbed runs on all processors, for statistics of the scores."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from controller_node.arithmetic.base import Counters
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


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a perturbed run gives: its score, and what went wrong in the law's arithmetic."""

    score: Score
    arithmetic: Counters


def _outcome(job: Job) -> Outcome:
    run = direct_run(
        job.scenario,
        seed=job.seed,
        drawn=True,
        controller=job.controller,
        arithmetic=job.arithmetic,
        indexing=job.indexing,
    )
    assert run.arithmetic is not None
    return Outcome(run.score, run.arithmetic)


def jobs(
    scenario: Scenario, runs: int, *, controller: str = "ipfc", arithmetic: str = "iq", indexing: str = "time"
) -> list[Job]:
    """``runs`` jobs with seeds from :data:`FIRST_SEED` on: the same draws for every controller and arithmetic."""
    return [Job(scenario, FIRST_SEED + i, controller, arithmetic, indexing) for i in range(runs)]


def outcomes(work: Sequence[Job], processes: int | None = None) -> Iterator[Outcome]:
    """Outcomes of the jobs in their order, each as soon as it is there.

    :param processes: default: one per processor.
    """
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from pool.imap(_outcome, work, chunksize=_CHUNK)


def scores(work: Sequence[Job], processes: int | None = None) -> Iterator[Score]:
    """Only the scores of :func:`outcomes`."""
    return (outcome.score for outcome in outcomes(work, processes))
