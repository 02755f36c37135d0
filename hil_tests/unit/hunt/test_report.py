"""The page of a hunt: the least case with its sentence, its figures, and the instant up to which it can be saved."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import pytest

from hil_tests.support.browser import TEXTS_OF_CHARTS, asked
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.hunt.found import FOUND, PASSING, WITHOUT, write_found
from railhil.hunt.least import Least, ShrinkTask
from railhil.hunt.oracle import run_case
from railhil.hunt.plan import Plan, Request, make_plan
from railhil.hunt.report import page
from railhil.hunt.shrink import Shrunk
from railhil.study.execute import Outcome

T = TypeVar("T")
R = TypeVar("R")
pytestmark = pytest.mark.slow
SAYS = "whenever age(TRN_SPEED) > 20 ms, within 60 ms train_level >= service_brake, until good(TRN_SPEED) >= 5"
LEAST = ("TRN_SPEED loss @2s for 100ms", "TRN_POS loss @1.9s for 1s")


@contextmanager
def straight(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
    yield enumerate(map(work, items))


@pytest.fixture(scope="module")
def hunted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Plan, dict[str, Any], Path]:
    """A hunt with one least case, whose search is made up and whose runs are made."""
    folder = tmp_path_factory.mktemp("hunt")
    (folder / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    (folder / "mine.toml").write_text(
        f'[[requirement]]\nid = "SPEED"\nsays = "{SAYS}"\ntitle = "<b>loss</b>"\n', encoding="utf-8"
    )
    plan = make_plan(Request(str(folder / "short.toml"), requirements=(str(folder / "mine.toml"),), runs=8))
    case = run_case(plan.base, plan.requirements, LEAST, 0)
    task = ShrinkTask(plan.base, plan.requirements, "SPEED", 3, LEAST, 0, 4.0, True)
    passing = ("TRN_SPEED loss @2s for 20ms", LEAST[1])
    least = Least(task, Shrunk(LEAST, 0, 12, 2), (), case.violated["SPEED"], case.frames_sha256, passing)
    found = write_found(plan, folder / FOUND, [least], straight)
    requirement = {"id": "SPEED", "says": SAYS, "verdict": "violated", "runs": 7, "antecedent_met": 3, "margin": -3.0}
    summary = {
        "scenario": "short", "scenario_sha256": "5" * 64, "code_sha256": "c" * 64, "seed": 0, "runs": 8, "valid": 7,
        "with_idle_faults": 1, "cells": ["a"], "last_new_cell": 3, "found": found,
        "strategies": {"swarm": {"runs": 8, "valid": 7, "first_violation": 3}},
        "requirements": [{**requirement, "unit": "level", "slack": None, "violations": 2, "said": "x", "first": 3}],
    }  # fmt: skip
    return plan, summary, folder


def page_with(hunted: tuple[Plan, dict[str, Any], Path], **changes: Any) -> str:
    """The page with other entries of the least case."""
    plan, summary, folder = hunted
    return page(plan, Outcome(folder, None, {**summary, "found": [{**summary["found"][0], **changes}]}), "")


def test_beside_a_least_case_stand_the_run_without_its_faults_and_the_nearest_that_passes(
    hunted: tuple[Plan, dict[str, Any], Path],
) -> None:
    _, summary, folder = hunted
    (case,) = summary["found"]
    assert case["is_repeatable"]
    for ending, faults in (("", []), (WITHOUT, []), (PASSING, list(case["passing"]))):
        certificate = json.loads((folder / FOUND / ("SPEED-1" + ending) / "certificate.json").read_text())
        assert certificate["faults"] == faults
    no_return = case["no_return"]
    assert 1.9 <= no_return["saved_s"] < no_return["lost_s"] == pytest.approx(no_return["saved_s"] + 0.01)
    assert no_return["branches"] >= 3


def test_the_page_marks_the_part_that_fails_and_says_up_to_when_the_run_can_be_saved(
    hunted: tuple[Plan, dict[str, Any], Path],
) -> None:
    plan, summary, folder = hunted
    text = page(plan, Outcome(folder, None, summary), "")
    assert text == page(plan, Outcome(folder, None, summary), "")
    assert '<mark class="fails">train_level &gt;= service_brake</mark>' in text
    assert '<span class="given">age(TRN_SPEED) &gt; 20 ms</span>' in text
    assert "<b>loss</b>" not in text
    assert "<th>Draws</th>" not in text
    no_return = summary["found"][0]["no_return"]
    said = f"at {no_return['saved_s']:g} s still saves the run, at {no_return['lost_s']:g} s not"
    assert said in text
    assert "Not found is not absence: 8 runs with this seed." in text
    for title in ("age(TRN_SPEED) (ms); limit 20 ms", "train_level; limit service_brake", "level: case",
                  "level: nearest that passes", "level: without the faults"):  # fmt: skip
        assert text.count(f"<b>{title}</b>") == 2, title
    assert text.count('class="fault"') > 4


def test_a_case_without_faults_says_from_what_its_draws_were_shrunk_and_has_no_strip_of_faults(
    hunted: tuple[Plan, dict[str, Any], Path],
) -> None:
    # Its only run is that without faults.
    least = {"name": f"SPEED-1{WITHOUT}", "faults": [], "draws": [0.0, 0.6, 0.8]}
    text = page_with(hunted, **least, **{"from": {"faults": [], "draws": [-2.0, 2.0, 1.0]}})
    assert "<th>Draws</th><td>draws of length 1 (standard deviations), 2 of 3 not 0</td>" in text
    shrunk = "from 3 draws not nominal (length 3) to 2 draws not nominal (length 1)"
    assert f"<td>in case 3, shrunk in 12 runs {shrunk}</td>" in text
    assert "none: the draws alone violate it" in text
    assert "<b>level: case</b>" in text
    for absent in ("no fault", "<b>faults</b>", "dashed: ", "dotted: "):
        assert absent not in text, absent


def test_a_case_whose_run_was_not_recorded_has_no_figure(hunted: tuple[Plan, dict[str, Any], Path]) -> None:
    text = page_with(hunted, name="SPEED-9")
    assert "not recorded far enough" in text
    assert 'class="chart"' not in text


def test_a_rule_of_every_run_has_no_sentence_and_the_whole_run_as_its_figure(
    hunted: tuple[Plan, dict[str, Any], Path],
) -> None:
    text = page_with(hunted, id="INV-4", says="left too early")
    assert '<p class="says">left too early</p>' in text
    assert text.count('<figure id="SPEED-1-whole">') == 1
    assert "What decides" not in text


@pytest.mark.needs_browser
@pytest.mark.parametrize("width_px", [1200, 560])
def test_page_as_shown(hunted: tuple[Plan, dict[str, Any], Path], tmp_path: Path, width_px: int) -> None:
    plan, summary, folder = hunted
    out = tmp_path / "report.html"
    out.write_text(page(plan, Outcome(folder, None, summary), ""), encoding="utf-8")
    found: dict[str, Any] = asked(out, TEXTS_OF_CHARTS, width_px)
    assert found["fetched"] == []
    assert (found["overlaps"], found["outside"]) == ([], [])
    assert found["beyond"] == 0
    assert found["figures"] >= 7
