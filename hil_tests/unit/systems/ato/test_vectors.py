"""A run as a vector: the scenario's own draws and noise, on the bench and in the batch."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtri

import railhil
from benchmarks.figures import QUICK_TOML
from railhil.batch import Case
from railhil.bench import direct_run, local_run
from railhil.cli import main
from railhil.common.errors import InputError
from railhil.plant_sim.ato.plant_readings import AxleSensors
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.streams import Chain, probability_of
from railhil.systems.ato.batch import VectorRuns, run_batch
from railhil.systems.ato.batch.noise import renew_noise, standard_noise
from railhil.systems.ato.batch.replay import trace_digest
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import count_draws, find_actual, name_draws, perturb, unit_draws

LVSHUN = load("lvshun_tieshan")
DRAWS = count_draws(LVSHUN.line)


@pytest.fixture
def short(tmp_path: Path) -> Scenario:
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return load(str(path))


def vectors(scenario: Scenario, runs: int, seed: int = 1) -> tuple[np.ndarray[Any, Any], list[Chain]]:
    """Draws and noise of some runs; the noise of each next one is the sum of one more sequence."""
    generator = np.random.default_rng(seed)
    noise: list[Chain] = []
    for length in range(1, runs + 1):
        coefficients = generator.standard_normal(length)
        coefficients /= np.sqrt((coefficients**2).sum())
        seeds = generator.integers(0, 2**32, length)
        noise.append(tuple(zip(seeds.tolist(), coefficients.tolist(), strict=True)))
    return generator.standard_normal((runs, len(name_draws(scenario)))), noise


@given(st.floats(-37.0, 37.0), st.floats(-37.0, 37.0))
def test_a_probability_grows_with_its_number(one: float, other: float) -> None:
    low, high = sorted((probability_of(one), probability_of(other)))
    assert 0.0 <= low <= high <= 1.0
    assert (probability_of(min(one, other)), probability_of(max(one, other))) == (low, high)


@pytest.mark.parametrize(
    ("number", "probability"), [(0.0, 0.5), (-3.090232306167814, 0.001), (-5.0, 2.866515718791939e-7)]
)
def test_probabilities_are_those_of_the_tables(number: float, probability: float) -> None:
    assert probability_of(number) == pytest.approx(probability, rel=1e-14)
    assert probability_of(-number) == pytest.approx(1.0 - probability, rel=1e-14)


def test_own_draws_perturb_a_run_that_is_not_asked_to_be_perturbed() -> None:
    own = replace(LVSHUN, draws=(0.5,) * DRAWS)
    assert find_actual(own, 3, False) == find_actual(own, 4, True) == perturb(own, 0)
    assert find_actual(own, 3, False).train.mass_kg != LVSHUN.train.mass_kg
    assert find_actual(LVSHUN, 3, False) is LVSHUN


def test_draws_are_applied_once() -> None:
    """A train with faults perturbs its scenario before the train without faults does."""
    once = find_actual(replace(LVSHUN, draws=(1.5,) * DRAWS), 0, False)
    assert find_actual(once, 0, False) is once


def test_the_numbers_of_a_seed_as_own_draws_and_noise_are_the_run_of_the_seed(short: Scenario, tmp_path: Path) -> None:
    """To the resolution of the wire: the numbers of the seed are known only to the last digit."""
    for seed in (3, 4):
        draws = tuple(ndtri(unit_draws(short, seed)).tolist())
        own = replace(short, draws=draws, noise=((seed, 1.0),))
        drawn = direct_run(short, RunSpec(seed=seed, perturbed=True))
        given = local_run(own, tmp_path, RunSpec(seed=seed))
        assert given.score == drawn.score
        assert trace_digest(own, given.trace) == trace_digest(short, drawn.trace)


def test_noise_is_the_sum_of_its_sequences_in_node_and_batch() -> None:
    """Bit by bit, in every order, across several blocks of the sensor's own drawing."""
    _, noise = vectors(LVSHUN, 5)
    sensors = replace(LVSHUN.sensors, speed_noise_sigma_mps=1.0)
    ticks = np.array([0, 1, 4095, 4096, 9000, *range(20_000, 21_000)])
    found = standard_noise(noise, ticks)
    assert abs(found).max() > 2.0
    for column, chain in enumerate(noise):
        axle = AxleSensors(sensors, 0, noise=chain)
        assert found[:, column].tolist() == [axle.noise_mps(tick) for tick in ticks.tolist()]


def test_from_an_instant_on_the_noise_is_that_of_another_seed_in_node_and_batch() -> None:
    sensors = replace(LVSHUN.sensors, speed_noise_sigma_mps=1.0)
    ticks = np.array([0, 4095, 4096, 8999, 9000, 9001, 12_288, 4096, 9000])
    noise = standard_noise([((3, 1.0),)] * 3, ticks)
    changes = [(0, 7), (9000, 7), (12_289, 7)]
    found = renew_noise(noise, ticks, changes)
    before, after = AxleSensors(sensors, 3), AxleSensors(sensors, 7)
    for column, (from_tick, seed) in enumerate(changes):
        axle = AxleSensors(sensors, 3)
        axle.noise_mps(0)
        axle.renew(from_tick, seed)
        wanted = [(before if tick < from_tick else after).noise_mps(tick) for tick in ticks.tolist()]
        assert [axle.noise_mps(tick) for tick in ticks.tolist()] == found[:, column].tolist() == wanted


def test_continuations_in_the_batch_are_the_runs_of_the_bench(short: Scenario, tmp_path: Path) -> None:
    law = LawSpec(arithmetic="float64")
    own = replace(short, draws=tuple(vectors(short, 1)[0][0].tolist()))
    changes = [(0.0, 4), (3.005, 4), (3.005, 5), (7.9, 5), (100.0, 5)]
    runs = [replace(own, noise_from=change) for change in changes]
    ticks = [change for run in runs if (change := run.noise_change) is not None]
    assert [tick for tick, _ in ticks] == [0, 301, 301, 790, 10_000]
    scores = VectorRuns(Case(own, law), chunk=2).continue_run(3, ticks)
    for run, score in zip(runs, scores, strict=True):
        assert local_run(run, tmp_path, RunSpec(law=law, seed=3)).score == score
        assert run_batch(Case(run, law), [3]).scores == (score,)
    assert scores[0] == direct_run(own, RunSpec(law=law, seed=4)).score
    assert scores[-1] == direct_run(own, RunSpec(law=law, seed=3)).score
    assert len({score.signed["stop_error_m"] for score in scores}) > 2


@pytest.mark.parametrize("law", ["ipfc", "ipfc_plus_stop"])
def test_vectors_in_the_batch_are_the_runs_of_the_bench(short: Scenario, law: str) -> None:
    case = Case(short, LawSpec(law, arithmetic="float64"))
    draws, noise = vectors(short, 6)
    scores = VectorRuns(case, chunk=4).run(draws, noise)
    for row, score in enumerate(scores):
        own = replace(short, draws=tuple(draws[row].tolist()), noise=noise[row])
        assert direct_run(own, RunSpec(law=case.law)).score == score
    assert len({score.signed["stop_error_m"] for score in scores}) > 1


def test_draws_and_a_fault_of_the_train_act_together(short: Scenario, tmp_path: Path) -> None:
    """The mismatch is applied to the drawn train, in the batch, without a bus and through the nodes."""
    faulty = replace(short, faults=("mass scale normal(1.1,0.02) @0s", "resistance scale uniform(1.1,1.3) @0s"))
    draws, noise = vectors(faulty, 2)
    law = LawSpec(arithmetic="float64")
    scores = VectorRuns(Case(faulty, law)).run(draws, noise)
    for row, score in enumerate(scores):
        own = replace(faulty, draws=tuple(draws[row].tolist()), noise=noise[row])
        assert direct_run(own, RunSpec(law=law)).score == score
        assert local_run(own, tmp_path, RunSpec(law=law)).score == score
    others = draws.copy()
    others[:, -1] += 1.0
    changed = VectorRuns(Case(faulty, law)).run(others, noise)
    assert all(score != other for score, other in zip(scores, changed, strict=True))


def test_a_batch_of_seeds_takes_the_draws_and_the_noise_of_its_scenario(short: Scenario) -> None:
    draws, noise = vectors(short, 2)
    law = LawSpec(arithmetic="float64")
    for own in (replace(short, draws=tuple(draws[1].tolist())), replace(short, noise=noise[1])):
        case = Case(own, law)
        batch = run_batch(case, [5, 6])
        for row, seed in enumerate((5, 6)):
            run = direct_run(own, case.run(seed))
            assert (batch.scores[row], batch.digest[row]) == (run.score, trace_digest(own, run.trace))


def test_another_number_of_draws_is_refused_in_the_batch(short: Scenario) -> None:
    _, noise = vectors(short, 2)
    with pytest.raises(ValueError, match=r"draws have the shape \(2, 10\), not \(2, "):
        VectorRuns(Case(short)).run(np.zeros((2, 10)), noise)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("draws=[0.5, 1.0]", "draws: 2 numbers, expected 15 numbers: 9 and one for each balise"),
        ("draws=[nan]", "draws[0]: found nan, allowed a finite number"),
        ("draws=3", "draws: found 3, allowed an array"),
        ("noise=[[3, 0.5], [4, 0.5]]", "noise: found 0.5, allowed 1 +- 1e-09, the sum of the squares"),
        ("noise=[[3, 1.000001]]", "noise: found 1.0000020000"),
        ("noise=[[-1, 1.0]]", "noise[0][0]: found -1, allowed at least 0"),
        ("noise=[[4294967296, 1.0]]", "noise[0][0]: found 4294967296, allowed at most"),
        ("noise=[[3, inf]]", "noise[0][1]: found inf, allowed a finite number"),
        ("noise=[[3]]", "noise[0][1]: missing"),
        ("noise_from=[-1, 3]", "noise_from[0]: found -1, allowed at least 0"),
        ("noise_from=[1.5, 0.5]", "noise_from[1]: found 0.5, allowed"),
        ("noise_from=[1.5]", "noise_from[1]: missing"),
    ],
)
def test_a_wrong_vector_is_refused_in_one_line(setting: str, message: str) -> None:
    with pytest.raises(InputError) as refused:
        RunSpec("lvshun_tieshan", (setting,)).load()
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_the_values_of_faults_have_their_numbers_too() -> None:
    drawn = "mass scale normal(1.1,0.1) @0s"
    with pytest.raises(InputError, match="expected 16 numbers: 9 and one for each balise, 1 for values of faults"):
        RunSpec("lvshun_tieshan", (f"draws={[0.0] * DRAWS}",), faults=(drawn,)).load()
    # One with its own seed is the same in every run.
    RunSpec("lvshun_tieshan", (f"draws={[0.0] * DRAWS}",), faults=(f"{drawn} seed 3",)).load()
    bare = ("perturbations={}", f"draws={[0.0] * (DRAWS + 1)}")
    assert RunSpec("lvshun_tieshan", bare, faults=(drawn,)).load().draws[-1] == 0.0


def test_draws_without_anything_to_draw_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "bare.toml"
    file.write_text(
        'schema_version = 1\nextends = "lvshun_tieshan"\nwithout = ["perturbations"]\nname = "bare"\ndraws = [0.0]\n'
    )
    with pytest.raises(InputError, match=r"draws: 1 number, expected none without \[perturbations\]"):
        load(str(file))


def test_a_scenario_without_a_vector_has_the_hash_that_it_had() -> None:
    zero = replace(LVSHUN, draws=(), noise=())
    assert load("lvshun_tieshan").sha256 == zero.sha256
    given = [
        RunSpec("lvshun_tieshan", (text,)).load().sha256
        for text in (f"draws={[0.0] * DRAWS}", "noise=[[0, 1.0]]", "noise_from=[9, 1]", "noise_from=[9, 2]")
    ]
    assert len({*given, zero.sha256}) == 5


@pytest.mark.slow
def test_a_vector_is_in_the_certificate_and_its_repetition_has_the_same_frames(tmp_path: Path) -> None:
    draws, noise = vectors(load("yizhuang_05"), 3)
    settings = (f"draws={draws[2].tolist()}", f"noise={[list(part) for part in noise[2]]}")
    railhil.run("yizhuang_05", settings=settings, out=tmp_path / "first")
    assert json.loads((tmp_path / "first" / "certificate.json").read_text())["settings"] == list(settings)
    assert main(["rerun", str(tmp_path / "first")]) == 0
    assert main(["rerun", str(tmp_path / "first"), "--bus", "auto"]) == 0
