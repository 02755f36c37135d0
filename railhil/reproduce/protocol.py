"""Makes the runs of a paper's protocol, each in one process without a bus, as many at a time as asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from railhil import library
from railhil.reproduce.paper import Measured, Paper, Planned, Results


def results(
    paper: Paper,
    seeds: Sequence[int],
    *,
    jobs: int = 1,
    kept: Path | None = None,
    drawn: bool = False,
    say: Callable[[str], None] = lambda sentence: None,
) -> Results:
    """Make all runs of a paper.

    :param jobs: processes at a time; the result does not depend on it.
    :param kept: where the run folders stay, each under the key of its run; None: nowhere.
    :param drawn: also keep the curves of the runs that a figure shows.
    :param say: called after each run.
    :raises InputError: a run cannot be made.
    :raises NeverBegan: the nodes refused a run.
    """
    planned = list(paper.planned(seeds))
    work = partial(_measured, paper, kept, drawn)
    found: dict[str, Measured] = {}
    with ExitStack() as held:
        if jobs > 1 and len(planned) > 1:
            pool = held.enter_context(ProcessPoolExecutor(min(jobs, len(planned))))
            made = pool.map(work, planned)
        else:
            made = map(work, planned)
        for one in made:
            found[one.key] = one
            say(f"{len(found)} of {len(planned)}: {one.key} {one.verdict}")
    return Results(tuple(seeds), found)


def _measured(paper: Paper, kept: Path | None, drawn: bool, planned: Planned) -> Measured:
    """One run, perhaps in a process of its own."""
    with ExitStack() as held:
        place = kept or Path(held.enter_context(TemporaryDirectory(prefix="railhil-reproduce-")))
        outcome = library.run(planned.spec, out=place / planned.key)
        return Measured(
            key=planned.key,
            verdict=outcome.verdict,
            reasons=outcome.reasons,
            frames_sha256=outcome.frames_sha256,
            values=dict(paper.measure(outcome)),
            curves=paper.curves(outcome) if drawn and planned.drawn else None,
        )
