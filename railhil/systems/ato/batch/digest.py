"""Notch codes of a run, and their digest, which compares a run of the batch with a run of the bench."""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import ArrayLike

from railhil.batch.case import Ints
from railhil.record.trace import Trace
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
