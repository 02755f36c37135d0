"""Importers: railtoolkit 2022.05 against its published running times, TTOBench tracks, and users' own files."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.common.errors import InputError
from railhil.scenarios.layers import DATA
from railhil.scenarios.load import load
from railhil.scenarios.profiles import MeanGrade, find_lowest, profile_value
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.importers import railtoolkit, ttobench
from railhil.systems.ato.scenario.importers.section import Stop, StopLine
from railhil.systems.ato.scenario.model import Balise, Line, Train
from railhil.systems.ato.scenario.target import Target

RAILTOOLKIT = TEST_DATA / "railtoolkit"
TTOBENCH = DATA / "sources" / "yizhuang_line" / "CN_Songjiazhuang_Yizhuang.json"


def train(name: str) -> Train:
    return railtoolkit.load_train(
        RAILTOOLKIT / "trains" / f"{name}.yaml", actuator_pole_per_s=0.34, accel_per_notch_mps2=0.2
    )


def flat_out_s(unit: Train, line: Line, distance_m: float, step_m: float = 2.0) -> float:
    """Running time with full effort, the braking rate of the train and no actuator, midpoint steps of distance."""
    count = round(distance_m / step_m)
    middle = (np.arange(count) + 0.5) * step_m
    grade = MeanGrade(line.grade_permil, unit.length_m)(middle)
    limit = np.array(
        [
            profile_value(find_lowest(line.speed_limit_mps, unit.length_m, unit.speed_limit_mps), x)
            for x in middle.tolist()
        ]
    )
    ceiling = np.zeros(count + 1)
    for i in reversed(range(count)):
        ceiling[i] = min(limit[i], (ceiling[i + 1] ** 2 + 2 * unit.service_braking_mps2 * step_m) ** 0.5)
    speed_grid = np.arange(0.0, limit.max() + 1.0, 0.05)
    force = force_limit_n(unit.traction, speed_grid) - resistance_n(unit, speed_grid, 0.0)
    weight_kn = unit.mass_kg * unit.gravity_mps2 / 1000
    v = total_s = 0.0
    for i in range(count):
        accel = float(np.interp(v, speed_grid, force) - weight_kn * grade[i]) / unit.inertial_mass_kg
        half = max(v * v + accel * step_m, 0.01) ** 0.5
        accel = float(np.interp(half, speed_grid, force) - weight_kn * grade[i]) / unit.inertial_mass_kg
        after = min(max(v * v + 2 * accel * step_m, 0.01) ** 0.5, limit[i], ceiling[i + 1])
        total_s += 2 * step_m / (v + after)
        v = after
    return total_s


def expected_times() -> list[tuple[str, str, float]]:
    with (RAILTOOLKIT / "expected" / "running_times.csv").open(encoding="utf-8") as file:
        return [(row["train"], row["path"], float(row["running_time_s"])) for row in csv.DictReader(file)]


def test_there_are_nine_published_running_times() -> None:
    assert len(expected_times()) == 9


@pytest.mark.parametrize(("train_name", "path_name", "expected_s"), expected_times())
def test_running_times_within_the_step_error_of_the_published_ones(
    train_name: str, path_name: str, expected_s: float
) -> None:
    """The published values carry 0.4 to 0.5 % error of their 20 m step: 0.6 % is as close as can be asked."""
    line = railtoolkit.load_line(RAILTOOLKIT / "paths" / f"{path_name}.yaml", train_length_m=0).line
    assert flat_out_s(train(train_name), line, 10_000.0) == pytest.approx(expected_s, rel=0.006)


def test_inertia_has_the_load_and_the_rotating_masses() -> None:
    local = train("local")
    assert local.inertial_mass_kg == pytest.approx((68 + 20) * 1.08 * 1000)
    assert local.length_m == 41.7
    assert local.speed_limit_mps * 3.6 == pytest.approx(120)
    assert local.service_braking_mps2 == 0.4253
    assert local.brake.force_max_n == pytest.approx(0.4253 * local.inertial_mass_kg)
    assert local.force_per_notch_n == pytest.approx(0.2 * local.inertial_mass_kg)


def test_resistance_of_the_powered_vehicle_follows_its_formula() -> None:
    """Wende p. 151 by hand at 60 km/h: base on driven, rolling on other axles, air with 15 km/h head wind."""
    permil = (3.0 * 45.333 + 1.4 * (68 - 45.333)) / 68 + 3.9 * 0.75**2
    force_n = permil / 1000 * 68_000 * 9.80665
    assert float(resistance_n(train("local"), 60 / 3.6, 0.0)) == pytest.approx(force_n, rel=1e-9)


def test_freight_is_limited_and_braked_as_its_slowest_vehicle() -> None:
    freight = train("freight")
    assert freight.speed_limit_mps * 3.6 == pytest.approx(80)
    assert freight.service_braking_mps2 == 0.225
    assert freight.length_m == pytest.approx(14.32 + 10 * 19.04)


def test_paths_keep_limits_grades_and_front_points() -> None:
    slope = railtoolkit.load_line(RAILTOOLKIT / "paths" / "slope.yaml", train_length_m=41.7)
    assert profile_value(slope.line.grade_permil, 6500.0) == -10.0
    assert [stop.name for stop in slope.stops][:2] == ["start", "view_point_1"]
    assert "clearing_point_1" not in [stop.name for stop in slope.stops]
    assert slope.stops[-1] == Stop("end", 10000.0)


def changed(tmp_path: Path, source: Path, old: str, new: str) -> Path:
    text = source.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / source.name
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('schema_version: "2022.05"', 'schema_version: "2024.01"', "found '2024.01', allowed the text '2022.05'"),
        ("schema: https", "skema: https", "schema: missing"),
        ("length: 41.7", "length: -1", "vehicles[0].length: found -1"),
        ("formation: [DB_BR_642]", "formation: [X]", "found 'X', allowed one of DB_BR_642"),
        ("      - [1.0, 94400]", "      - [0.0, 94400]", "increasing speeds"),
        ("vehicles:", "vehicles: [", "YAML"),
        ("mass: 68.0", "mass: heavy", "found 'heavy', allowed a number"),
    ],
)
def test_bad_rolling_stock_gives_one_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    path = changed(tmp_path, RAILTOOLKIT / "trains" / "local.yaml", old, new)
    with pytest.raises(InputError) as caught:
        railtoolkit.load_train(path, actuator_pole_per_s=0.3, accel_per_notch_mps2=0.2)
    assert "\n" not in str(caught.value)
    assert words in str(caught.value)


def test_bad_paths_give_one_line(tmp_path: Path) -> None:
    source = RAILTOOLKIT / "paths" / "const.yaml"
    for old, new, words in (
        ("[      10000.0,", "[      0.0,", "increasing positions"),
        ('"2022.05"', "2022.05", "found 2022.05, allowed the text '2022.05' or '2024.07'"),
        ("160,            0.00 ]", "-1,            0.00 ]", "found -1"),
    ):
        with pytest.raises(InputError) as caught:
            railtoolkit.load_line(changed(tmp_path, source, old, new), train_length_m=0)
        assert "\n" not in str(caught.value)
        assert words in str(caught.value)
    with pytest.raises(InputError, match="one of const"):
        railtoolkit.load_line(source, train_length_m=0, path_id="nix")
    with pytest.raises(InputError, match="rolling-stock"):
        railtoolkit.load_train(source, actuator_pole_per_s=0.3, accel_per_notch_mps2=0.2)


# --- TTOBench ------------------------------------------------------------------------------------------------


def test_the_shipped_track_reads_as_it_is() -> None:
    track = ttobench.load_line(TTOBENCH)
    assert len(track.stops) == 14
    assert track.stops[5].position_m == 9274, "the source's digit swap is corrected in the line file, not here"
    assert (len(track.line.speed_limit_mps), len(track.line.grade_permil)) == (34, 56)
    assert track.line.speed_limit_mps[1] == pytest.approx((150.0, 84 / 3.6))


@pytest.fixture
def track_file(tmp_path: Path) -> Any:
    data = json.loads(TTOBENCH.read_text(encoding="utf-8"))

    def write(change: Any) -> Path:
        change(data)
        path = tmp_path / "track.json"
        path.write_text(json.dumps(data), encoding="utf-8")
        return path

    return write


def test_units_of_the_file_are_followed(track_file: Any) -> None:
    def in_km_and_mps(data: Any) -> None:
        data["stops"] = {"unit": "km", "values": [0.0, 2.631]}
        data["speed limits"] = {"units": {"position": "km", "velocity": "m/s"}, "values": [[0, 20], [1.5, 10]]}
        del data["gradients"]

    track = ttobench.load_line(track_file(in_km_and_mps))
    assert track.stops[1].position_m == pytest.approx(2631)
    assert track.line.speed_limit_mps == ((0.0, 20.0), (1500.0, 10.0))
    assert track.line.grade_permil == ((0.0, 0.0),)


@pytest.mark.parametrize(
    ("keys", "value", "words"),
    [
        (("metadata", "library version"), "TTOBench v2.0", "one of TTOBench v1.1, TTOBench v1.2"),
        (("speed limits", "units", "velocity"), "mph", "found 'mph'"),
        (("stops", "values"), [0, 5, 3], "found 3.0, allowed a position above 5.0"),
        (("speed limits", "values"), [[0, 50], [10, 0]], "a limit above 0"),
        (("gradients", "values"), [[0, "steep"]], "found 'steep', allowed a number"),
        (("stops",), 3, "stops: found 3"),
    ],
)
def test_bad_tracks_give_one_line(track_file: Any, keys: tuple[str, ...], value: Any, words: str) -> None:
    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value

    with pytest.raises(InputError) as caught:
        ttobench.load_line(track_file(change))
    assert "\n" not in str(caught.value)
    assert words in str(caught.value)


@pytest.mark.parametrize("text", ["{", "[]", "3", "\x00", "[" * 100_000])
def test_files_that_are_no_track(text: str, tmp_path: Path) -> None:
    path = tmp_path / "track.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        ttobench.load_line(path)
    assert "\n" not in str(caught.value)


# --- sections ------------------------------------------------------------------------------------------------


def test_a_section_starts_at_0_and_keeps_what_lies_under_the_train() -> None:
    line = Line(
        "l",
        ((0.0, 1.0), (900.0, 2.0), (1500.0, 3.0)),
        ((0.0, 20.0), (950.0, 10.0), (2500.0, 5.0)),
        (Balise(1, 500.0, 500.0), Balise(202, 1200.0, 1201.0)),
    )
    whole = StopLine(line, (Stop("a", 1000.0), Stop("b", 2000.0)))
    section = whole.section(0, 1, 120.0, (50.0, 0.0))
    assert section.grade_permil == ((-1000.0, 1.0), (-100.0, 2.0), (500.0, 3.0))
    assert section.speed_limit_mps == ((-1000.0, 20.0), (-50.0, 10.0))
    assert section.balises == (
        Balise(202, 200.0, 201.0),
        Balise(2, 0.0, 0.0),
        Balise(11, 950.0, 950.0),
        Balise(12, 1000.0, 1000.0),
    )


def user_scenario(folder: Path, train_table: str, line_table: str, plan: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(
        'schema_version = 1\nname = "mine"\ntitle = "t"\n'
        f"[train]\n{train_table}\n[line]\n{line_table}\n[plan]\nstop_error_max_m = 0.5\ntime_error_max_s = 1\n{plan}\n"
        "[target.generate]\naccel_max_mps2 = 0.5\nbraking_max_mps2 = 0.3\nend_braking_mps2 = 0.2\n"
        "[sensors]\nspeed_lsb_kmh = 0.01\nodometer_lsb_m = 0.01\n"
        "[energy]\nxi_m = 0.9\nxi_b = 0\nauxiliary_power_kw = 40\n",
        encoding="utf-8",
    )
    return path


def test_a_user_runs_a_railtoolkit_train_on_a_railtoolkit_path(tmp_path: Path) -> None:
    for kind, name in (("trains", "local"), ("paths", "speed")):
        source = RAILTOOLKIT / kind / f"{name}.yaml"
        (tmp_path / source.name).write_bytes(source.read_bytes())
    scenario = load(
        user_scenario(
            tmp_path,
            'railtoolkit = "local.yaml"\nactuator_pole_per_s = 0.34\naccel_per_notch_mps2 = 0.2',
            'railtoolkit = "speed.yaml"\nfrom_stop = "start"\nto_stop = "end"\nbalises_before_stop_m = [100, 10]',
            "distance_m = 10000\nrunning_time_reserve_percent = 5",
        )
    )
    assert scenario.train.name == "Regional Train"
    assert scenario.plan.running_time_s > 523.3
    assert Target(scenario.target).stop_position_m == pytest.approx(10_000, abs=1e-3)


def test_a_user_runs_on_a_ttobench_track(tmp_path: Path) -> None:
    (tmp_path / "track.json").write_bytes(TTOBENCH.read_bytes())
    scenario = load(
        user_scenario(
            tmp_path,
            'file = "lvshun_2m2t"',
            'ttobench = "track.json"\nfrom_stop = 2\nto_stop = "stop 4"',
            "distance_m = 4348\nrunning_time_s = 320",
        )
    )
    assert scenario.line.name == "CN_Songjiazhuang_Yizhuang: stop 2 - stop 4"
    assert scenario.target.nodes[-1][0] == pytest.approx(320)


def test_distance_and_stops_must_agree(tmp_path: Path) -> None:
    (tmp_path / "track.json").write_bytes(TTOBENCH.read_bytes())
    for line, plan, words in (
        ("from_stop = 2\nto_stop = 3", "distance_m = 2000", "plan.distance_m: found 2000.0, allowed 2366 m"),
        ("from_stop = 3\nto_stop = 2", "distance_m = 2366", "line.to_stop: found 2, allowed a stop behind"),
        ("from_stop = 3\nto_stop = 20", "distance_m = 2366", "line.to_stop: found 20, allowed one of stop 0"),
        ("from_stop = 3", "distance_m = 2366", "line.to_stop: missing"),
    ):
        path = user_scenario(
            tmp_path, 'file = "lvshun_2m2t"', f'ttobench = "track.json"\n{line}', plan + "\nrunning_time_s = 320"
        )
        with pytest.raises(InputError) as caught:
            load(path)
        assert words in str(caught.value)


def test_without_yaml_one_line_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "yaml", None)
    said = r"PyYAML is not installed; install it with .*PyYAML.* \(the extra \[railtoolkit\]\)"
    with pytest.raises(InputError, match=said):
        railtoolkit.load_train(RAILTOOLKIT / "trains" / "local.yaml", actuator_pole_per_s=0.4, accel_per_notch_mps2=0.1)
