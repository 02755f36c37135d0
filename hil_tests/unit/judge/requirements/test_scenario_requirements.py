"""Sentences of a scenario file: they judge its runs, change nothing of them, and are inherited by their ids."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.common.errors import InputError
from railhil.hunt.plan import Request, make_plan
from railhil.judge.requirements.requirement import Requirement, requirements_from_json, requirements_of
from railhil.run.make import record_run
from railhil.run.spec import with_requirements
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.scenario_documents import any_judged_sha256

_BASE = """
[[requirement]]
id = "A-1"
says = "never true_speed < 0 km/h"
[[requirement]]
id = "A-2"
says = "always is_slow"
title = "slow"
when = { faults = "none" }
[define]
is_slow = "true_speed <= most"
most = "10 km/h"
"""


def scenario_of(folder: Path, text: str, name: str = "mine", extends: str = str(TEST_DATA / "pairs.toml")) -> str:
    path = folder / f"{name}.toml"
    if "/" in extends:
        (folder / "pairs.toml").write_bytes(Path(extends).read_bytes())
        extends = "pairs.toml"
    path.write_text(f'schema_version = 1\nextends = "{extends}"\n{text}')
    return str(path)


def judged_by(scenario: str, *settings: str) -> tuple[Requirement, ...]:
    spec = with_requirements(RunSpec(scenario, settings), ())
    return requirements_from_json(spec.requirements, "test")


def test_they_change_nothing_of_a_run(tmp_path: Path) -> None:
    plain, judged = load_any(str(TEST_DATA / "pairs.toml")), load_any(scenario_of(tmp_path, _BASE))
    assert judged.sha256 == plain.sha256
    assert any_judged_sha256(judged) == any_judged_sha256(plain)
    assert judged.assumptions == plain.assumptions


@pytest.mark.parametrize("base", ["yizhuang_stop", "hst_short", "four_stops"])
def test_each_system_has_them(tmp_path: Path, base: str) -> None:
    text = '[[requirement]]\nid = "X-1"\nsays = "never true_speed > 400 km/h"\n'
    scenario = scenario_of(tmp_path, text, extends=base)
    assert [one.says for one in judged_by(scenario)] == ["never true_speed > 400 km/h"]
    assert len(requirements_of(with_requirements(RunSpec(scenario), ()), load_any(scenario))) == 1


def test_an_extended_scenario_inherits_them_by_id_and_changes_keys_and_names(tmp_path: Path) -> None:
    scenario_of(tmp_path, _BASE, "base")
    text = '[define]\nmost = "11 km/h"\n[[requirement]]\nid = "A-3"\nsays = "at end energy < 9 MJ"\n' + (
        '[[requirement]]\nid = "A-1"\nsays = "never true_speed < -1 km/h"\n'
    )
    found = judged_by(scenario_of(tmp_path, text, extends="base.toml"), 'requirement.A-2.title="slower"')
    assert [(one.id, one.says, one.title, one.when) for one in found] == [
        ("A-1", "never true_speed < -1 km/h", "", "any"),
        ("A-2", "always is_slow", "slower", "none"),
        ("A-3", "at end energy < 9 MJ", "", "any"),
    ]
    assert dict(found[1].define) == {"is_slow": "true_speed <= most", "most": "11 km/h"}


def test_an_extended_scenario_may_leave_one_out(tmp_path: Path) -> None:
    scenario_of(tmp_path, _BASE, "base")
    found = judged_by(scenario_of(tmp_path, 'without = ["requirement.A-1"]\n', extends="base.toml"))
    assert [one.id for one in found] == ["A-2"]
    assert judged_by(scenario_of(tmp_path, 'without = ["requirement"]\n', extends="base.toml")) == ()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[[requirement]]\nid = "A-1"\n', r"mine.toml: requirement\[0\].says: missing"),
        ('[[requirement]]\nid = "A-1"\nsays = "x"\nsayz = "x"\n', r"requirement\[0\].sayz: unknown key.*says"),
        ('[[requirement]]\nid = "1"\nsays = "x"\n', r"requirement\[0\].id: found '1'"),
        ("requirement = 5\n", "requirement: found 5, allowed an array"),
        ("[requirement]\nA-1 = 5\n", r"requirement\[0\]: found 5"),
        ("[define]\nA = 'x'\n", "define.A"),
    ],
)
def test_a_wrong_table_is_refused_in_a_line(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        load_any(scenario_of(tmp_path, text))
    assert "\n" not in str(refused.value)


def test_the_same_id_twice_in_a_file_is_refused(tmp_path: Path) -> None:
    row = '[[requirement]]\nid = "A-1"\nsays = "never true_speed < 0 km/h"\n'
    with pytest.raises(InputError, match=r"requirement.id: found 'A-1', allowed an id that no other"):
        judged_by(scenario_of(tmp_path, row + row))


def test_a_sentence_that_does_not_fit_is_refused_with_its_column(tmp_path: Path) -> None:
    scenario = scenario_of(tmp_path, '[[requirement]]\nid = "A-1"\nsays = "never true_sped < 0 km/h"\n')
    spec = replace(with_requirements(RunSpec(scenario, bus="local"), ()), out=tmp_path / "run")
    with pytest.raises(InputError, match=r"mine.toml: requirement A-1: .*true_sped.*column 7"):
        record_run(spec)
    assert not (tmp_path / "run").exists()


def test_a_sentence_of_a_file_with_an_id_of_the_scenario_counts_once_or_is_refused(tmp_path: Path) -> None:
    spec = RunSpec(scenario_of(tmp_path, _BASE))
    file = tmp_path / "more.toml"
    file.write_text(_BASE)
    found = with_requirements(spec, [str(file)])
    assert [one["id"] for one in found.requirements] == ["A-1", "A-2"]
    assert "--requirements" not in found.words
    file.write_text(_BASE.replace("10 km/h", "12 km/h"))
    with pytest.raises(InputError, match="an id that no other requirement has"):
        requirements_of(with_requirements(spec, [str(file)]), spec.load())


def test_a_hunt_takes_those_of_the_scenario(tmp_path: Path) -> None:
    scenario = scenario_of(tmp_path, _BASE)
    assert [one.id for one in make_plan(Request(scenario)).requirements] == ["A-1", "A-2"]
    assert [one.id for one in make_plan(Request(scenario, only=("A-2",))).requirements] == ["A-2"]


@pytest.mark.slow
def test_its_run_is_judged_and_the_certificate_has_them(tmp_path: Path) -> None:
    scenario = scenario_of(tmp_path, _BASE)
    spec = RunSpec(scenario, law=LawSpec("ipfc_plus"), bus="local")
    plain = record_run(replace(spec, out=tmp_path / "plain"))
    judged = record_run(replace(with_requirements(spec, ()), out=tmp_path / "judged"))
    assert (plain.verdict, judged.verdict) == ("PASS", "FAIL")
    assert judged.frames_sha256 == plain.frames_sha256
    assert [one.verdict for one in judged.score.requirements] == ["kept", "violated"]
    again = RunSpec.from_file(tmp_path / "judged" / "certificate.json")
    # What the certificate has is not read from the file again.
    Path(scenario).write_text(Path(scenario).read_text().replace("10 km/h", "99 km/h"))
    assert with_requirements(again, ()).requirements == judged.spec.requirements
    assert scenario in json.loads((tmp_path / "judged" / "certificate.json").read_text())["command"]
