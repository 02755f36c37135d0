"""The panel of a command line: its source, and the time for which it is served.

Modules that only some command lines need are imported for them alone.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.bus.can_settings import named_bus
from railhil.bus.select import arguments_from_config, choose_bus
from railhil.cli.run_identity import RunIdentity, named_scenario
from railhil.common.errors import InputError, OptionError, Words
from railhil.common.exit_codes import ending_signals
from railhil.common.extras import need
from railhil.common.output import Output
from railhil.common.python_process import end_with_parent
from railhil.index.find import has_runs_below
from railhil.live.sockets import PANEL_TOKEN
from railhil.panel.live import LiveRun
from railhil.panel.operator import Operator
from railhil.panel.receiver import LogFollower, Receiver
from railhil.panel.server import PanelServer
from railhil.scenarios.load import find, sentences, stable_name
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import PANEL_PORT

if TYPE_CHECKING:
    from railhil.panel.foxglove import FoxgloveBridge
    from railhil.panel.requirements import LiveRequirements

#: Said behind the address where a person has started the panel alone.
_ENDED_BY = " (Ctrl-C ends it)"


def serve_panel(namespace: argparse.Namespace) -> int:
    """Serve until SIGINT or SIGTERM; returns the exit code.

    :raises InputError: scenario or record cannot be loaded.
    :raises OSError: a port cannot be opened.
    """
    if namespace.child:
        end_with_parent()
    if any(Path(text).is_dir() for text in namespace.what):
        if namespace.foxglove is not None:
            raise OptionError(
                "--foxglove", "cannot be given with run folders; railhil export --mcap makes a file of one"
            )
        panel = _recorded_panel(namespace)
        return asyncio.run(_serve(panel, Output(stderr=True), _ENDED_BY))
    if len(namespace.what) > 1:
        raise InputError("command line", "SCENARIO", " ".join(namespace.what), "one scenario, or run folders")
    named = _named(next(iter(namespace.what), None), namespace)
    operator = Operator(str(namespace.operator)) if namespace.operator else None
    receiver = _make_receiver(named_bus(namespace), namespace.follow)
    branches = None
    if namespace.follow is not None and operator is None:
        from railhil.panel.branches import Branches

        branches = Branches([namespace.follow])
    # Before the hashes of all shipped scenarios are computed.
    requirements = _live_requirements(named, namespace)
    identity = RunIdentity(named, namespace.controller)
    source = LiveRun(identity, receiver, operator, requirements, branches)
    # A page that is open stays the desk of the next run.
    token = os.environ.pop(PANEL_TOKEN, "") or secrets.token_urlsafe(16) if operator or branches else ""
    port = namespace.public_port if namespace.socket and namespace.public_port else namespace.port
    bridge: FoxgloveBridge | None = None
    if namespace.foxglove is not None:
        from railhil.panel.foxglove import FoxgloveBridge

        bridge = FoxgloveBridge(source, token, namespace.foxglove)
    panel = PanelServer(source, token, port, namespace.socket)
    # A record waits for its reader, a bus does not; viewers of the bridge are not counted.
    panel.looks_alone = namespace.follow is None or bridge is not None
    # A panel beside a run or in a container is ended by what has started it.
    ended_by = "" if namespace.child or namespace.socket else _ENDED_BY
    return asyncio.run(_serve(panel, Output(stderr=True), ended_by, bridge, operator))


def _recorded_panel(namespace: argparse.Namespace) -> PanelServer:
    """The page of run folders, or the index of a directory that has some below it. Raises InputError."""
    token = secrets.token_urlsafe(16)
    if len(namespace.what) == 1 and has_runs_below(Path(namespace.what[0])):
        for module, extra in (("pyarrow", "index"), ("jinja2", "report")):
            need(module, extra, command=f"railhil panel {namespace.what[0]}")
        from railhil.panel.index_server import IndexServer

        return IndexServer(Path(namespace.what[0]), namespace.requirements, token, namespace.port)
    from railhil.panel.recorded import RecordedRuns

    return PanelServer(RecordedRuns(namespace.what, namespace.requirements), token, namespace.port)


def _named(text: str | None, namespace: argparse.Namespace) -> AnyScenario | None:
    """The scenario that a command line names; None: there is none.

    :raises InputError: it cannot be loaded; for a text that names nothing, the line says that run folders are allowed.
    """
    if text is not None:
        try:
            find(text)
        except InputError as error:
            allowed = f"a run folder, {error.allowed}"
            raise InputError("command line", "SCENARIO|RUN", text, allowed, error.hint) from None
    return named_scenario(text, namespace.set, namespace.fault)


def _live_requirements(named: AnyScenario | None, namespace: argparse.Namespace) -> LiveRequirements | None:
    """Judges the run by the sentences of the scenario and of the files that a command line names; None: there are none.

    :raises InputError: a sentence is wrong, or does not fit the scenario that is named.
    """
    scenario = next(iter(namespace.what), None)
    own = {} if scenario is None else sentences(scenario, namespace.set)
    if not own and not namespace.requirements:
        return None
    # A panel without requirements does not load their language.
    from railhil.judge.requirements.requirement import check_requirements, named_requirements, requirements_in
    from railhil.panel.requirements import LiveRequirements

    known = requirements_in(own, "" if scenario is None else stable_name(scenario))
    found = (*known, *named_requirements(namespace.requirements, known))
    if named is not None:
        check_requirements(found, named)
    return LiveRequirements(found)


def _make_receiver(given: Mapping[str, Any], follow: str | None) -> Receiver:
    if follow is None:
        return Receiver(choose_bus(given).config)
    if given:
        found = Words(" ".join(arguments_from_config(given)) or "a timing")
        raise OptionError("--follow", f"cannot be given with {found} or any other option of a bus")
    folder = Path(follow)
    if not folder.is_dir():
        raise InputError(folder, "", Words("does not exist"), "the folder of a run that is being made")
    return Receiver({}, lambda config, name: LogFollower(folder), waits=True)


async def _serve(
    panel: PanelServer,
    console: Output,
    ended_by: str,
    bridge: FoxgloveBridge | None = None,
    operator: Operator | None = None,
) -> int:
    wanted = panel.port
    servers = [await panel.listen()]
    taken = f" (port {PANEL_PORT} is taken)" * (wanted == PANEL_PORT != panel.port)
    console.say(f"panel: {panel.address}{f'#token={panel.token}' if panel.token else ''}{taken}{ended_by}")
    if bridge is not None:
        servers.append(await bridge.listen())
        console.say(f"foxglove: ws://127.0.0.1:{bridge.port}")
    stopped: list[int] = []
    loop = asyncio.get_running_loop()
    for number in ending_signals():
        loop.add_signal_handler(number, stopped.append, int(number))
    if operator is not None:
        operator.port = panel.port
        # The run begins now.
        operator.greet()

    def beside() -> None:
        if operator is not None:
            operator.desks = panel.count_desks()
        if bridge is not None:
            bridge.tell()

    try:
        await panel.run(lambda: bool(stopped), beside)
    finally:
        panel.close()
    for server in servers:
        server.close()
        await server.wait_closed()
    return 128 + stopped[0]
