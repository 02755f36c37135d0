"""Another python-can bus as a port of the hub, which makes the hub a gateway.

The bus is a :class:`railhil.bus.link.Link`, which handles adapters that fail and come back. The switch passes frames
to and from it without waiting, directly through the adapter's descriptor. Operations that may take long run in a thread
of the port: waiting for a bus that is down, and reading a bus through python-can's own driver. The hub is not a node of
the control path, and nothing else reads the link meanwhile.

::

                    +--------------- BusPort ---------------+
    switch -------- | queue ----------------> GatewayLink.offer|----> bus
           <------- | Link.receive(0) <-- descriptor -------|<----
                    | arrivals <- thread: Link.receive, open |
                    +---------------------------------------+

Error frames report on the wire from which they come, and are not forwarded.
"""

from __future__ import annotations

import contextlib
import select
import threading
import time
from collections import Counter
from collections.abc import Callable

from railhil.bus.errors import BusLost
from railhil.bus.frame import ERROR, FD, Frame
from railhil.bus.hub.gateway_queues import Arrivals, Backlog
from railhil.bus.hub.link import BatchLink
from railhil.bus.hub.ports import SwitchPort
from railhil.bus.hub.portspec import PortSpec, descriptor_of, open_port, open_port_again, takes_fd
from railhil.bus.packing import pack_frames, unpack_frames
from railhil.common.digits import count_of

#: A full bus is tried again after this time (a frame takes 0.25 ms at 500 kbit/s), then after twice that, and so on.
RETRY_NS = 500_000
RETRY_MAX_NS = 4_000_000
#: Interval for a bus that is down, or whose driver may block on each attempt.
SLOW_RETRY_NS = 20_000_000
_OPEN_RETRY_S = 0.2
#: Long enough to query the state of a silent serial adapter.
_THREAD_LOOK_S = 0.1
_READS_AT_ONCE = 256
_SHOWN_FIRST = ("received", "sent", "outages")


class BusPort(SwitchPort):
    """A python-can bus as a port.

    ``counters``: ``dropped`` (frames that the bus did not take in time), ``fd_dropped`` (CAN FD frames for a bus
    without CAN FD), ``local_error_frames`` (not forwarded), ``rx_lost`` (frames of the bus that the switch did not read
    in time), in addition to those of the link.

    :param lossless: for lockstep: frames wait for a full or missing bus (:mod:`railhil.bus.hub.gateway_queues`);
        otherwise they wait briefly for a full bus and not at all for a missing one, so that nothing old is sent later.
    :param report: called with one line.
    :raises BusUnavailable: the bus cannot be opened.
    """

    def __init__(self, spec: PortSpec, *, lossless: bool, report: Callable[[str], None]) -> None:
        super().__init__(f"port {spec.transport}")
        self.is_client = False
        self.is_member = True
        self.counters: Counter[str] = Counter()
        #: Counters of links that had to be replaced.
        self._earlier: Counter[str] = Counter()
        self._spec, self._lossless, self._report = spec, lossless, report
        self._backlog = Backlog(lossless)
        self._arrivals = Arrivals()
        self._thread: threading.Thread | None = None
        self._thread_is_done = False
        self._closing = threading.Event()
        #: Descriptor of the bus that the epoll descriptor watches; None while the thread has the bus.
        self._watched_fd: int | None = None
        #: The link has given up and must be opened again.
        self._is_lost = False
        self._lost_s = 0.0
        self._link = open_port(spec, lossless)
        self._takes_fd = takes_fd(self._link)
        self._epoll = select.epoll()
        self._epoll.register(self._arrivals.fileno(), select.EPOLLIN)
        self._has_descriptor = descriptor_of(self._link) is not None
        self._first_retry_ns = RETRY_NS if self._has_descriptor else SLOW_RETRY_NS
        self._retry_ns = self._first_retry_ns
        self._attend()

    # --- called by the switch -----------------------------------------------------------------------------

    def fileno(self) -> int:
        """See :meth:`SwitchPort.fileno`; unchanged when the bus is reopened."""
        return self._epoll.fileno()

    def receive(self) -> list[bytes]:
        """See :meth:`SwitchPort.receive`."""
        frames = self._read() if self._thread is None else self._take_over()
        if any(frame[2] & ERROR for frame in frames):
            kept = [frame for frame in frames if not frame.flags & ERROR]
            self.counters["local_error_frames"] += len(frames) - len(kept)
            frames = kept
        return pack_frames(frames)

    def send(self, packet: bytes) -> bool:
        """See :meth:`SwitchPort.send`."""
        frames = self._suitable(unpack_frames(packet))
        if frames and not self.has_backlog and not self._is_down:
            frames = frames[self._offer(frames) :]
        return self._enqueue(frames) if frames or self._link.has_rest else False

    def flush(self) -> None:
        """See :meth:`SwitchPort.flush`."""
        if self._is_down and not self._lossless:
            self.counters["dropped"] += self._backlog.drop_all()
        self._dropped(self._backlog.drop_stale())
        if not self._is_down:
            before = self._backlog.frames
            self._backlog.give(self._offer)
            if self._link.has_rest:
                self._offer([])
            if self._backlog.frames < before:
                self._retry_ns = self._first_retry_ns
            elif self._retry_ns < RETRY_MAX_NS:
                self._retry_ns *= 2
        self._set_timer()

    def close(self) -> None:
        """See :meth:`SwitchPort.close`."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(1.0)
            if self._thread.is_alive():
                # The thread is opening a port, which cannot be interrupted; it ends with the process.
                return
        with contextlib.suppress(Exception):
            # A driver that has lost its device may raise anything while closing.
            self._link.close()
        self._epoll.close()
        self._arrivals.close()

    def statistics(self) -> str:
        """See :meth:`SwitchPort.statistics`."""
        # Each counter is copied in one step, because the thread may be counting.
        total = self.counters + Counter(dict(self._earlier)) + Counter(dict(self._link.counters))
        line = f"{count_of(total['received'], 'frame')} in, {total['sent']} out, {count_of(total['outages'], 'outage')}"
        others = [f"{name} {count}" for name, count in sorted(total.items()) if name not in _SHOWN_FIRST]
        waiting = [f"waiting {self._backlog.frames}"] if self._backlog else []
        return f"{self.name}: {', '.join([line, *others, *waiting])}"

    # --- to the bus ---------------------------------------------------------------------------------------

    @property
    def _is_down(self) -> bool:
        is_away = self._thread is not None and self._has_descriptor
        return is_away or self._is_lost or self._link.is_down

    def _suitable(self, frames: list[Frame]) -> list[Frame]:
        """The frames that this bus supports."""
        barred = ERROR if self._takes_fd else ERROR | FD
        if not any(frame[2] & barred for frame in frames):
            return frames
        suitable = []
        for frame in frames:
            if not frame.flags & barred:
                suitable.append(frame)
            elif frame.flags & ERROR:
                self.counters["local_error_frames"] += 1
            else:
                self._count("fd_dropped", "CAN FD frames are dropped, the bus was opened without fd=true")
        return suitable

    def _offer(self, frames: list[Frame]) -> int:
        """Number of frames that the bus has taken, from the first on."""
        try:
            taken = self._link.offer(frames)
        except Exception as error:
            # Drivers may raise anything; a failure of one must not affect the other buses.
            self._lost(error)
            taken = 0
        if self._link.is_down or self._is_lost:
            self._attend()
        return taken

    def _enqueue(self, frames: list[Frame]) -> bool:
        if self._is_down and not self._lossless:
            self.counters["dropped"] += len(frames)
            return False
        if frames:
            self._dropped(self._backlog.add(frames))
        is_new = not self.has_backlog
        if self.due_ns is None:
            # Frames that come later do not postpone the next attempt.
            self._retry_ns = self._first_retry_ns
            self._set_timer()
        return is_new

    def _dropped(self, frames: int) -> None:
        self._count("dropped", "frames are dropped, the bus does not take them in time", frames)

    def _set_timer(self) -> None:
        self.has_backlog = bool(self._backlog) or self._link.has_rest
        wait_ns = SLOW_RETRY_NS if self._is_down else self._retry_ns
        self.due_ns = time.monotonic_ns() + wait_ns if self.has_backlog else None

    def _count(self, name: str, words: str, count: int = 1) -> None:
        if count and not self.counters[name]:
            self._report(f"{self.name}: {words} (said once, all are counted)")
        self.counters[name] += count

    # --- from the bus -------------------------------------------------------------------------------------

    def _read(self) -> list[Frame]:
        """The frames announced by the descriptor."""
        frames: list[Frame] = []
        try:
            for _ in range(_READS_AT_ONCE):
                arrived = self._link.receive(0.0)
                frames += arrived
                # The hub gives one packet at a time; the other links read in bulk. The rest is announced again.
                if not arrived or not isinstance(self._link, BatchLink):
                    break
        except Exception as error:
            # Drivers may raise anything here, too.
            self._lost(error)
        if self._link.is_down or self._is_lost:
            self._attend()
        return frames

    def _take_over(self) -> list[Frame]:
        """The frames read by the thread; those of the bus itself once the thread has released it."""
        frames = self._arrivals.take()
        if self._thread_is_done and self._thread is not None:
            self._thread.join()
            frames += self._arrivals.take()
            self._thread = None
            self._attend()
            self.flush()
        return frames

    # --- outages ------------------------------------------------------------------------------------------

    def _lost(self, error: Exception) -> None:
        """The link has given up, or its driver has failed in a way unknown to the link."""
        if not self._link.is_down:
            self._earlier["outages"] += 1
        self._lost_s = time.monotonic()
        self._is_lost = True
        words = " ".join(str(error).split()) or type(error).__name__
        reason = words if isinstance(error, BusLost) else f"its driver has failed: {words}"
        self._report(f"{self.name} is down ({reason}); it is opened again when it is back")

    def _attend(self) -> None:
        """Let the descriptor or the thread watch the bus."""
        if self._has_descriptor and not self._link.is_down and not self._is_lost:
            self._watched_fd = self._link.bus.fileno()
            self._epoll.register(self._watched_fd, select.EPOLLIN)
            return
        if self._watched_fd is not None:
            with contextlib.suppress(OSError, ValueError):
                # It may have been closed by its driver.
                self._epoll.unregister(self._watched_fd)
            self._watched_fd = None
        if self._thread is None:
            self._thread_is_done = False
            self._thread = threading.Thread(target=self._look_after, name=self.name, daemon=True)
            self._thread.start()

    def _look_after(self) -> None:
        """Thread: read the bus, and wait for it while it is down; ends when the descriptor can be used again."""
        while not self._closing.is_set():
            if self._is_lost:
                # The pause is also made before the first attempt: a driver may open successfully and fail at once,
                # again and again.
                if self._closing.wait(_OPEN_RETRY_S) or not self._open_again():
                    continue
                self._is_lost = False
                self._report(f"{self.name} is open again after {time.monotonic() - self._lost_s:.2f} s")
            if self._has_descriptor and not self._link.is_down:
                break
            try:
                frames = self._link.receive(_THREAD_LOOK_S)
            except Exception as error:
                # Drivers may raise anything here, too.
                self._lost(error)
                continue
            if frames:
                self._count(
                    "rx_lost", "frames are lost, the hub does not carry them in time", self._arrivals.put(frames)
                )
        self._thread_is_done = True
        self._arrivals.wake()

    def _open_again(self) -> bool:
        with contextlib.suppress(Exception):
            # The remains of a lost bus may raise anything.
            self._link.close()
        link = open_port_again(self._spec, self._lossless)
        if link is None:
            return False
        self._earlier.update(self._link.counters)
        self._link = link
        return True
