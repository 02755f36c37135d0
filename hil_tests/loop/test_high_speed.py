"""Whole runs of the systems of high-speed trains, in one process and over the hub."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from hil_tests.support.cli import railhil
from railhil.bench import Result, direct_run, local_run
from railhil.bus.codes import Event
from railhil.controller_node.vector.node import ports_of
from railhil.judge.events.event import LEVEL
from railhil.judge.events.telegrams import events_of
from railhil.judge.reactions.catalogue import catalogue, catalogue_of
from railhil.scenarios.fault_list import fault_texts
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named

#: Ports of the bench's own nodes, which a run without a bus has not; it leaves open where the run ended.
NOT_COUPLED = ("SUP_CMD", "PLT_IDENT", "SUP_IDENT", "RUN_EVENT")
SPEC = RunSpec(law=LawSpec("pid", arithmetic="float64"), seed=3)


class Both(NamedTuple):
    local: Result
    direct: Result


@pytest.fixture(scope="module", params=["hst_short", "emu3_short"])
def both(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Both:
    scenario = load_any(request.param, ["task.duration_s=40", "task.rmse_max_kmh=9"])
    return Both(local_run(scenario, tmp_path_factory.mktemp("run"), SPEC), direct_run(scenario, SPEC))


@pytest.mark.long_after(1)
def test_the_run_is_complete_and_healthy(both: Both) -> None:
    assert both.local.ended is Event.ENDED_COMPLETE
    assert both.local.score.failures == ()
    assert both.local.refused == {}


def test_a_run_without_a_bus_has_the_same_telegrams_at_the_same_instants(both: Both) -> None:
    """Also those of the polls, whose time comes from two time bases of the recorder."""
    for port in both.local.trace.contract.ports:
        if port.name not in NOT_COUPLED:
            assert list(both.direct.trace.times_ns(port.name)) == list(both.local.trace.times_ns(port.name)), port.name
            for signal in port.signals:
                pair = (run.trace.raw(port.name, signal.name).tolist() for run in both)
                assert next(pair) == next(pair), (port.name, signal.name)
    assert both.direct.score.values == both.local.score.values


@pytest.mark.long_after(1)
@pytest.mark.loop
@pytest.mark.slow
@pytest.mark.parametrize("name", ["hst_short", "emu3_short"])
def test_three_processes_over_the_hub_send_the_same_bytes(name: str, tmp_path: Path) -> None:
    words = (
        "--set",
        "task.duration_s=20",
        "--set",
        "task.rmse_max_kmh=9",
        "--seed",
        "3",
        "--arithmetic",
        "float64",
        "--no-report",
    )
    logs = []
    for bus in ((), ("--bus", "local")):
        folder = tmp_path / str(len(logs))
        done = railhil("run", name, *words, *bus, "--out", folder)
        assert done.exit_code == 0, done.err
        logs.append((folder / "frames.log").read_bytes())
    assert logs[0] == logs[1]


@pytest.mark.parametrize("name", ["hst1", "emu3"])
def test_no_controller_has_a_mailbox_for_the_mutation(name: str) -> None:
    """The controller's node takes neither MUTATION nor TRUTH, and its law reads neither."""
    system = system_named(name)
    received, _ = ports_of(system.contract, system.part("interface"))
    names = {port.name for port in received}
    speeds = {f"UNIT{unit}_FB" for unit in range(1, max(1, len(system.units)) + 1)}
    assert names == {"TIME_SYNC", "RUN_EVENT", "REF", "EVENT"} | speeds
    node = system.part("controller")(load_any({"hst1": "hst_short", "emu3": "emu3_short"}[name]), SPEC.law)
    assert {*node.responder.store.ports} == names


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize(
    ("fault", "level", "cause"),
    [
        ("controller kill @20s", "traction_cut", "command_age"),
        ("UNIT2_FB loss 100% @20s for 1s", "traction_cut", "controller_safe"),
        ("actuator.brake off @0s units 2", "traction_cut", "brake_not_answering"),
        ("train.safety_loop off @20s", "service_brake", ""),
    ],
)
def test_the_ladder_of_the_units_is_in_the_events_and_in_the_verdict(
    fault: str, level: str, cause: str, tmp_path: Path
) -> None:
    """At 300 km/h, 20 s before the final braking begins."""
    settings = ("task.start_s=3530", "task.duration_s=40", "task.rmse_max_kmh=90")
    scenario = load_any("emu3_short", settings, [fault])
    run = local_run(scenario, tmp_path, SPEC)
    events = [event for event in events_of(scenario, run.trace) if event.kind == LEVEL]
    assert {(event.level, event.cause) for event in events} == {(level, cause)}
    assert run.score.verdict == "FAIL"
    assert any(f"acted by itself from {events[0].time_s:.2f} s" in text for text in run.score.failures)
    assert ("(the safety loop is open)" in run.score.failures[-1]) == ("loop" in fault)
    assert run.ended is (Event.ENDED_CONTROLLER_LOST if "kill" in fault else Event.ENDED_COMPLETE)


def test_the_catalogue_of_the_system_is_in_the_fault_language() -> None:
    for system in map(system_named, ("hst1", "emu3")):
        entries = catalogue_of(system)
        assert {entry.id for entry in entries} >= {"H1", "H3", "H9b"}
        for entry in entries:
            if system.name == "emu3":
                fault_texts(entry.faults, system, lambda row: Path("catalogue"))
    assert catalogue_of(system_named("ato")) == catalogue()


def test_a_new_scenario_begins_no_table_that_its_base_has_not(tmp_path: Path) -> None:
    """An empty [task.emergency] would lack its required keys."""
    for base, line in (("emu3_short", "#[task.emergency]"), ("jinan_xuzhou_emergency", "[task.emergency]")):
        path = tmp_path / f"{base}_mine.toml"
        assert railhil("new", "scenario", f"{base}_mine", "--extends", base, "--out", path).exit_code == 0
        assert line in path.read_text(encoding="utf-8").splitlines()
        assert load_any(path).name == f"{base}_mine"
