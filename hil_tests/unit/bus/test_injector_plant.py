"""The plant's connection under faults: what leaves, in which order, and what happens to the process."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from railhil.bus.frame import Frame
from railhil.bus.hub.disturbances import Host, Order
from railhil.bus.injector.node_faults import NodeFaults
from railhil.bus.injector.plant_side import FaultyEndpoint
from railhil.bus.link import errorframe
from railhil.bus.mvb import TelegramSource
from railhil.bus.packing import unpack_frames
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import SupCmd, TimeSync
from railhil.dbc import wire_contract
from railhil.faults.language import parse
from railhil.faults.model import Injection
from railhil.wire.ato import TrnPos, TrnSpeed

MS = 1_000_000
CONTRACT = wire_contract()


class Wire:
    """The endpoint below, which keeps what is sent."""

    def __init__(self) -> None:
        self.lossless = False
        self.is_down = False
        self.is_private = False
        self.sent: list[list[Frame]] = []
        self.arrived: list[Frame] = []
        self.asked: list[object] = []

    def send(self, frames: Sequence[Frame]) -> None:
        self.sent.append(list(frames))

    def receive(self, timeout_s: float | None) -> list[Frame]:
        self.asked.append(timeout_s)
        return self.arrived

    def has_ended(self, node: str) -> bool:
        return node == "controller"

    def is_cut_off(self, node: str) -> bool:
        return node == "supervisor"

    def close(self) -> None:
        self.asked.append("close")


class Hub:
    """Takes orders."""

    def __init__(self) -> None:
        self.host = Host()
        self.orders: list[Order] = []

    def is_cut_off(self, node: str) -> bool:
        return False

    def order(self, order: Order) -> None:
        self.orders.append(order)


class Bench:
    """The plant's connection, tick by tick."""

    def __init__(self, *faults: str, folder: Path | None = None, hub: Hub | None = None, is_open: bool = True) -> None:
        schedule = Schedule.from_contract(10 * MS, {}, CONTRACT)
        injection = Injection(tuple(map(parse, faults)), np.random.default_rng)
        self.faults = NodeFaults(injection, CONTRACT, schedule, "plant", folder)
        self.wire = Wire()
        self.is_open = is_open
        self.passed: list[Frame] = []
        self.acted: list[object] = []
        self.end = FaultyEndpoint(
            self.wire, self.faults, CONTRACT, hub, self,
            kill=lambda: self.acted.append(
                self.wire.sent[-1:] == [[]] and (folder is None or (folder / "faults-plant.csv").is_file())
            ),
            stop=lambda time_s: self.acted.append(("stop", time_s)),
            sleep=lambda time_s: self.acted.append(("sleep", time_s)),
        )  # fmt: skip

    def send_early(self, packet: bytes) -> bool:
        """The link below."""
        if self.is_open:
            self.passed += unpack_frames(packet)
        return self.is_open

    def send_packed(self, packet: bytes) -> None:
        raise AssertionError("what the faults leave is sent as frames")

    def receive_packed(self, timeout_s: float | None) -> bytes:
        raise AssertionError("what arrives passes the faults as frames")

    def tick(self, *ticks: int, also: Sequence[Frame] = ()) -> list[tuple[int, bytes]]:
        """Send the frames of these ticks together; what leaves: identifier and first bytes."""
        self.wire.sent = []
        self.end.send([frame for tick in ticks for frame in (*speed(tick), *also)])
        assert len([sent for sent in self.wire.sent if sent]) <= 1
        return [(frame.can_id, frame.data[:3]) for sent in self.wire.sent for frame in sent]

    def said(self) -> list[tuple[int, str, str]]:
        return [(hit.time_ns // MS, hit.before, hit.after) for hit in self.faults.activities.log.hits]


def speed(tick: int) -> list[Frame]:
    return TelegramSource(TrnSpeed.port()).frames(TrnSpeed(tick, life=tick % 16).encode())


def shown(tick: int) -> tuple[int, bytes]:
    return 0x118, tick.to_bytes(3)


def test_it_is_the_endpoint_below() -> None:
    bench = Bench()
    end, wire = bench.end, bench.wire
    end.lossless = True
    assert (wire.lossless, end.lossless, end.is_down) == (True, True, False)
    wire.is_down, wire.lossless = True, False
    assert (end.is_down, end.lossless) == (True, False)
    assert [end.has_ended(node) for node in ("controller", "plant")] == [True, False]
    assert [end.is_cut_off(node) for node in ("supervisor", "plant")] == [True, False]
    for wire.is_private in (True, False):
        assert end.is_private is wire.is_private
    wire.arrived = [Frame(1, b"a")]
    assert end.receive(0.5) == [Frame(1, b"a")]
    end.close()
    assert wire.asked == [0.5, "close"]
    assert bench.tick(0, 1) == [shown(0), shown(1)]
    assert bench.tick() == []
    assert wire.sent == []


def test_what_it_receives_is_seen() -> None:
    """An order by hand comes from the supervisor."""
    bench = Bench("TRN_SPEED loss @manual")
    bench.wire.arrived = TelegramSource(SupCmd.port()).frames(SupCmd(0, 1, 1).encode())
    bench.end.receive(None)
    assert bench.tick(0) == []
    assert [(time_ms, after) for time_ms, _, after in bench.said()] == [(0, "lost")]


def test_what_was_held_back_leaves_at_the_beginning_of_its_instant() -> None:
    bench = Bench("TRN_POS delay 10ms @0s")
    place = TelegramSource(TrnPos.port()).frames(TrnPos(5).encode())
    assert bench.tick(0, also=place) == [shown(0)]
    # After what belongs to the last instant, before the frame that begins the next one.
    sent = bench.tick(1, also=[Frame(0x7E0, b"x")])
    assert [one[0] for one in sent] == [0x120, 0x124, 0x118, 0x7E0]
    bench = Bench("TRN_POS delay 10ms @0s")
    sent = bench.tick(0, 1, also=place)
    assert [one[0] for one in sent] == [0x118, 0x120, 0x124, 0x118]
    assert sent[0] == shown(0)
    assert sent[3] == shown(1)


def test_frames_without_an_instant_leave_as_they_are() -> None:
    bench = Bench("TRN_POS loss @0s")
    others = [Frame(0x7E0, b"a"), Frame(0x7E1, b"b")]
    bench.end.send(others)
    assert bench.wire.sent == [others]


def test_frames_before_an_instant_belong_to_the_last_one() -> None:
    bench = Bench("TRN_POS loss @10ms")
    place = TelegramSource(TrnPos.port()).frames(TrnPos(5).encode())
    assert [one[0] for one in bench.tick(0, 1, 2, also=place)] == [0x118, 0x120, 0x124, 0x118, 0x118]
    assert [row[0] for row in bench.said()] == [10, 20]


def test_killed(tmp_path: Path) -> None:
    bench = Bench("node.plant kill @10ms", folder=tmp_path)
    bench.tick(0)
    assert bench.acted == []
    bench.tick(1)
    # Its log is written before, and what the link below holds back.
    assert bench.acted == [True]
    assert bench.said() == [(10, "running", "killed")]


def test_stopped_and_paused_once() -> None:
    bench = Bench("node.plant stop @10ms for 500ms", "clock.wall pause 250ms @20ms", "node.plant stop @0s")
    for frame in TelegramSource(TimeSync.port()).frames(TimeSync(0, 0, 20).encode()):
        bench.end.send([frame])
    bench.tick(0)
    # Without a duration nobody would continue it.
    assert bench.acted == []
    bench.tick(1, 2, 3)
    # 500 ms of simulation time at twice real time; the pause is on the wall clock.
    assert bench.acted == [("stop", 0.25), ("sleep", 0.25)]
    assert bench.said() == [(10, "running", "stopped"), (20, "running", "paused")]
    assert [one.ended_ns for one in bench.faults.activities.all] == [10 * MS, 20 * MS, None]


def test_faults_of_the_bus_are_ordered_between_its_frames() -> None:
    hub = Hub()
    bench = Bench("bus.a open @10ms", "bus error_frames 100% @20ms", hub=hub)
    bench.tick(0)
    assert hub.orders == []
    bench.tick(1)
    assert hub.orders == [Order("line", "controller", line="A")]
    bench.tick(2)
    assert [order.what for order in hub.orders[1:]] == ["errors"]
    bench.wire.arrived = [errorframe.bus_error(8, 0, sending=True)]
    bench.end.receive(0.0)
    assert [row[2] for row in bench.said()] == ["error frame, TEC 8, REC 0"]
    # Where nothing leaves nothing is disturbed, and a replay acts nothing out.
    hub.orders = []
    bench.end.send([])
    assert hub.orders == []
    bench = Bench("bus error_frames 100% @0s")
    assert bench.tick(0) == [shown(0)]
    assert bench.end.receive(0.0) == []


def test_a_load_of_foreign_frames() -> None:
    bench = Bench("bus load 11.1% @10ms for 30ms")
    # 500 kbit/s in frames of 111 bits: 500 frames a second, with one at once.
    assert CONTRACT.bit_rate == 500_000
    assert bench.tick(0) == [shown(0)]
    sent = bench.tick(1, 2, 3, 4)
    numbers = [1, *range(6, 1, -1), *range(11, 6, -1)]
    assert [one for one in sent if one[0] != 0x7E0] == [shown(tick) for tick in (1, 2, 3, 4)]
    assert [frame.data for frame in bench.wire.sent[0] if frame.can_id == 0x7E0] == [
        number.to_bytes(8) for number in numbers
    ]
    # At the beginning of their instant.
    assert [one[0] for one in sent[:3]] == [0x7E0, 0x118, 0x7E0]
    assert bench.said() == [(10, "", "1 x 7E0"), (20, "", "5 x 7E0"), (30, "", "5 x 7E0")]
    assert bench.faults.activities.all[0].hits == 3


def test_a_load_below_one_frame_an_instant() -> None:
    bench = Bench("bus load 1% @0s")
    bench.tick(*range(7))
    assert [row[0] for row in bench.said()] == [0, 30, 50]
    # After 1.05 s at 500 frames a second.
    assert [one[0] for one in Bench("bus load 11.1% @0s").tick(*range(0, 106, 15))].count(0x7E0) == 526


def send_early(bench: Bench, *ticks: int) -> None:
    for tick in ticks:
        assert bench.end.send_early is not None
        assert bench.end.send_early(speed(tick)), "what has passed the faults is never given back"


def test_what_the_faults_leave_is_sent_early() -> None:
    bench = Bench("TRN_SPEED loss 100% @20ms for 20ms")
    send_early(bench, 0, 1, 2, 3, 4)
    assert bench.passed == [*speed(0), *speed(1), *speed(4)]
    assert bench.wire.sent == []
    bench.end.send([])
    assert bench.wire.sent == []
    assert len(bench.said()) == 2


def test_what_cannot_be_sent_early_passes_the_faults_once_and_is_sent_in_order() -> None:
    bench = Bench("TRN_SPEED loss 100% @10ms for 10ms", is_open=False)
    send_early(bench, 0, 1, 2)
    assert (bench.passed, bench.wire.sent) == ([], [])
    bench.is_open = True
    send_early(bench, 3)
    assert bench.passed == [*speed(0), *speed(2), *speed(3)]
    bench.is_open = False
    send_early(bench, 4)
    bench.end.send(speed(5))
    bench.end.send([])
    assert bench.wire.sent == [[*speed(4), *speed(5)]]
    assert len(bench.said()) == 1


def test_a_lost_telegram_alone_is_nothing_to_complete() -> None:
    bench = Bench("TRN_SPEED loss 100% @0s")
    send_early(bench, 0, 1)
    bench.end.send([])
    assert (bench.passed, bench.wire.sent) == ([], [])


def test_nothing_is_sent_early_where_the_bus_is_disturbed() -> None:
    assert Bench(hub=Hub()).end.send_early is None
