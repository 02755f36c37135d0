"""Bus administrator on a fake endpoint: order on the bus, waiting, time-outs, and the state after each of them."""

from __future__ import annotations

import pytest

from hil_tests.support.administrator import NOTCH, STAT, FakeEndpoint, controller, frames_of, make
from hil_tests.support.clock import SetClock
from hil_tests.support.other_frames import OTHERS
from railhil.bus.errors import PeerSilent
from railhil.bus.frame import ERROR, REMOTE, Frame
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.schedule import Schedule
from railhil.dbc import wire_contract
from railhil.wire.ato import CtlStat, NotchCmd, TrnPos, TrnSpeed


@pytest.fixture
def wall() -> SetClock:
    return SetClock()


def test_schedule_is_the_port_table_with_the_overrides() -> None:
    schedule = Schedule.from_contract(10_000_000, {"TRN_SPEED": 16_000_000, "NOTCH_CMD": 40_000_000}, wire_contract())
    assert schedule.ticks("TIME_SYNC") == 128
    assert schedule.ticks("NOTCH_CMD") == 4
    assert schedule.ticks("TRN_SPEED") == 1
    assert Schedule.from_contract(16_000_000, {}, wire_contract()).ticks("TRN_SPEED") == 1
    assert "RUN_EVENT" not in schedule.periods_ns


def test_what_is_published_leaves_in_order_and_before_the_poll(wall: SetClock) -> None:
    endpoint = FakeEndpoint(wall, controller())
    administrator, store = make(endpoint, now_ns=70)
    administrator.queue.publish(TrnSpeed(1))
    administrator.queue.publish(TrnPos(2))
    assert endpoint.sent == []
    assert administrator.poll(NOTCH)
    expected = [*frames_of(TrnSpeed(1)), *frames_of(TrnPos(2)), master_frame(NOTCH.f_code, NOTCH.address)]
    assert endpoint.sent == expected
    assert endpoint.batches == [4]
    telegram, age_ns = store.read(NotchCmd, 100)
    assert telegram is not None
    assert (telegram.notch_256th, age_ns) == (5, 30)
    assert administrator.counters == {"polls": 1}


def test_flush_sends_once_and_nothing_when_there_is_nothing(wall: SetClock) -> None:
    endpoint = FakeEndpoint(wall)
    administrator, _ = make(endpoint, fd=True)
    administrator.queue.flush()
    assert endpoint.batches == []
    administrator.queue.publish(TrnSpeed(1))
    administrator.queue.flush()
    administrator.queue.flush()
    assert endpoint.sent == TelegramSource(TrnSpeed.port(), True).frames(TrnSpeed(1).encode())
    assert endpoint.batches == [1]


def test_what_a_signal_broke_off_is_not_sent_again(wall: SetClock) -> None:
    """The run's last event follows after it; a repeated TIME_SYNC before that would count as a bus fault."""

    def broken_off(frame: Frame) -> list[tuple[int, Frame]]:
        raise KeyboardInterrupt

    endpoint = FakeEndpoint(wall, broken_off)
    administrator, _ = make(endpoint)
    administrator.queue.publish(TrnSpeed(1))
    with pytest.raises(KeyboardInterrupt):
        administrator.poll(NOTCH)
    administrator.queue.publish(TrnPos(2))
    with pytest.raises(KeyboardInterrupt):
        administrator.queue.flush()
    assert endpoint.batches == [2, len(frames_of(TrnPos(2)))]
    assert endpoint.sent[2:] == frames_of(TrnPos(2))


def test_lockstep_waits_for_an_answer_of_two_frames_among_foreign_ones(wall: SetClock) -> None:
    block, second, trailer = frames_of(CtlStat(step_count=9))
    noise = [Frame(0x7FF, b"\1"), Frame(0x138, b"", ERROR), Frame(0x13C, bytes(8), REMOTE), *frames_of(NotchCmd(1))]
    parts = [block, noise[0], noise[1], second, noise[2], noise[3], trailer]
    endpoint = FakeEndpoint(wall, lambda frame: [(1000 * k, item) for k, item in enumerate(parts)])
    administrator, store = make(endpoint)
    assert administrator.poll(STAT)
    telegram, _ = store.read(CtlStat, 0)
    assert telegram is not None
    assert telegram.step_count == 9
    assert store.accepted("NOTCH_CMD") == 1
    assert store.counters == {"unknown_id": 1, "error_frame": 1, "remote_frame": 1}


def test_lockstep_watchdog_says_who_waits_for_whom(wall: SetClock) -> None:
    endpoint = FakeEndpoint(wall)
    administrator, _ = make(endpoint, now_ns=12_340_000_000)
    expected = r"^bus administrator waits for controller \(NOTCH_CMD\), for 60 s, at simulation time 12\.34 s$"
    with pytest.raises(PeerSilent, match=expected):
        administrator.poll(NOTCH)
    # And one more look.
    assert wall.now_ns == 60_100_000_000
    assert administrator.counters == {"polls": 1, "missed_polls": 1}


def test_lockstep_waits_for_a_peer_that_stands_still(wall: SetClock) -> None:
    """Starved on a loaded machine, not dead: its answer counts, and no poll was missed."""
    administrator, store = make(FakeEndpoint(wall, controller(delay_ns=59_000_000_000)))
    assert administrator.poll(NOTCH)
    assert store.accepted("NOTCH_CMD") == 1
    assert administrator.counters == {"polls": 1}


@pytest.mark.parametrize("answered", [False, True])
def test_lockstep_does_not_wait_for_a_peer_that_has_ended(wall: SetClock, answered: bool) -> None:
    """But takes the answer that was still on its way."""
    endpoint = FakeEndpoint(wall, controller(delay_ns=150_000_000) if answered else lambda frame: [])
    endpoint.ended = True
    administrator, _ = make(endpoint, now_ns=12_340_000_000)
    if answered:
        assert administrator.poll(NOTCH)
        return
    expected = r"waits for controller \(NOTCH_CMD\), which has ended, at simulation time 12\.34 s$"
    with pytest.raises(PeerSilent, match=expected):
        administrator.poll(NOTCH)
    assert wall.now_ns == 200_000_000


@pytest.mark.parametrize("rate", [0.0, 1.0])
def test_an_answer_that_a_fault_holds_back_is_a_missed_telegram(wall: SetClock, rate: float) -> None:
    """In lockstep, too, where the bus says that none can come: simulated time goes on."""
    endpoint = FakeEndpoint(wall)
    endpoint.cut_off = ("supervisor", "controller")
    administrator, _ = make(endpoint, rate=rate)
    assert administrator.poll(NOTCH) is False
    assert administrator.counters == {"polls": 1, "missed_polls": 1}


def test_lockstep_takes_the_answer_that_lies_there_after_this_process_stood_still(wall: SetClock) -> None:
    """Stopped between two looks (a paused container, a debugger): the controller has answered in time."""

    class Stopped(FakeEndpoint):
        def receive(self, timeout_s: float | None) -> list[Frame]:
            frames = super().receive(timeout_s)
            wall.now_ns += 10_000_000_000
            return frames

    answer = frames_of(NotchCmd(5, life=1))[0]
    administrator, store = make(Stopped(wall, lambda frame: [(0, Frame(0x7, b"")), (0, answer)]))
    assert administrator.poll(NOTCH)
    assert store.accepted("NOTCH_CMD") == 1


@pytest.mark.parametrize("rate", [0.0, 1.0])
@pytest.mark.parametrize("byte", range(8))
def test_a_damaged_answer_is_a_missed_telegram_at_once(wall: SetClock, rate: float, byte: int) -> None:
    """In lockstep too: the answer has come, so nobody is silent, and time goes on."""
    (frame,) = frames_of(NotchCmd(3))
    data = bytearray(frame.data)
    data[byte] ^= 0x10
    endpoint = FakeEndpoint(wall, lambda poll: [(1000, frame._replace(data=bytes(data)))])
    administrator, store = make(endpoint, rate)
    assert not administrator.poll(NOTCH)
    assert wall.now_ns == 1000
    assert store.accepted("NOTCH_CMD") == 0
    assert administrator.counters == {"polls": 1, "missed_polls": 1}


def test_realtime_gives_up_after_the_reply_time_out(wall: SetClock) -> None:
    administrator, _ = make(FakeEndpoint(wall), rate=1.0)
    assert not administrator.poll(NOTCH)
    assert wall.now_ns == 5_000_000
    assert administrator.counters == {"polls": 1, "missed_polls": 1}


@pytest.mark.parametrize(("delay_ns", "in_time"), [(4_999_999, True), (5_000_001, False), (19_000_000, False)])
def test_a_late_answer_is_never_taken_for_the_next_one(wall: SetClock, delay_ns: int, in_time: bool) -> None:
    """One late answer must not make every later one a poll old, and it does not refresh the age."""
    slow, fast = controller(delay_ns, notch=111), controller(1000, notch=222)
    endpoint = FakeEndpoint(wall, lambda frame: slow(frame) if len(endpoint.sent) == 1 else fast(frame))
    administrator, store = make(endpoint, rate=1.0)
    assert administrator.poll(NOTCH) == in_time
    for k in range(1, 4):
        wall.now_ns = k * 20_000_000
        assert administrator.poll(NOTCH)
        telegram, _ = store.read(NotchCmd, 0)
        assert telegram is not None
        assert telegram.notch_256th == 222
        assert wall.now_ns == k * 20_000_000 + 1000
    assert administrator.counters["late_frames"] == (0 if in_time else 1)
    assert store.accepted("NOTCH_CMD") == 3 + in_time


def test_a_flooded_bus_does_not_stop_the_administrator(wall: SetClock) -> None:
    """Frames without end, each 50 us of wall time: every poll still ends at its time-out."""

    class Flood(FakeEndpoint):
        def receive(self, timeout_s: float | None) -> list[Frame]:
            wall.now_ns += 50_000
            return [Frame(0x7FF, b"")]

    administrator, _ = make(Flood(wall), rate=1.0)
    assert not administrator.poll(NOTCH)
    assert wall.now_ns <= 11_000_000


def test_in_lockstep_nobody_is_silent_while_the_own_interface_is_out(wall: SetClock) -> None:
    """Patience begins anew when it is back."""

    class Out(FakeEndpoint):
        @property
        def is_down(self) -> bool:
            return wall.now_ns < 5_000_000_000

    administrator, _ = make(Out(wall))
    with pytest.raises(PeerSilent):
        administrator.poll(NotchCmd.port())
    assert 64_000_000_000 <= wall.now_ns <= 66_000_000_000


def test_a_source_that_does_not_answer_says_so(wall: SetClock) -> None:
    """An empty frame on the last identifier: a missed poll at once, no refused telegram."""
    endpoint = FakeEndpoint(wall, lambda frame: [(1000, Frame(STAT.can_ids[-1], b""))])
    administrator, store = make(endpoint)
    assert not administrator.poll(STAT)
    assert administrator.counters == {"polls": 1, "no_answer": 1, "missed_polls": 1}
    assert not store.counters
    # A remote frame without data is none of ours.
    endpoint = FakeEndpoint(wall, lambda frame: [(1000, Frame(NOTCH.can_ids[-1], b"", REMOTE)), *controller()(frame)])
    administrator, store = make(endpoint)
    assert administrator.poll(NOTCH)
    assert store.counters == {"remote_frame": 1}


def test_frames_that_only_have_our_identifiers_are_no_answers(wall: SetClock) -> None:
    answers = controller()

    def with_others(frame: Frame) -> list[tuple[int, Frame]]:
        found = answers(frame)
        return [*((10, other) for other in OTHERS), *found] if found else []

    administrator, store = make(FakeEndpoint(wall, with_others))
    assert administrator.poll(NOTCH)
    assert store.accepted(NOTCH.name) == 1
    assert (administrator.counters["no_answer"], administrator.counters["missed_polls"]) == (0, 0)
