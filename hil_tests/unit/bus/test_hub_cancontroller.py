"""The model of CAN controllers and redundant lines that a hub with ``--faults`` has, without a hub."""

from __future__ import annotations

import argparse

import pytest

from hil_tests.support.paths import ROOT
from railhil.bus.frame import ERROR, Frame
from railhil.bus.hub.cancontroller import BUS_OFF, ERROR_ACTIVE, ERROR_PASSIVE, CanController
from railhil.bus.hub.cli import add_arguments
from railhil.bus.hub.disturbances import GUARD_FRAMES, Lines, Notices, Order, order_of
from railhil.bus.link import errorframe
from railhil.bus.link.errorframe import describe
from railhil.bus.transports import HUB_MODEL, hub_limit


def after(fails: int = 0, others_fail: int = 0) -> CanController:
    controller = CanController()
    for _ in range(fails):
        controller.send_failed()
    for _ in range(others_fail):
        controller.receive_failed()
    return controller


@pytest.mark.parametrize(
    ("fails", "others_fail", "state"),
    [
        (0, 0, ERROR_ACTIVE),
        (15, 127, ERROR_ACTIVE),
        (16, 0, ERROR_PASSIVE),
        (0, 128, ERROR_PASSIVE),
        (31, 0, ERROR_PASSIVE),
        (32, 0, BUS_OFF),
        (0, 1000, ERROR_PASSIVE),
    ],
)
def test_states_of_iso_11898_1(fails: int, others_fail: int, state: str) -> None:
    controller = after(fails, others_fail)
    assert (controller.tec, controller.rec, controller.state) == (8 * fails, others_fail, state)


def test_counters_fall_with_good_frames_to_zero() -> None:
    controller = after(fails=16, others_fail=130)
    assert [describe(frame) for frame in controller.sent(1)] == [
        "controller problem (transmit warning, receive error-passive)"
    ]
    assert (controller.tec, controller.state) == (127, ERROR_PASSIVE)
    controller.received(1)
    assert (controller.rec, controller.state) == (119, ERROR_ACTIVE)
    controller.received(200)
    assert [describe(frame) for frame in controller.sent(200)] == ["controller problem (error-active)"]
    assert (controller.tec, controller.rec) == (0, 0)
    assert controller.sent(1) == controller.received(1) == []


def test_error_frames_are_those_of_socketcan() -> None:
    """linux/can/error.h: class in the identifier, state in byte 1, cause in byte 2, counters in bytes 6 and 7."""
    controller = after(fails=11, others_fail=3)
    assert controller.send_failed() == [
        Frame(0x288, bytes((0, 0, 0x80, 0, 0, 0, 96, 3)), ERROR),
        Frame(0x204, bytes((0, 0x08, 0, 0, 0, 0, 96, 3)), ERROR),
    ]
    assert controller.receive_failed() == [Frame(0x288, bytes((0, 0, 0, 0, 0, 0, 96, 4)), ERROR)]
    for _ in range(19):
        controller.send_failed()
    off = controller.send_failed()[-1]
    assert (off.can_id, off.flags, describe(off)) == (errorframe.BUS_OFF, ERROR, "bus-off")
    assert [describe(frame) for frame in controller.restart()] == ["restarted", "controller problem (error-active)"]
    assert (controller.tec, controller.rec, controller.state) == (0, 0, ERROR_ACTIVE)


def test_bus_off_by_order_and_restart_only_from_it() -> None:
    controller = CanController()
    assert controller.restart() == []
    controller.errors_left = 5
    assert controller.go_off() == [errorframe.bus_off()]
    assert (controller.state, controller.errors_left) == (BUS_OFF, 0)
    assert controller.go_off() == []


def test_held_error_passive_it_stays_so_until_the_traffic_decides_again() -> None:
    controller = CanController()
    assert [describe(frame) for frame in controller.hold_passive(True)] == [
        "controller problem (transmit error-passive)"
    ]
    controller.send_failed()
    assert controller.sent(50) == controller.hold_passive(True) == []
    assert (controller.tec, controller.state) == (128, ERROR_PASSIVE)
    assert controller.hold_passive(False) == []
    assert [describe(frame) for frame in controller.sent(1)] == ["controller problem (transmit warning)"]
    assert (controller.tec, controller.state) == (127, ERROR_ACTIVE)


def test_an_ordered_error_passive_outlasts_bus_off_and_restart() -> None:
    """Ordered before or while it is off, it holds until the order ends."""
    for is_off_first in (False, True):
        controller = CanController()
        if is_off_first:
            controller.go_off()
            assert controller.hold_passive(True) == []
        else:
            controller.hold_passive(True)
            controller.go_off()
        told = [describe(frame) for frame in controller.restart()]
        assert told == ["restarted", "controller problem (transmit error-passive)"]
        assert (controller.tec, controller.rec, controller.state) == (128, 0, ERROR_PASSIVE)
        assert controller.sent(50) == []
        controller.hold_passive(False)
        controller.sent(50)
        assert (controller.tec, controller.state) == (78, ERROR_ACTIVE)
        controller.go_off()
        controller.restart()
        assert controller.tec == 0


def test_a_receiver_switches_over_once_and_respects_the_guard() -> None:
    sender, receiver = Lines(), Lines()
    assert receiver.hears(sender, 1)
    sender.dead.add("A")
    assert receiver.hears(sender, 1)
    assert (receiver.trusted, receiver.switch_overs) == ("B", 1)
    sender.dead = {"B"}
    heard = [receiver.hears(sender, 1) for _ in range(GUARD_FRAMES + 1)]
    assert heard == [False] * GUARD_FRAMES + [True]
    assert (receiver.trusted, receiver.switch_overs) == ("A", 2)


def test_without_a_common_line_nothing_is_heard_and_nothing_switched() -> None:
    sender, receiver = Lines(), Lines()
    sender.dead, receiver.dead = {"A"}, {"B"}
    assert not receiver.hears(sender, 1)
    assert (receiver.trusted, receiver.switch_overs) == ("A", 0)
    receiver.dead = set()
    sender.dead = {"A", "B"}
    assert not receiver.hears(sender, 1)


@pytest.mark.parametrize(
    ("document", "words"),
    [
        (None, "order: found None, allowed: what, who, count, line, on"),
        ({"what": "errors"}, "order: found {'what': 'errors'}, allowed: what, who"),
        ({"what": "burn", "who": "plant"}, "key 'what': found 'burn', allowed: errors, passive, bus_off, restart"),
        ({"what": "errors", "who": ""}, "key 'who': found '', allowed: a role"),
        ({"what": "errors", "who": "plant", "count": 0}, "key 'count': found 0, allowed: 1..1000000"),
        ({"what": "errors", "who": "plant", "count": True}, "key 'count': found True"),
        ({"what": "line", "who": "plant", "line": "C"}, "key 'line': found 'C', allowed: A, B"),
        ({"what": "line", "who": "plant", "on": 1}, "key 'on': found 1, allowed: true, false"),
        ({"what": "line", "who": "plant", "when": 1}, "order: found"),
        ({"what": ["line"], "who": "plant"}, "key 'what': found"),
        ({"what": "line", "who": "plant", "line": ["A"]}, "key 'line': found"),
    ],
)
def test_bad_orders_are_one_line(document: object, words: str) -> None:
    with pytest.raises(ValueError, match="order") as error:
        order_of(document)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_an_order_survives_its_packet() -> None:
    order = Order("line", "plant", line="B", on=False)
    assert order_of(order.encoded()) == order


def test_an_old_packet_that_was_not_heard_says_nothing_about_the_newest() -> None:
    notices = Notices()
    notices.sending()
    notices.sending()
    notices.take({"cut_off": ["controller"], "packet": 1})
    assert not notices.is_cut_off("controller")
    notices.take({"cut_off": ["controller"], "packet": 2})
    assert notices.is_cut_off("controller")
    assert not notices.is_cut_off("supervisor")
    notices.sending()
    assert not notices.is_cut_off("controller")
    notices.take({"cut_off": ["controller"]})
    assert notices.is_cut_off("controller")


def test_the_page_has_the_list_of_what_is_modelled_and_each_option_exists() -> None:
    lines = ["| property | option | what the hub does | what is not modelled |", "|---|---|---|---|"]
    for row in HUB_MODEL:
        option = f"`{row.option}`" if row.option else "always" if row.by else "none"
        lines.append(f"| {row.subject} | {option} | {row.by or 'nothing'} | {row.without} |")
    assert "\n".join(lines) + "\n" in (ROOT / "docs" / "howto" / "hub.md").read_text(encoding="utf-8")
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    assert {row.option for row in HUB_MODEL} - {""} <= set(parser._option_string_actions)
    for row in HUB_MODEL:
        assert (row.subject in hub_limit()) is bool(row.option or not row.by)
    assert hub_limit().startswith("no acknowledgement; bit rate only with --bitrate-model")
    assert str(GUARD_FRAMES) in next(row.by for row in HUB_MODEL if row.subject == "two lines")
