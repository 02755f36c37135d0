"""``railhil train-model``: from a record to a file that a law runs with; bad input is one line."""

from __future__ import annotations

import tomllib
from dataclasses import asdict
from pathlib import Path
from statistics import fmean

import pytest

from hil_tests.support.cli import railhil
from railhil.bench import direct_run
from railhil.common.errors import InputError
from railhil.common.version import full_version
from railhil.controller_node.high_speed.learned import WEIGHTS, shipped_networks
from railhil.controller_node.high_speed.training import Recipe
from railhil.dbc import wire_contract
from railhil.judge.folder import code_sha256
from railhil.judge.record import Record
from railhil.learning.models import describe_training, render_file, train_models
from railhil.record.trace import Trace
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec

SHIPPED = {"hst1": ("jinan_xuzhou", 1), "emu3": ("jinan_xuzhou_emu3", 3)}
#: A seed on which nothing was trained or chosen.
SEED = 203


def recorded(tmp_path: Path, seed: int, parameters: ParameterSet | None) -> Record:
    """A run of the whole journey, driven by PID."""
    scenario = load_any("jinan_xuzhou")
    law = LawSpec("pid", "float64", parameters=parameters)
    log = tmp_path / "frames.log"
    log.write_text(f"record of seed {seed}\n")
    trace = direct_run(scenario, RunSpec(law=law, seed=seed)).trace
    return Record(log, scenario, trace, certificate={"controller": "pid", "seed": seed})


def rmse_kmh(parameters: ParameterSet | None, scenario: str = "jinan_xuzhou", seed: int = SEED, **of: str) -> float:
    """RMSE of ELM-NGPC on a stretch of the journey: its start, or the emergency."""
    settings = [f"{key.replace('__', '.')}={value}" for key, value in of.items()]
    found = direct_run(
        load_any(scenario, settings),
        RunSpec(law=LawSpec("elm_ngpc", "float64", parameters=parameters), seed=seed),
    )
    scores = found.score.as_json()["scores"]
    return float(scores["emergency_rmse_kmh"] or scores["rmse_kmh"])


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Record:
    """The record of the shipped networks, without its dither."""
    driver = load_parameters(WEIGHTS / "driver.toml")
    values = {key: value for key, value in driver.values.items() if not key.startswith("dither")}
    return recorded(tmp_path_factory.mktemp("plain"), 1, ParameterSet("pid", values, driver.source))


@pytest.mark.long
@pytest.mark.slow
def test_the_shipped_network_is_what_its_command_makes(tmp_path: Path) -> None:
    record = recorded(tmp_path, 1, load_parameters(WEIGHTS / "driver.toml"))
    recipe = Recipe(seed=2)
    learned = train_models(record, recipe, 1.0)
    assert learned.networks == shipped_networks("elm_ngpc", "hst1")
    # Modelling: with the network better at every period, and the file says so.
    assert all(error.integrated_kmh < 0.7 * error.linear_kmh for error in learned.errors.values())
    file = tmp_path / "elm.toml"
    file.write_text(render_file("elm_ngpc", record, learned, describe_training(record, recipe, 1.0, learned)))
    given, shipped = load_parameters(file), load_parameters(WEIGHTS / "elm_ngpc_hst1.toml")
    assert given.values == shipped.values
    assert given.training_seeds == frozenset({1})
    theirs = tomllib.loads((WEIGHTS / "elm_ngpc_hst1.toml").read_text())["training"]["notes"]
    ours = tomllib.loads(file.read_text())["training"]["notes"]
    # The shipped file was made by other code.
    assert ours.pop("code_sha256") == code_sha256()
    assert ours["railhil"] == full_version()
    assert len(ours.pop("training_sha256")) == 64
    assert ours | {name: theirs[name] for name in ("railhil", "record_sha256")} == theirs


@pytest.mark.long
@pytest.mark.slow
def test_without_dither_the_pseudo_inverse_fits_best_and_controls_worst(plain: Record, tmp_path: Path) -> None:
    """Reading D14: a negative test of the specification."""
    learned = train_models(plain, Recipe(ridge=None), 1.0)
    shipped = tomllib.loads((WEIGHTS / "elm_ngpc_hst1.toml").read_text())["training"]["notes"]
    assert learned.errors[1.0].integrated_kmh < shipped["rmse_integrated_kmh"][1]
    values = {"networks": [asdict(network) for network in learned.networks]}
    bad = ParameterSet("elm_ngpc", values, tmp_path / "bad.toml")
    stretch = {"task__duration_s": "300"}
    assert rmse_kmh(bad, **stretch) > 2.0
    assert rmse_kmh(None, **stretch) < 0.25


@pytest.mark.long
@pytest.mark.slow
def test_the_emergency_is_followed_within_the_figures_of_the_specification() -> None:
    """The mean: identification makes single runs differ by half of it."""
    found = [rmse_kmh(None, "jinan_xuzhou_emergency", seed) for seed in range(SEED, SEED + 5)]
    assert 0.24 < fmean(found) < 0.36


@pytest.mark.slow
def test_a_record_that_is_too_short_is_one_line() -> None:
    run = direct_run(load_any("hst_short"), RunSpec(law=LawSpec("pid", "float64")))
    record = Record(Path("frames.log"), load_any("hst_short"), run.trace)
    with pytest.raises(InputError, match=r"frames.log: length: \d+ samples of 1 s, expected at least 600"):
        train_models(record, Recipe(), 1.0)


def test_a_record_of_another_system_is_one_line() -> None:
    scenario = load_any("lvshun_tieshan")
    record = Record(Path("frames.log"), scenario, Trace(wire_contract()))
    with pytest.raises(InputError, match="system: found 'ato', allowed a system of high-speed trains: hst1 or emu3"):
        train_models(record, Recipe(), 1.0)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("nowhere",), "nowhere: does not exist"),
        (("nowhere", "--ridge", "0"), "--ridge: found 0, allowed a number above 0"),
        (("nowhere", "--hidden", "0"), "--hidden: found 0, allowed 1..100"),
        (("nowhere", "--kind", "rbf"), "--kind: found rbf, allowed elm, bp, os_elm"),
        (("nowhere", "--ridge", "1", "--pinv"), "not allowed with argument"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(tmp_path: Path, words: tuple[str, ...], line: str) -> None:
    done = railhil("train-model", *words, cwd=tmp_path)
    assert done.exit_code == 2
    assert line in done.one_line()


@pytest.mark.parametrize("law", ["elm_ngpc", "bp_ngpc"])
@pytest.mark.parametrize("system", SHIPPED)
def test_a_shipped_file_says_how_it_was_made(system: str, law: str) -> None:
    path = WEIGHTS / f"{law}_{system}.toml"
    given, (scenario, units) = load_parameters(path), SHIPPED[system]
    noted = tomllib.loads(path.read_text())["training"]["notes"]
    assert (given.law, given.training_scenario) == (law, scenario)
    assert len(shipped_networks(law, system)) == units
    assert noted["period_s"] == [0.5, 1.0, 2.0, 4.0]
    pairs = zip(noted["rmse_linear_kmh"], noted["rmse_integrated_kmh"], strict=True)
    assert all(integrated < linear for linear, integrated in pairs)
