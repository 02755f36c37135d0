"""Draws in a hunt: a case is data, a descent finds what random draws do not, and the least draws stay as they are."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.errors import InputError
from railhil.faults.random_faults import Sent
from railhil.hunt import found as found_module
from railhil.hunt import least as least_module
from railhil.hunt import plan, study
from railhil.hunt.draws import (
    DESCENT_RUNS,
    Draws,
    descend_rows,
    draws_sentence,
    random_draws,
    shrink_draws,
    size_words,
)
from railhil.hunt.least import ShrinkTask, shrink_case
from railhil.hunt.oracle import Judged
from railhil.hunt.plan import Request, make_plan
from railhil.judge.requirements.outcome import Outcome
from railhil.judge.requirements.sentence import KEPT, VIOLATED
from railhil.scenarios.run_spec import RunSpec

SENTENCE = '[[requirement]]\nid = "STOP"\nsays = "at stopped abs(stop_error) <= 0.3 m"\n'
SENT = {"TRN_SPEED": Sent(0.0, 42.0, 0.01)}


@pytest.fixture
def sentences(tmp_path: Path) -> str:
    (tmp_path / "mine.toml").write_text(SENTENCE)
    return str(tmp_path / "mine.toml")


def draws_of(spec: RunSpec) -> Draws:
    given = [text.removeprefix("draws=") for text in spec.settings if text.startswith("draws=")]
    return tuple(json.loads(given[-1])) if given else tuple(getattr(spec.load(), "draws", ()))


def bench_run(
    base: RunSpec, requirements: Sequence[Any], faults: Sequence[str], seed: int, folder: Path | None = None
) -> Judged:
    """Stands for a run: the stop error grows with the first and the last draw. A fault does nothing."""
    draws = draws_of(base) or (0.0,)
    margin = 4.5 - (draws[0] + draws[-1]) / math.sqrt(2)
    outcome = Outcome("STOP", "made up", VIOLATED if margin < 0 else KEPT, margin, "m", 1.0)
    violated = {"STOP": "made up"} if margin < 0 else {}
    return Judged("FAIL" if violated else "PASS", violated, (outcome,), frames_sha256=f"{draws} {faults} {seed}")


@pytest.fixture(autouse=True)
def _bench(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    if "real" in request.node.name:
        return
    for module in (study, least_module, found_module):
        monkeypatch.setattr(module, "run_case", bench_run)
    monkeypatch.setattr(plan, "faultless_run", lambda base: (42.0, SENT))


@given(st.integers(0, 2**32 - 1), st.integers(0, 10**6))
def test_draws_depend_on_seed_and_number_alone(seed: int, number: int) -> None:
    drawn = (True, False, True)
    found = random_draws(seed, number, drawn)
    assert found == random_draws(seed, number, drawn)
    assert found[1] == 0.0
    assert found[0] != found[2]


def test_a_hunt_of_draws_has_cases_with_and_without_faults(sentences: str) -> None:
    alone = make_plan(Request("lvshun_tieshan", requirements=(sentences,), what=("draws",), strategy="random"))
    both = make_plan(Request("lvshun_tieshan", requirements=(sentences,), what=("draws", "sensors"), strategy="random"))
    assert all(case.draws and not case.faults for case in alone.cases(range(5)))
    for case in both.cases(range(5)):
        assert len(case.draws) == len(alone.cases([0])[0].draws) == 9 + len(both.scenario.line.balises)
        assert case.faults
    assert not any(case.draws for case in make_plan(Request("lvshun_tieshan")).cases(range(3)))


def test_a_descent_finds_what_random_draws_do_not(sentences: str) -> None:
    """P = 3.4e-6: by chance one of 300,000 runs."""
    made = make_plan(Request("lvshun_tieshan", requirements=(sentences,), strategy="descent", runs=256, seed=3))
    chunk, _ = made.chunks()
    rows = study._work(made, chunk).rows().to_pylist()
    assert [row["number"] for row in rows] == list(range(DESCENT_RUNS))
    first = next(row for row in rows if row["violated"])
    assert first["number"] < 100
    assert rows == study._work(made, chunk).rows().to_pylist()
    short = make_plan(Request("lvshun_tieshan", requirements=(sentences,), strategy="descent", runs=50, seed=3))
    assert study._work(short, short.chunks()[0]).rows().to_pylist() == rows[:50]


def test_rows_of_a_descent_without_a_margin_are_made_all_the_same() -> None:
    rows = [*descend_rows(lambda number, draws: {"outcomes": [], "violated": []}, range(40), "X", 0, (True, True))]
    assert len(rows) == 40


def test_the_least_draws_are_nearest_to_the_middle_of_their_ranges(sentences: str) -> None:
    made = make_plan(Request("lvshun_tieshan", requirements=(sentences,), what=("draws",)))
    draws = tuple(6.0 if place in (0, 14) else 0.5 for place in range(15))
    task = ShrinkTask(made.base, made.requirements, "STOP", 0, ("TRN_SPEED loss @5s",), 3, 42.0, True, draws)
    least = shrink_case(task)
    assert least.shrunk.faults == ()
    assert [place for place, one in enumerate(least.draws) if one] == [0, 14]
    assert 4.5 <= math.hypot(*least.draws) <= 4.5 / 0.95 + 1e-3
    again = shrink_case(ShrinkTask(made.base, made.requirements, "STOP", 0, (), 3, 42.0, True, least.draws))
    assert (again.shrunk.faults, again.draws) == ((), least.draws)
    assert again.shrunk.runs <= 30
    assert draws_sentence(least.draws).endswith("2 of 15 not 0")


@pytest.mark.parametrize(
    ("faults", "draws", "said"),
    [
        ((), (), "nothing"),
        (("a", "b"), (), "2 faults"),
        ((), (0.0, 3.0, -4.0), "2 draws not nominal (length 5)"),
        (("a",), (0.0, 0.5), "1 fault and 1 draw not nominal (length 0.5)"),
        (("a",), (0.0, 0.0), "1 fault"),
    ],
)
def test_the_size_of_a_case_is_that_of_its_faults_and_of_its_draws(
    faults: tuple[str, ...], draws: Draws, said: str
) -> None:
    assert size_words(faults, draws) == said


@given(st.lists(st.floats(-8, 8), min_size=1, max_size=6).map(tuple), st.floats(0.1, 5.0))
def test_shrunk_draws_violate_and_are_not_longer(draws: Draws, bound: float) -> None:
    def violates(candidate: Draws) -> bool:
        return max(map(abs, candidate), default=0.0) > bound

    if not violates(draws):
        return
    least = shrink_draws(draws, violates)
    assert violates(least)
    assert math.hypot(*least) <= math.hypot(*draws)
    assert sum(bool(one) for one in least) == 1
    assert shrink_draws(least, violates) == least


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"scenario": "yizhuang_stop", "what": ("draws",)}, "--what: draws of yizhuang_stop"),
        ({"settings": (f"draws={[0.0] * 15}",), "what": ("draws",)}, "draws of lvshun_tieshan, which has its own"),
        ({"strategy": "descent"}, "--requirements: none, expected sentences"),
        ({"strategy": "descent", "what": ("draws", "sensors")}, "--what: found 'draws, sensors', allowed draws alone"),
    ],
)
def test_draws_that_a_run_does_not_have_are_refused_in_a_line(asked: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as refused:
        make_plan(Request(**{"scenario": "lvshun_tieshan", **asked}))
    assert said in str(refused.value)


@pytest.mark.long
def test_real_draws_found_by_descent_are_repeated_by_their_file(tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    (tmp_path / "mine.toml").write_text('[[requirement]]\nid = "FAR"\nsays = "never true_position > 0.045 m"\n')
    words = ("--requirements", tmp_path / "mine.toml", "--strategy", "descent", "--runs", "64", "--jobs", "1")
    done = railhil("hunt", tmp_path / "short.toml", *words, "--out", tmp_path / "hunt")
    assert done.exit_code == 1, done.err
    assert "draws of length " in done.out
    assert "NOT REPEATED" not in done.out
    # The sentence needs the record: branches count.
    assert "continuations with new noise from" in done.out
    (found,) = json.loads((tmp_path / "hunt/found.json").read_text())
    assert found["no_return"] is None
    assert found["decided"]["runs"] == 64
    # A curve needs two instants.
    is_drawn = '<figure id="FAR-1-decision">' in (tmp_path / "hunt/report.html").read_text()
    assert is_drawn == (len(found["decided"]["at_s"]) > 1)
    assert railhil("hunt", "--verify", tmp_path / "hunt", "--runs", "2").exit_code == 0
