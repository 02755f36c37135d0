"""Orders to a hub with ``--faults``: error counters, bus-off, redundant lines, full queues; in the total order."""

from __future__ import annotations

import argparse
import errno
import select
from pathlib import Path

import can
import pytest

from hil_tests.support.hub import PATIENCE_S, HubProcess, running_hub
from railhil.bus.frame import ERROR, Frame
from railhil.bus.hub.cancontroller import BUS_OFF, ERROR_ACTIVE, ERROR_PASSIVE
from railhil.bus.hub.cli import add_arguments, work
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.disturbances import GUARD_FRAMES, Host, Notices, Order
from railhil.bus.link.errorframe import describe
from railhil.bus.local import LocalBus
from railhil.bus.packing import encode_notice

ONE, TWO, LAST = Frame(0x101, b"1"), Frame(0x102, b"2"), Frame(0x7FF, b"last")


def notices(bus: HubBus) -> Notices:
    assert bus.notices is not None
    return bus.notices


def host(bus: HubBus) -> Host:
    return notices(bus).host


def read_to_last(bus: HubBus) -> list[Frame]:
    """Frames up to LAST, which is left out; error frames too."""
    found: list[Frame] = []
    while not found or found[-1] != LAST:
        found += bus.recv_frames(PATIENCE_S)
    return found[:-1]


def settle(*buses: HubBus, by: HubBus) -> list[list[Frame]]:
    """What each has received so far."""
    by.send_frames([LAST])
    return [read_to_last(bus) for bus in buses]


def data(frames: list[Frame]) -> list[Frame]:
    return [frame for frame in frames if not frame.flags & ERROR]


def test_a_hub_without_the_option_takes_no_orders_and_has_no_notices() -> None:
    with running_hub() as hub, hub.bus() as bus:
        assert bus.notices is None
        assert "no error counters, no bus-off" in hub.ready_line
        with pytest.raises(can.CanOperationError, match="takes no orders, it must be started with --faults"):
            bus.order(Order("bus_off", "plant"))


def test_a_malformed_order_costs_one_client_its_port() -> None:
    with running_hub("--faults") as hub, hub.bus() as good, hub.bus(name="bad") as bad, hub.bus() as other:
        assert "error counters, bus-off and two lines by order" in hub.ready_line
        bad._open_link().send_packet(encode_notice(order={"what": "burn", "who": "plant"}), None)
        hub.wait_for_stderr("'bad' is disconnected: malformed packet: order: key 'what': found 'burn', allowed: errors")
        good.send_frames([LAST])
        assert other.recv_frames(PATIENCE_S) == [LAST]


def test_errors_raise_the_counters_of_all_and_the_frame_still_arrives() -> None:
    with running_hub("--faults") as hub, hub.bus(name="x") as sender, hub.bus(role="plant") as reader:
        reader.order(Order("errors", "x", count=16))
        reader.send_frames([LAST])
        assert read_to_last(sender) == []
        assert sender.state is can.BusState.ACTIVE
        sender.send_frames([ONE, TWO])
        heard = settle(reader, by=sender)[0]
        assert data(heard) == [ONE, TWO], "sent again until it succeeds"
        assert [describe(frame) for frame in heard if frame.flags & ERROR] == ["protocol violation bus error"] * 16
        reader.send_frames([LAST])
        own = read_to_last(sender)
        assert describe(own[-2]) == "controller problem (transmit error-passive)"
        assert describe(own[-1]) == "controller problem (transmit warning)", "two frames have been sent since"
        assert host(sender) == Host(ERROR_ACTIVE, tec=16 * 8 - 3, rec=0)
        assert host(reader) == Host(ERROR_ACTIVE, tec=0, rec=16 - 3)


def test_python_can_shows_error_frames_and_states() -> None:
    with running_hub("--faults") as hub, hub.bus(name="x") as bus, hub.bus() as other:
        other.order(Order("errors", "x", count=17))
        other.send_frames([LAST])
        assert read_to_last(bus) == []
        bus.send(can.Message(arbitration_id=0x101, is_extended_id=False))
        message = bus.recv(PATIENCE_S)
        while message is not None and not message.is_error_frame:
            message = bus.recv(PATIENCE_S)
        assert message is not None
        assert (message.arbitration_id, bytes(message.data)) == (0x288, bytes((0, 0, 0x80, 0, 0, 0, 8, 0)))
        other.send_frames([LAST])
        read_to_last(bus)
        assert bus.state is can.BusState.PASSIVE
        assert host(bus).state == ERROR_PASSIVE
        other.order(Order("bus_off", "x"))
        other.order(Order("restart", "x"))
        other.send_frames([LAST])
        assert [describe(frame) for frame in read_to_last(bus)] == [
            "bus-off", "restarted", "controller problem (error-active)",
        ]  # fmt: skip
        assert bus.state is can.BusState.ACTIVE


def test_bus_off_by_errors_drops_the_frame_and_everything_until_the_restart() -> None:
    with running_hub("--faults") as hub, hub.bus(name="x") as bus, hub.bus() as one, hub.bus() as two:
        one.order(Order("errors", "x", count=40))
        one.send_frames([LAST])
        read_to_last(bus)
        bus.send_frames([ONE])
        bus.send_frames([ONE])
        while describe(read_one(bus)) != "bus-off":
            continue
        assert (bus.state, host(bus).state, host(bus).tec) == (can.BusState.ERROR, BUS_OFF, 256)
        one.send_frames([TWO])
        one.order(Order("restart", "x"))
        one.send_frames([LAST])
        assert data(read_to_last(bus)) == [], "TWO was sent while it was off"
        assert host(bus) == Host()
        bus.send_frames([ONE])
        bus.send_frames([LAST])
        found = [read_to_last(two) for _ in range(3)]
        assert [data(frames) for frames in found] == [[], [TWO], [ONE]]


def test_a_bus_off_client_returns_by_itself_after_the_time_asked_for() -> None:
    with running_hub("--faults", "--restart-ms", "1") as hub, hub.bus(name="x") as bus, hub.bus() as other:
        assert bus.hub_properties["restart_ms"] == 1
        other.order(Order("bus_off", "x"))
        found: list[str] = []
        while "restarted" not in found:
            found += [describe(frame) for frame in bus.recv_frames(PATIENCE_S)]
        assert found[0] == "bus-off"
        assert host(bus) == Host()


def test_with_a_bit_rate_the_restart_waits_for_recessive_bits() -> None:
    with (
        running_hub("--faults", "--bitrate-model", "-b", "20000") as hub,
        hub.bus(name="x") as bus,
        hub.bus(name="y") as other,
    ):
        other.order(Order("bus_off", "x"))
        other.order(Order("restart", "x"))
        other.order(Order("restart", "y"))
        found: list[Frame] = []
        while not found:
            found = bus.recv_frames(PATIENCE_S)
        # 1408 bits at 20 kbit/s are 70 ms: the order itself has not brought it back.
        assert [describe(frame) for frame in found] == ["bus-off"]
        assert host(bus).is_off
        while host(bus).is_off:
            bus.recv_frames(PATIENCE_S)


def test_an_order_for_nobody_is_told() -> None:
    with running_hub("--faults") as hub, hub.bus(name="x") as bus, hub.bus() as other:
        bus.order(Order("bus_off", "controller"))
        while not notices(bus).missed:
            bus.recv_frames(PATIENCE_S)
        assert notices(bus).missed == ["bus_off controller"]
        assert settle(other, by=bus) == [[]]


def test_one_dead_line_is_bridged_and_two_cut_the_client_off() -> None:
    with running_hub("--faults") as hub, hub.bus(name="x") as bus, hub.bus() as one, hub.bus() as two:
        one.order(Order("line", "x", line="A"))
        bus.send_frames([ONE])
        assert data(settle(one, two, by=bus)[1]) == [ONE]
        assert (host(one).line, host(one).switch_overs) == ("B", 1)
        one.send_frames([TWO])
        assert data(settle(bus, by=one)[0]) == [TWO]
        assert (host(bus).line, host(bus).switch_overs, bus.state) == ("B", 1, can.BusState.ACTIVE)
        one.order(Order("line", "x", line="B"))
        one.send_frames([TWO])
        one.order(Order("line", "x", line="B", on=False))
        for _ in range(GUARD_FRAMES):
            one.send_frames([ONE])
        assert data(settle(bus, by=one)[0]) == [ONE] * GUARD_FRAMES, "TWO was sent while both were dead"
        assert host(bus).switch_overs == 1


def test_a_second_switch_over_waits_for_the_guard() -> None:
    with running_hub("--faults") as hub, hub.bus(name="x") as bus, hub.bus() as other:
        other.order(Order("line", "x", line="A"))
        other.send_frames([ONE])
        other.order(Order("line", "x", line="A", on=False))
        other.order(Order("line", "x", line="B"))
        other.send_frames([TWO] * GUARD_FRAMES)
        assert data(settle(bus, by=other)[0]) == [ONE]
        assert (host(bus).line, host(bus).switch_overs) == ("A", 2)


def test_a_full_queue_refuses_frames_until_it_has_room_and_keeps_none() -> None:
    with running_hub("--faults") as hub, hub.bus(name="x") as bus, hub.bus() as other:
        other.order(Order("full", "x"))
        settle(bus, by=other)
        with pytest.raises(can.CanOperationError, match="transmit queue full") as error:
            bus.send(can.Message(arbitration_id=0x101, is_extended_id=False))
        assert error.value.error_code == errno.ENOBUFS
        assert bus.offer_frames([ONE]) == 0
        bus.send_frames([ONE], even_full=True)
        bus.order(Order("full", "x", on=False))
        while host(bus).full:
            bus.recv_frames(PATIENCE_S)
        bus.send_frames([TWO])
        assert data(settle(other, by=bus)[0]) == [TWO]


def test_nodes_are_told_which_answers_cannot_come() -> None:
    with (
        running_hub("--faults") as hub,
        hub.bus(role="plant") as plant,
        hub.bus(role="controller") as controller,
        hub.bus(role="supervisor") as supervisor,
    ):
        plant.send_frames([LAST])
        read_to_last(controller)
        plant.order(Order("bus_off", "controller"))
        plant.send_frames([ONE])
        while not notices(plant).is_cut_off("controller"):
            plant.recv_frames(PATIENCE_S)
        assert not notices(plant).is_cut_off("supervisor")
        plant.order(Order("restart", "controller"))
        plant.order(Order("full", "controller"))
        plant.send_frames([LAST])
        assert not notices(plant).is_cut_off("controller"), "that was the packet before"
        while not host(controller).full:
            controller.recv_frames(PATIENCE_S)
        read_to_last(controller)
        controller.send_frames([TWO], even_full=True)
        while not notices(plant).is_cut_off("controller"):
            assert plant.recv_frames(PATIENCE_S) == []
        plant.order(Order("bus_off", "plant"))
        plant.send_frames([ONE])
        while not notices(plant).is_cut_off("supervisor"):
            plant.recv_frames(PATIENCE_S)
        supervisor.send_frames([LAST])
        assert data(read_to_last(controller)) == []
    assert LocalBus([]).is_cut_off("controller") is False


def _disturbed_stream(hub: HubProcess) -> list[list[Frame]]:
    with hub.bus(name="x") as bus, hub.bus(role="plant") as one, hub.bus(coalesce_frames=64) as two:
        for number in range(60):
            if number % 7 == 3:
                one.order(Order("errors", "plant", count=4))
            if number == 30:
                one.order(Order("line", "plant", line="A"))
            one.send_frames([Frame(0x100 + number, b"")])
        one.send_frames([LAST])
        return [read_to_last(bus), read_to_last(two)]


def test_the_same_orders_at_the_same_places_have_the_same_effect() -> None:
    with running_hub("--faults") as hub:
        assert _disturbed_stream(hub) == _disturbed_stream(hub)


@pytest.mark.parametrize("channel", [None, "tcp://127.0.0.1:0"])
def test_own_frames_come_back_unless_the_client_is_off(channel: str | None) -> None:
    with (
        running_hub("--faults", channel=channel) as hub,
        hub.bus(name="x", receive_own_messages=True) as bus,
        hub.bus() as other,
    ):
        bus.send_frames([ONE])
        assert bus.recv_frames(PATIENCE_S) == [ONE]
        other.order(Order("bus_off", "x"))
        assert describe(read_one(bus)) == "bus-off"
        bus.send_frames([ONE])
        bus.order(Order("restart", "x"))
        bus.send_frames([LAST])
        assert data(read_to_last(bus)) == []


def read_one(bus: HubBus) -> Frame:
    frames: list[Frame] = []
    while not frames:
        frames = bus.recv_frames(PATIENCE_S)
    return frames[0]


def test_a_notice_does_not_hide_what_has_arrived_with_it() -> None:
    """On TCP the client reads both at once, and a selector sees only the socket."""
    with running_hub("--faults", channel="tcp://127.0.0.1:0") as hub, hub.bus(name="x") as bus, hub.bus() as other:
        descriptor = bus.fileno()
        other.order(Order("line", "x", line="A"))
        for number in range(200):
            other.order(Order("full", "x", on=number % 2 == 0))
        other.send_frames([LAST])
        found: list[Frame] = []
        while LAST not in found:
            assert select.select((descriptor,), (), (), PATIENCE_S)[0]
            found += bus.recv_frames(0.0)


def test_restart_ms_needs_the_model(socket_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    assert work(parser.parse_args(["-c", str(socket_folder / "hub.sock"), "--restart-ms", "5"])) == 2
    line = "railhil bus hub: error: option --restart-ms: found without --faults, allowed: only with it\n"
    assert capsys.readouterr().err == line
