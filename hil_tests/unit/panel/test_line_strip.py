"""The panel's display of a line: its named places, the columns over it, states in words."""

from __future__ import annotations

import json

import numpy as np

from hil_tests.support.line_record import ImaginedRun
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
    places = [(one.name, one.position) for one in layout.places]
    assert places == [("A", 0.0), ("B", 1200.0), ("C", 2300.0), ("D", 3420.0)]
    over = [layout.columns[at] for at in layout.strip]
    assert [one.name for one in over] == ["true_speed_mps", "permitted_mps", "ebi_mps", "speed_limit_mps"]
    assert {one.unit for one in over} == {"km/h"}
    assert json.loads(json.dumps(layout.as_json()))["places"][1] == {"name": "B", "position": 1200.0}
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


def test_a_system_without_places_has_no_line() -> None:
    layout = layout_of(load_any("yizhuang_05"))
    assert (layout.places, layout.strip, layout.gauges) == ((), (), ())


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
