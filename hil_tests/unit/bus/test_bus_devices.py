"""Who is on the bus: the administrator asks the devices for their status before the run."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from hil_tests.support.administrator import FakeEndpoint, make
from hil_tests.support.clock import SetClock
from hil_tests.support.other_frames import OTHERS
from railhil.bus.errors import PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.ident import Role, make_ident
from railhil.bus.mvb import device_status_frame, master_frame
from railhil.dbc import wire_contract
from railhil.plant_sim.handshake import Handshake


@pytest.fixture
def wall() -> SetClock:
    return SetClock()


def test_find_devices_asks_until_all_have_answered(wall: SetClock) -> None:
    asked: list[Frame] = []

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        asked.append(frame)
        device = frame.data[1]
        if device == 1:
            return [(1000, device_status_frame(1, 0x1000)), (1000, device_status_frame(9, 0x1000))]
        # The second device is there after 0.35 s; before, it babbles.
        ready = wall.now_ns > 350_000_000
        return [(2000, device_status_frame(2, 0x1000))] if ready else [(2000, Frame(0x088, bytes(8)))]

    administrator, _ = make(FakeEndpoint(wall, answer))
    assert administrator.find_devices((1, 2), 5_000_000_000) == set()
    # Then it listens for late answers, and for a second one to a poll of each device: 30 ms each time.
    assert wall.now_ns == 400_002_000 + 3 * 30_000_000 + 3_000
    first, second = master_frame(15, 1), master_frame(15, 2)
    assert asked == [first, *[second] * 5, first, second]


def test_on_a_private_bus_nobody_else_is_looked_for(wall: SetClock) -> None:
    """Two quiet times less before the first frame. A node that comes late answers every poll, and none of its answers
    reaches the run."""

    class Private(FakeEndpoint):
        is_private = True

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        # The second device is there after 0.25 s.
        device = frame.data[1]
        ready_ns = 0 if device == 1 else 250_000_000
        return [(max(1000, ready_ns - wall.now_ns), device_status_frame(device, 0x1000))]

    endpoint = Private(wall, answer)
    administrator, _ = make(endpoint)
    assert administrator.find_devices((1, 2), 5_000_000_000) == set()
    assert wall.now_ns == 250_000_000
    assert endpoint.pending == []
    assert len(endpoint.sent) == 4


def test_on_a_private_bus_a_missing_answer_is_not_waited_for_long(wall: SetClock) -> None:
    class Private(FakeEndpoint):
        is_private = True

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        # The first of two polls is lost.
        return [(1000, device_status_frame(1, 0x1000))] if wall.now_ns else []

    administrator, _ = make(Private(wall, answer))
    assert administrator.find_devices((1,), 5_000_000_000) == set()
    assert wall.now_ns == 100_001_000 + 1_000_000_000


def test_find_devices_names_those_that_did_not_answer(wall: SetClock) -> None:
    administrator, _ = make(FakeEndpoint(wall, lambda frame: [(0, device_status_frame(1, 0x1000))]))
    assert administrator.find_devices((1, 2, 3), 1_000_000_000) == {2, 3}
    assert wall.now_ns == 1_000_000_000
    assert wire_contract().device_status_id == 0x088


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda data: data[:7], "wrong length, 7 bytes instead of 8"),
        (lambda data: data[:4] + bytes([data[4] ^ 1]) + data[5:], "wrong check sequence"),
        (lambda data: data[:5] + master_frame(1, 1).data, "wrong master word"),
    ],
)
def test_a_device_status_that_is_refused_is_not_silence(
    wall: SetClock, change: Callable[[bytes], bytes], reason: str
) -> None:
    good = device_status_frame(1, 0x1000)
    answer = good._replace(data=change(good.data))
    administrator, _ = make(FakeEndpoint(wall, lambda frame: [(0, answer)]))
    with pytest.raises(PeerSilent) as caught:
        Handshake(
            administrator, make_ident(Role.PLANT, "0" * 64, contract=wire_contract()), wire_contract(), 0.3
        ).agree()
    # Two nodes are asked three times.
    expected = f"no good answer within 0.3 s, refused on identifier 088: 6 times {reason}"
    assert str(caught.value) == f"bus administrator waits for controller and supervisor: {expected}"


def test_silence_is_called_so(wall: SetClock) -> None:
    administrator, _ = make(FakeEndpoint(wall))
    with pytest.raises(PeerSilent, match=r"waits for controller and supervisor: no answer within 0\.3 s$"):
        Handshake(
            administrator, make_ident(Role.PLANT, "0" * 64, contract=wire_contract()), wire_contract(), 0.3
        ).agree()


def test_a_device_status_that_is_not_ours_is_no_answer(wall: SetClock) -> None:
    """Extended, remote and FD frames on its identifier, and on that of the polls: nobody is there, and nobody polls."""
    administrator, _ = make(FakeEndpoint(wall, lambda frame: [(10, other) for other in OTHERS]))
    assert administrator.find_devices([1], 10_000_000) == {1}
