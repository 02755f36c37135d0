"""The hub process: listens, says what it is, serves until a signal or the last client's leave, tidies up."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator

from bus.hub.address import Address, file_identity, listen, parse_channel, remove_socket_file
from bus.hub.model import WireModel
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
) -> None:
    """Run a hub on ``channel`` (a path, or ``tcp://127.0.0.1:PORT``) until SIGTERM or SIGINT.

    ``once``: end when the last client has left. ``bitrate_bps``: model the wire time of frames (None: no
    wire time), CAN FD data phases at ``data_bitrate_bps`` (None: the same). ``arbitration``: frames that
    wait at the same time leave by identifier. ``queue_limit_bytes``: how far a client may fall behind
    before it is cut off.

    A stop first hands out, for at most a second, what clients had already sent.

    Prints one line to standard output when clients may connect, and one to standard error for each client
    cut off. Raises :class:`bus.errors.BusUnavailable` when the channel cannot be had.
    """
    data_bitrate_bps = bitrate_bps if data_bitrate_bps is None else data_bitrate_bps
    model = None
    if bitrate_bps is not None or arbitration:
        model = WireModel(bitrate_bps, data_bitrate_bps, arbitration)
    listener, address = listen(parse_channel(channel))
    identity = None if address.path is None else file_identity(address.path)
    try:
        switch = Switch(
            listener,
            queue_limit_bytes=queue_limit_bytes,
            properties={
                "bitrate_model": bitrate_bps is not None,
                "arbitration": arbitration,
                "bitrate_bps": bitrate_bps,
                "data_bitrate_bps": data_bitrate_bps,
                "queue_limit_bytes": queue_limit_bytes,
            },
            report=_report,
            model=model,
            once=once,
        )
        with contextlib.closing(switch), _stopped_by_signals(switch):
            print(_ready_line(address, bitrate_bps, data_bitrate_bps, arbitration), flush=True)
            switch.run()
    finally:
        if address.path is not None and identity is not None:
            remove_socket_file(address.path, listener, identity)
        else:
            listener.close()


def _ready_line(address: Address, bitrate_bps: int | None, data_bitrate_bps: int | None, arbitration: bool) -> str:
    time_model = "no bit rate"
    if bitrate_bps is not None:
        time_model = f"bit rate {bitrate_bps} bit/s (FD data {data_bitrate_bps} bit/s), exact stuff bits"
    order_model = "arbitration by identifier" if arbitration else "no arbitration"
    return f"railhil hub ready at {address}: {time_model}; {order_model}; no error counters, no bus-off"


def _report(line: str) -> None:
    # A closed standard error (a parent that went away) is no reason to stop carrying frames.
    with contextlib.suppress(OSError):
        print(f"railhil hub: {line}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def _stopped_by_signals(switch: Switch) -> Iterator[None]:
    """SIGTERM and SIGINT end the switch's loop (only when it runs in the main thread)."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    numbers = (signal.SIGTERM, signal.SIGINT)
    previous = [signal.signal(number, lambda *_: switch.stop()) for number in numbers]
    try:
        yield
    finally:
        for number, handler in zip(numbers, previous, strict=True):
            signal.signal(number, handler)
