"""Frames that nobody sent change nothing, and runs leave nothing behind: short forms of the programs fuzz and soak."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.fuzz import Fuzzed, differences, fuzzed_run
from hil_tests.soak import State, growth, soaked
from railhil.bench import unrecorded_run
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario

pytestmark = pytest.mark.faults


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    path = tmp_path_factory.mktemp("quick") / "quick.toml"
    path.write_text(QUICK_TOML, encoding="utf-8")
    return load(str(path))


@pytest.fixture(scope="module")
def quiet(quick: Scenario) -> Fuzzed:
    return fuzzed_run(quick, 0, 1)


@pytest.mark.slow
def test_noise_changes_nothing(quick: Scenario, quiet: Fuzzed) -> None:
    fuzzed = fuzzed_run(quick, 20_000, 1)
    assert fuzzed.frames == 20_000
    assert differences(quiet, fuzzed) == []
    # Every cause for which a frame can be refused has occurred, and nothing more was accepted.
    causes = {
        "unknown_id", "wrong_length", "remote_frame", "extended_id", "error_frame", "wrong_master_word",
        "wrong_check_sequence", "missing_block", "assembly_timeout", "wrong_block_count", "no_mailbox",
    }  # fmt: skip
    assert causes <= {cause for cause, count in fuzzed.refused.items() if count > quiet.refused.get(cause, 0)}
    for cause in ("accepted", "polls"):
        assert fuzzed.refused[cause] == quiet.refused[cause]


def test_a_change_is_seen(quiet: Fuzzed) -> None:
    other = replace(
        quiet, genuine_sha256="other", score=replace(quiet.score, verdict="PASS"), answered=["controller answered"]
    )
    found = differences(quiet, other)
    assert found[:2] == ["controller answered", "the genuine frames differ"]
    assert found[2].startswith("the score differs: ")


@pytest.mark.long
def test_runs_leave_nothing_behind(quick: Scenario) -> None:
    assert growth(soaked(lambda: unrecorded_run(quick).frames_sha256, 5)) == []


def test_growth_is_seen() -> None:
    before = State("aa", 50 << 20, 10, 2, 0)
    after = State("bb", 60 << 20, 11, 3, 1)
    assert growth([before, before]) == []
    assert growth([before, after]) == [
        "the records differ", "descriptors: 10, then 11", "threads: 2, then 3", "children: 0, then 1",
        "memory grew by 10.5 MB",
    ]  # fmt: skip
