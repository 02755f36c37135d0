"""Serves the page of one command line; what only some need is loaded for them alone."""

from __future__ import annotations

import argparse
import asyncio
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.bus.can_settings import named_bus
from railhil.bus.select import arguments_from_config, choose_bus
from railhil.cli.watched import Watched, named_scenario
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import ending_signals
from railhil.common.output import Output
from railhil.common.python_process import end_with_parent
from railhil.panel.following import FollowedRun
from railhil.panel.live import LiveRun
from railhil.panel.operator import Operator
from railhil.panel.receiver import Receiver
from railhil.panel.server import PanelServer

if TYPE_CHECKING:
    from railhil.panel.foxglove import FoxgloveBridge


def serve_panel(namespace: argparse.Namespace) -> int:
    """Serve until SIGINT or SIGTERM; returns the exit code.

    :raises InputError: scenario or record cannot be loaded.
    :raises OSError: a port cannot be opened.
    """
    if namespace.child:
        end_with_parent()
    if any(Path(text).is_dir() for text in namespace.what):
        if namespace.foxglove is not None:
            allowed = "the run on a bus; for a recorded one railhil export --mcap"
            raise InputError("command line", "--foxglove", Words("beside run folders"), allowed)
        from railhil.panel.recorded import RecordedRuns

        runs = RecordedRuns(namespace.what)
        return asyncio.run(_serve(PanelServer(runs, "", namespace.port), Output(stderr=True)))
    if len(namespace.what) > 1:
        raise InputError("command line", "SCENARIO", Words(" ".join(namespace.what)), "one scenario, or run folders")
    named = named_scenario(next(iter(namespace.what), None), namespace.set, namespace.fault)
    operator = Operator(namespace.operator) if namespace.operator else None
    source = LiveRun(Watched(named, namespace.controller), _receiver(named_bus(namespace), namespace.follow), operator)
    token = secrets.token_urlsafe(16) if operator else ""
    port = namespace.public_port if namespace.socket and namespace.public_port else namespace.port
    bridge: FoxgloveBridge | None = None
    if namespace.foxglove is not None:
        from railhil.panel.foxglove import FoxgloveBridge

        bridge = FoxgloveBridge(source, token, namespace.foxglove)
    panel = PanelServer(source, token, port, namespace.socket)
    # A record waits for who reads it, a bus does not; viewers of the bridge are not counted.
    panel.looks_alone = namespace.follow is None or bridge is not None
    return asyncio.run(_serve(panel, Output(stderr=True), bridge, operator))


def _receiver(given: Mapping[str, Any], follow: str | None) -> Receiver:
    if follow is None:
        return Receiver(choose_bus(given).config)
    if given:
        found = Words(" ".join(arguments_from_config(given)) or "a timing")
        raise InputError("command line", "--follow", found, "no option of a bus beside it")
    folder = Path(follow)
    return Receiver({}, lambda config, name: FollowedRun(folder), waits=True)


async def _serve(
    panel: PanelServer, console: Output, bridge: FoxgloveBridge | None = None, operator: Operator | None = None
) -> int:
    servers = [await panel.listen()]
    console.say(f"panel: {panel.address}{f'#token={panel.token}' if panel.token else ''}")
    if bridge is not None:
        servers.append(await bridge.listen())
        console.say(f"foxglove: ws://127.0.0.1:{bridge.port}")
    stopped: list[int] = []
    loop = asyncio.get_running_loop()
    for number in ending_signals():
        loop.add_signal_handler(number, stopped.append, int(number))
    if operator is not None:
        # The run begins now.
        operator.greet()
    await panel.run(lambda: bool(stopped), bridge.tell if bridge is not None else lambda: None)
    for server in servers:
        server.close()
        await server.wait_closed()
    return 128 + stopped[0]
