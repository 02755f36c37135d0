"""The slave side: which polls are answered, what reaches the mailboxes, and what moves the node's clock."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.bus import clock, store
from railhil.bus.clock import to_time_sync
from railhil.bus.frame import ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, check_sequence, master_frame, parse_device_status, single_frame_fault
from railhil.bus.responder import Reading, Responder
from railhil.bus.schedule import Schedule
from railhil.bus.store import NEVER_NS
from railhil.bus.telegrams import SupCmd, TimeSync
from railhil.dbc import wire_contract
from railhil.wire.ato import CtlStat, NotchCmd, TrnPos, TrnSpeed

TICK_NS = 10_000_000
DEVICE = 1


class Node:
    """A responder with two own ports and a list of what it has read."""

    def __init__(self, fd: bool = False) -> None:
        self.made: list[str] = []
        self.read: list[Reading[Any]] = []
        self.responder = Responder(
            DEVICE,
            Schedule.from_contract(TICK_NS, {}, wire_contract()),
            [TrnSpeed.port(), TrnPos.port(), TimeSync.port()],
            {NotchCmd.PORT: self._notch, CtlStat.PORT: self._status},
            fd=fd,
            contract=wire_contract(),
        )
        for telegram in (TrnSpeed, TrnPos):
            self.responder.on(telegram, lambda reading: self.read.append(reading))

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


@pytest.mark.parametrize("begins", [False, True])
def test_the_polls_of_its_fastest_port_begin_the_time_of_a_node_that_asks_for_it(begins: bool) -> None:
    answers = {NotchCmd.PORT: NotchCmd, CtlStat.PORT: CtlStat}
    schedule = Schedule.from_contract(TICK_NS, {}, wire_contract())
    node = Responder(DEVICE, schedule, [TrnSpeed.port()], answers, contract=wire_contract(), begins=begins)
    node.handle(poll(CtlStat))
    assert not node.clock.running
    for _ in range(3):
        node.handle(poll(NotchCmd))
    assert (node.clock.running, node.clock.tick) == (begins, 4 if begins else 0)


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


def test_a_port_may_have_several_handlers() -> None:
    """Each gets every telegram, in the order in which they came; the clock keeps its own."""
    node = Node()
    seen: list[tuple[str, int]] = []
    node.responder.on(TimeSync, lambda reading: seen.append(("first", node.responder.clock.tick)))
    node.responder.on(TimeSync, lambda reading: seen.append(("second", reading.telegram.life)))
    node.feed(to_time_sync(7, TICK_NS, life=5))
    assert seen == [("first", 7), ("second", 5)]


def test_handlers_get_whole_telegrams_in_order() -> None:
    node = Node()
    node.feed(TrnSpeed(5))
    first, trailer = TelegramSource(TrnPos.port()).frames(TrnPos(1).encode())
    node.responder.handle(first)
    assert node.read == [Reading(TrnSpeed(5), 0, None)]
    node.responder.handle(trailer)
    node.responder.handle(trailer)
    node.feed(SupCmd())
    assert node.read == [Reading(TrnSpeed(5), 0, None), Reading(TrnPos(1), 0, None)]
    assert node.responder.store.counters == {"missing_block": 1, "unknown_id": 1}


def test_time_is_counted_before_the_telegram_is_stored() -> None:
    node = Node()
    for life in range(5):
        node.feed(TrnSpeed(5, life=life))
    assert node.responder.clock.tick == 4
    assert node.responder.store.read(TrnSpeed, 4 * TICK_NS)[1] == 0
    for life in range(2):
        node.feed(to_time_sync(1280, TICK_NS, life=life))
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
    responder = Responder(
        2,
        Schedule.from_contract(TICK_NS, {}, wire_contract()),
        [TrnSpeed.port()],
        {SupCmd.PORT: lambda: SupCmd(1)},
        contract=wire_contract(),
    )
    responder.handle(TelegramSource(TrnSpeed.port()).frames(TrnSpeed(5).encode())[0])
    for _ in range(5):
        assert responder.handle(poll(SupCmd))
    assert responder.clock.tick == 0


def test_ports_of_one_layout_have_each_its_own_mailbox_and_handler() -> None:
    """Two units: one telegram class, two ports; the same telegram on the one is none of the other."""
    units = [replace(TrnSpeed.port(), name=f"TRN_SPEED_{unit}", address=0x300 + 8 * unit) for unit in (1, 2)]
    responder = Responder(
        DEVICE,
        Schedule.from_contract(TICK_NS, {}, wire_contract()),
        [TrnSpeed.port(), *units],
        {},
        contract=wire_contract(),
    )
    read: dict[str, list[int]] = {port.name: [] for port in units}
    for port in units:
        responder.on(
            TrnSpeed, lambda reading, own=read[port.name]: own.append(reading.telegram.speed_01mmps), port.name
        )
    for port, speed_01mmps in zip(units, (11, 22), strict=True):
        for frame in TelegramSource(port).frames(TrnSpeed(speed_01mmps, life=3).encode()):
            responder.handle(frame)
    assert read == {"TRN_SPEED_1": [11], "TRN_SPEED_2": [22]}
    assert responder.store.read(TrnSpeed, 7, "TRN_SPEED_2") == (TrnSpeed(22, life=3), 7)
    assert responder.store.read(TrnSpeed, 7) == (None, NEVER_NS)
    assert not responder.clock.running
    with pytest.raises(KeyError, match="TRN_SPEED_3"):
        responder.on(TrnSpeed, print, "TRN_SPEED_3")


def test_a_check_sequence_is_computed_once_for_a_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also of the clock port, whose frames two take: the store and the clock."""
    blocks: list[bytes] = []

    def single(payload: bytes, data_bytes: int, tail: bytes) -> str:
        blocks.append(payload[:data_bytes])
        return single_frame_fault(payload, data_bytes, tail)

    monkeypatch.setattr(store, "check_sequence", lambda block: blocks.append(block) or check_sequence(block))
    monkeypatch.setattr(store, "single_frame_fault", single)
    node = Node()
    node.feed(TrnSpeed(5, life=1))
    node.feed(TrnPos(7))
    assert blocks == [TrnSpeed(5, life=1).encode(), TrnPos(7).encode()]
    assert not hasattr(clock, "check_sequence")
