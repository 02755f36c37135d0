"""A scenario that is based on another one says nothing of the other's run as if it were its own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support import shipped
from railhil.common.errors import InputError
from railhil.scenarios.layers import COMPLETE
from railhil.scenarios.load import load, load_any
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.schema import TrainTable

_OWN_LINE = '[line]\nname = "Elsewhere"\ngrade_permil = [[0, 0]]\nspeed_limit_kmh = [[0, 78]]\n'
_OWN_TRAIN = """[train]
name = "light"
mass_t = 200
rotating_mass_factor = 0.06
length_m = 80
actuator_pole_per_s = 0.34
accel_per_notch_mps2 = 0.2
davis = { a_n_per_kn = 2.0, b_n_per_kn_kmh = 0.008, c_n_per_kn_kmh2 = 0.00045 }
traction = { force_max_kn = 215 }
brake = { force_max_kn = 270 }
"""


def based(tmp_path: Path, body: str, settings: Sequence[str] = ()) -> Scenario:
    path = tmp_path / "mine.toml"
    path.write_text(f'extends = "lvshun_tieshan"\nname = "mine"\ntitle = "mine"\n{body}', encoding="utf-8")
    return load(path, settings)


def said_of(scenario: Scenario, begin: str) -> list[str]:
    return [sentence for sentence in scenario.assumptions if sentence.startswith(begin)]


@pytest.mark.parametrize(
    ("body", "changed"),
    [
        ("[train]\nmass_t = 215\n", "train.mass_t"),
        ("[line]\ngrade_permil = [[0, 1]]\n", "line.grade_permil"),
        ("[energy]\nxi_m = 0.9\n", "energy.xi_m"),
        ("[target.generate]\n", "target"),
        (_OWN_LINE, "line"),
        (_OWN_TRAIN, "train"),
    ],
)
def test_results_of_a_paper_are_left_out_of_another_run_and_that_is_said(
    tmp_path: Path, body: str, changed: str
) -> None:
    found = based(tmp_path, body)
    assert found.published == ()
    assert said_of(found, f"changed here: {changed}; sentences about them are those of lvshun_tieshan")
    assert said_of(found, "the published results of lvshun_tieshan are left out")


@pytest.mark.parametrize("setting", ["train.mass_t=215", "line.grade_permil=[[0, 1]]"])
def test_so_they_are_with_a_setting(setting: str) -> None:
    found = load("lvshun_tieshan", [setting])
    assert found.published == ()
    assert said_of(found, f"changed here: {setting.partition('=')[0]};")


def test_a_title_that_is_inherited_is_said_too() -> None:
    (said,) = said_of(load("lvshun_tieshan", ["train.mass_t=215"]), "changed here")
    assert said == "changed here: train.mass_t; sentences about them, and the title, are those of lvshun_tieshan"


@pytest.mark.parametrize("body", ["", "[plan]\nstop_error_max_m = 0.2\n", "[train]\nmass_t = 211\n[line]\n"])
def test_the_same_run_keeps_them(tmp_path: Path, body: str) -> None:
    assert based(tmp_path, body).published == load("lvshun_tieshan").published != ()


def test_other_conditions_keep_them_and_a_base_s_own_sentences_stay() -> None:
    worn = load("lvshun_tieshan_worn_wheels")
    assert worn.published == load("lvshun_tieshan").published
    assert not said_of(worn, "changed here")
    for name in shipped.ATO:
        assert not said_of(load(name), "changed here")


def test_a_complete_section_inherits_nothing(tmp_path: Path) -> None:
    line = based(tmp_path, _OWN_LINE).line
    assert (line.name, line.balises) == ("Elsewhere", ())
    assert not said_of(based(tmp_path, _OWN_LINE), "line: ")
    own = based(tmp_path, _OWN_TRAIN)
    assert own.train.traction.power_max_w is None, "2550 kW are those of the train of the base"
    assert not said_of(own, "train: ")
    assert {*COMPLETE["train"]} == {key for key, field in TrainTable.model_fields.items() if field.is_required()}


def extended(path: Path, without: str, rest: str = "", base: str = "yizhuang_05") -> Path:
    head = f'schema_version = 1\nname = "mine"\ntitle = "t"\nextends = "{base}"\nwithout = {without}\n'
    path.write_text(head + rest, encoding="utf-8")
    return path


def test_a_key_can_be_left_out_of_what_is_inherited(tmp_path: Path) -> None:
    """From the base, from its base and from a file that it names; the file's own value of the key stays."""
    base = load("yizhuang_05")
    keys = '["plan.running_time_s", "perturbations.wheel_factor", "line.balises_before_stop_m", "energy"]'
    rest = "[target.generate]\n[plan]\nrunning_time_reserve_percent = 10\n[energy]\nxi_m = 0.9\n"
    path = extended(tmp_path / "mine.toml", keys, rest)
    found = load(path)
    assert base.perturbations.wheel_factor is not None
    assert replace(found.perturbations, wheel_factor=base.perturbations.wheel_factor) == base.perturbations
    assert found.perturbations.wheel_factor is None
    assert found.line.balises == ()
    assert found.plan.running_time_s > base.plan.running_time_s
    assert found.energy.xi_m == 0.9
    assert said_of(found, "changed here: ")
    again = extended(tmp_path / "again.toml", '["energy.xi_m"]', base="mine.toml")
    assert load(again).energy.xi_m == 0.88
    assert load(again).perturbations == found.perturbations


@pytest.mark.parametrize(
    ("without", "words"),
    [
        ('["perturbations.wheel"]', "without: found 'perturbations.wheel', allowed a key that the extended"),
        ("3", "without: found 3, allowed an array of keys"),
        ('[""]', "without: found ['"),
        ('["plan"]', "plan.distance_m, plan.stop_error_max_m, plan.time_error_max_s: missing"),
    ],
)
def test_what_cannot_be_left_out_is_one_line(without: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        load(extended(tmp_path / "mine.toml", without, "[plan]\nrunning_time_s = 94\n"))


def test_without_needs_a_base(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('without = ["plan"]\n', encoding="utf-8")
    with pytest.raises(InputError, match="only beside extends"):
        load(path)


def test_balises_behind_the_stop_of_a_shorter_run_are_said() -> None:
    found = load("lvshun_tieshan", ["plan.distance_m=2000", "plan.running_time_s=160", "target.generate.hold_min_s=5"])
    assert len(found.line.balises) == 6
    assert said_of(found, "balises that the run never passes, behind its stop: 4, 5, 6")


def test_a_task_keeps_published_results_only_for_its_own_run() -> None:
    base = load_any("jinan_xuzhou_emergency")
    assert base.published
    assert load_any("jinan_xuzhou_emergency", ["task.emergency_stop_max_m=4000"]).published == base.published
    other = load_any("jinan_xuzhou_emergency", ["task.power_kw=9000"])
    assert other.published == ()
    assert other.assumptions[-1] == "the published results of jinan_xuzhou_emergency are left out: this is another run"


@pytest.mark.parametrize(
    ("scenario", "setting", "other"),
    [
        ("yizhuang_stop", "task.wander_time_s=3", ""),
        ("yizhuang_stop", "task.rail.adhesion_mps2=[0.5, 0.6]", "task.rail.slide_share"),
        ("yizhuang_stop", "task.true.low_speed_mps=3", "task.true.low_speed_loss"),
        ("yizhuang_stop", "timing.loop_delay_s=0.1", "0, or no such key"),
        ("jinan_xuzhou", "task.stale_braking_mps2=0.6", "task.stale_command"),
        ("jinan_xuzhou", "task.emergency_stop_max_m=4000", "task.emergency"),
        ("jinan_xuzhou", "timing.loop_delay_s=0.1", "0, or no such key"),
        ("lvshun_tieshan", "timing.port_period_ms.SPEED_SDT=20", "safety.sdt"),
    ],
)
def test_a_key_that_nothing_uses_is_refused(scenario: str, setting: str, other: str) -> None:
    key = setting.partition("=")[0]
    if not other:
        # The base gives the key beside which it is used.
        assert load_any(scenario, [setting])
        return
    with pytest.raises(InputError) as error:
        load_any(scenario, [setting])
    assert error.value.key == key
    assert other in error.value.allowed
