"""``railhil new line`` and ``railhil new scenario``: the files that they write are scenarios."""

from __future__ import annotations

import json
import re
import shlex
import tomllib
from dataclasses import replace

from hil_tests.support.cli import complaint
from railhil.scenarios.load import load
from railhil.scenarios.system import system_named
from railhil.systems.ato.scenario.keys import USUAL


def uncommented(text: str) -> str:
    """The scenario with every key that it offers."""
    return re.sub(r"^#(?=\w)", "", text, flags=re.MULTILINE)


def test_a_scenario_with_all_its_keys_is_the_one_that_it_builds_upon(here, tmp_path):
    for base in ("lvshun_tieshan", "yizhuang_05", "lvshun_tieshan_worn_wheels"):
        path = tmp_path / f"on_{base}.toml"
        assert here("new", "scenario", "myrun", "--extends", base, "--out", path).exit_code == 0
        text = path.read_text(encoding="utf-8")
        found, expected = load(path), load(base)
        assert (found.name, found.title) == ("myrun", f"myrun, based on {expected.name}")
        alike = replace(expected, name=found.name, title=found.title, sha256=found.sha256)
        assert found == alike
        path.write_text(uncommented(text), encoding="utf-8")
        assert load(path) == alike
        assert uncommented(text).count("\nstop_error_max_m = ") == 1
        assert here("scenarios", path).exit_code == 0


def test_a_scenario_explains_its_keys_as_the_reference_does(here, tmp_path):
    here("new", "scenario", "myrun")
    lines = (tmp_path / "myrun.toml").read_text(encoding="utf-8").splitlines()
    known = {key.name: key for key in system_named("ato").scenario_kind.list_keys()}
    assert set(USUAL) <= known.keys()
    place = lines.index("#control_period_ms = 500")
    key = known["timing.control_period_ms"]
    assert lines[place - 1] == f"# {key.meaning} (in {key.unit}; default {key.default}; {key.allowed})"
    assert "#wheel_factor = 1.0" in lines, "a default that no file says"
    assert "# mass with its load (in t; no default; number above 0 to 1e7)" in lines
    assert not [line for line in lines if line.startswith("#running_time_reserve_percent")]


def test_a_line_of_its_own_inherits_nothing_and_is_a_pass_at_once(here, tmp_path):
    """By the commands that it proposes; and without the keys that have defaults."""
    proposed = here("new", "line", "mine", "--json").json["next"]
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    assert "extends" not in text
    assert "file =" not in text
    assert len(text.splitlines()) < 50
    for command in proposed:
        words = shlex.split(command)[1:]
        if words[0] == "run":
            words += ["--bus", "local", "--no-report", "--out", "run"]
        assert here(*words).exit_code == 0, command
    assert json.loads((tmp_path / "run" / "certificate.json").read_text())["verdict"] == "PASS"
    scenario = load(tmp_path / "mine.toml")
    assert scenario.can_be_perturbed
    assert (scenario.sensors.odometer_lsb_m, scenario.energy.xi_m) == (0.01, 0.88)


def test_a_scenario_may_build_upon_a_file_elsewhere(here, tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    assert here("new", "scenario", "one", "--out", "a/one.toml").exit_code == 0
    assert here("new", "scenario", "two", "--extends", "a/one.toml", "--out", "b/two.toml").exit_code == 0
    assert tomllib.loads((tmp_path / "b/two.toml").read_text())["extends"] == "../a/one.toml"
    assert load(tmp_path / "b" / "two.toml").plan == load("lvshun_tieshan").plan


def test_a_changed_key_that_is_wrong_is_named_with_its_file(here, tmp_path):
    here("new", "scenario", "myrun")
    path = tmp_path / "myrun.toml"
    path.write_text(path.read_text().replace("#stop_error_max_m = 0.3", "stop_error_max_m = -1"))
    assert complaint(here("scenarios", "myrun.toml")).startswith("railhil: myrun.toml: plan.stop_error_max_m: found -1")
