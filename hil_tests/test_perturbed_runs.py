"""Runs without telegrams, alone and by the hundred, score as the real ones do."""

from __future__ import annotations

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.bench import direct_run, local_run
from hil_tests.perturbed_runs import FIRST_SEED, SCORES, jobs, scores
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


def test_scores_come_in_the_order_of_the_jobs(short):
    work = jobs(short, 5, indexing="distance")
    assert [job.seed for job in work] == list(range(FIRST_SEED, FIRST_SEED + 5))
    alone = [direct_run(short, seed=job.seed, drawn=True, indexing="distance").score for job in work]
    assert list(scores(work, processes=2)) == alone
    assert len({score.energy_kj for score in alone}) == 5
