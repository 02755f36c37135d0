"""From the runs of a campaign to its summary: tables, worst runs, comparisons, parts; all from made-up runs."""

from __future__ import annotations

import io
import json
import math
import shlex
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest
from rich.console import Console

from railhil.campaign.plan import Request, make_plan
from railhil.campaign.rows import schema, table_of
from railhil.campaign.show import _against, _scores, lines
from railhil.campaign.summary import summary
from railhil.campaign.worst import worst_runs
from railhil.common.output import Output
from railhil.systems.ato.judge.judging import JUDGING


def made_result(seeds, stop_m, time_s, overspeed_mps=0.0, wraps=0):
    """A result of the shape of ``railhil.batch.Batch``, signed errors given, NaN for no stop."""
    stop, time = np.asarray(stop_m, dtype=float), np.asarray(time_s, dtype=float)
    full = np.ones(len(stop))
    stopped = ~np.isnan(stop)
    return SimpleNamespace(
        seed=np.array(list(seeds)),
        values={
            "itae": 2000 * full,
            "energy_kj": 70_000 * full,
            "punctuality_s": abs(time),
            "stop_error_m": abs(stop),
            "comfort": 1.5 * full,
        },
        signed={"time_error_s": time, "stop_error_m": stop},
        extras={"overspeed_mps": overspeed_mps * full},
        verdicts=tuple("PASS" if one else "FAIL" for one in stopped & (abs(stop) <= 0.2)),
        ended=tuple("ended_complete" if one else "ended_not_stopped" for one in stopped),
        failures=tuple(() if one else ("not stopped",) for one in stopped),
        wraps=wraps * np.ones(len(stop), dtype=int),
        saturations=np.zeros(len(stop), dtype=int),
        zero_divisions=np.zeros(len(stop), dtype=int),
        digest=("0" * 16,) * len(stop),
    )


@pytest.fixture(scope="module")
def tuned(tmp_path_factory):
    file = tmp_path_factory.mktemp("parameters") / "tuned.toml"
    file.write_text('law = "ipfc"\n[parameters]\n[training]\nscenario = "lvshun_tieshan"\nseeds = [1003, 5]\n')
    return file


@pytest.fixture(scope="module")
def plan(tuned):
    return make_plan(Request(runs=20, both=True, parameters=(str(tuned),), allow_training_seeds=True))


@pytest.fixture(scope="module")
def results(plan):
    """``ipfc`` with errors that grow with the seed; the other entry 0.05 m better, but it fails to stop once."""
    own, other = plan.entries
    grows = np.arange(20) / 100
    better = np.abs(grows - 0.05)
    better[7] = np.nan
    in_time = np.full(20, 0.1)
    in_time[7] = np.nan
    tables = [
        table_of(own.label, made_result(plan.seeds, -grows, np.full(20, 0.2), wraps=1), plan.training(own), JUDGING),
        table_of(
            other.label, made_result(plan.seeds, better, in_time, overspeed_mps=0.3), plan.training(other), JUDGING
        ),
    ]
    return pa.concat_tables(tables)


def test_summary(plan, results):
    found = summary(plan, results)
    own, other = (found["laws"][entry.label] for entry in plan.entries)
    assert own["scores"]["stop_error_m"]["median"]["value"] == pytest.approx(0.095)
    assert own["scores"]["stop_error_m"]["median"]["interval"] == [0.05, 0.14]
    assert own["scores"]["stop_error_m"]["p95"]["interval"][1] is None
    assert own["inside"]["both"] == {"runs": 20, "share": 1.0, "interval": [pytest.approx(0.8316, abs=1e-4), 1.0]}
    assert (own["not_stopped"], other["not_stopped"]) == (0, 1)
    assert (own["overspeeds"], other["overspeeds"]) == (0, 20)
    assert (own["wraps"], own["runs_with_wraps"], other["wraps"]) == (20, 20, 0)
    assert other["inside"]["stop_limit"]["runs"] == 19
    counts = [[found["runs"] for found in law["stopped_within_m"].values()] for law in (own, other)]
    assert (list(own["stopped_within_m"]), counts) == (["0.1", "0.2", "0.3"], [[11, 20, 20], [15, 19, 19]])
    assert own["stopped_within_m"]["0.1"]["share"] == 0.55
    assert found["baseline"] == "ipfc"
    (against,) = found["against_baseline"].values()
    assert against["punctuality_s"]["better"]["runs"] == 19
    assert against["punctuality_s"]["median_difference"]["value"] == pytest.approx(-0.1)
    assert against["comfort"]["equal_runs"] == 20


def test_infinite_values_and_bounds_that_are_not_there_are_told_apart(plan):
    own, other = plan.entries
    errors = np.full(20, 0.1)
    unstopped = np.full(20, math.nan)

    def found(own_m, other_m):
        tables = [
            table_of(own.label, made_result(plan.seeds, own_m, own_m), (), JUDGING),
            table_of(other.label, made_result(plan.seeds, other_m, other_m), (), JUDGING),
        ]
        document = summary(plan, pa.concat_tables(tables))
        json.dumps(document, allow_nan=False)
        printed = Console(file=io.StringIO(), width=200)
        for made in (_scores(document, JUDGING.criteria), _against(document, JUDGING.criteria)):
            printed.print(made)
        law = document["laws"][other.label]["scores"]["stop_error_m"]
        return law, document["against_baseline"][other.label]["stop_error_m"], printed.file.getvalue()

    law, against, shown = found(errors, unstopped)
    assert law["median"] == {"value": "inf", "interval": ["inf", "inf"]}
    assert law["p95"] == {"value": "inf", "interval": ["inf", None]}
    assert against["median_difference"] == {"value": "inf", "interval": ["inf", "inf"]}
    assert "did not stop" in shown
    assert "inf..inf" in shown
    assert "inf..-" in shown
    assert "+inf" in shown
    law, against, shown = found(unstopped, errors)
    assert law["p95"] == {"value": 0.1, "interval": [0.1, None]}
    assert against["median_difference"] == {"value": "-inf", "interval": ["-inf", "-inf"]}
    assert "-inf..-inf" in shown


def test_training_seeds_are_said_in_every_table(plan, results):
    (warning,) = summary(plan, results)["warnings"]
    assert "NOT AN EVALUATION" in warning
    assert "1 of 20 runs" in warning
    other = plan.entries[1].label
    trained = [(row["law"], row["seed"]) for row in results.to_pylist() if row["training"]]
    assert trained == [(other, 1003)]


def test_the_terminal_says_how_many_runs_stopped_within_strict_figures(plan, results, tmp_path, capsys):
    """Whatever the scenario allows: 11, 20 and 20 of 20 runs, 15, 19 and 19 with the parameters of the file."""
    Output().show(lines(plan, summary(plan, results), tmp_path))
    printed = capsys.readouterr().out.split("Runs that stopped within")[1].split("Against")[0]
    assert printed.split()[:4] == ["law", "0.1", "m", "0.2"]
    shares = [word for word in printed.split() if word.endswith("%")]
    assert shares == ["55.00%", "100.00%", "100.00%", "75.00%", "95.00%", "95.00%"]


def test_a_weakened_watch_is_said_in_every_table(tmp_path, capsys):
    settings = ("watch.emergency_ms=100000", "watch.overspeed_margin_kmh=1e7")
    plan = make_plan(Request(runs=2, settings=settings))
    made = table_of("ipfc", made_result(plan.seeds, [0.1, 0.1], [0.1, 0.1]), (), JUDGING)
    found = summary(plan, made)
    words = "emergency_ms 100000 (usual 1000), overspeed_margin_kmh 1e+07 (usual 5)"
    assert (found["warnings"], found["watch_weakened"]) == ([f"watch weakened: {words}"], words)
    Output().show(lines(plan, found, tmp_path))
    assert capsys.readouterr().out.splitlines().count(f"watch weakened: {words}") == 3


def test_training_seeds_are_refused(tuned):
    with pytest.raises(Exception, match=r"tuned\.toml: training\.seeds: seed 1003, on which .* tuned, expected"):
        make_plan(Request(runs=20, parameters=(str(tuned),)))
    assert make_plan(Request(runs=3, parameters=(str(tuned),))).entries[0].label.startswith("ipfc+")


def test_worst_runs_and_their_commands(plan, results, tuned):
    own, other = plan.entries
    rows = results.slice(0, 20)
    found = worst_runs(plan, own, rows)
    assert [(run["seed"], run["why"]) for run in found[:3]] == [
        (1019, ["stop error 1"]),
        (1018, ["stop error 2"]),
        (1017, ["stop error 3"]),
    ]
    # Equal time errors: the lowest seeds.
    assert [run["seed"] for run in found if any("time error" in why for why in run["why"])] == [1000, 1001, 1002]
    assert [run["seed"] for run in found if "wraps" in run["why"]] == [1000, 1001, 1002, 1003, 1004]
    assert found[0]["stop_error_m"] == -0.19
    broken = worst_runs(plan, other, results.slice(20))
    assert sum("overspeed" in run["why"] for run in broken) == 5
    unstopped = next(run for run in broken if "did not stop" in run["why"])
    assert unstopped["seed"] == 1007
    assert unstopped["stop_error_m"] is None
    assert shlex.split(unstopped["command"]) == (
        "railhil run lvshun_tieshan --controller ipfc --arithmetic float64 --indexing time "
        f"--parameters {tuned} --seed 1007 --pace lockstep --perturbed"
    ).split(" ")


def test_no_failure_crowds_out_another(plan):
    own = plan.entries[0]
    stop_m = np.full(20, math.nan)
    stop_m[15:] = 0.1
    over = np.zeros(20)
    over[16:19] = 0.1, 0.3, 0.2
    rows = table_of(own.label, made_result(plan.seeds, stop_m, stop_m, over, wraps=np.arange(20) // 19), (), JUDGING)
    why = {run["seed"]: set(run["why"]) for run in worst_runs(plan, own, rows)}
    assert [seed for seed in why if "did not stop" in why[seed]] == [1000, 1001, 1002, 1003, 1004]
    assert [seed for seed in why if "overspeed" in why[seed]] == [1016, 1017, 1018]
    assert [seed for seed in why if "wraps" in why[seed]] == [1019]
    assert [run["seed"] for run in worst_runs(plan, own, rows) if run["why"] == ["overspeed"]] == [1018]


def test_missing_values_are_null(results):
    assert results.schema.equals(schema(JUDGING))
    row = next(row for row in results.to_pylist() if row["ended"] == "ended_not_stopped")
    assert row["stop_error_m"] is row["signed_time_error_s"] is None
    assert row["itae"] == 2000
