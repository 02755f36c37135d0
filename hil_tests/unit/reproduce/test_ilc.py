"""The paper on precise stopping: its sets of sequences, and tables and statements of made-up ones."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.paths import ROOT
from hil_tests.support.stops import SHORT
from railhil.common.errors import InputError
from railhil.controller_node.vector.controller import VectorController
from railhil.reproduce.comparison import FOLLOWS, FOLLOWS_NOT, IN_PART, OPEN
from railhil.reproduce.document import render_page, render_parameters
from railhil.reproduce.experiments import SequenceSet
from railhil.reproduce.ilc import PAPER, runs
from railhil.reproduce.ilc.memory_faults import (
    DETECTED,
    ERROR,
    FAULTS,
    RECOVERED,
    RECOVERED_P90,
    SEEN,
    UNDETECTED,
    WORST,
    WORST_AT_ONCE,
    MemoryFaults,
    name_fault_figure,
)
from railhil.reproduce.paper import PAPERS, Measurement, Results, find_paper
from railhil.scenarios.parameters import load_parameters
from railhil.sequences import one as one_by_one
from railhil.sequences.one import runner_of, sequence
from railhil.sequences.plan import run_specs

SEEDS = tuple(range(5, 15))
Values = dict[str, float | None]


def of_each_run(error_m: Callable[[int], float]) -> Values:
    """Figures of a set in which the error depends only on the number of the run."""
    found: Values = {}
    for number in range(1, runs.RUNS + 1):
        found |= {runs.name_run_figure(figure, number): error_m(number) for figure in runs.FIGURES}
        found[runs.name_run_figure(runs.WITHIN_10, number)] = float(error_m(number) <= 0.1)
        found[runs.name_run_figure(runs.WITHIN_30, number)] = float(error_m(number) <= 0.3)
    last = error_m(runs.RUNS)
    for name in (runs.name_last_figure, runs.name_whole_figure):
        shares = {name(runs.WITHIN_10): float(last <= 0.1), name(runs.WITHIN_30): float(last <= 0.3)}
        found |= {name(figure): last for figure in (runs.MEAN, runs.RMS, runs.P95)} | shares
    inside = [number for number in range(1, runs.RUNS - 1) if error_m(number) <= 0.3]
    runs_needed = float(inside[0]) if inside else None
    return found | {
        runs.CONVERGED: runs_needed, runs.CONVERGED_P90: runs_needed, runs.NOT_STOPPED: 0.0,
        runs.LAST_RMS_HELD: last,
    }  # fmt: skip


def learned(first_m: float, last_m: float) -> Values:
    """Halved from run to run, as gain 0.5 does."""
    return of_each_run(lambda number: max(last_m, first_m * 0.5 ** (number - 1)))


def made(**others: Values) -> Results:
    """Sets as paper and specification have them, unless others are given."""
    found: dict[str, Values] = {}
    for planned in PAPER.plan(SEEDS):
        key = planned.key
        if key.startswith("eps-fixed"):
            best, cycle = (0.2, "16ms") if key.endswith("16ms") else (0.4, "48ms")
            found[key] = of_each_run(lambda number, key=key, best=best: 0.2 if f"fixed-{best:g}-" in key else 0.4)
            assert key.endswith(cycle)
        elif key in ("reaim-observer-balises", "reaim-loss"):
            found[key] = of_each_run(lambda number: 0.04)
        elif key.startswith(("reaim", "open")):
            found[key] = learned(0.04, 0.02)
        elif key == runs.MEMORY:
            found[key] = {}
            for fault in FAULTS:
                found[key][name_fault_figure(fault, SEEN)] = float(fault in DETECTED)
                for figure in (ERROR, WORST_AT_ONCE, WORST, RECOVERED, RECOVERED_P90):
                    found[key][name_fault_figure(fault, figure)] = 4.0
        else:
            found[key] = learned(5.0, 0.11)
    found[runs.NO_FILTER] = of_each_run(lambda number: max(0.24, 5.0 * 0.65 ** (number - 1)))
    found["gamma-1.5"] = learned(2.0, 0.22)
    found["gamma-2"] = of_each_run(lambda number: float(number))
    found["scatter-0.01"] = of_each_run(lambda number: 1.75)
    found["window-0.1"] = {runs.NOT_STOPPED: 0.25}
    found |= others
    return Results(SEEDS, {key: Measurement(key, "FAIL", (), "0" * 64, values) for key, values in found.items()})


def test_statements_follow_from_sets_as_paper_and_specification_have_them() -> None:
    assert [one.verdict for one in PAPER.judge(made())] == [
        IN_PART,  # 0.31 m in run 5, 0.11 m later.
        FOLLOWS,
        IN_PART,  # The best eps depends on the cycle and on nothing else.
        FOLLOWS,
        FOLLOWS,
        FOLLOWS_NOT,  # All filters are equally good, and the packet is not the first of them.
        FOLLOWS_NOT,
        FOLLOWS_NOT,
        FOLLOWS,
        FOLLOWS,
        FOLLOWS,
    ]


def test_statements_about_other_sets() -> None:
    quick = learned(0.4, 0.09)
    found = PAPER.judge(made(**{runs.PAPER_CASE: quick, "window-0.1": {runs.NOT_STOPPED: 0.0}}))
    assert [found[place].verdict for place in (0, 5, 6)] == [FOLLOWS] * 3
    found = PAPER.judge(made(**{"reaim-learned": learned(0.05, 0.045)}))
    assert (found[8].verdict, found[10].verdict) == (IN_PART, IN_PART)
    worse = learned(2.0, 0.5)
    found = PAPER.judge(made(**{runs.PAPER_CASE: worse}))
    assert [found[place].verdict for place in (0, 1, 4)] == [FOLLOWS_NOT] * 3
    assert "packet, mean error, allowed 0.1 to 0.15: 0.500" in found[9].measured
    assert found[9].verdict == IN_PART


def test_sets_that_were_not_made_are_no_figures() -> None:
    nothing = Results(SEEDS, {})
    assert {one.verdict for one in PAPER.judge(nothing)} == {OPEN}
    assert "packet" in render_page(PAPER, nothing)


def test_the_bands_say_on_which_side_a_figure_is_outside() -> None:
    results = made(**{"reaim-learned": learned(0.06, 0.03), "gamma-2": learned(2.0, 0.1)})
    remarks = find_remarks(results)
    assert remarks["without balises: rms, allowed at most 0.066"] == "holds"
    assert remarks["observer, balises: rms, allowed at most 0.026"] == "does not hold: above"
    assert remarks["gamma 2 must not converge: within 0.3 m, allowed at most 1"] == "does not hold: above"
    assert remarks["packet, mean error, allowed 0.1 to 0.15"] == "holds"
    quick = find_remarks(made(**{runs.PAPER_CASE: learned(5.0, 0.05)}))
    assert quick["packet, mean error, allowed 0.1 to 0.15"] == "does not hold: below"


def find_remarks(results: Results) -> dict[str, str]:
    """Verdict of each bound."""
    tables = [table for table in PAPER.compare(results) if table.name in ("acceptance", "bars")]
    return {line.item: line.remark for table in tables for line in table.lines}


def test_the_figures_show_what_was_made() -> None:
    found = PAPER.draw(made())
    assert [one.name for one in found] == ["figure_6", "table_2", "ours"]
    mean_error = found[0].charts[0].curves[0].y
    assert 10 ** mean_error[:2] == pytest.approx([5.0, 2.5])
    assert found[1].charts[0].curves[2].y == pytest.approx([0.2, 0.4, 0.4, 0.4])


@pytest.mark.slow
def test_each_set_can_be_made() -> None:
    """Scenario, law and parameters of every entry go together."""
    seen = set()
    for planned in PAPER.plan(PAPER.text.seeds):
        spec = planned.spec
        which = (spec.scenario, spec.settings, spec.law.label)
        if which not in seen:
            seen.add(which)
            VectorController(spec.load(), spec.law)
    assert len(seen) > 30


def test_parameter_files_are_read_as_the_sets_that_they_are_of(tmp_path: Path) -> None:
    for paper in map(find_paper, PAPERS):
        given = [one.spec.law.parameters for one in paper.plan(paper.text.seeds)]
        files = render_parameters(paper, Results(paper.text.seeds, {}))
        assert set(files) == {str(one.source) for one in given if one is not None}
        for one in given:
            if one is not None:
                file = tmp_path / "one.toml"
                file.write_text(files[str(one.source)], encoding="utf-8")
                assert load_parameters(file).sha256 == one.sha256


def test_seeds_that_do_not_follow_each_other_are_refused() -> None:
    with pytest.raises(InputError, match=r"--seeds: found '?5,7'?, allowed seeds that follow each other, as 5-14"):
        PAPER.plan((5, 7))


def short(key: str, first: int = 5) -> Any:
    """An entry with 2 sequences of 2 runs of 12 s."""
    one = next(one for one in PAPER.plan(SEEDS) if one.key == key)
    return replace(
        one, spec=replace(one.spec, settings=(*one.spec.settings, *SHORT)), experiment=SequenceSet(first, 2, 2)
    )


@pytest.mark.long
@pytest.mark.slow
def test_a_set_has_the_runs_of_its_sequences(tmp_path: Path) -> None:
    one = short(runs.NO_FILTER)
    found = one.experiment.make(one.spec, tmp_path)
    assert not list(tmp_path.iterdir())
    scenario = one.spec.load()
    for row, seed in zip(found.runs, (5, 6), strict=True):
        specs = run_specs(one.spec, scenario, seed, 2)
        alone = [*sequence(scenario, specs, runner_of(scenario))]
        assert [(run.digest, run.left.sha256) for run in row] == [(run.digest, run.left.sha256) for run in alone]
    values = runs.measure(found)
    errors = runs.find_errors(found.runs)
    assert values[runs.name_run_figure(runs.MEAN, 2)] == pytest.approx(float(abs(errors[:, 1]).mean()))
    assert values[runs.NOT_STOPPED] == 0.0
    assert values[runs.CONVERGED] is None
    assert found.verdict == "FAIL"
    assert found.reasons == ("4 of 4 runs FAIL",)


@pytest.mark.long
@pytest.mark.slow
def test_the_command_beside_a_set_makes_the_same_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from railhil.judge.judging import judging_of
    from railhil.sequences.__main__ import COMMAND
    from railhil.sequences.table import schema
    from railhil.study.table import read_table

    one = short(runs.NO_FILTER)
    monkeypatch.chdir(tmp_path)
    for name, text in render_parameters(PAPER, Results(SEEDS, {})).items():
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_text(text, encoding="utf-8")
    words = one.experiment.words(one.spec)
    assert words[0] == "learn"
    assert "parameters/filter_none.toml" in words
    assert COMMAND.main([*words[1:], "--jobs", "1", "--no-report", "--out", "set"]) == 0
    table = read_table(Path("set", "results.parquet"), schema(judging_of(one.spec.load())))
    made_here = one.experiment.make(one.spec, tmp_path).runs
    assert table["notch_digest"].to_pylist() == [run.digest for row in made_here for run in row]


@pytest.mark.long
@pytest.mark.slow
def test_damaged_memories(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = short(runs.PAPER_CASE).spec
    found = MemoryFaults(5, 1, before=2, after=1).make(spec, tmp_path)
    values = found.figures
    assert values is not None
    assert {fault: values[name_fault_figure(fault, SEEN)] for fault in FAULTS} == {
        fault: float(fault in DETECTED) for fault in FAULTS
    }
    scenario = spec.load()
    alone = [*sequence(scenario, run_specs(spec, scenario, 5, 3), runner_of(scenario))]
    assert values["none: error_m"] == alone[2].score.signed["stop_error_m"]
    # The other slot has one run less; without any the train stops as in its first run.
    assert values["both records damaged: error_m"] > values["newest record damaged: error_m"] > values["none: error_m"]
    assert {values[name_fault_figure(fault, "recovered")] for fault in FAULTS} == {None}
    # Where runs are made one by one, they begin with the given memory, too.
    monkeypatch.setattr(one_by_one, "sequence_batch_of", lambda scenario: None)
    specs = run_specs(spec, scenario, 5, 3)[2:]
    ((_, _, run),) = one_by_one.sequences(scenario, [specs], [alone[1].left])
    assert (run.digest, run.left.sha256) == (alone[2].digest, alone[2].left.sha256)
    assert MemoryFaults(5, 1).words(spec) == []
    assert UNDETECTED


FOLDER = ROOT / "docs" / "reproduce" / "ilc"


@pytest.fixture(scope="module")
def written() -> dict[str, Any]:
    """The document in the docs."""
    found: dict[str, Any] = json.loads((FOLDER / "results.json").read_text("utf-8"))
    return found


@pytest.mark.long
@pytest.mark.slow
def test_a_set_of_the_page_is_made_again(written: dict[str, Any], tmp_path: Path) -> None:
    """The one with the least runs."""
    (one,) = (one for one in PAPER.plan(PAPER.text.seeds) if one.key == "window-0.1")
    (there,) = (run for run in written["runs"] if run["run"] == "window-0.1")
    found = one.experiment.make(one.spec, tmp_path)
    assert (found.verdict, list(found.reasons), found.frames_sha256) == (
        there["verdict"],
        there["reasons"],
        there["sha256"],
    )
    assert runs.measure(found) == there["measured"]
