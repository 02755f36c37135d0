"""A probability as a function, and its result."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import railhil
from hil_tests.support.cli import railhil as command
from hil_tests.unit.probability.test_probability import STOP, MadeUpBench
from hil_tests.unit.probability.test_probability import bench as bench  # a fixture
from railhil.campaign.study import CAMPAIGN
from railhil.hunt.study import HUNT
from railhil.probability.outcome import ProbabilityOutcome
from railhil.probability.study import PROBABILITY
from railhil.record.hash_list import DOCUMENTS, write_hash_list
from railhil.sequences.study import LEARN

SHORT: dict[str, Any] = {"says": STOP, "controller": "ipfc_plus_stop", "points": 500, "accuracy": 0.4, "seed": 3}


@pytest.fixture
def found(bench: MadeUpBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ProbabilityOutcome:
    # Made-up runs are of this process only.
    monkeypatch.setattr("railhil.study.call.running", in_this_process)
    return railhil.probability("lvshun_tieshan", **SHORT, out=tmp_path / "p")


def in_this_process(name: str, say: Any, jobs: int | None) -> Any:
    from contextlib import nullcontext

    from hil_tests.unit.probability.test_probability import straight

    return nullcontext(straight)


def test_the_result_has_the_probability_its_interval_causes_and_least_disturbance(
    found: ProbabilityOutcome, bench: MadeUpBench, tmp_path: Path
) -> None:
    assert found.folder == tmp_path / "p"
    assert found.low is not None
    assert found.high is not None
    assert found.low < bench.linear.p < found.high
    assert found.low < found.p < found.high
    assert found.is_resolved
    assert found.unresolved_below < found.p
    assert len(found.repetitions) >= 10
    assert found.p == pytest.approx(sum(found.repetitions) / len(found.repetitions))
    assert [*found.causes][2] == "noise"
    assert found.causes["mass factor"] == pytest.approx(0.5, abs=0.05)
    assert [*found.causes.values()] == sorted(found.causes.values(), reverse=True)
    assert found.least is not None
    assert found.least.file == tmp_path / "p/least.toml"
    assert found.least.file.is_file()
    assert found.least.size == pytest.approx(4.0, abs=0.03)
    assert [*found.least.draws] == ["mass factor", "balise 1"]
    assert sum(draw**2 for draw in found.least.draws.values()) ** 0.5 == pytest.approx(found.least.size)
    assert repr(found).startswith(f'<P(not "{STOP}") = ')
    assert "causes of the margin" in found._repr_html_()
    document = json.loads((found.folder / "summary.json").read_text(encoding="utf-8"))
    assert (document["p"], document["runs"]) == (found.p, found.runs)


def test_a_finished_study_is_read_and_makes_no_run_again(
    found: ProbabilityOutcome, bench: MadeUpBench, tmp_path: Path
) -> None:
    again = railhil.probability("lvshun_tieshan", **SHORT, out=tmp_path / "p")
    assert (again.p, again.low, again.high, again.causes, again.least) == (
        found.p, found.low, found.high, found.causes, found.least,
    )  # fmt: skip


def test_without_a_violation_there_is_no_interval_and_no_least_disturbance(
    bench: MadeUpBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.flat = True
    monkeypatch.setattr("railhil.study.call.running", in_this_process)
    found = railhil.probability("lvshun_tieshan", **SHORT, method="brute", max_runs=5000, out=tmp_path / "p")
    assert (found.p, found.low, found.high, found.least, found.is_resolved) == (0, None, None, None, False)
    assert "no interval" in repr(found)
    assert found.repetitions == ()
    text = (tmp_path / "p/report.html").read_text(encoding="utf-8")
    assert "no violation found" in text
    assert '<figure id="repetitions">' not in text
    assert '<figure id="levels">' not in text


def test_an_unfinished_study_has_no_page(found: ProbabilityOutcome, tmp_path: Path) -> None:
    (tmp_path / "p/summary.json").unlink()
    write_hash_list(tmp_path / "p")
    done = command("report", tmp_path / "p")
    assert done.exit_code == 2
    assert "has no summary.json" in done.one_line()


def test_the_page_has_levels_repetitions_and_causes_and_is_written_again_from_the_folder(
    found: ProbabilityOutcome, tmp_path: Path
) -> None:
    written = (tmp_path / "p/report.html").read_bytes()
    text = written.decode()
    for name in ("levels", "repetitions", "causes"):
        assert f'<figure id="{name}">' in text
    assert "mass factor: " in text
    assert re.search(r"Recorded [-\d]{10} [:\d]{5} UTC on .* with railhil ", text)
    assert f"P = {found.p:.2g}" in text
    assert "http" not in text.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")
    done = command("report", tmp_path / "p", "--out", tmp_path / "again.html")
    assert done.exit_code == 0, done.err
    assert (tmp_path / "again.html").read_bytes() == written
    assert command("verify", tmp_path / "p").exit_code == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({}, "railhil.probability: requirement, says: one of them is needed"),
        ({"says": 5}, "railhil.probability: says: found 5, allowed a text"),
        ({"says": STOP, "accuracy": 0.0}, "railhil.probability: accuracy: found 0.0"),
        ({"says": STOP, "max_runs": 5}, "railhil.probability: max_runs: found 5"),
        ({"says": STOP, "method": "best"}, "railhil.probability: method: found 'best'"),
        ({"says": STOP, "jobs": 0}, "railhil.probability: jobs: found 0"),
        ({"says": STOP, "controller": "nobody"}, "railhil.probability: controller: found 'nobody'"),
        ({"requirement": "ATO-99"}, "railhil.probability: requirement: found 'ATO-99'"),
    ],
)
def test_bad_arguments_are_refused_in_the_words_of_the_call(arguments: dict[str, Any], said: str) -> None:
    with pytest.raises(railhil.InputError) as refused:
        railhil.probability("lvshun_tieshan", **arguments)
    assert str(refused.value).startswith(said)


@pytest.mark.parametrize("study", [CAMPAIGN, HUNT, PROBABILITY, LEARN], ids=lambda study: study.name)
def test_the_folder_of_every_study_is_known_to_verify(study: Any) -> None:
    assert study.manifest in DOCUMENTS
