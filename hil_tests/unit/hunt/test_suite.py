"""The suite of planted defects: patches that fit, a copy that has the defect, a table of who found it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint
from railhil.common.errors import InputError
from railhil.common.held_code import place_of
from railhil.hunt.defects import RUNS, Defect, defects, plant, write_suite

pytest.importorskip("pyarrow", reason="MISSING CAPABILITY pyarrow (extra campaign)")

from railhil.hunt.leaderboard import leaderboard

#: Makes the folder of an entry.
Enter = Callable[..., Path]


@pytest.fixture
def enter(tmp_path: Path) -> Enter:
    def make(tool: str = "mine", defect: str = "m02", seed: int = 1, runs: int = 50, **others: str) -> Path:
        folder = tmp_path / f"{tool}-{defect}-{seed}-{runs}"
        folder.mkdir()
        lines = [f'tool = "{tool}"', f'defect = "{defect}"', f"seed = {seed}", f"runs = {runs}"]
        (folder / "entry.toml").write_text("\n".join([*lines, *(f'{key} = "{text}"' for key, text in others.items())]))
        return folder

    return make


def planted(place: Path, *words: str) -> str:
    """Standard output of a program of the copy."""
    environment = {**os.environ, "PYTHONPATH": str(place)}
    done = subprocess.run(
        [sys.executable, "-P", *words], env=environment, cwd=place, capture_output=True, text=True, timeout=600
    )
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


@pytest.mark.parametrize("defect", defects().values(), ids=lambda defect: defect.id)
def test_a_patch_takes_the_lines_out_and_puts_the_defect_in(defect: Defect) -> None:
    changed = [line for line in defect.patch.splitlines()[2:] if line[0] in "+-"]
    find, put = defect.find.splitlines(), defect.put.splitlines()
    kept = [line for line in find if line in put]
    assert changed == [*(f"-{line}" for line in find if line not in kept),
                       *(f"+{line}" for line in put if line not in kept)]  # fmt: skip
    assert defect.planted != place_of(defect.file).read_text("utf-8")
    assert len({one.code_sha256 for one in defects().values()}) == len(defects())


def test_a_defect_that_does_not_fit_is_told(tmp_path: Path) -> None:
    wrong = Defect("m99", "", next(iter(defects().values())).file, "no such text", "")
    with pytest.raises(InputError, match="0 times its text, expected once"):
        _ = wrong.planted
    with pytest.raises(InputError, match="--plant: found 'm99', allowed m02, m07, m09"):
        plant("m99", tmp_path)


def test_the_suite_is_written_into_a_folder_of_its_own(here: Railhil, tmp_path: Path) -> None:
    done = here("bench-suite", "suite", "--json")
    assert (done.exit_code, done.json["planted"]) == (0, None)
    document = json.loads((tmp_path / "suite/suite.json").read_text())
    assert [one["id"] for one in document["defects"]] == list(defects())
    assert all((tmp_path / "suite" / name).is_file() for name in done.json["files"])
    assert here("bench-suite", "suite").exit_code == 0
    (tmp_path / "other").mkdir()
    (tmp_path / "other/mine.txt").touch()
    assert "found 'other', allowed a new or empty folder" in complaint(here("bench-suite", "other"))
    assert "DIR: none, expected" in complaint(here("bench-suite"))
    (tmp_path / "file").touch()
    assert "file" in complaint(here("bench-suite", "file"))
    assert "without DIR" in complaint(here("bench-suite", "suite", "--score", "other"))


def test_who_finds_more_stands_first_and_what_was_not_found_costs_the_budget(enter: Enter, here: Railhil) -> None:
    folders = [enter("b"), enter("a", "m07", 2), enter("a", "m07", 3)]
    rows = leaderboard(folders)
    assert [(row["tool"], row["found"], row["of"], row["entries"]) for row in rows] == [
        ("a", 0, 15, 2),
        ("b", 0, 15, 1),
    ]
    assert {row["mean_runs"] for row in rows} == {RUNS}
    done = here("bench-suite", "--score", *map(str, folders))
    assert "0 of 15" in done.out
    assert here("bench-suite", "--json", "--score", str(folders[0])).json["rows"][0]["tool"] == "b"


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"defect": "m99"}, "defect: found 'm99', allowed m02, m07, m09"),
        ({"seed": 9}, "seed: found 9, allowed 1, 2, 3, 4, 5"),
        ({"runs": 0}, "runs"),
        ({"rum": "run"}, "did you mean run"),
        ({"run": "run"}, "run"),
    ],
)
def test_a_wrong_entry_is_refused(enter: Enter, entry: dict[str, str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        leaderboard([enter(**entry)])


def test_a_folder_that_is_no_entry_and_a_second_entry_are_refused(enter: Enter, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"neither hunt.json nor entry.toml"):
        leaderboard([tmp_path])
    with pytest.raises(InputError, match="one entry of each tool"):
        leaderboard([enter(runs=10), enter(runs=20)])


@pytest.mark.long
def test_a_planted_defect_is_found_by_a_hunt_and_counts_only_with_its_code(
    here: Railhil, enter: Enter, tmp_path: Path
) -> None:
    suite = tmp_path / "suite"
    write_suite(suite)
    place = plant("m02", suite)
    asked = "import railhil.study.plan as plan; print(plan.bench_sha256())"
    assert planted(place, "-c", asked).strip() == defects()["m02"].code_sha256
    words = (str(suite / "journey.toml"), "--controller", "ipfc_plus")
    search = ("--requirements", "ato", "--only", "INV-4", "--runs", "8", "--seed", "1", "--no-shrink", "--jobs", "1")
    planted(place, "-m", "railhil.hunt", *words, *search, "--out", str(tmp_path / "hunt"))
    (row,) = leaderboard([tmp_path / "hunt"])
    assert (row["tool"], row["found"], row["runs"]["m02"][0]) == ("railhil hunt, auto", 1, 7)
    # The same run as the entry of another program.
    case = json.loads((tmp_path / "hunt/cases.jsonl").read_text().splitlines()[6])
    faults = [word for fault in case["faults"] for word in ("--fault", fault)]
    run = ("run", *words, *faults, "--seed", str(case["seed"]), "--no-report", "--out")
    folder = enter(runs=7, run="run")
    planted(place, "-m", "railhil.cli", *run, str(folder / "run"))
    (row,) = leaderboard([folder])
    assert (row["tool"], row["found"], row["runs"]["m02"][0]) == ("mine", 1, 7)
    # Without the defect nothing is shown, and the code is another one.
    other = enter(runs=8, run="run")
    assert here(*run, str(other / "run")).exit_code == 1
    with pytest.raises(InputError, match="with a defect planted"):
        leaderboard([other])
