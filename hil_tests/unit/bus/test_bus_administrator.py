"""Bus administrator on a fake endpoint: order on the bus, waiting, time-outs, and the state after each of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest

from hil_tests.support.clock import SetClock
from hil_tests.support.other_frames import OTHERS
from railhil.bus.administrator import Administrator
from railhil.bus.clock import Pacer
from railhil.bus.errors import PeerSilent
from railhil.bus.frame import ERROR, REMOTE, Frame
from railhil.bus.ident import Role, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, device_status_frame, master_frame
from railhil.bus.schedule import Schedule
from railhil.bus.store import TrafficStore
from railhil.bus.telegrams import CtlStat, NotchCmd, TrnPos, TrnSpeed
from railhil.dbc import wire_contract
from railhil.plant_sim.handshake import agree

NOTCH, STAT = NotchCmd.port(), CtlStat.port()


class FakeEndpoint:
    """Answers come after a delay of wall time; everything sent is kept in order."""

    is_down = False
    is_private = False
    ended = False
    cut_off: tuple[str, ...] = ()

    def __init__(self, wall: SetClock, answer: Callable[[Frame], list[tuple[int, Frame]]] = lambda frame: []) -> None:
        self.sent: list[Frame] = []
        self.batches: list[int] = []
        self.pending: list[tuple[int, Frame]] = []
        self.wall = wall
        self._answer = answer

    def send(self, frames: Sequence[Frame]) -> None:
        self.sent += frames
        self.batches.append(len(frames))
        for frame in frames:
            self.pending += [(self.wall.now_ns + delay_ns, item) for delay_ns, item in self._answer(frame)]
        self.pending.sort(key=lambda entry: entry[0])

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """One frame per call, as python-can's recv gives them."""
        assert timeout_s is not None
        limit_ns = self.wall.now_ns + round(timeout_s * 1e9)
        if self.pending and self.pending[0][0] <= limit_ns:
            due_ns, frame = self.pending.pop(0)
            self.wall.now_ns = max(self.wall.now_ns, due_ns)
            return [frame]
        self.wall.now_ns = limit_ns
        return []

    def has_ended(self, node: str) -> bool:
        return self.ended

    def is_cut_off(self, node: str) -> bool:
        return node in self.cut_off

    def close(self) -> None:
        raise AssertionError("the administrator does not own its endpoint")


def frames_of(telegram: Telegram) -> list[Frame]:
    return TelegramSource(type(telegram).port()).frames(telegram.encode())


@pytest.fixture
def wall() -> SetClock:
    return SetClock()


def make(
    endpoint: FakeEndpoint, rate: float = 0.0, now_ns: int = 0, fd: bool = False
) -> tuple[Administrator, TrafficStore]:
    store = TrafficStore([NOTCH, STAT])
    ports = [TrnSpeed.port(), TrnPos.port()]
    return Administrator(endpoint, store, lambda: now_ns, Pacer(rate, endpoint.wall), ports, fd=fd), store


def controller(delay_ns: int = 1000, notch: int = 5) -> Callable[[Frame], list[tuple[int, Frame]]]:
    """Answers polls of NOTCH_CMD with increasing life sign."""
    life = 0

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        nonlocal life
        if frame != master_frame(NOTCH.f_code, NOTCH.address):
            return []
        life += 1
        return [(delay_ns, item) for item in frames_of(NotchCmd(notch, life=life & 15))]

    return answer


def test_schedule_is_the_port_table_with_the_overrides() -> None:
    schedule = Schedule.from_contract(10_000_000, {"TRN_SPEED": 16_000_000, "NOTCH_CMD": 40_000_000})
    assert schedule.ticks("TIME_SYNC") == 128
    assert schedule.ticks("NOTCH_CMD") == 4
    assert schedule.ticks("TRN_SPEED") == 1
    assert Schedule.from_contract(16_000_000, {}).ticks("TRN_SPEED") == 1
    assert "RUN_EVENT" not in schedule.periods_ns


def test_what_is_published_leaves_in_order_and_before_the_poll(wall: SetClock) -> None:
    endpoint = FakeEndpoint(wall, controller())
    administrator, store = make(endpoint, now_ns=70)
    administrator.publish(TrnSpeed(1))
    administrator.publish(TrnPos(2))
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
    administrator.flush()
    assert endpoint.batches == []
    administrator.publish(TrnSpeed(1))
    administrator.flush()
    administrator.flush()
    assert endpoint.sent == TelegramSource(TrnSpeed.port(), True).frames(TrnSpeed(1).encode())
    assert endpoint.batches == [1]


def test_what_a_signal_broke_off_is_not_sent_again(wall: SetClock) -> None:
    """The run's last event follows after it; a repeated TIME_SYNC before that would count as a bus fault."""

    def broken_off(frame: Frame) -> list[tuple[int, Frame]]:
        raise KeyboardInterrupt

    endpoint = FakeEndpoint(wall, broken_off)
    administrator, _ = make(endpoint)
    administrator.publish(TrnSpeed(1))
    with pytest.raises(KeyboardInterrupt):
        administrator.poll(NOTCH)
    administrator.publish(TrnPos(2))
    with pytest.raises(KeyboardInterrupt):
        administrator.flush()
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


def test_find_devices_asks_until_all_have_answered(wall: SetClock) -> None:
    asked: list[Frame] = []

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        asked.append(frame)
        device = frame.data[1]
        if device == 1:
            return [(1000, device_status_frame(1, 0x1000)), (1000, device_status_frame(9, 0x1000))]
        # The second device is there after 0.35 s; before, it babbles.
        ready = wall.now_ns > 350_000_000
        return [(2000, device_status_frame(2, 0x1000))] if ready else [(2000, Frame(0x088, bytes(8)))]

    administrator, _ = make(FakeEndpoint(wall, answer))
    assert administrator.find_devices((1, 2), 5_000_000_000) == set()
    # Then it listens for late answers, and for a second one to a poll of each device: 30 ms each time.
    assert wall.now_ns == 400_002_000 + 3 * 30_000_000 + 3_000
    first, second = master_frame(15, 1), master_frame(15, 2)
    assert asked == [first, *[second] * 5, first, second]


def test_on_a_private_bus_nobody_else_is_looked_for(wall: SetClock) -> None:
    """Two quiet times less before the first frame. A node that comes late answers every poll, and none of its answers
    reaches the run."""

    class Private(FakeEndpoint):
        is_private = True

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        # The second device is there after 0.25 s.
        device = frame.data[1]
        ready_ns = 0 if device == 1 else 250_000_000
        return [(max(1000, ready_ns - wall.now_ns), device_status_frame(device, 0x1000))]

    endpoint = Private(wall, answer)
    administrator, _ = make(endpoint)
    assert administrator.find_devices((1, 2), 5_000_000_000) == set()
    assert wall.now_ns == 250_000_000
    assert endpoint.pending == []
    assert len(endpoint.sent) == 4


def test_on_a_private_bus_a_missing_answer_is_not_waited_for_long(wall: SetClock) -> None:
    class Private(FakeEndpoint):
        is_private = True

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        # The first of two polls is lost.
        return [(1000, device_status_frame(1, 0x1000))] if wall.now_ns else []

    administrator, _ = make(Private(wall, answer))
    assert administrator.find_devices((1,), 5_000_000_000) == set()
    assert wall.now_ns == 100_001_000 + 1_000_000_000


def test_find_devices_names_those_that_did_not_answer(wall: SetClock) -> None:
    administrator, _ = make(FakeEndpoint(wall, lambda frame: [(0, device_status_frame(1, 0x1000))]))
    assert administrator.find_devices((1, 2, 3), 1_000_000_000) == {2, 3}
    assert wall.now_ns == 1_000_000_000
    assert wire_contract().device_status_id == 0x088


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda data: data[:7], "wrong length, 7 bytes instead of 8"),
        (lambda data: data[:4] + bytes([data[4] ^ 1]) + data[5:], "wrong check sequence"),
        (lambda data: data[:5] + master_frame(1, 1).data, "wrong master word"),
    ],
)
def test_a_device_status_that_is_refused_is_not_silence(
    wall: SetClock, change: Callable[[bytes], bytes], reason: str
) -> None:
    good = device_status_frame(1, 0x1000)
    answer = good._replace(data=change(good.data))
    administrator, store = make(FakeEndpoint(wall, lambda frame: [(0, answer)]))
    contract = wire_contract()
    with pytest.raises(PeerSilent) as caught:
        agree(administrator, store, make_ident(Role.PLANT, "0" * 64), contract, 0.3)
    # Two nodes are asked three times.
    expected = f"no good answer within 0.3 s, refused on identifier 088: 6 times {reason}"
    assert str(caught.value) == f"bus administrator waits for controller and supervisor: {expected}"


def test_silence_is_called_so(wall: SetClock) -> None:
    administrator, store = make(FakeEndpoint(wall))
    with pytest.raises(PeerSilent, match=r"waits for controller and supervisor: no answer within 0\.3 s$"):
        agree(administrator, store, make_ident(Role.PLANT, "0" * 64), wire_contract(), 0.3)


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


def test_a_device_status_that_is_not_ours_is_no_answer(wall: SetClock) -> None:
    """Extended, remote and FD frames on its identifier, and on that of the polls: nobody is there, and nobody polls."""
    administrator, _ = make(FakeEndpoint(wall, lambda frame: [(10, other) for other in OTHERS]))
    assert administrator.find_devices([1], 10_000_000) == {1}
