"""What the bus administrator publishes is sent early where the link can: order, and nothing twice."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from railhil.bus.administrator import Administrator, SendQueue
from railhil.bus.clock import Pacer
from railhil.bus.frame import Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.packing import unpack_frames
from railhil.bus.store import TrafficStore
from railhil.dbc import wire_contract
from railhil.wire.ato import NotchCmd, TrnPos, TrnSpeed

NOTCH = NotchCmd.port()
POLL = master_frame(NOTCH.f_code, NOTCH.address)


def frames_of(telegram: Telegram) -> list[Frame]:
    return TelegramSource(type(telegram).port()).frames(telegram.encode())


class EarlyLink:
    """A link that can send early: what it sent so, and what else; a poll is answered at once."""

    is_down = False
    is_private = True

    def __init__(self) -> None:
        self.passed: list[Frame] = []
        self.packets: list[list[Frame]] = []
        self.is_open = True

    def send_early(self, frames: Sequence[Frame]) -> bool:
        if self.is_open:
            self.passed += frames
        return self.is_open

    def send(self, frames: Sequence[Frame]) -> None:
        self.packets.append(list(frames))

    def receive(self, timeout_s: float | None) -> list[Frame]:
        return frames_of(NotchCmd(5, life=1))

    def has_ended(self, node: str) -> bool:
        return False

    def is_cut_off(self, node: str) -> bool:
        return False


@pytest.fixture
def link() -> EarlyLink:
    return EarlyLink()


def made(link: EarlyLink, rate: float = 0.0, unread: str = "") -> Administrator:
    contract = wire_contract()
    queue = SendQueue(link, contract, realtime=bool(rate), send_early=link.send_early, unread=unread)
    return Administrator(link, TrafficStore([NOTCH]), queue, lambda: 0, Pacer(rate), contract)


def test_what_was_sent_early_is_not_sent_again_with_the_poll(link: EarlyLink) -> None:
    administrator = made(link)
    administrator.queue.publish(TrnSpeed(1))
    administrator.queue.publish(TrnPos(2))
    assert link.passed == [*frames_of(TrnSpeed(1)), *frames_of(TrnPos(2))]
    assert link.packets == []
    assert administrator.poll(NOTCH)
    assert link.packets == [[POLL]]


def test_what_nobody_reads_goes_with_the_next_telegram_or_poll(link: EarlyLink) -> None:
    administrator, position = made(link, unread=TrnPos.PORT), TelegramSource(TrnPos.port())
    administrator.queue.publish(TrnPos(1))
    assert link.passed == []
    administrator.queue.publish(TrnSpeed(2))
    assert link.passed == [*position.frames(TrnPos(1).encode()), *frames_of(TrnSpeed(2))]
    administrator.queue.publish(TrnPos(3))
    assert administrator.poll(NOTCH)
    assert link.packets == [[*position.frames(TrnPos(3).encode()), POLL]]


def test_nothing_is_sent_when_all_was_sent_early(link: EarlyLink) -> None:
    administrator = made(link)
    administrator.queue.publish(TrnSpeed(1))
    administrator.queue.flush()
    assert link.packets == []


def test_what_cannot_be_sent_early_is_queued_in_order(link: EarlyLink) -> None:
    administrator = made(link)
    link.is_open = False
    administrator.queue.publish(TrnSpeed(1))
    assert link.passed == []
    link.is_open = True
    administrator.queue.publish(TrnPos(2))
    assert link.passed == [*frames_of(TrnSpeed(1)), *frames_of(TrnPos(2))], "what waits goes first"
    link.is_open = False
    administrator.queue.publish(TrnSpeed(3))
    administrator.queue.flush()
    assert link.packets == [frames_of(TrnSpeed(3))]


def test_nothing_is_sent_early_in_real_time(link: EarlyLink) -> None:
    administrator = made(link, rate=1.0)
    administrator.queue.publish(TrnSpeed(1))
    administrator.queue.flush()
    assert (link.passed, link.packets) == ([], [frames_of(TrnSpeed(1))])


class PackedWay:
    """A link for packed frames: what it was given, and what it sent early."""

    is_down = False
    is_private = True

    def __init__(self) -> None:
        self.passed: list[Frame] = []
        self.packets: list[list[Frame]] = []
        self.is_open = True

    def send_early(self, packet: bytes) -> bool:
        if self.is_open:
            self.passed += unpack_frames(packet)
        return self.is_open

    def send_packed(self, packet: bytes) -> None:
        self.packets.append(unpack_frames(packet))

    def receive_packed(self, timeout_s: float | None) -> bytes:
        raise NotImplementedError

    def receive(self, timeout_s: float | None) -> list[Frame]:
        return frames_of(NotchCmd(5, life=1))

    def send(self, frames: Sequence[Frame]) -> None:
        raise NotImplementedError

    def has_ended(self, node: str) -> bool:
        return False

    def is_cut_off(self, node: str) -> bool:
        return False


@pytest.fixture
def packed() -> PackedWay:
    return PackedWay()


def of_packets(link: PackedWay, unread: str = "") -> Administrator:
    contract = wire_contract()
    queue = SendQueue(link, contract, packed=link, unread=unread)
    return Administrator(link, TrafficStore([NOTCH]), queue, lambda: 0, Pacer(), contract)


def test_packed_telegrams_are_sent_early_and_polls_are_sent(packed: PackedWay) -> None:
    administrator, position = of_packets(packed), TelegramSource(TrnPos.port())
    administrator.queue.publish(TrnSpeed(1))
    administrator.queue.publish(TrnPos(2))
    assert packed.passed == [*frames_of(TrnSpeed(1)), *position.frames(TrnPos(2).encode())]
    assert administrator.poll(NOTCH)
    assert packed.packets == [[POLL]]
    packed.is_open = False
    administrator.queue.publish(TrnSpeed(3))
    administrator.queue.publish(TrnPos(4))
    assert administrator.poll(NOTCH)
    expected = [*frames_of(TrnSpeed(3)), *position.frames(TrnPos(4).encode()), POLL]
    assert packed.packets[1:] == [expected]
    administrator.queue.flush()
    assert packed.packets[2:] == [], "nothing twice"


def test_packed_telegrams_that_nobody_reads_wait(packed: PackedWay) -> None:
    administrator, position = of_packets(packed, unread=TrnPos.PORT), TelegramSource(TrnPos.port())
    administrator.queue.publish(TrnPos(1))
    assert packed.passed == []
    administrator.queue.publish(TrnSpeed(2))
    assert packed.passed == [*position.frames(TrnPos(1).encode()), *frames_of(TrnSpeed(2))]


def test_packed_telegrams_are_flushed(packed: PackedWay) -> None:
    administrator = of_packets(packed)
    packed.is_open = False
    administrator.queue.publish(TrnSpeed(1))
    administrator.queue.flush()
    administrator.queue.flush()
    assert packed.packets == [frames_of(TrnSpeed(1))]
