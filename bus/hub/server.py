"""The hub process: listens, prints its properties, serves until a signal or until the last client leaves, cleans up."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from railhil.bus.hub.address import Address, file_identity, listen, parse_channel, remove_socket_file
from railhil.bus.hub.disturbed_bus import Disturbance
from railhil.bus.hub.portspec import PROGRAM, PortSpec
from railhil.bus.hub.switch import Switch
from railhil.bus.hub.wire_model import WireModel
from railhil.common.exit_codes import ending_signals
from railhil.common.streams import announce, escape_controls

if TYPE_CHECKING:
    from railhil.bus.hub.gateway import BusPort

DEFAULT_QUEUE_LIMIT_BYTES = 64 << 20
DEFAULT_BITRATE_BPS = 500_000
#: A stop while a port is opened is an exception. A driver may catch it, and the interpreter drops it where no caller
#: can receive it, as in the callback of a weak reference. It is therefore raised again after this time.
_STOP_AGAIN_S = 0.05


@dataclass(frozen=True, slots=True)
class HubSpec:
    """What a hub models, and how it serves.

    :param once: end when the last client has left.
    :param bitrate_bps: model the wire time of frames; None: no wire time.
    :param data_bitrate_bps: of the data phases of CAN FD frames; None: as ``bitrate_bps``.
    :param arbitration: frames that wait at the same time are sent by priority of their identifiers.
    :param queue_limit_bytes: how far a client may fall behind before it is disconnected.
    :param ports: other buses to which frames are forwarded in both directions.
    :param lossless: frames for ``ports`` wait when they are full or down (lockstep) instead of being dropped.
    :param faults: model the CAN controllers and the two lines of the clients, and take orders that disturb them
        (:mod:`railhil.bus.hub.disturbances`).
    :param restart_ms: wall time after which a bus-off controller restarts by itself; 0: only by order.
    """

    once: bool = False
    bitrate_bps: int | None = None
    data_bitrate_bps: int | None = None
    arbitration: bool = False
    queue_limit_bytes: int = DEFAULT_QUEUE_LIMIT_BYTES
    ports: Sequence[PortSpec] = ()
    lossless: bool = False
    faults: bool = False
    restart_ms: int = 0

    @property
    def fd_data_bitrate_bps(self) -> int | None:
        """Bit rate of the data phases of CAN FD frames; None: no wire time."""
        return self.bitrate_bps if self.data_bitrate_bps is None else self.data_bitrate_bps

    def properties(self) -> dict[str, object]:
        """The hub's answer to the hello of a client."""
        return {
            "bitrate_model": self.bitrate_bps is not None,
            "arbitration": self.arbitration,
            "bitrate_bps": self.bitrate_bps,
            "data_bitrate_bps": self.fd_data_bitrate_bps,
            "queue_limit_bytes": self.queue_limit_bytes,
            "faults": self.faults,
            "restart_ms": self.restart_ms,
            "ports": [spec.transport for spec in self.ports],
        }

    def make_model(self) -> WireModel | None:
        """The wire; None: frames take no time and do not arbitrate."""
        if self.bitrate_bps is None and not self.arbitration:
            return None
        return WireModel(self.bitrate_bps, self.fd_data_bitrate_bps, self.arbitration)

    def make_disturbance(self) -> Disturbance | None:
        """The CAN controllers and lines of the clients; None: they are not modelled."""
        bit_ns = 1e9 / self.bitrate_bps if self.bitrate_bps else 0.0
        return Disturbance(self.restart_ms, bit_ns) if self.faults else None

    def ready_line(self, address: Address) -> str:
        """The line that says that clients may connect, and what is modelled."""
        time_model = "no bit rate"
        if self.bitrate_bps is not None:
            fd_data = f"FD data {self.fd_data_bitrate_bps} bit/s"
            time_model = f"bit rate {self.bitrate_bps} bit/s ({fd_data}), exact stuff bits"
        order_model = "arbitration by identifier" if self.arbitration else "no arbitration"
        others = f"; gateway to {', '.join(spec.transport for spec in self.ports)}" if self.ports else ""
        fault_model = (
            "error counters, bus-off and two lines by order" if self.faults else "no error counters, no bus-off"
        )
        return f"railhil hub ready at {address}: {time_model}; {order_model}; {fault_model}{others}"


def serve(channel: str, hub: HubSpec) -> None:
    """Run a hub on ``channel`` (a path, or ``tcp://127.0.0.1:PORT``) until SIGTERM, SIGINT or SIGHUP.

    A stop first delivers, for at most a second, the packets that clients had already sent. At the start the hub waits
    for another hub behind a port; a stop ends that wait too.

    Prints one line to standard output when clients may connect (it serves, too, if nobody reads that), and one to
    standard error for each client disconnected, for each bus that goes down or comes back, and at the end or on SIGUSR1
    the statistics of each bus. Raises :class:`railhil.bus.errors.BusUnavailable` when the channel or a port cannot be
    opened.
    """
    with _Signals() as signals:
        listener, address = listen(parse_channel(channel))
        identity = None if address.path is None else file_identity(address.path)
        bus_ports: list[BusPort] = []
        try:
            with signals.interrupting():
                for spec in hub.ports:
                    from railhil.bus.hub.gateway import BusPort

                    bus_ports.append(BusPort(spec, lossless=hub.lossless, report=_report))
            switch = Switch(
                listener,
                queue_limit_bytes=hub.queue_limit_bytes,
                properties=hub.properties(),
                report=_report,
                model=hub.make_model(),
                disturbance=hub.make_disturbance(),
                once=hub.once,
                bus_ports=bus_ports,
            )
            with contextlib.closing(switch), signals.sent_to(switch):
                announce(hub.ready_line(address))
                switch.run()
                switch.report_statistics()
        except _StoppedAtStart:
            # No frame has been carried yet.
            pass
        finally:
            for port in bus_ports:
                port.close()
            if address.path is not None and identity is not None:
                remove_socket_file(address.path, listener, identity)
            else:
                listener.close()


def _report(line: str) -> None:
    # A closed standard error (the parent has ended) must not stop the hub.
    with contextlib.suppress(OSError):
        print(escape_controls(f"{PROGRAM}: {line}"), file=sys.stderr, flush=True)


class _StoppedAtStart(BaseException):
    """A signal came before the switch ran; a separate class, so that a driver being opened does not treat it as its own
    error."""


class _Signals:
    """SIGTERM, SIGINT and SIGHUP end the hub, SIGUSR1 makes it report, from the very start (main thread only)."""

    def __init__(self) -> None:
        self._is_stopped = False
        self._may_interrupt = False
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            for number in ending_signals():
                self._previous[number] = signal.signal(number, self._stop)
            self._previous[signal.SIGUSR1] = signal.signal(signal.SIGUSR1, self._tell)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)

    @contextlib.contextmanager
    def interrupting(self) -> Iterator[None]:
        """Let a stop signal end the block, by :class:`_StoppedAtStart`; SIGALRM raises it again until the block ends.

        An error of the block after a stop comes from the interruption: a driver that catches everything turns the stop
        into an error, and so does CPython when a second signal comes in between.
        """
        if not self._previous:
            yield
            return
        unraisable = sys.unraisablehook
        alarm, timer = signal.signal(signal.SIGALRM, self._interrupt), signal.setitimer(signal.ITIMER_REAL, 0)
        sys.unraisablehook = lambda lost: None if lost.exc_type is _StoppedAtStart else unraisable(lost)
        try:
            try:
                self._may_interrupt = True
                if self._is_stopped:
                    raise _StoppedAtStart
                yield
            except Exception:
                if self._is_stopped:
                    raise _StoppedAtStart from None
                raise
            finally:
                self._may_interrupt = False
        finally:
            # The alarm is switched off a second time: it may have come before the first call was done.
            self._may_interrupt = False
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, alarm)
            signal.setitimer(signal.ITIMER_REAL, *timer)
            sys.unraisablehook = unraisable

    @contextlib.contextmanager
    def sent_to(self, switch: Switch) -> Iterator[None]:
        """Pass the signals to the switch during the block.

        They go through its descriptor, because a compiled loop goes to sleep without looking for signals.
        """
        if not self._previous:
            yield
            return
        before = signal.set_wakeup_fd(switch.wake_fd, warn_on_full_buffer=False)
        if self._is_stopped:
            switch.stop()
        try:
            yield
        finally:
            signal.set_wakeup_fd(before)

    def _stop(self, *_: object) -> None:
        self._is_stopped = True
        self._interrupt()

    def _interrupt(self, *_: object) -> None:
        if self._may_interrupt:
            signal.setitimer(signal.ITIMER_REAL, _STOP_AGAIN_S)
            raise _StoppedAtStart

    def _tell(self, *_: object) -> None:
        """Only a running switch has counters to report, and its descriptor has passed the request on."""
