"""Runs without telegrams, alone and by the hundred, score as the real ones do."""

from __future__ import annotations

from math import ceil
from multiprocessing.pool import ThreadPool
from types import SimpleNamespace

import pytest

from benchmarks.figures import QUICK_TOML
from controller_node.arithmetic.base import Constant
from controller_node.laws.ipfc import Ipfc
from hil_tests.bench import direct_run, local_run
from hil_tests.perturbed_runs import FIRST_SEED, SCORES, jobs, outcomes, scores
from scenarios.load import load


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
def test_an_outcome_counts_what_went_wrong_in_its_own_run(short, monkeypatch, arithmetic):
    """The notch made in a way that wraps in fixed point, in every period."""

    def wrapping(self, state, inputs):
        ar = self._ar
        ar.mpy(ar.const(Constant("x", 1.5, 30)), ar.const(Constant("y", 1.5, 30)), 30)
        return step(self, state, inputs)

    step = Ipfc.step
    monkeypatch.setattr(Ipfc, "step", wrapping)
    work = jobs(short, 2, arithmetic=arithmetic)
    monkeypatch.setattr("multiprocessing.get_context", lambda method: SimpleNamespace(Pool=ThreadPool))
    for job, outcome in zip(work, outcomes(work, processes=1), strict=True):
        run = direct_run(short, seed=job.seed, drawn=True, arithmetic=arithmetic)
        assert outcome.score == run.score
        # 25 polls of 20 ms in a control period.
        assert outcome.arithmetic.wraps == (ceil(len(run.notches) / 25) if arithmetic == "iq" else 0)


def test_scores_come_in_the_order_of_the_jobs(short):
    work = jobs(short, 5, indexing="distance")
    assert [job.seed for job in work] == list(range(FIRST_SEED, FIRST_SEED + 5))
    alone = [direct_run(short, seed=job.seed, drawn=True, indexing="distance").score for job in work]
    assert list(scores(work, processes=2)) == alone
    assert len({score.energy_kj for score in alone}) == 5
