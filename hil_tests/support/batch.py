"""A batch and the same runs on the bench, compared."""

from __future__ import annotations

from typing import Any

from railhil.batch import Case
from railhil.bench import direct_run
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.batch.replay import trace_digest


def same_as_the_bench(case: Case, seeds: tuple[int, ...]) -> list[Any]:
    """Assert that a batch is what single runs are; returns their scores."""
    batch = run_batch(case, seeds)
    for i, seed in enumerate(seeds):
        run = direct_run(case.scenario, case.run(seed))
        assert batch.digest[i] == trace_digest(case.scenario, run.trace), f"seed {seed}: notch codes"
        assert batch.scores[i] == run.score, f"seed {seed}"
        assert batch.wraps[i] == run.arithmetic.wraps
        assert batch.saturations[i] == run.arithmetic.saturations
        assert batch.zero_divisions[i] == run.arithmetic.zero_divisions
    return list(batch.scores)
