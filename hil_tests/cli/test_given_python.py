"""The way of a controller in Python from an empty folder; tests, faults and sentences about it; where it cannot be."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.cli import railhil as command
from hil_tests.support.short_runs import RUN_2M_TOML
from hil_tests.support.user_suite import run_suite
from railhil.library import NeverBegan
from railhil.testing import Bench
from railhil.testing.settings import Settings

ROOT = Path(__file__).parents[2]
CODE = """
def step(reading):
    return 3.6 * (reading.set_point_mps - reading.speed_mps)
"""
TEXT = "mine.py:step"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "mine.py").write_text(CODE, encoding="utf-8")
    (tmp_path / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
@pytest.mark.long_after(1)
@pytest.mark.parametrize("bus", ["local", ""])
def test_the_how_to_of_the_page_works_from_an_empty_folder(tmp_path: Path, bus: str) -> None:
    page = (ROOT / "docs/howto/controllers.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"## In Python\n\n```sh[^\n]*\n(.*?)```", page, re.DOTALL)
    lines = block.splitlines()
    assert len(lines) <= 15
    for line in lines:
        program, *rest = line.split()
        if program == "pytest":
            assert run_suite(tmp_path, *rest).ret == 0, line
            continue
        options = ["--no-report", *(["--bus", bus] if bus else [])] if rest[0] in ("run", "compare") else []
        done = command(*rest, *options, cwd=tmp_path)
        assert done.exit_code == 0, done.err


def test_a_new_one_for_any_system_lists_its_readings_and_runs(tmp_path: Path) -> None:
    words = ("new", "c-controller", "halts", "--python", "--scenario", "yizhuang_stop")
    assert command(*words, cwd=tmp_path).exit_code == 0
    text = (tmp_path / "halts/halts.py").read_text(encoding="utf-8")
    assert re.search(r"^ +odometer +mm$", text, re.MULTILINE)
    assert command(*words, cwd=tmp_path).exit_code == 2
    assert run_suite(tmp_path, "halts").ret == 0


@pytest.fixture
def bench(folder: Path) -> Bench:
    return Bench(Settings(), {"scenario": "short.toml", "controller": proportional}, folder, folder / "runs", "given")


def proportional(reading: Any) -> float:
    return 3.6 * float(reading.set_point_mps - reading.speed_mps)


def test_a_function_is_run_in_a_test_at_once_and_by_its_clock(bench: Bench, folder: Path) -> None:
    whole = bench.run()
    assert whole.certificate["controller"] == "test_given_python-proportional"
    with bench.start() as live:
        live.finish()
    assert live.result is not None
    assert live.result.frames_sha256 == whole.frames_sha256
    by_file = bench.run(controller=f"{folder / 'mine.py'}:step")
    assert by_file.outcome.score.values == whole.outcome.score.values


def test_its_failure_in_a_test_is_the_line_of_the_controller(bench: Bench) -> None:
    live = bench.start(controller=lambda reading: float("nan"))
    with live:
        run = live.finish()
    assert (run.verdict, "found nan" in run.outcome.line) == ("INVALID", True)
    with pytest.raises(NeverBegan, match=r"notch: found nan"):
        bench.run(controller=lambda reading: float("nan"))


def test_where_parameters_are_named_its_code_is(folder: Path) -> None:
    words = ("short.toml", "--bus", "local", "--no-report")
    done = command("run", *words, "--controller", TEXT, cwd=folder)
    assert "parameters: in the code of mine-step" in done.out
    assert "--controller ipfc_plus" not in done.out
    (run,) = (path for path in (folder / "runs").iterdir() if path.is_dir() and not path.is_symlink())
    assert command("replay", run, "--node", "plant", cwd=folder).exit_code == 0, "the plant needs no law"
    done = command("compare", *words, "--laws", f"ipfc,{TEXT}", cwd=folder)
    assert "mine-step: in the code of mine-step" in done.out


def test_a_fault_that_needs_a_law_is_made_with_that_law(folder: Path) -> None:
    done = command("faults", "--controller", TEXT, "--only", "T2a,T4", "--bus", "local", "--out", "table", cwd=folder)
    assert done.exit_code in (0, 1), done.err
    certificates = [path.read_text(encoding="utf-8") for path in sorted((folder / "table").glob("*/certificate.json"))]
    assert [("given_controller" in text) for text in certificates].count(True) == 1, certificates


@pytest.mark.parametrize(
    "words",
    [
        ("audit", "--controller", TEXT),
        ("tune", TEXT),
        ("learn", "--controller", TEXT),
        ("sequence", "run", "--controller", TEXT),
        ("watch", "--controller", TEXT),
        ("panel", "--controller", TEXT),
        ("export-c", TEXT, "--out", "made"),
        ("run", "--spec", "spec.toml"),
        ("run", "--controller", "mine.py:step", "--arithmetic", "iq"),
    ],
    ids=" ".join,
)
def test_where_it_cannot_be_is_one_line(folder: Path, words: tuple[str, ...]) -> None:
    (folder / "spec.toml").write_text(f'controller = "{TEXT}"\n', encoding="utf-8")
    done = command(*words, cwd=folder)
    assert (done.exit_code, TEXT in done.one_line()) == (2, True)
    assert not (folder / "runs").exists()


def test_the_environment_loads_no_code(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAILHIL_CONTROLLER", TEXT)
    done = command("run", "short.toml", "--bus", "local", cwd=folder)
    assert (done.exit_code, "RAILHIL_CONTROLLER" in done.one_line()) == (2, True)
