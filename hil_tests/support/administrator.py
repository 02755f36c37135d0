"""A bus administrator on a fake endpoint."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hil_tests.support.clock import SetClock
from railhil.bus.administrator import Administrator, SendQueue
from railhil.bus.clock import Pacer
from railhil.bus.frame import Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.store import TrafficStore
from railhil.dbc import wire_contract
from railhil.wire.ato import CtlStat, NotchCmd

NOTCH, STAT = NotchCmd.port(), CtlStat.port()


class FakeEndpoint:
    """Answers come after a delay of wall time; everything sent is kept in order."""

    is_down = False
    is_private = False
    ended = False
    cut_off: tuple[str, ...] = ()

    def __init__(self, wall: SetClock, answer: Callable[[Frame], list[tuple[int, Frame]]] = lambda frame: []) -> None:
        self.sent: list[Frame] = []
        self.batches: list[int] = []
        self.pending: list[tuple[int, Frame]] = []
        self.wall = wall
        self._answer = answer

    def send(self, frames: Sequence[Frame]) -> None:
        self.sent += frames
        self.batches.append(len(frames))
        for frame in frames:
            self.pending += [(self.wall.now_ns + delay_ns, item) for delay_ns, item in self._answer(frame)]
        self.pending.sort(key=lambda entry: entry[0])

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """One frame per call, as python-can's recv gives them."""
        assert timeout_s is not None
        limit_ns = self.wall.now_ns + round(timeout_s * 1e9)
        if self.pending and self.pending[0][0] <= limit_ns:
            due_ns, frame = self.pending.pop(0)
            self.wall.now_ns = max(self.wall.now_ns, due_ns)
            return [frame]
        self.wall.now_ns = limit_ns
        return []

    def has_ended(self, node: str) -> bool:
        return self.ended

    def is_cut_off(self, node: str) -> bool:
        return node in self.cut_off

    def close(self) -> None:
        raise AssertionError("the administrator does not own its endpoint")


def frames_of(telegram: Telegram) -> list[Frame]:
    return TelegramSource(type(telegram).port()).frames(telegram.encode())


def make(
    endpoint: FakeEndpoint, rate: float = 0.0, now_ns: int = 0, fd: bool = False
) -> tuple[Administrator, TrafficStore]:
    store = TrafficStore([NOTCH, STAT])
    queue = SendQueue(endpoint, wire_contract(), fd=fd, realtime=bool(rate))
    pacer = Pacer(rate, endpoint.wall)
    return Administrator(endpoint, store, queue, lambda: now_ns, pacer, wire_contract()), store


def controller(delay_ns: int = 1000, notch: int = 5) -> Callable[[Frame], list[tuple[int, Frame]]]:
    """Answers polls of NOTCH_CMD with increasing life sign."""
    life = 0

    def answer(frame: Frame) -> list[tuple[int, Frame]]:
        nonlocal life
        if frame != master_frame(NOTCH.f_code, NOTCH.address):
            return []
        life += 1
        return [(delay_ns, item) for item in frames_of(NotchCmd(notch, life=life & 15))]

    return answer
