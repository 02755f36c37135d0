"""The batch of the systems of high-speed trains gives the runs of the bench: commands, scores and failures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.cli import railhil
from railhil.batch import Case
from railhil.batch.columns import Columns
from railhil.batch.coupled import command_digest, digest_of
from railhil.batch.nodes import batch_of, kernel_of
from railhil.bench import Result, direct_run, unrecorded_run
from railhil.common.errors import InputError
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.high_speed import batch
from railhil.systems.high_speed.batch import run_high_speed
from railhil.wire.power_units import wire

LAWS = ("pid", "mm_gpc", "elm_ngpc", "delay_gpc")
#: The others are long.
_QUICK = ("pid", "mm_gpc")
BRAKING = ("task.start_s=3530", "task.rmse_max_kmh=90")


@pytest.fixture
def no_repeats(monkeypatch: pytest.MonkeyPatch) -> None:
    """No run is made one by one."""
    monkeypatch.setattr(batch, "run_coupled", None)


def check(
    scenario: AnyScenario,
    law: LawSpec,
    seeds: Sequence[int],
    repeated: int,
    bench: Callable[..., Result] = unrecorded_run,
) -> Any:
    """The first so many runs of a batch are those of the bench, one by one; returns the result of the batch."""
    case = Case(scenario, law)
    found = run_high_speed(case, seeds)
    assert len(set(found.digest)) == len(seeds)
    for i, seed in enumerate(seeds[:repeated]):
        run = bench(scenario, case.run(seed))
        assert found.digest[i] == command_digest(scenario, run.trace), seed
        assert found.scores[i] == run.score, seed
        for key, value in run.score.values.items():
            assert np.isnan(found.values[key][i]) if value is None else found.values[key][i] == value, (seed, key)
    return found


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.usefixtures("no_repeats")
@pytest.mark.parametrize("law", [pytest.param(law, marks=() if law in _QUICK else pytest.mark.long) for law in LAWS])
def test_the_batch_gives_the_runs_of_the_bench(law: str) -> None:
    scenario = load_any("hst_short", ["task.duration_s=12"])
    assert batch_of(scenario) is run_high_speed
    check(scenario, LawSpec(law, arithmetic="float64"), [3, 4, 2**32 - 1], 2)


@pytest.mark.long
@pytest.mark.usefixtures("no_repeats")
@pytest.mark.parametrize(
    ("name", "law"), [("emu3_short", "pid"), ("emu3_short", "delay_gpc"), ("jinan_xuzhou_emu3", "mm_gpc")]
)
def test_the_batch_gives_the_runs_of_the_bench_with_three_units(name: str, law: str) -> None:
    """With and without couplers, in the final braking at 300 km/h."""
    scenario = load_any(name, [*BRAKING, "task.duration_s=25"])
    check(scenario, LawSpec(law, arithmetic="float64"), [3, 4], 1, direct_run)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.usefixtures("no_repeats")
@pytest.mark.parametrize("arithmetic", ["iq", "float32"])
def test_the_batch_gives_the_runs_of_the_bench_in_other_arithmetics(arithmetic: str) -> None:
    scenario = load_any("hst_short", ["task.duration_s=12"])
    check(scenario, LawSpec("pid", arithmetic=arithmetic), [5, 6], 2, direct_run)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.usefixtures("no_repeats")
@pytest.mark.parametrize("law", LAWS)
def test_the_end_of_the_journey_is_that_of_the_bench(law: str) -> None:
    """From 300 km/h to the stopping point, where the train stands under ``pid``."""
    scenario = load_any("jinan_xuzhou", ["task.start_s=3450", "task.duration_s=307"])
    found = check(scenario, LawSpec(law, arithmetic="float64"), [1000, 1001], 1)
    if law == "pid":
        assert np.isfinite(found.values["arrival_m"]).all()


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.usefixtures("no_repeats")
@pytest.mark.parametrize("at_km", [204.5, 1.0])
def test_an_emergency_is_that_of_the_bench(at_km: float) -> None:
    """Every train reaches the place at a tick of its own; at km 1 they have passed it when the run begins."""
    scenario = load_any("jinan_xuzhou_emergency", [f"task.emergency.at_km={at_km}", "task.duration_s=130"])
    found = check(scenario, LawSpec("pid", arithmetic="float64"), [7, 8], 1, direct_run)
    assert np.isfinite(found.values["emergency_stop_m"]).all()


@pytest.mark.long
@pytest.mark.slow
def test_a_run_in_which_a_watch_acts_is_repeated_one_by_one() -> None:
    """The brake does a fifth of what it is told: the watch gives it up."""
    scenario = load_any("hst_short", [*BRAKING, "task.duration_s=60"])
    slow = scenario.task.unit[0].model_copy(update={"gain": 0.2})
    scenario = replace(scenario, task=scenario.task.model_copy(update={"unit": (slow,)}))
    found = check(scenario, LawSpec("pid", arithmetic="float64"), [3, 4], 2, direct_run)
    assert all("acted by itself" in failures[0] for failures in found.failures)


@pytest.mark.usefixtures("no_repeats")
def test_the_size_of_the_chunks_changes_nothing() -> None:
    case = Case(load_any("hst_short", ["task.duration_s=8"]), LawSpec("pid", arithmetic="float64"))
    together, apart = (run_high_speed(case, [3, 4, 5], chunk=chunk) for chunk in (3, 2))
    assert together.digest == apart.digest
    assert together.scores == apart.scores


def test_other_periods_of_the_ports_are_run_one_by_one() -> None:
    scenario = load_any("hst_short", ["task.duration_s=8", "timing.port_period_ms.UNIT1_CMD=80"])
    check(scenario, LawSpec("pid", arithmetic="float64"), [3], 1)


def test_a_scenario_with_a_fault_goes_through_the_nodes() -> None:
    scenario = load_any("hst_short", faults=["train.gain scale 1.4 @2s for 3s"])
    assert batch_of(scenario) is None
    assert kernel_of(scenario) is None
    assert kernel_of(load_any("hst_short")) == "railhil.systems.high_speed.kernel"


def test_a_law_without_fixed_point_is_refused_as_on_the_bench() -> None:
    with pytest.raises(InputError, match="fixed point"):
        run_high_speed(Case(load_any("hst_short"), LawSpec("gpc", arithmetic="iq")), [1])


def test_the_digest_depends_on_every_command() -> None:
    commands = np.arange(6).reshape(3, 2)
    changed = commands.copy()
    changed[2, 1] += 1
    assert digest_of(commands) == digest_of(commands.tolist()) != digest_of(changed)


def test_columns_are_complete_from_the_start() -> None:
    contract = wire(1).contract
    columns = Columns(contract, {"TRUTH": (np.array([0, 40_000_000]), {"TruePos": np.array([1, 2])})})
    assert columns.raw("TRUTH", "TruePos").tolist() == [1, 2]
    assert columns.raw("TRUTH", "TrueSpeed").tolist() == [0, 0]
    assert columns.times_s("TRUTH").tolist() == [0.0, 0.04]
    with pytest.raises(KeyError):
        columns.raw("TRUTH", "TRUEPOS")
    with pytest.raises(TypeError, match="TRUTH"):
        columns.add("TRUTH", 0, b"")


@pytest.mark.long
@pytest.mark.slow
def test_a_campaign_is_verified_on_the_bench(tmp_path: Path) -> None:
    """Over the ports of the system, which are not those of railhil's own train."""
    settings = ("--set", "task.duration_s=12", "--arithmetic", "float64", "--chunk", "1")
    done = railhil("campaign", "hst_short", *settings, "--runs", "2", "--out", tmp_path / "campaign")
    assert done.exit_code == 0, done.err
    assert "through the nodes" not in done.err
    done = railhil("campaign", "--verify", tmp_path / "campaign", "--runs", "1")
    assert done.exit_code == 0, done.err
    assert "1 of 1 runs are the same on the bench" in done.out
