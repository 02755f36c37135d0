"""Faults of the memory of a law that learns to stop: no crash, finite commands, the fault on the bus, learned again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.stops import SHORT
from railhil.batch.case import SequenceRun
from railhil.scenarios.load import load_any
from railhil.scenarios.memory import FAULTS, Memory, MemoryPlace, MemoryRecord
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.sequences.one import runner_of, sequence, sequences, through_nodes
from railhil.sequences.plan import run_specs
from railhil.wire.stop import BrakeCommand, IlcStatus

pytestmark = [pytest.mark.loop, pytest.mark.slow, pytest.mark.faults]

_SCENARIO = load_any("yizhuang_stop")
_KEY = "train_1 xiaocun outbound"
#: About what the law learns on this scenario; the memory is from before run 9.
_VALUES = {
    "version": 1,
    "records": [
        {
            "load_class": 0, "wet": 0, "offset_m": 4.95, "variance_m2": 0.1, "runs": 8, "last_run": 8, "gamma": 0.5,
            "last_errors_m": [0.0] * 8,
        }
    ],
}  # fmt: skip
GOOD = MemoryRecord("ilc_stop", _KEY, 8, 8, _VALUES)
NEWER = replace(GOOD, runs=9, last_run=8)
_TOO_FAR = {"version": 1, "records": [{**_VALUES["records"][0], "offset_m": 12.5}]}  # type: ignore[index, dict-item]


def runs_from_9(memory: Memory, count: int) -> list[SequenceRun]:
    base = RunSpec("yizhuang_stop", law=LawSpec("ilc_stop", "float64"), perturbed=True, bus="local")
    specs = run_specs(base, _SCENARIO, 3, 8 + count)[8:]
    return [*sequence(_SCENARIO, specs, runner_of(_SCENARIO), memory)]


def memory(*stored: MemoryPlace) -> Memory:
    return Memory("ilc_stop", stored, Path("store"))


def status(run: SequenceRun) -> tuple[int, int]:
    """Source and fault on the bus, at the end."""
    assert run.trace is not None
    return tuple(int(run.trace.raw(IlcStatus.PORT, name)[-1]) for name in ("MemorySource", "MemoryFault"))  # type: ignore[return-value]


def error_m(run: SequenceRun) -> float:
    assert run.trace is not None
    assert np.isfinite(run.trace.values(BrakeCommand.PORT, "CmdAccel")).all()
    error = run.score.signed["stop_error_m"]
    assert error is not None
    return error


@pytest.mark.long_after(1)
@pytest.mark.parametrize(
    ("bad", "fault"),
    [
        (MemoryPlace("A", None, "crc", "found other"), "crc"),
        (MemoryPlace("A", replace(NEWER, key="train_1 xiaohongmen outbound")), "key"),
        (MemoryPlace("A", replace(NEWER, values=_TOO_FAR)), "values"),
        (MemoryPlace("A", replace(NEWER, values={"version": 1, "records": [{}]})), "values"),
    ],
    ids=["damaged", "other platform", "out of range", "no record"],
)
def test_a_detected_fault_costs_nothing_while_the_other_slot_is_good(bad: MemoryPlace, fault: str) -> None:
    (run,) = runs_from_9(memory(bad, MemoryPlace("B", GOOD)), 1)
    assert status(run) == (2, FAULTS[fault])
    assert abs(error_m(run)) <= 0.6
    assert run.record is not None
    assert (run.record.runs, run.record.last_run) == (9, 9)


@pytest.mark.long
def test_without_a_good_slot_it_learns_again_within_5_runs() -> None:
    runs = runs_from_9(memory(MemoryPlace("A", None, "crc", ""), MemoryPlace("B", None, "json", "")), 6)
    assert [status(run) for run in runs] == [(0, FAULTS["crc"]), *[(1, 0), (2, 0)] * 2, (1, 0)]
    errors = [error_m(run) for run in runs]
    assert errors[0] > 3.5
    assert abs(errors[5]) <= 0.5
    assert [None if run.record is None else run.record.runs for run in runs] == [1, 2, 3, 4, 5, 6]


def test_the_report_of_another_run_teaches_nothing() -> None:
    settings = (*SHORT, "task.start_m=2560")
    learned = []
    for faults in ((), ("STOP_REPORT.ReportRun raw 9 @0s",), ("STOP_REPORT.ReportRun raw 1 @0s",)):
        scenario = load_any("yizhuang_stop", settings, faults)
        spec = RunSpec("yizhuang_stop", settings, LawSpec("ilc_stop", "float64"), seed=3, faults=faults, run_number=2)
        (run,) = sequence(scenario, [spec], through_nodes)
        assert run.score.verdict in ("PASS", "FAIL")
        assert run.kept is not None
        learned.append([one["last_run"] for one in run.kept.values["records"]])
    assert learned == [[2], [], []]


@pytest.mark.long
def test_least_squares_learn_from_runs_of_other_speeds_and_loads() -> None:
    """What they come to after 20 runs: docs/reference/stopping.md."""
    settings = (*SHORT, "task.start_m=2570", "task.start_spread_kmh=4")
    scenario = load_any("yizhuang_stop_load", settings)
    parameters = ParameterSet("ilc_stop", {"learning": "rls_load", "filter": "mean16"}, Path("test.toml"))
    law = LawSpec("ilc_stop", "float64", parameters=parameters)
    base = RunSpec("yizhuang_stop_load", settings, law, perturbed=True, bus="local")
    wanted = [run_specs(base, scenario, seed, 3) for seed in range(8)]
    errors, learned = np.zeros((8, 3)), np.zeros((8, 3))
    for place, number, run in sequences(scenario, wanted):
        errors[place, number - 1] = run.score.signed["stop_error_m"] or np.nan
        assert run.kept is not None
        learned[place, number - 1] = run.kept.values["braking"]["runs"]
    # A stop beyond 3 sigma of what was expected teaches nothing.
    assert (learned[:, 2] >= 2).all()
    rms = np.sqrt(np.square(errors).mean(axis=0))
    assert rms[2] < 0.5 * rms[0]
