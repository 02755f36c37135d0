"""Telemetry of a run: in the run folder, in the verdict, and read back from the record."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.cli import Started, railhil, wait_for
from hil_tests.support.plug import plug_in
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import local_run
from railhil.bus.codes import ControllerFlag
from railhil.bus.mvb import master_frame
from railhil.common.exit_codes import FAIL, PASS
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato.laws.ipfc import Ipfc, IpfcState
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.laws.base import SPEED_Q, LawInputs, LawOutputs
from railhil.controller_node.program.tracer import Tracer
from railhil.controller_node.telemetry_file import write_telemetry
from railhil.dbc import wire_contract
from railhil.judge.folder import junit, rerun_needs, run_command, score_json
from railhil.judge.result import Result
from railhil.record.telemetry import Headroom, read_summary, shown_telemetry
from railhil.record.trace import Trace
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec, StartUp
from railhil.systems.ato.judge.events import STATUS
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth

#: v^2 in Q28 does not fit into int32 above this speed, km/h.
_WRAPS_ABOVE_KMH = math.sqrt(8)


class Squared(Ipfc[Any]):
    """The law with one quantity more, in a format that is too small: the square of the speed in Q28.

    Its record shows the square of zero, else it would not start.
    """

    def step(self, state: IpfcState[Any], inputs: LawInputs[Any]) -> tuple[IpfcState[Any], LawOutputs[Any]]:
        answer = super().step(state, inputs)
        speed = self._ar.const(Constant("zero", 0.0, SPEED_Q)) if isinstance(self._ar, Tracer) else inputs.speed
        self._ar.note("squared", self._ar.mpy(speed, speed, 2 * SPEED_Q - 28), 28, "km2/h2")
        return answer


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scenario of 24 s: long enough for CTL_STAT to show every quantity."""
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_72M_TOML)
    return path


@pytest.fixture(scope="module")
def short_run(short: Path, tmp_path_factory: pytest.TempPathFactory) -> Result:
    """Its run without sockets, seed 1."""
    return local_run(load(short), tmp_path_factory.mktemp("short"), RunSpec(seed=1))


@pytest.fixture(scope="module")
def wrapped(short: Path, tmp_path_factory: pytest.TempPathFactory) -> Result:
    """The same run with :class:`Squared`."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("wrapped")
        plug_in(folder, patch, squared=Squared)
        return local_run(load(short), folder, RunSpec(law=LawSpec("squared"), seed=1))


@pytest.mark.slow
@pytest.mark.faults
def test_a_lost_message_is_told(short: Path, short_run: Result, tmp_path: Path) -> None:
    slow = local_run(load(short), tmp_path, RunSpec(law=LawSpec(task_period_ms=50), seed=1))
    for run, lost in ((short_run, False), (slow, True)):
        flags = run.trace.raw(CtlStat.PORT, "OverflowFlags")
        assert bool(np.any(flags & ControllerFlag.MESSAGE_LOST)) is lost
        assert np.all(np.diff(flags & ControllerFlag.MESSAGE_LOST) >= 0)
        losses = run.telemetry["lost_messages"]
        assert (losses["total"] > 0) is lost
        assert (
            losses["total"] == sum(losses["mailboxes"].values()) == run.counters["controller"].get("lost_messages", 0)
        )


@pytest.mark.slow
def test_a_wrap_fails_the_run(short_run: Result, wrapped: Result) -> None:
    (failure,) = set(wrapped.score.failures) - set(short_run.score.failures)
    assert wrapped.score.verdict == "FAIL"
    times_s = wrapped.trace.times_s(SimTruth.PORT)
    fast_s = times_s[np.argmax(wrapped.trace.values(SimTruth.PORT, "TrueSpeed") * 3.6 > _WRAPS_ABOVE_KMH)]
    text, _, reported = failure.rpartition(" at ")
    assert text == "fixed-point wrap in the controller, reported"
    # One control period until the law sees it, one period of CTL_STAT until it is told.
    assert fast_s <= float(reported.removesuffix(" s")) <= fast_s + 0.5 + 0.16 + 0.02
    # The quantity is only looked at: the train runs as ever.
    assert wrapped.commands("notch") == short_run.commands("notch")
    assert not any("wrap" in text for text in short_run.score.failures)


@pytest.mark.slow
def test_the_wrap_is_attributed(wrapped: Result) -> None:
    named = {row["name"]: row["wraps"] for row in wrapped.telemetry["quantities"] if row["wraps"]}
    assert set(named) == {"squared"}
    assert named["squared"] == wrapped.telemetry["totals"]["wraps"] > 10
    last = len(wrapped.telemetry["quantities"]) - 1
    shown = wrapped.trace.raw(CtlStat.PORT, "TelemetryIndex")
    flagged = wrapped.trace.raw(CtlStat.PORT, "TelemetryWrapped")
    assert set(shown[flagged == 1].tolist()) == {last}


class Late(Ipfc[Any]):
    """The law, with a sum that wraps in its second control period."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.steps = 0

    def step(self, state: IpfcState[Any], inputs: LawInputs[Any]) -> tuple[IpfcState[Any], LawOutputs[Any]]:
        self.steps += 1
        if self.steps == 2 and not isinstance(self._ar, Tracer):
            large = self._ar.from_raw(2**31 - 1, 0)
            self._ar.add(large, large)
        return super().step(state, inputs)


def test_a_wrap_in_the_last_step_fails_the_run(
    lvshun: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Control periods begin in ticks 0 and 50, CTL_STAT is due in tick 48, and the run ends in tick 53."""
    plug_in(tmp_path, monkeypatch, late=Late)
    plan = dataclasses.replace(lvshun.plan, running_time_s=0.52, overtime_max_s=0.0)
    run = local_run(dataclasses.replace(lvshun, plan=plan), tmp_path, RunSpec(law=LawSpec("late")))
    assert run.telemetry["steps"] == 2
    assert run.trace.times_s(CtlStat.PORT).tolist() == [0.0, 0.16, 0.32, 0.48, 0.53]
    assert "fixed-point wrap in the controller, reported at 0.53 s" in run.score.failures
    assert run.log is not None
    done = railhil("score", run.log, "--scenario", "lvshun_tieshan", "--json")
    assert done.exit_code == FAIL
    assert "fixed-point wrap in the controller, reported at 0.53 s" in done.json["failures"]


def result_of(scenario: Scenario, run: Result, spec: RunSpec | None = None) -> Result:
    """A run without the telemetry of its controller."""
    return Result(scenario, spec or RunSpec(), run.trace, run.score, exit_code=FAIL, frames=1)


@pytest.mark.slow
def test_the_wrap_stands_in_junit(wrapped: Result, nominal: Result, lvshun: Scenario) -> None:
    for run, fails in ((wrapped, True), (nominal, False)):
        root = junit(result_of(lvshun, run)).getroot()
        case = next(case for case in root.iter("testcase") if case.get("name") == "no_wrap")
        failure = case.find("failure")
        assert (failure is not None) is fails
        assert failure is None or "fixed-point wrap in the controller" in failure.get("message", "")


def test_a_run_without_telemetry_says_so(lvshun: Scenario, nominal: Result) -> None:
    """A controller that never made a step, and left no file."""
    assert shown_telemetry(Trace(wire_contract()), STATUS) is None
    trace = Trace(wire_contract())
    trace.add(CtlStat.PORT, 0, CtlStat().encode())
    assert shown_telemetry(trace, STATUS) is None
    document = score_json(result_of(lvshun, nominal, RunSpec(perturbed=True)))
    assert document["telemetry"] is None
    # Nor on which runs its own parameters were chosen.
    assert document["run"]["seed_was_trained"] is None


def test_the_record_gives_the_telemetry_of_a_controller_without_file(nominal: Result, wrapped: Result) -> None:
    found, other = shown_telemetry(nominal.trace, STATUS), shown_telemetry(wrapped.trace, STATUS)
    assert found is not None
    assert other is not None
    assert (found.happened, found.cycles) == ((), nominal.telemetry["cycles"]["ram"])
    whole = nominal.telemetry["quantities"]
    least = min(whole, key=lambda row: row["headroom_bits"])
    assert found.least_headroom == Headroom(f"quantity {whole.index(least)}", least["headroom_bits"])
    assert [row["index"] for row in found.quantities] == list(range(len(whole)))
    assert other.happened == ("wrap",)
    assert [row["index"] for row in other.quantities if row["wrapped"]] == [len(whole)]
    assert other.sentence().endswith(", wrap, as CTL_STAT tells it")


@pytest.mark.slow
@pytest.mark.loop
def test_process_leaves_the_telemetry_in_the_folder(short: Path, short_run: Result, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    done = railhil("run", short, "--seed", "1", "-i", "railhil", "--out", folder, "--quiet", "--no-report")
    document = json.loads((folder / "telemetry.json").read_text(encoding="utf-8"))
    assert document == json.loads(json.dumps(short_run.telemetry))
    assert (document["law"], document["arithmetic"], document["profile"]) == ("ipfc", "iq", "c28")
    assert document["steps"] == document["quantities"][0]["steps"] > 45
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
    assert not list(folder.glob(".part-*"))


@pytest.mark.slow
@pytest.mark.loop
def test_attached_run_takes_the_telemetry_from_the_record(
    short: Path, short_run: Result, tmp_path: Path, socket_folder: Path
) -> None:
    bus = ("-i", "railhil", "-c", str(socket_folder / "hub.sock"))
    started = [Started("bus", "hub", *bus[2:])]
    wait_for((socket_folder / "hub.sock").exists)
    started += [Started("node", role, short, *bus) for role in ("plant", "controller")]
    try:
        done = railhil("run", short, "--attach", "--out", tmp_path / "run", "--quiet", "--no-report", *bus)
        assert done.exit_code in (PASS, FAIL), done.err
    finally:
        for process in started:
            process.process.terminate()
            process.finish()
    found = json.loads((tmp_path / "run" / "score.json").read_text(encoding="utf-8"))["telemetry"]
    assert (found["source"], found["cycles"]) == ("CTL_STAT", short_run.telemetry["cycles"]["ram"])
    assert len(found["quantities"]) == len(short_run.telemetry["quantities"])
    assert "no overflow, as CTL_STAT tells it" in done.out
    certificate = json.loads((tmp_path / "run" / "certificate.json").read_text(encoding="utf-8"))
    assert {"SIM_TRUTH", "RUN_EVENT", "NOTCH_CMD"} <= set(certificate["not_witnessed"])
    # Nobody is there any more to be attached to.
    assert "attach" not in certificate["command"]
    assert "hub.sock" not in certificate["command"]
    assert "nodes" in certificate["command_needs"]
    words = certificate["command"].split()
    railhil(*words[1:], "--out", tmp_path / "again", "--quiet", "--no-report")
    again = json.loads((tmp_path / "again" / "certificate.json").read_text(encoding="utf-8"))
    assert again["frames_sha256"] == certificate["frames_sha256"]
    assert again["command_needs"] is None


def test_whoever_starts_the_nodes_says_how_it_is_done_again() -> None:
    attached = StartUp(attach=True, rerun_command="SEED=0 docker compose up")
    assert (run_command(RunSpec(start_up=attached), []), rerun_needs(attached)) == ("SEED=0 docker compose up", None)
    foreign = StartUp(foreign=True)
    assert run_command(RunSpec(start_up=foreign), ["-i", "socketcan", "-c", "can0"]).endswith(
        "--no-controller -i socketcan -c can0"
    )
    assert "board" in str(rerun_needs(foreign))


@pytest.mark.parametrize(
    "change",
    [
        None,
        lambda text: text[: len(text) // 2],
        lambda text: "[]",
        lambda text: "null",
        lambda text: "\ufffe",
        lambda text: text.replace('"ram"', '"step"'),
        lambda text: text.replace('"share": ', '"share": 1e999, "was": '),
        lambda text: text.replace('"ram": ', '"ram": 1e999, "was": '),
        lambda text: text.replace('"quantities": [', '"quantities": [7, '),
    ],
)
def test_a_broken_file_counts_as_missing(nominal: Result, tmp_path: Path, change: Any) -> None:
    whole = json.dumps(nominal.telemetry)
    path = tmp_path / "telemetry.json"
    if change is not None:
        assert change(whole) != whole
        path.write_text(change(whole), encoding="utf-8")
    assert read_summary(tmp_path) is None
    path.write_text(whole, encoding="utf-8")
    assert read_summary(tmp_path) is not None


def test_infinite_extremes_are_null(lvshun: Scenario, tmp_path: Path) -> None:
    node = ControllerNode(lvshun, LawSpec(arithmetic="float64"))
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
    node = ControllerNode(lvshun, LawSpec())
    write_telemetry(node, tmp_path / "gone" / "telemetry.json")
    assert "is lost: no such file or directory" in capsys.readouterr().err
    assert node.handle(master_frame(NotchCmd.port().f_code, NotchCmd.port().address))


@pytest.mark.slow
@pytest.mark.parametrize(("place", "why"), [(".", "is a directory"), ("gone/x.json", "no such file or directory")])
def test_a_file_that_cannot_be_written_is_refused_before_the_run(tmp_path: Path, place: str, why: str) -> None:
    done = railhil("node", "controller", "--telemetry", tmp_path / place, cwd=tmp_path)
    assert done.exit_code == 2
    assert f"cannot be written: {why}" in done.one_line()
