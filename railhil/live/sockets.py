"""The sockets of a run: of its own hub, in a folder of its own, and of the panel.

The folder is removed after the run, or at the next start if the run was killed. Whether a folder is still in use is
determined by a lock, which the kernel releases with the process, and not by a process number, because containers that
share /tmp have different ones.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import select
import socket
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from railhil.common.errors import InputError, describe_os_error

_PREFIX = "railhil-run-"
_LOCK = "lock"
_SOCKET = "hub.sock"
#: The only files in such a folder; ``_DRAFT`` is the lock file before it is locked.
_DRAFT = "lock.new"


@contextmanager
def make_private_socket() -> Iterator[Path]:
    """Path for the socket of a hub, in a folder that only this user can enter and that is removed afterwards.

    :raises OSError: no folder can be made.
    """
    _remove_stale(Path(tempfile.gettempdir()))
    folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
    lock = os.open(folder / _DRAFT, os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC, 0o600)
    try:
        # Only a locked file gets the name that other processes look for.
        fcntl.flock(lock, fcntl.LOCK_EX)
        (folder / _DRAFT).rename(folder / _LOCK)
        yield folder / _SOCKET
    finally:
        _remove(folder)
        os.close(lock)


def _remove(folder: Path) -> None:
    for name in (_SOCKET, _LOCK, _DRAFT):
        (folder / name).unlink(missing_ok=True)
    # Do not remove other files in it.
    with suppress(OSError):
        folder.rmdir()


def _remove_stale(parent: Path) -> None:
    """Remove the folders left by killed runs of this user."""
    for folder in parent.glob(f"{_PREFIX}*"):
        # Another run may end, or clean up, at the same time.
        with suppress(OSError):
            status = folder.lstat()
            if stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid():
                _remove_unless_held(folder)


def _remove_unless_held(folder: Path) -> None:
    lock = os.open(folder / _LOCK, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        _remove(folder)
    finally:
        os.close(lock)


_DATAGRAM_MAX = 16384
#: Panels that are told.
_PANELS_MAX = 16
#: Environment variable with the token of a panel beside a run.
PANEL_TOKEN = "RAILHIL_PANEL_TOKEN"
#: A panel says hello twice a second, on a busy machine later.
_DESK_S = 5.0


class PanelSocket:
    """The supervisor's end. It never waits for a panel: a report that a panel cannot take is left out.

    :raises InputError: the socket cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC | socket.SOCK_NONBLOCK)
        self._panels: dict[Any, None] = {}
        self._last: dict[str, Any] = {}
        # Commands that came before the first :meth:`take`.
        self._early: list[dict[str, Any]] = []
        #: Hash of the scenario of the run without its faults, for panels that were told of another one.
        self.scenario = ""
        #: Port of the page, as the panel says; 0: not known.
        self.port = 0
        #: Number of open pages that may give orders, when the panel last said hello.
        self._desks, self._hello_s = 0, 0.0
        before = os.umask(0o177)
        try:
            with contextlib.suppress(FileNotFoundError):
                if path.is_socket():
                    path.unlink()
            self._socket.bind(str(path))
        except OSError as error:
            self._socket.close()
            allowed = f"a socket that can be made ({describe_os_error(error)})"
            raise InputError("command line", "--operator", str(path), allowed) from None
        finally:
            os.umask(before)

    def is_greeted(self, timeout_s: float) -> bool:
        """Whether a panel has said hello until now, or says it within this time; commands are kept for :meth:`take`."""
        self._early += self._read(0.0 if self._panels else timeout_s)
        return bool(self._panels)

    def has_desk(self, since_s: float = 0.0) -> bool:
        """Whether a page is open that may give orders.

        :param since_s: wait for a panel that had one to say so after this instant of the monotonic clock.
        """
        while self._desks and self._hello_s < since_s and time.monotonic() < since_s + _DESK_S:
            self._early += self._read(since_s + _DESK_S - time.monotonic())
        return self._desks > 0 and time.monotonic() - self._hello_s < _DESK_S

    def take(self, timeout_s: float) -> list[dict[str, Any]]:
        """Commands that have arrived, after at most this time."""
        found, self._early = self._early, []
        return found + self._read(0.0 if found else timeout_s)

    def _read(self, timeout_s: float) -> list[dict[str, Any]]:
        if timeout_s > 0:
            select.select((self._socket,), (), (), timeout_s)
        found: list[dict[str, Any]] = []
        while True:
            try:
                data, sender = self._socket.recvfrom(_DATAGRAM_MAX)
            except OSError:
                return found
            if sender:
                self._panels.pop(sender, None)
                self._panels[sender] = None
                while len(self._panels) > _PANELS_MAX:
                    del self._panels[next(iter(self._panels))]
            with contextlib.suppress(ValueError):
                command = json.loads(data)
                if isinstance(command, dict) and command.get("do") != "hello":
                    found.append(command)
                    continue
                self._greet(command if isinstance(command, dict) else {})
                if sender and self._last:
                    self._send(sender, self._last)

    def _greet(self, hello: dict[str, Any]) -> None:
        port, desks = hello.get("port"), hello.get("desks")
        self.port = port if isinstance(port, int) else self.port
        if isinstance(desks, int):
            self._desks, self._hello_s = desks, time.monotonic()

    def tell(self, report: dict[str, Any]) -> None:
        """Send a report to every panel that has said hello."""
        if "phase" in report:
            self._last = report = {**report, "scenario": self.scenario} if self.scenario else report
        for panel in list(self._panels):
            self._send(panel, report)

    def _send(self, panel: Any, report: dict[str, Any]) -> None:
        try:
            self._socket.sendto(json.dumps(report).encode(), panel)
        except BlockingIOError:
            return
        except OSError:
            # It has gone.
            self._panels.pop(panel, None)

    def close(self) -> None:
        """Remove the socket."""
        self._socket.close()
        self._path.unlink(missing_ok=True)

    def __enter__(self) -> PanelSocket:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()
