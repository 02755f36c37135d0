"""One description of a run: from a command line, in Python or from a certificate, and the same in every file."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.cli.run import add_arguments, run_spec
from railhil.common.errors import InputError
from railhil.record.documents import read_certificate
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec

_EARLIER = sorted((TEST_DATA / "runs_0.1.0").glob("*/certificate.json"))
_SOME = [
    RunSpec(),
    RunSpec("yizhuang_01_songjiazhuang_xiaocun", seed=7, perturbed=True, law=LawSpec("tdmc", "float32", "distance")),
    RunSpec(settings=("plan.stop_error_max_m=0.2",), pace="realtime", rate=2.5, patience_s=5.0),
    RunSpec(law=LawSpec(task_period_ms=50), bus="local"),
]


def parsed(words: list[str]) -> RunSpec:
    """What ``railhil run`` makes of the words."""
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    parser.add_argument("--controller")
    parser.add_argument("--parameters", type=Path)
    namespace = parser.parse_args(words)
    given = namespace.parameters and load_parameters(namespace.parameters)
    return run_spec(namespace, namespace.controller, given)


@pytest.fixture
def tuned(tmp_path: Path) -> ParameterSet:
    path = tmp_path / "mine.toml"
    path.write_text(
        'law = "ipfc"\n[parameters]\nsoftening_max = 0.83\n[training]\nscenario = "lvshun_tieshan"\nseeds = [0, 1]\n'
    )
    return load_parameters(path)


@pytest.mark.parametrize("spec", _SOME)
def test_the_words_of_a_run_make_the_same_run(spec: RunSpec) -> None:
    assert parsed(spec.words) == spec


@pytest.mark.parametrize("spec", _SOME)
def test_what_is_written_of_a_run_makes_the_same_run(spec: RunSpec) -> None:
    assert RunSpec.from_json(json.loads(json.dumps(spec.as_json())), Path("x.json")) == spec


def test_parameters_go_with_the_run(tuned: ParameterSet) -> None:
    spec = RunSpec(law=LawSpec(parameters=tuned))
    assert parsed(spec.words) == spec
    again = RunSpec.from_json(spec.as_json(), Path("certificate.json"))
    assert again.law.parameters == replace(tuned, source=Path("certificate.json"))
    assert again.law.label == spec.law.label == f"ipfc+{tuned.digest}"


@pytest.mark.parametrize("path", _EARLIER, ids=lambda path: path.parent.name)
def test_a_certificate_of_version_0_1_0_says_which_run_it_was(path: Path) -> None:
    document = read_certificate(path.parent)
    assert document is not None
    words = document["command"].split()
    assert words[:2] == ["railhil", "run"]
    assert RunSpec.from_json(document, path) == parsed(words[2:])


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("arithmetic", "iq9"),
        ("indexing", "speed"),
        ("pace", "slow"),
        ("seed", -1),
        ("seed", "1"),
        ("rate", 0.0),
        ("bus", "vcan0"),
        ("controller", ""),
        ("task_period_ms", 10_001),
    ],
)
def test_a_value_that_no_run_has_is_named(key: str, value: object) -> None:
    with pytest.raises(InputError, match=rf"^x\.json: {key}: found "):
        RunSpec.from_json({"scenario": "lvshun_tieshan", key: value}, Path("x.json"))


def test_parameters_that_somebody_changed_are_refused(tuned: ParameterSet) -> None:
    document = RunSpec(law=LawSpec(parameters=tuned)).as_json()
    document["parameters"]["values"]["softening_max"] = 0.84
    with pytest.raises(InputError, match=r"^x\.json: parameters\.sha256: found .*values that nobody changed"):
        RunSpec.from_json(document, Path("x.json"))


def test_parameters_are_read_from_a_run_folder_too(tuned: ParameterSet, tmp_path: Path) -> None:
    path = tmp_path / "parameters.json"
    path.write_text(json.dumps(tuned.as_json()))
    assert load_parameters(path) == replace(tuned, source=path)
    path.write_text(json.dumps(RunSpec(law=LawSpec(parameters=tuned)).as_json()))
    assert load_parameters(path) == replace(tuned, source=path)
    path.write_text(json.dumps(RunSpec().as_json()))
    with pytest.raises(InputError, match=r"parameters\.json: cannot be read.*no JSON object with parameters"):
        load_parameters(path)
    path.write_text("[]")
    with pytest.raises(InputError, match=r"parameters\.json: cannot be read.*no JSON object with parameters"):
        load_parameters(path)
    path.write_text('{"law": ')
    with pytest.raises(InputError, match=r"parameters\.json: cannot be read, expected a parameter file"):
        load_parameters(path)
