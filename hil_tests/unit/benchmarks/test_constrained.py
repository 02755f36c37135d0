"""The measurements of laws with constraints and of the solvers for them."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.constrained import measured
from benchmarks.qp_solvers import SOLVERS, exceeded, recorded, solved
from railhil.scenarios.load import load_any

pytest.importorskip("daqp", reason="MISSING CAPABILITY daqp")


@pytest.mark.long
@pytest.mark.slow
def test_a_run_is_measured_and_the_jerk_limit_seen() -> None:
    scenario = load_any("emu3_short", ["task.duration_s=40"])
    found = measured(scenario, "emu3_short", "delay_qp", {"loop": "train", "jerk_max_mps3": 0.1}, 3)
    assert 0.0 < found.slope_mps3 < found.largest_slope_mps3 <= 0.15
    assert found.coupler_kn is not None
    assert found.step_us > 0.0


@pytest.mark.long
@pytest.mark.slow
def test_recorded_programs_are_solved_within_their_bounds_and_twice_alike() -> None:
    programs = recorded("emu3_short", {"loop": "train"})[:200:20]
    solve = SOLVERS[0][3]()
    first, taken_s = solved(solve, programs, warm=False)
    assert len(taken_s) == len(programs) == len(first)
    assert exceeded(programs, first) < 1e-9
    assert first.tobytes() == solved(solve, programs, warm=False)[0].tobytes()
    warm, _ = solved(solve, programs, warm=True)
    assert np.abs(warm - first).max() < 1e-9
