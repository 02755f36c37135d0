"""The stops of a run, one or several: which standstill counts as which, and where the list is told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.recordings import row_of
from hil_tests.support.scores import made_score
from railhil.cli.result_printer import print_scores
from railhil.common.output import Output
from railhil.dbc import wire_contract
from railhil.judge.folder import junit
from railhil.judge.result import Result
from railhil.judge.score import Score
from railhil.judge.stops import PlannedStop, missed_stops, scored_stops, standstills_of
from railhil.record.trace import Trace
from railhil.report.page import page
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.judge.journey import stop_of
from railhil.systems.ato.scenario.model import Scenario

_TWO = (PlannedStop("Xiaocun", 1000.0, 0.3, 90.0, 5.0), PlannedStop("Xiaohongmen", 2300.0, 0.3))
#: The first within both limits, the second 0.412 m past its point; on the way a signal, and one told twice.
_REACHED = ((60.0, 720.0), (91.5, 1000.1), (91.5, 1000.1), (190.0, 2300.412))


def two_stops() -> Score:
    """A run with two stops, of which the second is missed."""
    stops = scored_stops(_TWO, standstills_of(_REACHED))
    return replace(made_score("FAIL", 1.0, 2.0, 3.0, 4.0, 5.0, tuple(missed_stops(stops))), stops=stops)


@pytest.mark.parametrize(
    ("reached", "kept", "planned"),
    [
        ([], 0, None),
        # A milestone is repeated on the bus.
        ([(195.0, 2940.1), (195.0, 2940.1), (195.5, 2940.1)], 1, 0),
        # A signal on the way, the station, and rolling on from it.
        ([(60.0, 900.0), (195.2, 2939.9), (260.0, 2950.0)], 3, 1),
    ],
)
def test_the_verdict_is_on_the_standstill_that_the_plan_means(
    lvshun: Scenario, reached: Sequence[tuple[float, float]], kept: int, planned: int | None
) -> None:
    assert len(standstills_of(reached)) == kept
    stop = stop_of(lvshun.plan, reached)
    if planned is None:
        assert stop.standstill is stop.late_s is stop.error_m is None
        assert (stop.missed, stop.verdict) == ("not stopped", "FAIL")
    else:
        assert stop.late_s == reached[planned][0] - 195
        assert stop.error_m == reached[planned][1] - 2940


def test_standstills_within_a_millimetre_are_one() -> None:
    for away_m, count in ((0.0, 1), (0.001, 1), (0.001005, 2), (0.5, 2)):
        assert len(standstills_of([(1.0, 0.0), (2.0, away_m)])) == count


def test_a_limit_that_is_just_met_is_not_missed() -> None:
    (stop,) = scored_stops([PlannedStop("here", 0.0, 0.3, 2.0, 0.5)], standstills_of([(2.5, -0.3)]))
    assert (stop.error_m, stop.late_s, stop.verdict) == (-0.3, 0.5, "PASS")


def test_two_stops_of_one_run_are_scored_each_and_the_verdict_names_the_one_that_is_missed() -> None:
    score = two_stops()
    assert score.failures == ("stop Xiaohongmen: +0.412 m (allowed +-0.3 m)",)
    document = score.as_json()["stops"]
    assert document == [
        {
            "name": "Xiaocun", "target_m": 1000.0, "instant_s": 91.5, "position_m": 1000.1,
            "error_m": pytest.approx(0.1), "error_max_m": 0.3, "late_s": 1.5, "late_max_s": 5.0, "verdict": "PASS",
        },
        {
            "name": "Xiaohongmen", "target_m": 2300.0, "instant_s": 190.0, "position_m": 2300.412,
            "error_m": pytest.approx(0.412), "error_max_m": 0.3, "late_s": None, "late_max_s": None, "verdict": "FAIL",
        },
    ]  # fmt: skip


def test_a_stop_that_was_never_made_and_one_that_is_late_are_named() -> None:
    stops = scored_stops(_TWO, standstills_of([(99.0, 999.5)]))
    assert missed_stops(stops) == [
        "stop Xiaocun: -0.500 m (allowed +-0.3 m), arrival +9.000 s (allowed +-5 s)",
        "stop Xiaohongmen: not stopped",
    ]
    assert scored_stops(_TWO, ())[0].as_json()["instant_s"] is None


def test_junit_report_and_console_list_them(lvshun: Scenario, tmp_path: Path) -> None:
    score = two_stops()
    result = Result(lvshun, RunSpec(), Trace(wire_contract()), score, exit_code=1, line=score.failures[0])
    suite = junit(result).getroot()
    cases = {case.get("name"): case.find("failure") for case in suite.iter("testcase")}
    assert cases["stop Xiaocun"] is None
    failure = cases["stop Xiaohongmen"]
    assert failure is not None
    assert failure.get("message") == "+0.412 m (allowed +-0.3 m)"
    html = page([row_of(tmp_path, {}, lvshun, Trace(wire_contract()), score)])
    assert '<h2 id="each-stop">Stops</h2>' in html
    assert '<th>Xiaohongmen <span class="unit">(worst)</span></th><td>2300</td>' in html
    assert "FAIL: +0.412 m (allowed +-0.3 m)" in html


def test_the_console_lists_them(lvshun: Scenario, capsys: pytest.CaptureFixture[str]) -> None:
    print_scores(Output(), lvshun, [("ipfc", two_stops())])
    said = capsys.readouterr().out.splitlines()
    assert said[-2:] == ["ipfc: stop Xiaocun +0.1000 m PASS", "ipfc: stop Xiaohongmen +0.4120 m FAIL"]


def test_one_stop_is_in_the_list_and_needs_no_lines_of_its_own(nominal: Result) -> None:
    (stop,) = nominal.score.stops
    assert (stop.error_m, stop.late_s) == (nominal.score.signed["stop_error_m"], nominal.score.signed["time_error_s"])
    assert stop.verdict == nominal.score.verdict
    assert nominal.score.listed_stops == ()
