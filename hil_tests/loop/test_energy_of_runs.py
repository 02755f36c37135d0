"""Traction work of recorded runs against the bound of their sections (bar 10 of the line's specification)."""

from __future__ import annotations

from pathlib import Path

import pytest

import railhil
from hil_tests.support import shipped
from railhil.judge.record import Record
from railhil.systems.ato.energy.programme import energy_bound
from railhil.systems.ato.energy.record import energy_share_percent, regenerated_kj, traction_work_kj
from railhil.systems.ato.scenario.model import Scenario

NORMAL, ECONOMY = "normal", "economy"


def record_of(name: str, profile: str, folder: Path) -> Record:
    """A nominal run of ``ipfc_plus``; with ``economy`` on a curve that coasts, in the same time."""
    scenario = folder / f"{profile}.toml"
    coast = 'without = ["target"]\n[target.generate]\ncoast = true\n' if profile == ECONOMY else ""
    scenario.write_text(f'extends = "{name}"\nname = "{profile}"\ntitle = "{profile}"\n{coast}')
    return railhil.run(scenario, controller="ipfc_plus", bus="local", out=folder / "runs" / profile)


def work_and_bounds_kj(run: Record) -> tuple[float, float, float]:
    """Traction work of a run, and the bounds ``ideal`` and ``comfort`` at the time that it really took."""
    scenario = run.scenario
    assert isinstance(scenario, Scenario)
    late_s = run.score.signed["time_error_s"]
    assert late_s is not None
    time_s = scenario.plan.running_time_s + late_s
    bounds = [energy_bound(scenario, time_s, kind).bound_kj for kind in ("ideal", "comfort")]
    return traction_work_kj(run.trace), bounds[0], bounds[1]


@pytest.mark.long
@pytest.mark.slow
def test_a_run_on_a_curve_that_coasts_stops_as_well_and_needs_less_work(tmp_path: Path) -> None:
    normal, economy = (record_of("yizhuang_12", profile, tmp_path) for profile in (NORMAL, ECONOMY))
    assert normal.verdict == economy.verdict == "PASS"
    work_kj, ideal_kj, comfort_kj = work_and_bounds_kj(economy)
    assert ideal_kj * 0.995 <= work_kj
    assert energy_share_percent(work_kj, comfort_kj) <= 112.0
    assert work_kj < 0.9 * traction_work_kj(normal.trace)
    back_kj = regenerated_kj(economy.scenario, economy.trace)
    assert back_kj is not None
    assert 0.0 < back_kj < work_kj


@pytest.mark.long
@pytest.mark.timeout(900)
def test_the_yizhuang_line_keeps_its_shares_of_the_bound(tmp_path: Path) -> None:
    """``normal`` at most 125 % of comfort over the line; ``economy`` at most 112 %, and 125 % on each section."""
    names = [name for name in shipped.ATO if name.startswith("yizhuang_")]
    assert len(names) == 13
    works: dict[str, float] = {NORMAL: 0.0, ECONOMY: 0.0}
    comforts = dict(works)
    for name in names:
        for profile in works:
            folder = tmp_path / name
            folder.mkdir(exist_ok=True)
            run = record_of(name, profile, folder)
            assert run.verdict == "PASS"
            work_kj, ideal_kj, comfort_kj = work_and_bounds_kj(run)
            assert work_kj >= ideal_kj * 0.995
            if profile == ECONOMY:
                assert energy_share_percent(work_kj, comfort_kj) <= 125.0
            works[profile] += work_kj
            comforts[profile] += comfort_kj
    assert energy_share_percent(works[NORMAL], comforts[NORMAL]) <= 125.0
    assert energy_share_percent(works[ECONOMY], comforts[ECONOMY]) <= 112.0


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize("law", ["ipfc", "ipfc_plus"])
def test_no_shipped_run_needs_less_than_the_ideal_train(law: str, tmp_path: Path) -> None:
    for name in shipped.ATO:
        run = railhil.run(name, controller=law, bus="local", out=tmp_path / name)
        work_kj, ideal_kj, _ = work_and_bounds_kj(run)
        assert work_kj >= ideal_kj * 0.995, name
