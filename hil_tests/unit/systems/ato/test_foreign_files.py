"""Files of other tools with keys that are not read, keys that stand twice, aliases, and profiles that begin late."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.common.errors import InputError
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.importers import railtoolkit, ttobench

VALLEY = TEST_DATA / "railtoolkit" / "paths" / "valley_2024_07.yaml"
LOCAL = TEST_DATA / "railtoolkit" / "trains" / "local.yaml"
TUNNELS = TEST_DATA / "ttobench" / "two_tunnels.json"


def changed(tmp_path: Path, source: Path, old: str, new: str) -> Path:
    text = source.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / source.name
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def read_path(path: Path) -> tuple[str, ...]:
    return railtoolkit.load_line(path, train_length_m=100.0).remarks


def read_train(path: Path) -> object:
    return railtoolkit.load_train(path, actuator_pole_per_s=0.3, accel_per_notch_mps2=0.2)


#: Ten lines that stand for 9 ** 10 values.
BOMB = "\n".join(
    ["a0: &a0 [x, x, x, x, x, x, x, x, x]", *(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 10))]
)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("schema: https://railtoolkit.org/schema/running-path.json", "schema: *a9"),
        ('schema_version: "2024.07"', "schema_version: *a9"),
        ("position: 200", "position: *a9"),
        ("      - position: 0.0\n        speed: 60\n", "      - *a9\n"),
        ("speed: 80", "<<: [{speed: 3}, {speed: 4}]\n        resistance: *a9"),
    ],
)
def test_aliases_are_one_line_at_once(old: str, new: str, tmp_path: Path) -> None:
    path = changed(tmp_path, changed(tmp_path, VALLEY, old, new), "---\n", f"---\n{BOMB}\n")
    with pytest.raises(
        InputError, match=r"cannot be read, .*\(aliases are not read, and the value in line \d+ has one\)$"
    ):
        read_path(path)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("speed: 80", "sped: 80", "valley.characteristic_sections[1].sped: unknown key, .*did you mean speed?"),
        ("resistance: 5.0", "resistence: 5.0", "characteristic_sections[3].resistence: unknown key"),
        ("points_of_interest", "point_of_interest", "paths valley.point_of_interest: unknown key"),
        ("measure: front", "measure: front\n        Label: a", "points_of_interest[2].Label: unknown key"),
        ("speed: 80", "speed: 80\n        speed: 30", "the key speed stands there twice, again in line 27"),
        ("position: 200", "1: 200", "points_of_interest[0]"),
    ],
)
def test_a_mistyped_key_of_a_path_is_one_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_path(changed(tmp_path, VALLEY, old, new))
    for part in words.split(".*"):
        assert part in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("load_limit", "load_limt"),
        ("rotation_mass", "rotating_mass"),
        ("tractive_effort", "tractive_efforts"),
        ("speed_limit", "Speed_limit"),
        ("mass: 68.0", "mass: 68.0\n    mass: 60.0"),
    ],
)
def test_a_mistyped_key_of_a_train_is_one_line(old: str, new: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"vehicles DB_BR_642\.\w+: unknown key|mass stands there twice"):
        read_train(changed(tmp_path, LOCAL, f"    {old}", f"    {new}"))


def test_what_is_known_by_other_names_is_named_in_a_remark(tmp_path: Path) -> None:
    path = changed(tmp_path, VALLEY, "resistance: -8.0", "gradient: -8.0\n        id: b")
    path = changed(tmp_path, path, "description:", "groups: [a]\n    description:")
    assert read_path(path)[0].startswith(
        "not used of its file: groups, characteristic_sections.gradient, 1 of the points"
    )
    assert read_path(path)[1] == "level where its file has no resistance: 0 to 1200 m"
    read_train(changed(tmp_path, LOCAL, "    length", "    owner: someone\n    length"))


@pytest.fixture
def track_file(tmp_path: Path) -> Any:
    def write(**change: object) -> Path:
        path = tmp_path / "track.json"
        track = json.loads(TUNNELS.read_text(encoding="utf-8")) | {
            key.replace("_", " "): value for key, value in change.items()
        }
        path.write_text(json.dumps({key: value for key, value in track.items() if value is not None}), encoding="utf-8")
        return path

    return write


def test_a_track_has_remarks_on_unknown_keys_and_on_missing_gradients(track_file: Any) -> None:
    found = ttobench.load_line(track_file(gradients=None, signals=[1]))
    assert found.remarks == ("not used of its file: curvatures, tunnels, signals", "level: its file has no gradients")
    with pytest.raises(InputError, match=r"gradient: unknown key, expected one of .*did you mean gradients\?"):
        ttobench.load_line(track_file(gradients=None, gradient={}))
    limits = json.loads(TUNNELS.read_text(encoding="utf-8"))["speed limits"]
    with pytest.raises(InputError, match=r"speed limits\.value: unknown key"):
        ttobench.load_line(track_file(speed_limits=limits | {"value": []}))


def scenario_on(folder: Path, line: str, distance_m: float) -> Path:
    path = folder / "mine.toml"
    path.write_text(
        'schema_version = 1\nname = "mine"\ntitle = "t"\n[train]\nfile = "yizhuang_b6"\n'
        f"[line]\n{line}\n[plan]\ndistance_m = {distance_m}\nrunning_time_reserve_percent = 8\n"
        "stop_error_max_m = 0.5\ntime_error_max_s = 3\n[target.generate]\n",
        encoding="utf-8",
    )
    return path


def test_a_profile_that_begins_behind_the_start_is_a_remark(track_file: Any, tmp_path: Path) -> None:
    limits = {"units": {"position": "km", "velocity": "km/h"}, "values": [[0.5, 50], [0.7, 60]]}
    path = track_file(speed_limits=limits)
    late = "line: the first speed limit, 50 km/h, begins at 500 m and is taken to hold from 0 m"
    assert late in load(scenario_on(tmp_path, f'ttobench = "{path.name}"\nfrom_stop = 0\nto_stop = 1', 900)).assumptions
    from_the_second = load(scenario_on(tmp_path, f'ttobench = "{path.name}"\nfrom_stop = 1\nto_stop = 2', 1300))
    assert not [words for words in from_the_second.assumptions if "taken to hold" in words]


def test_an_own_profile_that_begins_behind_the_start_is_a_remark(tmp_path: Path) -> None:
    own = 'name = "own"\ngrade_permil = [[{0}, 4]]\nspeed_limit_kmh = [[{0}, 50]]'
    assert [words for words in load(scenario_on(tmp_path, own.format(100), 900)).assumptions if "100 m" in words] == [
        "line: the first grade, 4 permil, begins at 100 m and is taken to hold from 0 m",
        "line: the first speed limit, 50 km/h, begins at 100 m and is taken to hold from 0 m",
    ]
    assert not [words for words in load(scenario_on(tmp_path, own.format(0), 900)).assumptions if "hold" in words]
