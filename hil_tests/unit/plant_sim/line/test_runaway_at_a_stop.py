"""A drive that does not obey, at a stop: the interlock of the doors opens the contactors."""

from __future__ import annotations

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.hunt.oracle import run_case
from railhil.judge.requirements.requirement import read_requirements
from railhil.scenarios.run_spec import LawSpec, RunSpec


@pytest.mark.slow
def test_wheels_that_spin_are_no_traction_against_the_protection() -> None:
    wanted = [one for one in read_requirements("line") if one.id == "LINE-12"]
    base = RunSpec(str(TEST_DATA / "tiny_line.toml"), law=LawSpec("ipfc_plus"), bus="local")
    faults = "atp dead @23.1s for 5.75s combine", "adhesion low 0.0028 @23.25s for 6.35s combine"
    judged = run_case(base, wanted, faults, 0)
    assert judged.is_valid
    assert dict(judged.violated) == {}


@pytest.mark.slow
@pytest.mark.parametrize("fault", ["traction full @17.5s", "doors off @5s"])
def test_no_traction_with_open_doors_whatever_the_drive_does(fault: str) -> None:
    """Found by a hunt. At 5 s the train is so slow that the protection applies its service brake alone."""
    doors = [one for one in read_requirements("line") if one.id in ("LINE-5", "LINE-6", "LINE-7", "LINE-19")]
    base = RunSpec(str(TEST_DATA / "tiny_line.toml"), law=LawSpec("ipfc_plus"), bus="local")
    judged = run_case(base, doors, (fault,), 0)
    assert judged.is_valid
    assert dict(judged.violated) == {}
