"""Scenario files of a line: the shipped lines, their legs and timetables, what a document keeps, and their draws."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.scenarios import layers
from railhil.scenarios.load import load_any
from railhil.scenarios.streams import PERTURBATION, generator
from railhil.scenarios.system import system_named
from railhil.systems.ato.scenario.keys import MEANING as ATO_MEANING
from railhil.systems.ato.scenario.model import TargetCurve, Uniform
from railhil.systems.ato.scenario.perturb import perturb
from railhil.systems.ato.scenario.target import Target
from railhil.systems.line.scenario.canonical import scenario_sha256
from railhil.systems.line.scenario.keys import MEANING
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.perturb import draw_line
from railhil.systems.line.scenario.regenerate import target_texts

SHIPPED = [
    "four_stops",
    "four_stops_perturbed",
    "yizhuang_out",
    "yizhuang_out_coast",
    "yizhuang_back",
    "yizhuang_back_coast",
    "yizhuang_round",
    "zurich",
]
PLATFORM = 'platform = "left"'


@lru_cache
def line(name: str) -> LineScenario:
    return cast("LineScenario", load_any(name))


def written(folder: Path, text: str, base: str = "four_stops") -> LineScenario:
    file = folder / "own.toml"
    file.write_text(f'extends = "{base}"\nname = "own"\n{text}')
    return cast("LineScenario", load_any(file))


@pytest.mark.parametrize(
    ("name", "end_s", "end_m", "stops"),
    [
        ("four_stops", 340.0, 3420.0, 4),
        ("yizhuang_out", 30 + 2107.0, 22_728.0, 14),
        ("yizhuang_out_coast", 30 + 2107.0, 22_728.0, 14),
        ("yizhuang_back", 30 + 2104.0, 22_728.0, 14),
        ("yizhuang_round", 30 + 2107.0 + 120.0 + 2104.0, 45_456.0, 27),
    ],
)
def test_a_shipped_line_has_the_stops_and_times_of_the_specification(
    name: str, end_s: float, end_m: float, stops: int
) -> None:
    scenario = line(name)
    assert (scenario.plan.running_time_s, scenario.plan.distance_m) == (end_s, end_m)
    assert len(scenario.stops) == stops
    assert scenario.plan.overtime_max_s == 300.0
    assert scenario.stops[-1].service == "terminal"


@pytest.mark.parametrize("name", SHIPPED)
def test_the_curve_of_each_section_stops_at_its_stop_and_time(name: str) -> None:
    scenario = line(name)
    for section in scenario.sections:
        here, there = scenario.stops[section.departure], scenario.stops[section.arrival]
        target = Target(section.target)
        assert target.stop_position_m == pytest.approx(there.position_m - here.position_m, abs=1e-6)
        assert there.arrive_s is not None
        assert here.depart_s is not None
        assert target.stop_time_s == pytest.approx(there.arrive_s - here.depart_s, abs=1e-6)


def test_the_shortest_times_of_yizhuang_are_those_of_the_generator() -> None:
    assert sum(section.fastest_s for section in line("yizhuang_out").sections) == pytest.approx(1658.9, abs=0.1)


def test_a_passed_stop_lies_inside_one_section() -> None:
    scenario = line("four_stops")
    assert [(section.departure, section.arrival) for section in scenario.sections] == [(0, 1), (1, 3)]
    assert (scenario.stops[2].arrive_s, scenario.stops[2].depart_s) == (None, None)


def test_the_return_leg_of_a_round_trip_is_the_line_of_the_return_behind_the_turn() -> None:
    back, leg = line("yizhuang_back").legs[0], line("yizhuang_round").legs[1]
    for name in ("grade_permil", "speed_limit_mps"):
        assert [(at_m - 22_728.0, value) for at_m, value in getattr(leg, name)] == list(getattr(back, name))
    assert [balise.surveyed_m - 22_728.0 for balise in leg.balises] == [balise.surveyed_m for balise in back.balises]
    given = json.loads((TEST_DATA / "line" / "return_profiles.json").read_text())
    assert [list(row) for row in back.grade_permil] == given["grade_permil"][: len(back.grade_permil)]


def test_the_train_turns_back_at_the_end_of_the_first_leg() -> None:
    scenario = line("yizhuang_round")
    assert [place for place, stop in enumerate(scenario.stops) if stop.turn_back] == [13]
    turn = scenario.stops[13]
    assert (turn.leg, turn.arrive_s, turn.depart_s) == (0, 2137.0, 2257.0)
    assert [section.leg for section in scenario.sections] == [0] * 13 + [1] * 13


@pytest.mark.parametrize("name", SHIPPED)
def test_neighbouring_balises_have_different_numbers_of_one_byte(name: str) -> None:
    numbers = [balise.number for leg in line(name).legs for balise in leg.balises]
    assert {*numbers} <= {*range(1, 256)}
    for leg in line(name).legs:
        own = [balise.number for balise in leg.balises]
        assert all(own[place] not in own[max(0, place - 15) : place] for place in range(len(own)))


def test_track_behind_the_last_stop_is_an_assumption() -> None:
    assert any("30 m of overrun track behind Songjiazhuang" in text for text in line("yizhuang_round").assumptions)


@pytest.mark.parametrize("name", ["yizhuang_back", "yizhuang_back_coast", "yizhuang_out_coast", "zurich"])
def test_target_files_of_a_line_are_what_the_generator_makes(name: str) -> None:
    path = layers.DATA / "runs" / f"{name}.toml"
    for file, text in target_texts(path).items():
        assert (layers.DATA / "targets" / f"{file}.toml").read_text() == text


@pytest.mark.parametrize("name", SHIPPED)
def test_a_document_restores_the_scenario(name: str) -> None:
    scenario = line(name)
    kind = scenario.installed_system.scenario_kind
    assert kind.restore(json.loads(json.dumps(kind.document(scenario))), Path("scenario.json")) == scenario


def test_limits_that_only_judge_change_the_judged_hash_alone() -> None:
    scenario = line("four_stops")
    kind = scenario.installed_system.scenario_kind
    stops = tuple(replace(stop, stop_error_max_m=0.2) for stop in scenario.stops)
    for other in (
        replace(scenario, stops=stops),
        replace(scenario, route=replace(scenario.route, arrival_error_max_s=3.0)),
        replace(scenario, route=replace(scenario.route, departure_late_max_s=3.0)),
    ):
        assert scenario_sha256(other) == scenario.sha256
        assert kind.judged_sha256(other) != kind.judged_sha256(scenario)


@pytest.mark.parametrize(
    "text",
    [
        "[route]\ndoor_window_m = 0.4",
        "[route]\ndwell_min_s = 25",
        "[train]\nemergency = { braking_mps2 = 1.1 }",
        "[route]\njog = { attempts = 1 }",
        "[[route.signal]]\nposition_m = 1900\nclear_s = 250",
    ],
)
def test_what_changes_the_run_changes_the_hash(tmp_path: Path, text: str) -> None:
    assert written(tmp_path, text).sha256 != written(tmp_path, "").sha256


def test_a_line_takes_the_place_of_plan_and_target_of_the_scenario_that_it_extends(tmp_path: Path) -> None:
    route = f'[route]\nto_stop = "Jiugong"\nrunning_time_reserve_percent = 5\n{PLATFORM}'
    scenario = written(tmp_path, f'system = "line"\ntitle = "Own"\n{route}', base="yizhuang_01")
    assert [stop.name for stop in scenario.stops] == ["Songjiazhuang", "Xiaocun", "Xiaohongmen", "Jiugong"]
    assert [section.running_time_s for section in scenario.sections] == [186.0, 108.0, 158.0]


def test_a_leg_can_go_on_over_another_line(tmp_path: Path) -> None:
    branch = (
        'name = "branch"\ngrade_permil = [[-118, 0], [400, 5]]\nspeed_limit_kmh = [[-118, 60]]\n'
        'stops = [{ name = "D", position_m = 50 }, { name = "E", position_m = 1250 }]\n'
    )
    (tmp_path / "branch.toml").write_text(branch)
    leg = '[[route.leg]]\nline = "branch.toml"\nturn_back_s = 90\nrunning_time_s = [110]\nplatform = "left"\n'
    text = (layers.DATA / "runs" / "four_stops.toml").read_text().replace(', service = "terminal"', "")
    (tmp_path / "own.toml").write_text(f"{text}\n{leg}")
    scenario = cast("LineScenario", load_any(tmp_path / "own.toml"))
    assert [(stop.name, stop.position_m, stop.leg) for stop in scenario.stops[-2:]] == [("D", 3420, 0), ("E", 4620, 1)]
    assert (scenario.stops[-2].depart_s, scenario.stops[-1].arrive_s) == (430.0, 540.0)
    assert scenario.legs[1].grade_permil == ((3252.0, 0.0), (3770.0, 5.0))


def test_other_times_than_those_of_the_target_files_are_generated(tmp_path: Path) -> None:
    times = [190, 108, 158, 146, 94, 121, 109, 113, 167, 157, 163, 109, 116]
    scenario = written(tmp_path, f"[route]\nrunning_time_s = {times}", base="yizhuang_out")
    usual = line("yizhuang_out")
    assert scenario.sections[0].running_time_s == 190.0
    assert scenario.sections[0].target != usual.sections[0].target
    assert [one.target for one in scenario.sections[1:]] == [one.target for one in usual.sections[1:]]


def test_a_line_regulated_by_profiles_has_a_curve_for_each(tmp_path: Path) -> None:
    scenario = written(tmp_path, '[route]\nregulation = "profiles"\n[atp]\nenabled = false')
    for section in scenario.sections:
        times_s = [Target(curve).stop_time_s for curve in section.profiles]
        assert times_s == pytest.approx([section.fastest_s * (1 + share) for share in (0.0, 0.05, 0.12)])


def test_signals_of_a_leg_have_run_positions(tmp_path: Path) -> None:
    text = "[[route.signal]]\nposition_m = 1000\nclear_s = 2400\nleg = 2"
    (signal,) = written(tmp_path, text, base="yizhuang_round").signals
    assert (signal.position_m, signal.leg, signal.clear_s) == (22_728.0 + 1000.0, 1, 2400.0)


def test_a_line_of_one_leg_is_drawn_like_a_train_of_ato() -> None:
    scenario = line("four_stops")
    scenario = replace(
        scenario,
        perturbations=replace(
            scenario.perturbations,
            davis_factor=Uniform(0.7, 1.3),
            grade_factor=Uniform(0.9, 1.1),
            balise_position_error_m=Uniform(-0.05, 0.05),
        ),
    )
    drawn, alone = draw_line(scenario, 7), perturb(scenario, 7)
    assert (drawn.scenario.line, drawn.scenario.train) == (alone.line, alone.train)
    assert drawn.scenario.legs == (alone.line,)
    assert drawn.section_masses == (1.0, 1.0)


def test_all_legs_are_drawn_together_and_a_mass_for_each_section() -> None:
    scenario = line("yizhuang_round")
    drawn = draw_line(scenario, 5)
    nominal = [permil for leg in scenario.legs for _, permil in leg.grade_permil]
    found = [permil for leg in drawn.scenario.legs for _, permil in leg.grade_permil]
    factor, offset_permil = np.polyfit(nominal, found, 1)
    assert np.array(found) == pytest.approx(np.array(nominal) * factor + offset_permil, abs=1e-9)
    assert factor != pytest.approx(1.0, abs=1e-3)
    errors = [balise.true_m - balise.surveyed_m for leg in drawn.scenario.legs for balise in leg.balises]
    assert len({*errors}) == 132
    assert max(map(abs, errors)) <= 0.05
    assert len({*drawn.section_masses}) == 26
    assert 0.9 <= min(drawn.section_masses) <= max(drawn.section_masses) <= 1.1
    last = generator(5, PERTURBATION).random(9 + 132 + 1)[-1]
    assert drawn.atp_wheel_factor == pytest.approx(0.995 + 0.01 * last)
    assert drawn.scenario.sha256 == scenario.sha256


def test_a_nominal_run_draws_nothing() -> None:
    scenario = line("yizhuang_out")
    drawn = draw_line(scenario, 5, drawn=False)
    assert drawn.scenario is scenario
    assert drawn.section_masses == (1.0,) * 13
    assert drawn.atp_wheel_factor == 1.0


def test_the_shipped_curves_of_the_way_out_are_those_of_the_single_runs() -> None:
    nodes = np.array(line("yizhuang_out").sections[4].target.nodes)
    curve = cast("LineScenario", load_any("yizhuang_05")).target
    assert isinstance(curve, TargetCurve)
    assert (nodes == np.array(curve.nodes)).all()


def test_every_key_of_a_line_has_a_meaning() -> None:
    keys = system_named("line").scenario_kind.list_keys()
    assert [key.name for key in keys if not key.meaning] == []
    assert {"route.stops[].position_m", "route.leg[].line", "route.signal[].clear_s"} <= {key.name for key in keys}


def test_the_meanings_are_those_of_keys_that_there_are() -> None:
    assert {*MEANING} - {key.name for key in system_named("line").scenario_kind.list_keys()} <= {*ATO_MEANING}


@pytest.mark.parametrize(
    ("emergency", "told"),
    [
        ("braking_mps2 = 0.918, dead_s = 0.6, lag_s = 0.6", False),
        ("braking_mps2 = 0.917, dead_s = 0.3, lag_s = 0.6", True),
        ("braking_mps2 = 1.2, dead_s = 0.7, lag_s = 0.6", True),
    ],
)
def test_a_brake_that_the_protection_does_not_cover_is_among_the_assumptions(
    tmp_path: Path, emergency: str, told: bool
) -> None:
    scenario = written(tmp_path, f"[train]\nemergency = {{ {emergency} }}")
    assert any("the protection does not cover it" in sentence for sentence in scenario.assumptions) == told
