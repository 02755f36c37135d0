"""Faults in runs of separate processes: the same bytes as in one process, and signals that no process can refuse."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.cli import Railhil, complaint, railhil
from hil_tests.support.hub import running_hub
from hil_tests.support.short_runs import RUN_2M_TOML, RUN_72M_TOML

pytestmark = [pytest.mark.loop, pytest.mark.faults]

_TABLES = """
[[fault]]
where = "TRN_SPEED"
what = "loss"
when = "3 s"
for = "2 s"
with = { share = "30%", enter = "10%", leave = "40%" }
id = "T2"
"""
_GIVEN = (
    "NOTCH_CMD delay 60ms jitter 20ms @6s for 1s",
    "TRN_POS corrupt 50% bits uniform(1,3) @8s x5",
    "CTL_STAT truncate 3 @v>10km/h x2",
    "bus off @12s for 100ms",
    "controller stop @14s for 200ms",
    "controller kill @18s",
)


def documents(folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Certificate and score of a run folder."""
    read = [json.loads((folder / name).read_text(encoding="utf-8")) for name in ("certificate.json", "score.json")]
    return read[0], read[1]


@pytest.mark.long
@pytest.mark.slow
def test_over_the_hub_a_run_with_faults_has_the_bytes_of_the_one_in_process(tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(RUN_72M_TOML.replace("[target]", _TABLES + "[target]"), encoding="utf-8")
    given = [word for text in _GIVEN for word in ("--fault", text)]
    certificates = []
    for bus in ("local", "auto"):
        folder = tmp_path / bus
        done = railhil("run", path, "--bus", bus, "--out", folder, "--quiet", "--no-report", "--seed", "3", *given)
        assert done.exit_code in (1, 3), done.err
        assert "fault 1: TRN_SPEED loss gemodel" in done.out or "fault 1: TRN_SPEED loss 30%" in done.out
        certificates.append(documents(folder)[0])
        assert not [line for line in done.out.splitlines() if "never began" in line or "changed nothing" in line]
    first, second = certificates
    assert first["frames_sha256"] == second["frames_sha256"]
    assert first["line"] == second["line"]
    assert first["injected"] == second["injected"]
    assert len(first["injected"]) == 7
    assert all(one["hits"] for one in first["injected"])
    assert (tmp_path / "local" / "faults.csv").read_bytes() == (tmp_path / "auto" / "faults.csv").read_bytes()
    # The certificate makes the run again, as does its command.
    spec = tmp_path / "auto" / "certificate.json"
    railhil("run", "--spec", spec, "--bus", "local", "--out", tmp_path / "again", "--quiet", "--no-report")
    assert documents(tmp_path / "again")[0]["frames_sha256"] == first["frames_sha256"]
    assert first["faults"] == list(_GIVEN)
    assert "'NOTCH_CMD delay 60ms jitter 20ms @6s for 1s'" in second["command"]


def test_a_fault_that_never_began_makes_the_run_invalid(here: Railhil, tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    words = ["run", path, "--bus", "local", "--out", tmp_path / "run", "--quiet", "--no-report"]
    done = here(*words, "--fault", "TRN_SPEED loss @v>100km/h")
    assert done.exit_code == 3
    assert "INVALID: fault 1 never began: TRN_SPEED loss @v>100km/h" in done.out
    certificate, score = documents(tmp_path / "run")
    assert certificate["verdict"] == "INVALID"
    assert score["faults"][0]["begun_s"] is None


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--fault", "TRN_SPEED los 30% @1s"), "(did you mean loss?)"),
        (("--fault", "TRN_SPED loss @1s"), "(did you mean TRN_SPEED?)"),
        (("--fault", "wall pause 1s @1s"), "lockstep has no wall clock"),
        (("--fault", "TRN_SPEED loss @1s", "--fault", "TRN_SPEED delay 1s @2s"), "one fault at a time on a target"),
        (("--fault", "TRN_SPEED loss @1s unit 2"), "found 'unit 2', allowed units 1 to 1"),
    ],
)
def test_a_bad_fault_is_refused_in_one_line(here: Railhil, tmp_path: Path, words: tuple[str, ...], said: str) -> None:
    done = here("run", "--bus", "local", "--out", tmp_path / "run", "--quiet", "--no-report", *words)
    assert said in complaint(done)
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
def test_a_bad_table_names_its_file(here: Railhil, tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    for bad, said in (
        ('where = "TRN_SPEED"\nwhat = "los"\nwhen = "3 s"', "fault[0]: found 'los'"),
        ('where = "TRN_SPEED"\nwhat = "loss"\nwen = "3 s"', "fault[0].wen: unknown key"),
        ('where = "TRN_SPEED"\nwhat = "loss"', "fault[0].when"),
        ('where = "TRN_SPEED"\nwhat = "loss"\nwhen = "3 m/s"', "found '3 m/s', allowed 60s, 1200m"),
    ):
        path.write_text(f"{RUN_2M_TOML}\n[[fault]]\n{bad}\n", encoding="utf-8")
        line = complaint(here("scenarios", path))
        assert said in line, line
        assert str(path) in line


def test_the_words_are_listed(here: Railhil) -> None:
    done = here("faults", "--list")
    assert done.exit_code == 0
    assert "  loss: telegrams are lost" in done.out
    words = here("faults", "--list", "--json").json["words"]
    assert {"telegram", "node", "bus", "sensor"} <= {word["level"] for word in words}


@pytest.mark.long
@pytest.mark.slow
def test_error_counters_and_lines_of_the_bus_are_disturbed_on_a_hub_of_the_run(tmp_path: Path) -> None:
    """B1, B2 and B7 of the catalogue: both watches stay at NORMAL, and the run is the same bytes each time."""
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    given = ("bus error_frames 5% @1s for 1s", "bus passive @2200ms for 300ms combine", "bus.a open @2600ms for 300ms")
    words = ["run", path, "--bus", "auto", "--quiet", "--no-report"]
    words += [word for text in given for word in ("--fault", text)]
    for name in ("once", "again"):
        done = railhil(*words, "--out", tmp_path / name)
        assert done.exit_code in (0, 1), done.err
    first, score = documents(tmp_path / "once")
    assert first["frames_sha256"] == documents(tmp_path / "again")[0]["frames_sha256"]
    hits = [one["hits"] for one in score["faults"]]
    assert hits[0] > 5
    assert hits[1:] == [1, 1]
    with (tmp_path / "once" / "events.csv").open(encoding="utf-8") as stream:
        events = list(csv.DictReader(stream))
    assert [one for one in events if one["level"] and float(one["time_s"]) > 0.9] == []
    counted = [one for one in events if one["cause"] == "error_frame"]
    assert sum(int(one["count"]) for one in counted) == hits[0], "all of them are in the record"
    said = (tmp_path / "once" / "controller.txt").read_text(encoding="utf-8")
    assert "warning: error-passive (TEC 128, REC 0)" in said
    assert "error_passive 1, switch_overs 1" in said


@pytest.mark.slow
def test_a_hub_that_takes_no_orders_is_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    with running_hub() as hub:
        words = ("run", path, "-i", "railhil", "-c", hub.channel, "--out", tmp_path / "run", "--quiet", "--no-report")
        done = railhil(*words, "--fault", "bus passive @1s")
    assert done.exit_code == 2
    assert "takes no orders to disturb it, it must be a hub started with --faults" in done.err
