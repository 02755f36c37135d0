"""``railhil run --panel``: the panel's process beside a run, and the wait for its start button."""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from railhil.common.command_line import whole_number
from railhil.common.errors import InputError, Sentence, Words
from railhil.common.extras import need
from railhil.judge.fault_report import check_faults, transports_of
from railhil.judge.result import Result
from railhil.live.processes import nodes_processor
from railhil.live.sockets import PanelSocket, make_private_socket
from railhil.run.run import Observer, Plan
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.operator_commands import ORDER
from railhil.scenarios.options import PORT_MAX, add_option, add_options
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.settings import normalise_fault

#: A run does not wait longer for its panel; on a busy machine it takes 2 s.
_READY_S = 5.0
_END_S = 2.0
_LOOK_S = 0.1
_SHOWN_S = 0.2
#: Nice value of the panel, compared with the run.
_NICE = 10
_PANEL_ONLY = Sentence("used only with --panel or --operator")
#: The fault of the emergency button: like the driver's mushroom button it opens the safety loop.
EMERGENCY_PLACE, EMERGENCY = "train.safety_loop", "safety_loop off @manual"


def add_page_argument(parser: argparse.ArgumentParser) -> None:
    """``--panel [PORT]``."""
    parser.add_argument(
        "--panel",
        nargs="?",
        const=8765,
        type=whole_number(0, PORT_MAX),
        metavar="PORT",
        help="TCP port of 127.0.0.1 for a page of the run, see railhil panel (default: 8765; 0: any)",
    )


def add_panel_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of a run with a panel."""
    add_page_argument(parser)
    add_option(parser, "--foxglove", ", with --panel")
    parser.add_argument(
        "--catalogue",
        action="store_true",
        help="with --panel or --operator: prepare the system's fault catalogue, to be injected during the run",
    )
    parser.add_argument("--wait", action="store_true", help="begin when Start is pressed on the panel")
    add_options(parser, "--operator", ORDER)


def check_panel(namespace: argparse.Namespace, spec: RunSpec) -> None:
    """Refuse a panel that could not hear or serve anything.

    :raises InputError: the run has no bus, or the extra is not installed.
    """
    if namespace.wait and namespace.panel is None and namespace.operator is None:
        raise InputError("command line", "--wait", Words("without a panel"), _PANEL_ONLY)
    if namespace.catalogue and namespace.panel is None and namespace.operator is None:
        raise InputError("command line", "--catalogue", Words("without a panel"), _PANEL_ONLY)
    if namespace.catalogue and (namespace.attach or namespace.no_controller):
        found = Words("beside nodes that are running already")
        allowed = Sentence("used only with nodes that railhil run starts, with its faults")
        raise InputError("command line", "--catalogue", found, allowed)
    if namespace.foxglove is not None and namespace.panel is None:
        raise InputError("command line", "--foxglove", namespace.foxglove, Sentence("used only with --panel"))
    asked = "--panel" if namespace.panel is not None else "--operator" if namespace.operator is not None else ""
    if asked and spec.is_local:
        allowed = Sentence("cannot be given with --bus local: a panel listens to a run over a bus")
        raise InputError("command line", asked, Words("beside --bus local"), allowed)
    if namespace.panel is not None:
        require_websockets()


def require_websockets() -> None:
    """Refuse a panel whose extra is not installed. Raises InputError."""
    need("websockets", "panel", command="command line: --panel")


def with_emergency(spec: RunSpec) -> RunSpec:
    """A run that is watched, with the fault of the emergency button, where there is time to press it and the train has
    such a loop."""
    # Nodes that are already running have their faults.
    if spec.start_up.joins or not (spec.is_realtime or spec.start_up.waits):
        return spec
    return replace(spec, faults=(*spec.faults, *_emergency_of(spec.load())))


def _emergency_of(scenario: AnyScenario) -> tuple[str, ...]:
    """The fault of the emergency button; none without such a loop, or if the scenario has one there."""
    has_loop = EMERGENCY_PLACE in scenario.installed_system.injects
    taken = any(text.startswith(EMERGENCY.partition(" ")[0]) for text in scenario.faults)
    return (EMERGENCY,) if has_loop and not taken else ()


def prepared_faults(scenario: str, catalogue: bool) -> tuple[str, ...]:
    """Faults of the page in a run whose nodes are started apart, as in containers: all nodes and the supervisor get
    them.

    :param catalogue: with the fault catalogue of the system.
    :raises InputError: the scenario cannot be loaded.
    """
    spec = RunSpec(scenario)
    spec = replace(spec, faults=_emergency_of(spec.load()))
    return (with_catalogue(spec) if catalogue else spec).faults


def with_catalogue(spec: RunSpec) -> RunSpec:
    """The run with the system's fault catalogue prepared.

    :raises InputError: the run would have too many faults.
    """
    from railhil.judge.reactions.catalogue import faults_by_hand

    return replace(spec, faults=(*spec.faults, *faults_by_hand(spec.load())))


class PanelBeside(Observer):
    """The panel's process while a run is made, and the socket of its orders.

    :param port: of the page; None: there is none.
    :param foxglove: port for other viewers; None: there is none.
    :param operator: socket of the orders; None: one of its own.
    """

    def __init__(self, port: int | None, foxglove: int | None, operator: Path | None) -> None:
        self._port, self._foxglove, self._operator = port, foxglove, operator
        self._socket: PanelSocket | None = None

    @contextmanager
    def beside(self, plan: Plan) -> Iterator[Plan]:
        with ExitStack() as held:
            path = self._operator or held.enter_context(make_private_socket())
            socket = self._socket = held.enter_context(PanelSocket(path))
            if self._port is not None:
                apart = set() if plan.spec.is_realtime else nodes_processor()[1]
                process = held.enter_context(panel_process(self._words(plan, path), apart))
                _wait_until_shown(process, socket)
            plan = replace(plan, panel=socket)
            yield _wait_for_start(socket, plan) if plan.spec.start_up.waits else plan
            if self._port is not None:
                # Time to show the end.
                time.sleep(_SHOWN_S)

    def _words(self, plan: Plan, path: Path) -> list[str]:
        spec = plan.spec
        words = [*spec.scenario_words, *spec.requirement_words, "--port", str(self._port)]
        # Without a law the page names no notes.
        words += ["--controller", spec.law.controller] if spec.law.given is None else []
        words += ["--operator", str(path), "--child"]
        words += ["--foxglove", str(self._foxglove)] if self._foxglove is not None else []
        # Without a bus to listen to, the panel follows the record.
        return words + (["--follow", str(plan.folder)] if plan.choice.needs_pipes else plan.choice.arguments)

    def on_result(self, result: Result) -> None:
        assert self._socket is not None
        self._socket.tell({"phase": "ended", "exit_code": result.exit_code, "line": result.line})


def _wait_until_shown(process: subprocess.Popen[bytes], socket: PanelSocket) -> None:
    """Wait until the page can be opened: the start of the panel takes half a second of a processor, and the run would
    be slower or late. A panel that ends or hangs is not waited for."""
    until_s = time.monotonic() + _READY_S
    while process.poll() is None and time.monotonic() < until_s and not socket.is_greeted(_LOOK_S):
        pass


@contextmanager
def panel_process(words: Sequence[str], apart: Collection[int] = ()) -> Iterator[subprocess.Popen[bytes]]:
    """``railhil panel`` with these words, as long as this context.

    :param apart: the only processors that it may use; empty: any.
    """
    process = subprocess.Popen([sys.executable, "-P", "-m", "railhil.panel", *words], stdin=subprocess.DEVNULL)
    with suppress(OSError):
        # The run has precedence if both want a processor. The panel may have ended already.
        os.setpriority(os.PRIO_PROCESS, process.pid, _NICE)
        if apart:
            os.sched_setaffinity(process.pid, apart)
    try:
        yield process
    finally:
        process.terminate()
        # A suspended process takes the signal only when it continues.
        process.send_signal(signal.SIGCONT)
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait_for_start(panel: PanelSocket, plan: Plan) -> Plan:
    """Wait until Start is pressed; returns the run with the faults that were typed meanwhile."""
    lockstep = not plan.spec.is_realtime
    while True:
        panel.tell({"phase": "waiting", "faults": list(plan.scenario.faults), "lockstep": lockstep})
        for command in panel.take(_LOOK_S):
            if command.get("do") == "start":
                panel.tell({"answer": command.get("id"), "refused": ""})
                panel.tell({"phase": "starting", "faults": list(plan.scenario.faults), "lockstep": lockstep})
                return plan
            why = "press Start first"
            if command.get("do") == "fault" and plan.spec.start_up.attach:
                why = "the nodes are running already: give them and railhil run --fault"
            elif command.get("do") == "fault":
                try:
                    plan = _with_fault(plan, str(command.get("text", "")))
                    why = ""
                except InputError as error:
                    why = str(error)
            panel.tell({"answer": command.get("id"), "refused": why})


def _with_fault(plan: Plan, text: str) -> Plan:
    """The run with one more fault, by hand unless it has a trigger.

    :raises InputError: it is none, or cannot be injected.
    """
    # Loading the language takes a tenth of the start of a command.
    from railhil.faults.language import fault_text, parse, with_condition

    spec = plan.spec
    fault = parse(normalise_fault(with_condition(text, "manual")))
    # Faults of a catalogue permit others at their place; a typed one beside them must permit them, too.
    beside = any(other.combine and other.id and other.place == fault.place for other in map(parse, spec.faults))
    found = replace(spec, faults=(*spec.faults, fault_text(replace(fault, combine=fault.combine or beside))))
    scenario = found.load()
    check_faults(scenario, transports_of(plan.choice, spec.start_up.foreign), spec.pace)
    return replace(plan, spec=found, scenario=scenario)
