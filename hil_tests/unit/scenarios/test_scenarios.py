"""Scenario files: what is shipped, how files refer to each other, what the hash covers, perturbed runs."""

from __future__ import annotations

import csv
import dataclasses
import hashlib
import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support import shipped
from hil_tests.support.paths import ROOT
from railhil.common.errors import InputError
from railhil.scenarios import streams
from railhil.scenarios.json_schema import scenario_json_schema
from railhil.scenarios.layers import DATA, Layers
from railhil.scenarios.load import RUNS, load, load_any, names
from railhil.scenarios.profiles import MeanGrade, find_lowest, profile_value
from railhil.scenarios.reference import PAGE, page
from railhil.scenarios.system import system_named
from railhil.systems.ato.scenario.canonical import canonical_json, scenario_sha256
from railhil.systems.ato.scenario.keys import MEANING
from railhil.systems.ato.scenario.model import Line, Perturbations, Scenario, Uniform
from railhil.systems.ato.scenario.perturb import perturb

YIZHUANG_DATA = DATA / "sources" / "yizhuang_line"


def write(folder: Path, text: str, name: str = "mine.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", shipped.ATO)
def test_every_shipped_scenario_loads_and_says_what_is_assumed(name: str) -> None:
    scenario = load(name)
    assert scenario.name == name
    assert len(scenario.sha256) == 64
    assert scenario.assumptions
    assert scenario.plan.stop_error_max_m > 0


@pytest.mark.parametrize("name", shipped.OTHERS)
def test_shipped_scenarios_of_other_systems_load_and_say_what_is_assumed(name: str) -> None:
    scenario = load_any(name)
    assert scenario.name == name
    assert scenario.assumptions


def test_names_are_the_two_lvshun_and_thirteen_yizhuang_runs() -> None:
    assert names() == sorted(names())
    assert [name.split("_")[0] for name in shipped.ATO] == ["lvshun"] * 2 + ["yizhuang"] * 13
    assert {"hst_short", "jinan_xuzhou"} <= {*shipped.OTHERS}


@pytest.mark.parametrize("name", shipped.ATO)
def test_the_limit_of_the_stop_has_a_source(name: str) -> None:
    """The standard that the precise-stopping paper names, and a leeway that an operator publishes."""
    scenario = load(name)
    assert scenario.plan.stop_error_max_m == 0.3
    source = next(sentence for sentence in scenario.assumptions if "0.3 m" in sentence)
    assert "He and Tang" in source
    assert "Taipei Metro" in source


def test_lvshun_has_the_numbers_of_table_1() -> None:
    scenario = load("lvshun_tieshan")
    assert scenario.train.mass_kg == 211_000
    assert scenario.train.inertial_mass_kg == pytest.approx(223_660)
    assert scenario.train.force_per_notch_n / scenario.train.inertial_mass_kg == pytest.approx(0.2088, abs=1e-5)
    assert scenario.line.speed_limit_mps[0][1] * 3.6 == pytest.approx(78)
    assert (scenario.plan.distance_m, scenario.plan.running_time_s) == (2940, 195)
    assert (scenario.plan.stop_error_max_m, scenario.plan.time_error_max_s) == (0.3, 0.3)
    assert scenario.sensors.speed_noise_sigma_mps * 3.6 == pytest.approx(0.01)
    assert [balise.surveyed_m for balise in scenario.line.balises] == [0, 600, 1500, 2400, 2800, 2915]
    assert [row.controller for row in scenario.published] == ["ipfc", "tpfc2", "tpfc1", "tdmc", "fuzzy_pid"]
    assert scenario.published[0].values["energy_kj"] == 74075
    assert scenario.perturbations.wheel_factor is None


def test_worn_wheels_change_only_the_wheel_distribution() -> None:
    plain, worn = load("lvshun_tieshan"), load("lvshun_tieshan_worn_wheels")
    assert worn.perturbations.wheel_factor == Uniform(0.995, 1.005)
    same = dataclasses.replace(worn.perturbations, wheel_factor=None)
    changed = dataclasses.replace(worn, perturbations=same, name=plain.name, title=plain.title, sha256=plain.sha256)
    assert changed == plain


def test_yizhuang_line_is_the_source_with_stop_5_corrected() -> None:
    with (YIZHUANG_DATA / "stations.csv").open(encoding="utf-8") as file:
        stations = list(csv.DictReader(file))
    positions = [float(row["position_m"]) for row in stations]
    assert positions[5] == 9247
    runs = [load(name) for name in names() if re.match(r"yizhuang_\d", name)]
    assert [run.plan.distance_m for run in runs] == list(np.diff(positions))
    for column, key, scale in (("gradient_permil", "grade_permil", 1.0), ("speed_kmh", "speed_limit_mps", 3.6)):
        file_name = "gradients.csv" if scale == 1.0 else "speed_limits.csv"
        with (YIZHUANG_DATA / file_name).open(encoding="utf-8") as file:
            rows = tuple((float(row["from_m"]), float(row[column])) for row in csv.DictReader(file))
        for run, start_m in zip(runs, positions, strict=False):
            for x in np.arange(0.5, run.plan.distance_m, 10.0).tolist():
                assert profile_value(getattr(run.line, key), x) * scale == pytest.approx(
                    profile_value(rows, start_m + x)
                ), f"{run.name} {key} at {x} m"


def test_yizhuang_profiles_reach_under_the_standing_train() -> None:
    """At Xiaocun the platform section begins 130 m before the stop and the train is 118 m long."""
    run = load("yizhuang_02_xiaocun_xiaohongmen")
    assert run.line.speed_limit_mps[0][0] == 2501 - 2631
    assert profile_value(run.line.grade_permil, -118.0) == -2.0


def test_yizhuang_has_five_balises_before_the_stop_and_one_under_the_train() -> None:
    run = load("yizhuang_02_xiaocun_xiaohongmen")
    assert [1275 - balise.surveyed_m for balise in run.line.balises] == [1275, 180, 90, 40, 10, 0]
    assert [balise.number for balise in run.line.balises] == [15, 21, 22, 23, 24, 25]


def test_shipped_sources_are_byte_for_byte() -> None:
    digest = hashlib.sha256((YIZHUANG_DATA / "CN_Songjiazhuang_Yizhuang.json").read_bytes()).hexdigest()
    assert digest == "e891bf74a32013a996a93c6df94a01f173c6a12bc171ce33edb24619a70b092d"
    assert "Redistribution and use" in (YIZHUANG_DATA / "LICENSE.TTOBench.BSD-2-Clause.txt").read_text("utf-8")
    assert "MIT License" in (YIZHUANG_DATA / "SOURCE.md").read_text("utf-8")


# --- files that refer to files -------------------------------------------------------------------------------


def test_a_scenario_of_ones_own_extends_a_shipped_one(tmp_path: Path) -> None:
    path = write(tmp_path, 'extends = "lvshun_tieshan"\nname = "heavy"\ntitle = "t"\n[train]\nmass_t = 230\n')
    scenario = load(path)
    assert scenario.train.mass_kg == 230_000
    assert scenario.train.inertial_mass_kg == pytest.approx(230_000 * 1.06)
    assert scenario.line == load("lvshun_tieshan").line
    assert load(str(path)) == scenario


def test_nested_tables_are_merged_key_by_key(tmp_path: Path) -> None:
    path = write(tmp_path, 'extends = "lvshun_tieshan"\nname = "n"\ntitle = "t"\n[train.davis]\na_n_per_kn = 3\n')
    train = load(path).train
    assert (train.davis_a_n_per_kn, train.davis_b_n_per_kn_kmh) == (3, 0.008)
    assert load("lvshun_tieshan").train.davis_a_n_per_kn == 2.0


def test_a_file_given_above_replaces_the_whole_section_below(tmp_path: Path) -> None:
    write(tmp_path, 'extends = "lvshun_tieshan"\nname = "a"\ntitle = "t"\n[train]\nmass_t = 230\n', "a.toml")
    path = write(tmp_path, 'extends = "a.toml"\nname = "b"\ntitle = "t"\n[train]\nfile = "yizhuang_b6"\n', "b.toml")
    assert load(path).train == load("yizhuang_01_songjiazhuang_xiaocun").train


def test_generate_above_makes_the_curve_below_anew(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        'extends = "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan"\nname = "slow"\ntitle = "t"\n'
        "[plan]\nrunning_time_s = 120\n[target.generate]\njerk_max_mps3 = 0.4\n",
    )
    scenario = load(path)
    assert scenario.plan.running_time_s == 120
    assert scenario.target.nodes[-1][0] == pytest.approx(120)


def test_a_reserve_gives_the_running_time(tmp_path: Path) -> None:
    text = (DATA / "runs" / "lvshun_tieshan.toml").read_text("utf-8")
    text = text.replace('[target]\nfile = "lvshun_tieshan"', "[target.generate]")
    text = text.replace("running_time_s = 195", "running_time_reserve_percent = 7")
    fastest = load(write(tmp_path, text.replace("percent = 7", "percent = 0"))).plan.running_time_s
    with_reserve = load(write(tmp_path, text)).plan.running_time_s
    assert with_reserve == int(with_reserve)
    assert fastest * 1.06 - 1 < with_reserve < fastest * 1.07 + 1


def test_a_tick_of_3_2_ms_is_exact(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        'extends = "lvshun_tieshan"\nname = "n"\ntitle = "t"\n'
        "[timing]\nbase_tick_ms = 3.2\ncontrol_period_ms = 480\n[timing.port_period_ms]\nTRN_SPEED = 16\n",
    )
    timing = load(path).timing
    assert (timing.base_tick_ns, timing.control_period_ns) == (3_200_000, 480_000_000)
    assert timing.port_period_ns == {"TRN_SPEED": 16_000_000}


# --- the hash ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def lvshun() -> Scenario:
    return load("lvshun_tieshan")


def test_the_hash_leaves_out_what_only_explains(lvshun: Scenario) -> None:
    renamed = dataclasses.replace(lvshun, title="other", assumptions=(), published=())
    assert scenario_sha256(renamed) == lvshun.sha256


def test_the_hash_covers_everything_that_changes_a_run(lvshun: Scenario) -> None:
    changed = [
        dataclasses.replace(lvshun, train=dataclasses.replace(lvshun.train, mass_kg=211_000.0001)),
        dataclasses.replace(lvshun, line=Line("x", lvshun.line.grade_permil, lvshun.line.speed_limit_mps)),
        dataclasses.replace(lvshun, perturbations=Perturbations()),
        dataclasses.replace(lvshun, watch=dataclasses.replace(lvshun.watch, hold_ms=21)),
        dataclasses.replace(lvshun, timing=dataclasses.replace(lvshun.timing, loop_delay_s=0.05)),
    ]
    hashes = {scenario_sha256(scenario) for scenario in changed}
    assert len(hashes) == len(changed)
    assert lvshun.sha256 not in hashes


def test_the_canonical_form_is_the_same_for_the_same_file(lvshun: Scenario) -> None:
    assert canonical_json(load("lvshun_tieshan")) == canonical_json(lvshun)
    assert json.loads(canonical_json(lvshun))["plan"]["distance_m"] == 2940.0


# --- perturbed runs ------------------------------------------------------------------------------------------


def test_a_seed_gives_the_same_run_and_another_seed_another(lvshun: Scenario) -> None:
    assert perturb(lvshun, 5) == perturb(lvshun, 5)
    assert perturb(lvshun, 5) != perturb(lvshun, 6)


def test_every_quantity_is_drawn_within_its_bounds_and_reaches_both_ends() -> None:
    nominal = load("lvshun_tieshan_worn_wheels")
    runs = [perturb(nominal, seed) for seed in range(300)]
    given = nominal.perturbations
    drawn = {
        "mass_factor": [run.train.mass_kg / nominal.train.mass_kg for run in runs],
        "davis_factor": [run.train.davis_c_n_per_kn_kmh2 / nominal.train.davis_c_n_per_kn_kmh2 for run in runs],
        "actuator_pole_factor": [run.train.actuator_pole_per_s / nominal.train.actuator_pole_per_s for run in runs],
        "force_gain_factor": [run.train.force_per_notch_n / nominal.train.force_per_notch_n for run in runs],
        "grade_offset_permil": [run.line.grade_permil[0][1] for run in runs],
        "grade_factor": [(run.line.grade_permil[1][1] - run.line.grade_permil[0][1]) / 4 for run in runs],
        "speed_noise_sigma_mps": [run.sensors.speed_noise_sigma_mps for run in runs],
        "loop_delay_s": [run.timing.loop_delay_s for run in runs],
        "wheel_factor": [run.sensors.wheel_factor for run in runs],
        "balise_position_error_m": [b.true_m - b.surveyed_m for run in runs for b in run.line.balises],
    }
    assert set(drawn) == {field.name for field in dataclasses.fields(given)}
    for name, values in drawn.items():
        bounds: Uniform = getattr(given, name)
        width = bounds.high - bounds.low
        assert bounds.low - 1e-9 <= min(values) < bounds.low + 0.05 * width, name
        assert bounds.high - 0.05 * width < max(values) <= bounds.high + 1e-9, name
    pairs = np.corrcoef([values for name, values in drawn.items() if name != "balise_position_error_m"])
    assert np.abs(pairs - np.eye(len(pairs))).max() < 0.25


def test_mass_scales_both_masses_and_the_survey_stays(lvshun: Scenario) -> None:
    run = perturb(lvshun, 11)
    factor = run.train.mass_kg / lvshun.train.mass_kg
    assert run.train.inertial_mass_kg == pytest.approx(lvshun.train.inertial_mass_kg * factor)
    assert run.train.traction == lvshun.train.traction
    assert [b.surveyed_m for b in run.line.balises] == [b.surveyed_m for b in lvshun.line.balises]
    assert (run.target, run.plan, run.sha256) == (lvshun.target, lvshun.plan, lvshun.sha256)


def test_a_draw_does_not_depend_on_what_else_is_perturbed(lvshun: Scenario) -> None:
    only_pole = dataclasses.replace(
        lvshun, perturbations=Perturbations(actuator_pole_factor=lvshun.perturbations.actuator_pole_factor)
    )
    run = perturb(only_pole, 3)
    assert run.train.actuator_pole_per_s == perturb(lvshun, 3).train.actuator_pole_per_s
    assert run.train.mass_kg == lvshun.train.mass_kg
    assert run.timing == lvshun.timing


def test_streams_of_one_seed_are_independent_and_repeatable() -> None:
    first = streams.generator(1, streams.SPEED_NOISE).standard_normal(1000)
    assert np.array_equal(first, streams.generator(1, streams.SPEED_NOISE).standard_normal(1000))
    other = streams.generator(1, streams.TUNING).standard_normal(1000)
    assert abs(float(np.corrcoef(first, other)[0, 1])) < 0.15
    with pytest.raises(ValueError, match="-1"):
        streams.generator(-1, streams.TUNING)


# --- profiles under a train ----------------------------------------------------------------------------------


def test_the_limit_under_the_train_falls_at_the_front_and_rises_at_the_rear() -> None:
    limits = ((0.0, 20.0), (500.0, 10.0), (520.0, 15.0), (900.0, 30.0))
    assert find_lowest(limits, 80.0, 25.0) == ((0.0, 20.0), (500.0, 10.0), (600.0, 15.0), (980.0, 25.0))


def test_grade_is_averaged_over_the_train() -> None:
    grade = MeanGrade(((0.0, 0.0), (100.0, 10.0), (140.0, -10.0)), 80.0)
    assert grade([100.0, 140.0, 180.0, 220.0, -50.0]) == pytest.approx([0.0, 5.0, 0.0, -10.0, 0.0])
    assert grade.extremes(90.0, 200.0) == pytest.approx((-5.0, 5.0))


def test_the_json_schema_knows_every_key_and_requires_none() -> None:
    schema = scenario_json_schema()
    text = json.dumps(schema)
    assert '"required"' not in text
    assert {"extends", "train", "plan", "published"} <= set(schema["properties"])
    assert "file" in schema["$defs"]["TrainTable"]["properties"]
    assert schema["$defs"]["TrainTable"]["additionalProperties"] is False


def test_example_of_imported_files_replaces_train_and_line_of_what_it_extends() -> None:
    scenario = load(str(ROOT / "docs" / "examples" / "desiro_slope.toml"))
    assert scenario.train.name == "Regional Train"
    assert scenario.line.grade_permil[-1][1] == 0.0
    assert scenario.plan.distance_m == 9000


@pytest.mark.parametrize(("distance", "right"), [(15, False), (16, True)])
def test_a_balise_number_may_come_again_behind_fifteen_others(tmp_path: Path, distance: int, right: bool) -> None:
    """A line of 400 km has more balises than the wire has numbers. Their order in the file does not matter."""
    rows = [f"{{ number = {k % distance + 1}, surveyed_m = {90 * k} }}" for k in range(2 * distance)]
    path = tmp_path / "many.toml"
    path.write_text(
        f'extends = "lvshun_tieshan"\nname = "many"\n[line]\nbalises = [{", ".join(reversed(rows))}]\n',
        encoding="utf-8",
    )
    if right:
        assert len(load(path).line.balises) == 2 * distance
    else:
        with pytest.raises(InputError, match=r"line\.balises\[\d+\]\.number: found \d+, allowed a number that none"):
            load(path)


def test_a_watch_is_weaker_when_a_limit_is_above_the_usual_one(tmp_path: Path) -> None:
    assert all(load(name).watch.weakened == "" for name in shipped.ATO)
    path = tmp_path / "weak.toml"
    head = 'extends = "lvshun_tieshan"\nname = "weak"\n[watch]\n'
    for lines, said in (
        ("hold_ms = 10", ""),
        ("overspeed_margin_kmh = 4.99", ""),
        ("overspeed_margin_kmh = 5.01", "overspeed_margin_kmh 5.01 (usual 5)"),
        (
            "hold_ms = 100000\ntraction_cut_ms = 200000\nservice_brake_ms = 300000\nemergency_ms = 400000\n"
            "overspeed_margin_kmh = 1e7",
            "hold_ms 100000 (usual 20), traction_cut_ms 200000 (usual 64), service_brake_ms 300000 (usual 256), "
            "emergency_ms 400000 (usual 1000), overspeed_margin_kmh 1e+07 (usual 5)",
        ),
    ):
        path.write_text(head + lines + "\n", encoding="utf-8")
        assert load(path).watch.weakened == said


def test_the_reference_of_all_keys_is_current_and_whole() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "python -m railhil.scenarios.reference writes it"
    by_name = {key.name: key for key in system_named("ato").scenario_kind.list_keys()}
    assert all(key.meaning for key in by_name.values())
    assert set(MEANING) <= set(by_name)
    assert (by_name["plan.distance_m"].unit, by_name["plan.distance_m"].allowed) == ("m", "number above 0 to 400000")
    assert (by_name["timing.loop_delay_s"].unit, by_name["timing.loop_delay_s"].default) == ("s", "0.04")
    # Every key of every shipped scenario is one of them.
    for name in shipped.ATO:
        path = RUNS / f"{name}.toml"
        for keys_there in leaves(Layers(path).merge()):
            assert keys_there in by_name, keys_there


def leaves(table: dict[str, object], above: str = "") -> Iterator[str]:
    """Dotted keys of a file, rows of tables by their keys."""
    for key, value in table.items():
        name = f"{above}{key}"
        rows = [row for row in value if isinstance(row, dict)] if isinstance(value, list) else []
        if isinstance(value, dict):
            yield from leaves(value, f"{name}.")
        elif rows:
            for row in rows:
                yield from leaves(row, f"{name}[].")
        else:
            yield name
