"""Whole runs of precise stopping, in one process, without a bus and over the hub."""

from __future__ import annotations

import json
import random
from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.foreign import PORTABLE_INTERFACE, CNode
from hil_tests.support.stops import SHORT, stop_scenario
from railhil import library
from railhil.bench import Result, direct_run, local_run
from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.charts.svg import markup
from railhil.cli.commands import parser
from railhil.cli.faults import entry_run
from railhil.cli.run import run_spec
from railhil.common.errors import InputError
from railhil.controller_node.vector.node import VectorNode, ports_of
from railhil.judge.events.event import LEVEL
from railhil.judge.events.telegrams import events_of
from railhil.judge.reactions.catalogue import Entry, catalogue_of
from railhil.judge.signals import signal_table
from railhil.plant_sim.node import make_plant_node
from railhil.record.framelog import log_sha256
from railhil.record.session import make_session
from railhil.scenarios.fault_list import fault_texts
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.systems.stop import panels
from railhil.systems.stop.approach import Approach
from railhil.wire.stop import Stage

#: Ports of the bench's own nodes, which a run without a bus has not; it leaves open where the run ended.
NOT_COUPLED = ("SUP_CMD", "PLT_IDENT", "SUP_IDENT", "RUN_EVENT")
LAW = LawSpec("one_shot", arithmetic="float64")
SPEC = RunSpec(law=LAW, seed=3, run_number=2)


class Both(NamedTuple):
    local: Result
    direct: Result


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Both:
    scenario = stop_scenario(*SHORT, "task.stop_error_max_m=5", name="yizhuang_stop_closed")
    return Both(local_run(scenario, tmp_path_factory.mktemp("run"), SPEC), direct_run(scenario, SPEC))


def test_the_run_is_complete_and_healthy(both: Both) -> None:
    assert both.local.ended is Event.ENDED_COMPLETE
    assert both.local.score.failures == ()
    assert both.local.refused == {}


@pytest.mark.slow
def test_an_open_safety_loop_is_the_cause_in_events_and_verdict(tmp_path: Path) -> None:
    scenario = stop_scenario(*SHORT, "task.stop_error_max_m=5", name="yizhuang_stop_closed")
    scenario = replace(scenario, faults=("train.safety_loop off @1s",))
    run = local_run(scenario, tmp_path, SPEC)
    levels = [event for event in events_of(scenario, run.trace) if event.kind == LEVEL]
    assert [(event.level, event.cause, event.detail) for event in levels] == [
        ("emergency", "", "the safety loop is open")
    ]
    assert f"acted by itself from {levels[0].time_s:.2f} s (the safety loop is open)" in "; ".join(run.score.failures)


def test_a_run_without_a_bus_has_the_same_telegrams_at_the_same_instants(both: Both) -> None:
    for port in both.local.trace.contract.ports:
        if port.name not in NOT_COUPLED:
            assert list(both.direct.trace.times_ns(port.name)) == list(both.local.trace.times_ns(port.name)), port.name
            for signal in port.signals:
                pair = (run.trace.raw(port.name, signal.name).tolist() for run in both)
                assert next(pair) == next(pair), (port.name, signal.name)
    assert both.direct.score.values == both.local.score.values


def test_the_stop_is_reported_with_the_number_of_the_run_and_the_error_of_the_mark(both: Both) -> None:
    trace = both.local.trace
    runs = trace.raw("STOP_REPORT", "ReportRun").tolist()
    assert runs[0] == 0
    assert runs[-1] == 2
    measured_m = trace.values("STOP_REPORT", "ReportError")[-1]
    error_m = both.local.score.signed["stop_error_m"]
    assert 0.0 < abs(measured_m - error_m) < 0.15


def test_both_status_telegrams_are_recorded_and_are_columns_of_the_signals(both: Both) -> None:
    trace = both.local.trace
    assert trace.count("ATO_STATE") > 100
    assert trace.count("ILC_STATUS") > 5
    assert {Stage.TRACK, Stage.BRAKE, Stage.STANDSTILL} == {*trace.raw("ATO_STATE", "AtoStage").tolist()} - {0}
    header, rows = signal_table(stop_scenario(), trace)
    assert {"stage", "margin_m", "speed_estimate_mps", "memory_source", "memory_variance_m2"} <= {*header}
    estimated = rows[:, header.index("speed_estimate_mps")]
    assert estimated[200] == pytest.approx(rows[200, header.index("true_speed_mps")], rel=0.02)


def test_no_controller_has_a_mailbox_for_the_truth() -> None:
    system = system_named("stop")
    received, _ = ports_of(system.contract, system.part("interface"))
    names = {port.name for port in received}
    readings = {"BRAKE_STAT", "SPEED_RAW", "ODO", "TRAIN_STATE", "STOP_REPORT"}
    assert names == {"TIME_SYNC", "RUN_EVENT"} | readings
    node = system.part("controller")(stop_scenario(), LAW)
    assert {*node.responder.store.ports} == names


@pytest.mark.slow
def test_runs_of_a_sequence_differ_and_are_repeated_by_their_number(tmp_path: Path) -> None:
    scenario = stop_scenario(*SHORT)
    found = []
    for place, number in enumerate((1, 2, 2)):
        folder = tmp_path / str(place)
        folder.mkdir()
        found.append(local_run(scenario, folder, RunSpec(law=LAW, run_number=number)).frames_sha256)
    assert found[0] != found[1]
    assert found[1] == found[2]


def test_a_number_is_refused_where_runs_have_none() -> None:
    with pytest.raises(InputError, match="run_number: found 2, allowed 1: runs of system ato have no numbers"):
        RunSpec(run_number=2).load()
    assert load_any("yizhuang_stop").system == "stop"


@pytest.mark.long_after(2)
@pytest.mark.faults
@pytest.mark.slow
@pytest.mark.parametrize(
    "entry",
    [entry for entry in catalogue_of(system_named("stop")) if entry.id in ("P1", "P5", "P6", "P8", "P15")],
    ids=lambda entry: entry.id,
)
def test_the_train_reacts_as_the_catalogue_says(entry: Entry, tmp_path: Path) -> None:
    """The rest of the catalogue: ``railhil faults yizhuang_stop_closed``."""
    words = ["faults", "yizhuang_stop_closed", "--set", "task.stop_error_max_m=30"]
    given = parser(words).parse_args(words)
    row = entry_run(run_spec(given, "one_shot", None), tmp_path, False, entry)
    assert row.failures == []


def test_the_catalogue_of_the_system_is_in_the_fault_language() -> None:
    system = system_named("stop")
    for entry in catalogue_of(system):
        fault_texts(entry.faults, system, lambda row: Path("catalogue"))


@pytest.mark.slow
def test_from_standstill_the_train_starts_accelerates_and_stops(tmp_path: Path) -> None:
    settings = ("task.start_m=2531", "task.approach_kmh=18", "task.after_stop_s=2")
    scenario = stop_scenario(*settings, name="yizhuang_stop_from_standstill")
    run = local_run(scenario, tmp_path, RunSpec(law=LawSpec("reaim", "float64"), seed=3))
    assert run.score.failures == ()
    assert run.refused == {}
    stages = run.trace.raw("ATO_STATE", "AtoStage")
    changes = [Stage(int(stage)) for stage in stages[np.diff(stages, prepend=-1) != 0]]
    # The way is so short that the brake is armed before the speed of the approach is reached.
    assert changes[changes.index(Stage.START) :] == [
        Stage.START, Stage.ACCELERATE, Stage.ARMED, Stage.BRAKE, Stage.STANDSTILL, Stage.LEARN,
    ]  # fmt: skip
    assert 4.0 < max(run.trace.values("TRUTH", "TrueSpeed")) < 5.0


@pytest.mark.long
@pytest.mark.slow
def test_announced_low_adhesion_chooses_the_planned_rate() -> None:
    settings = (*SHORT, "task.start_m=2580", "task.rail.slide_share=1", "task.rail.adhesion_mps2=[0.58, 0.58]")
    spec = RunSpec(law=LawSpec("reaim", "float64"), seed=3)
    errors_m, rates_mps2 = [], []
    for announced in (0, 1):
        share = f"task.rail.announced_share={announced}"
        scenario = stop_scenario(*settings, share, name="yizhuang_stop_low_adhesion")
        run = direct_run(scenario, spec)
        errors_m.append(run.score.signed["stop_error_m"] or 0.0)
        rates_mps2.append(-min(run.trace.values("BRAKE_CMD", "CmdAccel")))
    assert errors_m[0] > 1.0
    assert abs(errors_m[1]) < 0.2
    assert rates_mps2[0] > 0.7
    assert rates_mps2[1] < 0.65


@pytest.mark.long
@pytest.mark.slow
def test_every_command_runs_it_in_the_arithmetic_of_the_system(tmp_path: Path) -> None:
    for command in ("faults", "compare"):
        given = parser([command]).parse_args([command, "yizhuang_stop"])
        assert run_spec(given, None, None).law == LawSpec("ilc_stop", "float64")
    assert library.run("yizhuang_stop", settings=SHORT, out=tmp_path / "run").spec.law.arithmetic == "float64"


def test_another_base_tick_is_refused() -> None:
    with pytest.raises(InputError, match=r"timing\.base_tick_ms: found 8\.0, allowed 16"):
        direct_run(stop_scenario("timing.base_tick_ms=8"), SPEC)


@pytest.mark.long
@pytest.mark.loop
@pytest.mark.slow
def test_three_processes_over_the_hub_send_the_same_bytes_and_rerun_repeats_them(tmp_path: Path) -> None:
    settings = [word for setting in (*SHORT, "task.stop_error_max_m=5") for word in ("--set", setting)]
    words = (*settings, "--seed", "4", "--run-number", "3", "--no-report")
    for bus in ("hub", "local"):
        where = ("--bus", "local") if bus == "local" else ()
        done = railhil("run", "yizhuang_stop", *words, *where, "--out", tmp_path / bus)
        assert done.exit_code == 0, done.err
    assert log_sha256(tmp_path / "hub" / "frames.log") == log_sha256(tmp_path / "local" / "frames.log")
    assert json.loads((tmp_path / "hub" / "certificate.json").read_text(encoding="utf-8"))["run_number"] == 3
    assert railhil("rerun", tmp_path / "local").exit_code == 0


@pytest.mark.long_after(1)
@pytest.mark.needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["iq", "float32"])
def test_the_c_node_answers_both_status_polls_as_ours(tmp_path: Path, arithmetic: str) -> None:
    """On a bus that loses some of the frames; the report says so when the readings were too old."""
    scenario = stop_scenario(*SHORT)
    settings = [word for setting in SHORT for word in ("--set", setting)]
    words = ("ilc_stop", "yizhuang_stop", *settings, "--arithmetic", arithmetic)
    done = railhil("export-c", *words, "--out", tmp_path / "c")
    assert done.exit_code == 0, done.err
    spec = RunSpec(law=LawSpec("ilc_stop", arithmetic=arithmetic))
    ours, theirs = VectorNode(scenario, spec.law), CNode(tmp_path / "c", "ilc_stop", PORTABLE_INTERFACE)
    session = make_session(scenario, lambda line: None, spec)
    lost, answered = random.Random(1), Counter[int]()

    def both(frame: Frame) -> list[Frame]:
        if frame.can_id < 0x160 and lost.random() < 0.1 and frame.can_id != 0x080:
            return []
        answer = ours.handle(frame)
        assert answer == theirs.handle(frame)
        answered.update(item.can_id for item in answer)
        return answer

    make_plant_node(scenario, spec, LocalBus([both, session.handle])).run()
    assert answered[0x180] > 100
    assert answered[0x188] > 5


def test_the_figures_are_drawn(both: Both) -> None:
    scenario = stop_scenario(*SHORT, name="yizhuang_stop_closed")
    run = SimpleNamespace(
        label="one", controller="one_shot", scenario=scenario, trace=both.local.trace, can_be_drawn=True
    )
    found = panels.pictures(scenario, [run])
    assert [picture.name for picture in found] == ["approach", "last_metres", "speed_estimate"]
    assert all("<svg" in markup(picture) for picture in found)
    times_s, error_mmps = panels._Run("one", None, Approach.of(scenario, both.local.trace), run.trace, 0).error_mmps(
        "ATO_STATE", "AtoSpeed"
    )
    # The first telegram comes before the law's first step in a run over the bus; later ones tell the measured speed.
    assert len(times_s) > 100
    assert np.nanmax(abs(error_mmps[10:])) < 60
