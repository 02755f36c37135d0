"""The transports of the bench for benchmarks: the processes to start, and the addresses of the ends."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.figures import Missing
from benchmarks.machine import is_emulated
from benchmarks.processes import hub
from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.hub.address import TCP_SCHEME
from railhil.bus.select import vcan_available

VCAN = "vcan0"


@dataclass(slots=True)
class Ends:
    """Addresses of the two ends of a pair.

    ``near``, ``far``: kind and address for :mod:`benchmarks.peer`. ``hub_pids``: processes between them.
    """

    near: tuple[str, str]
    far: tuple[str, str]
    hub_pids: list[int] = field(default_factory=list)

    @property
    def near_flags(self) -> list[str]:
        """Command-line flags of the bus at the near end."""
        return _flags(*self.near)

    @property
    def far_flags(self) -> list[str]:
        """Command-line flags of the bus at the far end."""
        return _flags(*self.far)


def _flags(kind: str, address: str) -> list[str]:
    if kind == "can":
        return ["-i", "socketcan", "-c", address]
    return ["-i", HUB_INTERFACE, "-c", TCP_SCHEME + address if kind == "tcp" else address]


@dataclass(frozen=True, slots=True)
class Transport:
    """One transport between nodes.

    :ivar short: name for folders, short because of the length limit of socket paths.
    :ivar opened: starts and ends the processes between the ends, in an empty folder (short path).
    :ivar runs: whether a run of the bench is made over it.
    :ivar in_c: whether ``c/loop.c`` can use it.
    """

    name: str
    short: str
    opened: Callable[[Path], AbstractContextManager[Ends]]
    runs: bool = True
    in_c: bool = True


@contextmanager
def _pair(folder: Path) -> Iterator[Ends]:
    near, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with near, far:
        yield Ends(("pair", str(near.fileno())), ("pair", str(far.fileno())))


@contextmanager
def _unix(folder: Path) -> Iterator[Ends]:
    with hub(str(folder / "hub.sock")) as (channel, pid):
        yield Ends(("hub", channel), ("hub", channel), [pid])


@contextmanager
def _tcp(folder: Path) -> Iterator[Ends]:
    with hub(f"{TCP_SCHEME}127.0.0.1:0") as (channel, pid):
        where = ("tcp", channel.removeprefix(TCP_SCHEME))
        yield Ends(where, where, [pid])


@contextmanager
def _gateway(folder: Path) -> Iterator[Ends]:
    with ExitStack() as stack:
        sides = [stack.enter_context(hub(str(folder / name))) for name in ("a.sock", "b.sock")]
        ports = [word for channel, _ in sides for word in ("--port", f"{HUB_INTERFACE}:{channel}")]
        _, pid = stack.enter_context(hub(str(folder / "gateway.sock"), "--lossless", *ports))
        (near, near_pid), (far, far_pid) = sides
        yield Ends(("hub", near), ("hub", far), [near_pid, pid, far_pid])


@contextmanager
def _vcan(folder: Path) -> Iterator[Ends]:
    yield Ends(("can", VCAN), ("can", VCAN))


SOCKET_PAIR = Transport("socket pair, no hub", "pair", _pair, runs=False)
UNIX_HUB = Transport("hub, Unix socket", "unix", _unix)
TCP_HUB = Transport("hub, TCP loopback", "tcp", _tcp)
GATEWAY = Transport("hub, gateway, hub", "gateway", _gateway)
KERNEL = Transport("kernel vcan", "vcan", _vcan)
NO_VCAN = f"this kernel has no {VCAN}: railhil vcan -- python -m benchmarks --only transports"


def transports(*, emulated: bool | None = None, vcan: bool | None = None) -> tuple[list[Transport], list[Missing]]:
    """The transports to measure on a machine, and those left out, with the reason.

    :param emulated: whether its processor is emulated; None: as on this machine.
    :param vcan: whether its kernel has :data:`VCAN`; None: as on this machine.
    """
    found, missing = [SOCKET_PAIR, UNIX_HUB], []
    if is_emulated() if emulated is None else emulated:
        # Starting their processes would take minutes there, and they can be measured on other machines.
        missing += [Missing(way.name, "left out on an emulated machine") for way in (TCP_HUB, GATEWAY)]
    else:
        found += [TCP_HUB, GATEWAY]
    if vcan_available(VCAN) if vcan is None else vcan:
        found.append(KERNEL)
    else:
        missing.append(Missing(KERNEL.name, NO_VCAN))
    return found, missing
