"""Planted defects of watches and gate: a run with the faults that show one violates the sentence made for it."""

from __future__ import annotations

import pytest

from hil_tests.support.planted import plant_here, planted_rows
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.hunt.oracle import Judged, run_case
from railhil.judge.requirements.requirement import read_requirements
from railhil.scenarios.run_spec import LawSpec, RunSpec


@pytest.fixture(scope="module")
def hop(tmp_path_factory: pytest.TempPathFactory) -> RunSpec:
    path = tmp_path_factory.mktemp("hop") / "short.toml"
    path.write_text(RUN_72M_TOML, encoding="utf-8")
    return RunSpec(str(path), law=LawSpec("ipfc_plus"), bus="local")


@pytest.mark.slow
@pytest.mark.parametrize("name", planted_rows())
def test_a_planted_defect_violates_its_sentence_and_the_bench_without_it_does_not(
    name: str, hop: RunSpec, monkeypatch: pytest.MonkeyPatch
) -> None:
    defect, faults, by = planted_rows()[name]
    asked = read_requirements("ato")

    def judged() -> Judged:
        return run_case(hop, asked, faults, seed=0)

    sound = judged()
    assert (sound.is_valid, dict(sound.violated)) == (True, {})
    plant_here(defect, monkeypatch)
    assert by in judged().violated


@pytest.mark.slow
def test_a_restart_while_the_notch_returns_on_its_ramp_violates_no_sentence(hop: RunSpec) -> None:
    """The new controller begins with notch 0 after a silence: this step is none of the ramp."""
    faults = ("controller stop @4s for 500ms", "controller restart @5s for 60ms")
    found = run_case(hop, read_requirements("ato"), faults, seed=0)
    assert (found.is_valid, dict(found.violated)) == (True, {})
