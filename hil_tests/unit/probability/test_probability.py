"""``railhil probability``: what is asked, what is said, and bytes that depend on code and seed alone."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TypeVar

import numpy as np
import pytest
from rich.console import Console

from hil_tests.support.cli import complaint, railhil
from hil_tests.unit.probability.linear_states import Linear
from railhil.judge.requirements.requirement import Requirement, scenario_requirements
from railhil.probability import least, plan, study
from railhil.probability.limit_state import Bench, sides_of
from railhil.probability.plan import Plan, Request, make_plan
from railhil.probability.report import page
from railhil.probability.sampling import Floats, Points
from railhil.probability.show import lines
from railhil.probability.study import PROBABILITY, exit_code
from railhil.study.execute import Outcome, execute

T = TypeVar("T")
R = TypeVar("R")
STOP = "at stopped abs(stop_error) <= 0.05 m"


@dataclass
class MadeUpBench:
    """Stands for the runs: linear limit states in two draws, of which the scenario draws the first and the last."""

    linear: Linear = field(default_factory=lambda: Linear(4.0, 2, sides=2))
    flat: bool = False
    is_fast: bool = True

    def state(self, bench: Bench, scenario: Any) -> Any:
        return MadeUpState(self, len(bench.sides))

    def run(self, bench: Bench, draws: Sequence[float], noise: Any) -> Any:
        draws = np.array(draws)[[0, 2]]
        margins = self.linear(Points(draws[None], np.zeros((1, 0), dtype=np.int64), np.zeros((1, 0))))[0]
        return SimpleNamespace(frames_sha256="a" * 64, margins=margins[: len(bench.sides)].tolist())


class MadeUpState:
    all_names = ("mass factor", None, "balise 1")
    names = ("mass factor", "balise 1")
    drawn = np.array([0, 2])
    silent = 0

    def __init__(self, bench: MadeUpBench, sides: int) -> None:
        self._bench, self._sides, self.is_fast = bench, sides, bench.is_fast

    def whole_draws(self, points: Points) -> Floats:
        found = np.zeros((len(points), 3))
        found[:, self.drawn] = points.draws
        return found

    def __call__(self, points: Points) -> Floats:
        found = np.ones((len(points), 2)) if self._bench.flat else self._bench.linear(points)
        return found[:, : self._sides]


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> MadeUpBench:
    made = MadeUpBench()
    for module in (plan, study):
        monkeypatch.setattr(module, "LimitState", made.state)
    monkeypatch.setattr(Bench, "run", lambda self, draws, noise: made.run(self, draws, noise))
    monkeypatch.setattr(Bench, "margins_of", lambda self, result: result.margins)
    found = SimpleNamespace(frames_sha256="a" * 64, margins=[-0.1])
    monkeypatch.setattr(least, "run_file", lambda *given: found)
    monkeypatch.setattr(least, "_decided", lambda *given: {"runs": 64, "at_s": [0.0, 2.5], "failed": [3, 64]})
    return made


@contextmanager
def straight(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
    yield enumerate(map(work, items))


@contextmanager
def backwards(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
    """As several processes may do: results come in another order."""
    yield ((place, work(items[place])) for place in reversed(range(len(items))))


def probability(folder: Path, engine: Any = straight, **asked: Any) -> tuple[Plan, Outcome]:
    given = {"says": STOP, "points": 500, "accuracy": 0.4, "seed": 3, "controller": "ipfc_plus_stop", **asked}
    made_plan = make_plan(Request(**given))
    said: list[str] = []
    made = execute(PROBABILITY, made_plan, str(folder), Console(file=io.StringIO()), engine, said.append)
    return made_plan, PROBABILITY.finish(made_plan, made, engine, said.append)


def test_a_rare_event_of_two_sides_is_found_with_its_interval_and_said_with_what_it_is_over(
    bench: MadeUpBench, tmp_path: Path
) -> None:
    made_plan, made = probability(tmp_path / "a")
    found = made.summary
    assert found["method"] == "subset"
    assert found["low"] < bench.linear.p < found["high"]
    assert len(found["repetitions"]) >= 10
    assert found["accuracy"] <= 0.4
    assert exit_code(made_plan, made) == 0
    told = list(lines(made_plan, found, made.folder))
    assert any(line.startswith(f'P(not "{STOP}") = ') and "95%" in line for line in told)
    assert any("over: the 2 draws of [perturbations]" in line and "not over: faults" in line for line in told)
    assert not any("safe" in line or "verified" in line for line in told)
    said = "decided between 0 and 2.5 s: 3 of 64 ... 64 of 64 continuations with new noise from there fail"
    assert said in map(str.strip, told)
    text = page(made_plan, made, "Recorded today.")
    assert "Recorded today." in text
    assert '<figure id="decision">' in text
    assert "from 2.5 s: 64 of 64 fail" in text


def test_causes_are_those_of_the_signed_margin(bench: MadeUpBench, tmp_path: Path) -> None:
    _, made = probability(tmp_path / "a")
    draws = made.summary["causes"]["draws"]
    assert draws["mass factor"]["share"] == pytest.approx(0.5, abs=0.05)
    assert draws["balise 1"]["share"] == pytest.approx(0.5, abs=0.05)
    assert draws["mass factor"]["squares_in_failures"] == pytest.approx(9, rel=0.3)
    assert made.summary["causes"]["noise"] == pytest.approx(0, abs=0.01)


def test_the_least_disturbance_is_the_most_probable_point_and_a_scenario_of_its_own(
    bench: MadeUpBench, tmp_path: Path
) -> None:
    _, made = probability(tmp_path / "a")
    found = made.summary["least"]
    assert found["size"] == pytest.approx(4.0, abs=0.03)
    assert found["draws"][1] == 0
    text = (tmp_path / "a/least.toml").read_text()
    assert 'extends = "lvshun_tieshan"' in text
    assert "not drawn by the scenario" in text
    assert [one.says for one in scenario_requirements(str(tmp_path / "a/least.toml"))] == [STOP]


def test_a_requirement_of_the_scenario_is_named_by_its_id(tmp_path: Path) -> None:
    text = f'schema_version = 1\nextends = "lvshun_tieshan"\n[[requirement]]\nid = "NEAR"\nsays = "{STOP}"\n'
    (tmp_path / "near.toml").write_text(text)
    asked = Request(str(tmp_path / "near.toml"), requirement="NEAR", controller="ipfc_plus_stop")
    assert make_plan(asked).requirement.says == STOP


def test_a_frequent_event_is_counted(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.linear = Linear(1.5, 2, sides=2)
    made_plan, made = probability(tmp_path / "a", accuracy=0.1)
    assert made.summary["method"] == "brute"
    assert made.summary["low"] < bench.linear.p < made.summary["high"]
    assert made.summary["repetitions"] == []
    assert exit_code(made_plan, made) == 0


def test_runs_through_the_nodes_are_counted_in_short_parts(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.linear, bench.is_fast = Linear(1.0, 2), False
    _, made = probability(tmp_path / "a", says="at stopped stop_error <= 0.05 m", method="brute", max_runs=5_000)
    assert made.table is not None
    assert [one["runs"] for one in made.table.to_pylist()] == [200, *[100] * 48], "5000 in all, with those of the noise"
    assert made.summary["low"] < bench.linear.p < made.summary["high"]


def test_an_event_of_every_run_is_counted(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.linear = Linear(-30.0, 2)
    made_plan, made = probability(tmp_path / "a", says="at stopped stop_error <= 0.05 m")
    assert (made.summary["p"], made.summary["high"]) == (1.0, 1.0)
    assert exit_code(made_plan, made) == 0


def test_an_event_that_is_only_far_away_takes_one_pilot(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.linear = Linear(30.0, 2)
    made_plan, made = probability(tmp_path / "a", says="at stopped stop_error <= 0.05 m", max_runs=1000)
    assert made.summary["runs"] < 2 * 500 * 20 + 500, "the pilot and one repetition"
    assert made.summary["levels"][-1] == {"side": "at stopped stop_error <= 0.05 m", "bound": 0.0, "share": 0.0}
    assert exit_code(made_plan, made) == 3


def test_the_file_of_the_least_run_takes_a_sentence_of_several_lines(bench: MadeUpBench, tmp_path: Path) -> None:
    says = "at stopped\n\tstop_error\n<= 0.05 m"
    _, made = probability(tmp_path / "a", says=says)
    assert scenario_requirements(str(made.folder / "least.toml"))[0].says == says


def test_more_repetitions_are_made_until_the_accuracy_is_met(bench: MadeUpBench, tmp_path: Path) -> None:
    _, made = probability(tmp_path / "a", accuracy=0.15)
    assert len(made.summary["repetitions"]) > 10
    assert made.summary["accuracy"] <= 0.15


def test_an_accuracy_that_the_runs_do_not_reach_is_not_resolved(bench: MadeUpBench, tmp_path: Path) -> None:
    made_plan, made = probability(tmp_path / "a", accuracy=0.01, max_runs=100_000)
    assert 80_000 < made.summary["runs"] <= 100_000
    assert exit_code(made_plan, made) == 3
    assert list(lines(made_plan, made.summary, made.folder))[-1].startswith("NOT RESOLVED: wanted +-1% of P, reached")


def test_a_study_that_is_resumed_with_more_runs_goes_on(bench: MadeUpBench, tmp_path: Path) -> None:
    _, made = probability(tmp_path / "a", accuracy=0.1, max_runs=80_000)
    _, again = probability(tmp_path / "a", accuracy=0.1)
    before, after = made.summary["repetitions"], again.summary["repetitions"]
    assert len(before) < len(after)
    assert after[: len(before)] == before


def test_an_event_that_no_run_shows_is_not_resolved_and_has_no_interval(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.flat = True
    made_plan, made = probability(tmp_path / "a", max_runs=20_000)
    assert made.summary["method"] == "brute", "a margin that shows no way can only be counted"
    assert (made.summary["p"], made.summary["low"], made.summary["least"]) == (0.0, None, None)
    assert exit_code(made_plan, made) == 3
    assert any("was not resolved" in line for line in lines(made_plan, made.summary, made.folder))


@pytest.mark.parametrize(("at_most", "code"), [(1e-7, 1), (6e-5, 3), (1e-3, 0)])
def test_at_most_fails_below_the_interval_and_decides_nothing_inside_it(
    bench: MadeUpBench, tmp_path: Path, at_most: float, code: int
) -> None:
    made_plan, made = probability(tmp_path / "a", at_most=at_most)
    assert exit_code(made_plan, made) == code
    beginning = {1: "FAIL", 3: "NOT RESOLVED", 0: "resolved"}[code]
    assert list(lines(made_plan, made.summary, made.folder))[-1].startswith(beginning)


def test_bytes_depend_on_code_and_seed_alone(bench: MadeUpBench, tmp_path: Path) -> None:
    names = ("results.parquet", "least.toml", "summary.json")
    _, one = probability(tmp_path / "a")
    _, other = probability(tmp_path / "b", backwards)
    _, again = probability(tmp_path / "a")
    assert [(tmp_path / "a" / name).read_bytes() for name in names] == [
        (tmp_path / "b" / name).read_bytes() for name in names
    ]
    assert one.summary == other.summary == again.summary
    assert json.loads((tmp_path / "a/summary.json").read_text()) == again.summary


def test_rare_runs_are_made_again(bench: MadeUpBench, tmp_path: Path) -> None:
    made_plan, made = probability(tmp_path / "a")
    (same,) = PROBABILITY.repeat(made_plan, made.table, 0)
    assert not same.differences
    bench.linear = Linear(4.1, 2, sides=2)
    (other,) = PROBABILITY.repeat(made_plan, made.table, 0)
    assert list(other.differences) == ["margin"]


@pytest.mark.parametrize(
    ("says", "sides"),
    [
        (STOP, ("at stopped (stop_error) <= 0.05 m", "at stopped -(stop_error) <= 0.05 m")),
        ("never 5 s < abs(time_error)", ("never 5 s < (time_error)", "never 5 s < -(time_error)")),
        ("at stopped abs(stop_error) >= 0.05 m", None),
        ("never abs(true_accel) > 1 m/s2 for longer than 1 s", None),
        ("at stopped stop_error <= 0.05 m", None),
    ],
)
def test_the_sides_of_a_size_are_sentences_of_their_own(says: str, sides: tuple[str, ...] | None) -> None:
    found = tuple(side.says for side in sides_of(Requirement("R", says)))
    assert found == (sides or (says,))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--says", "at stopped stop_error <= 1 m", "--requirement", "ATO-01"], "one of them is needed"),
        ([], "one of them is needed"),
        (["--requirement", "ATO-0"], "one of ATO-1"),
        (["--says", "at stopped stop_error <= 1 s"], "a length is compared with a time"),
        (["yizhuang_stop", "--says", STOP], "draws and noise"),
        (["--says", STOP, "--set", "noise=[[1, 1.0]]"], "with noise of its own, expected a scenario without them"),
        (["--says", STOP, "--requirements", "ato"], "used only with --requirement"),
        (["--says", STOP, "--accuracy", "0"], "allowed a share of P above 0"),
        (["--says", STOP, "--max-runs", "1.5"], "allowed a whole number"),
        (["--says", STOP, "--at-most", "2"], "allowed a probability"),
        (["--says", STOP, "--runs", "2"], "used only with --verify"),
    ],
)
def test_bad_input_is_one_line(words: list[str], told: str) -> None:
    assert told in complaint(railhil("probability", *words))
