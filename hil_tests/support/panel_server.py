"""A panel's server over a source that shows nothing, and pages that ask it."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import websockets

from railhil.panel.operator import list_fault_kinds
from railhil.panel.server import PanelServer
from railhil.panel.wire import SUBPROTOCOL

TOKEN = "right"


class ScriptedSource:
    """Shows nothing, notes commands."""

    def __init__(self) -> None:
        self.commands: list[dict[str, Any]] = []
        self.watched: set[int] = set()
        self.lists = 0
        self.branches: Any = None
        self.report: Path | None = None

    def describe(self) -> dict[str, Any]:
        return {"kind": "live"}

    def read_past(self) -> list[str | bytes]:
        return ["{}"]

    def look(self) -> list[str | bytes]:
        return []

    def list_frames(self) -> str:
        self.lists += 1
        return json.dumps({"frames": self.lists})

    def execute(self, command: dict[str, Any]) -> str:
        self.commands.append(command)
        return "" if command.get("do") != "fail" else "it cannot be"

    def watch(self, can_ids: set[int]) -> None:
        self.watched = can_ids

    def list_kinds(self) -> list[dict[str, Any]]:
        return list_fault_kinds(["TRN_SPEED loss @manual"])


def served(visit: Callable[[PanelServer, ScriptedSource], Any], token: str = TOKEN) -> ScriptedSource:
    """A server while ``visit`` (a coroutine function) is at it."""
    source = ScriptedSource()

    async def all_of_it() -> None:
        panel = PanelServer(source, token, 0)
        server = await panel.listen()
        try:
            await visit(panel, source)
        finally:
            server.close()
            await server.wait_closed()

    asyncio.run(all_of_it())
    return source


def page(panel: PanelServer, origin: str | None = None, subprotocol: str = SUBPROTOCOL) -> Any:
    origin = origin or f"http://127.0.0.1:{panel.port}"
    return websockets.connect(f"ws://127.0.0.1:{panel.port}/ws", origin=origin, subprotocols=[subprotocol])


async def asked(connection: Any, document: Any) -> dict[str, Any]:
    await connection.send(document if isinstance(document, str) else json.dumps(document))
    while True:
        answer = json.loads(await connection.recv())
        if "refused" in answer or "done" in answer:
            return dict(answer)
