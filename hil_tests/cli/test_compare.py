"""``railhil compare``: real processes, one law after another, and ``railhil report`` of the results."""

from __future__ import annotations

import csv
import json
import re
import signal
from argparse import Namespace
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import Done, Started, railhil, wait_for
from railhil.cli.compare import _checked
from railhil.controller_node.laws import load
from railhil.run.make import NeverBegan
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named

_PLUGGED = """\
from railhil.controller_node.ato.laws.ipfc import Ipfc

class Twin(Ipfc):
    name = "twin"
    indexings = ("time",)
    parameters_origin = "designed on seeds 0 and 1"
    design_seeds = {"benchmark_quick": range(2)}
"""
_TUNED = """\
law = "ipfc"
[parameters]
softening_max = 0.8
[training]
scenario = "benchmark_quick"
seeds = [0, 1]
"""
_FILES = ["SHA256SUMS", "compare.csv", "compare.json", "report.html"]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Folder of a short scenario, a parameter file, and a second law that the processes find."""
    folder = tmp_path_factory.mktemp("compare")
    package = folder / "plug" / "plugged-0.1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: plugged\nVersion: 0.1\n")
    (package / "entry_points.txt").write_text("[railhil.laws]\ntwin = plugged_twin:Twin\n")
    (package.parent / "plugged_twin.py").write_text(_PLUGGED)
    (folder / "short.toml").write_text(QUICK_TOML)
    (folder / "tuned.toml").write_text(_TUNED)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(package.parent))
        yield folder


@dataclass(frozen=True, slots=True)
class Compared:
    """A finished comparison: what was printed, and ``compare.json``."""

    done: Done
    folder: Path
    document: dict[str, Any]


def compare(place: Path, out: str, *arguments: str, anew: bool = False) -> Done:
    return railhil(
        "compare", place / "short.toml", "--bus", "local", "--quiet", "--out", place / out, *arguments, anew=anew
    )


@pytest.fixture(scope="module")
def compared(place: Path) -> Compared:
    """Three runs: the law of the paper, the same tuned, and the twin."""
    arguments = ("--laws", "ipfc,twin", "--parameters", str(place / "tuned.toml"), "--both", "--seed", "7")
    done = compare(place, "whole", *arguments, anew=True)
    assert done.exit_code in (0, 1), done.err
    document = json.loads((place / "whole" / "compare.json").read_text(encoding="utf-8"))
    return Compared(done, place / "whole", document)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_every_law_runs_and_stands_in_the_table(compared: Compared) -> None:
    runs = compared.document["runs"]
    tuned = load_parameters(compared.folder.parent / "tuned.toml").controller
    assert compared.document["recorded"].keys() == {"utc", "host", "operator"}
    assert [run["label"] for run in runs] == ["ipfc", f"{tuned} tuned", "twin"]
    assert [run["folder"] for run in runs] == ["ipfc", tuned, "twin"]
    assert "twin: the law's own (designed on seeds 0 and 1)" in compared.done.out
    assert sorted(path.name for path in compared.folder.iterdir() if path.is_file()) == _FILES
    for run in runs:
        certificate = json.loads((compared.folder / run["folder"] / "certificate.json").read_text(encoding="utf-8"))
        assert (certificate["frames_sha256"], certificate["seed"]) == (run["frames_sha256"], 7)
        assert railhil("score", compared.folder / run["folder"], "--json").json["scores"] == run["scores"]
        assert f"{run['label']} (measured)" in compared.done.out
        line = f"{run['verdict']}: {run['label']}" + (f": {run['line']}" if run["line"] else "")
        assert line in compared.done.out.splitlines()
    stops = [run["scores"]["stop_error_m"] for run in runs]
    within = {f"{limit:g}": sum(stop <= limit for stop in stops) for limit in (0.1, 0.2, 0.3)}
    assert compared.document["stopped_within_m"] == {
        limit: {"runs": count, "share": count / 3} for limit, count in within.items()
    }
    parts = ", ".join(f"{limit} m: {count} of 3" for limit, count in within.items())
    assert f"runs that stopped within {parts}" in compared.done.out.splitlines()
    # The scenario is derived, and its run is none that was published.
    assert [run["published"] for run in runs] == [None] * 3
    # The twin is the same law, the tuned one is not.
    assert runs[0]["scores"] == runs[2]["scores"] != runs[1]["scores"]
    assert (runs[0]["parameters_sha256"], len(runs[1]["parameters_sha256"])) == (None, 64)
    assert compared.done.exit_code == max({"PASS": 0, "FAIL": 1}[run["verdict"]] for run in runs)


@pytest.mark.slow
@pytest.mark.loop
def test_csv_holds_the_same_figures(compared: Compared) -> None:
    with (compared.folder / "compare.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    for row, run in zip(rows, compared.document["runs"], strict=True):
        assert (row["label"], row["verdict"], row["frames_sha256"]) == (
            run["label"],
            run["verdict"],
            run["frames_sha256"],
        )
        assert {key: float(row[key]) for key in run["scores"]} == run["scores"]
        published = run["published"] or dict.fromkeys(run["scores"], "")
        assert {key: row[f"published_{key}"] for key in run["scores"]} == {k: str(v) for k, v in published.items()}


@pytest.mark.slow
@pytest.mark.loop
def test_report_again_from_the_folders_gives_the_same_bytes(compared: Compared, tmp_path: Path) -> None:
    """In the same place; elsewhere the links to the folders have other addresses."""
    path = compared.folder / "report.html"
    first = path.read_bytes()
    assert b"3 runs, compared" in first
    done = railhil("report", compared.folder, "--out", path)
    assert (done.exit_code, done.out) == (0, f"{path}\n")
    assert path.read_bytes() == first
    folders = [compared.folder / run["folder"] for run in compared.document["runs"]]
    assert railhil("report", *folders, cwd=tmp_path).exit_code == 0
    link = rb'<a href="[^"#]*/([^"/]*)">'
    assert re.sub(link, rb"<a \1>", (tmp_path / "report.html").read_bytes()) == re.sub(link, rb"<a \1>", first)
    full = railhil("report", compared.folder, "--out", "/dev/full")
    assert full.exit_code == 4
    assert full.one_line() == "railhil: /dev/full cannot be written: no space left on device"


@pytest.mark.slow
def test_a_controller_that_cannot_be_had_is_refused_before_the_first_run(place: Path) -> None:
    """Also when it comes last; the folder is free for the next attempt."""
    done = compare(place, "refused", "--laws", "ipfc,twin", "--indexing", "distance")
    assert done.exit_code == 2
    assert "indexing: twin: found 'distance', allowed time with this law" in done.one_line()
    assert done.out == ""
    assert not (place / "refused").exists()


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_all_laws_are_those_that_have_the_indexing(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(place / "plug"))
    done = compare(place, "all", "--indexing", "distance", "--bus", "local", anew=True)
    assert done.exit_code in (0, 1), done.err
    sentence = "Left out, as without set-points over distance: ipfc_plus, ipfc_plus_stop, twin."
    assert sentence in done.out.splitlines()
    document = json.loads((place / "all" / "compare.json").read_text(encoding="utf-8"))
    able = [law for law in system_named("ato").law_names() if "distance" in load(law).indexings]
    assert [run["folder"] for run in document["runs"]] == able
    report = (place / "all" / "report.html").read_bytes()
    assert f"<p>{sentence}</p>".encode() in report
    assert railhil("report", place / "all").exit_code == 0
    assert (place / "all" / "report.html").read_bytes() == report


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_all_laws_are_those_that_have_the_arithmetic() -> None:
    """A law that is computed by a solver has no single precision; asked for by name it is refused."""
    wanted = [RunSpec("hst_short", law=LawSpec(law, "float32")) for law in ("pid", "delay_qp")]
    given = Namespace(laws="all", allow_training_seeds=True, indexing="time")
    plan, notes = _checked(given, wanted[0].load(), wanted)
    assert plan == wanted[:1]
    assert len(notes) == 1
    assert re.match("Left out. .*delay_qp, arithmetic: found 'float32', allowed float64", notes[0])
    for laws, some in (("all", wanted[1:]), ("pid,delay_qp", wanted)):
        with pytest.raises(NeverBegan, match="allowed float64"):
            _checked(Namespace(**{**vars(given), "laws": laws}), wanted[0].load(), some)


@pytest.mark.slow
@pytest.mark.loop
def test_an_interrupted_comparison_keeps_what_was_recorded(place: Path) -> None:
    folder = place / "stopped"
    started = Started(
        "compare", place / "short.toml", "--laws", "ipfc,twin", "--out", folder, "--pace", "realtime", "--rate", "2"
    )
    wait_for(lambda: (folder / "ipfc" / "frames.log").is_file() and (folder / "ipfc" / "frames.log").stat().st_size)
    started.process.send_signal(signal.SIGINT)
    done, _ = started.finish()
    assert done.exit_code == 130
    assert "1 of 2 runs recorded" in done.out
    assert [path.name for path in folder.iterdir()] == ["ipfc"]
    assert json.loads((folder / "ipfc" / "score.json").read_text(encoding="utf-8"))["verdict"] == "INVALID"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--laws", "ipfc,pid"), "--laws: found 'pid', allowed "),
        (("--laws", "ipfc,ipfc"), "allowed each law once"),
        (("--laws", "twin", "--parameters", "tuned.toml"), "law: found 'ipfc', allowed a law that is compared: twin"),
        (("--both",), "--both: used only with --parameters"),
        (("--parameters", "tuned.toml", "--parameters", "tuned.toml"), "allowed one parameter file per law"),
        (("--parameters", "gone.toml"), "gone.toml"),
        (
            ("--parameters", "tuned.toml", "--perturbed", "--seed", "1"),
            "training.seeds: seed 1, on which these parameters were tuned, expected other seeds",
        ),
    ],
)
def test_bad_command_lines_are_one_line_and_leave_nothing(place: Path, arguments: tuple[str, ...], words: str) -> None:
    given = [str(place / word) if word.endswith(".toml") else word for word in arguments]
    done = compare(place, "bad", *given)
    assert done.exit_code == 2
    assert words in done.one_line()
    assert not (place / "bad").exists()


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_training_and_design_seeds_are_said_when_they_are_allowed(place: Path) -> None:
    arguments = ("--laws", "ipfc,twin", "--parameters", str(place / "tuned.toml"), "--perturbed", "--seed", "1")
    done = compare(place, "trained", *arguments, "--allow-training-seeds")
    assert done.exit_code in (0, 1), done.err
    tuned = load_parameters(place / "tuned.toml").controller
    runs = json.loads((place / "trained" / "compare.json").read_text(encoding="utf-8"))["runs"]
    assert [run["label"] for run in runs] == [f"{tuned} tuned (on this seed)", "twin (on this seed)"]
    assert [run["seed_was_trained"] for run in runs] == [True, True]
    page = (place / "trained" / "report.html").read_text(encoding="utf-8")
    for law, how in (("ipfc", "tuned"), ("twin", "designed")):
        sentence = f"NOT AN EVALUATION: the parameters of {law} were {how} on this very run, seed 1"
        assert sentence in done.out.splitlines()
        assert f"<strong>{sentence}.</strong>" in page
    assert 'class="first best"' not in page


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_a_run_says_that_its_seed_was_one_of_training(place: Path, compared: Compared, tmp_path: Path) -> None:
    arguments = ("--parameters", place / "tuned.toml", "--perturbed", "--seed", "1", "--no-report", "--bus", "local")
    done = railhil("run", place / "short.toml", *arguments, "--out", tmp_path / "run")
    assert done.exit_code in (0, 1), done.err
    sentence = "NOT AN EVALUATION: the parameters of ipfc were tuned on this very run, seed 1"
    assert sentence in done.out.splitlines()
    for folder, trained in ((tmp_path / "run", True), (compared.folder / "twin", False)):
        assert json.loads((folder / "score.json").read_text())["run"]["seed_was_trained"] is trained
    (tmp_path / "run" / "score.json").write_text('{"telemetry": {"source": 1}, "run": 3}')
    damaged = railhil("report", tmp_path / "run")
    assert damaged.exit_code == 2
    assert "score.json: " in damaged.one_line()


@pytest.mark.slow
@pytest.mark.loop
def test_report_of_runs_that_do_not_belong_together(compared: Compared, place: Path, tmp_path: Path) -> None:
    (place / "other.toml").write_text(QUICK_TOML.replace("benchmark_quick", "another"))
    done = railhil("run", place / "other.toml", "--bus", "local", "--no-report", "--out", tmp_path / "other")
    assert done.exit_code in (0, 1), done.err
    assert "report.html" not in done.out
    assert not (tmp_path / "other" / "report.html").exists()
    done = railhil("report", compared.folder / "ipfc", tmp_path / "other", cwd=tmp_path)
    assert done.exit_code == 2
    assert "scenario: found 'another', allowed benchmark_quick" in done.one_line()
    assert not (tmp_path / "report.html").exists()
    done = railhil("report", tmp_path / "other", "--out", tmp_path / "no" / "x.html")
    assert "no such file or directory" in done.one_line()
    assert railhil("report", tmp_path / "other").exit_code == 0
    assert (tmp_path / "other" / "report.html").is_file()
    (tmp_path / "compare.json").write_text("[]")
    assert "compare.json: has no JSON object" in railhil("report", tmp_path).one_line()


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_without_the_libraries_the_run_is_whole(place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lacking = 'raise ModuleNotFoundError("No module named \'jinja2\'", name="jinja2")\n'
    (tmp_path / "lacking").mkdir()
    (tmp_path / "lacking" / "jinja2.py").write_text(lacking)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "lacking"))
    done = railhil("run", place / "short.toml", "--bus", "local", "--out", tmp_path / "run", anew=True)
    assert done.exit_code in (0, 1), done.err
    assert "no report: jinja2 is not installed; install it with " in done.out
    assert (tmp_path / "run" / "certificate.json").is_file()
    done = railhil("report", tmp_path / "run", anew=True)
    assert done.exit_code == 2
    assert "jinja2 is not installed; install it with " in done.one_line()


@pytest.mark.slow
@pytest.mark.loop
def test_json_of_a_comparison_is_its_file(place: Path) -> None:
    folder = place / "as_json"
    words = ("--laws", "ipfc", "--bus", "local", "--no-report", "--json")
    done = railhil("compare", place / "short.toml", *words, "--out", folder)
    assert done.exit_code in (0, 1), done.err
    assert done.json == json.loads((folder / "compare.json").read_text(encoding="utf-8"))
