"""Margins of runs with given draws and noise: those of the nodes, by the batch and from the record."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import complaint, railhil
from railhil.judge.requirements.outcome import judge_requirements
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.scores import score_margins
from railhil.probability.plan import Plan, Request, make_plan
from railhil.probability.sampling import Level, Points, draw_points
from railhil.run.local import unrecorded_run
from railhil.scenarios.run_spec import LawSpec, RunSpec


def plan_of(tmp_path: Path, says: str, settings: tuple[str, ...] = ()) -> Plan:
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return make_plan(Request(str(path), settings, says=says, controller="ipfc_plus_stop", arithmetic="float64"))


def chained_points(plan: Plan, runs: int, streams: int) -> Points:
    """Points whose noise is a sum of several streams, as the chains of a rare event have it."""
    random = np.random.default_rng(5)
    points = draw_points(runs, len(plan.state.names), True, random)
    for _ in range(streams - 1):
        points = Level(0.0, (0.5,) * points.draws.shape[1], 0.4).propose(points, random)
    return points


def test_margins_by_the_batch_are_those_of_the_nodes_to_the_last_digit(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, "at stopped abs(stop_error) <= 0.01 m")
    points = chained_points(plan, 3, 5)
    margins = plan.state(points)
    assert plan.state.is_fast
    draws = plan.state.whole_draws(points)
    for row, (own, noise) in enumerate(zip(draws, points.chains(), strict=True)):
        assert plan.bench.margins_of(plan.bench.run(own, noise)) == margins[row].tolist()
    assert len({tuple(row) for row in margins.tolist()}) == 3


@pytest.mark.parametrize(("sign", "is_violated"), [("<=", False), ("<", True)])
def test_a_margin_at_the_limit_is_that_of_the_nodes(tmp_path: Path, sign: str, is_violated: bool) -> None:
    plan = plan_of(tmp_path, "at stopped stop_error <= 0 m")
    points = chained_points(plan, 1, 1)
    stop_error_m = -plan.state(points)[0, 0]
    plan = plan_of(tmp_path, f"at stopped stop_error {sign} {stop_error_m:.4f} m")
    margins = plan.state(points).tolist()
    (draws,), (noise,) = plan.state.whole_draws(points), points.chains()
    assert margins == [plan.bench.margins_of(plan.bench.run(draws, noise))]
    assert (margins[0][0] < 0) is is_violated


def test_a_sentence_that_needs_the_record_goes_through_the_nodes(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, "never true_speed > 2 km/h")
    margins = plan.state(chained_points(plan, 2, 1))
    assert not plan.state.is_fast
    assert margins.shape == (2, 1)
    assert np.isfinite(margins).all()


def test_draws_without_a_distribution_are_left_out(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, "at stopped abs(stop_error) <= 0.01 m")
    names = plan.state.all_names
    assert None in names
    assert "balise 1" in names
    whole = plan.state.whole_draws(draw_points(4, len(plan.state.names), True, np.random.default_rng(1)))
    assert [bool(column.any()) for column in whole.T] == [name is not None for name in names]


@pytest.mark.parametrize(
    ("fault", "name", "is_fast"),
    [
        ("mass scale uniform(0.8,1.2) @0s", "fault 1 mass factor", True),
        ("sensor.speed offset normal(0,0.01) @1s", "fault 1 speed error", False),
    ],
)
def test_values_of_faults_are_sampled_in_the_batch_and_through_the_nodes(
    fault: str, name: str, is_fast: bool, tmp_path: Path
) -> None:
    """Without perturbations, too."""
    path = tmp_path / "faulty.toml"
    path.write_text(f'without = ["perturbations"]\nfault = ["{fault}"]\n{QUICK_TOML}')
    plan = make_plan(Request(str(path), says="at stopped abs(stop_error) <= 0.01 m", arithmetic="float64"))
    assert plan.state.names == (name,)
    points = chained_points(plan, 3, 2)
    margins = plan.state(points)
    assert plan.state.is_fast is is_fast
    for row, (own, noise) in enumerate(zip(plan.state.whole_draws(points), points.chains(), strict=True)):
        assert plan.bench.margins_of(plan.bench.run(own, noise)) == margins[row].tolist()
    # The same noise, another value.
    same = points.take(np.array([0, 0, 0]))
    moved = plan.state(Points(np.array([[0.0], [1.0], [-1.0]]), same.seeds, same.weights))
    assert len({tuple(row) for row in moved.tolist()}) == 3


@pytest.mark.parametrize(
    "says",
    [
        "at stopped abs(stop_error) <= 0.0531 m",
        "at stopped stop_error < 53.1 mm and time_error < 5 s",
        "at end energy < 0.01 kWh",
    ],
)
def test_margins_from_scores_are_those_of_the_record(tmp_path: Path, says: str) -> None:
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    law = LawSpec("ipfc_plus_stop", "float64")
    specs = [RunSpec(str(path), law=law, seed=seed, perturbed=True) for seed in (1, 2)]
    runs = [unrecorded_run(spec.load(), spec) for spec in specs]
    requirement = Requirement("R", says)
    margins = score_margins(requirement, specs[0].load())
    assert margins is not None
    found = margins([run.score for run in runs])
    for run, margin in zip(runs, found, strict=True):
        (outcome,) = judge_requirements(run.as_record(), [requirement])
        assert outcome.margin == (None if np.isnan(margin) else pytest.approx(margin, rel=1e-12))


@pytest.mark.parametrize("says", ["never true_speed < 0 km/h", "at end true_speed < 1 km/h"])
def test_other_sentences_have_no_margin_from_scores(says: str) -> None:
    assert score_margins(Requirement("R", says), RunSpec("lvshun_tieshan").load()) is None


@pytest.mark.long
def test_a_study_of_a_short_run_is_resumed_verified_and_its_least_run_has_its_hash(tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    says = "at stopped stop_error <= 1.9 m"
    asked = ("--says", says, "--points", "100", "--method", "subset", "--accuracy", "10", "--out", tmp_path / "p")
    made = railhil("probability", path, *asked, "--controller", "ipfc_plus_stop", "--jobs", "2", "--json")
    assert made.exit_code == 0, made.err
    least = tmp_path / "p/least.toml"
    for bus in ("local", "auto"):
        again = railhil("run", least, "--controller", "ipfc_plus_stop", "--bus", bus, "--out", tmp_path / bus)
        assert again.exit_code == 1, again.err
        assert made.json["least"]["sha256"] in (tmp_path / bus / "SHA256SUMS").read_text()
    assert railhil("probability", "--verify", tmp_path / "p", "--runs", "2").exit_code == 0
    assert railhil("probability", "--resume", tmp_path / "p", "--json").json == made.json
    assert "probability.accuracy" in complaint(railhil("probability", "--resume", tmp_path / "p", "--accuracy", "5"))
