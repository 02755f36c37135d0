"""Transports of python-can, to be measured beside the bench's own."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TextIO

from benchmarks.buses import NO_VCAN, VCAN, Ends, Transport
from benchmarks.figures import MeasurementError, Missing
from benchmarks.processes import end, last_line
from railhil.bus.select import vcan_available

_DAEMON = "socketcand"
_HOST = "127.0.0.1"
_START_S = 20.0
_LOOK_S = 0.05
_NO_DAEMON = (
    f"no {_DAEMON} on the PATH: github.com/linux-can/socketcand, `meson setup build && meson compile -C build`, and "
    "build/src before the rest of the PATH"
)
_NOT_ASKED_FOR = "it sends to a multicast group: --multicast GROUP permits that"


def _free_port() -> int:
    """A TCP port of the loopback that is free at the moment."""
    with socket.socket() as probe:
        probe.bind((_HOST, 0))
        return int(probe.getsockname()[1])


def _wait_for(daemon: subprocess.Popen[Any], port: int, said: TextIO) -> None:
    """:raises MeasurementError: it does not listen."""
    deadline_s = time.monotonic() + _START_S
    while daemon.poll() is None and time.monotonic() < deadline_s:
        try:
            socket.create_connection((_HOST, port), _LOOK_S).close()
        except OSError:
            time.sleep(_LOOK_S)
        else:
            return
    said.seek(0)
    raise MeasurementError(f"{_DAEMON} at {_HOST}:{port} did not start: {last_line(said.read())}")


@contextmanager
def _socketcand(folder: Path) -> Iterator[Ends]:
    port = _free_port()
    # -n: no beacon, which would be a broadcast.
    words = [_DAEMON, "-n", "-q", "-i", VCAN, "-l", "lo", "-p", str(port)]
    with (folder / "socketcand.txt").open("w+", encoding="utf-8") as said:
        daemon = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        try:
            _wait_for(daemon, port, said)
            where = _of_python_can(interface=_DAEMON, channel=VCAN, host=_HOST, port=port, tcp_tune=True)
            yield Ends(where, where, [daemon.pid])
        finally:
            end(daemon)


@contextmanager
def _multicast(group: str, folder: Path) -> Iterator[Ends]:
    where = _of_python_can(interface="udp_multicast", channel=group, hop_limit=0)
    yield Ends(where, where)


def _of_python_can(**settings: str | int) -> tuple[str, str]:
    """Kind and address of an end for :mod:`benchmarks.peer`.

    :param settings: keyword arguments of ``can.Bus``.
    """
    return "python-can", json.dumps(settings)


def _way(short: str, opened: Callable[[Path], AbstractContextManager[Ends]]) -> Transport:
    return Transport(f"python-can {short}", short, opened, runs=False, in_c=False)


SOCKETCAND = _way(_DAEMON, _socketcand)


def multicast_to(group: str) -> Transport:
    """python-can's ``udp_multicast`` in one group."""
    return _way("udp_multicast", partial(_multicast, group))


def foreign_transports(group: str, *, vcan: bool | None = None) -> tuple[list[Transport], list[Missing]]:
    """The transports of python-can to measure on a machine, and those left out, with the reason.

    :param group: permitted multicast group; empty: none.
    :param vcan: whether its kernel has :data:`~benchmarks.buses.VCAN`; None: as on this machine.
    """
    found, missing = [], []
    if shutil.which(_DAEMON) is None:
        missing.append(Missing(SOCKETCAND.name, _NO_DAEMON))
    elif vcan_available(VCAN) if vcan is None else vcan:
        found.append(SOCKETCAND)
    else:
        missing.append(Missing(SOCKETCAND.name, NO_VCAN))
    way = multicast_to(group)
    if group:
        found.append(way)
    else:
        missing.append(Missing(way.name, _NOT_ASKED_FOR))
    return found, missing
