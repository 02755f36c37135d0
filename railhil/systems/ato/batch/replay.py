"""Repeats runs with an emergency brake through the nodes of the bench.

After an emergency brake the controller's own watch determines the notch instead of its law. The batch has no such
watch: its scores are still right, because the train brakes regardless of commands, but the notch codes would differ
from those of the bench.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railhil.batch.case import Case
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.judge.score import Score
from railhil.run.local import unrecorded_run
from railhil.systems.ato.batch.digest import control_codes


def left_the_healthy_path(score: Score) -> bool:
    """True for a run whose notch codes the batch cannot compute."""
    return any("emergency brake" in text for text in score.failures)


def replayed(case: Case, seed: int) -> tuple[Score, NDArray[np.int16], dict[int, int]]:
    """Score, notch codes and event counts of the law's arithmetic (by kind) of one run."""
    run = unrecorded_run(case.scenario, case.run(seed))
    counts = {WRAP: "wraps", SATURATION: "saturations", DIVISION_BY_ZERO: "zero_divisions"}
    codes = np.asarray(control_codes(case.scenario, run.trace), dtype=np.int16)
    return run.score, codes, {kind: run.counts[name] for kind, name in counts.items()}
