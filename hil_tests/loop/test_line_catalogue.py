"""The fault catalogue of a line with stations, on a short line: signs and reactions within their bounds, same bytes."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.cli.commands import parser
from railhil.cli.faults import entry_run
from railhil.cli.run import run_spec
from railhil.judge.reactions.catalogue import Entry, catalogue_of, faults_by_hand
from railhil.run.local import local_run
from railhil.scenarios.fault_list import fault_texts
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named

LINE = TEST_DATA / "short_line.toml"
#: An entry of the doors and one of the protection; the others are long.
QUICK = ("D3", "P8")
MARKS = {"stop": (0.0, 89.0, 189.0), "section": (10.0, 112.0)}
ENTRIES = [
    pytest.param(entry, id=entry.id, marks=[] if entry.id in QUICK else [pytest.mark.long])
    for entry in catalogue_of(system_named("line"))
]


@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize("entry", ENTRIES)
def test_the_train_reacts_as_the_catalogue_says(entry: Entry, tmp_path: Path) -> None:
    given = parser(["faults"]).parse_args(["faults", str(LINE)])
    row = entry_run(run_spec(given, None, None), tmp_path, False, entry)
    assert row.failures == []
    assert row.made


def test_every_entry_is_in_the_fault_language_and_can_be_ordered_by_hand() -> None:
    system = system_named("line")
    for entry in catalogue_of(system):
        assert fault_texts(entry.faults, system, lambda row: Path("catalogue"), MARKS)
    by_hand = faults_by_hand(load_any(str(LINE)))
    assert "door_left stuck_open @manual combine id D1" in by_hand
    assert "atp dead @manual combine id P8" in by_hand


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.faults
def test_a_run_with_faults_has_the_same_bytes_again(tmp_path: Path) -> None:
    faults = ("door obstacle @stop 2", "atp_speed noise 0.05 @10s", "docking_loop intermittent @stop 2 for 5s")
    scenario = load_any(str(LINE), (), faults)
    spec = RunSpec(law=LawSpec("ipfc_plus"), seed=4)
    hashes = {local_run(scenario, tmp_path / name, spec).frames_sha256 for name in ("one", "two")}
    assert len(hashes) == 1
