"""Mailboxes read late by a task: in the node, in the loop, and through the real command."""

from __future__ import annotations

import json
from itertools import product

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import local_run
from railhil.bus.codes import Event
from railhil.bus.frame import FD, Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.responder import Responder
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.common.errors import InputError
from railhil.controller_node import node as node_module
from railhil.controller_node.ato.node import ControllerNode
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import CtlMode, CtlStat, NotchCmd, TrkInfo, TrnSpeed

MS = 1_000_000
NOTCH_POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)


def frames_of(telegram: Telegram) -> list[Frame]:
    return TelegramSource(type(telegram).port()).frames(telegram.encode())


def track(number: int) -> TrkInfo:
    """A TRK_INFO that differs in both blocks from others; its limit is above every speed here."""
    return TrkInfo(target_mm=number, speed_limit_4mmps=10_000, target_speed_half_mps=number, life=number % 4)


class Feeder:
    """A node under a task, driven by hand: one TRN_SPEED per tick of 10 ms opens it."""

    def __init__(self, lvshun, task_period_ms: int) -> None:
        self.node = ControllerNode(lvshun, LawSpec(task_period_ms=task_period_ms))
        self.ticks = 0

    def tick(self, *telegrams: Telegram, count: int = 1, speed: bool = True) -> None:
        for _ in range(count):
            if speed:
                # A measured speed is never the same for long: the sensor's noise.
                self.feed(*frames_of(TrnSpeed(50_000 + self.ticks * self.ticks % 11 % 3, life=self.ticks % 16)))
            if self.ticks == 0:
                self.feed(*frames_of(TimeSync()))
            self.ticks += 1
        for telegram in telegrams:
            self.feed(*frames_of(telegram))

    def feed(self, *frames: Frame) -> None:
        for frame in frames:
            assert self.node.handle(frame) == []

    def mode(self) -> CtlMode:
        (answer,) = self.node.handle(NOTCH_POLL)
        return CtlMode(NotchCmd.decode(answer.data[:4]).mode)

    def track(self) -> bytes:
        return self.node.responder.store.raw(TrkInfo.PORT)


@pytest.mark.parametrize("task_ms", [10, 20, 30, 50, 70])
def test_speed_is_as_old_as_the_task_makes_it(lvshun, task_ms):
    """The task reads the newest speed before its instant, one tick old; until the next reading it only ages."""
    feeder = Feeder(lvshun, task_ms)
    for now_ms in range(0, 2000, 10):
        # The track has an age, too.
        feeder.tick(*([] if now_ms % 160 else [track(now_ms // 160)]))
        if now_ms % 20:
            continue
        # Polled on its period from the start: polls and clock frames are compared.
        mode = feeder.mode()
        if now_ms >= 200:
            age_ms = now_ms % task_ms + 10
            if task_ms <= 50:
                assert mode is (CtlMode.HOLD if age_ms > 20 else CtlMode.RUNNING), now_ms
            else:
                assert age_ms <= 64 or mode is CtlMode.TRACTION_CUT
    # The first tick's reading finds nothing; of the frames between two readings the last is kept.
    readings = [tick for tick in range(1, 200) if tick * 10 % task_ms == 0]
    assert feeder.node.lost_by_mailbox["TRN_SPEED"] == 200 - len(readings) - 1


def test_read_at_once_nothing_ages(lvshun):
    feeder = Feeder(lvshun, 0)
    for tick in range(50):
        feeder.tick(track(0))
        assert tick % 2 or feeder.mode() is CtlMode.RUNNING
    assert feeder.node.counters == {}


@pytest.mark.parametrize("lost", list(product((False, True), repeat=3)))
def test_late_telegram_is_one_telegram_or_none(lvshun, lost):
    """Two TRK_INFO come between two readings; any of the second one's frames may be missing."""
    feeder = Feeder(lvshun, 400)
    feeder.tick()
    old, new = track(1), track(2)
    feeder.tick(old, count=10)
    feeder.tick(count=16)
    feeder.feed(*(frame for frame, gone in zip(frames_of(new), lost, strict=True) if not gone))
    assert feeder.track() == b""
    feeder.tick(count=20)
    if all(lost):
        assert feeder.track() == old.encode()
    elif not any(lost):
        assert feeder.track() == new.encode()
    else:
        assert feeder.track() == b""
        assert feeder.node.counters["assembly_timeout"] == 1
    assert sum(feeder.node.lost_by_mailbox[name] for name in ("TRK_INFO.0", "TRK_INFO.1", "TRK_INFO.trailer")) == (
        3 - sum(lost)
    )


def test_telegram_cut_by_the_reading_is_refused_as_a_whole(lvshun):
    """The task comes between block and trailer: neither half is a telegram, nor are the two halves later."""
    feeder = Feeder(lvshun, 50)
    feeder.tick(count=4)
    first, *rest = frames_of(track(5))
    feeder.feed(first)
    feeder.tick(count=2)
    feeder.feed(*rest)
    feeder.tick(count=6)
    assert feeder.track() == b""
    assert feeder.node.counters["assembly_timeout"] == 1
    feeder.tick(track(6))
    feeder.tick(count=6)
    assert feeder.track() == track(6).encode()


def test_same_tick_is_one_instant_for_the_assembly(lvshun):
    """The age of each frame when it is read counts, not the time of reading: 40 ms late is not too slow."""
    feeder = Feeder(lvshun, 50)
    feeder.tick(track(7))
    feeder.tick(count=6)
    assert feeder.track() == track(7).encode()
    _, age_ns = feeder.node.responder.store.read(TrkInfo, feeder.node.responder.clock.now_ns)
    assert age_ns == 60 * MS


def test_time_and_end_of_the_run_do_not_wait_for_the_task(lvshun):
    feeder = Feeder(lvshun, 10_000)
    for life in (1, 2):
        feeder.tick(TimeSync(seconds_s=7, life=life))
    assert feeder.node.responder.clock.now_ns == 7_000 * MS
    feeder.tick(RunEvent(Event.ENDED_COMPLETE), speed=False)
    assert feeder.node.ended is Event.ENDED_COMPLETE


def test_poll_that_opens_the_tick_lets_the_task_run(lvshun):
    """TRN_SPEED fails as a whole: the polls carry time on, and what lies in the mailboxes is read on time."""
    feeder = Feeder(lvshun, 50)
    feeder.tick(count=3)
    feeder.feed(*frames_of(track(9)))
    for _ in range(2):
        feeder.mode()
    assert feeder.track() == b""
    feeder.mode()
    assert feeder.node.responder.clock.now_ns >= 50 * MS
    assert feeder.track() == track(9).encode()


@pytest.fixture(scope="module")
def brief_file(tmp_path_factory):
    """72 m in 24 s."""
    path = tmp_path_factory.mktemp("brief") / "short.toml"
    path.write_text(RUN_72M_TOML)
    return path


@pytest.fixture(scope="module")
def at_50_ms(brief_file, tmp_path_factory):
    run = RunSpec(law=LawSpec(task_period_ms=50), seed=1)
    return local_run(load(brief_file), tmp_path_factory.mktemp("task"), run)


@pytest.mark.slow
def test_mailboxes_read_at_once_change_no_byte_of_the_record(brief_file, tmp_path, monkeypatch):
    """Against the same node with its mailboxes taken out."""
    brief = load(brief_file)
    (tmp_path / "with").mkdir()
    expected = local_run(brief, tmp_path / "with", RunSpec(seed=1)).frames_sha256

    def bare(*arguments, module, **options) -> Responder:
        return Responder(*arguments, **options)

    monkeypatch.setattr(node_module, "Responder", bare)
    without = local_run(brief, tmp_path, RunSpec(seed=1))
    assert "no_mailbox" not in without.counters["controller"]
    assert without.frames_sha256 == expected


@pytest.mark.faults
def test_task_of_50_ms_holds_now_and_then_and_still_arrives(at_50_ms):
    modes = at_50_ms.trace.raw(NotchCmd.PORT, "CtlMode").tolist()
    assert at_50_ms.ended is Event.ENDED_COMPLETE
    # Of the polls at 0, 20, 40, 60, 80 ms three find a speed older than 20 ms.
    assert modes.count(CtlMode.HOLD) / len(modes) == pytest.approx(0.6, abs=0.01)
    assert set(modes) == {CtlMode.INITIALISING, CtlMode.RUNNING, CtlMode.HOLD}
    counters, speeds = at_50_ms.counters["controller"], at_50_ms.trace.count(TrnSpeed.PORT)
    assert counters["lost_messages"] > 0.8 * speeds
    assert counters["gap"] == pytest.approx(speeds / 5, abs=2)
    assert "controller.lost_messages" in at_50_ms.refused


@pytest.mark.slow
@pytest.mark.faults
def test_task_of_400_ms_is_braked_by_the_ladder(lvshun, tmp_path):
    run = local_run(lvshun, tmp_path, RunSpec(law=LawSpec(task_period_ms=400), seed=1))
    modes = run.trace.raw(NotchCmd.PORT, "CtlMode").tolist()
    assert run.ended is Event.ENDED_NOT_STOPPED
    assert {CtlMode.HOLD, CtlMode.TRACTION_CUT, CtlMode.SERVICE_BRAKE} <= set(modes)
    assert max(run.commands("notch")) <= 0
    assert run.score.verdict == "FAIL"
    assert set(run.trace.raw(CtlStat.PORT, "LadderLevel").tolist()) <= {0, 1, 2, 3}


@pytest.mark.long
@pytest.mark.faults
@pytest.mark.slow
@pytest.mark.loop
def test_processes_give_the_record_of_the_loop_without_sockets(at_50_ms, brief_file, tmp_path):
    words = ("--task-period-ms", "50", "--quiet", "--no-report", "--out", tmp_path / "run")
    done = railhil("run", brief_file, "--seed", "1", *words)
    assert done.exit_code in (0, 1), done.err
    found = json.loads((tmp_path / "run" / "certificate.json").read_text(encoding="utf-8"))
    assert found["frames_sha256"] == at_50_ms.frames_sha256
    assert "--task-period-ms 50" in found["command"]


def test_can_fd_has_no_mailboxes(lvshun):
    node = ControllerNode(lvshun, LawSpec(), fd=True)
    for telegram in (TrnSpeed(50_000, life=1), track(3)):
        for frame in TelegramSource(type(telegram).port(), fd=True).frames(telegram.encode()):
            node.handle(frame)
    assert node.responder.store.accepted(TrnSpeed.PORT) == node.responder.store.accepted(TrkInfo.PORT) == 1
    assert node.lost_messages == 0
    assert node.lost_by_mailbox == {}
    with pytest.raises(InputError, match=r"--task-period-ms: found 50, allowed 0 with CAN FD"):
        ControllerNode(lvshun, LawSpec(task_period_ms=50), fd=True)
    classic = ControllerNode(lvshun, LawSpec())
    classic.handle(Frame(TrnSpeed.port().fd_id, bytes(8), FD))
    assert classic.counters == {"no_mailbox": 1}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", "--attach", "--task-period-ms", "50"), "--task-period-ms: found 50, allowed 0 with --attach"),
        (("run", "--task-period-ms", "10001"), "found 10001, allowed 0..10000"),
        (("node", "controller", "--task-period-ms", "1.5"), "found 1.5, allowed 0..10000"),
        (("node", "controller", "-i", "virtual", "-c", "0", "-b", "0"), "--bitrate: found 0, allowed above 0"),
    ],
)
def test_options_that_cannot_be_are_refused(arguments, words, tmp_path):
    done = railhil(*arguments, cwd=tmp_path)
    assert done.exit_code == 2
    assert words in done.err
    assert "Traceback" not in done.err
