"""The far end of the round trip, a process of its own: ``python -m benchmarks.echo --channel C`` or ``--fd N``."""

from __future__ import annotations

import argparse
import socket
import sys

from benchmarks.processes import hub_config
from bus.errors import BusLost
from bus.link import open_link

#: Frames that are taken and not sent back.
STREAM_ID = 0x7F0
_PACKET_BYTES = 4096


def echo_hub(channel: str) -> None:
    """Send back every frame but those of the stream, until the hub has gone."""
    link = open_link(hub_config(channel))
    try:
        while True:
            answers = [frame for frame in link.receive(None) if frame.can_id != STREAM_ID]
            if answers:
                link.send(answers)
    except BusLost:
        return
    finally:
        link.close()


def echo_socket(descriptor: int) -> None:
    """Send back every packet of an inherited SEQPACKET socket, until the other end is closed."""
    with socket.socket(fileno=descriptor) as sock:
        while packet := sock.recv(_PACKET_BYTES):
            sock.send(packet)


def main() -> int:
    """Parse the command line and echo."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.echo")
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument("--channel", help="hub on which to echo frames")
    kind.add_argument("--fd", type=int, help="inherited socket on which to echo packets")
    namespace = parser.parse_args()
    if namespace.channel is not None:
        echo_hub(namespace.channel)
    else:
        echo_socket(namespace.fd)
    return 0


if __name__ == "__main__":
    sys.exit(main())
