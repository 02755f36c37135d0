"""Command line of the hub process (``railhil bus hub``, ``python -m railhil.bus.hub``)."""

from __future__ import annotations

import argparse
import contextlib
import sys

from railhil.bus.can_settings import BITRATE_HELP, CHANNEL_HELP, DATA_BITRATE_HELP
from railhil.bus.errors import BusUnavailable
from railhil.bus.hub.address import default_channel
from railhil.bus.hub.portspec import parse_ports
from railhil.bus.hub.server import DEFAULT_BITRATE_BPS, DEFAULT_QUEUE_LIMIT_BYTES, HubSpec, serve
from railhil.common.command_line import add_priority_argument, whole_number
from railhil.common.scheduling import cycle
from railhil.common.streams import escape_controls

#: Upper limits, far beyond any CAN bus and any memory.
_BITRATE_MAX_BPS, _QUEUE_MAX_BYTES, _RESTART_MAX_MS = 1_000_000_000, 1 << 40, 3_600_000
_bit_rate = whole_number(1, _BITRATE_MAX_BPS)


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register ``railhil bus hub``."""
    kinds = commands.add_parser("bus").add_subparsers(dest="kind", required=True, metavar="KIND")
    parser = kinds.add_parser(
        "hub",
        help="software CAN switch (python-can interface 'railhil')",
        examples=["railhil bus hub", "railhil bus hub -c tcp://127.0.0.1:20000 --bitrate-model --arbitration"],
    )
    add_arguments(parser)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the hub's options to a parser."""
    parser.add_argument(
        "-c",
        "--channel",
        metavar="CHANNEL",
        help=f"{CHANNEL_HELP} (default: {default_channel()})",
    )
    parser.add_argument("--once", action="store_true", help="exit when all clients have left")
    parser.add_argument(
        "--bitrate-model", action="store_true", help="frames take their time on the wire (exact stuff bits)"
    )
    parser.add_argument(
        "-b",
        "--bitrate",
        type=_bit_rate,
        metavar="BPS",
        help=f"{BITRATE_HELP}, with --bitrate-model (default: {DEFAULT_BITRATE_BPS})",
    )
    parser.add_argument(
        "--data-bitrate",
        type=_bit_rate,
        metavar="BPS",
        help=f"{DATA_BITRATE_HELP}, with --bitrate-model (default: that of -b)",
    )
    parser.add_argument(
        "--arbitration",
        action="store_true",
        help="frames that wait at the same time leave in order of their identifier",
    )
    parser.add_argument(
        "--faults",
        action="store_true",
        help="take orders that disturb the bus: error counters, bus-off, two redundant lines, full transmit queue",
    )
    parser.add_argument(
        "--restart-ms",
        type=whole_number(1, _RESTART_MAX_MS),
        metavar="MS",
        help="with --faults: a bus-off client restarts by itself after this wall time (default: only by order)",
    )
    parser.add_argument(
        "--queue-limit",
        type=whole_number(1, _QUEUE_MAX_BYTES),
        default=DEFAULT_QUEUE_LIMIT_BYTES,
        metavar="BYTES",
        help="how far a client may fall behind before it is disconnected (default: %(default)s)",
    )
    parser.add_argument(
        "--port",
        action="append",
        default=[],
        metavar="INTERFACE:CHANNEL[,KEY=VALUE...]",
        help="another python-can bus that frames are carried to and from (gateway); may be given several times",
    )
    parser.add_argument(
        "--lossless",
        action="store_true",
        help="for lockstep: frames wait for a --port that is full or down, instead of being dropped",
    )
    add_priority_argument(parser, 0, "0")


def work(args: argparse.Namespace) -> int:
    """Run the hub with the parsed options; returns the exit code (0, or 2 with one line on standard error)."""
    try:
        if not args.bitrate_model and (args.bitrate is not None or args.data_bitrate is not None):
            option = "-b/--bitrate" if args.bitrate is not None else "--data-bitrate"
            raise BusUnavailable(f"option {option}: found without --bitrate-model, allowed: only with it")
        if args.lossless and not args.port:
            raise BusUnavailable("option --lossless: found without --port, allowed: only with it")
        if args.restart_ms is not None and not args.faults:
            raise BusUnavailable("option --restart-ms: found without --faults, allowed: only with it")
        channel = args.channel or default_channel()
        ports = parse_ports(args.port, channel)
        bitrate_bps = (args.bitrate or DEFAULT_BITRATE_BPS) if args.bitrate_model else None
        hub = HubSpec(
            once=args.once,
            bitrate_bps=bitrate_bps,
            data_bitrate_bps=args.data_bitrate,
            arbitration=args.arbitration,
            queue_limit_bytes=args.queue_limit,
            ports=ports,
            lossless=args.lossless,
            faults=args.faults,
            restart_ms=args.restart_ms or 0,
        )
        # A hub that serves several runs keeps its garbage collector enabled.
        around = cycle("hub", args.realtime_priority) if args.realtime_priority else contextlib.nullcontext()
        with around:
            serve(channel, hub)
    except BusUnavailable as error:
        print(escape_controls(f"railhil bus hub: error: {error}"), file=sys.stderr)
        return 2
    return 0
