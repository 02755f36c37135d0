"""The batch of precise stopping: every run is that of the bench."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.plug import plug_in
from hil_tests.support.stops import SHORT, stop_scenario
from railhil.batch.case import Case, SequenceRun
from railhil.batch.coupled import command_digest
from railhil.batch.nodes import kernel_of, one_by_one
from railhil.bench import direct_run
from railhil.controller_node.laws.memory import NOTHING, Remembered
from railhil.controller_node.stop.laws.one_shot import OneShot
from railhil.controller_node.vector.controller import VectorController
from railhil.scenarios.load import load_any
from railhil.scenarios.memory import Memory, MemoryPlace, MemoryRecord, no_memory
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.stop import batch
from railhil.systems.stop.batch import run_stops, run_together

#: Everything that can be drawn or that the plant does is on.
ROUGH = (
    *SHORT,
    "task.balises_m=[100, 28, 16, 4]",
    "task.start_spread_kmh=3",
    "task.rail.slide_share=0.5",
    "task.rail.adhesion_mps2=[0.4, 0.6]",
    "task.rail.seen_share=0.5",
    "task.rail.announced_share=0.5",
    "task.load_percent=[0, 100]",
    "task.true.full_load_gain=0.9",
    "task.true.low_speed_loss=0.15",
    "task.true.delay_run_sigma_s=0.02",
    "task.brake.notch_mps2=0.02",
    "task.grade=[[0, 3], [2612, -2]]",
)


def alone(scenario: Any, spec: RunSpec) -> SequenceRun:
    """The same run without arrays."""
    controller = VectorController(scenario, spec.law)
    run = direct_run(scenario, spec, controller)
    run.arithmetic = controller.counters
    return SequenceRun.of(run, command_digest(scenario, run.trace), controller.kept())


def specs_of(law: LawSpec, count: int = 4) -> list[RunSpec]:
    return [RunSpec(law=law, seed=seed, run_number=1 + seed % 2) for seed in range(count)]


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(("law", "arithmetic"), [("ilc_stop", "float64"), ("reaim", "float64"), ("ilc_stop", "iq")])
def test_every_run_is_that_of_the_bench(law: str, arithmetic: str) -> None:
    scenario = stop_scenario(*ROUGH, name="yizhuang_stop_closed")
    specs = specs_of(LawSpec(law, arithmetic=arithmetic))
    found = run_together(scenario, specs, chunk=3)
    assert found == [alone(scenario, spec) for spec in specs]
    assert len({one.digest for one in found}) == len(found)


@pytest.mark.long
@pytest.mark.slow
def test_each_train_has_its_own_memory() -> None:
    scenario = stop_scenario(*SHORT, name="yizhuang_stop_closed")
    law = LawSpec("ilc_stop", arithmetic="float64")
    memories: list[Memory] = [no_memory("ilc_stop", Path("memory"))] * 3
    for number in (1, 2, 3):
        specs = [
            RunSpec(law=replace(law, memory=memory), seed=seed, run_number=number)
            for seed, memory in enumerate(memories)
        ]
        found = run_together(scenario, specs)
        assert found == [alone(scenario, spec) for spec in specs]
        memories = [one.left for one in found]
    assert len({str(one.kept.values) for one in found if one.kept}) == 3
    # A run that is made again is not learned again, as on the bench.
    again = [replace(spec, law=replace(law, memory=memory)) for spec, memory in zip(specs, memories, strict=True)]
    kept = [one.kept for one in run_together(scenario, again)]
    assert kept == [alone(scenario, spec).kept for spec in again]
    assert [one.values for one in kept if one] == [one.kept.values for one in found if one.kept]


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(
    ("arithmetic", "values"),
    [("float64", {"filter": "kalman_command", "start_inside_cycle": True}), ("float32", {"filter": "mean5"})],
)
def test_parameters_and_single_precision_are_those_of_the_bench(arithmetic: str, values: dict[str, Any]) -> None:
    scenario = stop_scenario(*ROUGH, "task.start_m=2606", name="yizhuang_stop_closed")
    parameters = ParameterSet("ilc_stop", values, Path("test.toml"))
    specs = specs_of(LawSpec("ilc_stop", arithmetic, parameters=parameters), 2)
    assert run_together(scenario, specs) == [alone(scenario, spec) for spec in specs]


def stored(law: str, offset_m: float, runs: int) -> Memory:
    """The memory of a train after some runs."""
    kept = {"load_class": 0, "wet": 0, "offset_m": offset_m, "variance_m2": 0.01 * runs, "runs": runs, "last_run": 1}
    values = {"version": 1, "records": [{**kept, "last_errors_m": [0.1] * runs, "gamma": 0.5}]}
    return Memory(
        law, (MemoryPlace("A", MemoryRecord(law, "train_1 xiaocun outbound", runs, 1, values)),), Path("store")
    )


@pytest.mark.slow
def test_a_train_with_a_stored_memory_runs_beside_one_without() -> None:
    scenario = stop_scenario(*SHORT, name="yizhuang_stop_closed")
    memories = [stored("reaim", 0.4, 3), no_memory("reaim", Path("memory")), stored("reaim", -0.2, 1)]
    specs = [
        RunSpec(law=LawSpec("reaim", "float64", memory=memory), seed=seed, run_number=2)
        for seed, memory in enumerate(memories)
    ]
    found = run_together(scenario, specs, say=refuse)
    assert found == [alone(scenario, spec) for spec in specs]
    records = [one.kept.values["records"] for one in found if one.kept]
    assert [one[0]["runs"] for one in records] == [4, 1, 2]


def refuse(said: str) -> None:
    raise AssertionError(said)


class Branching(OneShot[Any]):
    """A law whose operations depend on its memory; its constants have the same names and formats."""

    def __init__(self, arithmetic: Any, scenario: Any, parameters: Any = None, memory: Remembered = NOTHING) -> None:
        super().__init__(arithmetic, scenario, parameters)
        self._early = memory.values is not None

    @classmethod
    def memory_key(cls, scenario: Any) -> str:
        return "train"

    def memory(self, state: Any) -> dict[str, Any]:
        return {"runs": 1}

    def step(self, state: Any, readings: Any) -> Any:
        state, answer = super().step(state, readings)
        if self._early:
            accel, *rest = answer.commands
            answer = answer._replace(commands=(self.re.add(accel, accel), *rest))
        return state, answer


@pytest.mark.long
@pytest.mark.slow
def test_laws_that_differ_in_more_than_constants_are_run_one_by_one_and_it_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plug_in(tmp_path, monkeypatch, "railhil.laws_stop", branching=Branching)
    scenario = stop_scenario(*SHORT)
    had = Memory("branching", (MemoryPlace("A", MemoryRecord("branching", "train", 1, 1, {"runs": 1})),), Path("store"))
    specs = [
        RunSpec(law=LawSpec("branching", "float64", memory=memory), run_number=2)
        for memory in (had, no_memory("branching", Path("store")))
    ]
    said: list[str] = []
    found = run_together(scenario, specs, say=said.append)
    assert said == ["branching: 2 runs are made one by one: with their memories the law differs in its operations"]
    assert found == [alone(scenario, spec) for spec in specs]
    assert found[0].digest != found[1].digest


def test_why_all_runs_of_a_scenario_are_made_one_by_one() -> None:
    usual, other = load_any("yizhuang_stop"), load_any("yizhuang_stop", ["timing.port_period_ms.ATO_STATE=128"])
    assert (one_by_one(usual), kernel_of(usual)) == ("", "railhil.systems.stop.kernel")
    assert one_by_one(other) == (
        "the batch of system stop makes the runs one by one: its ports have other periods than those of the port table"
    )
    assert kernel_of(other) is None
    assert batch.one_by_one(load_any("yizhuang_stop", (), ("adhesion low 0.06 @10s",))) == "the scenario has faults"


@pytest.mark.slow
def test_a_run_in_which_the_watch_acts_is_that_of_the_bench() -> None:
    scenario = stop_scenario(*SHORT, "task.true.gain=0.35", "task.duration_s=30", name="yizhuang_stop")
    specs = specs_of(LawSpec("one_shot", arithmetic="float64"), 2)
    found = run_together(scenario, specs)
    assert found == [alone(scenario, spec) for spec in specs]
    assert all("does not answer" in one.score.failures[1] for one in found)


def test_a_train_that_does_not_stop_in_time_is_that_of_the_bench() -> None:
    scenario = stop_scenario(*SHORT, "task.duration_s=6")
    specs = specs_of(LawSpec("one_shot", arithmetic="float64"), 2)
    found = run_together(scenario, specs)
    assert found == [alone(scenario, spec) for spec in specs]
    assert found[0].score.ended == "ended_not_stopped"


def test_the_batch_of_a_campaign_is_of_first_runs() -> None:
    scenario = stop_scenario(*SHORT)
    law = LawSpec("one_shot", arithmetic="float64")
    result = run_stops(Case(scenario, law), [3, 4])
    assert result.scores[1] == alone(scenario, RunSpec(law=law, seed=4)).score
    assert result.digest[0] == alone(scenario, RunSpec(law=law, seed=3)).digest
