"""Runs without telegrams, alone and by the hundred, score as the real ones do."""

from __future__ import annotations

from math import ceil

import pytest

import railhil.controller_node.controller
from benchmarks.figures import QUICK_TOML
from railhil.batch.perturbed_runs import FIRST_SEED, SCORES, outcomes
from railhil.bench import direct_run, local_run
from railhil.controller_node.arithmetic.base import Constant, Counters
from railhil.controller_node.laws.ipfc import Ipfc
from railhil.scenarios.load import load


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return load(str(path))


@pytest.mark.parametrize("indexing", ["time", "distance"])
def test_a_direct_run_scores_as_one_with_telegrams(short, tmp_path, indexing):
    """ITAE follows the indexing: a trace that does not name it is scored by time."""
    direct = direct_run(short, seed=3, drawn=True, indexing=indexing)
    local = local_run(short, tmp_path, seed=3, drawn=True, indexing=indexing)
    assert direct.notches == local.notches
    assert {name: getattr(direct.score, name) for name in SCORES} == {
        name: getattr(local.score, name) for name in SCORES
    }


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
def test_outcomes_are_those_of_single_runs(short, monkeypatch, arithmetic):
    """The notch made in a way that wraps in fixed point, in every period."""

    def wrapping(self, state, inputs):
        ar = self._ar
        ar.mpy(ar.const(Constant("x", 1.5, 30)), ar.const(Constant("y", 1.5, 30)), 30)
        return step(self, state, inputs)

    step = Ipfc.step
    monkeypatch.setattr(Ipfc, "step", wrapping)
    # Else it would not start.
    monkeypatch.setattr(railhil.controller_node.controller, "refuse_wraps", lambda *given: None)
    found = outcomes(short, 3, arithmetic=arithmetic, indexing="distance")
    runs = [
        direct_run(short, seed=FIRST_SEED + i, drawn=True, arithmetic=arithmetic, indexing="distance") for i in range(3)
    ]
    for name in SCORES:
        assert [getattr(score, name) for score in found.scores] == [getattr(run.score, name) for run in runs]
    # 25 polls of 20 ms in a control period.
    wraps = sum(ceil(len(run.notches) / 25) for run in runs) if arithmetic == "iq" else 0
    assert found.arithmetic == Counters(wraps, 0, 0)
    assert len({score.energy_kj for score in found.scores}) == 3
