"""The batch of the systems of high-speed trains gives the runs of the bench."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from railhil.batch import Case
from railhil.batch.nodes import batch_of
from railhil.bench import unrecorded_run
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import system_named

LAWS = ("pid", "mm_gpc", "elm_ngpc", "delay_gpc")


def same_runs(name: str, settings: Sequence[str], law: str, seeds: Sequence[int], bench: int) -> None:
    """The first ``bench`` seeds of a batch are those of the bench, run by run."""
    scenario = load_any(name, settings)
    case = Case(scenario, LawSpec(law, arithmetic="float64"))
    batch = batch_of(scenario)
    assert batch is not None
    found = batch(case, seeds)
    assert len(set(found.notch_digest)) == len(seeds)
    digest = system_named(scenario.system).part("digest")
    for i, seed in enumerate(seeds[:bench]):
        run = unrecorded_run(scenario, case.run(seed))
        assert found.notch_digest[i] == digest(scenario, run.trace), seed
        assert found.scores[i] == run.score, seed
        assert {key: row[i] for key, row in found.values.items() if run.score.values[key] is not None} == {
            key: value for key, value in run.score.values.items() if value is not None
        }


@pytest.mark.parametrize("law", LAWS)
def test_the_batch_gives_the_runs_of_the_bench(law: str) -> None:
    same_runs("hst_short", ["task.duration_s=12"], law, [3, 4, 2**32 - 1], 2)


@pytest.mark.parametrize("law", ["pid", "delay_gpc"])
def test_the_batch_gives_the_runs_of_the_bench_with_three_coupled_units(law: str) -> None:
    same_runs("emu3_short", ["task.start_s=3530", "task.duration_s=10"], law, [3, 4], 1)


@pytest.mark.slow
def test_a_campaign_is_verified_on_the_bench(tmp_path: Path) -> None:
    """Over the ports of the system, which are not those of railhil's own train."""
    settings = ("--set", "task.duration_s=12", "--arithmetic", "float64", "--chunk", "1")
    done = railhil("campaign", "hst_short", *settings, "--runs", "2", "--out", tmp_path / "campaign")
    assert done.exit_code == 0, done.err
    assert "through the nodes" not in done.err
    done = railhil("campaign", "--verify", tmp_path / "campaign", "--runs", "1")
    assert done.exit_code == 0, done.err
    assert "1 of 1 runs are the same on the bench" in done.out
