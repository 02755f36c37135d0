"""Planted defects of controller and units: a run with the faults that show one violates the sentence made for it."""

from __future__ import annotations

import pytest

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.planted import plant_here, planted_rows
from railhil.hunt.oracle import run_case
from railhil.judge.requirements.requirement import read_requirements
from railhil.scenarios.run_spec import LawSpec, RunSpec

ROWS = planted_rows("planted_high_speed")
HOP = RunSpec(
    str(TEST_DATA / "hst_hop.toml"),
    ("task.duration_s=20", "task.emergency.at_km=0.02"),
    LawSpec("pid", arithmetic="float64"),
    bus="local",
)


@pytest.mark.faults
@pytest.mark.slow
@pytest.mark.parametrize("name", ROWS)
def test_a_planted_defect_violates_its_sentence_and_the_bench_without_it_does_not(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    defect, faults, by = ROWS[name]
    asked = read_requirements("hst1")
    sound = run_case(HOP, asked, faults, seed=0)
    assert sound.is_valid
    assert by not in sound.violated
    plant_here(defect, monkeypatch)
    assert by in run_case(HOP, asked, faults, seed=0).violated


@pytest.mark.faults
@pytest.mark.slow
def test_a_controller_that_was_restarted_may_hear_what_the_sentence_refuses() -> None:
    """43 orders are lost: the life sign of the next one is old to a receiver that has heard the last one before."""
    faults = ("EVENT loss @3s for 8.6s", "controller restart @5s for 30ms")
    found = run_case(HOP, read_requirements("hst1"), faults, seed=0)
    assert (found.is_valid, dict(found.violated)) == (True, {})
