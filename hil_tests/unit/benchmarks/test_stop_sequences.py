"""Sequences of stops: their train, written independently of the bench's, stops at the same place."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.stop_sequences import DEFAULT, Sequences, changed, converged
from hil_tests.support.stops import EXACT, FLAT, SHORT, stop_scenario
from railhil.controller_node.laws.stopping.ilc_stop import IlcStop, IlcStopParameters
from railhil.controller_node.laws.stopping.reaim import Reaim, ReaimParameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.vector_bench import direct_run


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "law", "given"), [("ilc_stop", IlcStop, IlcStopParameters), ("reaim", Reaim, ReaimParameters)]
)
def test_both_trains_stop_at_the_same_place(name, law, given):
    scenario = stop_scenario(*SHORT, *EXACT, *FLAT, "task.start_m=2560")
    bench = direct_run(scenario, RunSpec(law=LawSpec(name, "float64"))).score.signed["stop_error_m"]
    keys = changed(
        DEFAULT,
        start_m=2560.0,
        start_kmh=18.0,
        approach_kmh=18.0,
        cruise_sigma_mps=0.0,
        wander_sigma_mps=0.0,
        grade=((0.0, 0.0),),
        sensors={"speed_noise_mps": 0.0},
    )
    found = Sequences(keys, law, given(), 2).run(1)
    assert found == pytest.approx([bench, bench], abs=0.002)


def test_converged_is_the_first_of_three_runs_in_a_row():
    errors = np.array([[1.0, 0.1, 1.0], [0.1, 0.1, 0.1], [0.1, 0.1, 1.0], [0.2, 9.0, 0.1]])
    assert converged(errors).tolist() == [2.0, 1.0, np.inf]
