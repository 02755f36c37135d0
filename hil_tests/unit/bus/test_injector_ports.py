"""All faults of one port together, and which ports and nodes a fault is about."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from railhil.bus.frame import Frame
from railhil.bus.injector.follower import raw_of
from railhil.bus.injector.node_faults import NodeFaults, nodes_of, ports_of
from railhil.bus.injector.telegram_frames import Telegram, data_of, shown
from railhil.bus.mvb import TelegramSource
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import TimeSync
from railhil.dbc import Port, wire_contract
from railhil.faults.language import parse
from railhil.faults.model import Fault, Injection, Place, Trigger, Truth
from railhil.wire.ato import CtlStat, NotchCmd, TrkInfo, TrnPos, TrnSpeed

MS = 1_000_000
CONTRACT = wire_contract()
TRUTH = Truth("SIM_TRUTH", "TruePos", "TrueSpeed", beside=("TRN_WATCH",))
NAMED = {"notch": "NOTCH_CMD.NotchCmd"}
SCHEDULE = Schedule.from_contract(10 * MS, {}, CONTRACT)


def injection(*faults: Fault, truth: Truth | None = TRUTH, units: tuple[str, ...] = ()) -> Injection:
    return Injection(faults, np.random.default_rng, truth, NAMED, units)


def node(*texts: str, at: str = "plant", folder: Path | None = None) -> NodeFaults:
    found = NodeFaults(injection(*map(parse, texts)), CONTRACT, SCHEDULE, at, folder)
    found.activities.look(0, 0.0, 0.0)
    return found


def telegram(port: Port, number: int = 1, fd: bool = False) -> Telegram:
    return TelegramSource(port, fd).frames(bytes([number]) * port.data_bytes)


def said(faults: NodeFaults) -> list[tuple[int, str, str]]:
    return [(hit.fault, hit.before, hit.after) for hit in faults.activities.log.hits]


SPEED, PLACE = TrnSpeed.port(), TrnPos.port()


def test_ports_and_nodes_of_a_fault() -> None:
    bench = {"RUN_EVENT", "SUP_CMD", "PLT_IDENT", "CTL_IDENT", "SUP_IDENT", "SIM_TRUTH", "TRN_WATCH"}
    train = {port.name for port in CONTRACT.ports} - bench
    own = {port.name for port in CONTRACT.ports if port.source == "controller"} - bench
    for text, ports, nodes in (
        ("TRN_SPEED loss @0s", {"TRN_SPEED"}, {"plant"}),
        ("CTL_STAT.counter freeze @0s", {"CTL_STAT"}, {"controller"}),
        ("command.notch stuck @0s", {"NOTCH_CMD"}, {"controller"}),
        ("clock.time stuck @0s", {"TIME_SYNC"}, {"plant"}),
        ("clock.wall pause @0s", set(), {"plant"}),
        ("bus off @0s", train, {"plant", "controller"}),
        ("bus down @0s", train, {"plant", "controller"}),
        ("bus full @0s", train, {"plant", "controller"}),
        ("bus ok @0s", train, {"plant", "controller"}),
        ("bus load @0s", set(), {"plant"}),
        ("bus.a open @0s", set(), {"plant"}),
        ("node.controller slow 1s @0s", own, {"controller"}),
        ("node.controller kill @0s", set(), {"controller"}),
        ("node.plant stop @0s", set(), {"plant"}),
        ("sensor.speed off @0s", set(), set()),
    ):
        fault = parse(text)
        found = injection(fault)
        assert {port.name for port in ports_of(fault, found, CONTRACT)} == ports, text
        assert nodes_of(fault, found, CONTRACT) == nodes, text
    # Without a truth its port is one of the train's.
    fault = parse("bus off @0s")
    assert {port.name for port in ports_of(fault, injection(fault, truth=None), CONTRACT)} == train | {
        "SIM_TRUTH", "TRN_WATCH",
    }  # fmt: skip
    assert len(own) < len(train)


def test_a_node_has_its_own_faults() -> None:
    texts = "TRN_SPEED loss @0s", "NOTCH_CMD loss @0s", "bus off @9s", "TRN_SPEED delay 1s @9s"
    plant, controller = node(*texts), node(*texts, at="controller")
    assert [one.number for one in plant.activities.all] == [1, 3, 4]
    assert [one.number for one in controller.activities.all] == [2, 3]
    assert (plant.node, controller.node) == ("plant", "controller")
    # Time comes from the port that opens the ticks, at the plant, and elsewhere from the truth.
    assert SPEED.address in plant.follower.clock_ids
    assert SPEED.address not in controller.follower.clock_ids
    assert {"TRN_SPEED", "TRK_INFO", "TIME_SYNC"} <= plant.ports.keys()
    assert "NOTCH_CMD" not in plant.ports
    assert {"NOTCH_CMD", "CTL_STAT"} <= controller.ports.keys()
    assert [one.number for one in plant.at("bus", "off", "down")] == [3]
    assert [one.number for one in plant.at("telegram", "loss")] == [1]
    assert plant.at("bus", "loss") == []
    assert plant.samples(5).random() == np.random.default_rng(5).random()


@pytest.mark.parametrize("fd", [False, True])
def test_whole_telegrams_pass_one_by_one(fd: bool) -> None:
    faults = node("TRN_POS loss x1 @0s", "TRK_INFO loss @0s")
    foreign = Frame(0x7E0, b"a")
    place, track = telegram(PLACE, fd=fd), telegram(TrkInfo.port(), fd=fd)
    other = telegram(SPEED)
    frames = [foreign, *place, *other, *track, *place, foreign]
    assert list(faults.passes(frames)) == [foreign, *other, *place, foreign]
    assert said(faults) == [(1, shown(place), "lost"), (2, shown(track), "lost")]
    assert list(faults.passes([])) == []


def test_a_signal_comes_before_its_telegram_and_the_bus_last() -> None:
    """Whatever their order in the list."""
    texts = (
        "bus off @9s", "TRN_POS delay 10ms @0s combine", "TRN_POS.checksum value 1 @0s", "TRN_POS truncate 3 @0s",
        "TRN_POS.TrainPos raw 5 @0s",
    )  # fmt: skip
    faults = node(*texts)
    port = faults.ports["TRN_POS"]
    assert [activity.number for activity, _ in port._changes] == [3, 5, 4]
    assert [activity.number for activity, _ in port._keeps] == [2, 1]
    assert list(faults.passes(telegram(PLACE))) == []
    changed = said(faults)
    assert [row[0] for row in changed] == [3, 5, 4, 2]
    # Each is noted with what it has made of the one before it.
    assert changed[0][0] == 3
    assert changed[0][1] == shown(telegram(PLACE))
    assert [row[2] for row in changed[:3]] == [row[1] for row in changed[1:]]
    assert changed[3][2] == "later"
    # Commands and the time come before the telegram, too.
    faults = node("TIME_SYNC truncate 3 @0s", "clock.time stuck @0s")
    assert [one.number for one, _ in faults.ports["TIME_SYNC"]._changes] == [2, 1]
    faults = node("NOTCH_CMD remote @0s", "NOTCH_CMD.CtlMode raw 1 @0s", "command.notch stuck @0s", at="controller")
    assert [one.number for one, _ in faults.ports["NOTCH_CMD"]._changes] == [3, 2, 1]


def test_each_word_has_its_change() -> None:
    data = bytes([1]) * 8

    def passed(text: str, port: Port, at: str = "plant") -> Telegram:
        return list(node(text, at=at).passes(telegram(port)))

    def signal(name: str, port: Port, frames: Telegram) -> int:
        return raw_of(data_of(port, frames), next(one for one in port.signals if one.name == name))

    assert signal("TrainPos", PLACE, passed("TRN_POS.TrainPos raw 77 @0s", PLACE)) == 77
    assert signal("PosLife", PLACE, passed("TRN_POS.counter value 9 @0s", PLACE)) == 9
    assert (
        signal("NotchCmd", NotchCmd.port(), passed("command.notch value 2 @0s", NotchCmd.port(), "controller")) == 512
    )
    assert passed("TRN_POS.checksum value 0 @0s", PLACE)[-1].data[0] == 0
    assert passed("clock.time step 1s @0s", TimeSync.port())[0].data == b"\1\1\1\2" + data[4:]
    assert [one.can_id for one in passed("TRN_POS masquerade TRK_INFO @0s", PLACE)] == [0x130, 0x131]
    assert [one.data for one in passed("TRN_POS truncate 1 @0s", PLACE)] == [b"\1", telegram(PLACE)[1].data[:1]]
    # ``ok`` is none.
    assert passed("TRN_POS ok @0s", PLACE) == telegram(PLACE)


def test_a_change_that_changes_nothing_is_not_noted() -> None:
    faults = node("TRN_POS.checksum offset 0 @0s", "TRN_POS.TrainPos raw 5 @9s")
    assert list(faults.passes(telegram(PLACE))) == telegram(PLACE)
    assert said(faults) == []


def test_a_fault_counts_the_telegrams_of_its_port() -> None:
    faults = node("TRN_SPEED loss x2 @#3", "TRN_SPEED.TrainSpeed raw 1 @9s")
    assert [len(list(faults.passes(telegram(SPEED)))) for _ in range(6)] == [1, 1, 0, 0, 1, 1]
    assert [one.begun_ns for one in faults.activities.all] == [0, None]
    # What is triggered otherwise is not looked at between the instants.
    faults = node("TRN_SPEED loss @1s")
    faults.activities.now_ns = 2 * 10**9
    assert list(faults.passes(telegram(SPEED))) == telegram(SPEED)


def test_what_leaves_later_passes_the_faults_behind() -> None:
    """A delayed telegram is lost when the bus is off at its instant."""
    faults = node("TRN_POS delay 10ms @0s", "bus off @20ms for 5ms after deliver")
    numbered = [telegram(PLACE, number) for number in range(5)]
    assert list(faults.passes(numbered[0])) == []
    assert list(faults.due()) == []
    faults.activities.look(10 * MS, 0.0, 0.0)
    assert list(faults.due()) == numbered[0]
    assert list(faults.passes(numbered[1])) == []
    faults.activities.look(20 * MS, 0.0, 0.0)
    assert list(faults.due()) == []
    faults.activities.look(30 * MS, 0.0, 0.0)
    assert list(faults.due()) == numbered[1]
    assert [(row[0], row[2]) for row in said(faults)] == [(1, "later"), (1, "later"), (2, "later")]
    assert list(faults.due()) == []


def test_what_a_fault_does_after_its_end_is_noted_but_does_not_count() -> None:
    faults = node("NOTCH_CMD delay 10ms x1 @0s", at="controller")
    notch = NotchCmd.port()
    assert list(faults.passes(telegram(notch, 1))) == []
    (one,) = faults.activities.all
    assert (one.active, one.hits) == (False, 1)
    faults.activities.look(20 * MS, 0.0, 0.0)
    # An answer waits for its poll.
    assert list(faults.due()) == []
    assert list(faults.passes(telegram(notch, 2))) == telegram(notch, 1)
    assert said(faults) == [(1, shown(telegram(notch, 1)), "later"), (1, shown(telegram(notch, 2)), "lost")]
    assert [(hit.time_ns, hit.what) for hit in faults.activities.log.hits] == [(0, "delay"), (20 * MS, "delay")]
    assert one.hits == 1


def test_both_of_two_faults_of_a_port_keep_their_telegrams() -> None:
    faults = node("TRN_POS delay 10ms @0s combine", "TRN_POS duplicate @0s combine")
    assert list(faults.passes(telegram(PLACE))) == []
    faults.activities.look(10 * MS, 0.0, 0.0)
    # What was delayed is then doubled.
    assert list(faults.due()) == telegram(PLACE) * 2


def test_the_status_is_polled_and_the_speed_is_not() -> None:
    status = CtlStat.port()
    faults = node("CTL_STAT duplicate x1 @0s", at="controller")
    assert [list(faults.passes(telegram(status, number))) for number in (1, 2)] == [telegram(status, 1)] * 2


def test_the_log_is_written_where_the_run_is(tmp_path: Path) -> None:
    faults = node("TRN_SPEED loss @0s", folder=tmp_path)
    list(faults.passes(telegram(SPEED)))
    faults.write()
    assert [path.name for path in tmp_path.iterdir()] == ["faults-plant.csv"]
    node("TRN_SPEED loss @0s").write()


def test_an_instant_begins_and_ends_faults() -> None:
    faults = node("TRN_POS loss @departed", "TRN_POS delay 1s @manual")
    speed = TelegramSource(SPEED)
    assert not faults.see(Frame(0x7E0, b"a"))
    assert faults.see(speed.frames(TrnSpeed(0, life=1).encode())[0])
    faults.follower._events.append("departed")
    faults.follower._orders.append((2, True))
    assert faults.see(speed.frames(TrnSpeed(0, life=2).encode())[0])
    assert faults.activities.now_ns == 10 * MS
    assert [one.begun_ns for one in faults.activities.all] == [10 * MS, 10 * MS]


def test_a_fault_of_a_unit_is_about_its_port() -> None:
    fault = Fault(Place("telegram", "SPEED"), "loss", Trigger("time", 0.0), units=(2,))
    names = "TRN_X", "TRN"
    assert [port.name for port in ports_of(fault, injection(fault, units=names), CONTRACT)] == ["TRN_SPEED"]
