"""``--set KEY=VALUE``: a layer above the scenario's files, checked like them and part of the evidence."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil
from hil_tests.unit.scenarios.test_scenarios_errors import toml_value
from railhil.audit.__main__ import main as audit
from railhil.campaign.plan import Request, make_plan
from railhil.common.errors import InputError
from railhil.plant_sim.command import main as plant
from railhil.scenarios.layers import Layers
from railhil.scenarios.load import RUNS, load
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.settings import normalise_setting
from railhil.systems.ato.scenario.canonical import judged_sha256
from railhil.tuning.__main__ import main as tune

NAME = "lvshun_tieshan"


def test_a_setting_is_a_key_of_the_scenario() -> None:
    plain = load(NAME)
    changed = load(NAME, ["plan.stop_error_max_m=0.5", "plan.stop_error_max_m=0.4", "title=wider window"])
    assert (changed.plan.stop_error_max_m, changed.title) == (0.4, "wider window")
    assert changed.name == plain.name
    # What judges a run changes no frame of it.
    assert changed.sha256 == plain.sha256
    assert judged_sha256(changed) != judged_sha256(plain)
    assert load(NAME, ["timing.loop_delay_s=0.05"]).sha256 != plain.sha256
    assert load(NAME, [f"plan.stop_error_max_m={plain.plan.stop_error_max_m}"]).sha256 == plain.sha256
    lines = load(NAME, ["line.balises=[{number = 7, surveyed_m = 100}]"]).line
    assert [balise.number for balise in lines.balises] == [7]
    assert load(NAME, ["train.file=yizhuang_b6"]).train.name == load("yizhuang_05").train.name


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("plan", "--set: found 'plan', allowed KEY=VALUE"),
        ("=3", "allowed KEY=VALUE"),
        ("plan..x=3", "allowed KEY=VALUE"),
        ("name=other", "--set: name: found 'other', allowed a key that does not say which"),
        ("extends=lvshun_tieshan", "--set: extends: found 'lvshun_tieshan'"),
        ("plan.stop_eror_max_m=3", "--set: plan.stop_eror_max_m: unknown key"),
        ("plan.stop_error_max_m=wide", "--set: plan.stop_error_max_m: found 'wide', allowed a number"),
        ("plan.stop_error_max_m=1\nplan = 3", "--set: plan.stop_error_max_m: found '1\\nplan = 3'"),
        ("plan.stop_error_max_m=" + 5000 * "9", "--set: plan.stop_error_max_m: found "),
        ("line.speed_limit_kmh=[[0, 60]]", "--set: line.speed_limit_kmh: found [[0, 60]], allowed what goes with"),
        ("timing.base_tick_ms=7", "--set: timing.base_tick_ms: found 7, allowed what goes with lvshun_tieshan.toml ("),
        ("train.file=nowhere", "--set: train.file: found 'nowhere'"),
    ],
)
def test_a_bad_setting_is_one_line_and_blamed_itself(text: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        load(NAME, [normalise_setting(text)])
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_two_settings_that_cannot_both_hold() -> None:
    with pytest.raises(InputError, match="a key below a table"):
        load(NAME, ["plan=3", "plan.distance_m=3"])


def test_a_named_file_is_found_from_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "train.toml").write_text("", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert normalise_setting("train.file=train.toml") == f'train.file="{tmp_path / "train.toml"}"'
    assert normalise_setting("train.file=yizhuang_b6") == "train.file=yizhuang_b6"


@pytest.mark.slow
def test_a_run_with_settings_can_be_scored_and_made_again(tmp_path: Path) -> None:
    path = tmp_path / "quick.toml"
    path.write_text(QUICK_TOML, encoding="utf-8")
    given = ["plan.stop_error_max_m=50", "plan.time_error_max_s=50"]
    words = [word for text in given for word in ("--set", text)]
    done = railhil("run", path, *words, "--bus", "local", "--no-report", "--out", tmp_path / "one", "--json")
    assert done.exit_code == 0, done.err
    certificate = json.loads((tmp_path / "one" / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["settings"] == given
    assert certificate["scenario_sha256"] == load(path).sha256
    assert certificate["judged_sha256"] == judged_sha256(load(path, given)) != judged_sha256(load(path))
    assert railhil("score", tmp_path / "one").exit_code == 0
    again = shlex.split(certificate["command"])[1:]
    assert railhil(*again, "--no-report", "--out", tmp_path / "two").exit_code == 0
    logs = [(tmp_path / name / "frames.log").read_bytes() for name in ("one", "two")]
    assert logs[0] == logs[1]


def test_a_campaign_hands_its_settings_on() -> None:
    plan = make_plan(Request(runs=1, settings=("plan.stop_error_max_m=0.5",)))
    assert plan.scenario.plan.stop_error_max_m == 0.5
    words = ["run", *plan.run(plan.entries[0], 1000).words]
    assert words[:4] == ["run", NAME, "--set", "plan.stop_error_max_m=0.5"]


def test_nothing_to_draw_is_said_and_not_silently_nominal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Layers(RUNS / f"{NAME}.toml").merge()
    del whole["perturbations"]
    path = tmp_path / "nominal.toml"
    path.write_text("\n".join(f"{key} = {toml_value(value)}" for key, value in whole.items()), encoding="utf-8")

    def program(main: Callable[[], int], *words: str) -> Callable[[], object]:
        def call() -> object:
            monkeypatch.setattr("sys.argv", ["program", *words])
            return main()

        return call

    for made in (
        lambda: RunSpec(str(path), perturbed=True).load(),
        program(plant, str(path), "--perturbed"),
        lambda: make_plan(Request(str(path))),
        program(tune, "ipfc", str(path)),
        program(audit, str(path), "--runs", "1"),
    ):
        with pytest.raises(InputError, match=r"lvshun_tieshan, which has nothing to draw \(no \[perturbations\]"):
            made()
