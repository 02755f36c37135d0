"""The figures of a run over a line show its record, and nothing that the record does not have."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.line_record import ImaginedRun, record
from railhil.charts.figure import Chart, Curve, Figure
from railhil.charts.svg import markup
from railhil.judge.score import Score
from railhil.scenarios.load import load_any
from railhil.systems.line.panels import pictures
from railhil.systems.line.panels.drawn import DOORS, EXCHANGE, HOLD, DrawnRun
from railhil.systems.line.planned import fold_positions, planned_motion
from railhil.systems.line.scenario.model import LineScenario, RouteSignal
from railhil.wire.line import SignalAspect, StnInfo

_LATE_S = 20.0


@lru_cache
def four_stops() -> LineScenario:
    line = load_any("four_stops")
    assert isinstance(line, LineScenario)
    return replace(line, signals=(RouteSignal(2500.0, 100.0),))


@lru_cache
def imagined() -> ImaginedRun:
    """Departs from the second stop too late, and stops 4 cm short at the last."""
    return ImaginedRun(four_stops(), late_s={1: _LATE_S}, error_m={3: -0.04})


def figure(figures: list[Figure], name: str) -> Figure:
    return next(one for one in figures if one.name == name)


def curve(chart: Chart, label: str) -> Curve:
    return next(one for one in chart.curves if one.label == label)


def test_each_drawn_point_is_one_of_the_record(tmp_path: Path) -> None:
    run = imagined()
    figures = pictures(run.line, [record(run, tmp_path)])
    time_s, place_m = run.trace.times_s("SIM_TRUTH"), run.trace.values("SIM_TRUTH", "TruePos")
    graph, lateness = figure(figures, "train-graph").charts
    drawn = curve(graph, "law")
    np.testing.assert_array_equal(drawn.x, time_s)
    np.testing.assert_array_equal(drawn.y, place_m)
    track = curve(figure(figures, "speed").charts[0], "law")
    np.testing.assert_array_equal(track.x, place_m)
    np.testing.assert_array_equal(track.y, run.trace.values("SIM_TRUTH", "TrueSpeed") * 3.6)
    told = set(np.round(run.trace.values("ATP_LIM", "PermittedSpeed") * 3.6, 9))
    permitted = curve(figure(figures, "speed").charts[0], "P").y
    assert set(np.round(permitted[np.isfinite(permitted)], 9)) <= told
    # Late from the departure at the second stop to the last arrival, as far as it is.
    steps = curve(lateness, "law")
    (_, _, departed_s, _), (_, arrived_s, _, _) = run.stays[1:]
    assert steps.y[steps.x == departed_s].tolist() == [pytest.approx(departed_s - 167.0)]
    assert steps.y[steps.x == arrived_s].tolist() == [pytest.approx(arrived_s - 340.0)]
    (band,) = graph.bands
    late_s = band.x[np.isfinite(band.low)]
    assert (late_s.min(), late_s.max()) == pytest.approx((167.5, arrived_s), abs=3.0)
    assert [point.x for point in figure(figures, "stop-errors").charts[0].points] == pytest.approx([0.0, -0.04])
    bars = [area for area in figure(figures, "energy").charts[0].areas if area.label == "traction"]
    assert [area.x for area in bars] == [(0.0, 51.0), (0.0, 53.0)]
    (red,) = (area for area in graph.areas if area.kind == "fault")
    assert (red.x, red.y) == ((0.0, 100.0), (2500.0, 2500.0))
    assert list(graph.y_names.values()) == ["A", "B", "C", "D"]


def test_the_parts_of_a_stop_follow_each_other_without_a_gap(tmp_path: Path) -> None:
    run = imagined()
    drawn = DrawnRun("law", None, 0, run.line, record(run, tmp_path))  # type: ignore[arg-type]
    spells = [spell for spell in drawn.spells() if spell.stop == 2]
    assert [spell.kind for spell in spells] == [DOORS, EXCHANGE, HOLD, DOORS]
    for before, after in pairwise(spells):
        assert before.until_s == after.begun_s
    _, arrived_s, departed_s, _ = run.stays[1]
    # Two ports tell it, with 80 ms and 160 ms.
    assert (spells[0].begun_s, spells[-1].until_s) == pytest.approx((arrived_s, departed_s), abs=0.25)
    assert {spell.stop for spell in drawn.spells()} == {1, 2, 4}


@pytest.mark.parametrize("until_s", [5.0, 60.0, 137.5, 200.0, 250.0])
def test_a_run_that_broke_off_is_drawn_as_far_as_it_went(until_s: float, tmp_path: Path) -> None:
    run = ImaginedRun(four_stops(), until_s=until_s)
    broken = record(run, tmp_path).copy_with(
        label="law", score=Score("INVALID", {}, {}, ("run record_incomplete",), "record_incomplete"), events=()
    )
    figures = pictures(run.line, [broken])
    assert [one.name for one in figures] == ["train-graph", "speed", "stop-errors", "approaches"]
    assert curve(figure(figures, "train-graph").charts[0], "law").x[-1] == pytest.approx(until_s)
    for one in figures:
        assert "nan" not in markup(one)


def test_a_stop_without_a_standstill_is_named(tmp_path: Path) -> None:
    run = imagined()
    figures = pictures(run.line, [record(run, tmp_path, missing=(1,))])
    errors = figure(figures, "stop-errors")
    assert "No standstill: law at 2 B." in errors.caption
    assert [point.y for point in errors.charts[0].points] == [-1.0]


def test_no_line_crosses_a_hole_of_the_record(tmp_path: Path) -> None:
    hole = (60.0, 66.0)
    ports = ("SIM_TRUTH", "ATP_LIM", "ATP_STAT", "STN_INFO", "DOOR_STAT")
    run = ImaginedRun(four_stops(), silent=[(port, *hole) for port in ports])
    figures = pictures(run.line, [record(run, tmp_path)])
    drawn = curve(figure(figures, "train-graph").charts[0], "law")
    inside = np.flatnonzero((drawn.x > hole[0] - 0.5) & (drawn.x < hole[1]))
    assert np.isnan(drawn.y[inside]).sum() == 1
    for chart in (figure(figures, "speed").charts[0], *figure(figures, "approaches").charts):
        for one in chart.curves:
            if one.label in ("law", "P", "EBI"):
                known = np.isfinite(one.x) & np.isfinite(one.y)
                far = np.diff(one.x[np.isfinite(one.x)]).max(initial=0.0)
                assert far < 5.0 or not known[:-1][np.diff(one.x) > 5.0].any()


def test_two_runs_stand_beside_each_other(tmp_path: Path) -> None:
    runs = [imagined(), ImaginedRun(four_stops())]
    records = [record(run, tmp_path, label=label) for run, label in zip(runs, ("late", "on time"), strict=True)]
    figures = pictures(four_stops(), records)
    for name in ("train-graph", "speed", "approaches"):
        labels = {one.label for one in figure(figures, name).charts[0].curves}
        assert {"late", "on time"} <= labels
    late, punctual = figure(figures, "train-graph").charts[0].bands
    assert np.isfinite(late.low).any()
    assert not np.isfinite(punctual.low).any()
    assert {point.label for point in figure(figures, "stop-errors").charts[0].points} == {"late", "on time"}
    assert [markup(one) for one in figures] == [markup(one) for one in pictures(four_stops(), records)]


@settings(max_examples=60, deadline=None)
@given(st.floats(-60.0, 60.0), st.floats(35.0, 130.0))
def test_a_train_that_is_shifted_in_time_is_late_by_that_time_under_way(shift_s: float, planned_s: float) -> None:
    planned = planned_motion(four_stops())
    place_m = planned.positions_at(np.array([planned_s]))
    moving = np.array([10.0])
    assert planned.lateness_s(np.array([planned_s + shift_s]), place_m, moving) == pytest.approx(shift_s, abs=0.05)


def test_a_train_at_a_stop_is_late_after_the_departure_and_early_before_the_arrival() -> None:
    planned = planned_motion(four_stops())
    time_s = np.array([0.0, 30.0, 45.0, 120.0, 137.0, 150.0, 167.0, 180.0])
    place_m = np.array([0.0, 0.0, 0.0, 1200.2, 1199.8, 1200.0, 1200.1, 1200.0])
    late_s = planned.lateness_s(time_s, place_m, np.zeros(8))
    assert late_s.tolist() == [0.0, 0.0, 15.0, -17.0, 0.0, 0.0, 0.0, 13.0]


def test_a_round_trip_folds_at_its_turn_back() -> None:
    line = load_any("yizhuang_round")
    assert isinstance(line, LineScenario)
    places_m = fold_positions(line, np.array([stop.position_m for stop in line.stops]))
    np.testing.assert_allclose(places_m, places_m[::-1], atol=1e-6)
    assert places_m.argmax() == 13
    assert np.isnan(fold_positions(line, np.array([np.nan])))[0]


def test_each_of_several_runs_has_its_own_permitted_speed_and_emergency_brake(tmp_path: Path) -> None:
    runs = [imagined(), ImaginedRun(four_stops())]
    records = [record(run, tmp_path, label=label) for run, label in zip(runs, ("late", "on time"), strict=True)]
    figures = pictures(four_stops(), records)
    for name in ("speed", "approaches"):
        one = figure(figures, name)
        for chart in (one.charts[0], one.charts[-1])[: 1 if name == "speed" else 2]:
            curves = {drawn.label: drawn for drawn in chart.curves}
            assert {"P late", "P on time", "EBI late", "EBI on time"} <= {*curves}
            assert curves["P late"].run != curves["P on time"].run
            assert curves["P late"].look.colour == curves["late"].look.colour
        assert one.caption.count("as the train protection told them.") == 1
    for chart in figure(figures, "approaches").charts:
        assert [band.label for band in chart.bands] == ["interval late", "interval on time"]


class HeldRed(ImaginedRun):
    """A signal is told red from 90 s to 110 s, and from 145 s to 160 s at the second stop."""

    def _station(self, now_s: float) -> StnInfo:
        is_red = 90.0 <= now_s < 110.0 or 145.0 <= now_s < 160.0
        return replace(super()._station(now_s), signal_next=SignalAspect.RED if is_red else SignalAspect.NONE)


def test_a_signal_that_a_fault_holds_red_is_drawn_where_and_when_the_record_shows_it(tmp_path: Path) -> None:
    line = replace(four_stops(), signals=(RouteSignal(1100.0, 100.0),))
    run = HeldRed(line)
    (graph, _) = figure(pictures(line, [record(run, tmp_path)]), "train-graph").charts
    planned, *held = (area for area in graph.areas if area.kind == "fault")
    assert (planned.x, planned.y) == ((0.0, 100.0), (1100.0, 1100.0))
    assert [area.y for area in held] == [(1100.0, 1100.0), (1200.0, 1200.0)]
    assert {area.label for area in held} == {"red signal"}
    assert held[0].x == pytest.approx((100.0, 110.0), abs=0.2)
    assert held[1].x == pytest.approx((145.0, 160.0), abs=0.2)


def test_a_run_without_a_signal_held_red_has_none_in_its_graph(tmp_path: Path) -> None:
    (graph, _) = figure(pictures(four_stops(), [record(imagined(), tmp_path)]), "train-graph").charts
    assert sum(area.kind == "fault" for area in graph.areas) == 1
