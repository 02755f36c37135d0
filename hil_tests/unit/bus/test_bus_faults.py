"""Faults of the bus as orders to the hub, without a hub."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from hil_tests.support.scripted import Scripted
from railhil.bus.frame import REMOTE, Frame
from railhil.bus.hub.disturbances import Host, Order
from railhil.bus.injector.bus_faults import BusFaults, need_orders
from railhil.bus.injector.node_faults import NodeFaults
from railhil.bus.link import errorframe
from railhil.bus.mvb import master_frame
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import SupCmd
from railhil.dbc import wire_contract
from railhil.faults.language import parse
from railhil.faults.model import Injection, Random
from railhil.wire.ato import NotchCmd

POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
OTHER = Frame(0x100, bytes(8))


class Told:
    """Takes orders; the test sets ``host``."""

    def __init__(self) -> None:
        self.host = Host()
        self.cut_off = ""
        self.orders: list[Order] = []

    def is_cut_off(self, node: str) -> bool:
        return node == self.cut_off

    def order(self, order: Order) -> None:
        self.orders.append(order)

    def take(self) -> list[Order]:
        found, self.orders = self.orders, []
        return found


class Bus:
    """The bus faults of a run, instant by instant."""

    def __init__(self, *texts: str, samples: Callable[[int], Random] = np.random.default_rng) -> None:
        faults = tuple(map(parse, texts))
        injection = Injection(faults, samples)
        contract = wire_contract()
        schedule = Schedule.from_contract(10_000_000, {}, contract)
        self.node = NodeFaults(injection, contract, schedule, "plant")
        self.hub = Told()
        found = BusFaults.of(self.node, self.hub, contract)
        assert found is not None
        self.faults = found

    def at(self, time_s: float) -> list[Order]:
        """The orders of an instant."""
        self.node.activities.look(round(time_s * 1e9), 0.0, 0.0)
        self.faults.instant()
        return self.hub.take()

    def said(self) -> list[tuple[int, str, str]]:
        return [(hit.fault, hit.before, hit.after) for hit in self.node.activities.log.hits]


@pytest.mark.parametrize(
    ("text", "needed"),
    [
        ("bus error_frames @1s", True),
        ("bus passive @1s", True),
        ("bus.b loose @1s", True),
        ("bus off @1s", False),
        ("bus load @1s", False),
        ("bus.a ok @1s", False),
        ("TRN_SPEED loss @1s", False),
    ],
)
def test_only_these_need_a_hub_that_takes_orders(text: str, needed: bool) -> None:
    assert need_orders([parse(text)]) is needed


def test_error_passive_is_held_and_left_at_both_nodes_and_counts_when_it_is_reached() -> None:
    bus = Bus("bus passive @1s for 1s")
    assert bus.at(0.99) == []
    assert bus.at(1.0) == [Order("passive", "plant"), Order("passive", "controller")]
    assert bus.at(1.01) == bus.said() == []
    bus.hub.host = Host(state="error-passive", tec=128)
    bus.faults.heard([])
    bus.faults.heard([])
    assert bus.said() == [(1, "error-active", "error-passive, TEC 128, REC 0")]
    assert bus.at(2.0) == [Order("passive", "plant", on=False), Order("passive", "controller", on=False)]


@pytest.mark.parametrize(
    ("what", "clients"), [("open", ["controller"]), ("short", ["controller", "plant", "supervisor"])]
)
def test_a_line_is_dead_for_the_time_of_the_fault_and_a_switch_over_counts(what: str, clients: list[str]) -> None:
    bus = Bus(f"bus.a {what} @1s for 1s")
    assert bus.at(1.0) == [Order("line", who, line="A") for who in clients]
    assert bus.at(1.01) == []
    bus.hub.host = Host(line="B", switch_overs=1)
    bus.faults.heard([])
    assert bus.said() == [(1, "line A", "line B")]
    assert bus.at(2.0) == [Order("line", who, line="A", on=False) for who in clients]


def test_without_any_line_the_newest_fault_keeps_each_answer_away() -> None:
    bus = Bus("bus.b open @1s", "bus.a open @2s for 1s")
    bus.at(1.0)
    bus.at(2.0)
    for _ in range(2):
        bus.faults.sending([POLL])
        bus.faults.heard([])
        bus.hub.cut_off = "controller"
        bus.faults.heard([])
        bus.faults.heard([])
    assert bus.said() == [(2, "answer", "cut off")] * 2


def test_a_loose_contact_comes_and_goes_with_the_instants() -> None:
    bus = Bus("bus.b loose 50% @0s")
    orders = [order for tick in range(100) for order in bus.at(tick / 100)]
    assert {(order.who, order.line) for order in orders} == {("controller", "B")}
    assert 30 < len(orders) < 70
    assert [order.on for order in orders[:4]] == [True, False, True, False]


def test_each_frame_of_plant_and_controller_is_disturbed_with_its_share() -> None:
    bus = Bus("bus error_frames 10% @0s")
    bus.at(0.0)
    ordered = {"plant": 0, "controller": 0}
    for _ in range(1000):
        bus.faults.sending([OTHER, POLL])
        for order in bus.hub.take():
            assert order.what == "errors"
            ordered[order.who] += order.count
        bus.faults.heard([])
    # A repetition is disturbed like the first attempt: 1/9 of the frames sent.
    answer = len(NotchCmd.port().can_ids)
    assert ordered["plant"] / 2000 == pytest.approx(1 / 9, rel=0.2)
    assert ordered["controller"] / (1000 * answer) == pytest.approx(1 / 9, rel=0.2)


def test_the_plant_is_never_taken_off_the_bus_and_a_controller_comes_back_after_the_fault() -> None:
    bus = Bus("bus error_frames 100% @0s for 1s")
    bus.at(0.0)
    bus.hub.host = Host(tec=100)
    bus.faults.heard([])
    bus.faults.sending([OTHER, POLL])
    assert bus.hub.take() == [
        Order("errors", "plant", count=19),
        Order("errors", "controller", count=32 * len(NotchCmd.port().can_ids)),
    ]
    # Nothing heard meanwhile: its counter may already be there.
    bus.faults.sending([OTHER])
    assert bus.hub.take() == []
    bus.faults.heard([errorframe.bus_error(108, 0, sending=True), OTHER, errorframe.restarted()])
    assert bus.said() == [(1, "", "error frame, TEC 108, REC 0")]
    assert bus.at(1.0) == [Order("restart", "controller")]
    bus.faults.sending([OTHER, POLL])
    bus.faults.heard([errorframe.bus_error(108, 0, sending=True)])
    assert bus.hub.take() == []
    assert len(bus.said()) == 1, "after its end it hits nothing"


@pytest.mark.parametrize(("tec", "count"), [(0, 31), (103, 19), (104, 18), (247, 1), (248, 0)])
def test_so_many_errors_as_leave_the_plant_on_the_bus(tec: int, count: int) -> None:
    bus = Bus("bus error_frames 100% @0s")
    bus.hub.host = Host(tec=tec)
    if tec:
        bus.faults.heard([])
    bus.at(0.0)
    bus.faults.sending([OTHER])
    assert bus.hub.take() == ([Order("errors", "plant", count=count)] if count else [])


def test_only_answers_of_the_controller_are_disturbed() -> None:
    """To polls that ask for one: not those of the supervisor, nor frames that are no polls."""
    bus = Bus("bus error_frames 100% @0s")
    bus.hub.host = Host(tec=255)
    bus.faults.heard([])
    bus.at(0.0)
    supervisor = master_frame(SupCmd.port().f_code, SupCmd.port().address)
    others = [supervisor, POLL._replace(can_id=0x100), POLL._replace(flags=REMOTE), POLL._replace(data=bytes(3))]
    bus.faults.sending(others)
    assert bus.hub.take() == []
    bus.faults.sending([POLL])
    assert [order.who for order in bus.hub.take()] == ["controller"]


def test_errors_and_contacts_at_the_edge_of_their_share() -> None:
    bus = Bus("bus error_frames 50% @0s", samples=lambda _: Scripted((0.499, 0.0, 0.5, 0.5)))
    bus.at(0.0)
    bus.faults.sending([OTHER])
    assert bus.hub.take() == [Order("errors", "plant", count=2)]
    bus.faults.sending([OTHER])
    assert bus.hub.take() == []
    loose = Bus("bus.a loose 30% @0s", samples=lambda _: Scripted((0.299, 0.3)))
    assert [order.on for order in loose.at(0.0)] == [True]
    assert [order.on for order in loose.at(0.1)] == [False]


def test_the_controller_comes_back_after_the_last_fault_and_not_before() -> None:
    bus = Bus("bus error_frames 1% @0s for 1s", "bus error_frames 1% @0s for 2s")
    assert bus.at(0.0) == bus.at(1.0) == []
    assert bus.at(2.0) == [Order("restart", "controller")]


def test_one_fault_that_needs_the_hub_is_enough() -> None:
    assert need_orders(map(parse, ("bus off @0s", "bus passive @0s")))
    assert not need_orders([])
    # None of the plant's faults is about the hub.
    injection = Injection((parse("bus off @0s"),), np.random.default_rng)
    contract = wire_contract()
    node = NodeFaults(injection, contract, Schedule.from_contract(10_000_000, {}, contract), "plant")
    assert BusFaults.of(node, Told(), contract) is None


def test_a_cut_off_counts_before_anything_is_sent() -> None:
    bus = Bus("bus.a open @0s", "bus.b open @9s")
    bus.at(0.0)
    bus.hub.cut_off = "controller"
    bus.faults.heard([])
    assert bus.said() == [(1, "answer", "cut off")]
