"""A fault that drives the plant beyond what its telegrams carry: the run is INVALID with the reason, and never a defect
of the bench."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.batch.case import Case
from railhil.bus.layout import CHECK_ERRONEOUS
from railhil.common.exit_codes import FAIL, INVALID, PASS, exit_code_of
from railhil.plant_sim.any_plant import FaultTooLarge
from railhil.run.coupled import direct_run
from railhil.run.make import run_into
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.batch import run_batch
from railhil.wire.ato import TrnSpeed

pytestmark = pytest.mark.faults

_SHORT = {
    "ato": ("short.toml", ()),
    "hst1": ("hst_short", ("task.duration_s=12",)),
    "emu3": ("emu3_short", ("task.duration_s=12",)),
    "stop": ("yizhuang_stop", ("task.duration_s=25",)),
    "line": (str(Path(__file__).parents[1] / "data" / "tiny_line.toml"), ()),
}

#: Settings of runs that need less time.
_SHORTER = {"stop": ("task.duration_s=3",)}


def _spec(system: str, folder: Path, *faults: str) -> RunSpec:
    (folder / "short.toml").write_text(RUN_2M_TOML)
    scenario, settings = _SHORT[system]
    scenario = str(folder / scenario) if scenario == "short.toml" else scenario
    law = LawSpec(load_any(scenario, settings, ()).usual_law)
    return RunSpec(scenario, settings=settings, bus="local", faults=faults, law=law)


@pytest.mark.parametrize(
    ("system", "faults", "signal"),
    [
        ("ato", ["mass scale 0.01 @1s"], "SIM_TRUTH.TrueAccel"),
        ("ato", ["gradient offset 100 @0s combine"] * 4, "SIM_TRUTH.TrueGrade"),
        ("line", ["mass scale 0.01 @0s"], "SIM_TRUTH.TrueAccel"),
        ("hst1", ["gain scale 100 @1s"], "TRUTH.TrueDrive"),
        ("emu3", ["gain scale 20 @1s units 2"], "TRUTH.Coupler2"),
        ("stop", ["gain scale 5 @0s"], "TRUTH.TrueAccel"),
    ],
)
def test_a_motion_beyond_the_record_is_invalid_and_says_why(
    system: str, faults: list[str], signal: str, tmp_path: Path
) -> None:
    result = run_into(tmp_path / "run", _spec(system, tmp_path, *faults))
    assert result.exit_code == INVALID
    assert result.line.startswith(faults[0])
    assert "beyond the range of the record" in result.line
    assert f"{signal}: found " in result.line


@pytest.mark.parametrize(
    ("system", "fault", "port", "value"),
    [
        ("stop", "gain scale 3 @0s combine", "TRUE_DATA", "TrueGain"),
        ("hst1", "lag scale 100 @0s combine", "MUTATION", "TrueLag"),
        ("ato", "balise wrong 1000km @0s combine", "BALISE", "BalisePos"),
    ],
)
def test_other_values_stay_at_the_end_of_their_range_and_are_marked(
    system: str, fault: str, port: str, value: str, tmp_path: Path
) -> None:
    """Three such faults: alone, none of them leaves the range."""
    spec = replace(_spec(system, tmp_path, *[fault] * 3), settings=(*_SHORT[system][1], *_SHORTER.get(system, ())))
    result = run_into(tmp_path / "run", spec)
    assert result.exit_code in (PASS, FAIL)
    signal = result.trace.contract.port(port).signal(value)
    check = next(one.name for one in result.trace.contract.port(port).signals if one.check == "chk")
    assert result.trace.raw(port, value).max() == signal.raw_range[1]
    assert CHECK_ERRONEOUS in result.trace.raw(port, check)


@pytest.mark.slow
def test_a_run_over_a_bus_says_the_same(tmp_path: Path) -> None:
    spec = _spec("ato", tmp_path, "mass scale 0.01 @1s")
    alone, apart = (run_into(tmp_path / bus, replace(spec, bus=bus)) for bus in ("local", "hub"))
    assert apart.exit_code == INVALID
    assert apart.line.endswith(alone.line)
    assert apart.frames_sha256 == alone.frames_sha256


def test_a_run_without_a_bus_ends_as_invalid_too(tmp_path: Path) -> None:
    spec = _spec("stop", tmp_path, "gain scale 5 @0s")
    scenario = load_any(spec.scenario, spec.settings, spec.faults)
    with pytest.raises(FaultTooLarge, match="gain scale 5") as error:
        direct_run(scenario, spec)
    assert exit_code_of(error.value) == INVALID


@pytest.mark.slow
def test_the_batch_names_the_run_whose_fault_is_too_large(tmp_path: Path) -> None:
    spec = _spec("ato", tmp_path, "mass scale 0.01 @0s")
    scenario = load_any(spec.scenario, spec.settings, spec.faults)
    with pytest.raises(FaultTooLarge, match=r"mass scale 0.01.*: .* with seed 7"):
        run_batch(Case(scenario, spec.law, False), [7])


@given(speed=st.integers(-(2**40), 2**40), life=st.integers(0, 15))
def test_a_limited_telegram_is_the_nearest_that_fits(speed: int, life: int) -> None:
    telegram = TrnSpeed(speed, life=life)
    telegram.limit()
    low, high = TrnSpeed.port().signal("TrainSpeed").raw_range
    assert TrnSpeed.decode(telegram.encode()) == TrnSpeed(min(max(speed, low), high), CHECK_ERRONEOUS, life=life)
