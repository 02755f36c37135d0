"""Selects the bus: the user's choice, else kernel SocketCAN if vcan0 exists, else the user-space hub.

The choice and its reason are always printed. Interface and channel use python-can's names, flags and configuration
files, without additions.
"""

from __future__ import annotations

import socket
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE, LOCAL, PIPES, has_settings
from railhil.bus.hub.address import OWN_HUB_START_S, default_channel
from railhil.common.errors import InputError, OptionError, Words

_DEFAULT_VCAN = "vcan0"


@dataclass(frozen=True, slots=True)
class BusChoice:
    """``config``: keyword arguments of ``can.Bus``; ``reason``: one clause; ``needs_hub``: the caller must start the
    hub; ``needs_pipes``: it must make the pipes between the nodes."""

    config: dict[str, Any]
    reason: str
    needs_hub: bool = False
    arguments: list[str] = field(default_factory=list)
    needs_pipes: bool = False

    @property
    def is_private(self) -> bool:
        """True for a bus that exists for this run alone: nobody else is on it, and nothing is lost there."""
        return self.needs_hub or self.needs_pipes

    @property
    def transport(self) -> str:
        """``interface:channel`` as shown in reports; ``local`` without a bus."""
        if self.config.get("interface") == LOCAL:
            return LOCAL
        return f"{self.config.get('interface')}:{self.config.get('channel', '')}"

    @property
    def fd(self) -> bool:
        """True when telegrams are sent in the CAN FD form."""
        return bool(self.config.get("fd", False))


def vcan_available(channel: str = _DEFAULT_VCAN) -> bool:
    """True when the kernel has AF_CAN and an interface of this name."""
    if not hasattr(socket, "AF_CAN"):
        return False
    try:
        with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as probe:
            probe.bind((channel,))
    except OSError:
        # A kernel whose CAN module cannot be loaded, or no interface of this name.
        return False
    return True


def arguments_from_config(config: Mapping[str, Any]) -> list[str]:
    """Command-line flags that select the same bus for another process (except timing objects)."""
    flags = {"interface": "-i", "channel": "-c", "bitrate": "-b", "data_bitrate": "--data-bitrate"}
    arguments: list[str] = []
    extra = []
    for key, value in config.items():
        if key in flags:
            arguments += [flags[key], str(value)]
        elif key == "fd":
            arguments += ["--fd"] if value else []
        elif key != "timing":
            extra.append(f"{key}={value}")
    return arguments + (["--bus-kwargs", *extra] if extra else [])


def choose_bus(given: Mapping[str, Any], private_hub: Path | None = None, vcan: bool | None = None) -> BusChoice:
    """Select the bus for a command.

    :param given: keyword arguments of ``can.Bus`` that the user has named.
    :param private_hub: socket path where the caller can start its own hub; without it the default hub is used.
    :param vcan: whether the kernel has vcan0; None: determined if nothing else selects a bus.
    :raises InputError: python-can's configuration is wrong, or a channel or bit rate is given and nothing names an
        interface.
    """
    given = dict(given)
    reason = "given on the command line"
    config = _configured(given)
    if given and "interface" not in given:
        # python-can would fill it in when opening; code that depends on the interface needs it earlier.
        if "interface" not in config:
            found = Words(f"only {' '.join(arguments_from_config(given)) or 'a timing'}")
            raise InputError("command line", "--interface", found, "-i INTERFACE beside it, or can.rc")
        given = {**config, **given}
        reason += ", the rest from python-can's configuration"
    if given.get("interface") == HUB_INTERFACE and "channel" not in given and private_hub is not None:
        return _own_hub(private_hub, "a hub of this run's own, as given on the command line", given)
    if given:
        return BusChoice(given, reason, arguments=arguments_from_config(given))
    if config:
        return BusChoice(config, "from python-can's configuration", arguments=arguments_from_config(config))
    if vcan_available() if vcan is None else vcan:
        config = {"interface": "socketcan", "channel": _DEFAULT_VCAN}
        return BusChoice(config, "the kernel has vcan0", arguments=arguments_from_config(config))
    reason = "no vcan0 in this kernel: user-space hub"
    if private_hub is not None:
        return _own_hub(private_hub, reason, {})
    config = {"interface": HUB_INTERFACE, "channel": default_channel()}
    return BusChoice(config, reason, arguments=arguments_from_config(config))


def no_bus(given: Mapping[str, Any], pace: str) -> BusChoice:
    """The choice for a run without a bus.

    :param given: keyword arguments of ``can.Bus`` that the user has named.
    :param pace: of the run.
    :raises InputError: the command line also selects a bus, or real-time pacing.
    """
    if given:
        found = Words(" ".join(arguments_from_config(given)) or "a timing")
        raise OptionError("--bus local", f"cannot be given with {found} or any other option of a bus")
    if pace != "lockstep":
        raise OptionError("--bus local", f"used only with --pace lockstep, not with --pace {pace}")
    return BusChoice({"interface": LOCAL}, "all nodes in this process, as asked for")


def own_pipes() -> BusChoice:
    """The choice for a run in lockstep whose nodes are all started by the caller, with nobody else on the bus."""
    config = {"interface": HUB_INTERFACE, "channel": PIPES}
    return BusChoice(config, "lockstep on this machine, nobody else on the bus: no hub needed", needs_pipes=True)


def _configured(given: Mapping[str, Any]) -> dict[str, Any]:
    """The bus of ``given`` and python-can's configuration; empty if neither says anything.

    :raises InputError: the configuration is wrong.
    """
    if not has_settings():
        return dict(given)
    from railhil.bus.configured import configured

    found = configured(given)
    return {key: found[key] for key in ("interface", "channel", "bitrate", "fd") if found.get(key) is not None}


def _own_hub(path: Path, reason: str, given: Mapping[str, Any]) -> BusChoice:
    """The hub that the caller starts with the nodes; they wait for it for the requested time, or almost for ever."""
    config = {"connect_timeout": OWN_HUB_START_S, **given, "interface": HUB_INTERFACE, "channel": str(path)}
    return BusChoice(config, reason, True, arguments_from_config(config))
