"""The socket by which a panel and the supervisor talk: datagrams of JSON, on a Unix socket of this user."""

from __future__ import annotations

import contextlib
import json
import os
import select
import socket
from pathlib import Path
from types import TracebackType
from typing import Any

from railhil.common.errors import InputError

_DATAGRAM_MAX = 16384
#: Panels that are told.
_PANELS_MAX = 16


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
        before = os.umask(0o177)
        try:
            with contextlib.suppress(FileNotFoundError):
                if path.is_socket():
                    path.unlink()
            self._socket.bind(str(path))
        except OSError as error:
            self._socket.close()
            allowed = f"a socket that can be made ({(error.strerror or str(error)).lower()})"
            raise InputError("command line", "--operator", str(path), allowed) from None
        finally:
            os.umask(before)

    def is_greeted(self, timeout_s: float) -> bool:
        """Whether a panel has said hello until now, or says it within this time; commands are kept for :meth:`take`."""
        self._early += self._read(0.0 if self._panels else timeout_s)
        return bool(self._panels)

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
                elif sender and self._last:
                    self._send(sender, self._last)

    def tell(self, report: dict[str, Any]) -> None:
        """Send a report to every panel that has said hello."""
        if "phase" in report:
            self._last = report
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
