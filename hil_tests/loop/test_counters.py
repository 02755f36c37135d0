"""The counters of the nodes agree with the record under every kind of fault, and are found wrong when changed."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import Result, local_run
from railhil.common.errors import InputError
from railhil.judge.counters import unchecked, unreconciled
from railhil.judge.judging import judging_of
from railhil.record.hash_list import write_hash_list
from railhil.record.trace import NodeCounters, Trace
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.judge.invariants import broken
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, TrnSpeed

pytestmark = pytest.mark.faults

Make = Callable[..., tuple[Scenario, Result]]
#: Faults that the receivers refuse for different causes, and those that keep frames from a receiver.
DISTURBED = (
    "TRN_SPEED duplicate 50% copies 2 @500ms for 300ms",
    "TRN_SPEED.TrainSpeed raw 8388607 @900ms x3",
    "TRN_SPEED.SpeedChk raw 2 @1s x3",
    "TRN_POS.counter freeze @1s for 100ms",
    "NOTCH_CMD.counter freeze @1.2s for 100ms",
    "NOTCH_CMD.NotchCmd raw 32767 @1.5s x3",
    "controller stop @1.8s for 100ms",
)


@pytest.fixture(scope="module")
def make(tmp_path_factory: pytest.TempPathFactory) -> Make:
    """Makes the run of 4 s with these faults and settings."""
    folder = tmp_path_factory.mktemp("counters")
    (folder / "short.toml").write_text(RUN_2M_TOML)

    def made(*faults: str, settings: tuple[str, ...] = (), **law: Any) -> tuple[Scenario, Result]:
        scenario = load(folder / "short.toml", settings, faults)
        spec = RunSpec(str(folder / "short.toml"), law=LawSpec(**law))
        return scenario, local_run(scenario, tmp_path_factory.mktemp("run"), spec)

    return made


@pytest.fixture(scope="module")
def disturbed(make: Make) -> tuple[Scenario, Result]:
    return make(*DISTURBED)


def counts(run: Result, node: str, port: str) -> dict[str, Any]:
    assert run.trace.reported is not None
    return dict(run.trace.reported.nodes[node]["ports"][port])


def test_the_nodes_count_what_the_record_shows(disturbed: tuple[Scenario, Result]) -> None:
    scenario, run = disturbed
    assert all(one.hits for one in run.faults)
    assert unreconciled(scenario, run.trace) == []
    speed, notch = counts(run, "controller", TrnSpeed.PORT), counts(run, "plant", NotchCmd.PORT)
    assert {"duplicate", "check_variable", "out_of_range"} <= set(speed["refused"])
    assert (speed["refused"]["check_variable"], speed["refused"]["out_of_range"]) == (3, 3)
    assert notch["refused"] == {"duplicate": 5, "out_of_range": 3}
    assert run.trace.reported is not None
    (gap,) = run.trace.reported.nodes["controller"]["gaps"]
    assert gap["ports"][TrnSpeed.PORT]["count"] == 10
    assert unchecked(run.trace) == ""


@pytest.mark.long_after(4)
@pytest.mark.parametrize(
    "fault",
    [
        "controller restart @1s for 200ms", "controller kill @1s", "controller slow 50ms @1s", "bus off @1s for 300ms",
        "bus down @1s", "controller stop @1s for 200ms after deliver", "TRN_SPEED corrupt 30% bits 2 @1s for 1s",
        "TRN_SPEED truncate 2 @1s x9", "TRN_POS truncate 2 @1s x5", "NOTCH_CMD truncate 2 @1s x5",
        "TRN_SPEED masquerade TRN_POS @1s x5", "NOTCH_CMD replay 100ms @1s", "TRN_SPEED remote @1s x9",
        "TRN_SPEED reorder 30% gap 3 @1s", "TRN_SPEED delay 30ms jitter 30ms @1s", "speed garbage @1s for 100ms",
    ],
)  # fmt: skip
def test_they_agree_under_each_fault(make: Make, fault: str) -> None:
    scenario, run = make(fault)
    assert run.faults[0].hits
    assert broken(scenario, run.trace) == []


def test_the_safe_channel_and_the_can_module_count_too(make: Make) -> None:
    safe, run = make("SPEED_SDT.SafeSpeedCode raw 5 @1s x3", settings=("safety.sdt=true",))
    assert unreconciled(safe, run.trace) == []
    told = counts(run, "controller", "SPEED_SDT")
    assert told["committed"] > told["accepted"] > 40
    assert told["refused"]["safe_crc"] == 3
    task, run = make("TRN_SPEED.SpeedChk raw 2 @1s x3", task_period_ms=20)
    assert unreconciled(task, run.trace) == []
    assert counts(run, "controller", TrnSpeed.PORT)["lost"] > 100
    # Without the life signs nothing beyond the good content can have been taken.
    most = run.trace.count(TrnSpeed.PORT) - run.faults[0].hits
    assert with_told(task, run.trace, changed(run.trace, "controller", TrnSpeed.PORT, accepted=most)) == []
    (said,) = with_told(task, run.trace, changed(run.trace, "controller", TrnSpeed.PORT, accepted=most + 1))
    assert said.startswith("invariant 1: the controller took 1 TRN_SPEED telegram ")


def changed(trace: Trace, node: str, port: str, **values: Any) -> NodeCounters:
    """The report with other counters of a port."""
    assert trace.reported is not None
    told = copy.deepcopy(trace.reported)
    told.nodes[node]["ports"][port].update(values)  # type: ignore[index]
    return told


def with_told(scenario: Scenario, trace: Trace, told: NodeCounters | None) -> list[str]:
    kept, trace.reported = trace.reported, told
    try:
        return unreconciled(scenario, trace)
    finally:
        trace.reported = kept


def test_a_controller_that_took_more_than_is_good_is_found(disturbed: tuple[Scenario, Result]) -> None:
    scenario, run = disturbed
    accepted = counts(run, "controller", TrnSpeed.PORT)["accepted"]
    told = changed(run.trace, "controller", TrnSpeed.PORT, accepted=accepted + 12)
    said = with_told(scenario, run.trace, told)
    assert said[0] == "invariant 1: the controller took 12 TRN_SPEED telegrams that the record does not show good"
    # And the verdict names it.
    kept, run.trace.reported = run.trace.reported, told
    assert said[0] in judging_of(scenario).score(scenario, run.trace).failures
    run.trace.reported = kept


@pytest.mark.parametrize(
    ("node", "port"), [("controller", "TRN_SPEED"), ("controller", "TRN_POS"), ("plant", "NOTCH_CMD")]
)
@pytest.mark.parametrize("key", ["accepted", "committed", "refused"])
@pytest.mark.parametrize("by", [-1, 1])
def test_every_counter_is_compared(disturbed: tuple[Scenario, Result], node: str, port: str, key: str, by: int) -> None:
    scenario, run = disturbed
    own = counts(run, node, port)
    value = own[key] + by if key != "refused" else own[key] | {"duplicate": own[key].get("duplicate", 0) + by}
    assert with_told(scenario, run.trace, changed(run.trace, node, port, **{key: value}))


def test_every_gap_is_compared(disturbed: tuple[Scenario, Result]) -> None:
    scenario, run = disturbed
    for key in ("first", "count"):
        told = copy.deepcopy(run.trace.reported)
        assert told is not None
        told.nodes["controller"]["gaps"][0]["ports"][TrnSpeed.PORT][key] += 1
        found = with_told(scenario, run.trace, told)
        assert (found != []) == (key == "count")


def test_refused_frames_are_compared(make: Make) -> None:
    scenario, run = make("TRN_SPEED truncate 2 @1s x9")
    assert run.trace.reported is not None
    told = copy.deepcopy(run.trace.reported)
    told.nodes["controller"]["frames"]["wrong_length"] -= 1  # type: ignore[index]
    assert with_told(scenario, run.trace, told) == [
        "invariant 6: the controller refused 8 frames (wrong length), the record shows 9"
    ]


def records(trace: Trace) -> Iterator[tuple[str, Trace]]:
    """The record with one telegram less and one more, by port."""
    for port in (TrnSpeed.PORT, NotchCmd.PORT):
        for wanted in (-1, 1):
            other = Trace(trace.contract)
            other.reported, other.end_ns, other.refused = trace.reported, trace.end_ns, trace.refused
            for entry in trace.contract.ports:
                data, size = bytes(trace._data.get(entry.name, b"")), entry.data_bytes
                for index, time_ns in enumerate(trace.times_ns(entry.name)):
                    at_it = entry.name == port and index == 40
                    for _ in range(1 + wanted if at_it else 1):
                        other.add(entry.name, time_ns, data[index * size : (index + 1) * size])
            yield port, other


def test_a_changed_record_is_found(disturbed: tuple[Scenario, Result]) -> None:
    scenario, run = disturbed
    for port, trace in records(run.trace):
        assert any(port in said for said in unreconciled(scenario, trace)), port


def test_a_node_that_does_not_report_is_not_checked(disturbed: tuple[Scenario, Result]) -> None:
    scenario, run = disturbed
    assert run.trace.reported is not None
    alone = NodeCounters(True, {"plant": run.trace.reported.nodes["plant"]})
    kept, run.trace.reported = run.trace.reported, alone
    assert unchecked(run.trace) == "controller"
    run.trace.reported = None
    assert unreconciled(scenario, run.trace) == []
    assert unchecked(run.trace) == "controller and plant"
    run.trace.reported = kept


def test_where_frames_can_be_lost_only_too_many_are_found(disturbed: tuple[Scenario, Result]) -> None:
    scenario, run = disturbed
    assert run.trace.reported is not None
    loose = NodeCounters(False, changed(run.trace, "controller", TrnSpeed.PORT, committed=3, accepted=2).nodes)
    assert with_told(scenario, run.trace, loose) == []
    more = changed(run.trace, "controller", TrnSpeed.PORT, accepted=run.trace.count(TrnSpeed.PORT))
    assert with_told(scenario, run.trace, NodeCounters(False, more.nodes))[0].startswith(
        "invariant 1: the controller took"
    )


def test_a_telegram_that_only_the_recorder_has_missed_is_no_breach(make: Make) -> None:
    """The node took it, the record lacks it: nothing is known of it, and the run is INVALID."""
    scenario, run = make()
    nodes = run.trace.reported.nodes
    for port, trace in records(run.trace):
        fewer = trace.count(port) < run.trace.count(port)
        trace.reported = NodeCounters(False, nodes)
        node = "controller" if port == TrnSpeed.PORT else "plant"
        unclear = f"record: the {node} took 1 {port} telegram that the record does not show"
        assert unreconciled(scenario, trace) == ([unclear] if fewer else [])
        found = judging_of(scenario).score(scenario, trace)
        assert (found.verdict == "INVALID", unclear in found.failures) == (fewer, fewer)


def test_a_bad_telegram_that_was_taken_is_a_breach_wherever_it_is_recorded(make: Make) -> None:
    scenario, run = make("TRN_SPEED.SpeedChk raw 2 @1s x3")
    accepted = counts(run, "controller", TrnSpeed.PORT)["accepted"]
    for surplus, said in ((3, "invariant 1: the controller took 3"), (4, "record: the controller took 4")):
        told = changed(run.trace, "controller", TrnSpeed.PORT, accepted=accepted + surplus)
        assert with_told(scenario, run.trace, NodeCounters(False, told.nodes))[0].startswith(said)


def test_the_folder_of_a_run_keeps_the_counters(tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    spec = RunSpec(str(tmp_path / "short.toml"), bus="local", faults=("TRN_SPEED.checksum random @1s x3",))
    made = railhil.run(spec, bus="local", out=tmp_path / "run")
    path = tmp_path / "run" / "certificate.json"
    document = json.loads(path.read_text())
    assert railhil.open_run(tmp_path / "run").reasons == made.reasons
    document["received"]["nodes"]["controller"]["ports"]["TRN_SPEED"]["accepted"] += 1
    path.write_text(json.dumps(document))
    write_hash_list(path.parent)
    assert any("invariant 1" in said for said in railhil.open_run(tmp_path / "run").reasons)
    document["received"]["nodes"]["plant"]["frames"] = 3
    path.write_text(json.dumps(document))
    write_hash_list(path.parent)
    with pytest.raises(InputError, match="received"):
        railhil.open_run(tmp_path / "run")
