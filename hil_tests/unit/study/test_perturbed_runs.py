"""Runs without telegrams, alone and by the hundred, score as the real ones do."""

from __future__ import annotations

from math import ceil

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.plug import Wrapping, plug_in
from railhil.bench import direct_run, local_run
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.study.perturbed_runs import FIRST_SEED, run_seeds


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return load(str(path))


@pytest.mark.parametrize("indexing", ["time", "distance"])
def test_a_direct_run_scores_as_one_with_telegrams(short, tmp_path, indexing):
    """ITAE follows the indexing: a trace that does not name it is scored by time."""
    direct = direct_run(short, RunSpec(law=LawSpec(indexing=indexing), seed=3, perturbed=True))
    local = local_run(short, tmp_path, RunSpec(law=LawSpec(indexing=indexing), seed=3, perturbed=True))
    assert direct.commands("notch") == local.commands("notch")
    assert direct.score.values == local.score.values


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
def test_runs_of_many_seeds_are_those_of_single_runs(short, tmp_path, monkeypatch, arithmetic):
    plug_in(tmp_path, monkeypatch, wrapping=Wrapping)
    law = LawSpec("wrapping", arithmetic, "distance")
    found = run_seeds(short, law, range(FIRST_SEED, FIRST_SEED + 3))
    runs = [direct_run(short, RunSpec(law=law, seed=FIRST_SEED + i, perturbed=True)) for i in range(3)]
    assert [score.values for score in found.scores] == [run.score.values for run in runs]
    # 25 polls of 20 ms in a control period.
    wraps = sum(ceil(len(run.commands("notch")) / 25) for run in runs) if arithmetic == "iq" else 0
    assert [int(one.sum()) for one in (found.wraps, found.saturations, found.zero_divisions)] == [wraps, 0, 0]
    assert len({score.values["energy_kj"] for score in found.scores}) == 3
