"""The link on a hub that takes orders: bus-off and a full transmit queue, on a clock of the test."""

from __future__ import annotations

import pytest

from hil_tests.support.clock import SetClock
from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame
from railhil.bus.hub.batches import HubClient
from railhil.bus.hub.cancontroller import BUS_OFF, ERROR_PASSIVE
from railhil.bus.hub.connection import Refused
from railhil.bus.hub.disturbances import Host, Notices, Order
from railhil.bus.hub.link import BatchLink
from railhil.bus.link import errorframe
from railhil.bus.link.base import Timeouts


class FakeHub:
    """A client of the hub; ``due`` holds what it receives: frames or its new state, each with its time in s."""

    channel_info = "hub"

    def __init__(self, wall: SetClock) -> None:
        self.notices = Notices()
        self.sent: list[Frame] = []
        self.due: list[tuple[float, list[Frame] | Host]] = []
        self._wall = wall

    def send_frames(self, frames: list[Frame], *, even_full: bool = False) -> None:
        assert even_full
        self.sent += frames

    def order(self, order: Order) -> None:
        raise Refused("the bus is shut down")

    def offer_frames(self, frames: list[Frame]) -> int:
        return 0

    def has_left(self, role: str) -> bool:
        return False

    is_here = has_left

    def recv_frames(self, timeout_s: float) -> list[Frame]:
        end_s = self._wall.monotonic() + timeout_s
        if self.due and self.due[0][0] <= end_s:
            at_s, found = self.due.pop(0)
            self._wall.now_ns = max(self._wall.now_ns, round(at_s * 1e9))
            if isinstance(found, list):
                return found
            self.notices.take({"host": {name: getattr(found, name) for name in Host.__slots__}})
            return []
        self._wall.now_ns = round(end_s * 1e9)
        return []


@pytest.fixture
def wall() -> SetClock:
    return SetClock(1_000_000_000)


@pytest.fixture
def hub(wall: SetClock) -> FakeHub:
    return FakeHub(wall)


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def link(hub: FakeHub, wall: SetClock, said: list[str]) -> BatchLink:
    bus: HubClient = hub  # type: ignore[assignment]
    return BatchLink(bus, said.append, timeouts=Timeouts(give_up_s=30.0, queue_full_s=0.02), wall=wall)


OLD, NEW, HEARD = Frame(1, b"old"), Frame(1, b"new"), Frame(2, b"heard")


def test_a_full_queue_is_waited_for_a_moment_and_nothing_stale_is_sent_later(link, hub, wall) -> None:
    hub.notices.host = Host(full=True)
    hub.due = [(1.005, [HEARD])]
    link.send([OLD])
    assert wall.monotonic() == pytest.approx(1.02, abs=0.001), "bounded"
    assert (hub.sent, link.counters["send_dropped"]) == ([], 1)
    hub.notices.host = Host()
    link.send([NEW])
    assert hub.sent == [NEW]
    assert link.receive(0.0) == [HEARD], "what arrived meanwhile is not lost"
    assert link.receive(0.0) == []


def test_a_queue_with_room_again_in_time_takes_the_frame(link, hub, wall) -> None:
    hub.notices.host = Host(full=True)
    hub.due = [(1.004, [HEARD]), (1.006, [HEARD]), (1.01, Host())]
    link.send([NEW])
    assert wall.monotonic() == pytest.approx(1.01, abs=0.001)
    assert (hub.sent, link.counters["sent"], link.counters["send_dropped"]) == ([NEW], 1, 0)
    assert link.receive(0.0) == [HEARD, HEARD]


@pytest.mark.parametrize("host", [Host(full=True), Host(state=BUS_OFF)])
def test_in_lockstep_nobody_waits_and_the_hub_discards_the_frame(link, hub, wall, host) -> None:
    """Simulated time would stand still with the sender; the hub tells who waits for the answer."""
    link.lossless = True
    hub.notices.host = host
    link.send([OLD])
    assert wall.monotonic() == 1.0
    assert (hub.sent, link.counters["send_dropped"], link.counters["sent"]) == ([OLD], 1, 0)


def test_bus_off_is_an_outage_whose_length_the_node_learns(link, hub, said) -> None:
    hub.due = [
        (1.5, [HEARD]),
        (2.0, Host(state=BUS_OFF, tec=256)),
        (2.0, [errorframe.bus_off()]),
        (2.4, Host()),
        (2.4, [errorframe.restarted()]),
        (2.5, [HEARD]),
    ]
    assert link.receive(1.0) == [HEARD]
    assert not link.is_down
    link.receive(1.0)
    assert link.is_down
    link.receive(1.0)
    link.send([OLD])
    assert (hub.sent, link.counters["send_dropped"]) == ([], 1)
    link.receive(1.0)
    assert not link.is_down
    link.receive(1.0)
    assert link.take_gap_ns() == 0
    assert link.receive(1.0) == [HEARD]
    assert link.take_gap_ns() == 1_000_000_000, "since it heard somebody last"
    assert link.take_gap_ns() == 0
    assert said == [
        "hub is down (bus-off by order); nothing is sent",
        "hub: error frame: bus-off (said once, all are counted)",
        "hub is back after 1.00 s",
    ]
    assert (link.counters["bus_off"], link.counters["outages"], link.counters["error_frames"]) == (1, 1, 2)


@pytest.mark.parametrize("lossless", [False, True])
def test_in_real_time_bus_off_for_good_ends_the_node(link, hub, lossless) -> None:
    """In lockstep simulated time says how long it lasts."""
    link.lossless = lossless
    hub.due = [(1.0, Host(state=BUS_OFF))]
    link.receive(0.0)
    link.receive(29.0)
    if lossless:
        assert link.receive(600.0) == []
        return
    with pytest.raises(BusLost, match=r"^hub: bus-off by order; not back within 30 s$"):
        link.receive(2.0)


def test_what_is_cut_off_is_what_the_hub_says(link, hub) -> None:
    assert not link.is_cut_off("controller")
    hub.notices.take({"cut_off": ["controller"]})
    assert link.is_cut_off("controller")


def test_error_passive_is_a_warning_and_each_switch_over_is_counted(link, hub, said) -> None:
    assert link.disturber is link
    states = [
        Host(state=ERROR_PASSIVE, tec=128),
        Host(state=ERROR_PASSIVE, tec=130, line="B", switch_overs=1),
        Host(line="B", switch_overs=1),
        Host(line="A", switch_overs=2, state=ERROR_PASSIVE, rec=128),
    ]
    hub.due = [(1.0, state) for state in states]
    for state in states:
        link.receive(1.0)
        assert link.host == state
    assert (link.counters["error_passive"], link.counters["switch_overs"]) == (2, 2)
    assert said == [
        "hub: warning: error-passive (TEC 128, REC 0)",
        "hub: takes frames from line B now",
        "hub: takes frames from line A now",
        "hub: warning: error-passive (TEC 0, REC 128)",
    ]


def test_an_order_to_a_hub_that_is_gone_ends_the_node(link) -> None:
    with pytest.raises(BusLost, match=r"^hub: cannot order: the bus is shut down"):
        link.order(Order("restart", "controller"))
