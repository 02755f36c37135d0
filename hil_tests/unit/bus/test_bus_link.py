"""A node's connection: the edge to python-can, full queues, lost interfaces, batch and single path."""

from __future__ import annotations

import errno
from collections import Counter
from collections.abc import Iterator
from typing import Any

import can
import pytest
from hypothesis import given

from hil_tests.support.clock import SetClock
from hil_tests.support.frames import frames
from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import ERROR, EXTENDED, REMOTE, Frame, from_message, to_message
from railhil.bus.hub.link import BatchLink
from railhil.bus.link import Link, open_link
from railhil.bus.link.single import SingleLink
from railhil.bus.mvb import TelegramSource
from railhil.wire.ato import TrkInfo, TrnSpeed

# -- frames and messages ----------------------------------------------------------------------------------------------


@given(frames())
def test_frame_to_message_and_back(frame: Frame) -> None:
    message = to_message(frame, 12.5)
    message._check()
    assert from_message(message) == frame
    assert (message.timestamp, message.dlc) == (12.5, len(frame.data))


def test_remote_frame_keeps_the_length_that_it_asks_for() -> None:
    message = can.Message(arbitration_id=0x118, is_extended_id=False, is_remote_frame=True, dlc=5)
    frame = from_message(message)
    assert frame == Frame(0x118, bytes(5), REMOTE)
    assert to_message(frame).equals(message, timestamp_delta=None, check_channel=False)
    assert not to_message(frame).data


# -- sending ----------------------------------------------------------------------------------------------------------


class FullBus(can.BusABC):
    """An interface whose transmit queue is full for the next ``full`` attempts."""

    channel_info = "full bus"

    def __init__(self, full: int = 0, error: Exception | None = None) -> None:
        self.full = full
        self.error = error
        self.attempts = 0
        self.taken: list[Frame] = []

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        self.attempts += 1
        if self.full > 0:
            self.full -= 1
            raise self.error or can.CanOperationError("Failed to transmit", errno.ENOBUFS)
        self.taken.append(from_message(msg))

    def recv(self, timeout: float | None = None) -> can.Message | None:
        raise self.error or can.CanOperationError("interface down")

    def shutdown(self) -> None:
        self._is_shutdown = True


@pytest.fixture
def wall() -> SetClock:
    return SetClock()


def speeds(*values: int) -> list[Frame]:
    return [TelegramSource(TrnSpeed.port()).frames(TrnSpeed(value).encode())[0] for value in values]


@pytest.mark.parametrize("full", [0, 1, 39])
def test_a_full_queue_is_retried(wall: SetClock, full: int) -> None:
    bus = FullBus(full)
    link = SingleLink(bus, wall=wall)
    link.send(speeds(1))
    assert bus.taken == speeds(1)
    assert link.counters["send_retries"] == full
    assert (link.counters["sent"], link.counters["send_dropped"]) == (1, 0)
    assert wall.monotonic() == pytest.approx(full * 0.0005)


def test_the_retry_is_bounded_and_leaves_no_backlog(wall: SetClock) -> None:
    """After the bound the old value is given up: what leaves later is the newest, once."""
    bus = FullBus(1000)
    link = SingleLink(bus, wall=wall)
    link.send(speeds(1))
    assert bus.taken == []
    assert wall.monotonic() == pytest.approx(0.02, abs=0.001)
    bus.full = 0
    link.send(speeds(2))
    assert bus.taken == speeds(2)
    assert (link.counters["sent"], link.counters["send_dropped"]) == (1, 1)


def test_all_frames_of_one_send_share_the_bound(wall: SetClock) -> None:
    """A tick of eight frames on a bus without a second node must not take eight times as long."""
    link = SingleLink(FullBus(1000), wall=wall)
    link.send(speeds(*range(8)))
    assert link.counters["send_dropped"] == 8
    assert wall.monotonic() == pytest.approx(0.02, abs=0.001)


def test_enobufs_is_recognised_by_its_cause_too(wall: SetClock) -> None:
    error = can.CanOperationError("Failed to transmit")
    error.__cause__ = OSError(errno.ENOBUFS, "No buffer space available")
    bus = FullBus(2, error)
    SingleLink(bus, wall=wall).send(speeds(1))
    assert bus.taken == speeds(1)


@pytest.mark.parametrize(
    "error", [can.CanOperationError("down", errno.ENETDOWN), can.CanError("gone"), OSError(errno.ENODEV, "no device")]
)
def test_any_other_error_is_a_lost_bus(wall: SetClock, error: Exception) -> None:
    link = SingleLink(FullBus(1, error), wall=wall)
    with pytest.raises(BusLost, match=r"^full bus: cannot send: "):
        link.send(speeds(1))
    with pytest.raises(BusLost, match=r"^full bus: cannot receive: "):
        link.receive(0.0)
    assert wall.slept_s == []


# -- batch and single path --------------------------------------------------------------------------------------------


class Batched:
    """The batch calls of the hub's interface on top of any python-can bus."""

    notices = None

    def __init__(self, bus: can.BusABC) -> None:
        self.bus = bus
        self.channel_info = bus.channel_info

    def send_frames(self, items: list[Frame]) -> None:
        for item in items:
            self.bus.send(to_message(item))

    def offer_frames(self, items: list[Frame]) -> int:
        self.send_frames(items)
        return len(items)

    def recv_frames(self, timeout_s: float | None) -> list[Frame]:
        found: list[Frame] = []
        while (message := self.bus.recv(0 if found else timeout_s)) is not None:
            found.append(from_message(message))
        return found

    def order(self, order: object) -> None:
        raise AssertionError(f"{order}: without notices nothing is ordered")

    def has_left(self, role: str) -> bool:
        return False

    def is_here(self, role: str) -> bool:
        return False

    def shutdown(self) -> None:
        self.bus.shutdown()


@pytest.fixture
def virtual() -> Iterator[list[Any]]:
    """Two ends of python-can's in-process bus."""
    ends = [can.Bus(interface="virtual", channel="railhil-link-test", preserve_timestamps=True) for _ in range(2)]
    yield ends
    for end in ends:
        end.shutdown()


def received(link: Link) -> list[Frame]:
    found: list[Frame] = []
    while batch := link.receive(0.0):
        found += batch
    return found


@pytest.mark.parametrize("batch_send", [False, True])
@pytest.mark.parametrize("batch_receive", [False, True])
def test_both_paths_carry_the_same_frames(virtual: list[Any], batch_send: bool, batch_receive: bool) -> None:
    sender: Link = BatchLink(Batched(virtual[0])) if batch_send else SingleLink(virtual[0])  # type: ignore[arg-type]
    receiver: Link = BatchLink(Batched(virtual[1])) if batch_receive else SingleLink(virtual[1])  # type: ignore[arg-type]
    sent = [
        *speeds(1, 2),
        *TelegramSource(TrkInfo.port()).frames(TrkInfo(7).encode()),
        *TelegramSource(TrkInfo.port(), True).frames(TrkInfo(7).encode()),
        Frame(0x123, bytes(3), REMOTE),
        Frame(0x1ABCDEF, b"\1", EXTENDED),
        Frame(0, b"", ERROR),
        Frame(0x7FF, b""),
    ]
    sender.send(sent)
    assert received(receiver) == sent
    assert received(sender) == []
    assert sender.counters["sent"] == len(sent)
    errors = 0 if batch_receive else 1
    assert +receiver.counters == +Counter({"received": len(sent), "error_frames": errors})


def test_receive_waits_no_longer_than_told(virtual: list[Any]) -> None:
    assert SingleLink(virtual[0]).receive(0.001) == []


def test_a_closed_interface_is_a_lost_bus(virtual: list[Any]) -> None:
    link = SingleLink(virtual[0])
    link.close()
    with pytest.raises(BusLost, match="cannot send"):
        link.send(speeds(1))
    with pytest.raises(BusLost, match="cannot receive"):
        link.receive(0.0)


@pytest.mark.parametrize(
    ("config", "where"),
    [
        ({"interface": "nonsense", "channel": "x"}, "nonsense:x"),
        ({"interface": "socketcan", "channel": "nocan77"}, "socketcan:nocan77"),
        (
            {"interface": "railhil", "channel": "/nowhere/hub.sock", "connect_timeout": 0.2},
            "railhil:/nowhere/hub.sock",
        ),
    ],
)
def test_what_cannot_be_opened_is_one_line(config: dict[str, Any], where: str) -> None:
    with pytest.raises(BusUnavailable, match=r"^bus .* cannot be opened: .+$") as caught:
        open_link(config)
    assert where in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_kernel_without_can_points_to_a_way_to_get_one(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**config: Any) -> can.BusABC:
        del config
        raise OSError(errno.EAFNOSUPPORT, "Address family not supported by protocol")

    monkeypatch.setattr(can, "Bus", refuse)
    with pytest.raises(BusUnavailable, match=r"this kernel has no CAN .*railhil vcan -- "):
        open_link({"interface": "socketcan", "channel": "can7"})
