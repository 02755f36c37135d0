"""Faults of telegrams, injected in one process: what is on the wire, what the log says, who notices."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.injected import NOTCH, SPEED, Runs, frames, hits, log, runs_with_faults
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import Result
from railhil.bus.codes import FaultOrder
from railhil.bus.injector.controller_side import FaultyController
from railhil.bus.telegrams import RunEvent
from railhil.common.errors import InputError
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.controller import make_controller_node
from railhil.dbc import wire_contract
from railhil.judge.fault_report import fault_outcomes, missed_faults
from railhil.record.framelog import read_log
from railhil.run.local import LocalRun, local_plan
from railhil.run.run import Observer
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.wire.ato import CtlMode, CtlStat, NotchCmd, TrnPos, TrnSpeed

pytestmark = pytest.mark.faults


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Runs:
    return runs_with_faults(tmp_path_factory)


def test_a_controller_without_faults_of_its_own_has_no_injector(tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML)
    for fault, kind in (("TRN_SPEED loss @1s", ControllerNode), ("NOTCH_CMD loss @1s", FaultyController)):
        assert isinstance(make_controller_node(load(path, (), (fault,)), RunSpec()), kind)


def test_what_is_lost_is_not_on_the_wire(runs: Runs) -> None:
    clean, run = runs(), runs("TRN_SPEED loss @1s for 100ms")
    assert len(frames(run, SPEED)) == len(frames(clean, SPEED)) - 10
    assert [row[0] for row in hits(run)] == pytest.approx([1.0 + tick / 100 for tick in range(10)])
    assert {row[3] for row in hits(run)} == {"lost"}
    assert [row[:2] for row in log(run) if row[1] in ("begun", "ended")] == [(1.0, "begun"), (1.1, "ended")]
    assert not any(1.0 <= time_s < 1.1 for time_s, _ in frames(run, SPEED))
    # 64 ms without speed: the controller cuts traction, and leaves it after good telegrams.
    modes = run.trace.raw(NotchCmd.PORT, "CtlMode")
    assert CtlMode.TRACTION_CUT in modes
    assert modes[-1] == CtlMode.RUNNING


def test_the_recorder_keeps_its_time_without_the_clock_port(runs: Runs) -> None:
    run = runs("TRN_SPEED loss @500ms for 1s")
    truth_s = run.trace.times_s("SIM_TRUTH")
    assert np.allclose(np.diff(truth_s), 0.02)


@pytest.mark.slow
def test_the_same_seed_loses_the_same_telegrams(runs: Runs) -> None:
    text = "TRN_SPEED loss 30% @1s for 1s"
    first = runs(text)
    assert runs(text, again=True).frames_sha256 == first.frames_sha256
    assert 15 < first.faults[0].hits < 45
    other = runs(text, seed=1)
    assert [row[0] for row in hits(other)] != [row[0] for row in hits(first)]
    # With a seed of its own the run's seed does not matter.
    own = [[row[0] for row in hits(runs(f"{text} seed 5", seed=seed))] for seed in (0, 1)]
    assert own[0] == own[1]


@pytest.mark.slow
def test_begins_at_a_place_a_speed_and_an_event(runs: Runs) -> None:
    clean = runs(moving=True)
    time_s = clean.trace.times_s("SIM_TRUTH")
    speed, place = (clean.trace.values("SIM_TRUTH", name) for name in ("TrueSpeed", "TruePos"))
    for when, wanted_s in (
        ("@500mm", time_s[np.argmax(place >= 0.5)]),
        ("@v>3.6km/h", time_s[np.argmax(speed >= 1.0)]),
        ("@v<3.6km/h", time_s[np.argmax((speed <= 1.0) & (time_s > 12))]),
        ("@traction", time_s[np.argmax(clean.trace.values("SIM_TRUTH", "TractionForce") > 0)]),
        ("@braking", time_s[np.argmax(clean.trace.values("SIM_TRUTH", "TrueAccel") <= -0.3)]),
        ("@standstill", time_s[np.argmax((speed == 0) & (time_s > 12))]),
    ):
        begun_s = runs(f"TRN_SPEED loss x1 {when}", moving=True).faults[0].begun_s
        assert begun_s is not None, when
        assert 0 < begun_s - wanted_s <= 0.03, when
    departed = clean.trace.values(RunEvent.PORT, "EventTime")[0]
    begun_s = runs("TRN_SPEED loss x1 @departed+300ms", moving=True).faults[0].begun_s
    assert begun_s is not None
    assert 0.3 <= begun_s - departed <= 0.34
    # A level of a watch: traction is cut, and the second one begins.
    second = runs("TRN_SPEED loss @1s for 100ms", "NOTCH_CMD loss x1 @traction_cut").faults[1]
    assert second.begun_s is not None
    assert 1.06 <= second.begun_s <= 1.1


def test_lasts_until_an_event(runs: Runs) -> None:
    run = runs("TRN_SPEED duplicate @1s until standstill", moving=True)
    time_s, speed = run.trace.times_s("SIM_TRUTH"), run.trace.values("SIM_TRUTH", "TrueSpeed")
    assert run.faults[0].ended_s == pytest.approx(time_s[np.argmax((speed == 0) & (time_s > 12))] + 0.01, abs=0.011)


def test_a_delayed_answer_takes_the_place_of_a_later_one(runs: Runs) -> None:
    run = runs("NOTCH_CMD delay 60ms @1s for 500ms")
    empty = [time_s for time_s, frame in frames(run, NOTCH) if not frame.data]
    assert empty == pytest.approx([1.0, 1.02, 1.04])
    # Every poll has one answer.
    assert len(frames(run, NOTCH)) == len(frames(runs(), NOTCH))
    late = dict(frames(run, NOTCH))
    own = dict(frames(runs(), NOTCH))
    assert late[1.2].data[3] & 0xF == own[1.14].data[3] & 0xF
    assert run.counters["plant"]["no_answer"] == run.counters["plant"]["missed_polls"] == 3
    # Afterwards the backlog takes the place of three fresh answers, which are lost.
    assert [row[3] for row in hits(run)].count("lost") == 3


def test_an_answer_that_is_lost_is_said_to_be_none(runs: Runs) -> None:
    run = runs("NOTCH_CMD loss x3 @1s", "CTL_STAT loss x1 @1s")
    counters = run.counters["plant"]
    assert counters["no_answer"] == counters["missed_polls"] == 4
    assert [frame.data for _, frame in frames(run, NOTCH)].count(b"") == 3
    trailer = CtlStat.port().can_ids[-1]
    assert [frame.data for _, frame in frames(run, trailer)].count(b"") == 1
    # It is no telegram that was refused.
    assert "wrong_length" not in counters
    assert sum(outcome.hits for outcome in run.faults) == 4


@pytest.mark.parametrize(
    ("fault", "node", "cause"),
    [
        ("TRN_SPEED.checksum random @1s for 50ms", "controller", "wrong_check_sequence"),
        ("TRN_POS truncate @1s for 50ms", "controller", "wrong_length"),
        ("TRN_SPEED remote @1s for 50ms", "controller", "remote_frame"),
        ("TRN_SPEED masquerade PLT_STAT @1s for 50ms", "supervisor", ""),
        ("NOTCH_CMD masquerade CTL_STAT @1s for 50ms", "plant", "no_answer"),
        ("NOTCH_CMD stuck @1s for 100ms", "gate", "duplicate"),
        ("TRN_SPEED.counter freeze @1s for 50ms", "controller", "duplicate"),
        ("TRN_SPEED replay 80ms @1s for 50ms", "controller", "out_of_order"),
        ("TRN_SPEED.SpeedChk raw 0 @1s for 50ms", "controller", "check_variable"),
    ],
)
def test_a_disturbed_telegram_is_refused_by_its_cause(runs: Runs, fault: str, node: str, cause: str) -> None:
    run = runs(fault)
    assert run.faults[0].hits > 0
    assert not missed_faults(run.faults)
    assert not cause or run.counters[node].get(cause, 0) >= 1, run.counters


@pytest.mark.slow
def test_signals_change_with_the_right_check_sequences(runs: Runs) -> None:
    clean = runs()
    at = slice(100, 105)
    before = clean.trace.values(TrnSpeed.PORT, "TrainSpeed")[at]
    for word, wanted in (
        ("value 1.5", np.full(5, 1.5)),
        ("raw 77", np.full(5, 0.0077)),
        ("offset 0.25", before + 0.25),
        ("scale 2", before * 2),
        ("stuck", np.full(5, before[0])),
        ("value 1e9", np.full(5, ((1 << 23) - 1) * 1e-4)),
    ):
        run = runs(f"TRN_SPEED.TrainSpeed {word} @1s for 50ms")
        assert run.trace.values(TrnSpeed.PORT, "TrainSpeed")[at] == pytest.approx(wanted, abs=2e-4), word
        assert "wrong_check_sequence" not in run.counters["controller"]
    spread = runs("TRN_SPEED.TrainSpeed random @1s for 50ms").trace.values(TrnSpeed.PORT, "TrainSpeed")[at]
    assert np.ptp(spread) > 100
    # A telegram of several frames.
    run = runs("TRN_POS.TrainPos offset 7 @1s for 100ms")
    shifted = run.trace.values(TrnPos.PORT, "TrainPos")[50:55] - clean.trace.values(TrnPos.PORT, "TrainPos")[50:55]
    assert shifted == pytest.approx(np.full(5, 7.0), abs=1e-9)


def test_an_order_by_hand_becomes_a_fault_with_its_instant(runs: Runs, tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML)
    texts = ("TRN_SPEED loss 50% @manual", "NOTCH_CMD loss @manual for 100ms", "CTL_STAT loss @manual")
    scenario = load(path, (), texts)
    spec = RunSpec(str(path))

    class Orders(Observer):
        def on_progress(self, time_s: float) -> None:
            for at_s, number, order in (
                (0.8, 1, FaultOrder.INJECT),
                (1.12, 1, FaultOrder.CLEAR),
                (1.6, 2, FaultOrder.INJECT),
            ):
                if abs(time_s - at_s) < 1e-6:
                    run.session.commands.order(number, order)

    run = LocalRun(local_plan(scenario, spec, tmp_path), Orders())
    run.play()
    first, second, third = fault_outcomes(tmp_path, scenario, spec.seed)
    assert first.text == "TRN_SPEED loss 50% @810ms for 320ms"
    assert second.text == "NOTCH_CMD loss @1.62s for 100ms"
    assert (third.text, third.hits) == ("CTL_STAT loss @manual", 0)
    assert not missed_faults([first, second, third])
    # As plain faults they make the same frames of plant and controller.
    again = runs(first.text, second.text, third.text)
    assert again.log is not None
    contract = wire_contract()
    ours = {contract.port(name).can_ids[-1] for name in ("SUP_CMD", "PLT_IDENT", "CTL_IDENT", "SUP_IDENT")}
    ours |= {can_id for name in ("PLT_IDENT", "CTL_IDENT", "SUP_IDENT") for can_id in contract.port(name).can_ids}
    frames_of = [
        [(time_ns, frame) for time_ns, frame in read_log(log) if frame.can_id not in ours]
        for log in (run.log.path, again.log)
    ]
    assert frames_of[0] == frames_of[1]


def test_a_fault_that_does_nothing_is_named(runs: Runs) -> None:
    run = runs("TRN_SPEED loss @v>100km/h", "BALISE corrupt 0% @1s for 1s", "TRN_POS loss @manual")
    assert missed_faults(run.faults[:1]) == "fault 1 never began: TRN_SPEED loss @v>100km/h"
    assert missed_faults(run.faults[1:2]) == "fault 2 changed nothing: BALISE corrupt 0% @1s for 1s"
    assert not missed_faults(run.faults[2:])


def test_what_cannot_be_injected_is_refused(runs: Runs) -> None:
    for text, said in (
        ("plant kill @1s", "the plant is in the process of all others"),
        ("bus.a open @1s", "only railhil's hub has two lines"),
        ("bus passive @1s", "error counters"),
        ("wall pause 1s @1s", "lockstep has no wall clock"),
        ("SIM_TRUTH loss @1s", "a port of the vehicle"),
        ("NOTCH_CMD masquerade SIM_TRUTH @1s", "a port of the vehicle"),
        ("SUP_CMD loss @1s", "a port of the vehicle"),
    ):
        with pytest.raises(InputError, match=said):
            runs(text)


def test_every_sent_telegram_is_accepted_refused_or_lost(runs: Runs) -> None:
    run = runs("TRN_SPEED loss 20% @500ms for 1s combine", "TRN_SPEED corrupt 20% @500ms for 1s combine")
    sent = len(frames(runs(), SPEED))
    lost = sum(row[1] == "loss" for row in hits(run))
    counters = run.counters["controller"]
    refused = sum(counters.get(cause, 0) for cause in ("wrong_check_sequence", "wrong_master_word"))
    assert len(frames(run, SPEED)) == sent - lost
    assert refused == sum(row[1] == "corrupt" for row in hits(run)) - _lost_after_corruption(run)
    assert math.isfinite(run.score.values["itae"])


def _lost_after_corruption(run: Result) -> int:
    corrupted = {(row[0], row[3]) for row in hits(run) if row[1] == "corrupt"}
    return sum((row[0], row[2]) in corrupted for row in hits(run) if row[1] == "loss")


def test_logs_are_written_where_the_run_is(runs: Runs) -> None:
    run = runs("NOTCH_CMD loss x1 @1s")
    assert run.log is not None
    names = {path.name for path in Path(run.log.parent).glob("faults*")}
    assert names == {"faults-controller.csv", "faults.csv"}
