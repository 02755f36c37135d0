"""Figures of a precise stop do not depend on which telegram of the record is missing."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from railhil.systems.stop.approach import Approach

STEP_S = 0.016


def ramp(kept: np.ndarray) -> Approach:
    """A brake that builds up 1 m/s2 in 0.192 s, every 16 ms; of the telegrams only those kept."""
    time_s = np.arange(100) * STEP_S
    drive = -np.clip((time_s - 0.5) / 0.192, 0.0, 1.0)
    speed = np.full(100, 5.0)
    scenario = SimpleNamespace(task=SimpleNamespace(stop_m=10.0))
    return Approach(scenario, time_s[kept], time_s[kept], speed[kept], drive[kept], drive[kept], None)


@pytest.mark.parametrize("lost", [(), (1,), (0, 1), (1, 2, 3), (40,), (98,)])
def test_the_jerk_is_the_same_with_telegrams_missing(lost: tuple[int, ...]) -> None:
    kept = np.setdiff1d(np.arange(100), lost)
    assert ramp(kept).jerk_mps3() == pytest.approx(1.0 / 0.192, rel=0.06)


def test_too_few_telegrams_have_no_jerk() -> None:
    assert ramp(np.arange(1)).jerk_mps3() is None
    assert ramp(np.arange(5)).jerk_mps3() is None
