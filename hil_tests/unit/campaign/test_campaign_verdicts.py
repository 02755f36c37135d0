"""PASS share, failures, limits and worst runs of a campaign come from one verdict per run, in every system."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from rich.console import Console

from railhil.campaign.plan import Plan, Request, make_plan
from railhil.campaign.report import page
from railhil.campaign.rows import table_of
from railhil.campaign.show import _inside, _scores, lines
from railhil.campaign.summary import summary
from railhil.common.output import Output
from railhil.judge.score import Score
from railhil.judge.stops import PlannedStop, ScoredStop, Standstill
from railhil.study.execute import Outcome


def made(
    plan: Plan,
    values: dict[str, Any],
    failures: list[tuple[str, ...]],
    verdicts: Sequence[str] = (),
    scores: Sequence[Score] = (),
) -> pa.Table:
    """Runs with these values by criterion (0.5 of all others), failures and verdicts (by the failures if empty).

    :param scores: of a system whose campaigns note more than the values.
    """
    runs = len(failures)
    every = {one.key: np.full(runs, 0.5) for one in plan.criteria} | {
        key: np.array(column, dtype=float) for key, column in values.items()
    }
    result = SimpleNamespace(
        seed=np.arange(1000, 1000 + runs),
        scores=tuple(scores or (Score("PASS", {}, {}, (), "ended_complete"),) * runs),
        values=every,
        signed={one.signed: every[one.key] for one in plan.criteria if one.signed},
        extras={extra.key: np.zeros(runs) for extra in plan.judging.extras},
        verdicts=tuple(verdicts or ("FAIL" if one else "PASS" for one in failures)),
        ended=("ended_complete",) * runs,
        failures=tuple(failures),
        digest=("0" * 16,) * runs,
        **{name: np.zeros(runs, dtype=int) for name in ("wraps", "saturations", "zero_divisions")},
    )
    return table_of(plan.entries[0].label, result, (), plan.judging)


def printed(*tables: Any) -> str:
    console = Console(file=io.StringIO(), width=200)
    for one in tables:
        console.print(one)
    return console.file.getvalue()  # type: ignore[attr-defined, no-any-return]


def test_runs_of_the_system_stop_that_did_not_stop_are_counted_and_listed(tmp_path: Any, capsys: Any) -> None:
    plan = make_plan(Request("yizhuang_stop", runs=20))
    nothing = [np.nan] * 13 + [0.1] * 7
    failures = [("the train did not stop",)] * 13 + [()] * 7
    found = summary(plan, made(plan, {"stop_error_m": nothing, "overshoot_m": nothing}, failures))
    (law,) = found["laws"].values()
    assert (law["not_stopped"], law["inside"]["pass"]["runs"]) == (13, 7)
    assert law["inside"]["stop_limit"]["runs"] == law["stopped_within_m"]["0.3"]["runs"] == 7
    assert law["failures"] == {"the train did not stop": 13}
    listed = [run["seed"] for run in law["worst"] if "did not stop" in run["why"]]
    assert listed == [1000, 1001, 1002, 1003, 1004]
    Output().show(lines(plan, found, tmp_path))
    text = capsys.readouterr().out
    assert "FAIL in 13 of 20 runs: the train did not stop (13)" in text
    assert "did not stop: FAIL: the train did not stop" in text


def test_a_score_that_does_not_apply_is_no_failure() -> None:
    """No run of hst_short arrives or has an emergency."""
    plan = make_plan(Request("hst_short", runs=4))
    keys = ("arrival_m", "emergency_rmse_kmh", "emergency_stop_m")
    found = summary(plan, made(plan, {key: [np.nan] * 4 for key in keys}, [()] * 4))
    (law,) = found["laws"].values()
    assert [law["scores"][key]["median"]["value"] for key in keys] == [None] * 3
    assert "not_stopped" not in law
    assert list(found["limits"]) == ["rmse_kmh"]
    assert "did not stop" not in printed(_scores(found, plan.criteria), _inside(found, plan.judging))


def test_the_limit_of_an_emergency_is_among_the_limits() -> None:
    plan = make_plan(Request("jinan_xuzhou_emergency", ("task.emergency_stop_max_m=4398.1",), runs=6))
    stops_m = [4398.3, 4397.0, 4398.5, 4397.0, 4398.11, 4397.0]
    failures = [(f"emergency stop {one} m, allowed at most 4398.1 m",) if one > 4398.1 else () for one in stops_m]
    found = summary(plan, made(plan, {"emergency_stop_m": stops_m}, failures))
    (law,) = found["laws"].values()
    assert law["inside"]["both"]["runs"] == law["inside"]["pass"]["runs"] == 3
    assert {1000, 1002, 1004} <= {run["seed"] for run in law["worst"]}


def test_every_kind_of_failure_has_its_runs_among_the_worst() -> None:
    """Also those that no score shows."""
    plan = make_plan(Request("yizhuang_stop", runs=20))
    failures: list[tuple[str, ...]] = [()] * 20
    for place in (8, 9):
        failures[place] = (f"the train acted by itself from {place}.25 s (the brake does not answer)",)
    errors_m = [0.2, 0.19, 0.18] + [0.0] * 17
    found = summary(plan, made(plan, {"stop_error_m": errors_m}, failures))
    (law,) = found["laws"].values()
    assert law["inside"]["all_limits"]["runs"] == 20
    assert law["failures"] == {"the train acted by itself from N s (the brake does not answer)": 2}
    assert [run["seed"] for run in law["worst"]] == [1000, 1001, 1002, 1008, 1009]


def test_one_failure_in_twenty_thousand_is_not_a_hundred_per_cent() -> None:
    plan = make_plan(Request("yizhuang_stop", runs=20_001))
    found = summary(plan, made(plan, {}, [("x",)] + [()] * 20_000))
    assert "99.995%" in printed(_inside(found, plan.judging))


def test_a_run_that_says_nothing_about_the_law_is_no_failure(tmp_path: Any, capsys: Any) -> None:
    plan = make_plan(Request("yizhuang_stop", runs=4))
    never = "fault 1 never began: TRN_SPEED loss 30% @90s for 5s"
    failures = [(), ("x",), (never,), ()]
    found = summary(plan, made(plan, {}, failures, ["PASS", "FAIL", "INVALID", "PASS"]))
    (law,) = found["laws"].values()
    assert law["failures"] == {"x": 1}
    assert law["invalid"]["runs"] == sum(law["invalid"]["reasons"].values()) == 1
    assert law["inside"]["pass"]["runs"] == 2
    Output().show(lines(plan, found, tmp_path))
    text = capsys.readouterr().out
    assert "FAIL in 1 of 4 runs: x (1)" in text
    assert "INVALID in 1 of 4 runs: fault N never began" in text
    assert f"INVALID: {never}" in text
    # Without such a run nothing of it is said.
    found = summary(plan, made(plan, {}, [(), ("x",), (), ()]))
    assert "invalid" not in next(iter(found["laws"].values()))
    Output().show(lines(plan, found, tmp_path))
    assert "INVALID" not in capsys.readouterr().out


def test_a_score_of_which_more_is_better_and_that_no_run_has_is_said_in_words() -> None:
    plan = make_plan(Request("four_stops", ("perturbations.mass_factor=[1, 1]",), runs=4))
    found = summary(plan, made(plan, {"recovered_s": [np.nan] * 4}, [()] * 4))
    assert "no value" in printed(_scores(found, plan.criteria))


def test_the_worst_stop_of_each_run_is_a_column_and_is_counted_by_its_name(tmp_path: Path, capsys: Any) -> None:
    plan = make_plan(Request("four_stops_perturbed", runs=4))

    def scored(*errors_m: float) -> Score:
        planned = (PlannedStop("2 B", 1200.0, 0.3), PlannedStop("4 D", 3420.0, 0.3))
        stops = [
            ScoredStop(stop, Standstill(1.0, stop.target_m + error_m))
            for stop, error_m in zip(planned, errors_m, strict=False)
        ]
        return Score("PASS", {}, {}, (), "ended_complete", stops=tuple(stops))

    scores = [scored(0.01, -0.05), scored(0.2, 0.1), scored(-0.02, 0.04), scored()]
    table = made(plan, {}, [()] * 4, scores=scores)
    assert table["worst_stop"].to_pylist() == ["4 D", "2 B", "4 D", None]
    assert table["worst_stop_error_m"].to_pylist()[:3] == pytest.approx([-0.05, 0.2, 0.04])
    found = summary(plan, table)
    (law,) = found["laws"].values()
    assert [(one["name"], one["runs"]) for one in law["worst_stop"]] == [("4 D", 2), ("2 B", 1)]
    assert [one["worst_stop_error_m"] for one in law["worst_stop"]] == pytest.approx([-0.05, 0.2])
    Output().show(lines(plan, found, tmp_path))
    text = capsys.readouterr().out
    assert "Runs by their worst stop" in text
    assert "worst stop 2 B +0.2000 m" in text
    written = page(plan, Outcome(tmp_path, table, found), "")
    assert "Runs by their worst stop" in written
    assert re.search(r">4 D</td><td[^>]*>2</td><td[^>]*>-0.0500<", written)


def test_a_system_without_a_worst_stop_has_no_such_column() -> None:
    plan = make_plan(Request("yizhuang_stop", runs=2))
    assert "worst_stop" not in made(plan, {}, [()] * 2).column_names
