"""``railhil rerun``: the same bytes in one line, else the first frame that differs, decoded."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint
from hil_tests.support.recordings import certified, rewritten, tampered
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil import library
from railhil.bus.ident import CtlIdent
from railhil.wire.ato import NotchCmd


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folder of 2 m, with the scenario's file beside it."""
    folder = tmp_path_factory.mktemp("short")
    (folder / "short.toml").write_text(RUN_2M_TOML)
    return library.run(folder / "short.toml", seed=3, out=folder / "run").folder


@pytest.fixture
def copy(short: Path, tmp_path: Path) -> Path:
    """A copy of that folder that a test may change."""
    return shutil.copytree(short, tmp_path / "copy")


@pytest.mark.slow
def test_the_same_bytes_are_one_line(here: Railhil, short: Path) -> None:
    by_folder, by_certificate = here("rerun", short), here("rerun", short / "certificate.json")
    sha256 = json.loads((short / "certificate.json").read_text())["frames_sha256"]
    assert by_folder.exit_code == by_certificate.exit_code == 0
    (line,) = by_folder.out.splitlines()
    assert line.startswith(f"same bytes: frames.log sha256 {sha256} (")
    assert "seed 3" in line


@pytest.mark.slow
def test_frames_of_others_are_no_difference(here: Railhil, copy: Path) -> None:
    """As on a shared bus: a record with them, and one of the same telegrams without."""
    log = (copy / "frames.log").read_text().splitlines(keepends=True)
    rewritten(copy, [*log[:90], "(0.020000) mvb0 00000118#1122 R\n", *log[90:]])
    certified(copy, other_frames=1)
    done = here("rerun", copy)
    assert done.exit_code == 0
    assert done.out.startswith("same telegrams, beside 1 recorded frames of others and 0 now: sha256 ")
    certified(copy, telegrams_sha256="0" * 64)
    assert here("rerun", copy).exit_code == 1


def test_the_repeated_run_is_kept_where_it_is_asked_for(here: Railhil, short: Path, tmp_path: Path) -> None:
    done = here("rerun", short, "--out", tmp_path / "again", "--json")
    assert done.json["same"]
    assert done.json["folder"] == str(tmp_path / "again")
    assert (tmp_path / "again/frames.log").read_bytes() == (short / "frames.log").read_bytes()


def test_the_first_other_frame_is_decoded(here: Railhil, copy: Path) -> None:
    line = tampered(copy, NotchCmd.port().address, 40, 0)
    done = here("rerun", copy, "--json")
    assert done.exit_code == 1
    found = done.json["difference"]
    assert (found["line"], found["frame"]) == (line, "NOTCH_CMD (controller)")
    (change,) = found["signals"]
    assert change["name"] == "NotchCmd"
    assert abs(float(change["recorded"].split()[0]) - float(change["repeated"].split()[0])) == 1
    folder = Path(done.json["folder"])
    assert (folder / "certificate.json").is_file()
    shutil.rmtree(folder)


@pytest.mark.slow
def test_a_trailer_and_a_longer_record_are_named(here: Railhil, copy: Path) -> None:
    line = tampered(copy, CtlIdent.port().address + 4, 1, 0)
    done = here("rerun", copy)
    shown = next(text for text in done.out.splitlines() if text.startswith("first difference"))
    assert f"line {line}, 0 s, CTL_IDENT trailer (controller): check sequences" in shown
    log = (copy / "frames.log").read_text().splitlines(keepends=True)
    rewritten(copy, log[: line - 1])
    assert f"line {line}, 0 s: the record has ended, now CTL_IDENT trailer" in here("rerun", copy).out


@pytest.mark.slow
def test_another_version_and_a_changed_scenario_are_said_first(here: Railhil, copy: Path, tmp_path: Path) -> None:
    changed = tmp_path / "short.toml"
    changed.write_text(RUN_2M_TOML.replace("overtime_max_s = 1", "overtime_max_s = 2"))
    certified(copy, railhil="0.0.9", code_sha256="0" * 64, scenario=str(changed))
    done = here("rerun", copy)
    notes, said = done.out.splitlines()[:-1], done.out.splitlines()[-1]
    assert [note.split(" ")[0] for note in notes] == ["note:"] * 3
    assert notes[0].startswith("note: the record was made by railhil 0.0.9, this is ")
    assert "the code of the bench has changed" in notes[1]
    assert "short.toml has changed since the record: scenario.json beside the certificate is used" in notes[2]
    assert (done.exit_code, said.split(":")[0]) == (0, "same bytes")
    changed.unlink()
    assert "scenario.json is used" in here("rerun", copy).out
    (copy / "scenario.json").unlink()
    assert "scenario.json: sha256: no such file" in complaint(here("rerun", copy))
    alone = shutil.copy(copy / "certificate.json", tmp_path / "alone.json")
    assert "short.toml" in complaint(here("rerun", alone))


def test_without_the_log_only_the_hash_is_compared(here: Railhil, copy: Path, tmp_path: Path) -> None:
    alone = tmp_path / "alone.json"
    alone.write_bytes((copy / "certificate.json").read_bytes())
    assert here("rerun", alone).exit_code == 0
    alone.write_text(json.dumps(json.loads(alone.read_text()) | {"seed": 4}))
    done = here("rerun", alone)
    assert done.exit_code == 1
    assert "no frames.log beside" in done.out


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ({"pace": "realtime"}, "pace: found 'realtime', allowed lockstep"),
        ({"foreign": True}, "foreign: a controller of somebody else"),
        ({"frames_sha256": ""}, "frames_sha256: missing"),
        ({"frames_sha256": "0" * 64}, "a log that nobody changed"),
        ({"seed": -1}, "seed: found -1"),
    ],
)
def test_what_cannot_be_repeated_is_refused(here: Railhil, copy: Path, keys: dict[str, object], line: str) -> None:
    certified(copy, **keys)
    # The record says that it was in lockstep; a certificate can be sent alone.
    given = shutil.copy(copy / "certificate.json", copy.parent / "alone.json") if "pace" in keys else copy
    assert line in complaint(here("rerun", given))


def test_another_controller_than_the_recorded_one_is_refused_and_the_command_for_it_named(
    here: Railhil, short: Path
) -> None:
    said = complaint(here("rerun", short, "--controller", "tdmc"))
    assert "--controller: found 'tdmc', allowed ipfc, the controller of the record" in said
    command = said[said.index("railhil run --spec") :].split(" runs ")[0].split()
    assert command[-2:] == ["--controller", "tdmc"]
    assert Path(command[3]) == short / "certificate.json"


@pytest.mark.slow
def test_the_recorded_controller_may_be_named(here: Railhil, short: Path) -> None:
    assert here("rerun", short, "--controller", "ipfc").out.startswith("same bytes")


def test_a_bus_is_asked_for_by_its_options(here: Railhil, short: Path, tmp_path: Path) -> None:
    said = complaint(here("rerun", short, "--bus", "local", "-i", "socketcan"))
    assert "--bus local" in said
    assert "-i socketcan" in said
    assert "virtual" in complaint(here("rerun", short, "-i", "virtual"))
    assert "does not exist" in complaint(here("rerun", tmp_path / "nothing"))


TWO_STOPS_TOML = """
extends = "four_stops"
system = "line"
name = "two_stops"
title = "Two stops, 100 m"

[line]
grade_permil = [[-118, 0]]
speed_limit_kmh = [[-118, 60]]

[route]
running_time_reserve_percent = 6
hold = { probability = 0, extra_s = [0, 0] }
stops = [
    { name = "A", position_m = 0, platform = "left", depart_s = 3 },
    { name = "B", position_m = 100, platform = "left", service = "terminal" },
]
"""


@pytest.mark.slow
def test_a_run_with_faults_at_planned_instants_is_scored_and_repeated(here: Railhil, tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(TWO_STOPS_TOML)
    faults = ["TRN_SPEED loss 20% @section 1 5s for 2s", "dwell hold 5s @stop 2"]
    run = library.run(tmp_path / "two.toml", faults=faults, out=tmp_path / "run").folder
    assert here("score", run).exit_code in (0, 1)
    assert here("rerun", run).exit_code == 0
