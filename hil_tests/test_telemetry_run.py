"""Telemetry of a run: on the wire, in the run folder, and in the verdict."""

from __future__ import annotations

import dataclasses
import json
import math
import signal
from pathlib import Path
from typing import Any

import cantools
import numpy as np
import pytest

import controller_node.loop
from bus.exitcodes import FAIL
from bus.frame import Frame
from bus.mvb import TelegramSource, master_frame
from bus.store import TrafficStore
from bus.telegrams import HEADROOM_UNUSED, NO_QUANTITY, ControllerFlag, CtlStat, NotchCmd, SimTruth
from controller_node.arithmetic import make
from controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from controller_node.laws.base import SPEED_Q, LawInputs, LawOutputs
from controller_node.laws.ipfc import Ipfc, IpfcState
from controller_node.node import ControllerNode, ControllerOptions
from controller_node.telemetry_file import telemetry_document, write_telemetry
from hil_tests.bench import BenchRun, local_run
from hil_tests.cli import Started, railhil, wait_for
from scenarios.model import Scenario
from supervisor.folder import junit, score_json
from supervisor.framelog import read_log
from supervisor.run import RunOptions, RunResult
from supervisor.score import Score
from supervisor.telemetry import read_summary

#: v^2 in Q28 does not fit into int32 above this speed, km/h.
_WRAPS_ABOVE_KMH = math.sqrt(8)


class Squared(Ipfc[Any]):
    """The law with one quantity more, in a format that is too small: the square of the speed in Q28."""

    def step(self, state: IpfcState[Any], inputs: LawInputs[Any]) -> tuple[IpfcState[Any], LawOutputs[Any]]:
        answer = super().step(state, inputs)
        self._ar.note("squared", self._ar.mpy(inputs.speed, inputs.speed, 2 * SPEED_Q - 28), 28, "km2/h2")
        return answer


@pytest.fixture(scope="module")
def nominal(lvshun: Scenario, tmp_path_factory: pytest.TempPathFactory) -> BenchRun:
    return local_run(lvshun, tmp_path_factory.mktemp("nominal"), seed=1)


@pytest.fixture(scope="module")
def wrapped(lvshun: Scenario, tmp_path_factory: pytest.TempPathFactory) -> BenchRun:
    """A run of :class:`Squared`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(controller_node.loop, "load", lambda name: Squared)
        return local_run(lvshun, tmp_path_factory.mktemp("wrapped"), seed=1)


def answer(node: ControllerNode, telegram: type[Any]) -> Any:
    """What the node answers to a poll."""
    store = TrafficStore([telegram.port()])
    for frame in node.handle(master_frame(telegram.port().f_code, telegram.port().address)):
        store.feed(frame, 0)
    return store.read(telegram, 0)[0]


def running_node(scenario: Scenario, run: BenchRun, arithmetic: str = "iq") -> ControllerNode:
    """A controller that has heard the first seconds of a recorded run."""
    node = ControllerNode(scenario, ControllerOptions(arithmetic=arithmetic))
    assert run.log is not None
    for time_ns, frame in read_log(run.log):
        if time_ns > 5e9:
            break
        node.handle(Frame(*frame))
    return node


def test_each_status_telegram_shows_the_next_quantity(nominal: BenchRun) -> None:
    shown = nominal.trace.raw(CtlStat.PORT, "TelemetryIndex")
    first = int(np.argmax(shown != NO_QUANTITY))
    quantities = nominal.telemetry["quantities"]
    assert set(shown[:first].tolist()) <= {NO_QUANTITY}
    assert shown[first:].tolist() == [i % len(quantities) for i in range(len(shown) - first)]
    headroom = nominal.trace.raw(CtlStat.PORT, "TelemetryHeadroom")[first:]
    for index, quantity in enumerate(quantities):
        seen = headroom[index :: len(quantities)].tolist()
        assert seen == sorted(seen, reverse=True), quantity["name"]
        assert seen[-1] >= quantity["headroom_bits"]


def test_status_telegram_is_the_telemetry_of_the_moment(lvshun: Scenario, nominal: BenchRun) -> None:
    node = running_node(lvshun, nominal)
    telemetry = node.controller.telemetry
    for kind in (SATURATION, WRAP, DIVISION_BY_ZERO):
        # Between two periods an event belongs to the last quantity.
        number = make("iq")
        number.noted, number.events = [], [(0, kind, 1)]
        telemetry.take(number)
        seen = {}
        for _ in telemetry.quantities:
            status = answer(node, CtlStat)
            seen[status.telemetry_index] = status
        assert sorted(seen) == list(range(len(telemetry.quantities)))
        for index, status in seen.items():
            row = telemetry.row(index)
            assert status.telemetry_headroom_bits == row.headroom_bits
            assert status.telemetry_wrapped == min(row.wraps, 1)
            assert status.telemetry_saturated == min(row.saturations, 1)
            assert status.telemetry_zero_division == min(row.zero_divisions, 1)
    assert [row.wraps for row in telemetry.rows] == [0] * (len(telemetry.quantities) - 1) + [1]


def test_floats_have_no_headroom_on_the_wire(lvshun: Scenario, nominal: BenchRun) -> None:
    node = running_node(lvshun, nominal, "float64")
    status = answer(node, CtlStat)
    assert (status.telemetry_headroom_bits, status.step_cycles, status.step_cycles_max) == (HEADROOM_UNUSED, 0, 0)
    fresh = answer(ControllerNode(lvshun, ControllerOptions()), CtlStat)
    assert (fresh.telemetry_index, fresh.telemetry_headroom_bits) == (NO_QUANTITY, HEADROOM_UNUSED)


@pytest.mark.parametrize(("cycles", "sent"), [(65_534, 65_534), (65_535, 65_535), (65_536, 65_535), (9**9, 65_535)])
def test_cycles_saturate_on_the_wire_only(lvshun: Scenario, nominal: BenchRun, cycles: int, sent: int) -> None:
    node = ControllerNode(lvshun, ControllerOptions())
    node.controller.cost = dataclasses.replace(node.controller.cost, cycles=cycles)
    assert nominal.log is not None
    for time_ns, frame in read_log(nominal.log):
        if time_ns > 1e9:
            break
        node.handle(frame)
    status = answer(node, CtlStat)
    assert (status.step_cycles, status.step_cycles_max) == (sent, sent)
    assert telemetry_document(node)["cycles"]["ram"] == cycles


def test_cantools_reads_the_telemetry() -> None:
    database = cantools.database.load_file(Path(__file__).parents[1] / "dbc" / "railhil.dbc")
    telegram = CtlStat(
        step_cycles=0xFFFF,
        step_cycles_max=0x1234,
        telemetry_index=7,
        telemetry_headroom_bits=18,
        telemetry_saturated=1,
        overruns=200,
    )
    block = TelegramSource(CtlStat.port()).frames(telegram.encode())[1]
    decoded: Any = database.decode_message(block.can_id, block.data)
    assert {name: decoded[name] for name in decoded if name.startswith(("Step", "Tele", "Over"))} == {
        "StepCycles": 65_535,
        "StepCyclesMax": 0x1234,
        "TelemetryIndex": 7,
        "TelemetryHeadroom": 18,
        "TelemetryWrapped": "no",
        "TelemetrySaturated": "yes",
        "TelemetryZeroDivision": "no",
        "OverrunCount": 200,
    }
    nothing: Any = database.decode_message(
        block.can_id, TelegramSource(CtlStat.port()).frames(CtlStat().encode())[1].data
    )
    assert (nothing["TelemetryIndex"], nothing["TelemetryHeadroom"]) == ("none", "unused")


def test_a_lost_message_is_told(lvshun: Scenario, nominal: BenchRun, tmp_path: Path) -> None:
    slow = local_run(lvshun, tmp_path, seed=1, task_period_ms=50)
    for run, lost in ((nominal, False), (slow, True)):
        flags = run.trace.raw(CtlStat.PORT, "OverflowFlags")
        assert bool(np.any(flags & ControllerFlag.MESSAGE_LOST)) is lost
        assert np.all(np.diff(flags & ControllerFlag.MESSAGE_LOST) >= 0)
        losses = run.telemetry["lost_messages"]
        assert (losses["total"] > 0) is lost
        assert (
            losses["total"] == sum(losses["mailboxes"].values()) == run.counters["controller"].get("lost_messages", 0)
        )


def test_a_wrap_fails_the_run(nominal: BenchRun, wrapped: BenchRun) -> None:
    (failure,) = set(wrapped.score.failures) - set(nominal.score.failures)
    assert wrapped.score.verdict == "FAIL"
    times_s = wrapped.trace.times_s(SimTruth.PORT)
    fast_s = times_s[np.argmax(wrapped.trace.values(SimTruth.PORT, "TrueSpeed") * 3.6 > _WRAPS_ABOVE_KMH)]
    text, _, reported = failure.rpartition(" at ")
    assert text == "fixed-point wrap in the controller, reported"
    # One control period until the law sees it, one period of CTL_STAT until it is told.
    assert fast_s <= float(reported.removesuffix(" s")) <= fast_s + 0.5 + 0.16 + 0.02
    # The quantity is only looked at: the train runs as ever.
    assert wrapped.notches == nominal.notches
    assert not any("wrap" in text for text in nominal.score.failures)


def test_the_wrap_is_attributed(wrapped: BenchRun) -> None:
    named = {row["name"]: row["wraps"] for row in wrapped.telemetry["quantities"] if row["wraps"]}
    assert set(named) == {"squared"}
    assert named["squared"] == wrapped.telemetry["totals"]["wraps"] > 100
    last = len(wrapped.telemetry["quantities"]) - 1
    shown = wrapped.trace.raw(CtlStat.PORT, "TelemetryIndex")
    flagged = wrapped.trace.raw(CtlStat.PORT, "TelemetryWrapped")
    assert set(shown[flagged == 1].tolist()) == {last}


def result_of(score: Score) -> RunResult:
    return RunResult(score, FAIL, "", 1, "", 1.0, 1.0, 1.0, "local", None)


def test_the_wrap_stands_in_the_log_and_in_junit(wrapped: BenchRun, nominal: BenchRun, lvshun: Scenario) -> None:
    assert wrapped.log is not None
    done = railhil("score", wrapped.log, "--scenario", "lvshun_tieshan", "--json")
    assert done.exit_code == FAIL
    assert done.json["failures"] == list(wrapped.score.failures)
    for run, fails in ((wrapped, True), (nominal, False)):
        root = junit(lvshun, RunOptions("lvshun_tieshan"), result_of(run.score)).getroot()
        case = next(case for case in root.iter("testcase") if case.get("name") == "no_wrap")
        failure = case.find("failure")
        assert (failure is not None) is fails
        assert failure is None or "fixed-point wrap in the controller" in failure.get("message", "")


def test_a_run_without_telemetry_says_so(nominal: BenchRun) -> None:
    """Nodes that were started elsewhere keep theirs."""
    document = score_json(result_of(nominal.score), RunOptions("lvshun_tieshan", attach=True))
    assert document["telemetry"] is None


@pytest.mark.loop
def test_process_leaves_the_telemetry_in_the_folder(nominal: BenchRun, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    done = railhil("run", "--seed", "1", "--out", folder, "--quiet")
    document = json.loads((folder / "telemetry.json").read_text(encoding="utf-8"))
    assert document == json.loads(json.dumps(nominal.telemetry))
    assert (document["law"], document["arithmetic"], document["profile"]) == ("ipfc", "iq", "c28")
    assert document["steps"] == document["quantities"][0]["steps"] > 380
    assert document["totals"] == {"wraps": 0, "saturations": 0, "zero_divisions": 0}
    score = json.loads((folder / "score.json").read_text(encoding="utf-8"))["telemetry"]
    least = min(document["quantities"], key=lambda row: row["headroom_bits"])
    assert score == {
        **document["totals"],
        "least_headroom": {"name": least["name"], "bits": least["headroom_bits"]},
        "cycles": document["cycles"]["ram"],
        "cycles_flash": 2 * document["cycles"]["ram"],
        "cycle_share": document["cycles"]["share"],
        "lost_messages": 0,
    }
    certificate = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    assert (certificate["arithmetic"], certificate["arithmetic_profile"]) == ("iq", "c28")
    assert f"least headroom {least['headroom_bits']} bit ({least['name']}), 0 wraps, 0 saturations" in done.out
    assert f"{score['cycles']} C28x cycles a step in RAM, {score['cycles_flash']} from flash" in done.out
    assert not list(folder.glob("*.part"))


@pytest.mark.loop
def test_telemetry_survives_the_end_of_the_plant(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    run = Started("run", "--seed", "1", "--out", folder, "--quiet", "--pace", "realtime", "--rate", "20")
    wait_for(lambda: (folder / "frames.log").stat().st_size > 400_000)
    run.child("plant_sim").send_signal(signal.SIGKILL)
    done, _ = run.finish()
    assert done.exit_code == 3
    document = json.loads((folder / "telemetry.json").read_text(encoding="utf-8"))
    assert 5 < document["steps"] < 380
    score = json.loads((folder / "score.json").read_text(encoding="utf-8"))
    assert score["telemetry"]["cycles"] == document["cycles"]["ram"]


@pytest.mark.parametrize(
    "change",
    [
        None,
        lambda text: text[: len(text) // 2],
        lambda text: "[]",
        lambda text: "null",
        lambda text: "\ufffe",
        lambda text: text.replace('"worst_step"', '"step"'),
        lambda text: text.replace('"share": ', '"share": 1e999, "was": '),
        lambda text: text.replace('"worst_step": ', '"worst_step": 1e999, "was": '),
        lambda text: text.replace('"quantities": [', '"quantities": [7, '),
    ],
)
def test_a_broken_file_counts_as_missing(nominal: BenchRun, tmp_path: Path, change: Any) -> None:
    whole = json.dumps(nominal.telemetry)
    path = tmp_path / "telemetry.json"
    if change is not None:
        assert change(whole) != whole
        path.write_text(change(whole), encoding="utf-8")
    assert read_summary(tmp_path) is None
    path.write_text(whole, encoding="utf-8")
    assert read_summary(tmp_path) is not None


def test_infinite_extremes_are_null(lvshun: Scenario, tmp_path: Path) -> None:
    node = ControllerNode(lvshun, ControllerOptions(arithmetic="float64"))
    number = make("float64")
    number.noted = [math.inf] * len(node.controller.telemetry.quantities)
    node.controller.telemetry.take(number)
    write_telemetry(node, tmp_path / "telemetry.json")
    row = json.loads((tmp_path / "telemetry.json").read_text(encoding="utf-8"))["quantities"][0]
    assert (row["minimum"], row["maximum"], row["steps"]) == (None, None, 1)
    found = read_summary(tmp_path)
    assert found is not None
    assert found.least_headroom is None
    assert found.cycles == 0
    assert found.sentence() == "no fixed point, 0 wraps, 0 saturations"


def test_a_full_disk_costs_the_file_and_nothing_else(
    lvshun: Scenario, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    node = ControllerNode(lvshun, ControllerOptions())
    write_telemetry(node, tmp_path / "gone" / "telemetry.json")
    assert "is lost: no such file or directory" in capsys.readouterr().err
    assert answer(node, NotchCmd) is not None


@pytest.mark.parametrize(("place", "why"), [(".", "is a directory"), ("gone/x.json", "no such directory")])
def test_a_file_that_cannot_be_written_is_refused_before_the_run(tmp_path: Path, place: str, why: str) -> None:
    done = railhil("node", "controller", "--telemetry", tmp_path / place, cwd=tmp_path)
    assert done.exit_code == 2
    assert f"a file that can be written ({why})" in done.one_line()
