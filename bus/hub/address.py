"""Channel names of the hub, and how to listen and connect on them.

A channel is a path (AF_UNIX SEQPACKET, file mode 0600) or ``tcp://127.0.0.1:PORT`` (loopback addresses
only; any user of the machine can connect to it, which the path scheme prevents).
"""

from __future__ import annotations

import contextlib
import errno
import ipaddress
import os
import socket
import stat
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass

from railhil.bus.errors import BusUnavailable
from railhil.common.errors import describe_os_error
from railhil.common.user_files import lock_within

TCP_SCHEME = "tcp://"
#: ``sizeof(sun_path)`` of Linux minus the terminating zero byte.
MAX_PATH_BYTES = 107
#: How long to wait for a hub that is still starting.
HUB_START_S = 5.0
#: A run waits for the hub that it starts itself as long as that process lives, however busy the machine; a node cannot
#: see that process and uses this limit.
OWN_HUB_START_S = 300.0
_BACKLOG = 32
_LOCK_TIMEOUT_S = 2.0


@dataclass(frozen=True, slots=True)
class Address:
    """Address at which a hub listens: ``path``, or ``host`` and ``port``."""

    path: str | None
    host: str = ""
    port: int = 0

    def __str__(self) -> str:
        if self.path is not None:
            return self.path
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{TCP_SCHEME}{host}:{self.port}"


def default_channel() -> str:
    """Path used when the user names no channel: one per user, in the runtime or temporary directory."""
    folder = os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir()
    return os.path.join(folder, f"railhil-{os.getuid()}.sock")


def parse_channel(channel: str) -> Address:
    """Address of a channel name.

    Raises :class:`BusUnavailable` for a path that is too long, a malformed TCP name, a non-loopback address.
    """
    if not channel.startswith(TCP_SCHEME):
        size = len(os.fsencode(channel))
        if not channel or size > MAX_PATH_BYTES or "\0" in channel:
            raise BusUnavailable(
                f"hub channel {channel!r}: found a path of {size} bytes, "
                f"allowed: 1..{MAX_PATH_BYTES} bytes without a zero byte"
            )
        return Address(channel)
    host, _, port_text = channel.removeprefix(TCP_SCHEME).rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    allowed = "allowed: tcp://127.0.0.1:PORT or tcp://[::1]:PORT with PORT 0..65535"
    if not (port_text.isascii() and port_text.isdigit() and len(port_text) <= 5 and int(port_text) <= 65535):
        raise BusUnavailable(f"hub channel {channel!r}: found port {port_text!r}, {allowed}")
    try:
        loopback = ipaddress.ip_address("127.0.0.1" if host == "localhost" else host).is_loopback
    except ValueError:
        loopback = False
    if not loopback:
        raise BusUnavailable(f"hub channel {channel!r}: found host {host!r}, {allowed}")
    return Address(None, "127.0.0.1" if host == "localhost" else host, int(port_text))


def new_socket(address: Address) -> socket.socket:
    """Unconnected socket of the address's scheme."""
    if address.path is not None:
        return socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    sock = socket.socket(socket.AF_INET6 if ":" in address.host else socket.AF_INET, socket.SOCK_STREAM)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return sock


def connect(sock: socket.socket, address: Address) -> None:
    """Connect; raises OSError."""
    if address.path is not None:
        sock.connect(address.path)
        return
    sock.connect((address.host, address.port))
    # Repeated attempts on a free port of the ephemeral range can end in TCP connecting the socket to
    # itself.
    if sock.getsockname() == sock.getpeername():
        raise ConnectionRefusedError(errno.ECONNREFUSED, os.strerror(errno.ECONNREFUSED))


def listen(address: Address) -> tuple[socket.socket, Address]:
    """Listening socket (non-blocking) and its actual address (TCP port 0 picks a free one).

    A socket file without a listener is replaced. Raises :class:`BusUnavailable` with one line otherwise.
    """
    sock = None
    try:
        sock = new_socket(address)
        if address.path is not None:
            with _directory_lock(address.path):
                _bind_path(sock, address.path)
                sock.listen(_BACKLOG)
        else:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            sock.bind((address.host, address.port))
            sock.listen(_BACKLOG)
            address = Address(None, address.host, sock.getsockname()[1])
        sock.setblocking(False)
    except OSError as error:
        if sock is not None:
            sock.close()
        if error.errno == errno.EADDRINUSE:
            raise BusUnavailable(f"hub channel {address}: is in use by a running hub or another program") from None
        raise BusUnavailable(f"hub channel {address}: {describe_os_error(error)}") from None
    except BusUnavailable:
        if sock is not None:
            sock.close()
        raise
    return sock, address


def remove_socket_file(path: str, listener: socket.socket, inode: tuple[int, int]) -> None:
    """Remove the socket file at the end, unless another hub has meanwhile created its own there."""
    listener.close()
    with contextlib.suppress(FileNotFoundError):
        if file_identity(path) == inode:
            os.unlink(path)


def file_identity(path: str) -> tuple[int, int]:
    """Device and inode number of a path (links not followed)."""
    status = os.lstat(path)
    return status.st_dev, status.st_ino


@contextlib.contextmanager
def _directory_lock(path: str) -> Iterator[None]:
    """Serialise check, unlink and bind of two hubs that start on the same path; leaves no lock file."""
    folder = os.path.dirname(path) or "."
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        if not lock_within(descriptor, _LOCK_TIMEOUT_S):
            raise BusUnavailable(f"hub channel {path}: folder {folder} is locked by another program")
        yield
    finally:
        os.close(descriptor)


def _bind_path(sock: socket.socket, path: str) -> None:
    with contextlib.suppress(FileNotFoundError):
        if not stat.S_ISSOCK(os.lstat(path).st_mode):
            raise BusUnavailable(f"hub channel {path}: the file exists and is not a socket")
        _refuse_if_alive(path)
        os.unlink(path)
    # The mode must be right from the start: chmod after bind would leave a gap.
    previous_umask = os.umask(0o177)
    try:
        sock.bind(path)
    finally:
        os.umask(previous_umask)


def _refuse_if_alive(path: str) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as probe:
        probe.setblocking(False)
        try:
            probe.connect(path)
        except ConnectionRefusedError:
            return
        except BlockingIOError:
            # A full backlog means a live listener.
            reason = "is in use by a running hub"
        except OSError as error:
            # A socket of another type (EPROTOTYPE) belongs to another program and must not be removed.
            reason = f"the socket belongs to another program ({describe_os_error(error)})"
        else:
            reason = "is in use by a running hub"
    raise BusUnavailable(f"hub channel {path}: {reason}")
