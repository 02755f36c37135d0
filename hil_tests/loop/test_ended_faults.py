"""Each place of faults inside a plant, with a fault that a later word ``ok`` ends."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.short_runs import RUN_72M_TOML
from hil_tests.support.stops import SHORT
from railhil.faults.words import CLEAR, words_at
from railhil.hunt.oracle import run_case
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named


def first_fault(place: str) -> str:
    """A fault of the first word of a place, from 1 s on."""
    word = next(one for one in words_at(*place.split("."), "") if one.name != CLEAR)
    values = ["2" for one in word.parameters if one.usual is None]
    return " ".join([place, word.name, *values, "@1s"])


@pytest.mark.faults
@pytest.mark.slow
@pytest.mark.parametrize("system", ["ato", "line", "stop", "hst1", "emu3"])
def test_a_fault_at_any_place_can_be_ended(system: str, tmp_path: Path) -> None:
    hop = tmp_path / "hop.toml"
    hop.write_text(RUN_72M_TOML, encoding="utf-8")
    scenario, settings = {
        "ato": (str(hop), ()),
        "line": (str(TEST_DATA / "tiny_line.toml"), ()),
        "stop": ("yizhuang_stop_closed", SHORT),
        "hst1": ("hst_short", ("task.duration_s=20",)),
        "emu3": ("emu3_short", ("task.duration_s=20",)),
    }[system]
    # A model that is not a number ends the run.
    found_system = system_named(system)
    places = [place for place in found_system.injects if place != "train.model"]
    faults = [text for place in places for text in (first_fault(place), f"{place} {CLEAR} @1.2s")]
    law = LawSpec(found_system.law, arithmetic=found_system.arithmetic)
    found = run_case(RunSpec(scenario, settings, law, bus="local"), (), faults, seed=0)
    assert found.verdict in ("PASS", "FAIL", "INVALID"), found.detail
    assert dict(found.violated) == {}
