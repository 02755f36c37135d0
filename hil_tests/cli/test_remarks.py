"""The lines of a run about its assumptions and the next step: one line each, based on facts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.plug import Wrapping, plug_in
from hil_tests.support.recordings import row_of
from hil_tests.support.scores import made_score
from railhil.cli.result_printer import assumption_lines, next_step
from railhil.dbc import wire_contract
from railhil.judge.record import Record
from railhil.record.notes import WRAP_FAILURE
from railhil.record.trace import Trace
from railhil.systems.ato.scenario.model import Scenario

_STOP = "stop error -0.219 m, allowed +-0.2 m"
_SCORE = made_score("FAIL", 1.0, 1.0, 0.1, -0.219, 1.0, (_STOP,))


def run(scenario: Scenario, *failures: str, verdict: str = "FAIL", **certificate: Any) -> Record:
    said = {"controller": "ipfc", "indexing": "time", "scenario": scenario.name} | certificate
    score = replace(_SCORE, failures=failures or _SCORE.failures, verdict=verdict)
    return row_of(Path("run"), said, scenario, Trace(wire_contract()), score)


def test_assumptions_are_one_line_that_points_at_the_report(lvshun: Scenario, tmp_path: Path) -> None:
    (line,) = assumption_lines(lvshun, "lvshun_tieshan", tmp_path, verbose=False)
    assert f"assumed: {len(lvshun.assumptions)} choices that the scenario names (" in line
    assert "railhil scenarios lvshun_tieshan" in line
    (tmp_path / "report.html").touch()
    assert f"listed in {tmp_path / 'report.html'}" in assumption_lines(lvshun, "", tmp_path, verbose=False)[0]
    assert assumption_lines(lvshun, "", tmp_path, verbose=True) == [f"assumed: {text}" for text in lvshun.assumptions]
    assert assumption_lines(replace(lvshun, assumptions=()), "", tmp_path, verbose=False) == []


@pytest.mark.parametrize(
    ("failures", "certificate", "words"),
    [
        ((_STOP,), {}, ("--controller ipfc_plus", "railhil tune ipfc lvshun_tieshan")),
        ((_STOP,), {"parameters": {"sha256": "0"}}, ("--controller ipfc_plus",)),
        ((_STOP,), {"controller": "of_somebody"}, ("railhil report ",)),
        ((_STOP,), {"controller": "ipfc_plus"}, ("railhil report ",)),
        ((_STOP,), {"indexing": "distance"}, ("railhil report ",)),
        ((_STOP, "emergency brake at 3.00 s"), {}, ("railhil report ",)),
        ((f"{WRAP_FAILURE}, reported at 3 s",), {}, ("railhil audit lvshun_tieshan --controller ipfc ",)),
    ],
)
def test_the_next_step_follows_from_what_went_wrong(
    lvshun: Scenario, tmp_path: Path, failures: tuple[str, ...], certificate: dict[str, Any], words: tuple[str, ...]
) -> None:
    line = next_step(run(lvshun, *failures, **certificate), tmp_path)
    assert line.startswith("next: ")
    assert "\n" not in line
    assert all(word in line for word in words)
    for other in ("--controller ipfc_plus", "railhil tune", "railhil report", "railhil audit"):
        assert any(other in word for word in words) == (other in line)


def test_the_next_step_of_a_law_of_the_user_is_about_that_law(
    lvshun: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the user's line, by its file."""
    plug_in(tmp_path, monkeypatch, mine=Wrapping)
    line = next_step(run(replace(lvshun, name="/lines/own.toml"), _STOP, controller="mine"), tmp_path)
    assert line == "next: railhil tune mine /lines/own.toml, which searches its parameters"


def test_no_advice_without_a_fail_or_on_somebody_elses_controller(lvshun: Scenario, tmp_path: Path) -> None:
    assert next_step(run(lvshun, verdict="PASS"), tmp_path) == ""
    assert next_step(run(lvshun, verdict="INVALID"), tmp_path) == ""
    assert next_step(run(lvshun, foreign=True), tmp_path) == ""
    assert next_step(run(lvshun, attached=True), tmp_path) == ""
