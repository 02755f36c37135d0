"""``railhil run --panel``: the panel's process beside a run, and the wait for its start button."""

from __future__ import annotations

import argparse
import os
import secrets
import signal
import subprocess
import sys
import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from railhil.common.command_line import whole_number
from railhil.common.errors import InputError, OptionError, Sentence, Words
from railhil.common.extras import need
from railhil.judge.fault_report import check_faults, transports_of
from railhil.judge.result import Result
from railhil.live.processes import nodes_processor
from railhil.live.sockets import PANEL_TOKEN, PanelSocket, make_private_socket
from railhil.record.operator_commands import REALTIME_PACE, check_pace
from railhil.run.run import Observer, Plan
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.operator_commands import ORDER
from railhil.scenarios.options import PANEL_PORT, PORT_MAX, add_option, add_options
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_documents import nominal_sha256
from railhil.scenarios.settings import normalise_fault

if TYPE_CHECKING:
    from railhil.judge.record import Record

#: A run does not wait longer for its panel; on a busy machine it takes 2 s.
_READY_S = 5.0
_END_S = 2.0
_LOOK_S = 0.1
_SHOWN_S = 0.2
#: So long the end of a run stays on an open page that may give orders, unless the operator keeps it.
STAY_S = 45.0
#: Pace with which a run begins that has waited for its operator.
_WAITED_PACE = 1.0
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
        const=PANEL_PORT,
        type=whole_number(0, PORT_MAX),
        metavar="PORT",
        help=f"TCP port of 127.0.0.1 for a page of the run, see railhil panel (default: {PANEL_PORT}, or a free one if "
        "that is taken; 0: any)",
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
    parser.add_argument(
        "--wait", action="store_true", help="begin when Start is pressed on the panel, in lockstep at 1x with a page"
    )
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
        raise OptionError("--catalogue", "used only with nodes that railhil run starts, with its faults")
    if namespace.foxglove is not None and namespace.panel is None:
        raise OptionError("--foxglove", "used only with --panel")
    asked = "--panel" if namespace.panel is not None else "--operator" if namespace.operator is not None else ""
    if asked and spec.is_local:
        raise OptionError(asked, "cannot be given with --bus local: a panel listens to a run over a bus")
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
    """The panel's process while a run is made and until its end was seen, and the socket of its orders; a context.

    :param port: of the page; None: there is none.
    :param foxglove: port for other viewers; None: there is none.
    :param operator: socket of the orders; None: one of its own.
    """

    def __init__(self, port: int | None, foxglove: int | None, operator: Path | None) -> None:
        self._port, self._foxglove, self._operator = port, foxglove, operator
        self._held = ExitStack()
        self._socket: PanelSocket | None = None
        #: A page that is open stays the desk of the next run.
        self._token = secrets.token_urlsafe(16)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._held.close()

    @contextmanager
    def beside(self, plan: Plan) -> Iterator[Plan]:
        if self._socket is not None:
            self._port = self._socket.port or self._port
        # The page of the run before.
        self._held.close()
        process = None
        path = self._operator or self._held.enter_context(make_private_socket())
        socket = self._socket = self._held.enter_context(PanelSocket(path))
        socket.scenario = nominal_sha256(plan.scenario)
        if self._port is not None:
            apart = set() if plan.spec.is_realtime else nodes_processor()[1]
            words = self._words(plan, path)
            process = self._held.enter_context(panel_process(words, apart, {PANEL_TOKEN: self._token}))
            _wait_until_shown(process, socket)
        plan = replace(plan, panel=socket)
        if plan.spec.start_up.waits:
            paced = self._port is not None and not plan.spec.is_realtime
            plan = _wait_for_start(socket, replace(plan, pace=_WAITED_PACE if paced else 0.0), process)
        yield plan

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
        self._socket.tell(
            {"phase": "ended", "verdict": result.verdict, "line": result.line, "faults": list(result.scenario.faults)}
        )

    def show_end(self, run: Record) -> bool:
        """Show the end of a run as long as a page is open that may give orders, for :data:`STAY_S` unless the operator
        keeps it; returns whether the next run is to be made.
        """
        if self._socket is None or self._port is None:
            return False
        ended, until_s, is_kept = _describe_end(run), time.monotonic() + STAY_S, False
        self._socket.tell(ended)
        # Time to show it to pages that give no orders, too.
        time.sleep(_SHOWN_S)
        with suppress(KeyboardInterrupt):
            # A busy machine may have kept the panel waiting.
            self._socket.has_desk(time.monotonic())
            while self._socket.has_desk() and (is_kept or time.monotonic() < until_s):
                left_s = None if is_kept else until_s - time.monotonic()
                self._socket.tell({**ended, "left_s": left_s})
                for command in self._socket.take(_LOOK_S):
                    what = command.get("do")
                    refused = "" if what in ("next", "leave", "stay") else "the run has ended"
                    self._socket.tell({"answer": command.get("id"), "refused": refused})
                    is_kept = is_kept or what == "stay"
                    if what in ("next", "leave"):
                        return bool(what == "next")
        return False


def _describe_end(run: Record) -> dict[str, Any]:
    """The last report of a run to its pages."""
    # Loaded at the end of a run only.
    from railhil.record.hash_list import REPORT

    report = run.folder.resolve() / REPORT
    values = [(one, value) for one in run.judging.criteria if (value := run.score.with_sign(one)) is not None]
    return {
        "phase": "ended",
        "verdict": run.verdict,
        "line": run.line,
        # The panel knows the run by them.
        "faults": list(run.scenario.faults),
        "scores": [
            [one.title, f"{one.shown(value)} {one.unit_typeset}".strip(), one.missed(run.scenario, value)]
            for one, value in values
        ],
        "folder": str(run.folder.resolve()),
        "report": str(report) if report.is_file() else "",
        "rerun": run.certificate.get("command", ""),
    }


def _wait_until_shown(process: subprocess.Popen[bytes], socket: PanelSocket) -> None:
    """Wait until the page can be opened: the start of the panel takes half a second of a processor, and the run would
    be slower or late. A panel that ends or hangs is not waited for."""
    until_s = time.monotonic() + _READY_S
    while process.poll() is None and time.monotonic() < until_s and not socket.is_greeted(_LOOK_S):
        pass


@contextmanager
def panel_process(
    words: Sequence[str], apart: Collection[int] = (), named: Mapping[str, str] | None = None
) -> Iterator[subprocess.Popen[bytes]]:
    """``railhil panel`` with these words, as long as this context.

    :param apart: the only processors that it may use; empty: any. :param named: further environment variables.
    """
    command = [sys.executable, "-P", "-m", "railhil.panel", *words]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, env={**os.environ, **(named or {})})
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


def _wait_for_start(panel: PanelSocket, plan: Plan, process: subprocess.Popen[bytes] | None = None) -> Plan:
    """Wait until Start is pressed; returns the run with the faults and the pace that were chosen meanwhile.

    :param process: of the page; None: it is started apart.
    :raises InputError: the page has ended, so nobody can press Start.
    """
    lockstep = not plan.spec.is_realtime
    while True:
        if process is not None and process.poll() is not None:
            raise InputError("command line", "--wait", Words("a panel that has ended"), "one on which Start is pressed")
        state = {"faults": list(plan.scenario.faults), "lockstep": lockstep, "pace": plan.pace}
        panel.tell({"phase": "waiting", **state})
        for command in panel.take(_LOOK_S):
            what, pace = command.get("do"), command.get("pace")
            if what == "start":
                panel.tell({"answer": command.get("id"), "refused": ""})
                panel.tell({"phase": "starting", **state, "pace": plan.pace})
                return plan
            why = "press Start first"
            if what == "pace":
                why = check_pace(pace) if lockstep else REALTIME_PACE
                plan = plan if why else replace(plan, pace=float(pace or 0.0))
            elif what == "fault" and plan.spec.start_up.attach:
                why = "the nodes are running already: they have the faults with which they were started"
            elif what == "fault":
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
