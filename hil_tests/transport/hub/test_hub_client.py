"""The python-can plugin: API, order of mixed calls, filters, readiness, models as seen by clients."""

from __future__ import annotations

import asyncio
import contextlib
import select
import signal
import threading
from collections.abc import Iterator

import can
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hil_tests.transport.hub.test_hub_process import PATIENCE_S, HubProcess, running_hub
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.connection import SendTimeout


@pytest.fixture(scope="module", params=["path", "tcp"])
def hub(request: pytest.FixtureRequest) -> Iterator[HubProcess]:
    """One plain hub for the whole module, on each scheme."""
    with running_hub(channel=None if request.param == "path" else "tcp://127.0.0.1:0") as process:
        yield process


@pytest.fixture
def pair(hub: HubProcess) -> Iterator[tuple[HubBus, HubBus]]:
    """Two clients with CAN FD."""
    with hub.bus(fd=True) as one, hub.bus(fd=True) as other:
        yield one, other


def _message(can_id: int, data: bytes = b"", **options: object) -> can.Message:
    return can.Message(arbitration_id=can_id, data=data, **{"is_extended_id": False, **options})  # type: ignore[arg-type]


def _receive(bus: can.BusABC) -> can.Message:
    message = bus.recv(PATIENCE_S)
    assert message is not None
    return message


@pytest.mark.parametrize(
    "message",
    [
        _message(0x123, b"\x01\x02"),
        _message(0x1FFFFFFF, b"12345678", is_extended_id=True),
        _message(0x12, is_remote_frame=True, dlc=7),
        _message(0x1ABCDEF, is_extended_id=True, is_remote_frame=True, dlc=0),
        _message(0x20, bytes(8), is_error_frame=True),
        _message(0x44, b"f" * 48, is_fd=True, bitrate_switch=True),
        _message(0x45, b"f" * 3, is_fd=True, error_state_indicator=True),
    ],
)
def test_every_kind_of_frame_round_trips(pair: tuple[HubBus, HubBus], message: can.Message) -> None:
    one, other = pair
    one.send(message)
    received = _receive(other)
    assert received.equals(message, check_channel=False, timestamp_delta=None)
    assert received.is_rx


def test_frames_of_every_kind_keep_their_order_in_one_call(pair: tuple[HubBus, HubBus]) -> None:
    one, other = pair
    frames = [
        Frame(1, b"a"),
        Frame(0x1234567, b"b", EXTENDED),
        Frame(3, b"c" * 12, FD),
        Frame(4, b"d" * 64, FD | BRS),
        Frame(5, bytes(6), REMOTE),
        *(Frame(k, bytes([k % 256])) for k in range(600)),
        Frame(6, bytes(8), ERROR),
    ]
    one.send_frames(frames)
    received: list[Frame] = []
    packets = 0
    while len(received) < len(frames):
        received += other.recv_frames(PATIENCE_S)
        packets += 1
    assert received == frames
    # Two classic frames, two FD frames, then 602 classic frames in batches of at most 256.
    assert packets == 1 + 2 + 3


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    sends=st.lists(st.integers(0, 5), min_size=1, max_size=12),
    receives=st.lists(st.sampled_from(["recv", "frames"]), min_size=1, max_size=40),
)
def test_mixed_calls_keep_the_order(pair: tuple[HubBus, HubBus], sends: list[int], receives: list[str]) -> None:
    """0 is one ``send``, n > 0 is ``send_frames`` of n frames; the receiver mixes its calls in turn."""
    one, other = pair
    count = 0
    for size in sends:
        if size == 0:
            one.send(_message(count))
        else:
            one.send_frames([Frame(count + k, b"") for k in range(size)])
        count += max(size, 1)
    received: list[int] = []
    turn = 0
    while len(received) < count:
        if receives[turn % len(receives)] == "recv":
            received.append(_receive(other).arbitration_id)
        else:
            frames = other.recv_frames(PATIENCE_S)
            assert frames
            received += [frame.can_id for frame in frames]
        turn += 1
    assert received == list(range(count))


def test_own_messages_come_at_their_place_in_the_total_order(hub: HubProcess) -> None:
    with hub.bus(receive_own_messages=True) as one, hub.bus(receive_own_messages=True) as other:
        for number in range(300):
            one.send_frames([Frame(0x100, number.to_bytes(2, "big"))] * (number % 3 + 1))
            other.send(_message(0x200, number.to_bytes(2, "big")))
        total = 600 + 300
        orders = []
        for bus, own_id in ((one, 0x100), (other, 0x200)):
            messages = [_receive(bus) for _ in range(total)]
            assert all(message.is_rx == (message.arbitration_id != own_id) for message in messages)
            orders.append([(message.arbitration_id, bytes(message.data)) for message in messages])
            assert bus.recv(0.0) is None
        assert orders[0] == orders[1]


def test_filters_hold_for_both_ways_of_receiving(hub: HubProcess) -> None:
    rules = [
        {"can_id": 0x100, "can_mask": 0x7F0, "extended": False},
        {"can_id": 0x5, "can_mask": 0xF},
    ]
    sent = [
        Frame(0x100, b""),
        Frame(0x100, b"", EXTENDED),
        Frame(0x10F, b""),
        Frame(0x110, b""),
        Frame(0x765, b""),
        Frame(0x18765, b"", EXTENDED),
    ]
    passed = [sent[0], sent[2], sent[4], sent[5]]
    with hub.bus() as sender, hub.bus(can_filters=rules) as bus:
        sender.send_frames([Frame(0x200, b"")])
        sender.send_frames(sent)
        assert bus.recv_frames(PATIENCE_S) == passed
        sender.send_frames(sent)
        assert [_receive(bus).arbitration_id for _ in passed] == [frame.can_id for frame in passed]
        assert bus.recv(0.0) is None
        bus.set_filters(None)
        sender.send_frames(sent)
        assert bus.recv_frames(PATIENCE_S) == sent


def test_the_descriptor_is_readable_as_long_as_frames_are_left(pair: tuple[HubBus, HubBus]) -> None:
    one, other = pair

    def readable(timeout_s: float) -> bool:
        return bool(select.select([other.fileno()], [], [], timeout_s)[0])

    assert not readable(0.0)
    for number in range(3):
        one.send_frames([Frame(number, b"")] * 5)
    for count in range(15):
        assert readable(PATIENCE_S), f"{count} of 15 frames read"
        assert other.recv(PATIENCE_S) is not None
    assert not readable(0.0)


def test_an_asyncio_notifier_gets_every_frame_of_a_batch(pair: tuple[HubBus, HubBus]) -> None:
    one, other = pair

    async def listen() -> list[int]:
        reader = can.AsyncBufferedReader()
        notifier = can.Notifier(other, [reader], loop=asyncio.get_running_loop())
        one.send_frames([Frame(number, b"") for number in range(40)])
        received = [(await asyncio.wait_for(reader.get_message(), PATIENCE_S)).arbitration_id for _ in range(40)]
        notifier.stop()
        return received

    assert asyncio.run(listen()) == list(range(40))


def test_what_a_client_sent_just_before_it_left_is_delivered(hub: HubProcess) -> None:
    with hub.bus() as reader:
        for number in range(20):
            with hub.bus() as visitor:
                # Input that the visitor never reads: its close is then a reset, which must not lose its output.
                reader.send_frames([Frame(0x600, b"")] * 10)
                visitor.send_frames([Frame(number, b"bye")] * 256)
                visitor.send_frames([Frame(number, b"bye")] * 256)
            assert [reader.recv_frames(PATIENCE_S) for _ in range(2)] == [[Frame(number, b"bye")] * 256] * 2


def test_leaving_waits_for_a_busy_hub_to_take_what_was_sent(hub: HubProcess) -> None:
    with hub.bus() as reader, hub.bus() as visitor:
        reader.send_frames([Frame(0x600, b"")])
        assert select.select([visitor.fileno()], [], [], PATIENCE_S)[0]
        hub.process.send_signal(signal.SIGSTOP)
        batch = [Frame(0x100, b"bye")] * 256
        taken = 0
        with contextlib.suppress(SendTimeout):
            while taken < 100_000:
                visitor.send_frames(batch, timeout_s=0.0)
                taken += 1
        # The socket buffers are full and the visitor has unread input: a plain close would lose the buffers (TCP).
        wake = threading.Timer(0.2, hub.process.send_signal, (signal.SIGCONT,))
        wake.start()
        visitor.shutdown()
        wake.join()
        for _ in range(taken):
            assert reader.recv_frames(PATIENCE_S) == batch
        assert reader.recv_frames(0.0) == []


def test_timeouts_return_nothing(pair: tuple[HubBus, HubBus]) -> None:
    one, _ = pair
    for timeout_s in (0.0, 0.002):
        assert one.recv(timeout_s) is None
        assert one.recv_frames(timeout_s) == []


def test_fd_frames_need_fd_and_bad_frames_send_nothing(hub: HubProcess) -> None:
    with hub.bus() as plain, hub.bus() as other:
        with pytest.raises(can.CanOperationError, match="fd=True"):
            plain.send(_message(1, b"x" * 12, is_fd=True))
        with pytest.raises(can.CanOperationError, match="fd=True"):
            plain.send_frames([Frame(1, b""), Frame(1, b"x", FD)])
        with pytest.raises(ValueError, match="allowed"):
            plain.send_frames([Frame(1, b""), Frame(0x800, b"")])
        plain.send_frames([Frame(2, b"")])
        assert other.recv_frames(PATIENCE_S) == [Frame(2, b"")]


def test_a_passive_bus_listens_only(pair: tuple[HubBus, HubBus]) -> None:
    one, other = pair
    one.state = can.BusState.PASSIVE
    with pytest.raises(can.CanOperationError, match="listen only"):
        one.send(_message(1))
    other.send(_message(2))
    assert _receive(one).arbitration_id == 2
    one.state = can.BusState.ACTIVE
    one.send(_message(3))
    assert _receive(other).arbitration_id == 3


def test_a_bus_that_is_shut_down_says_so(hub: HubProcess) -> None:
    bus = hub.bus()
    bus.shutdown()
    bus.shutdown()
    for call in (lambda: bus.send(_message(1)), lambda: bus.recv(0.0), lambda: bus.recv_frames(0.0), bus.fileno):
        with pytest.raises(can.CanOperationError, match="shut down"):
            call()


def test_send_times_out_on_a_hub_that_does_not_read_and_nothing_taken_is_lost() -> None:
    with running_hub() as hub, hub.bus() as bus, hub.bus() as other:
        hub.process.send_signal(signal.SIGSTOP)
        taken = 0

        def flood() -> None:
            nonlocal taken
            while taken < 100_000:
                bus.send(_message(0x100, taken.to_bytes(4, "big")), timeout=0.0)
                taken += 1

        with pytest.raises(SendTimeout) as caught:
            flood()
        assert isinstance(caught.value, can.CanTimeoutError)
        assert isinstance(caught.value, can.CanOperationError)
        with pytest.raises(SendTimeout):
            bus.send_frames([Frame(1, b"")], timeout_s=0.001)
        hub.process.send_signal(signal.SIGCONT)
        for number in range(taken):
            assert other.recv_frames(PATIENCE_S) == [Frame(0x100, number.to_bytes(4, "big"))]
