"""The hub process: listens, says what it is, serves until a signal or the last client's leave, tidies up."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator, Sequence

from bus.hub.address import Address, file_identity, listen, parse_channel, remove_socket_file
from bus.hub.gateway import BusPort
from bus.hub.model import WireModel
from bus.hub.portspec import PROGRAM, PortSpec
from bus.hub.switch import Switch

DEFAULT_QUEUE_LIMIT_BYTES = 64 << 20
DEFAULT_BITRATE_BPS = 500_000


def serve(
    channel: str,
    *,
    once: bool = False,
    bitrate_bps: int | None = None,
    data_bitrate_bps: int | None = None,
    arbitration: bool = False,
    queue_limit_bytes: int = DEFAULT_QUEUE_LIMIT_BYTES,
    ports: Sequence[PortSpec] = (),
    lossless: bool = False,
) -> None:
    """Run a hub on ``channel`` (a path, or ``tcp://127.0.0.1:PORT``) until SIGTERM or SIGINT.

    ``once``: end when the last client has left. ``bitrate_bps``: model the wire time of frames (None: no
    wire time), CAN FD data phases at ``data_bitrate_bps`` (None: the same). ``arbitration``: frames that
    wait at the same time leave by identifier. ``queue_limit_bytes``: how far a client may fall behind
    before it is cut off. ``ports``: other buses that frames are carried to and from; ``lossless``: frames for
    them wait when they are full or down (lockstep) instead of being dropped.

    A stop first hands out, for at most a second, what clients had already sent.

    Prints one line to standard output when clients may connect, and one to standard error for each client
    cut off, for each bus that goes or comes back, and at the end or SIGUSR1 for what each bus has carried.
    Raises :class:`bus.errors.BusUnavailable` when the channel or a port cannot be had.
    """
    data_bitrate_bps = bitrate_bps if data_bitrate_bps is None else data_bitrate_bps
    model = None
    if bitrate_bps is not None or arbitration:
        model = WireModel(bitrate_bps, data_bitrate_bps, arbitration)
    listener, address = listen(parse_channel(channel))
    identity = None if address.path is None else file_identity(address.path)
    bus_ports: list[BusPort] = []
    try:
        for spec in ports:
            bus_ports.append(BusPort(spec, lossless=lossless, report=_report))
        switch = Switch(
            listener,
            queue_limit_bytes=queue_limit_bytes,
            properties={
                "bitrate_model": bitrate_bps is not None,
                "arbitration": arbitration,
                "bitrate_bps": bitrate_bps,
                "data_bitrate_bps": data_bitrate_bps,
                "queue_limit_bytes": queue_limit_bytes,
                "ports": [spec.transport for spec in ports],
            },
            report=_report,
            model=model,
            once=once,
            bus_ports=bus_ports,
        )
        with contextlib.closing(switch), _stopped_by_signals(switch):
            print(_ready_line(address, bitrate_bps, data_bitrate_bps, arbitration, ports), flush=True)
            switch.run()
            switch.report_statistics()
    finally:
        for port in bus_ports:
            port.close()
        if address.path is not None and identity is not None:
            remove_socket_file(address.path, listener, identity)
        else:
            listener.close()


def _ready_line(
    address: Address,
    bitrate_bps: int | None,
    data_bitrate_bps: int | None,
    arbitration: bool,
    ports: Sequence[PortSpec],
) -> str:
    time_model = "no bit rate"
    if bitrate_bps is not None:
        time_model = f"bit rate {bitrate_bps} bit/s (FD data {data_bitrate_bps} bit/s), exact stuff bits"
    order_model = "arbitration by identifier" if arbitration else "no arbitration"
    others = f"; gateway to {', '.join(spec.transport for spec in ports)}" if ports else ""
    return f"railhil hub ready at {address}: {time_model}; {order_model}; no error counters, no bus-off{others}"


def _report(line: str) -> None:
    # A closed standard error (a parent that went away) is no reason to stop carrying frames.
    with contextlib.suppress(OSError):
        print(f"{PROGRAM}: {line}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def _stopped_by_signals(switch: Switch) -> Iterator[None]:
    """SIGTERM and SIGINT end the switch's loop, SIGUSR1 lets it report (only when it runs in the main thread)."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    actions = {signal.SIGTERM: switch.stop, signal.SIGINT: switch.stop, signal.SIGUSR1: switch.tell}
    previous = {number: signal.signal(number, lambda *_, act=act: act()) for number, act in actions.items()}
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
