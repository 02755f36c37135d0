"""python-can's options and configuration. python-can itself is imported only when a setting is used.

Its import loads every log format with its libraries (with asammdf installed also pandas), in every process that reads
these options. Options, help and messages are python-can's own; a test compares them.
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
    """The options of ``can.cli.add_bus_arguments``."""
    group = parser.add_argument_group("bus arguments")

    def add(*flags: str, **settings: Any) -> None:
        group.add_argument(*flags, default=argparse.SUPPRESS, **settings)

    channel = "Most backend interfaces require some sort of channel. For example with the serial interface the channel "
    channel += 'might be a rfcomm device: "/dev/rfcomm0". With the socketcan interface valid channel examples include: '
    add("-c", "--channel", metavar="CHANNEL", help=f'{channel}"can0", "vcan0".')
    interface = (
        "Specify the backend CAN interface to use. If left blank, fall back to reading from configuration files."
    )
    # A metavar of its own would hide the names in the help.
    add("-i", "--interface", choices=Interfaces(), help=interface)
    add("-b", "--bitrate", type=int, metavar="BITRATE", help="Bitrate to use for the CAN bus.")
    add("--fd", action="store_true", help="Activate CAN-FD support")
    data = "Bitrate to use for the data phase in case of CAN-FD."
    add("--data-bitrate", type=int, metavar="DATA_BITRATE", help=data)
    timing = "Configure bit rate and bit timing. For example, use `--timing f_clock=8_000_000 tseg1=5 tseg2=2 sjw=2 "
    timing += "brp=2 nof_samples=1` for classical CAN or `--timing f_clock=80_000_000 nom_tseg1=119 nom_tseg2=40 "
    timing += "nom_sjw=40 nom_brp=1 data_tseg1=29 data_tseg2=10 data_sjw=10 data_brp=1` for CAN FD. Check the "
    timing += "python-can documentation to verify whether your CAN interface supports the `timing` argument."
    several = {"nargs": argparse.ONE_OR_MORE}
    add("--timing", action=_Timing, metavar="TIMING_ARG", help=timing, **several)
    kwargs = "Pass keyword arguments down to the instantiation of the bus class. For example, `-i vector -c 1 "
    kwargs += "--bus-kwargs app_name=MyCanApp serial=1234` is equivalent to opening the bus with `can.Bus('vector', "
    kwargs += "channel=1, app_name='MyCanApp', serial=1234)"
    add("--bus-kwargs", action=_BusKwargs, metavar="BUS_KWARG", help=kwargs, **several)
