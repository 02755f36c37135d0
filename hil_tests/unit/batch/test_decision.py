"""When the noise of a run has decided that it fails: counts of continuations, each of which anybody can repeat."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.batch import decision
from railhil.batch.decision import (
    Decision,
    decision_figure,
    decision_of,
    find_decision,
    lost_sentence,
    scores_that_violate,
)
from railhil.common.errors import InputError
from railhil.judge.record import checked_record
from railhil.judge.requirements.outcome import judge_requirements
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.result import Result
from railhil.run.local import unrecorded_run
from railhil.run.make import record_run
from railhil.scenarios.run_spec import LawSpec, RunSpec

#: The noise of seed 1 violates it, and about a quarter of all do.
NEAR = Requirement("NEAR", "at stopped stop_error <= -0.661 m")


@pytest.fixture
def short(tmp_path: Path) -> RunSpec:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    return RunSpec(str(tmp_path / "short.toml"), law=LawSpec("ipfc_plus", arithmetic="float64"), bus="local", seed=1)


def violates(result: Result) -> bool:
    (outcome,) = judge_requirements(result.as_record(), (NEAR,))
    return outcome.violated


@pytest.mark.parametrize(
    ("failed", "said"),
    [
        ((3, 2, 9, 64), "decided between 2 and 3 s: 9 of 64 ... 64 of 64 continuations with new noise from there fail"),
        ((3, 40, 64, 64), "decided between 0 and 2 s: 3 of 64 ... 64 of 64"),
        ((64, 3, 64, 64), "decided between 1 and 2 s: 3 of 64 ... 64 of 64"),
        ((50, 60, 64, 64), "decided between 0 and 2 s: 50 of 64 ... 64 of 64"),
        ((64, 64, 64, 64), "64 of 64 continuations with new noise from the start fail"),
        ((3, 5, 64, 63), "not decided at 3 s: 63 of 64 continuations with new noise from there fail"),
    ],
)
def test_the_sentence_claims_what_was_counted(failed: tuple[int, ...], said: str) -> None:
    assert Decision(64, (0.0, 1.0, 2.0, 3.0), failed).sentence.startswith(said)


@pytest.mark.parametrize(("count", "is_drawn"), [(0, False), (1, False), (2, True)])
def test_counts_at_one_instant_are_no_curve(count: int, is_drawn: bool) -> None:
    document = {"runs": 64, "at_s": [0.0, 2.5][:count], "failed": [64, 64][:count]}
    assert (decision_figure(document if count else None, "decision") is not None) == is_drawn


@pytest.mark.parametrize("by_batch", [True, False])
@settings(max_examples=30, deadline=None)
@given(at=st.integers(0, 500))
def test_a_decision_is_bisected_to_a_share_of_the_run(by_batch: bool, at: int) -> None:
    """A made-up run of 5 s, which its noise decides at one tick."""
    with pytest.MonkeyPatch.context() as patched:
        asked: list[int] = []

        def counts(ticks: Any) -> list[int]:
            asked.extend(ticks)
            return [64 if tick >= at else 5 for tick in ticks]

        patched.setattr(decision, "_counted_by_batch", lambda *given: counts if by_batch else None)
        patched.setattr(decision, "_counted_by_branches", lambda *given: counts)
        found = find_decision(RunSpec("lvshun_tieshan"), 5.0, violates, lambda scores: [])
    assert len({*asked}) == len(asked) == len(found.at_s) <= (40 if by_batch else 7)
    if at == 0:
        assert found.failed == (64,) * len(found.at_s)
        return
    last = max(time_s for time_s, failed in zip(found.at_s, found.failed, strict=True) if failed < 64)
    following = min((time_s for time_s in found.at_s if time_s > last), default=5.0)
    assert last < at / 100 <= following
    assert following - last <= (0.011 if by_batch else 0.16)


@pytest.mark.slow
def test_batch_and_branches_count_the_same_continuations_which_their_key_repeats(
    short: RunSpec, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(decision, "CONTINUATIONS", 4)
    monkeypatch.setattr(decision, "_INSTANTS", 2)
    monkeypatch.setattr(decision, "_BY_BATCH", 2)
    monkeypatch.setattr(decision, "_BY_BRANCHES", 2)
    scores = scores_that_violate([NEAR], short.load())
    by_batch = find_decision(short, 5.0, violates, scores)
    by_branches = find_decision(short, 5.0, violates)
    ours, theirs = (dict(zip(one.at_s, one.failed, strict=True)) for one in (by_batch, by_branches))
    shared = sorted(ours.keys() & theirs.keys())
    assert len(shared) >= 2
    assert [ours[at_s] for at_s in shared] == [theirs[at_s] for at_s in shared]
    at_s = shared[0]
    # Seed 1 is the run's own.
    changed = [(*short.settings, f"noise_from=[{at_s}, {seed}]") for seed in range(2, 6)]
    runs = [replace(short, settings=one) for one in changed]
    assert sum(violates(unrecorded_run(one.load(), one)) for one in runs) == ours[at_s]
    assert 0 < sum(by_batch.failed) < 4 * len(by_batch.failed)


@pytest.mark.slow
def test_a_recorded_run_without_faults_says_when_it_was_decided(short: RunSpec, tmp_path: Path) -> None:
    (tmp_path / "near.toml").write_text(f'[[requirement]]\nid = "NEAR"\nsays = "{NEAR.says}"\n')
    words = ("--requirements", tmp_path / "near.toml", "--out", tmp_path / "run", "--no-return")
    limits = ("--set", "plan.stop_error_max_m=1", "--set", "plan.time_error_max_s=1")
    done = railhil("run", *short.words, *limits, *words)
    assert done.exit_code == 1, done.out
    record = checked_record(str(tmp_path / "run"), None)
    found = decision_of(record)
    assert found.runs == 64
    assert 0 < found.failed[0] < 64
    assert lost_sentence(record) == found.sentence
    assert found.sentence in done.out
    assert found.sentence in (tmp_path / "run/report.html").read_text()
    told = railhil("branch", tmp_path / "run", "--no-return", "--json")
    assert json.loads(told.out) == {"runs": 64, "at_s": [*found.at_s], "failed": [*found.failed]}


def test_a_run_that_takes_no_noise_has_no_decision(short: RunSpec, tmp_path: Path) -> None:
    changed = replace(short, settings=("noise_from=[1, 2]",))
    for spec in (changed, RunSpec("yizhuang_stop")):
        with pytest.raises(InputError, match="expected a run that can be given noise, and does not change it"):
            find_decision(spec, 4.0, violates)
    run = record_run(
        replace(changed, settings=(*changed.settings, "plan.time_error_max_s=0.001"), out=tmp_path / "run")
    )
    assert run.verdict == "FAIL"
    assert lost_sentence(checked_record(str(run.place), None)) == ""
