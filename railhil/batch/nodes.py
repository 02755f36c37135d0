"""Runs of many seeds of a system: by its batch, or else one by one through the nodes of the bench, in this process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from railhil.batch.case import BatchResult, Case, column
from railhil.bench import unrecorded_run
from railhil.plant_sim.faults.plants import needs_nodes
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import system_named
from railhil.supervisor.fault_report import missed_faults
from railhil.supervisor.judging import judging_of

#: Number of hexadecimal digits of the frame log's hash that are used instead of the notch digest.
DIGITS = 16


def batch_of(scenario: AnyScenario) -> Callable[..., Any] | None:
    """The batch of a scenario's system (:func:`railhil.batch.run_batch`), None when it has none, or when a fault of
    the scenario needs the nodes."""
    system = system_named(scenario.system)
    if needs_nodes(scenario):
        return None
    return system.part("batch") if "batch" in system.own else None


def run_nodes(case: Case, seeds: Sequence[int]) -> BatchResult:
    """Run a case with each seed; the digest of a run is the beginning of the SHA-256 of its frame log.

    :raises InputError: law, arithmetic, indexing or parameters do not fit.
    """
    runs = [unrecorded_run(case.scenario, case.run(int(seed))) for seed in seeds]
    scores = [run.score for run in runs]
    totals = [run.telemetry["totals"] for run in runs]
    # A fault that did nothing: such a run says nothing about the controller.
    missed = [missed_faults(run.faults) for run in runs]
    judging = judging_of(case.scenario)
    criteria = judging.criteria
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
        extras={extra.key: column([score.extras[extra.key] for score in scores]) for extra in judging.extras},
        passed=np.array(
            [score.verdict == "PASS" and not why for score, why in zip(scores, missed, strict=True)], dtype=bool
        ),
        ended=tuple(score.ended for score in scores),
        failures=tuple((*score.failures, *filter(None, (why,))) for score, why in zip(scores, missed, strict=True)),
        wraps=wraps,
        saturations=saturations,
        zero_divisions=zero_divisions,
        notch_digest=tuple(run.frames_sha256[:DIGITS] for run in runs),
    )
