"""Bus administrator: publishes its own ports on their period and polls the ports of the others.

In lockstep it waits for every answer, so time stands still until the whole bench has agreed; in realtime an answer
that is later than ``reply_ns`` is a missed telegram that ages.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable

from bus.clock import Pacer
from bus.errors import BusOccupied, PeerSilent
from bus.frame import BRS, FD, Frame
from bus.layout import Telegram
from bus.link import Endpoint
from bus.mvb import F_DEVICE_STATUS, TelegramSource, master_frame, parse_device_status
from bus.store import TrafficStore
from dbc import Port, wire_contract

#: Reply time-out in realtime (the MVB's 42.7 us cannot be kept on CAN).
REPLY_NS = 5_000_000
#: Lockstep: a peer that has not answered for this long on the wall clock is lost.
WATCHDOG_NS = 2_000_000_000


class Administrator:
    """Master of the bus on one endpoint.

    :param store: mailboxes for the ports that are polled.
    :param now_ns: simulation time, asked at each reception.
    :param fd: send the CAN FD form.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        store: TrafficStore,
        now_ns: Callable[[], int],
        pacer: Pacer,
        published: Iterable[Port],
        *,
        fd: bool = False,
        watchdog_ns: int = WATCHDOG_NS,
        reply_ns: int = REPLY_NS,
    ) -> None:
        self.counters: Counter[str] = Counter()
        self._endpoint = endpoint
        self._store = store
        self._now_ns = now_ns
        self._pacer = pacer
        self._sources = {port.name: TelegramSource(port, fd) for port in published}
        # Identifiers of the frame that completes a telegram, classic and CAN FD.
        self._last_ids = {port.name: (port.can_ids[-1], port.fd_id) for port in wire_contract().ports}
        self._queue: list[Frame] = []
        self._watchdog_ns = watchdog_ns
        self._reply_ns = reply_ns

    def publish(self, telegram: Telegram) -> None:
        """Queue one telegram; it leaves with the next ``flush`` or poll."""
        self._queue.extend(self._sources[telegram.PORT].frames(telegram.encode()))

    def flush(self) -> None:
        """Send what is queued."""
        if self._queue:
            self._endpoint.send(self._queue)
            self._queue = []

    def poll(self, port: Port) -> bool:
        """Ask the owner of a port for its telegram.

        Lockstep waits for the answer; realtime gives up after the reply time-out. An answer that the store refuses
        (damaged on the way) is a missed telegram in both.

        :returns: True when the answer was committed to the store, False for a missed one.
        :raises PeerSilent: in lockstep, when no answer came within the wall-clock watchdog.
        """
        self.counters["polls"] += 1
        if self._pacer.rate:
            self._discard_late()
        self._queue.append(master_frame(port.f_code, port.address))
        self.flush()
        limit_ns = self._reply_ns if self._pacer.rate else self._watchdog_ns
        committed = self._wait_for(port, time.monotonic_ns() + limit_ns)
        if committed:
            return True
        self.counters["missed_polls"] += 1
        if committed is None and not self._pacer.rate:
            raise PeerSilent(
                f"bus administrator waits for {port.source} ({port.name}) for {limit_ns / 1e9:.1f} s, "
                f"at simulation time {self._now_ns() / 1e9:.2f} s"
            )
        return False

    def _discard_late(self) -> None:
        """Drop what came after the reply time-out: taken for the next answer, it would make each one a poll late."""
        deadline_ns = time.monotonic_ns() + self._reply_ns
        while frames := self._endpoint.receive(0.0):
            self.counters["late_frames"] += len(frames)
            if time.monotonic_ns() >= deadline_ns:
                return

    def _wait_for(self, port: Port, deadline_ns: int) -> bool | None:
        """True: an answer was committed, False: it was refused, None: no answer by the deadline."""
        receive, feed, now_ns = self._endpoint.receive, self._store.feed, self._now_ns
        name, last_ids = port.name, self._last_ids[port.name]
        while True:
            remaining_ns = deadline_ns - time.monotonic_ns()
            if remaining_ns <= 0:
                return None
            committed = None
            for frame in receive(remaining_ns / 1e9):
                if feed(frame, now_ns()) == name:
                    committed = True
                elif frame.can_id in last_ids and committed is None and not frame.flags & ~(FD | BRS):
                    committed = False
            if committed is not None:
                return committed

    def find_devices(self, devices: Iterable[int], timeout_ns: int, interval_ns: int = 100_000_000) -> set[int]:
        """Ask each device for its status (F_code 15) until all have answered or ``timeout_ns`` of wall time is over.

        :returns: the devices that did *not* answer.
        :raises BusOccupied: somebody else polls on this bus.
        """
        missing = set(devices)
        poll_id = wire_contract().poll_id
        deadline_ns = time.monotonic_ns() + timeout_ns
        while missing and time.monotonic_ns() < deadline_ns:
            self._endpoint.send([master_frame(F_DEVICE_STATUS, device) for device in sorted(missing)])
            round_ns = time.monotonic_ns() + interval_ns
            while missing and (remaining_ns := round_ns - time.monotonic_ns()) > 0:
                for frame in self._endpoint.receive(remaining_ns / 1e9):
                    if frame.can_id == poll_id and not frame.flags:
                        raise BusOccupied("another bus administrator polls on this bus: one bench at a time")
                    if frame.can_id == wire_contract().device_status_id:
                        answer = parse_device_status(frame.data)
                        if answer is not None:
                            missing.discard(answer[0])
        return missing
