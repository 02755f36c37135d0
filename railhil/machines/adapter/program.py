"""The command line of the emulated serial CAN adapter.

The serial port (a pseudo-terminal) appears under PATH; the bus behind it is any python-can interface. Commands are read
from standard input, one per line (:class:`railhil.machines.adapter.emulator.Emulator` lists them)::

    railhil bus hub -c hub.sock &
    python -m railhil.machines.adapter --link ttyEMU -i railhil -c hub.sock
    railhil node controller -i slcan -c ttyEMU -b 500000 --bus-kwargs sleep_after_open=0
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.bus.link import open_link
from railhil.bus.select import choose_bus
from railhil.common.command_line import OneLineParser, parse, whole_number
from railhil.machines.adapter.device import BIT_RATES, Build
from railhil.machines.adapter.emulator import Emulator
from railhil.machines.adapter.terminal import Terminal

_COMMANDS = """\
commands on standard input, one a line; with S seconds it is undone by itself after that time:
  unplug [S]   the port vanishes with the adapter's power; replug: a new port under the same name
  busoff [S]   nothing comes or goes on the bus; restart: on the bus again
  stall [S]    the adapter reads nothing from the host; resume: it reads again
  garble N     the next N bytes to the host are turned into other bytes
  status       the state as one line of JSON, with which every command is answered
  quit         unplugged for good

exit codes: 0 after quit, 2 for a wrong command line or a bus that cannot be opened, 3 when the bus is gone, 130 after
Ctrl-C"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Serve until SIGTERM, Ctrl-C, ``quit`` or the end of the bus."""
    parser = OneLineParser(
        prog="python -m railhil.machines.adapter", description="Emulated serial CAN adapter (slcan).", epilog=_COMMANDS
    )
    parser.add_argument("--link", type=Path, required=True, metavar="PATH", help="where the serial port appears")
    parser.add_argument("--serial-rate", type=whole_number(0, 12_000_000), default=0, metavar="BAUD",
                        help="pace of the serial line (default 0: as fast as it goes, as over USB)")  # fmt: skip
    parser.add_argument("--queue", type=whole_number(1, 4096), default=Build().transmit_queue_frames, metavar="FRAMES",
                        help="size of the transmit queue (default %(default)s)")  # fmt: skip
    parser.add_argument("--bus-bit-rate", type=int, choices=BIT_RATES, metavar="BPS",
                        help="only a host that sets this bit rate hears the bus (default: any does)")  # fmt: skip
    parser.add_argument("--no-answers", action="store_true",
                        help="firmware that does not answer commands and frames")  # fmt: skip
    add_bus_arguments(parser)
    namespace = parse(parser, arguments)
    if namespace.link.exists() and not namespace.link.is_symlink():
        parser.error(f"--link: {namespace.link} is there and is no symbolic link")
    choice = choose_bus(named_bus(namespace))
    build = Build(
        transmit_queue_frames=namespace.queue, bus_bit_rate=namespace.bus_bit_rate, answers=not namespace.no_answers
    )
    link = open_link(choice.config)
    try:
        emulator = Emulator(
            Terminal(namespace.link), build, link, serial_rate_baud=namespace.serial_rate,
            commands_fd=sys.stdin.fileno(), say=lambda line: print(line, flush=True),
        )  # fmt: skip
        print(f"adapter: {namespace.link} on {choice.transport}", file=sys.stderr, flush=True)
        emulator.run()
    finally:
        link.close()
    return 0
