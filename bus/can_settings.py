"""python-can's options and configuration. python-can itself is imported only when a setting is used.

Its import loads every log format with its libraries (with asammdf installed also pandas), in every process that reads
these options. Options and messages are python-can's own; a test compares them.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

#: Files in which python-can looks for settings on Linux (``can.util.CONFIG_FILES`` and ``load_environment_config``).
_FILES = ("~/can.conf", "/etc/can.conf", "~/.can", "~/.canrc")
_VARIABLES = ("CAN_INTERFACE", "CAN_CHANNEL", "CAN_BITRATE", "CAN_CONFIG")
#: Name of the hub's python-can interface.
HUB_INTERFACE = "railhil"
#: Channel of this interface between the nodes of one run: pipes, no hub.
PIPES = "pipes"
#: Used instead of an interface: all nodes run in one process, nothing is opened.
LOCAL = "local"


def has_settings(environment: Mapping[str, str] | None = None) -> bool:
    """Whether python-can's files or variables may set anything; true also in a program that uses python-can itself.

    :param environment: None: that of this process.
    """
    if "can" in sys.modules:
        return True
    environment = os.environ if environment is None else environment
    return any(name in environment for name in _VARIABLES) or any(map(_is_there, _FILES))


def _is_there(path: str) -> bool:
    """Whether there is such a file. False in a home that this user may not read, as in python-can, and without a
    home."""
    return os.path.isfile(os.path.expanduser(path))


#: Help of options that the hub has, too.
CHANNEL_HELP = (
    "channel of the interface, such as can0 or /dev/ttyACM0; of the hub a socket path or tcp://127.0.0.1:PORT"
)
BITRATE_HELP = "bit rate in bit/s"
DATA_BITRATE_HELP = "CAN FD: bit rate of the data phase in bit/s"


class Interfaces:
    """Names of the installed interfaces, in order. python-can is loaded for the list only if another interface than the
    hub is asked for."""

    def __contains__(self, name: object) -> bool:
        return name == HUB_INTERFACE or name in _installed()

    def __iter__(self) -> Iterator[str]:
        return iter(_installed())


def _installed() -> list[str]:
    import can

    return sorted(can.VALID_INTERFACES)


class _ByPythonCan(argparse.Action):
    """An option whose value is parsed by python-can's own action."""

    name: ClassVar[str]

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, *words: Any) -> None:
        from can import cli

        kind: type[argparse.Action] = getattr(cli, self.name)
        kind(self.option_strings, self.dest, self.nargs, metavar=self.metavar)(parser, namespace, *words)


class _Timing(_ByPythonCan):
    name = "_BitTimingAction"


class _BusKwargs(_ByPythonCan):
    name = "_BusKwargsAction"


def named_bus(namespace: argparse.Namespace) -> dict[str, Any]:
    """Keyword arguments of ``can.Bus`` that a command line with these options has named."""
    keys = ("interface", "channel", "bitrate", "fd", "data_bitrate", "timing")
    return {key: getattr(namespace, key) for key in keys if key in namespace} | getattr(namespace, "bus_kwargs", {})


def add_bus_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of ``can.cli.add_bus_arguments``, with a help of a line each."""
    group = parser.add_argument_group("bus (options of python-can)")

    def add(*flags: str, **settings: Any) -> None:
        group.add_argument(*flags, default=argparse.SUPPRESS, **settings)

    interface = (
        "python-can's interface, such as socketcan, slcan or pcan; railhil doctor lists those of this installation"
    )
    # Names as choices, for the message on another one; the metavar keeps them out of the help.
    add("-i", "--interface", choices=Interfaces(), metavar="INTERFACE", help=interface)
    add("-c", "--channel", metavar="CHANNEL", help=CHANNEL_HELP)
    add("-b", "--bitrate", type=int, metavar="BPS", help=BITRATE_HELP)
    add("--fd", action="store_true", help="use CAN FD")
    add("--data-bitrate", type=int, metavar="BPS", help=DATA_BITRATE_HELP)
    several = {"nargs": argparse.ONE_OR_MORE, "metavar": "KEY=VALUE"}
    add(
        "--timing",
        action=_Timing,
        help="bit timing instead of the bit rate, such as f_clock=8_000_000 brp=2",
        **several,
    )
    add("--bus-kwargs", action=_BusKwargs, help="further arguments of the interface, such as rtscts=True", **several)
