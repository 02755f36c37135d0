"""Opens an interface with the matching link."""

from __future__ import annotations

import contextlib
import errno
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE, has_settings
from railhil.bus.errors import BusUnavailable
from railhil.bus.link.base import TIMEOUTS, Link, Timeouts
from railhil.bus.packing import ROLES
from railhil.bus.transports import Opening, transport_of
from railhil.common.streams import escape_controls

#: python-can's switch to receive own frames, which other tools may need.
_ECHO = "receive_own_messages"


def open_link(config: dict[str, Any], name: str = "bus", *, timeouts: Timeouts = TIMEOUTS) -> Link:
    """Open a python-can interface from ``can.Bus`` keyword arguments (absent ones come from ``can.rc``, environment).

    :param name: the node's name, with which each line about an outage on standard error begins.
    :param timeouts: how long to wait for an interface that is down; not used for the hub, whose loss ends the run.
    :raises BusUnavailable: one line that names interface and channel.
    :raises InputError: python-can's configuration is wrong.
    """

    def say(line: str) -> None:
        # A closed standard error must not stop the node.
        with contextlib.suppress(OSError):
            print(escape_controls(f"{name}: {line}"), file=sys.stderr, flush=True)

    # The hub reports to the nodes of a bench which of them are connected.
    own: dict[str, Any] = {"role": name} if config.get("interface") == HUB_INTERFACE and name in ROLES else {}
    named = config
    if has_settings():
        from railhil.bus.configured import configured

        named = configured(config)
        if named.get(_ECHO):
            # A node would take its own polls for those of another bus administrator.
            own[_ECHO] = False
            say(f"{_ECHO} is set for this bus, and switched off: no node needs its own frames")
    interface, channel = str(named.get("interface", "")), str(named.get("channel", ""))
    # Only what the interface needs is imported, so that nodes start quickly.
    module, _, link = transport_of(interface, channel).link.partition(":")
    try:
        opened: Callable[[Opening], Link] = getattr(import_module(module), link).opened
        return opened(Opening({**config, **own}, name, say, timeouts))
    except Exception as error:
        # An interface without its driver library may raise anything (kvaser: NameError).
        where = f"{config.get('interface', 'default interface')}:{config.get('channel', 'default channel')}"
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        if isinstance(error, OSError) and error.errno == errno.EAFNOSUPPORT and config.get("interface") == "socketcan":
            reason = "this kernel has no CAN (railhil vcan -- COMMAND gives a command one, with vcan0)"
        raise BusUnavailable(f"bus {where} cannot be opened: {reason}") from error


def listen_only(link: Link) -> None:
    """Tell the interface not to acknowledge frames either, if it can be told. The caller sends nothing in any case."""
    # python-can is already loaded, by its interface.
    can = sys.modules.get("can")
    if can is not None and isinstance(link.bus, can.BusABC):
        with contextlib.suppress(NotImplementedError, AttributeError):
            link.bus.state = can.BusState.PASSIVE
