"""Figures over sequences, against values worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.judge.judging import judging_of, sequence_measures
from railhil.scenarios.load import load
from railhil.sequences.summary import runs_to_converge, spread, tail_runs

NAN = float("nan")


def test_runs_to_converge_is_the_first_of_three_in_a_row() -> None:
    errors = np.array(
        [
            [0.9, 0.2, 0.1, 0.3, 0.9, 0.9],
            [0.9, 0.2, 0.1, 0.4, 0.1, 0.1],
            [0.9, 0.2, NAN, 0.1, 0.1, 0.1],
            [0.1, 0.1, 0.1, 0.1, 0.1, 0.1],
        ]
    )
    assert runs_to_converge(errors, 0.3, 3).tolist() == [2, np.inf, 4, 1]
    assert runs_to_converge(errors[:, :2], 0.3, 3).tolist() == [np.inf] * 4


def test_spread_of_runs_of_which_one_did_not_stop() -> None:
    found = spread(np.array([[0.1, -0.3], [0.2, NAN]]), (0.1, 0.3))
    assert (found["runs"], found["with_a_value"]) == (4, 3)
    assert found["mean"] == pytest.approx(0.0)
    assert found["mean_error"] == pytest.approx(0.2)
    assert found["rms"] == pytest.approx(np.sqrt(0.14 / 3))
    assert found["median_error"] == 0.2
    assert found["p95"] is None, "infinitely bad"
    assert found["within"] == {"0.1": 0.25, "0.3": 0.75}


def test_the_last_runs_are_a_third() -> None:
    assert [tail_runs(runs) for runs in (1, 2, 3, 15, 30)] == [1, 1, 1, 5, 10]


def test_a_system_that_names_no_measures_has_its_limits() -> None:
    scenario = load("lvshun_tieshan")
    found = sequence_measures(scenario, judging_of(scenario))
    assert [(one.criterion.key, one.within, one.converged) for one in found] == [
        ("stop_error_m", (scenario.plan.stop_error_max_m,), scenario.plan.stop_error_max_m),
        ("punctuality_s", (scenario.plan.time_error_max_s,), scenario.plan.time_error_max_s),
    ]
