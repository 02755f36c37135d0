"""Repeats runs with an emergency brake through the nodes of the bench.

After an emergency brake the controller's own watch determines the notch instead of its law. The batch has no such
watch: its scores are still right, because the train brakes regardless of commands, but the notch codes would differ
from those of the bench.
"""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhil.batch.case import Case, Ints
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.judge.score import Score
from railhil.record.trace import Trace
from railhil.run.local import unrecorded_run
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd

#: Hexadecimal digits of a digest.
_DIGITS = 16


def notch_digest(codes: ArrayLike) -> str:
    """First 16 hexadecimal digits of the SHA-256 of notch codes (1/256, one for each control period) as int16."""
    return hashlib.sha256(np.asarray(codes, dtype="<i2").tobytes()).hexdigest()[:_DIGITS]


def control_codes(scenario: Scenario, trace: Trace) -> Ints:
    """Notch codes of a recorded run: the code of the first poll in each control period."""
    codes = trace.raw(NotchCmd.PORT, "NotchCmd")
    times_ns = np.rint(trace.times_s(NotchCmd.PORT) * 1e9).astype(np.int64)
    first = np.diff(times_ns // scenario.timing.control_period_ns, prepend=-1) > 0
    return np.asarray(codes[first])


def trace_digest(scenario: Scenario, trace: Trace) -> str:
    """:func:`notch_digest` of a recorded run."""
    return notch_digest(control_codes(scenario, trace))


def left_the_healthy_path(score: Score) -> bool:
    """True for a run whose notch codes the batch cannot compute."""
    return any("emergency brake" in text for text in score.failures)


def replayed(case: Case, seed: int) -> tuple[Score, NDArray[np.int16], dict[int, int]]:
    """Score, notch codes and event counts of the law's arithmetic (by kind) of one run."""
    run = unrecorded_run(case.scenario, case.run(seed))
    counts = {WRAP: "wraps", SATURATION: "saturations", DIVISION_BY_ZERO: "zero_divisions"}
    codes = np.asarray(control_codes(case.scenario, run.trace), dtype=np.int16)
    return run.score, codes, {kind: run.counts[name] for kind, name in counts.items()}
