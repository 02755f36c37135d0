"""Runs of a system without a batch: each through the nodes of the bench, in this process."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from railhil.batch.case import BatchResult, Case, column
from railhil.bench import BenchRun, local_run
from railhil.supervisor.judging import judging_of

#: Number of hexadecimal digits of the frame log's hash that are used instead of the notch digest.
DIGITS = 16


def run_nodes(case: Case, seeds: Sequence[int]) -> BatchResult:
    """Run a case with each seed; the digest of a run is the beginning of the SHA-256 of its frame log.

    :raises InputError: law, arithmetic, indexing or parameters do not fit.
    """
    runs = [_run(case, int(seed)) for seed in seeds]
    scores = [run.score for run in runs]
    totals = [run.telemetry["totals"] for run in runs]
    criteria = judging_of(case.scenario).criteria
    signed = [criterion.signed for criterion in criteria if criterion.signed is not None]
    wraps, saturations, zero_divisions = (
        np.array([total[name] for total in totals], dtype=np.int64)
        for name in ("wraps", "saturations", "zero_divisions")
    )
    return BatchResult(
        seed=np.array(seeds, dtype=np.int64),
        scores=tuple(scores),
        values={item.key: column([score.values[item.key] for score in scores]) for item in criteria},
        signed={key: column([score.signed[key] for score in scores]) for key in signed},
        overspeed_mps=column([score.overspeed_mps for score in scores]),
        passed=np.array([score.verdict == "PASS" for score in scores], dtype=bool),
        ended=tuple(score.ended for score in scores),
        failures=tuple(score.failures for score in scores),
        wraps=wraps,
        saturations=saturations,
        zero_divisions=zero_divisions,
        notch_digest=tuple(run.frames_sha256[:DIGITS] for run in runs),
    )


def _run(case: Case, seed: int) -> BenchRun:
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        return local_run(case.scenario, Path(folder), case.run(seed))
