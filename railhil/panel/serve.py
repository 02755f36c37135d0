"""Serves the page of one command line."""

from __future__ import annotations

import argparse
import asyncio
import secrets
from pathlib import Path
from typing import Any

from railhil.bus.select import choose_bus
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import ending_signals
from railhil.common.orphans import end_with_parent
from railhil.common.output import Output
from railhil.controller_node.laws import find
from railhil.controller_node.telemetry_file import law_document
from railhil.panel.live import LiveRun
from railhil.panel.operator import Operator
from railhil.panel.receiver import Receiver
from railhil.panel.recorded import RecordedRuns
from railhil.panel.server import PanelServer
from railhil.scenarios.load import load_any
from railhil.scenarios.system import System, system_named


def serve_panel(namespace: argparse.Namespace) -> int:
    """Serve until SIGINT or SIGTERM; returns the exit code.

    :raises InputError: scenario or record cannot be loaded.
    :raises OSError: the port cannot be opened.
    """
    if namespace.child:
        end_with_parent()
    if any(Path(text).is_dir() for text in namespace.what):
        runs = RecordedRuns(namespace.what)
        return asyncio.run(_serve(PanelServer(runs, "", namespace.port), Output(stderr=True)))
    if len(namespace.what) > 1:
        raise InputError("command line", "SCENARIO", Words(" ".join(namespace.what)), "one scenario, or run folders")
    scenario = load_any(namespace.what[0], namespace.set, namespace.fault)
    choice = choose_bus(namespace)
    operator = Operator(namespace.operator) if namespace.operator else None
    notes = law_notes(system_named(scenario.system), namespace.controller)
    source = LiveRun(scenario, Receiver(choice.config), scenario.name, notes, operator)
    return asyncio.run(
        _serve(PanelServer(source, secrets.token_urlsafe(16) if operator else "", namespace.port), Output(stderr=True))
    )


async def _serve(panel: PanelServer, console: Output) -> int:
    server = await panel.listen()
    console.say(f"panel: {panel.address}{f'#token={panel.token}' if panel.token else ''}")
    stopped: list[int] = []
    loop = asyncio.get_running_loop()
    for number in ending_signals():
        loop.add_signal_handler(number, stopped.append, int(number))
    await panel.run(lambda: bool(stopped))
    server.close()
    await server.wait_closed()
    return 128 + stopped[0]


def law_notes(system: System, law: str | None) -> list[dict[str, Any]] | None:
    """What the law of a run declares of its notes; None: not known, or the same for every law of the system.

    :raises InputError: there is no such law.
    """
    if law is None or "interface" in system.own:
        return None
    notes: list[dict[str, Any]] = law_document(law, find(law, system.laws))["notes"]
    return notes
