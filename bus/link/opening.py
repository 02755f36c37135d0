"""Opens an interface with the matching link."""

from __future__ import annotations

import contextlib
import errno
import sys
from typing import TYPE_CHECKING, Any

from railhil.bus.can_settings import HUB_INTERFACE, has_settings
from railhil.bus.errors import BusUnavailable
from railhil.bus.hub.wire import ROLES
from railhil.bus.link.base import Link
from railhil.bus.link.outage import TIMEOUTS, Timeouts
from railhil.bus.select import PIPES
from railhil.common.plain_text import plain

if TYPE_CHECKING:
    import can


#: python-can's switch to receive what one has sent, as other tools want it.
_ECHO = "receive_own_messages"


def open_link(config: dict[str, Any], name: str = "bus", *, timeouts: Timeouts = TIMEOUTS) -> Link:
    """Open a python-can interface from ``can.Bus`` keyword arguments (absent ones come from ``can.rc``, environment).

    :param name: the node's name, with which each line about an outage on standard error begins.
    :param timeouts: how long to wait for an interface that is down; not used for the hub, whose loss ends the run.
    :raises BusUnavailable: one line that names interface and channel.
    :raises InputError: python-can's configuration is wrong.
    """

    # The hub says to the nodes of a bench which of them are there.
    own: dict[str, Any] = {"role": name} if config.get("interface") == HUB_INTERFACE and name in ROLES else {}

    def reopen() -> can.BusABC:
        import can

        return can.Bus(**{**config, **own})

    def say(line: str) -> None:
        # A closed standard error must not stop the node.
        with contextlib.suppress(OSError):
            print(plain(f"{name}: {line}"), file=sys.stderr, flush=True)

    # Import only what the interface needs, so that nodes start quickly.
    if own and str(config.get("channel", "")).startswith(f"{PIPES}:"):
        from railhil.bus.link.pipes import Ends, PipeLink

        return PipeLink(Ends.parse(config["channel"]), name, say)
    if has_settings():
        from railhil.bus.configured import configured

        if configured(config).get(_ECHO):
            # A node would take its own polls for those of another bus administrator.
            own[_ECHO] = False
            say(f"{_ECHO} is set for this bus, and switched off: no node needs its own frames")
    try:
        from railhil.bus.hub.batches import HubClient

        is_hub = config.get("interface") == HUB_INTERFACE
        # What python-can is configured with is added to the given settings, of the hub too.
        bus = HubClient(**{**_of_hub(config), **own}) if is_hub and not has_settings() else reopen()
        if isinstance(bus, HubClient):
            from railhil.bus.link.batch import BatchLink

            return BatchLink(bus, say)
        if type(bus).__name__ == "SocketcanBus":
            from railhil.bus.link.kernel import KernelLink

            return KernelLink(bus, reopen, say, timeouts=timeouts)
        has_port = isinstance(getattr(getattr(bus, "serialPortOrig", None), "fd", None), int)
        if has_port and type(bus).__name__ == "slcanBus":
            # Only a local port; ports behind socket:// and on Windows use python-can's own driver. So do adapters with
            # other protocols: robotell stores its port under the same attribute name.
            from railhil.bus.link.slcan import SlcanLink

            return SlcanLink(bus, reopen, say, timeouts=timeouts)
        if type(bus).__name__ == "UdpMulticastBus":
            from railhil.bus.link.echo import EchoLink

            return EchoLink(bus, reopen, say, timeouts=timeouts)
        from railhil.bus.link.single import SingleLink

        return SingleLink(bus, reopen, say, timeouts=timeouts)
    except Exception as error:
        # An interface without its driver library may raise anything (kvaser: NameError).
        where = f"{config.get('interface', 'default interface')}:{config.get('channel', 'default channel')}"
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        if isinstance(error, OSError) and error.errno == errno.EAFNOSUPPORT and config.get("interface") == "socketcan":
            reason = "this kernel has no CAN (railhil vcan -- COMMAND gives a command one, with vcan0)"
        raise BusUnavailable(f"bus {where} cannot be opened: {reason}") from error


def _of_hub(config: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in config.items() if key != "interface"}
