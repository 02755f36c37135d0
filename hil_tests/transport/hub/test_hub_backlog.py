"""Frames waiting for a bus of the gateway: order, age and limit of the backlog, and its packets."""

from __future__ import annotations

from hil_tests.support.clock import SetClock
from railhil.bus.frame import FD, Frame
from railhil.bus.hub import gateway_queues
from railhil.bus.hub.gateway_queues import Backlog
from railhil.bus.packing import pack_frames, unpack_frames

PLAIN = Frame(0x123, b"plain")


def test_packets_hold_256_classic_frames_or_one_fd_frame() -> None:
    classic = [Frame(k, b"") for k in range(300)]
    long = Frame(1, bytes(12), FD)
    packets = pack_frames([*classic, long, PLAIN])
    assert [len(packet) for packet in packets] == [4096, 44 * 16, 72, 16]
    assert [frame for packet in packets for frame in unpack_frames(packet)] == [*classic, long, PLAIN]
    assert pack_frames([]) == []


def test_backlog_gives_out_in_order_what_is_not_stale() -> None:
    wall = SetClock()
    given: list[int] = []

    def take_two(frames: list[Frame]) -> int:
        given.extend(frame.can_id for frame in frames[:2])
        return min(2, len(frames))

    for lossless, expected in ((False, [3, 4, 5]), (True, [0, 1, 2, 3, 4, 5])):
        given.clear()
        wall.now_ns = 0
        waiting = Backlog(lossless, wall)
        waiting.add([Frame(k, b"") for k in range(3)])
        wall.now_ns = 1
        waiting.add([Frame(k, b"") for k in range(3, 6)])
        wall.now_ns = gateway_queues.STALE_NS + 1
        assert waiting.drop_stale() == (0 if lossless else 3)
        while waiting:
            waiting.give(take_two)
        assert given == expected
        assert waiting.frames == 0


def test_backlog_is_bounded_and_the_oldest_make_room() -> None:
    waiting = Backlog(lossless=True)
    assert waiting.add([Frame(1, b"")]) == 0
    assert waiting.add([Frame(2, b"")] * (gateway_queues.LIMIT_FRAMES - 1)) == 0
    assert waiting.add([Frame(3, b"")]) == 1
    assert waiting.frames == gateway_queues.LIMIT_FRAMES
    assert waiting.drop_all() == gateway_queues.LIMIT_FRAMES
    assert not waiting
