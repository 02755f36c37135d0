"""A run from a TOML file, a certificate, the environment and the command line, one above the other."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from railhil.cli import commands
from railhil.cli.run import spec_of
from railhil.common.command_line import parse
from railhil.common.errors import Faults, InputError
from railhil.scenarios.memory import Memory, MemoryPlace, MemoryRecord, write_memory
from railhil.scenarios.memory_store import MemoryStore
from railhil.scenarios.run_document import ENVIRONMENT, OPTIONS, environment_layer
from railhil.scenarios.run_spec import LawSpec, RunSpec

_VARIABLES = {
    "RAILHIL_SCENARIO": "yizhuang_05",
    "RAILHIL_CONTROLLER": "tdmc",
    "RAILHIL_ARITHMETIC": "float64",
    "RAILHIL_INDEXING": "distance",
    "RAILHIL_TASK_PERIOD_MS": "50",
    "RAILHIL_SEED": "7",
    "RAILHIL_PERTURBED": "true",
    "RAILHIL_RUN_NUMBER": "4",
    "RAILHIL_PACE": "realtime",
    "RAILHIL_RATE": "2.5",
    "RAILHIL_PATIENCE": "5",
    "RAILHIL_BUS": "auto",
}


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def asked(*words: str | Path, **environment: str) -> RunSpec:
    """What ``railhil run`` makes of words and variables."""
    given = ["run", *map(str, words)]
    return spec_of(parse(commands.parser(given), given), environment)


def test_a_file_says_a_run(tmp_path: Path) -> None:
    spec = RunSpec("yizhuang_05", ("plan.stop_error_max_m=0.2",), LawSpec("tdmc", "float32", "distance", None, 50), 7)
    lines = [f"{key} = {json.dumps(value)}" for key, value in spec.as_json().items() if value is not None]
    whole = RunSpec.from_file(written(tmp_path / "run.toml", "\n".join(lines)))
    assert whole.as_json() == spec.as_json() | {"scenario": whole.scenario}
    assert whole.scenario.startswith("yizhuang_05_")
    assert RunSpec.from_file(written(tmp_path / "empty.toml", "")) == asked() == RunSpec()


def test_files_are_found_beside_the_file_that_names_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    written(folder / "line.toml", 'schema_version = 1\nname = "mine"\nextends = "lvshun_tieshan"\n')
    written(folder / "law.toml", 'law = "ipfc"\n[parameters]\nsoftening_max = 0.83\n')
    text = 'scenario = "line.toml"\nparameters = "law.toml"\n'
    path = written(folder / "run.toml", text)
    monkeypatch.chdir(tmp_path)
    for found in (RunSpec.from_file(path), asked("--spec", "mine/run.toml")):
        assert found.scenario == str(folder / "line.toml")
        assert found.law.parameters is not None
        assert found.law.parameters.source == folder / "law.toml"
        assert found.load().name == "mine"
    # A name on the command line is relative to where the command is called.
    assert asked("mine/line.toml", RAILHIL_PARAMETERS="mine/law.toml") == found


def test_command_line_over_environment_over_file_over_defaults(tmp_path: Path) -> None:
    path = written(
        tmp_path / "run.toml",
        'controller = "tdmc"\narithmetic = "float32"\nseed = 1\nperturbed = true\n'
        'settings = ["plan.stop_error_max_m=1"]\n',
    )
    words = ("--spec", path, "--seed", "3", "--no-perturbed", "--set", "plan.time_error_max_s=9")
    found = asked(*words, RAILHIL_SEED="2", RAILHIL_ARITHMETIC="float64", RAILHIL_PATIENCE="")
    assert found == RunSpec(
        settings=("plan.stop_error_max_m=1", "plan.time_error_max_s=9"), law=LawSpec("tdmc", "float64"), seed=3
    )
    assert asked("--spec", path, RAILHIL_SEED="2").seed == 2
    assert asked("--spec", path).seed == 1


def test_every_variable_says_its_key() -> None:
    assert {*_VARIABLES} == {*ENVIRONMENT.values()} - {
        "RAILHIL_PARAMETERS",
        "RAILHIL_MEMORY",
        "RAILHIL_MEMORY_FROM",
    }
    found = asked(**_VARIABLES).as_json()
    assert {name: str(found[key]).lower() for key, name in ENVIRONMENT.items() if name in _VARIABLES} == _VARIABLES | {
        "RAILHIL_SCENARIO": found["scenario"],
        "RAILHIL_PATIENCE": "5.0",
    }
    assert asked("lvshun_tieshan", "--pace", "lockstep", **_VARIABLES).rate == RunSpec().rate


def test_the_memory_of_a_law_is_said_by_one_of_two_keys(tmp_path: Path) -> None:
    record = MemoryRecord("ipfc", "here", 1, 1, {"offset_m": 0.5})
    memory = Memory("ipfc", (MemoryPlace("A", record),), tmp_path / "old.json")
    write_memory(memory, memory.source)
    path = written(tmp_path / "run.toml", 'memory_store = "new"\n')
    assert RunSpec.from_file(path).memory_store == str(tmp_path / "new")
    begun = asked("--spec", path, "--memory-from", memory.source)
    assert (begun.memory_store, begun.law.memory) == (None, memory)
    assert begun.law.label == f"ipfc@{memory.digest}"
    assert begun.law.words[-2:] == ["--memory-from", str(memory.source)]
    assert asked(RAILHIL_MEMORY_FROM=str(memory.source)) == begun
    kept = asked("--memory", "x", RAILHIL_MEMORY_FROM=str(memory.source))
    assert (kept.memory_store, kept.law.memory) == (str(Path("x").resolve()), None)
    document = begun.as_json()
    assert RunSpec.from_json(document, memory.source) == begun
    document["memory"]["stored"][0]["slot"] = "B"
    with pytest.raises(InputError, match=r"old\.json: memory\.sha256: found .*values that nobody changed"):
        RunSpec.from_json(document, memory.source)


def test_a_certificate_makes_its_run_again(tmp_path: Path) -> None:
    spec = RunSpec("yizhuang_03_xiaohongmen_jiugong", law=LawSpec("tdmc"), seed=9, perturbed=True)
    path = tmp_path / "certificate.json"
    path.write_text(json.dumps({**spec.as_json(), "rate": 1.0, "frames_sha256": "00", "verdict": "PASS"}))
    assert RunSpec.from_file(path) == spec
    assert asked("--spec", path, "--no-perturbed").perturbed is False


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("sed = 1", "run.toml: sed: unknown key.* (did you mean seed?)"),
        ("seed = -1", "run.toml: seed: found -1, allowed at least 0"),
        ('seed = "1"', "run.toml: seed: found '1', allowed a whole number"),
        ("[parameters]\na = 1", "run.toml: parameters: found {'a': 1}, allowed a text"),
        ('scenario = "nowhere"', "run.toml: scenario: found 'nowhere', allowed a path"),
        ('scenario = "nowhere.toml"', "run.toml: scenario: found 'nowhere.toml', allowed a scenario file (TOML)"),
        ('controller = "ipcf"', "run.toml: controller: found 'ipcf', allowed ipfc, .*did you mean ipfc"),
        ('parameters = "none.toml"', "none.toml: does not exist, expected a parameter file"),
        ("rate = 2.0", "run.toml: rate: used only in a run with pace realtime"),
        ("seed = ", "run.toml: cannot be read, expected a run in TOML"),
        (
            'sed = 1\narithmetic = "iq9"\ncontroller = "ipcf"',
            "arithmetic: found 'iq9', .*; .*run.toml: sed: .*; .*run.toml: controller: found 'ipcf'",
        ),
    ],
)
def test_what_no_run_is_names_file_key_found_and_allowed(text: str, line: str, tmp_path: Path) -> None:
    path = written(tmp_path / "run.toml", text)
    pattern = ".*".join(map(re.escape, line.split(".*")))
    with pytest.raises(InputError, match=pattern) as refused:
        RunSpec.from_file(path)
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("text", ["[]", "{}", "{", '{"seed": 1}', "[" * 100_000])
def test_a_file_that_is_no_certificate_is_one_line(text: str, tmp_path: Path) -> None:
    path = written(tmp_path / "certificate.json", text)
    with pytest.raises(InputError, match=r"certificate\.json: .*expected a run in TOML, or certificate\.json"):
        RunSpec.from_file(path)


def test_a_file_that_is_not_there_says_which_is_near(tmp_path: Path) -> None:
    written(tmp_path / "run.toml", "")
    with pytest.raises(InputError, match=r"rum\.toml: does not exist.*did you mean .*run\.toml"):
        RunSpec.from_file(tmp_path / "rum.toml")


def test_all_sources_are_refused_together(tmp_path: Path) -> None:
    path = written(tmp_path / "run.toml", "seed = -1\n")
    with pytest.raises(InputError) as refused:
        asked("--spec", path, "--controller", "ipcf", "--rate", "2", RAILHIL_SEED="x", RAILHIL_PERTURBED="perhaps")
    assert str(refused.value).split("; ") == [
        f"{path}: seed: found -1, allowed at least 0",
        "environment: RAILHIL_SEED: found 'x', allowed a whole number",
        "environment: RAILHIL_PERTURBED: found 'perhaps', allowed true or false",
        "command line: --rate: used only in a run with pace realtime",
        str(refused.value).split("; ")[4],
    ]
    assert "command line: --controller: found 'ipcf'" in str(refused.value)


@pytest.mark.parametrize(("name", "hint"), [("RAILHIL_SEEED", "RAILHIL_SEED"), ("RAILHIL_FAULT", "--fault")])
def test_a_variable_that_nobody_reads_is_refused(name: str, hint: str) -> None:
    with pytest.raises(InputError, match=f"environment: {name}: found '1', .*{hint}"):
        asked(**{name: "1"})


def test_an_environment_without_our_variables_says_nothing() -> None:
    faults = Faults()
    assert environment_layer({"SEED": "3", "RAILHIL_CACHE": "/tmp", "RAILHIL_SEED": ""}, faults).values == {}
    faults.raise_all()


def test_the_table_of_the_documents_is_the_one_of_the_code() -> None:
    text = (ROOT / "docs" / "reference" / "run_spec.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| `([^`]+)` \| (?:`(\w+)`|-) \| (?:`(\w+)`|-) \|", text, re.M)
    assert {key: option.split()[0].lower() for key, option, *_ in rows} == dict(OPTIONS)
    assert {key: variable for key, _, variable, _ in rows if variable} == dict(ENVIRONMENT)
    compose = (ROOT / "docker-compose.yml").read_text(encoding="utf-8")
    for key, _, variable, container in rows:
        assert bool(container) == (f"${{{variable.removeprefix('RAILHIL_')}:-" in compose), key
        assert not container or variable == f"RAILHIL_{container}"


def test_a_run_with_a_store_has_the_next_number(tmp_path: Path) -> None:
    """Where runs have numbers; a number that is given is used, so that a run that was broken off can be made again."""
    store = MemoryStore(tmp_path / "store")
    words = ("yizhuang_stop", "--controller", "ilc_stop", "--memory", str(store.path))
    assert asked(*words).run_number == 1
    store.write(MemoryRecord("ilc_stop", "here", 3, 7, {}), store.read("ilc_stop"), "", {})
    assert asked(*words).run_number == 8
    assert asked(*words, "--run-number", "7").run_number == 7
    assert asked("lvshun_tieshan", "--memory", str(tmp_path / "other")).run_number == 1
