"""The whole loop in one process with a faulty bus: the reactions of both watches, and consistent counters."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.bench import Result, local_run
from railhil.bus.codes import Event
from railhil.bus.frame import ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.store import CAUSES
from railhil.dbc import wire_contract
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlMode, NotchCmd, SimTruth, TrnSpeed, WatchLevel

SPEED_ID = TrnSpeed.port().address
#: When the losses begin; from tick LOSS_TICK + 16 on, the tick of a TIME_SYNC is lost first.
LOSS_S = 60
LOSS_TICK = LOSS_S * 100


@pytest.fixture(scope="module")
def clean(short: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Result:
    return local_run(short, tmp_path_factory.mktemp("clean"))


def notch_table(run: Result) -> tuple[Any, Any, Any]:
    """Times in s, modes and notch codes of all NOTCH_CMD telegrams."""
    raw = run.trace.raw
    return run.trace.times_s(NotchCmd.PORT), raw(NotchCmd.PORT, "CtlMode"), raw(NotchCmd.PORT, "NotchCmd")


def assert_no_traction_when_cut(run: Result, train: list[tuple[WatchLevel, float]] | None = None) -> None:
    """Neither watch lets traction through at TRACTION_CUT and above."""
    _, modes, codes = notch_table(run)
    cut = (modes >= CtlMode.TRACTION_CUT) & (modes <= CtlMode.EMERGENCY)
    assert (codes[cut] <= 0).all()
    for level, traction_n in train or ():
        assert level < WatchLevel.TRACTION_CUT or traction_n == 0


class SpeedFault:
    """Does something to the TRN_SPEED telegrams from tick ``first`` on; counts them as the plant sends them."""

    def __init__(self, fault: Callable[[int, Frame], list[Frame]], first: int = LOSS_TICK) -> None:
        self.sent = 0
        self.passed = 0
        self._fault = fault
        self._first = first

    def __call__(self, frame: Frame) -> list[Frame]:
        if frame.can_id != SPEED_ID or frame.flags:
            return [frame]
        tick = self.sent
        self.sent += 1
        frames = self._fault(tick - self._first, frame) if tick >= self._first else [frame]
        self.passed += len(frames)
        return frames


def lose(count: int) -> Callable[[int, Frame], list[Frame]]:
    return lambda since, frame: [] if since < count else [frame]


# -- loss -------------------------------------------------------------------------------------------------------------


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize(
    ("count", "first", "worst"),
    [
        (1, LOSS_TICK + 1, CtlMode.RUNNING),
        (4, LOSS_TICK, CtlMode.HOLD),
        (20, LOSS_TICK + 1, CtlMode.TRACTION_CUT),
    ],
)
def test_burst_loss_of_speed(
    short: Scenario, clean: Result, tmp_path: Path, count: int, first: int, worst: CtlMode
) -> None:
    wire = SpeedFault(lose(count), first)
    run = local_run(short, tmp_path, wire=wire)
    times_s, modes, _ = notch_table(run)
    during = (times_s * 100 >= first) & (times_s * 100 < first + count + 10)
    assert modes[during].max() == worst
    assert set(modes[~during]) == {CtlMode.RUNNING}
    assert_no_traction_when_cut(run)
    if worst is CtlMode.TRACTION_CUT:
        entered_s = times_s[during][modes[during] == worst][0]
        assert entered_s - first / 100 <= 0.07 + 1e-9
        # Five good telegrams end it, and the answer to the next poll says so.
        left_s = times_s[during][modes[during] == worst][-1] + 0.02
        assert left_s == pytest.approx((first + count + 5) / 100, abs=0.021)
    # The clock lost nothing: the law ran in every control period, the stop is where it was.
    assert run.ended is Event.ENDED_COMPLETE
    assert run.score.values["stop_error_m"] == pytest.approx(clean.score.values["stop_error_m"], abs=0.05)
    assert run.refused == {"controller.gap": 1} if count < 20 else set(run.refused) <= {"controller.gap"}
    assert wire.sent == wire.passed + count


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("first", [LOSS_TICK, LOSS_TICK + 1, LOSS_TICK + 16])
def test_permanent_loss_of_speed_stops_the_train_on_the_ladder(
    lvshun: Scenario, tmp_path: Path, train: list[tuple[WatchLevel, float]], first: int
) -> None:
    run = local_run(lvshun, tmp_path, wire=SpeedFault(lose(10**9), first))
    times_s, modes, codes = notch_table(run)
    bounds_s = {CtlMode.TRACTION_CUT: 0.07, CtlMode.SERVICE_BRAKE: 0.27, CtlMode.EMERGENCY: 1.02}
    for mode, bound_s in bounds_s.items():
        entered_s = times_s[modes >= mode][0] - first / 100
        assert 0 < entered_s <= bound_s + 1e-9, mode
    assert (np.diff(modes[times_s * 100 >= first - 1].astype(int)) >= 0).all()
    assert codes[-1] == -7 * 256
    assert run.ended is Event.ENDED_COMPLETE
    assert_no_traction_when_cut(run, train)
    assert run.trace.raw(SimTruth.PORT, "TrueSpeed")[-1] == 0


# -- frames that are repeated, exchanged, damaged or not ours ---------------------------------------------------------


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.faults
def test_flipped_bits_are_refused_and_the_run_stays_healthy(short: Scenario, clean: Result, tmp_path: Path) -> None:
    """One to three bits in 1 % of all frames to the controller, polls excepted (without its poll nobody answers)."""
    draw = random.Random(11)
    flipped: Counter[int] = Counter()
    mailboxes = {TrnSpeed.PORT, "TRN_POS", "TIME_SYNC", "PLT_STAT", "TRK_INFO"}
    known = {can_id: port.name for port in wire_contract().ports for can_id in port.can_ids if port.name in mailboxes}

    def wire(frame: Frame) -> list[Frame]:
        if frame.can_id not in known or draw.random() >= 0.01:
            return [frame]
        word = int.from_bytes(frame.data)
        for bit in draw.sample(range(64), draw.randint(1, 3)):
            word ^= 1 << bit
        flipped[frame.can_id] += 1
        return [frame._replace(data=word.to_bytes(8))]

    run = local_run(short, tmp_path, wire=wire)
    refused = run.refused
    assert flipped[SPEED_ID] > 30
    # Each damaged TRN_SPEED leaves one gap, except that two in a row leave one together.
    assert flipped[SPEED_ID] * 0.9 <= refused["controller.gap"] <= flipped[SPEED_ID]
    causes = {f"controller.{cause}" for cause in (*CAUSES, "gap")}
    assert set(refused) <= causes
    # Nothing passed unseen: what was not refused was a bit that means nothing (sequence, unused check octets).
    in_store = sum(count for cause, count in refused.items() if cause != "controller.gap")
    assert flipped[SPEED_ID] <= in_store <= flipped.total()
    assert run.ended is Event.ENDED_COMPLETE
    assert set(notch_table(run)[1]) <= {CtlMode.RUNNING, CtlMode.HOLD}
    assert run.score.values["stop_error_m"] == pytest.approx(clean.score.values["stop_error_m"], abs=0.05)


def random_frame(draw: random.Random, ids: list[int]) -> Frame:
    flags = draw.choice([0, 0, 0, 0, REMOTE, ERROR, EXTENDED, FD, FD | EXTENDED])
    size = draw.choice([0, 3, 7, 8, 8, 8, 8, 12, 64])
    return Frame(draw.choice(ids) if draw.random() < 0.7 else draw.randrange(0x800), draw.randbytes(size), flags)


@pytest.mark.long
@pytest.mark.faults
def test_a_hundred_thousand_random_frames_change_nothing(short: Scenario, clean: Result, tmp_path: Path) -> None:
    """Every kind of frame on every identifier of the bench, between the right ones, except inside a telegram."""
    draw = random.Random(5)
    own = [can_id for port in wire_contract().ports for can_id in (*port.can_ids, port.fd_id)]
    # A random data frame on a block's identifier replaces that block, as on any bus: the blocks are left out here.
    blocks = {can_id for port in wire_contract().ports if not port.single_frame for can_id in port.can_ids}
    ids = [*(can_id for can_id in own if can_id not in blocks), 0x080, 0x088]
    noise = [frame for frame in (random_frame(draw, ids) for _ in range(130_000)) if frame.can_id not in blocks]
    fed: Counter[str] = Counter()
    per_frame = 12

    def wire(frame: Frame) -> list[Frame]:
        count = min(per_frame, len(noise))
        fed["noise"] += count
        return [*(noise.pop() for _ in range(count)), frame]

    run = local_run(short, tmp_path, wire=wire)
    assert fed["noise"] >= 100_000
    assert run.frames_sha256 == clean.frames_sha256
    counted = sum(run.counters["controller"].values()) - sum(clean.counters["controller"].values())
    # Every frame is in exactly one counter; polls that nobody here has to answer are in none.
    assert fed["noise"] - counted <= 5
    assert set(run.refused) <= {f"controller.{cause}" for cause in CAUSES}
