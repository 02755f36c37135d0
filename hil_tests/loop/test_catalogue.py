"""Every entry of the fault catalogue on a short journey: what detects it, and the reaction within its bound."""

from __future__ import annotations

import re
import signal
from pathlib import Path

import psutil
import pytest

from hil_tests.support.cli import Started, railhil, wait_for
from hil_tests.support.short_runs import RUN_297M_TOML
from railhil.cli.commands import parser
from railhil.cli.faults import entry_run, needs_hub
from railhil.cli.run import run_spec
from railhil.judge.reactions.catalogue import Entry, catalogue
from railhil.run.spec import with_requirements

pytestmark = [pytest.mark.faults, pytest.mark.slow]

#: Entries that need a hub with controllers and lines, or another process; and real time, as long as the run.
ON_A_HUB, IN_REAL_TIME = {"B1", "B2", "B7", "N5"}, {"K2"}
#: Entries that need a longer journey.
FARTHER = {"S3d"}
#: Entries whose kind of fault another entry has, or another test of this module; they are long.
LONG = {
    *("T1", "T1b", "T2a", "T2b", "T4", "T5a", "T5", "T5c", "T6", "T9", "T9b", "T11b", "T12", "T16b", "T18"),
    *("S1a", "S1c", "S1e", "S1g", "S1h", "S2b", "S3c", "S3d", "S4a", "S5b", "S5c"),
    *("B2", "B3", "B6", "B7", "N2", "C1a", "C3a", "C5"),
}
SHIPPED = "yizhuang_05"
#: A short journey of one fault pair.
PAIRS = Path(__file__).parents[1] / "data" / "pairs.toml"


@pytest.fixture(scope="module")
def journey(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_297M_TOML, encoding="utf-8")
    return str(path)


HERE = [
    pytest.param(entry, id=entry.id, marks=[pytest.mark.long] if entry.id in LONG else [])
    for entry in catalogue()
    if entry.faults and entry.id not in IN_REAL_TIME
]


@pytest.mark.parametrize("entry", HERE)
def test_the_bench_reacts_as_the_catalogue_says(entry: Entry, journey: str, tmp_path: Path) -> None:
    given = parser(["faults"]).parse_args(["faults", SHIPPED if entry.id in FARTHER else journey])
    base = run_spec(given, "ipfc", None)
    assert needs_hub(base, entry) is (entry.id in ON_A_HUB)
    row = entry_run(base, tmp_path, False, entry)
    assert row.refused == ""
    assert row.failures == []
    assert row.made
    assert not list(tmp_path.glob("*/frames.blf")), "nobody keeps this folder"


@pytest.mark.long
@pytest.mark.parametrize("law", ["ipfc", "ipfc_plus"])
@pytest.mark.parametrize("name", ["T5c", "B6", "S2b"])
def test_an_entry_holds_on_a_long_journey_with_both_laws_and_the_sentences(name: str, law: str, tmp_path: Path) -> None:
    """Late speeds put the controller's clock behind: that must not cost the position, nor make the ramp steeper."""
    given = parser(["faults"]).parse_args(["faults", "lvshun_tieshan"])
    (entry,) = (one for one in catalogue() if one.id == name)
    row = entry_run(with_requirements(run_spec(given, law, None), "ato"), tmp_path, False, entry)
    assert row.made
    assert row.failures == []
    assert "violated" not in row.requirements.values()


def test_the_table_is_printed_and_kept(journey: str, tmp_path: Path) -> None:
    """One entry demands less than the strongest level, one has no run here."""
    done = railhil("faults", journey, "--only", "T2a,T15,C3a", "--jobs", "2", "--out", tmp_path / "runs", "--quiet")
    assert done.exit_code == 0, done.err
    assert "speed_age" in done.out
    assert "2 runs, 0 not as they must be" in done.out
    assert "1 entry without a run here: T15" in done.out
    assert {"frames.log", "frames.blf", "certificate.json"} <= {
        path.name for path in (tmp_path / "runs" / "T2a").iterdir()
    }
    page = (tmp_path / "runs" / "report.html").read_text(encoding="utf-8")
    assert 'class="badge PASS"' in page
    assert 'href="T2a"' in page
    # Any table is written again, alone or beside others.
    kept = str(tmp_path / "runs")
    assert railhil("report", kept, kept, "--out", tmp_path / "both.html").exit_code == 0
    assert 'id="beside-ato"' in (tmp_path / "both.html").read_text(encoding="utf-8")
    # The time is that of the level which is demanded, not of the strongest one. The cell is broken over lines, as the
    # width of the terminal has it.
    assert {"(up", "EMERGENCY)"} <= set(done.out.split())
    (first,) = railhil("faults", journey, "--only", "T2a", "--json").json
    assert first["reaction"] == "HOLD"
    assert 0 <= first["after_ms"] <= first["within_ms"] == 40


def test_nothing_is_known_without_a_run(tmp_path: Path) -> None:
    """Its trigger does not occur: the table has no run, and there is no folder of one."""
    done = railhil("faults", "hst", "--only", "H9b", "--quiet", "--out", tmp_path / "kept")
    assert done.exit_code == 3
    assert "0 runs, 0 not as they must be" in done.out
    assert "1 entry without a run here: H9b" in done.out
    assert [path.name for path in (tmp_path / "kept").iterdir() if path.is_dir()] == []


@pytest.mark.long
def test_most_random_pairs_have_a_verdict(tmp_path: Path) -> None:
    words = ("--pairs", "2", "--seed", "1", "--jobs", "2", "--json", "--out", tmp_path / "kept")
    done = railhil("faults", PAIRS, *words)
    assert done.exit_code == 0, done.err
    assert done.json["broken"] == []
    verdicts = done.json["verdicts"]
    assert sum(verdicts.values()) == 2
    assert verdicts["PASS"] + verdicts["FAIL"] >= 1
    page = (tmp_path / "kept" / "report.html").read_text(encoding="utf-8")
    assert "2 random pairs of faults" in page
    assert railhil("verify", tmp_path / "kept").exit_code == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--pairs", "2", "--only", "T2"], "--only: cannot be given with --pairs"),
        (["--pairs", "2", "--out", "a_file"], "--out: found 'a_file', allowed an empty or new folder"),
        (["--only", "T2", "--out", "a_file"], "--out: found 'a_file', allowed a folder"),
    ],
)
def test_options_that_would_be_ignored_are_refused(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a_file").touch()
    done = railhil("faults", PAIRS, *words)
    assert done.exit_code == 2
    assert said in done.one_line()


@pytest.mark.long_after(1)
@pytest.mark.parametrize("words", [["--pairs", "2000", "--seed", "1"], []], ids=["pairs", "catalogue"])
def test_a_stopped_command_ends_its_processes_and_says_how_far_it_came(words: list[str]) -> None:
    started = Started("faults", PAIRS, "--jobs", "2", *words)
    command = psutil.Process(started.process.pid)
    workers = wait_for(lambda: len(command.children()) == 2 and command.children())
    started.process.send_signal(signal.SIGTERM)
    done, _ = started.finish()
    assert done.exit_code == 128 + signal.SIGTERM, done.err
    assert re.search(r"^stopped by SIGTERM after \d+ of \d+ (pairs|entries)", done.out, re.MULTILINE)
    assert not any(worker.is_running() for worker in workers)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--only", "Q9"], "--only: found 'Q9'"),
        (["--pairs", "0"], "argument --pairs"),
        (["--controller", "nobody"], "--controller: found 'nobody'"),
    ],
)
def test_what_is_not_in_the_catalogue_is_refused(words: list[str], said: str) -> None:
    done = railhil("faults", SHIPPED, *words)
    assert done.exit_code == 2
    assert said in done.err


@pytest.mark.long
def test_an_entry_that_needs_a_hub_has_one(journey: str) -> None:
    """And nothing else is run beside it."""
    done = railhil("faults", journey, "--only", "B7", "--quiet")
    assert done.exit_code == 0, done.out
    assert "1 run, 0 not as they must be" in done.out
    assert "without a run" not in done.out
