"""An interface that fails and comes back: what a link drops, keeps, reports and counts, and the node's time
meanwhile."""

from __future__ import annotations

import errno
import time
from collections.abc import Callable

import can
import pytest

from railhil.bus.clock import BusClock, rate_to_10th, to_time_sync
from railhil.bus.errors import BusLost, BusOccupied
from railhil.bus.frame import ERROR, Frame, from_message, to_message
from railhil.bus.ident import Role
from railhil.bus.link.base import Timeouts
from railhil.bus.link.errorframe import describe
from railhil.bus.link.single import SingleLink
from railhil.bus.local import LocalBus
from railhil.bus.mvb import F_DEVICE_STATUS, TelegramSource, device_status_frame, master_frame
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.node import make_plant_node
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.wire.ato import TrnSpeed, WatchLevel

_TICK_NS = 10_000_000
_BUS_OFF = Frame(0x40, bytes(8), ERROR)
_RESTARTED = Frame(0x100, bytes(8), ERROR)


class Adapter:
    """An interface that is plugged in or not, and every bus opened on it."""

    def __init__(self) -> None:
        self.plugged = True
        #: So many frames it refuses for want of room.
        self.full = 0
        #: It cannot even be closed.
        self.dead = False
        #: So many times it is looked at before it is plugged in again.
        self.looks = 0
        self.sent: list[Frame] = []
        self.waiting: list[Frame | Exception] = []
        self.opened = 0

    def open(self) -> can.BusABC:
        self.looks -= 1
        if self.looks == 0:
            self.plugged = True
        if not self.plugged:
            raise can.CanInitializationError("no such port")
        self.opened += 1
        return AdapterBus(self)


class AdapterBus(can.BusABC):
    channel_info = "adapter"

    def __init__(self, adapter: Adapter) -> None:
        self.adapter = adapter
        self.flushed = 0

    def _check(self) -> None:
        if not self.adapter.plugged:
            raise can.CanOperationError("Input/output error", errno.EIO)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        self._check()
        if self.adapter.full:
            self.adapter.full -= 1
            raise can.CanOperationError("Failed to transmit", errno.ENOBUFS)
        self.adapter.sent.append(from_message(msg))

    def recv(self, timeout: float | None = None) -> can.Message | None:
        self._check()
        if not self.adapter.waiting:
            return None
        item = self.adapter.waiting.pop(0)
        if isinstance(item, Exception):
            raise item
        return to_message(item)

    def flush(self) -> None:
        self.flushed += 1

    def shutdown(self) -> None:
        self._is_shutdown = True
        if self.adapter.dead:
            raise can.CanOperationError("Could not write to serial device")


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def adapter() -> Adapter:
    return Adapter()


@pytest.fixture
def link(adapter: Adapter, said: list[str]) -> SingleLink:
    return SingleLink(adapter.open(), adapter.open, said.append, timeouts=Timeouts(look_again_s=0.01))


def speeds(*values: int) -> list[Frame]:
    source = TelegramSource(TrnSpeed.port())
    return [source.frames(TrnSpeed(value, life=value % 16).encode())[0] for value in values]


def until(condition: Callable[[], bool], link: SingleLink) -> None:
    """Receive until it holds, at most two seconds of looks."""
    for _ in range(200):
        link.receive(0.01)
        if condition():
            return
    raise AssertionError("it never came to that")


def test_an_unplugged_adapter_is_waited_for_and_nothing_stale_is_sent(link, adapter, said):
    link.send(speeds(1))
    adapter.plugged = False
    link.send(speeds(2))
    assert link.is_down
    assert link.receive(0.0) == []
    link.send(speeds(3))
    adapter.plugged = True
    until(lambda: not link.is_down, link)
    link.send(speeds(4))
    assert adapter.sent == speeds(1, 4)
    assert adapter.opened == 2
    assert (link.counters["sent"], link.counters["send_dropped"], link.counters["outages"]) == (2, 2, 1)
    assert [line.split(" (")[0].split(" after")[0] for line in said] == ["adapter is down", "adapter is back"]


def test_in_lockstep_the_very_frame_waits_for_the_adapter(link, adapter):
    link.lossless = True
    adapter.plugged = False
    adapter.looks = 4
    link.send(speeds(1, 2))
    assert adapter.sent == speeds(1, 2)
    assert adapter.looks == 0
    assert link.counters["send_dropped"] == 0


@pytest.mark.parametrize("lossless", [False, True])
def test_an_adapter_that_never_comes_back_ends_the_node(adapter, lossless):
    timeouts = Timeouts(look_again_s=0.01, give_up_s=0.05)
    link = SingleLink(adapter.open(), adapter.open, timeouts=timeouts)
    link.lossless = lossless
    adapter.plugged = False
    with pytest.raises(BusLost, match=r"^adapter: Input/output error.*; not back within"):  # noqa: PT012
        for _ in range(100):
            link.send(speeds(1))
            link.receive(0.01)


def test_the_time_without_frames_is_told_once_with_the_first_frame(link, adapter):
    adapter.waiting = speeds(1)
    assert link.receive(0.0) == speeds(1)
    assert link.take_gap_ns() == 0
    adapter.plugged = False
    link.receive(0.0)
    adapter.plugged = True
    until(lambda: not link.is_down, link)
    assert link.take_gap_ns() == 0
    adapter.waiting = speeds(2)
    assert link.receive(0.0) == speeds(2)
    assert link.take_gap_ns() >= 10_000_000
    assert link.take_gap_ns() == 0


def test_a_full_queue_drops_the_old_value_and_in_lockstep_waits(adapter):
    link = SingleLink(adapter.open(), adapter.open, timeouts=Timeouts(queue_full_s=0.001))
    adapter.full = 10_000
    link.send(speeds(1))
    assert link.counters["send_dropped"] == 1
    adapter.full = 99
    link.lossless = True
    link.send(speeds(2))
    assert (adapter.sent, adapter.full) == (speeds(2), 0)


def test_bus_off_is_silence_until_the_restart(link, adapter, said):
    adapter.waiting = [_BUS_OFF]
    assert link.receive(0.0) == [_BUS_OFF]
    assert link.is_down
    link.send(speeds(1))
    assert adapter.sent == []
    adapter.waiting = [_RESTARTED]
    until(lambda: not link.is_down, link)
    link.send(speeds(2))
    assert adapter.sent == speeds(2)
    assert (link.counters["bus_off"], link.counters["error_frames"], link.counters["send_dropped"]) == (1, 2, 1)
    assert adapter.opened == 1
    assert "bus-off" in said[0]


def test_bus_off_is_a_gap_too(link, adapter):
    adapter.waiting = speeds(1)
    link.receive(0.0)
    adapter.waiting = [_BUS_OFF]
    link.receive(0.0)
    time.sleep(0.05)
    adapter.waiting = [_RESTARTED]
    until(lambda: not link.is_down, link)
    assert link.take_gap_ns() == 0
    adapter.waiting = speeds(2)
    link.receive(0.0)
    assert link.take_gap_ns() >= 50_000_000


def test_a_dead_adapter_is_closed_without_a_word(link, adapter, said):
    adapter.dead = True
    link.close()
    assert said == []


def test_a_wait_in_lockstep_can_be_ended(link, adapter):
    def stop() -> None:
        raise KeyboardInterrupt

    link.lossless = True
    link.while_waiting = stop
    adapter.plugged = False
    with pytest.raises(KeyboardInterrupt):
        link.send(speeds(1))


def test_in_lockstep_what_comes_while_a_frame_waits_out_bus_off_is_kept(link, adapter):
    adapter.waiting = [_BUS_OFF]
    link.receive(0.0)
    adapter.waiting = [_RESTARTED, *speeds(5)]
    link.lossless = True
    link.send(speeds(1))
    assert adapter.sent == speeds(1)
    assert [frame for _ in range(3) for frame in link.receive(0.0)] == [_RESTARTED, *speeds(5)]


def test_a_serial_line_may_say_anything(link, adapter):
    adapter.waiting = [
        ValueError("invalid literal"),
        IndexError("string index"),
        UnicodeDecodeError("a", b"", 0, 1, ""),
    ]
    for _ in range(3):
        assert link.receive(0.0) == []
    assert link.counters["garbage"] == 3
    assert link.bus.flushed == 3
    assert not link.is_down


def test_error_frames_in_words():
    assert describe(Frame(0x04, b"\0\x20", ERROR)) == "controller problem (transmit error-passive)"
    assert describe(Frame(0x88, bytes(8), ERROR)) == "protocol violation bus error"
    assert describe(Frame(0x10000, bytes(8), ERROR)) == "class 0x10000"


# -- time during an outage --------------------------------------------------------------------------------------------


def clock_at(tick: int, rate_10th: int) -> BusClock:
    clock = BusClock(_TICK_NS, 1)
    clock.feed(speeds(tick % 16)[0].data)
    for life in range(2):
        clock.synchronise(to_time_sync(tick, _TICK_NS, rate_10th=rate_10th, life=life))
    clock.feed(speeds((tick + 1) % 16)[0].data)
    return clock


@pytest.mark.parametrize("ticks_out", [20, 50, 200, 1003])
@pytest.mark.parametrize("error_ticks", [-6, 0, 6])
def test_after_an_outage_the_clock_is_right_at_once(ticks_out, error_ticks):
    """Life signs count to 16 only: without the length of the outage the clock would be whole turns behind."""
    clock = clock_at(100, rate_10th=10)
    before = clock.tick
    clock.silence((ticks_out + error_ticks) * _TICK_NS)
    for later in range(ticks_out, ticks_out + 20):
        clock.feed(speeds((before + later) % 16)[0].data)
    assert clock.tick == before + ticks_out + 19


def test_in_lockstep_an_outage_takes_no_time():
    clock = clock_at(100, rate_10th=0)
    before = clock.tick
    clock.silence(2_000_000_000)
    assert clock.tick == before


@pytest.mark.parametrize("rate", [0.01, 0.05, 0.1, 1.0, 25.4, 25.6, 1000.0])
def test_only_lockstep_is_lockstep_to_a_controller(lvshun, rate):
    """Whatever the telegram can hold: a realtime answer that met a full queue would wait for ever."""
    node = ControllerNode(lvshun, LawSpec())
    node.handle(speeds(0)[0])
    for life, (pace, lockstep) in enumerate(((0.0, True), (rate, False))):
        node.responder.clock.synchronise(to_time_sync(0, _TICK_NS, rate_10th=rate_to_10th(pace), life=life))
        assert node.lockstep is lockstep


@pytest.mark.parametrize(("rate", "ticks"), [(0.01, 20), (0.1, 20), (20.0, 4000), (25.5, 5100), (1000.0, 5100)])
def test_an_outage_beyond_the_ends_of_the_telegram_is_reckoned_by_the_end(rate, ticks):
    clock = clock_at(100, rate_to_10th(rate))
    before = clock.tick
    clock.silence(2_000_000_000)
    assert clock.tick == before + ticks


@pytest.mark.parametrize(
    ("out_s", "level"),
    [
        (0.03, WatchLevel.HOLD),
        (0.1, WatchLevel.TRACTION_CUT),
        (0.5, WatchLevel.SERVICE_BRAKE),
        (2.0, WatchLevel.EMERGENCY),
    ],
)
def test_after_an_outage_the_watch_knows_how_old_the_speed_was(lvshun, out_s, level):
    node = ControllerNode(lvshun, LawSpec())
    telegrams = speeds(*range(1, 40))
    node.handle(telegrams[0])
    node.responder.clock.synchronise(to_time_sync(0, _TICK_NS, rate_10th=10))
    for frame in telegrams[1:]:
        node.handle(frame)
    assert node.guard.level is WatchLevel.NORMAL
    node.was_out(round(out_s * 1e9))
    assert node.guard.level is level


# -- one bench at a time ----------------------------------------------------------------------------------------------


def test_a_plant_refuses_a_bus_with_another_administrator(lvshun):
    stranger = master_frame(1, 0x110)
    node = make_plant_node(
        lvshun, RunSpec(), LocalBus([lambda frame: [stranger] if frame.can_id == 0x80 else []]), appear_s=1.0
    )
    with pytest.raises(BusOccupied, match="another bus administrator"):
        node.run()


def test_a_plant_refuses_two_controllers_on_its_bus(lvshun):
    one, other = (ControllerNode(lvshun, LawSpec()) for _ in range(2))
    supervisor = [device_status_frame(Role.SUPERVISOR, 0x1000)]
    asked = master_frame(F_DEVICE_STATUS, Role.SUPERVISOR)
    bus = LocalBus([one.handle, other.handle, lambda frame: supervisor if frame == asked else []])
    node = make_plant_node(lvshun, RunSpec(), bus, appear_s=1.0)
    with pytest.raises(BusOccupied, match=r"two nodes answer as device 1 \(controller\)"):
        node.run()
