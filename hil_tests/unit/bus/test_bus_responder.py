"""The slave side: which polls are answered, what reaches the mailboxes, and what moves the node's clock."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.bus.clock import to_time_sync
from railhil.bus.frame import ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, master_frame, parse_device_status
from railhil.bus.responder import Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import CtlStat, NotchCmd, SupCmd, TimeSync, TrnPos, TrnSpeed
from railhil.dbc import wire_contract

TICK_NS = 10_000_000
DEVICE = 1


class Node:
    """A responder with two own ports and a list of what it committed."""

    def __init__(self, fd: bool = False) -> None:
        self.made: list[str] = []
        self.committed: list[str] = []
        self.responder = Responder(
            DEVICE,
            Schedule.from_contract(TICK_NS, {}),
            [TrnSpeed.port(), TrnPos.port(), TimeSync.port()],
            {NotchCmd.PORT: self._notch, CtlStat.PORT: self._status},
            fd=fd,
            on_commit=self.committed.append,
        )

    def _notch(self) -> Telegram:
        self.made.append(NotchCmd.PORT)
        return NotchCmd(len(self.made))

    def _status(self) -> Telegram:
        self.made.append(CtlStat.PORT)
        return CtlStat(step_count=len(self.made))

    def feed(self, telegram: Telegram) -> None:
        for frame in TelegramSource(type(telegram).port()).frames(telegram.encode()):
            assert self.responder.handle(frame) == []


def poll(telegram: type[Telegram]) -> Frame:
    return master_frame(telegram.port().f_code, telegram.port().address)


@pytest.mark.parametrize("fd", [False, True])
def test_own_polls_are_answered_with_a_fresh_telegram(fd: bool) -> None:
    node = Node(fd)
    notch, status = TelegramSource(NotchCmd.port(), fd), TelegramSource(CtlStat.port(), fd)
    assert node.responder.handle(poll(NotchCmd)) == notch.frames(NotchCmd(1).encode())
    assert node.responder.handle(poll(NotchCmd)) == notch.frames(NotchCmd(2).encode())
    assert node.responder.handle(poll(CtlStat)) == status.frames(CtlStat(step_count=3).encode())
    assert node.made == ["NOTCH_CMD", "NOTCH_CMD", "CTL_STAT"]


def test_only_own_polls_are_answered() -> None:
    """Every F_code with every address of the port table and its neighbours."""
    own = {(port.f_code, port.address) for port in (NotchCmd.port(), CtlStat.port())}
    addresses = {port.address + step for port in wire_contract().ports for step in (-1, 0, 1, 8)} | {0, 1, 2, 0xFFF}
    node = Node()
    for f_code in range(15):
        for address in sorted(addresses):
            answered = bool(node.responder.handle(master_frame(f_code, address)))
            assert answered == ((f_code, address) in own)
    assert len(node.made) == 2
    assert not node.responder.store.counters


def test_device_status_is_given_for_the_own_address_only() -> None:
    node = Node()
    for device in range(0x1000):
        answers = node.responder.handle(master_frame(15, device))
        if device == DEVICE:
            (frame,) = answers
            assert frame.can_id == 0x088
            assert parse_device_status(frame.data) == (DEVICE, 0x1000)
        else:
            assert answers == []


@given(st.binary(max_size=8))
def test_wrong_master_frames_are_counted_and_not_answered(data: bytes) -> None:
    node = Node()
    right = {poll(NotchCmd).data, poll(CtlStat).data, master_frame(15, DEVICE).data}
    if data in right:
        return
    assert node.responder.handle(Frame(0x080, data)) == []
    foreign = len(data) == 3 and master_frame(data[0] >> 4, (data[0] & 15) << 8 | data[1]).data == data
    assert node.responder.store.counters["wrong_master_word"] == (0 if foreign else 1)


@pytest.mark.parametrize("bit", range(24))
def test_every_bit_of_a_master_frame_counts(bit: int) -> None:
    node = Node()
    frame = poll(NotchCmd)
    data = (int.from_bytes(frame.data) ^ 1 << bit).to_bytes(3)
    assert node.responder.handle(Frame(frame.can_id, data)) == []
    assert node.responder.store.counters == {"wrong_master_word": 1}


@pytest.mark.parametrize(
    ("flags", "cause"),
    [(ERROR, "error_frame"), (REMOTE, "remote_frame"), (EXTENDED, "extended_id"), (FD, "unknown_id")],
)
def test_a_poll_in_a_wrong_kind_of_frame_is_none(flags: int, cause: str) -> None:
    node = Node()
    assert node.responder.handle(poll(NotchCmd)._replace(flags=flags)) == []
    assert node.responder.store.counters == {cause: 1}


def test_on_commit_names_whole_telegrams_in_order() -> None:
    node = Node()
    node.feed(TrnSpeed(5))
    first, trailer = TelegramSource(TrnPos.port()).frames(TrnPos(1).encode())
    node.responder.handle(first)
    assert node.committed == ["TRN_SPEED"]
    node.responder.handle(trailer)
    node.responder.handle(trailer)
    node.feed(SupCmd())
    assert node.committed == ["TRN_SPEED", "TRN_POS"]
    assert node.responder.store.counters == {"missing_block": 1, "unknown_id": 1}


def test_time_is_counted_before_the_telegram_is_stored() -> None:
    node = Node()
    for life in range(5):
        node.feed(TrnSpeed(5, life=life))
    assert node.responder.clock.tick == 4
    assert node.responder.store.read(TrnSpeed, 4 * TICK_NS)[1] == 0
    node.feed(to_time_sync(1280, TICK_NS))
    assert node.responder.clock.tick == 1280
    assert node.responder.store.read(TrnSpeed, node.responder.clock.now_ns)[1] == 1276 * TICK_NS


def test_a_damaged_time_sync_changes_no_time() -> None:
    node = Node()
    node.feed(TrnSpeed(5))
    block, trailer = TelegramSource(TimeSync.port()).frames(to_time_sync(77, TICK_NS).encode())
    node.responder.handle(block._replace(data=bytes([block.data[0] ^ 1]) + block.data[1:]))
    node.responder.handle(trailer)
    assert node.responder.clock.tick == 0
    assert node.responder.store.counters == {"wrong_check_sequence": 1}


def test_time_goes_on_by_the_polls_of_the_fastest_own_port() -> None:
    """TRN_SPEED is gone from tick 101 on; the age of the last one still grows with the polls."""
    node = Node()
    for tick in range(600):
        if tick <= 100:
            node.feed(TrnSpeed(5, life=tick & 15))
        if tick % 16 == 0:
            node.responder.handle(poll(CtlStat))
        if tick % 2 == 0:
            node.responder.handle(poll(NotchCmd))
        if tick > 100:
            assert node.responder.clock.tick == tick - tick % 2
            _, age_ns = node.responder.store.read(TrnSpeed, node.responder.clock.now_ns)
            assert age_ns == (tick - tick % 2 - 100) * TICK_NS


def test_a_slow_port_is_no_clock() -> None:
    """An extra poll of a port with a long period must not be taken for lost time."""
    responder = Responder(2, Schedule.from_contract(TICK_NS, {}), [TrnSpeed.port()], {SupCmd.PORT: lambda: SupCmd(1)})
    responder.handle(TelegramSource(TrnSpeed.port()).frames(TrnSpeed(5).encode())[0])
    for _ in range(5):
        assert responder.handle(poll(SupCmd))
    assert responder.clock.tick == 0
