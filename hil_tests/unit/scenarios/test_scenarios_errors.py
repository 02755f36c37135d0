"""Bad scenario files: always one line that names the file, the key, what was found and what is allowed."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from railhil.common.errors import InputError, Sentence, Words, nearest_key
from railhil.scenarios.layers import Layers
from railhil.scenarios.load import RUNS, load, load_any, short_names, stable_name
from railhil.scenarios.model import require_perturbations
from railhil.systems.ato.scenario.model import Perturbations

HEAD = 'extends = "lvshun_tieshan"\nname = "mine"\ntitle = "t"\n'

CASES = {
    "unit": ("[train]\nmass_kg = 3", "train.mass_kg", "did you mean mass_t?"),
    "unit of speed": ("[line]\nspeed_limit_mps = [[0, 3]]", "line.speed_limit_mps", "did you mean speed_limit_kmh?"),
    "spelling": ("[plan]\ndistanze_m = 3", "plan.distanze_m", "did you mean distance_m?"),
    "negative": ("[train]\nmass_t = -3", "train.mass_t", "found -3, allowed at least 1e-09"),
    "notch grid": ("[train]\nnotch_max = 6.501953125", "train.notch_max", "allowed a multiple of 0.00390625"),
    "text": ('[train]\nmass_t = "x"', "train.mass_t", "found 'x', allowed a number"),
    "bool": ("[train]\nmass_t = true", "train.mass_t", "found True, allowed a number"),
    "huge": ("[train]\nmass_t = 1" + 400 * "0", "train.mass_t", "a number"),
    "infinite": ("[train]\nmass_t = inf", "train.mass_t", "finite"),
    "not a table": ("train = 3", "train", "found 3, allowed a table"),
    "both masses": ("[train]\ninertial_mass_t = 230", "train", "exactly one of rotating_mass_factor and inertial"),
    "both notches": ("[train]\naccel_per_notch_mps2 = 0.2", "train", "exactly one of force_per_notch_n and accel"),
    "davis": ("[train.davis]\nd = 3", "train.davis.d", "a_n_per_kn, b_n_per_kn_kmh, c_n_per_kn_kmh2"),
    "effort rows": ("[train.traction]\ncurve_kmh_kn = [[5, 1], [0, 2]]", "train.traction.curve_kmh_kn[1]", "more than"),
    "distance": ("[plan]\ndistance_m = 2941", "plan.distance_m", "allowed 2940.0000 m"),
    "time": ("[plan]\nrunning_time_s = 190", "plan.running_time_s", "allowed 195.0000 s"),
    "tick": ("[timing]\nbase_tick_ms = 0", "timing.base_tick_ms", "at least"),
    "period": ("[timing]\ncontrol_period_ms = 505", "timing.control_period_ms", "whole multiple of base_tick_ms = 10"),
    "port": ("[timing.port_period_ms]\nTRN_SPEED = 16", "timing.port_period_ms.TRN_SPEED", "whole multiple"),
    "port name": ("[timing.port_period_ms]\nspeed = 20", "timing.port_period_ms.speed", "no such port"),
    "port of another name": (
        "[timing.port_period_ms]\nTRN_SPED = 20",
        "timing.port_period_ms.TRN_SPED",
        "one of TIME_SYNC, SUP_CMD, NOTCH_CMD,",
    ),
    "port without a period": (
        "[timing.port_period_ms]\nRUN_EVENT = 20",
        "timing.port_period_ms.RUN_EVENT",
        "no such port",
    ),
    "too far": ("[plan]\ndistance_m = 400_001", "plan.distance_m", "found 400001, allowed at most 400000"),
    "too long": ("[plan]\nrunning_time_s = 28_801", "plan.running_time_s", "found 28801, allowed at most 28800"),
    "delay": ("[timing]\nloop_delay_s = 0.31", "timing.loop_delay_s", "found 0.31, allowed 0 to 0.3 s"),
    "delay over period": (
        "[timing]\ncontrol_period_ms = 200\nloop_delay_s = 0.25",
        "timing.loop_delay_s",
        "0 to 0.2 s",
    ),
    "drawn delay": ("[perturbations]\nloop_delay_s = [0, 0.4]", "perturbations.loop_delay_s", "0 to 0.3 s"),
    "bounds": ("[perturbations]\nmass_factor = [1.1, 0.9]", "perturbations.mass_factor", "low <= high"),
    "factor": ("[perturbations]\nmass_factor = [-1, 1]", "perturbations.mass_factor", "factors above 0"),
    "noise": ("[perturbations]\nspeed_noise_sigma_kmh = [-1, 1]", "perturbations.speed_noise_sigma_kmh", "at least 0"),
    "ladder": ("[watch]\nhold_ms = 64", "watch.traction_cut_ms", "found 64, allowed more than hold_ms = 64"),
    "rows": ("[line]\ngrade_permil = [[0, 1], [0, 2]]", "line.grade_permil[1]", "increasing"),
    "steep": ("[line]\ngrade_permil = [[0, 300]]", "line.grade_permil[0]", "-200 to 200 permil"),
    "row length": ("[line]\ngrade_permil = [[0, 1, 2]]", "line.grade_permil[0]", "at most 2 values"),
    "row too short": ("[line]\ngrade_permil = [[0]]", "line.grade_permil[0][1]", "missing"),
    "no rows": ("[line]\ngrade_permil = []", "line.grade_permil", "at least 1"),
    "limit 0": ("[line]\nspeed_limit_kmh = [[0, 0]]", "line.speed_limit_kmh[0]", "above 0"),
    "over the limit": ("[line]\nspeed_limit_kmh = [[0, 60]]", "line.speed_limit_kmh", "60.00 km/h there"),
    "balise twice": (
        "[line]\nbalises = [{number = 1, surveyed_m = 3}, {number = 1, surveyed_m = 4}]",
        "line.balises[1].number",
        "a number that none of the 15 balises before and behind it has",
    ),
    "balise number": ("[line]\nbalises = [{number = 256, surveyed_m = 3}]", "line.balises[0].number", "255"),
    "balise key": ("[line]\nbalises = [{number = 1, position_m = 3}]", "line.balises[0].position_m", "surveyed_m"),
    "stop without stops": ('[line]\nfrom_stop = "A"\nto_stop = "B"', "line.from_stop", "the line has none"),
    "stops without a choice": (
        '[line]\nstops = [{name = "A", position_m = 0}, {name = "B", position_m = 9}]',
        "line.stops",
        'found 2 stops in system ato, allowed 2 of them by from_stop and to_stop; several stops: system = "line"',
    ),
    "stop of a name that stands twice": (
        '[line]\nfrom_stop = "A"\nto_stop = "B"\nstops = [{name = "A", position_m = 0}, {name = "A", position_m = 9}]',
        "line.from_stop",
        "one of their numbers 0, 1",
    ),
    "two lines": ('[line]\nttobench = "there.json"\ngrade_permil = [[0, 0]]', "line", "profiles and ttobench"),
    "stray balises": (
        "[line]\nbalises_before_stop_m = [3]",
        "line.balises_before_stop_m",
        "used only with line.from_stop",
    ),
    "no such file": ('[line]\nttobench = "nix.json"', "line.ttobench", "a file that exists"),
    "no such train": ('[train]\nfile = "nix"', "train.file", "one of lvshun_2m2t, yizhuang_b6"),
    "file is no text": ("[train]\nfile = 3", "train.file", "found 3"),
    "node times": ("[target]\nnodes_s_mps2 = [[0, 0], [2, 1], [1, -1]]", "target.nodes_s_mps2[2]", "increasing"),
    "first node": ("[target]\nnodes_s_mps2 = [[1, 0], [2, -1]]", "target.nodes_s_mps2[0]", "time 0"),
    "last node": ("[target]\nnodes_s_mps2 = [[0, 0], [2, 1]]", "target.nodes_s_mps2[1]", "below 0"),
    "one node": ("[target]\nnodes_s_mps2 = [[0, -1]]", "target.nodes_s_mps2", "at least two nodes"),
    "never moves": ("[target]\nnodes_s_mps2 = [[0, 0], [2, -1]]", "target.nodes_s_mps2", "never comes to a stop"),
    "impossible time": (
        "[plan]\nrunning_time_s = 90\n[target.generate]",
        "target.generate",
        "shorter than the fastest",
    ),
    "version": ("schema_version = 2", "schema_version", "found 2, allowed 1"),
}


def one_line(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        load(path)
    text = str(caught.value)
    assert "\n" not in text
    return text


@pytest.mark.parametrize("case", CASES)
def test_one_line_names_file_key_found_and_allowed(case: str, tmp_path: Path) -> None:
    body, key, words = CASES[case]
    path = tmp_path / "mine.toml"
    (tmp_path / "there.json").write_text("{}", encoding="utf-8")
    head = "" if body.startswith("train =") else HEAD
    path.write_text(head + body + "\n" + (HEAD if not head else ""), encoding="utf-8")
    text = one_line(path)
    assert f".toml: {key}: " in text
    assert words in text


def test_the_message_names_the_file_that_has_the_key(tmp_path: Path) -> None:
    (tmp_path / "my_train.toml").write_text("mass_t = 3\nmass_kg = 4\n", encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(HEAD + '[train]\nfile = "my_train.toml"\n', encoding="utf-8")
    assert one_line(path).startswith(f"{tmp_path / 'my_train.toml'}: train.mass_kg: ")


def test_a_missing_key_names_the_table_that_should_have_it(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('schema_version = 1\nname = "mine"\ntitle = "t"\n[train]\nmass_t = 3\n', encoding="utf-8")
    assert one_line(path) == (
        f"{path}: train.name, train.length_m, train.davis, train.traction, train.brake, train.actuator_pole_per_s, "
        "line, target, plan: missing, expected values: the keys are required"
    )
    path.write_text(HEAD + "[[line.balises]]\nnumber = 1\n", encoding="utf-8")
    assert one_line(path) == f"{path}: line.balises[0].surveyed_m: missing, expected a value: the key is required"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a = [[[", "TOML 1.0"),
        ("[a]\n[a]\n", "TOML 1.0"),
        ("a = " + 5000 * "[", "more than 32 deep"),
        ("a = " + 33 * "[" + 33 * "]", "more than 32 deep"),
        (4000 * "a." + "a = 1", "more than 32 deep"),
        ("a = " + 5000 * "9", "thousands of digits"),
        ("a = " + 4000 * "9", "unknown key"),
        ('extends = "mine.toml"\n', "at most 8 files"),
        ('extends = "nix"\n', "lvshun_tieshan, lvshun_tieshan_worn_wheels"),
        ('extends = "nix.toml"\n', "a file that exists"),
        ("extends = 3\n", "shipped name"),
        ("", "schema_version, name, title, train, line, target, plan: missing"),
    ],
)
def test_files_that_are_no_scenario(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    assert words in one_line(path)


def test_a_file_that_is_not_text(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_bytes(b"a = \xff\xfe")
    assert "UTF-8" in one_line(path)


@pytest.mark.parametrize("name", ["lvshun", "", "nix.toml", "/", "lvshun_tieshan.toml"])
def test_names_that_are_no_scenario(name: str) -> None:
    with pytest.raises(InputError) as caught:
        load(name)
    assert "\n" not in str(caught.value)


def test_a_name_nearly_right_gets_a_hint() -> None:
    with pytest.raises(InputError, match=r"did you mean lvshun_tieshan\?"):
        load("lvshun_tieshn")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("yizhuang_5", "(did you mean yizhuang_05?)"),
        ("Lvshun_Tieshan", "(did you mean lvshun_tieshan?)"),
        ("lvshun", "one of lvshun_tieshan, lvshun_tieshan_worn_wheels"),
        ("mine", "(did you mean mine.toml?)"),
        ("mime.toml", "mime.toml: does not exist, expected a scenario file (TOML) (did you mean mine.toml?)"),
    ],
)
def test_a_name_that_is_none_is_answered_with_one_that_is(
    name: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").touch()
    with pytest.raises(InputError) as caught:
        load(name)
    assert str(caught.value).endswith(words)


def test_the_beginning_of_a_name_is_enough() -> None:
    for name, short in short_names().items():
        assert load_any(short).name == name
    assert short_names()["yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan"] == "yizhuang_05"
    assert short_names()["lvshun_tieshan"] == "lvshun_tieshan"
    assert stable_name("yizhuang_05") == "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan"


#: What breaks a shipped file, the key that did, and the check that noticed.
BREAKS = {
    "speed limit": ("[line]\nspeed_limit_kmh = [[0, 60]]", "line.speed_limit_kmh: found [[0, 60]]", "target: found "),
    "control period": ("[timing]\nbase_tick_ms = 7", "timing.base_tick_ms: found 7", "timing.control_period_ms: "),
    "curve": (
        "[target]\nnodes_s_mps2 = [[0, 0.5], [4, 0.5], [5, -0.5], [9, -0.5]]",
        "target.nodes_s_mps2: found ",
        "plan.distance_m: found 2940",
    ),
}


@pytest.mark.parametrize("case", BREAKS)
def test_an_own_file_that_breaks_what_it_builds_upon_is_blamed_itself(case: str, tmp_path: Path) -> None:
    body, blamed, noticed = BREAKS[case]
    path = tmp_path / "mine.toml"
    path.write_text(HEAD + "[energy]\nxi_m = 0.9\n" + body, encoding="utf-8")
    text = one_line(path)
    assert text.startswith(f"{path}: {blamed}")
    assert f"({noticed}" in text
    assert ", allowed what goes with lvshun_tieshan.toml (" in text


def test_a_scenario_that_leaves_nothing_to_draw_has_no_perturbed_runs() -> None:
    scenario = replace(load("lvshun_tieshan"), perturbations=Perturbations())
    with pytest.raises(InputError, match=r"--perturbed: .* which has nothing to draw \(no \[perturb"):
        require_perturbations(scenario, "--perturbed")
    require_perturbations(load("lvshun_tieshan_worn_wheels"), "--perturbed")


def test_a_shipped_file_has_its_own_name() -> None:
    assert all(Layers(path).merge()["name"] == path.stem for path in RUNS.glob("*.toml"))


def test_input_error_is_one_line_whatever_it_holds() -> None:
    error = InputError("a\nb.toml", "k\ty", "x\n" * 200, "a\n b", hint="c\nd")
    assert str(error).count("\n") == 0
    assert len(str(error)) < 200
    assert str(InputError("f", "k", Words(), "a value")) == "f: k: missing, expected a value"


def test_a_sentence_replaces_found_and_allowed_in_the_line_only() -> None:
    error = InputError("f", "--jobs", 2, Sentence("used only\nwith --engine processes"), "d")
    assert str(error) == "f: --jobs: used only with --engine processes (d)"
    assert (error.found, "--engine processes" in error.allowed) == (2, True)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_nearest_key_prefers_the_same_name_in_another_unit() -> None:
    assert nearest_key("mass_kg", ["mass_t", "mast_kg"]) == "mass_t"
    assert nearest_key("zzz", ["mass_t"]) is None


# --- any value anywhere --------------------------------------------------------------------------------------


def toml_value(value: Any) -> str:
    """A value as TOML on one line (tables inline)."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return json.dumps(value)


def places(value: Any, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, item in items for place in places(item, (*path, key)))]


def with_value(value: Any, path: tuple[str | int, ...], new: Any) -> Any:
    if not path:
        return new
    copy: Any = dict(value) if isinstance(value, dict) else list(value)
    copy[path[0]] = with_value(value[path[0]], path[1:], new)
    return copy


WHOLE = Layers(RUNS / "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan.toml").merge()
PLACES = [place for place in places(WHOLE) if place]
STRANGE = st.one_of(
    st.integers(),
    st.floats(),
    st.sampled_from([0, -1, 1e-300, 1e308, 10**400, "", "x", True, [], {}, [[]], {"a": 1}, [0, 0]]),
    st.lists(st.lists(st.floats(-1e9, 1e9), min_size=2, max_size=2), max_size=3),
)


@pytest.mark.slow
@given(st.sampled_from(PLACES), STRANGE)
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_strange_value_loads_or_gives_one_line(tmp_path: Path, place: tuple[str | int, ...], value: Any) -> None:
    table = with_value(WHOLE, place, value)
    path = tmp_path / "mine.toml"
    path.write_text("\n".join(f"{key} = {toml_value(item)}" for key, item in table.items()), encoding="utf-8")
    outcome: object
    try:
        outcome = load(path)
    except InputError as error:
        outcome = error
    assert len(str(outcome).splitlines()) == 1
