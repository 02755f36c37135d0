"""An interface that returns a node's own frames to it, like python-can's ``udp_multicast``; without any network."""

from __future__ import annotations

from collections import deque
from typing import Any

import can
import pytest

from railhil.bus.administrator import Administrator, SendQueue
from railhil.bus.clock import Pacer
from railhil.bus.errors import BusOccupied
from railhil.bus.frame import Frame, from_message, to_message
from railhil.bus.ident import Role
from railhil.bus.link import Link, open_link
from railhil.bus.link.single import EchoLink
from railhil.bus.mvb import device_status_frame, master_frame
from railhil.bus.store import TrafficStore
from railhil.dbc import wire_contract
from railhil.wire.ato import NotchCmd, TrnSpeed

POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
SPEED = Frame(TrnSpeed.port().can_ids[0], bytes(8))


class UdpMulticastBus(can.BusABC):
    """A member of a group in memory: whatever one sends comes to all, the sender included, and nobody says whose it is.

    :param answers: to a frame, by a node that shares the group.
    """

    channel_info = "a group"

    def __init__(self, group: list[UdpMulticastBus], answers: dict[Frame, Frame] | None = None) -> None:
        self.inbox: deque[can.Message] = deque()
        self._group = group
        self._answers = answers or {}
        group.append(self)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        for member in self._group:
            member.inbox.append(msg)
        if answer := self._answers.get(from_message(msg)):
            for member in self._group:
                member.inbox.append(to_message(answer))

    def recv(self, timeout: float | None = None) -> can.Message | None:
        return self.inbox.popleft() if self.inbox else None

    def shutdown(self) -> None:
        self._is_shutdown = True


def two_links() -> tuple[EchoLink, EchoLink]:
    group: list[UdpMulticastBus] = []
    return EchoLink(UdpMulticastBus(group)), EchoLink(UdpMulticastBus(group))


def administrator_on(link: Link) -> Administrator:
    contract = wire_contract()
    return Administrator(link, TrafficStore([]), SendQueue(link, contract), lambda: 0, Pacer(), contract)


def test_the_link_is_chosen_by_the_interface(monkeypatch: pytest.MonkeyPatch) -> None:
    def opened(**config: Any) -> UdpMulticastBus:
        del config
        return UdpMulticastBus([])

    monkeypatch.setattr(can, "Bus", opened)
    assert isinstance(open_link({"interface": "udp_multicast"}), EchoLink)


def test_own_frames_do_not_reach_the_node_and_those_of_others_do() -> None:
    ours, theirs = two_links()
    ours.send([POLL, SPEED])
    assert (theirs.receive(0.0), theirs.receive(0.0)) == ([POLL], [SPEED])
    theirs.send([SPEED])
    # Behind two of its own, and equal to one of them.
    assert ours.receive(0.0) == [SPEED]
    assert ours.receive(0.0) == theirs.receive(0.0) == []
    assert (ours.counters["received"], theirs.counters["received"]) == (1, 2)


def test_own_frames_that_are_lost_on_the_way_take_no_room() -> None:
    group: list[UdpMulticastBus] = []
    bus = UdpMulticastBus(group)
    link = EchoLink(bus)
    for number in range(5000):
        link.send([Frame(0x118, number.to_bytes(8, "big"))])
    bus.inbox.clear()
    assert len(link._own) < 5000
    UdpMulticastBus(group).send(can.Message(arbitration_id=0x118, data=bytes(8), is_extended_id=False))
    assert link.receive(0.0) == [Frame(0x118, bytes(8))]


def test_a_bus_administrator_does_not_take_itself_for_another() -> None:
    role = Role.CONTROLLER
    link = EchoLink(UdpMulticastBus([], {master_frame(15, role): device_status_frame(role, 0x1000)}))
    assert administrator_on(link).find_devices((role,), 1_000_000_000) == set()


def test_but_another_one_is_noticed() -> None:
    """Its polls are equal to the own ones, and one too many."""
    ours, theirs = two_links()
    theirs.send([master_frame(15, Role.CONTROLLER)])
    with pytest.raises(BusOccupied, match="another bus administrator"):
        administrator_on(ours).find_devices((Role.CONTROLLER,), 1_000_000_000)


@pytest.mark.parametrize("way", ["variable", "command line"])
def test_a_switch_for_own_frames_is_off_for_a_node_and_said(
    way: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Else the administrator takes its own poll for that of another one."""
    config: dict[str, Any] = {"interface": "virtual", "channel": "echoing"}
    if way == "variable":
        monkeypatch.setenv("CAN_CONFIG", '{"receive_own_messages": true}')
    else:
        config["receive_own_messages"] = True
    link = open_link(config, "plant")
    link.send([POLL])
    assert link.receive(0.02) == []
    assert administrator_on(link).find_devices((Role.CONTROLLER,), 1_000_000) == {Role.CONTROLLER}
    link.close()
    assert "plant: receive_own_messages is set for this bus, and switched off" in capfd.readouterr().err
