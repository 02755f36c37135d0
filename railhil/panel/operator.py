"""The panel's end of the supervisor's socket (:mod:`railhil.live.panel_socket`)."""

from __future__ import annotations

import contextlib
import json
import socket
import time
from typing import Any

#: Wall time between two greetings; the supervisor tells those that have greeted it.
_HELLO_S = 0.5
_DATAGRAM_MAX = 16384
#: What a page may ask for.
COMMANDS = ("start", "pause", "stop", "pace", "inject", "clear", "fault")


class Operator:
    """Passes commands to the supervisor and keeps its last report; never waits.

    :param path: the supervisor's socket; it may come and go.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._socket: socket.socket | None = None
        self._hello_s = 0.0
        #: The supervisor's last report; empty: none.
        self.report: dict[str, Any] = {}

    def greet(self) -> None:
        """Tell the supervisor that this panel is there. It tells nothing back before the first :meth:`look`."""
        self._send({"do": "hello"})
        self.close()

    def command(self, command: dict[str, Any]) -> str:
        """Pass on a command; returns why not, empty if it was."""
        if command.get("do") not in COMMANDS:
            return f"no such command: {command.get('do')}"
        if not self.report or not self._send(command):
            return "no supervisor is running"
        return ""

    def look(self) -> list[dict[str, Any]]:
        """The supervisor's answers to commands since the last look; brings :attr:`report` up to date."""
        now_s = time.monotonic()
        if now_s - self._hello_s >= _HELLO_S:
            self._hello_s = now_s
            if not self._send({"do": "hello"}) and self._socket is None and self.report.get("phase") != "ended":
                # The supervisor has gone.
                self.report = {}
        answers = []
        while self._socket is not None:
            try:
                document = json.loads(self._socket.recv(_DATAGRAM_MAX))
            except BlockingIOError:
                break
            except (OSError, ValueError):
                self.close()
                break
            if "phase" in document:
                self.report = document
            else:
                answers.append(document)
        return answers

    def close(self) -> None:
        """Let go of the socket."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, document: dict[str, Any]) -> bool:
        try:
            if self._socket is None:
                self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
                # An address of its own, to which the supervisor can answer.
                self._socket.bind("")
                self._socket.connect(self._path)
            self._socket.send(json.dumps(document).encode())
        except BlockingIOError:
            return False
        except OSError:
            with contextlib.suppress(OSError):
                self.close()
            return False
        return True
