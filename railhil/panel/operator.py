"""Commands of the panel's operator over the supervisor's socket (:mod:`railhil.live.sockets`), and the kinds of
faults to which an operator may give other values during a run."""

from __future__ import annotations

import contextlib
import json
import socket
import time
from collections.abc import Iterable
from math import isfinite
from typing import Any

#: Wall time between two greetings; the supervisor reports to panels that have greeted it.
_HELLO_S = 0.5
#: A report has all faults of the run, the last one its command, too.
_DATAGRAM_MAX = 1 << 17
#: Commands that a page may send.
COMMANDS = ("start", "pause", "stop", "pace", "inject", "clear", "fault", "next", "stay", "leave")


class Operator:
    """Passes commands to the supervisor and keeps its last report; never waits.

    :param path: the supervisor's socket; it may come and go.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._socket: socket.socket | None = None
        self._hello_s = 0.0
        #: For the supervisor: port of the page, and number of the open pages that may give orders.
        self.port = self.desks = 0
        #: The supervisor's last report; empty: none.
        self.report: dict[str, Any] = {}

    def greet(self) -> None:
        """Greet the supervisor. Its reports are read with the first :meth:`look`."""
        self._hello()
        self.close()

    def execute(self, command: dict[str, Any]) -> str:
        """Pass on a command; returns the reason if it was not passed, else empty."""
        if command.get("do") not in COMMANDS:
            return f"no such command: {command.get('do')}"
        if not self.report or not self._send(command):
            return "no supervisor is running"
        return ""

    def look(self) -> list[dict[str, Any]]:
        """The supervisor's answers to commands since the last call; brings :attr:`report` up to date."""
        now_s = time.monotonic()
        if now_s - self._hello_s >= _HELLO_S:
            self._hello_s = now_s
            if not self._hello() and self._socket is None and self.report.get("phase") != "ended":
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

    def forget_end(self) -> None:
        """Another run is heard: the end of the one before is not its own."""
        if self.report.get("phase") == "ended":
            self.report = {}

    def close(self) -> None:
        """Close the socket."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _hello(self) -> bool:
        return self._send({"do": "hello", "port": self.port, "desks": self.desks})

    def _send(self, document: dict[str, Any]) -> bool:
        try:
            if self._socket is None:
                self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
                # A separate address to which the supervisor can answer.
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


def list_fault_kinds(texts: Iterable[str]) -> list[dict[str, Any]]:
    """The kinds among the faults of a run that are triggered by hand, each once, in their order.

    ``name``: place and word; ``tail``: its count and other fixed parts; ``parameters``: name, meaning, ``keyword``
    before it (empty: none), ``value`` as prepared, ``usual`` value (empty: none), ``unit`` of a number without one,
    ``range`` (empty: any), all as texts of the fault language, and whether it is ``fixed`` (a name).
    """
    # The language is loaded only when it is used.
    from railhil.faults.language import parse
    from railhil.faults.model import NAME, Fault, Parameter
    from railhil.faults.notation import UNITS, number_text, place_text, value_text
    from railhil.faults.operator_values import parameters_of

    def describe(fault: Fault, one: Parameter) -> dict[str, Any]:
        is_name = one.unit == NAME
        limits = [number_text(limit, one.unit) if isfinite(limit) else "" for limit in (one.low, one.high)]
        return {
            "name": one.name,
            "meaning": one.meaning,
            "keyword": one.keyword,
            "value": value_text(fault.values[one.name], one.unit),
            "usual": "" if one.usual is None else value_text(one.usual, one.unit),
            "unit": "" if is_name else next(iter(UNITS[one.unit])),
            "range": "" if is_name or not any(limits) else f"{limits[0]} to {limits[1]}".strip(),
            "fixed": is_name,
        }

    found: dict[tuple[str, str, str], dict[str, Any]] = {}
    for fault in map(parse, texts):
        if fault.trigger.kind != "manual" or not parameters_of(fault):
            continue
        names = [str(fault.values[one.name]) for one in parameters_of(fault) if one.unit == NAME]
        tail = [f"x{fault.count}"] if fault.count is not None else []
        tail += [f"after {fault.after}"] if fault.after else []
        tail += [f"units {','.join(map(str, fault.units))}"] if fault.units else []
        name = f"{place_text(fault.place)} {fault.what}"
        parameters = [describe(fault, one) for one in parameters_of(fault)]
        fixed = " ".join(tail)
        kind = {"name": name, "tail": fixed, "parameters": parameters}
        found.setdefault((name, fixed, " ".join(names)), kind)
    return list(found.values())
