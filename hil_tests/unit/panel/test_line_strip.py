"""The panel's display of a line: its named places, the columns over it, states in words."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hil_tests.support.line_record import ImaginedRun
from railhil.judge.judging import judging_of
from railhil.panel.layout import Layout, Rows, make_layout
from railhil.panel.recorded import merge_layouts
from railhil.report.display_columns import STATE
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.systems.line.scenario.model import LineScenario


def layout_of(scenario: AnyScenario) -> Layout:
    return make_layout(scenario, scenario.installed_system.contract, None)


def four_stops() -> LineScenario:
    line = load_any("four_stops")
    assert isinstance(line, LineScenario)
    return line


def test_a_line_has_its_stops_and_the_speeds_over_it() -> None:
    line = four_stops()
    layout = layout_of(line)
    stations = [one for one in layout.places if one.kind != "balise"]
    places = [(one.name, one.position) for one in stations]
    assert places == [("A", 0.0), ("B", 1200.0), ("C", 2300.0), ("D", 3420.0)]
    over = [layout.columns[at] for at in layout.strip]
    assert [one.name for one in over] == ["true_speed_mps", "permitted_mps", "ebi_mps"]
    assert {one.unit for one in over} == {"km/h"}
    assert [one.kind for one in stations] == ["stop", "stop", "mark", "stop"]
    told = json.loads(json.dumps(layout.as_json()))["places"]
    assert {"name": "B", "position": 1200.0, "kind": "stop"} in told
    assert len({one.name for one in layout.columns}) == len(layout.columns)


def test_the_page_has_what_a_scenario_assumes_and_what_it_is_not() -> None:
    line = four_stops()
    layout = layout_of(line)
    assert layout.assumptions == line.assumptions
    assert any("no conformity is claimed" in sentence for sentence in layout.as_json()["assumptions"])
    other = layout_of(load_any("yizhuang_05"))
    assert merge_layouts([layout, layout, other]).assumptions == tuple(
        dict.fromkeys((*line.assumptions, *other.assumptions))
    )


def test_states_are_words_at_first_sight() -> None:
    layout = layout_of(four_stops())
    shown = {layout.columns[at].name: layout.columns[at] for at in layout.gauges}
    assert {"lateness_s", "distance_left_m", "permitted_mps"} <= set(shown)
    for name, raw, word in (("left_doors", 2, "open"), ("ato_state", 9, "closing")):
        assert shown[name].kind == STATE
        assert shown[name].words[raw] == word


@pytest.mark.parametrize("name", ["yizhuang_05", "hst", "emu3", "yizhuang_stop_closed", "four_stops"])
def test_each_system_has_a_line_with_what_its_scenario_knows_of_it(name: str) -> None:
    scenario = load_any(name)
    layout = layout_of(scenario)
    assert layout.columns[layout.strip[0]].name == "true_speed_mps"
    ends_at_m = judging_of(scenario).ends_at_m(scenario)
    if ends_at_m is not None:
        assert [one.position for one in layout.places if one.kind == "stop"][-1] == ends_at_m
    (planned, *others) = layout.profiles
    assert (planned.unit, planned.is_step) == ("km/h", False)
    for one in layout.profiles:
        at_m = [row[0] for row in one.rows]
        assert at_m == sorted(at_m)
    assert {one.label for one in others} <= {"limit", "grade"}
    # The train is told what to do and what it does, and each shipped arrangement begins with something that is there.
    assert layout.columns[layout.applied].unit == layout.columns[layout.command].unit
    there = {"line", "values", "events", "frames", "reaction ladders", *(one.title for one in layout.charts)}
    for desk in layout.desks:
        assert {tile for tile, _, _ in desk.tiles} - there <= {"speed"}


@pytest.mark.parametrize("name", ["jinan_xuzhou", "jinan_xuzhou_emu3"])
def test_a_high_speed_line_has_what_its_scenario_says_and_the_grade_that_the_wire_tells(name: str) -> None:
    layout = layout_of(load_any(name))
    (limit,) = [one for one in layout.profiles if one.label == "limit"]
    assert limit.rows == ((80_000.0, 250.0), (100_000.0, 250.0))
    marks = [(one.name, one.position) for one in layout.places if one.kind == "mark"]
    assert marks == [("coasting", 150_000.0), ("end of coasting", 180_000.0)]
    over = [layout.columns[at] for at in layout.strip]
    assert [(one.name, one.unit) for one in over][-1] == ("true_grade_permil", "‰")
    # What the first two minutes do not reach is not on their line.
    short = layout_of(load_any("hst_short"))
    assert ([one.label for one in short.profiles], short.places) == (["target curve"], ())


@pytest.mark.parametrize("name", ["four_stops", "jinan_xuzhou", "lvshun_tieshan", "yizhuang_stop"])
def test_the_header_of_a_page_has_a_curve_in_few_points(name: str) -> None:
    scenario = load_any(name)
    for whole, shown in zip(judging_of(scenario).profiles(scenario), layout_of(scenario).profiles, strict=True):
        if whole.is_step:
            assert shown == whole
            continue
        (at_m, wanted), (picked_m, values) = np.array(whole.rows).T, np.array(shown.rows).T
        moves = np.diff(at_m, prepend=-np.inf) > 0.0
        off = np.abs(np.interp(at_m, picked_m, values) - wanted)[moves]
        assert off.max() < 5e-4 * np.ptp(wanted)
        assert len(picked_m) < 0.5 * len(at_m)


def test_units_of_a_train_and_words_are_typeset() -> None:
    labels = {one.name: one for one in layout_of(load_any("emu3")).columns}
    assert (labels["true_speed2_mps"].label, labels["unit3_level"].label) == ("true speed 2", "unit 3 level")
    stop = {one.name: one for one in layout_of(load_any("yizhuang_stop")).columns}
    assert (stop["stage"].words[5], stop["memory_source"].words[1]) == ("brake", "slot_a")
    assert stop["memory_variance_m2"].unit == "m²"


def test_runs_beside_each_other_keep_their_line() -> None:
    layout = layout_of(four_stops())
    merged = merge_layouts([layout, layout])
    assert (merged.places, merged.strip, merged.gauges) == (layout.places, layout.strip, layout.gauges)


def test_a_row_of_the_panel_has_lateness_and_states() -> None:
    line = four_stops()
    layout, run = layout_of(line), ImaginedRun(line, late_s={1: 20.0}, until_s=200.0)
    rows = Rows(line, layout).make(run.trace)
    names = [column.name for column in layout.columns]
    (_, arrived_s, departed_s, _) = run.stays[1]

    def at(time_s: float, name: str) -> float:
        return float(rows[np.searchsorted(rows[:, 0], time_s), 1 + names.index(name)])

    assert at(arrived_s + 10.0, "left_doors") == 2.0
    assert at(60.0, "left_doors") == 0.0
    assert abs(at(60.0, "lateness_s")) < 0.05
    assert abs(at(departed_s - 1.0, "lateness_s") - (departed_s - 1.0 - 167.0)) < 0.03
