"""``railhil tune`` as a command: evaluation, refusals, Ctrl-C, shipped files."""

from __future__ import annotations

import json
import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil
from hil_tests.support.scores import with_values
from railhil.batch import Case
from railhil.common.errors import InputError
from railhil.controller_node import laws
from railhil.judge.folder import code_sha256
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.judge.criteria import CRITERIA, STOP_ERROR
from railhil.systems.ato.scenario.model import Scenario
from railhil.tuning import __main__ as tool
from railhil.tuning.__main__ import shipped
from railhil.tuning.command import arguments
from railhil.tuning.evaluation import Evaluation, better, evaluate, quantiles, worse
from railhil.tuning.objective import Scale
from railhil.tuning.search import Box, Protocol, search
from railhil.tuning.trials import Trials


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 8 m."""
    path = tmp_path_factory.mktemp("quick") / "quick.toml"
    path.write_text(QUICK_TOML, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def short(quick: Path) -> Scenario:
    """That run, loaded."""
    return load(str(quick))


@pytest.mark.slow
def test_evaluation_refuses_training_seeds(short: Scenario) -> None:
    case = Case(short, LawSpec("ipfc", "float64"))
    given = ParameterSet("ipfc", {"model_gain_mps": 0.08}, Path("tuned.toml"), short.name, frozenset({0, 1}))
    with pytest.raises(InputError, match="seed 1, on which these parameters were tuned"):
        evaluate(case, given, range(1, 5))
    allowed = evaluate(case, given, range(1, 4), allow_training_seeds=True)
    assert allowed.seen == (1,)
    other = evaluate(case, given, range(2, 4))
    assert other.seen == ()
    assert other.tuned.scores == run_batch(replace(case, law=replace(case.law, parameters=given)), (2, 3)).scores
    assert other.default.scores == run_batch(case, (2, 3)).scores


@pytest.mark.long
@pytest.mark.slow
def test_a_set_that_is_worse_on_other_runs_is_laid_aside(
    quick: Path, short: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "kept.toml"
    command = ["tune", "fuzzy_pid", str(quick), "--budget", "10", "--seeds", "0", "--runs", "4", "--out", str(file)]
    # The search takes the largest objective for the best.
    judge = Trials.of
    monkeypatch.setattr(Trials, "of", lambda self, given: [None if x is None else -x for x in judge(self, given)])
    monkeypatch.setattr("sys.argv", command)
    assert tool.main() == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("WORSE than the law's own parameters on the 4 runs of the evaluation (objective ")
    assert last.endswith(f"{file} holds the law's own")
    box = Box.of("fuzzy_pid", laws.load("fuzzy_pid"))
    assert dict(load_parameters(file).values) == dict(zip(box.names, box.default, strict=True))
    notes = tomllib.loads(file.read_text(encoding="utf-8"))["training"]["notes"]
    assert notes["laid_aside"] in last
    assert notes["objective_tuned"] == notes["objective_default"]


@pytest.mark.slow
def test_the_laws_own_parameters_are_not_called_the_better_set(
    quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "own.toml"
    monkeypatch.setattr(Trials, "of", lambda self, given: [None for _ in given])
    words = ["fuzzy_pid", str(quick), "--budget", "10", "--seeds", "0", "--runs", "2", "--out", str(file)]
    assert tool.main(words) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last == f"no better set was found: {file} holds the law's own parameters"


def test_what_counts_as_worse(short: Scenario) -> None:
    result = run_batch(Case(short, LawSpec("ipfc", "float64")), (2, 3, 4))
    given = ParameterSet("ipfc", {}, Path("tuned.toml"))
    scale = Scale.of(short, result.scores)

    def said(**changes: object) -> list[str]:
        return worse(
            Evaluation(Case(short, LawSpec("ipfc", "float64")), given, (), result, replace(result, **changes)), scale
        )

    assert said() == []
    same = Evaluation(Case(short, LawSpec("ipfc", "float64")), given, (), result, result)
    assert not better(same, scale), "as good"
    more = tuple(with_values(score, itae=2 * score.values["itae"]) for score in result.scores)
    assert [text.split()[0] for text in said(scores=more)] == ["objective"]
    assert said(scores=tuple(with_values(score, itae=0.5 * score.values["itae"]) for score in result.scores)) == []
    beyond = np.full(3, 1e3)
    (text,) = said(values=result.values | {"stop_error_m": beyond})
    assert text.endswith("-> 1000.000 m")
    # Inside the limit an error may grow: the objective weighs it.
    assert said(values=result.values | {"punctuality_s": np.full(3, short.plan.time_error_max_s)}) == []
    if result.passed.any():
        assert said(passed=np.zeros(3, dtype=bool)) != []


def test_parameters_that_no_candidate_can_mend_are_named(short: Scenario) -> None:
    scenario = replace(short, timing=replace(short.timing, control_period_ns=100_000_000))
    with pytest.raises(InputError) as caught:
        search(Protocol(scenario, LawSpec("ipfc_plus", "float64"), seeds=(0,), budget=10))
    assert "a loop delay of 0.11 s is not inside the control period of 0.1 s" in str(caught.value)
    assert str(caught.value).endswith("not searched, so that no candidate can mend it: loop_delay_s)")


def test_a_run_that_does_not_stop_is_infinitely_bad(short: Scenario) -> None:
    result = run_batch(Case(short, LawSpec("ipfc", "float64")), (2, 3, 4))
    stop = result.values["stop_error_m"].copy()
    stop[1] = np.nan
    spoiled = replace(result, values=result.values | {"stop_error_m": stop})
    assert quantiles(spoiled, STOP_ERROR) == [max(stop[0], stop[2]), math.inf]
    assert quantiles(spoiled, CRITERIA[0]) == quantiles(result, CRITERIA[0])


def test_training_seeds_are_in_order_and_each_once() -> None:
    def seeds(text: str) -> tuple[int, ...]:
        found: tuple[int, ...] = arguments().parse_args(["ipfc", "--seeds", text]).seeds
        return found

    assert seeds("9,3, 5-6,3") == (3, 5, 6, 9)
    assert seeds("0-9999") == tuple(range(10_000))


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_tune_as_a_user_runs_it(
    quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    done = railhil("tune", "fuzzy_pid", quick, "--budget", "10", "--seeds", "3,5", "--runs", "4", cwd=tmp_path)
    assert done.exit_code == 0, done.err
    assert done.said == []
    assert [path.name for path in tmp_path.iterdir()] == ["fuzzy_pid_benchmark_quick.toml"]
    file = tmp_path / "fuzzy_pid_benchmark_quick.toml"
    given = load_parameters(file)
    assert (given.law, given.training_seeds) == ("fuzzy_pid", {3, 5})
    assert "4 perturbed runs, seeds 1000 to 1003, float64" in done.out
    assert "TRAINING" not in done.out

    # The evaluation alone says the same; with a training seed it says nothing, or that it is none.
    def evaluated(*more: str) -> str:
        assert tool.main(["--evaluate", str(file), "fuzzy_pid", str(quick), "--runs", "4", *more]) == 0
        return capsys.readouterr().out

    shown = evaluated()
    *before, last = done.out.splitlines()
    assert "\n".join(before).endswith(shown.rstrip("\n"))
    assert last.startswith(
        ("the tuned parameters are the better set on the 4 runs", "WORSE than the law's own", "no better set was found")
    )
    told = json.loads(evaluated("--json"))
    assert (told["runs"], told["first_seed"], told["training_seeds"]) == (4, 1000, [])
    assert told["tuned"]["scores"].keys() == told["default"]["scores"].keys()
    weak = evaluated("--set", "watch.emergency_ms=2000")
    assert "watch weakened: emergency_ms 2000 (usual 1000)" in weak.splitlines()
    with pytest.raises(InputError, match="seed 3, on which these parameters were tuned"):
        evaluated("--seed", "2")
    assert "THESE ARE TRAINING RUNS: 2 of the seeds" in evaluated("--seed", "2", "--allow-training-seeds")

    # Of other code it says so first.
    notes = tomllib.loads(file.read_text(encoding="utf-8"))["training"]["notes"]
    assert notes["code_sha256"] == code_sha256()
    text = file.read_text(encoding="utf-8")
    for key, words in (("code_sha256", "the code of the bench has"), ("tuning_sha256", "the code of the search has")):
        file.write_text(text.replace(notes[key], "0" * 64), encoding="utf-8")
        said = [line for line in evaluated().splitlines() if line.startswith("note: ")]
        assert said == [f"note: {words} changed since the search ({key})"]


def test_ctrl_c_writes_the_best_so_far(
    quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "best.toml"
    judge, judged = Trials.of, []

    def pressed(self: Trials, candidates: list[dict[str, float]]) -> list[float | None]:
        if judged:
            raise KeyboardInterrupt
        judged.append(judge(self, candidates))
        return judged[0]

    monkeypatch.setattr(Trials, "of", pressed)
    assert tool.main(["tdmc", str(quick), "--budget", "60", "--seeds", "0", "--out", str(file)]) == 130
    assert "stopped before the budget was used up" in capsys.readouterr().out
    assert load_parameters(file).law == "tdmc"
    notes = tomllib.loads(file.read_text(encoding="utf-8"))["training"]["notes"]
    assert (notes["complete"], notes["evaluations"]) == (False, 10)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "LAW: missing, expected one of"),
        (["ipcf"], "did you mean ipfc?"),
        (["ipfc", "nowhere"], "nowhere"),
        (["ipfc", "--budget", "9"], "found 9, allowed 10..1000000"),
        (["ipfc", "--seeds", "7-0"], "found 7-0, allowed seeds and ranges"),
        (["ipfc", "--seed", "5"], "seed 5, which is a training seed"),
        (["ipfc", "--seed", "4294967295"], "a last seed of at most 4294967295"),
        (["ipfc", "--out", "."], "--out: the file . cannot be written: is a directory"),
        (["ipfc", "--indexing", "sideways"], "--indexing"),
        (["--evaluate", "none.toml"], "none.toml: does not exist"),
        (["--evaluate", "none.toml", "--out", "x"], "--out: cannot be given with --evaluate"),
        (["--evaluate", "none.toml", "--runs", "0"], "at least 1 beside --evaluate"),
        (["--evaluate", "none.toml", "--list"], "--evaluate"),
        (["ipfc", "--list"], "--list: cannot be given with a law"),
        (["pid"], "SCENARIO: found None, allowed a scenario of system emu3 or hst1"),
        (["pid", "hst_short", "--indexing", "distance"], "--indexing: found 'distance', allowed time with system hst1"),
        (["pid", "yizhuang_stop"], "found 'pid', allowed one of ilc_stop"),
        (["one_shot", "yizhuang_stop"], "found 'one_shot', allowed a law that declares tunable parameters"),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises((InputError, SystemExit)) as caught:
        tool.main(arguments)
    said = capsys.readouterr()
    if isinstance(caught.value, InputError):
        line, code = str(caught.value), caught.value.exit_code
    else:
        line, code = said.err.rstrip("\n"), caught.value.code
    assert code == 2
    assert words in line
    assert "\n" not in line
    assert said.out == ""
    assert not list(tmp_path.iterdir())


@pytest.mark.long
@pytest.mark.slow
def test_shipped_files_are_of_every_law_and_of_this_code() -> None:
    """After a change of a law, the plant or the protocol the files are to be made again.

    What a file claims is claimed under the limits that its scale holds: the stop's was 0.2 m then.
    """
    files = shipped()
    # Laws that somebody plugs in have no file here.
    own = {law for law in laws.names() if laws.load(law).__module__.startswith("railhil.controller_node.")}
    assert {given.law for given in files} == own
    for given in files:
        content = tomllib.loads(given.source.read_text(encoding="utf-8"))
        notes = content["training"]["notes"]
        assert (given.source.stem, given.source.parent.name) == (given.law, given.training_scenario)
        assert (notes["budget"], notes["complete"], notes["objective_version"]) == (800, True, 1)
        seeds = content["training"]["seeds"]
        assert seeds == list(range(8))
        scenario, scale = load(given.training_scenario), notes["scale"]
        plan = replace(scenario.plan, stop_error_max_m=scale["stop_error_m"], time_error_max_s=scale["time_error_s"])
        trials = Trials(replace(scenario, plan=plan), LawSpec(given.law, "float64", notes["indexing"]), seeds)
        default, (tuned,) = trials.of_defaults(), trials.of([given.values])
        assert tuned is not None
        assert tuned <= default
        # Another mathematical library may move single runs by a last bit, and so by centimetres.
        assert default == pytest.approx(notes["objective_default"], rel=0.05), given.law
        assert tuned == pytest.approx(notes["objective_tuned"], rel=0.05), given.law


def test_list_names_every_shipped_file(tmp_path: Path) -> None:
    done = railhil("tune", "--list", cwd=tmp_path)
    assert done.exit_code == 0
    assert done.out.splitlines() == [f"{one.law}  {one.training_scenario}  {one.source}" for one in shipped()]
    assert done.out
