"""Faults of telegrams, injected in one process: what is on the wire, what the log says, who notices."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.injected import NOTCH, SPEED, Runs, frames, hits, log, runs_with_faults
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import Result
from railhil.bus.codes import FaultOrder
from railhil.bus.injector.controller_side import FaultyController
from railhil.bus.mvb import TelegramSource
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


def test_without_faults_no_injector_is_made(runs: Runs) -> None:
    run = runs()
    assert run.faults == []
    assert run.log is not None
    assert not list(run.log.parent.glob("faults*"))


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


def test_bursts(runs: Runs) -> None:
    times = [round(row[0] * 100) for row in hits(runs("TRN_SPEED loss gemodel 5% 40% @500ms for 3s"))]
    bursts = 1 + sum(later > earlier + 1 for earlier, later in pairwise(times))
    # 300 telegrams: a burst begins after 20 good ones on average and lasts 2.5.
    assert 5 <= bursts <= 25
    assert 1.2 < len(times) / bursts < 5


@pytest.mark.parametrize(
    ("when", "begun_s"),
    [("@1s", 1.0), ("@995ms", 1.0), ("@0s", 0.0), ("@1s+500ms", 1.5), ("@#101", 1.0)],
)
def test_begins_at_an_instant(runs: Runs, when: str, begun_s: float) -> None:
    assert runs(f"TRN_SPEED loss x1 {when}").faults[0].begun_s == begun_s


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


def test_delayed_telegrams_come_later(runs: Runs) -> None:
    clean, run = runs(), runs("TRN_SPEED delay 50ms @1s for 500ms")
    assert len(frames(run, SPEED)) == len(frames(clean, SPEED))
    lives = [frame.data[3] & 0xF for time_s, frame in frames(run, SPEED) if 1.06 <= time_s < 1.45]
    assert all((later - earlier) % 16 == 1 for earlier, later in pairwise(lives))
    dropped = runs("TRN_SPEED delay 50ms @1s for 500ms after drop")
    assert len(frames(dropped, SPEED)) == len(frames(clean, SPEED)) - 5


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


def test_duplicates_are_ignored(runs: Runs) -> None:
    run = runs("TRN_SPEED duplicate copies 2 @1s for 100ms", "NOTCH_CMD duplicate x1 @2s")
    assert len(frames(run, SPEED)) == len(frames(runs(), SPEED)) + 20
    assert run.counters["controller"]["duplicate"] == 20
    assert run.counters["gate"]["duplicate"] == 1


def test_overtaken_telegrams_are_old(runs: Runs) -> None:
    run = runs("TRN_SPEED reorder gap 3 x1 @1s", "NOTCH_CMD reorder gap 2 x1 @2s")
    lives = [frame.data[3] & 0xF for time_s, frame in frames(run, SPEED) if 0.98 < time_s < 1.06]
    first = lives[0]
    assert [(life - first) % 16 for life in lives[:7]] == [0, 2, 3, 4, 1, 5, 6]
    assert run.counters["controller"]["out_of_order"] == 1
    assert run.counters["gate"]["out_of_order"] == 1


def test_corrupt_telegrams_are_refused(runs: Runs) -> None:
    run = runs("TRN_SPEED corrupt bits 3 @1s for 100ms", "NOTCH_CMD corrupt x5 @2s")
    refused = {"wrong_check_sequence", "wrong_master_word"}
    assert sum(run.counters["controller"].get(cause, 0) for cause in refused) == 10
    assert sum(run.counters["plant"].get(cause, 0) for cause in refused) == 5
    for _, _, before, after in hits(run):
        flipped = int(before[4:], 16) ^ int(after[4:], 16)
        assert flipped.bit_count() in (1, 3)


@pytest.mark.parametrize(
    ("fault", "node", "cause"),
    [
        ("TRN_SPEED.checksum random @1s for 50ms", "controller", "wrong_check_sequence"),
        ("TRN_SPEED.checksum freeze @1s for 50ms", "controller", "wrong_check_sequence"),
        ("TRN_SPEED.checksum offset 3 @1s for 50ms", "controller", "wrong_check_sequence"),
        ("TRN_SPEED.checksum value 17 @1s for 50ms", "controller", "wrong_check_sequence"),
        ("TRN_SPEED truncate 4 @1s for 50ms", "controller", "wrong_length"),
        ("TRN_POS truncate @1s for 50ms", "controller", "wrong_length"),
        ("TRN_SPEED remote @1s for 50ms", "controller", "remote_frame"),
        ("TRN_SPEED masquerade PLT_STAT @1s for 50ms", "supervisor", ""),
        ("NOTCH_CMD masquerade CTL_STAT @1s for 50ms", "plant", "no_answer"),
        ("NOTCH_CMD truncate 0 @1s for 50ms", "plant", "no_answer"),
        ("NOTCH_CMD truncate 7 @1s for 50ms", "plant", "wrong_length"),
        ("NOTCH_CMD remote @1s for 50ms", "plant", "no_answer"),
        ("NOTCH_CMD.checksum offset @1s for 50ms", "plant", "wrong_check_sequence"),
        ("TRN_SPEED stuck @1s for 50ms", "controller", "duplicate"),
        ("NOTCH_CMD stuck @1s for 100ms", "gate", "duplicate"),
        ("TRN_SPEED.counter freeze @1s for 50ms", "controller", "duplicate"),
        ("TRN_SPEED.counter offset 10 @1s for 50ms", "controller", "out_of_order"),
        ("NOTCH_CMD.counter value 3 @1s for 100ms", "gate", "duplicate"),
        ("NOTCH_CMD.counter random @1s for 500ms", "gate", "out_of_order"),
        ("TRN_SPEED replay 80ms @1s for 50ms", "controller", "out_of_order"),
        ("NOTCH_CMD replay 160ms @1s for 50ms", "gate", "out_of_order"),
        ("TRN_SPEED.SpeedChk raw 0 @1s for 50ms", "controller", "check_variable"),
    ],
)
def test_a_disturbed_telegram_is_refused_by_its_cause(runs: Runs, fault: str, node: str, cause: str) -> None:
    run = runs(fault)
    assert run.faults[0].hits > 0
    assert not missed_faults(run.faults)
    assert not cause or run.counters[node].get(cause, 0) >= 1, run.counters


def test_the_counter_continues_as_asked_for(runs: Runs) -> None:
    def lives(fault: str) -> list[int]:
        return [frame.data[3] & 0xF for time_s, frame in frames(runs(fault), SPEED) if 0.98 < time_s < 1.06]

    usual = [frame.data[3] & 0xF for time_s, frame in frames(runs(), SPEED) if 0.98 < time_s < 1.06]
    valid = usual[0]
    assert lives("TRN_SPEED.counter value 9 x2 @1s")[3:6] == usual[3:6]
    assert lives("TRN_SPEED.counter value 9 x2 @1s after last_valid")[3:5] == [valid + 1, valid + 2]
    assert lives("TRN_SPEED.counter value 9 x2 @1s after last")[1:5] == [9, 9, 10, 11]


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


def test_a_command_is_changed_where_it_leaves_the_controller(runs: Runs) -> None:
    run = runs("notch value 5 @1s for 100ms")
    sent = run.trace.values(NotchCmd.PORT, "NotchCmd")
    assert (sent[50:55] == 5).all()
    assert run.faults[0].hits == 5


def test_ok_ends_what_is_active(runs: Runs) -> None:
    run = runs("TRN_SPEED loss @1s", "TRN_SPEED ok @1100ms")
    first, order = run.faults
    assert (first.hits, first.ended_s) == (10, 1.1)
    assert order.hits == 1


def test_faults_of_signals_come_before_those_of_the_telegram(runs: Runs) -> None:
    run = runs("TRN_SPEED corrupt @1s x3 combine", "TRN_SPEED.TrainSpeed value 1 @1s x3")
    rows = hits(run)
    assert sorted(row[1] for row in rows) == ["corrupt"] * 3 + ["value"] * 3
    # What is corrupted is the changed telegram.
    changed = {row[3] for row in rows if row[1] == "value"}
    assert {row[2] for row in rows if row[1] == "corrupt"} == changed
    source = TelegramSource(TrnSpeed.port())
    assert all(source.frames(bytes.fromhex(text[4:12]))[0].data.hex().upper() == text[4:] for text in changed)


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


def test_a_distribution_is_drawn_with_the_seed(runs: Runs) -> None:
    text = "TRN_SPEED.TrainSpeed scale uniform(0.5,0.9) @1s for 100ms"
    texts = {runs(text, seed=seed).faults[0].text for seed in (0, 1)}
    assert len(texts) == 2
    for drawn in texts:
        assert 0.5 <= float(drawn.split()[2]) <= 0.9
    # The drawn text makes the same frames of the nodes; only the handshake names another scenario.
    again = runs(runs(text).faults[0].text)
    assert [frame for _, frame in frames(again, SPEED)] == [frame for _, frame in frames(runs(text), SPEED)]


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
