"""Serves the page of one command line."""

from __future__ import annotations

import argparse
import asyncio
import secrets

from railhil.bus.select import choose_bus
from railhil.common.output import Output
from railhil.panel.live import LiveRun
from railhil.panel.receiver import Receiver
from railhil.panel.server import PanelServer
from railhil.scenarios.load import load_any


def serve_panel(namespace: argparse.Namespace) -> None:
    """Serve until SIGINT or SIGTERM.

    :raises InputError: the scenario cannot be loaded.
    :raises OSError: the port cannot be opened.
    """
    scenario = load_any(namespace.what[0], namespace.set, namespace.fault)
    choice = choose_bus(namespace)
    source = LiveRun(scenario, Receiver(choice.config), f"{scenario.name} on {choice.transport}")
    asyncio.run(_serve(PanelServer(source, secrets.token_urlsafe(16), namespace.port), Output(stderr=True)))


async def _serve(panel: PanelServer, console: Output) -> None:
    server = await panel.listen()
    console.say(f"panel: {panel.address}#token={panel.token}")
    try:
        await panel.run()
    finally:
        server.close()
