"""``railhil hunt``: a planted defect is found, shrunk and repeated to the byte, whatever the processes did."""

from __future__ import annotations

import hashlib
import io
import json
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import pytest
from rich.console import Console

from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.faults.language import parse
from railhil.faults.random_faults import Sent
from railhil.hunt import found as found_module
from railhil.hunt import least as least_module
from railhil.hunt import oracle, plan, study
from railhil.hunt.oracle import BENCH, Judged
from railhil.hunt.plan import Plan, Request, make_plan
from railhil.hunt.show import lines
from railhil.hunt.study import HUNT, exit_code
from railhil.record.hash_list import check_hash_list
from railhil.scenarios.run_spec import RunSpec
from railhil.study.execute import Outcome, Stopped, execute
from railhil.study.manifest import read_manifest

T = TypeVar("T")
R = TypeVar("R")
SENT = {"TRN_SPEED": Sent(0.0, 42.0, 0.01), "TRN_POS": Sent(0.0, 42.0, 0.02)}


@dataclass
class MadeUpBench:
    """Stands for the runs: a fault of TRN_SPEED of 50 ms or more breaks rule 4. ``fails``: raised by a run with a fault
    at a place; ``invalid``: every run is; ``always``: what every run violates. A fault of TRN_POS does nothing beside
    others."""

    fails: str = ""
    invalid: bool = False
    always: str = ""
    runs: list[tuple[str, ...]] = field(default_factory=list)
    kept: dict[str, set[str]] = field(default_factory=dict)

    def run_case(
        self, base: RunSpec, requirements: Sequence[Any], faults: Sequence[str], seed: int, folder: Path | None = None
    ) -> Judged:
        texts = tuple(faults) or tuple(base.load().faults)
        self.runs.append(texts)
        if folder is not None:
            self.kept[folder.name] = {str(one["id"]) for one in base.requirements}
        digest = hashlib.sha256(f"{texts} {seed}".encode()).hexdigest()
        if self.invalid:
            return Judged("INVALID", frames_sha256=digest, detail="made up")
        if self.fails and any(text.startswith(self.fails) for text in texts):
            return Judged("TOOL ERROR", {BENCH: "made up"}, frames_sha256=digest)
        speed = [parse(text) for text in texts if text.startswith("TRN_SPEED")]
        long = [one for one in speed if one.count is None and (one.duration_s or 42.0) >= 0.05]
        violated = {"INV-4": "made up"} if long else {self.always: "made up"} if self.always else {}
        idle = tuple(place for place, text in enumerate(texts) if text.startswith("TRN_POS"))
        cells = (f"cell {len(texts)}",)
        idle = idle if len(idle) < len(texts) else ()
        return Judged("FAIL" if violated else "PASS", violated, cells=cells, frames_sha256=digest, idle=idle)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> MadeUpBench:
    made = MadeUpBench()
    for module in (study, least_module, found_module):
        monkeypatch.setattr(module, "run_case", made.run_case)
    monkeypatch.setattr(plan, "faultless_run", lambda base: (42.0, SENT))
    return made


@contextmanager
def straight(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
    yield enumerate(map(work, items))


@contextmanager
def backwards(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
    """As several processes may do: results come in another order."""
    yield ((place, work(items[place])) for place in reversed(range(len(items))))


@contextmanager
def first_two_and_last(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
    """As several processes may do: the first parts come last."""
    places = [len(items) - 1, 1, 0] if len(items) > 2 else [*range(len(items))]
    yield ((place, work(items[place])) for place in places)


@contextmanager
def dies_after_one(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
    def results() -> Iterator[tuple[int, R]]:
        yield 0, work(items[0])
        raise RuntimeError("killed")

    yield results()


def hunt(folder: Path, engine: Any = straight, time_s: float | None = None, **asked: Any) -> tuple[Plan, Outcome]:
    made_plan = make_plan(Request(**{"runs": 40, "seed": 5, **asked}))
    said: list[str] = []
    console = Console(file=io.StringIO())
    made = execute(HUNT, made_plan, str(folder), console, engine, said.append, time_s=time_s)
    return made_plan, HUNT.finish(made_plan, made, engine, said.append)


def cases_and_found(folder: Path) -> dict[str, bytes]:
    """The bytes that depend on code, seed and number of runs alone."""
    files = [folder / "cases.jsonl", folder / "found.json", folder / "summary.json", *(folder / "found").glob("*.toml")]
    return {path.name: path.read_bytes() for path in files}


def test_a_planted_defect_is_found_shrunk_and_repeated_by_its_file(bench: MadeUpBench, tmp_path: Path) -> None:
    made_plan, made = hunt(tmp_path / "a")
    (entry,) = made.summary["requirements"]
    assert (entry["id"], entry["verdict"]) == ("INV-4", "violated")
    assert len(made.summary["found"]) >= 1
    for one in made.summary["found"]:
        (text,) = one["faults"]
        assert text.startswith("TRN_SPEED")
        assert len(one["from"]["faults"]) >= 1
        assert one["is_repeatable"]
        assert one["seed"] == 0
        file = tmp_path / "a/found" / f"{one['name']}.toml"
        assert one["frames_sha256"] in file.read_text()
    kinds = [tuple(text.split()[:2] for text in one["faults"]) for one in made.summary["found"]]
    assert len(kinds) == len({str(kind) for kind in kinds}), "one of each class"
    assert exit_code(made_plan, made) == 1
    told = list(lines(made_plan, made.summary, made.folder))
    assert any(line.startswith("INV-4  VIOLATED in ") for line in told)
    assert told[-1] == "FAIL: INV-4 violated. Not found is not absence: 40 runs with this seed."


def test_the_runs_that_are_kept_are_judged_by_the_sentences_of_the_hunt(bench: MadeUpBench, tmp_path: Path) -> None:
    made_plan, _ = hunt(tmp_path / "a", requirements=("ato",))
    names = {one.id for one in made_plan.requirements}
    assert len(names) > 10
    assert {"INV-4-1", "INV-4-1-without"} <= bench.kept.keys()
    assert all(judged_by == names for judged_by in bench.kept.values())


def test_faults_that_changed_nothing_are_left_out_of_a_case_that_violates(bench: MadeUpBench, tmp_path: Path) -> None:
    made_plan, made = hunt(tmp_path / "a", no_shrink=True)
    rows = [json.loads(line) for line in (tmp_path / "a/cases.jsonl").read_text().splitlines()]
    with_idle = [one for one in rows if one["idle"]]
    assert made.summary["with_idle_faults"] == len(with_idle) > 0
    assert any(one["violated"] for one in with_idle)
    for one in with_idle:
        assert {text.split()[0].split(".")[0] for text in one["idle"]} == {"TRN_POS"}
        assert not {*one["idle"]} & {*one["faults"]}
        if one["violated"]:
            assert one["frames_sha256"] == bench.run_case(made_plan.base, (), one["faults"], one["seed"]).frames_sha256
    assert f"in {len(with_idle)} of them not every fault acted" in list(lines(made_plan, made.summary, made.folder))[1]


def test_what_is_violated_without_any_fault_is_said_so(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.always = "T-1"
    (tmp_path / "mine.toml").write_text('[[requirement]]\nid = "T-1"\nsays = "never true_speed > 1 km/h"\n')
    made_plan, made = hunt(tmp_path / "a", requirements=(str(tmp_path / "mine.toml"),))
    (found,) = [one for one in made.summary["found"] if one["id"] == "T-1"]
    assert (found["faults"], found["is_repeatable"]) == ([], True)
    told = list(lines(made_plan, made.summary, made.folder))
    place = next(place for place, line in enumerate(told) if line.startswith("T-1  VIOLATED"))
    assert told[place + 1].strip() == "(without any fault)"
    assert "--requirements" not in told[place + 3], "the file has the sentence"
    document = tomllib.loads((tmp_path / "a/found/T-1-1.toml").read_text())
    assert [(one["id"], one["says"]) for one in document["requirement"]] == [("T-1", "never true_speed > 1 km/h")]


def test_a_requirement_that_no_run_was_judged_by_is_not_called_silent(bench: MadeUpBench, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('[[requirement]]\nid = "T-1"\nsays = "never true_speed > 1 km/h"\n')
    made_plan, made = hunt(tmp_path / "a", requirements=(str(tmp_path / "mine.toml"),), runs=4)
    assert any(line.startswith("T-1  not judged in any run") for line in lines(made_plan, made.summary, made.folder))


def test_the_order_of_results_and_an_interruption_change_no_byte(bench: MadeUpBench, tmp_path: Path) -> None:
    hunt(tmp_path / "a")
    hunt(tmp_path / "b", backwards)
    with pytest.raises(Stopped, match="8 of 40 runs are kept"):
        hunt(tmp_path / "c", dies_after_one)
    hunt(tmp_path / "c")
    assert cases_and_found(tmp_path / "a") == cases_and_found(tmp_path / "b") == cases_and_found(tmp_path / "c")


def test_a_longer_hunt_begins_with_the_cases_of_a_shorter_one(bench: MadeUpBench, tmp_path: Path) -> None:
    hunt(tmp_path / "a", runs=16, no_shrink=True)
    hunt(tmp_path / "b", runs=24, no_shrink=True)
    short, long = ((tmp_path / name / "cases.jsonl").read_text().splitlines() for name in "ab")
    assert long[:16] == short


def test_a_hunt_that_ends_by_time_is_one_of_the_runs_made(bench: MadeUpBench, tmp_path: Path) -> None:
    hunt(tmp_path / "a", runs=16)
    hunt(tmp_path / "b", first_two_and_last, time_s=1e-9, runs=80)
    assert cases_and_found(tmp_path / "a") == cases_and_found(tmp_path / "b")
    ended, whole = (replace(read_manifest(tmp_path / name, HUNT), recorded={}) for name in "ba")
    assert ended == whole
    parts = sorted(path.name for path in (tmp_path / "b/parts").iterdir())
    assert parts == ["cases-000000.parquet", "cases-000001.parquet"]
    check_hash_list(tmp_path / "b", HUNT.manifest, None)
    made_before = len(bench.runs)
    hunt(tmp_path / "b", runs=16)
    assert len(bench.runs) == made_before


def test_a_hunt_whose_time_is_long_makes_all_its_runs(bench: MadeUpBench, tmp_path: Path) -> None:
    _, made = hunt(tmp_path / "a", time_s=1e6, runs=16)
    assert made.summary["runs"] == 16


def test_a_finished_hunt_makes_no_run_again(bench: MadeUpBench, tmp_path: Path) -> None:
    _, first = hunt(tmp_path / "a")
    made_before = len(bench.runs)
    _, second = hunt(tmp_path / "a")
    assert len(bench.runs) == made_before
    assert second.summary == first.summary
    (tmp_path / "a/found/INV-4-1.toml").write_text("changed")
    _, third = hunt(tmp_path / "a")
    assert third.summary == first.summary
    assert "changed" not in (tmp_path / "a/found/INV-4-1.toml").read_text()


def test_a_clean_bench_ends_with_0_and_claims_no_absence(bench: MadeUpBench, tmp_path: Path) -> None:
    made_plan, made = hunt(tmp_path / "a", only=("INV-9",))
    assert made.summary["requirements"] == made.summary["found"] == []
    assert exit_code(made_plan, made) == 0
    told = list(lines(made_plan, made.summary, made.folder))
    assert told[-1] == "no violation found in 40 runs with this seed. Not found is not absence."


def test_a_run_that_fails_is_a_finding_of_its_own(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.fails = "TRN_POS"
    made_plan, made = hunt(tmp_path / "a", only=("INV-9",))
    assert [one["id"] for one in made.summary["requirements"]] == [BENCH]
    assert exit_code(made_plan, made) == 4


def test_runs_that_say_nothing_make_no_verdict(bench: MadeUpBench, tmp_path: Path) -> None:
    bench.invalid = True
    made_plan, made = hunt(tmp_path / "a")
    assert exit_code(made_plan, made) == 3
    assert "only 0 of 40 runs" in list(lines(made_plan, made.summary, made.folder))[-1]


def test_an_exception_in_a_run_is_told_with_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise ZeroDivisionError("planted")

    monkeypatch.setattr(oracle, "run_into", fail)
    found = oracle.run_case(RunSpec(bus="local"), (), (), 0)
    assert found.verdict == "TOOL ERROR"
    assert found.violated == {BENCH: "ZeroDivisionError: planted (in fail of test_hunt.py)"}


def test_a_run_is_judged_by_the_faults_that_acted(short: Path) -> None:
    base, acts, idle = (
        RunSpec(str(short / "short.toml"), bus="local"),
        "TRN_SPEED loss @1s for 200ms combine",
        ("balise missed only 9 @1s combine"),
    )
    found = oracle.run_case(base, (), (idle, acts), 0)
    alone = oracle.run_case(base, (), (acts,), 0)
    assert (found.verdict, found.idle, found.cells) == (alone.verdict, (0,), alone.cells)
    assert alone.idle == ()
    nothing = oracle.run_case(base, (), (idle,), 0)
    assert (nothing.verdict, nothing.is_valid, nothing.idle) == ("INVALID", False, ())


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short journey, and a requirement that faults can violate, beside one that they cannot."""
    folder = tmp_path_factory.mktemp("hunt")
    (folder / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    (folder / "mine.toml").write_text(
        '[[requirement]]\nid = "CUT"\nsays = "never controller_level >= traction_cut"\n'
        '[[requirement]]\nid = "BACK"\nsays = "never true_speed < -1 km/h"\n',
        encoding="utf-8",
    )
    return folder


@pytest.mark.long
def test_on_the_bench_the_file_repeats_the_run_over_the_bus(short: Path) -> None:
    words = ("--requirements", short / "mine.toml", "--runs", "8", "--seed", "3")
    for jobs, name in (("1", "one"), ("2", "two")):
        done = railhil("hunt", short / "short.toml", *words, "--jobs", jobs, "--out", short / name)
        assert done.exit_code == 1, done.err
        assert "CUT  VIOLATED" in done.out
        assert "BACK  not found in " in done.out
    assert cases_and_found(short / "one") == cases_and_found(short / "two")
    (found,) = [one for one in json.loads((short / "one/found.json").read_text()) if one["name"] == "CUT-1"]
    repeated = railhil(
        "run",
        short / "one/found/CUT-1.toml",
        "--controller",
        "ipfc",
        "--seed",
        str(found["seed"]),
        "--out",
        short / "run",
    )
    assert found["frames_sha256"] in repeated.out
    (verdict,) = [line for line in repeated.out.splitlines() if line.startswith("FAIL")]
    assert "CUT" in verdict, "its file has the sentence"
    assert "requirement CUT" in railhil("score", short / "one/found/CUT-1").out, "so has its folder"
    verified = railhil("hunt", "--verify", short / "one", "--runs", "2")
    assert verified.exit_code == 0, verified.err
    assert "2 of 2 runs are the same on the bench" in verified.out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--only", "XY"], "--only: found 'XY'"),
        (["--requirements", "none.toml"], "none.toml: does not exist"),
        (["--controller", "nobody"], "--controller: found 'nobody'"),
        (["--scheduler", "tcp://here:1"], "--scheduler: used only with --engine dask"),
        (["--runs", "0"], "argument --runs"),
        (["--time", "5 days"], "argument --time: found 5 days, allowed a time above 0"),
        (["--time", "1h", "--shard", "1/2", "--out", "x"], "--time: used only without --shard"),
    ],
)
def test_bad_input_is_one_line(words: list[str], said: str) -> None:
    done = railhil("hunt", "yizhuang_05", *words)
    assert done.exit_code == 2
    assert said in done.err
