"""Tuning: candidates judged together, the search, the objective, and that every law can be tuned."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.plug import plug_in
from hil_tests.support.scores import made_score, with_values
from railhil.batch import Case
from railhil.bench import local_run
from railhil.common.errors import InputError
from railhil.controller_node import laws
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant, Curve
from railhil.controller_node.arithmetic.float64 import Float64Batch
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.program.model import Evaluator, Kind, LawProgram
from railhil.controller_node.program.tracer import Tracer
from railhil.judge.score import Score
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.batch.stacked import StackedLoop
from railhil.systems.ato.judge.judging import JUDGING
from railhil.systems.ato.scenario.model import Scenario
from railhil.tuning.document import document
from railhil.tuning.objective import EXTRA, TERM_MAX, Scale, Term, objective, run_cost
from railhil.tuning.search import Box, Found, Protocol, search
from railhil.tuning.trials import Trials

SCENARIO = load("lvshun_tieshan")
SEEDS = (0, 1)
LAWS = laws.names()
#: Corners of a box that are all tried.
_CORNERS = 128


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    """A run of 8 m."""
    path = tmp_path_factory.mktemp("quick") / "quick.toml"
    path.write_text(QUICK_TOML, encoding="utf-8")
    return load(str(path))


@pytest.fixture(scope="module")
def found(short: Scenario) -> tuple[Protocol, Found]:
    """A small search."""
    protocol = Protocol(short, LawSpec("ipfc", "float64"), seeds=SEEDS, budget=40)
    return protocol, search(protocol)


@pytest.fixture(scope="module")
def given(found: tuple[Protocol, Found], tmp_path_factory: pytest.TempPathFactory) -> ParameterSet:
    """The file of that search, read."""
    path = tmp_path_factory.mktemp("tuned") / "ipfc.toml"
    path.write_text(document(*found), encoding="utf-8")
    return load_parameters(path)


def box_of(law: str) -> Box:
    """Box of a law of ato."""
    return Box.of(law, laws.load(law))


def points(law: str, count: int) -> list[dict[str, float]]:
    """Candidates anywhere in the box of a law."""
    box, random = box_of(law), np.random.default_rng(7)
    return [box.candidate(point) for point in random.random((count, len(box.names))).tolist()]


def alone(scenario: Scenario, law: str, values: dict[str, float], seeds: tuple[int, ...]) -> tuple[Score, ...]:
    """Scores of a candidate by the batch engine itself."""
    return run_batch(
        Case(scenario, LawSpec(law, "float64", parameters=ParameterSet(law, values, Path("point")))), seeds
    ).scores


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_candidates_judged_together_are_judged_as_alone(law: str) -> None:
    """Bit for bit, and also where a parameter decides how many operations the law has."""
    near = load("yizhuang_05")
    trials = Trials(near, LawSpec(law, "float64"), SEEDS)
    assert trials.of_defaults() == objective(trials.scale, run_batch(Case(near, LawSpec(law, "float64")), SEEDS).scores)
    candidates = points(law, 5)
    for values, judged in zip(candidates, trials.of(candidates), strict=True):
        if judged is None:
            with pytest.raises(InputError, match="ValueError: "):
                alone(near, law, values, SEEDS)
        else:
            assert judged == objective(trials.scale, alone(near, law, values, SEEDS))


def test_constants_of_each_train() -> None:
    """Tables, curves and negated constants that differ from train to train, as each train alone has them."""
    rows = [(0.0, 1.0, 2.0), (0.0, 0.5, 3.0)]
    curves = [Curve("c", lambda x, a=a: a * x, 20, 20, ()) for a in (2.0, 3.0)]
    arguments, trains = np.array([-1.0, 1.0, 0.7, 9.0]), ([0, 1], [2, 3])

    def programs(row: tuple[float, ...], curve: Curve) -> LawProgram:
        tracer = Tracer(wide=True)
        parts = {name: tracer.begin(name) for name in ("inputs", "start", "sent")}
        step = tracer.begin("step")
        k, x = tracer.input("k", None, Kind.INDEX), tracer.input("speed_01mmps", 0)
        table = tracer.table("t", [Constant(f"t[{i}]", value, 20) for i, value in enumerate(row)])
        place = tracer.locate(table, x)
        found = tracer.add(tracer.at(table, place), tracer.at(table, tracer.index(k, 1), 1))
        # A fraction that its format does not hold.
        lower = tracer.neg(tracer.const(Constant("third", row[1] / 3, 4)))
        step.outputs = [("out.notch", tracer.add(found, tracer.curve(curve, tracer.maximum(x, lower))))]
        return LawProgram("law", parts["inputs"], parts["start"], step, parts["sent"])

    recorded = [programs(row, curve) for row, curve in zip(rows, curves, strict=True)]
    loop = StackedLoop(recorded, 2)
    loop.state = {"k": 1, "speed_01mmps": arguments}
    together = loop.step(0, np.zeros(4), np.zeros(4))[1].notch
    for one, (row, curve), places in zip(recorded, zip(rows, curves, strict=True), trains, strict=True):
        x = arguments[places]
        alone_ = Evaluator(one.step, Float64Batch()).run({"k": 1, "speed_01mmps": x})["out.notch"]
        assert np.array_equal(together[places], alone_)
        row_at = np.array(row)[np.clip(np.searchsorted(row, x, side="right") - 1, 0, 1)]
        assert np.array_equal(alone_, row_at + row[2] + [curve.function(max(v, -row[1] / 3)) for v in x])


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_box_of_every_law(law: str) -> None:
    """Defaults inside; corners give a law in both arithmetics, or one line why it cannot be."""
    kind = laws.load(law)
    box = box_of(law)
    assert 4 <= len(box.names) <= 10
    for name, low, high, default in zip(box.names, box.low, box.high, box.default, strict=True):
        assert low < high
        assert low <= default <= high, name
    start = box.candidate(box.point(box.default))
    assert start == pytest.approx(dict(zip(box.names, box.default, strict=True)), rel=1e-5)
    refusals = []
    corners = list(itertools.product(*zip(box.low, box.high, strict=True)))
    if len(corners) > _CORNERS:
        # IPFC+ takes a tenth of a second to make: some of them.
        chosen = np.random.default_rng(5).choice(len(corners), _CORNERS // 2, replace=False)
        corners = [corners[i] for i in (0, len(corners) - 1, *chosen)]
    for corner in corners:
        parameters = kind.parameters_type(**dict(zip(box.names, corner, strict=True)))
        try:
            for arithmetic in ("float64", "iq"):
                kind(make(arithmetic), SCENARIO, parameters)
        except ValueError as error:
            refusals.append(str(error))
    assert all(text.strip() and "\n" not in text for text in refusals)
    assert len(refusals) <= len(corners) / 2


@pytest.mark.long
@pytest.mark.slow
def test_search_is_deterministic_and_never_worse(found: tuple[Protocol, Found]) -> None:
    protocol, first = found
    again = search(protocol)
    assert document(protocol, again) == document(protocol, first)
    assert first.objective < first.objective_default
    assert first.evaluations == protocol.generations * protocol.population == 40
    assert first.complete
    # What stands in the file is what was judged.
    scale = Trials(protocol.scenario, LawSpec("ipfc", "float64"), SEEDS).scale
    assert objective(scale, alone(protocol.scenario, "ipfc", dict(first.values), SEEDS)) == first.objective
    other = search(replace(protocol, search_seed=1))
    assert other.values != first.values


def test_search_that_finds_nothing_better_keeps_the_defaults(short: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Trials, "of", lambda self, candidates: [None, *[1e9] * (len(candidates) - 1)])
    result = search(Protocol(short, LawSpec("ipfc", "float64"), seeds=(0,), budget=10))
    box = box_of("ipfc")
    assert dict(result.values) == dict(zip(box.names, box.default, strict=True))
    assert result.objective == result.objective_default
    assert (result.evaluations, result.infeasible) == (10, 2)


@pytest.mark.slow
def test_interrupted_search_gives_what_it_has(short: Scenario) -> None:
    protocol = Protocol(short, LawSpec("tdmc", "float64"), seeds=(0,), budget=60)
    judged: list[float] = []

    def pressed(evaluations: int, best: float) -> None:
        judged.append(best)
        if evaluations == 2 * protocol.population:
            raise KeyboardInterrupt

    result = search(protocol, pressed)
    assert not result.complete
    assert result.evaluations == 2 * protocol.population
    trials = Trials(short, LawSpec("tdmc", "float64"), (0,))
    assert result.objective == judged[-1] == trials.of([result.values])[0] < result.objective_default


def test_parameters_at_a_bound_are_named() -> None:
    box = Box(("a", "b", "c"), (0.0, 1.0, 0.01), (1.0, 2.0, 10.0), (0.5, 1.5, 0.1))
    # The third on a logarithmic scale: 0.012 is 2.6 % of the way from 0.01 to 10.
    assert box.at_bounds({"a": 0.981, "b": 1.019, "c": 0.012}) == ["a", "b"]
    assert box.at_bounds({"a": 0.5, "b": 1.03, "c": 9.9}) == ["c"]
    assert box.point((2.0, 0.0, 0.1)) == pytest.approx([1.0, 0.0, 1 / 3])


def test_budget_is_the_same_for_every_law() -> None:
    sizes = {(p.population, p.generations) for p in (Protocol(SCENARIO, LawSpec(law, "float64")) for law in LAWS)}
    assert sizes == {(40, 20)}
    for budget in (10, 11, 49, 50, 333, 5000):
        protocol = Protocol(SCENARIO, LawSpec("ipfc", "float64"), budget=budget)
        assert 0.8 * budget <= protocol.population * protocol.generations <= budget
        assert protocol.generations >= 2


DIVISORS = {"itae": 2000.0, "energy_kj": 75000.0, "punctuality_s": 0.3, "stop_error_m": 0.2, "comfort": 2.0}
SCALE = Scale(tuple(Term(criterion, DIVISORS[criterion.key]) for criterion in JUDGING.criteria), JUDGING.extras)
GOOD = made_score("PASS", 2000.0, 75000.0, 0.3, -0.2, 2.0)


def test_objective() -> None:
    assert run_cost(SCALE, GOOD) == pytest.approx(5.0)
    assert run_cost(SCALE, with_values(GOOD, itae=4000.0)) == pytest.approx(6.0)
    assert run_cost(SCALE, with_values(GOOD, stop_error_m=0.3)) == pytest.approx(5.5)
    assert run_cost(SCALE, with_values(GOOD, stop_error_m=1e6)) == pytest.approx(4.0 + TERM_MAX)
    never = with_values(GOOD, stop_error_m=None, punctuality_s=None)
    assert run_cost(SCALE, never) == pytest.approx(3.0 + 2 * TERM_MAX)
    assert run_cost(SCALE, replace(GOOD, extras={"overspeed_mps": 1 / 3.6})) == pytest.approx(5.0 + EXTRA + 1.0)
    # Every run counts: one that never stops cannot hide behind a median.
    assert objective(SCALE, [GOOD] * 7 + [never]) == pytest.approx(5.0 + (2 * TERM_MAX - 2) / 8)
    # An incomplete record costs the same in every term.
    assert run_cost(SCALE, with_values(GOOD, itae=None)) == pytest.approx(4.0 + TERM_MAX)


def test_a_criterion_without_a_scale_is_left_out(short: Scenario) -> None:
    """The reference runs have 0, or no value at all."""
    scale = Scale.of(short, [with_values(GOOD, itae=0.0, comfort=None), with_values(GOOD, itae=0.0, comfort=None)])
    assert [criterion.key for criterion in scale.left_out] == ["itae", "comfort"]
    assert [term.criterion.key for term in scale.terms] == ["energy_kj", "stop_error_m", "punctuality_s"]
    assert run_cost(scale, with_values(GOOD, itae=5.0)) == run_cost(scale, GOOD)


@pytest.mark.slow
def test_file_drives_a_run(given: ParameterSet, found: tuple[Protocol, Found], short: Scenario, tmp_path: Path) -> None:
    assert given.values == dict(found[1].values)
    assert given.training_scenario == short.name == "benchmark_quick"
    assert given.training_seeds == frozenset(SEEDS)
    own, tuned = (
        local_run(short, tmp_path, RunSpec(law=LawSpec(arithmetic="float64", parameters=parameters)))
        for parameters in (None, given)
    )
    assert own.commands("notch") != tuned.commands("notch")


class Fixed(Ipfc[Any]):
    """A law with nothing to tune."""

    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {}


def test_a_law_with_nothing_to_tune_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plug_in(tmp_path, monkeypatch, fixed=Fixed)
    with pytest.raises(InputError, match="a law that declares tunable parameters"):
        search(Protocol(SCENARIO, LawSpec("fixed", "float64")))
