"""Shared by ``railhil run`` and ``railhil compare``: one law over the bus, recorded into its own folder."""

from __future__ import annotations

import argparse
import errno
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.bus.can_settings import add_bus_arguments
from railhil.bus.select import BusChoice, choose_bus, no_bus, own_pipes
from railhil.cli.progress import LOADED_LATER, progress
from railhil.common.choices import BUSES
from railhil.common.command_line import add_law_arguments, add_run_arguments
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, INVALID, USAGE
from railhil.common.extras import install_command
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.settings import add_fault_argument, add_set_argument
from railhil.scenarios.system import DEFAULT, System, system_named
from railhil.supervisor.desk import Desk
from railhil.supervisor.errors import NO_ROOM
from railhil.supervisor.fault_report import check_faults, transports_of
from railhil.supervisor.inputs import write_inputs
from railhil.supervisor.launch import needs_orders
from railhil.supervisor.memory import keep_memory, learned, with_memory
from railhil.supervisor.panel_socket import PanelSocket
from railhil.supervisor.processes import process_start_ns
from railhil.supervisor.run import Run
from railhil.supervisor.run_folder import discard_folder
from railhil.supervisor.sockets import private_socket
from railhil.supervisor.start_up import StartUp

if TYPE_CHECKING:
    from railhil.common.output import Output
    from railhil.local_run import LocalRun
    from railhil.supervisor.report.recorded import RecordedRun
    from railhil.supervisor.result import RunResult
    from railhil.supervisor.trace import Trace

#: What the end of a run needs. It is loaded while the nodes end, or when it is used: while they start, three processes
#: would share what are two processors on many machines.
_FOR_THE_END = (
    "railhil.supervisor.ending",
    "railhil.supervisor.folder",
    "railhil.supervisor.reactions.expected",
    "railhil.supervisor.report.recorded",
    "railhil.cli.show_run",
)
#: Errors of the operating system when a log cannot grow.
_CANNOT_GROW = (*NO_ROOM, errno.EROFS)


class NeverBegan(Exception):
    """A run that never began; carries its exit code."""

    def __init__(self, line: str, exit_code: int) -> None:
        super().__init__(line)
        self.exit_code = exit_code

    def __reduce__(self) -> tuple[type[NeverBegan], tuple[str, int]]:
        """So that it can come back from the process that made the run."""
        return type(self), (str(self), self.exit_code)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of every command that runs laws over the bus."""
    add_run_arguments(parser)
    add_set_argument(parser)
    add_fault_argument(parser)
    add_law_arguments(parser)
    parser.add_argument(
        "--no-rt", action="store_true", help="realtime: normal scheduling, no locked memory, even where permitted"
    )
    parser.add_argument("--no-report", action="store_true", help="write no report.html")
    parser.add_argument(
        "--verbose", action="store_true", help="print all that the scenario assumes, and how long the end took"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    parser.add_argument(
        "--bus",
        choices=BUSES,
        default="auto",
        help="local: all nodes in this process, no bus (same record, faster)",
    )
    add_bus_arguments(parser)


def law_names(system: System | None = None) -> list[str]:
    """Names of the installed laws of a system, in the order of every table; None: of railhil's own system."""
    return (system or system_named(DEFAULT)).law_names()


def run_system(namespace: argparse.Namespace) -> System:
    """The system of the scenario on the command line.

    :raises InputError: it cannot be loaded.
    """
    return system_named(load_any(namespace.scenario, namespace.set, namespace.fault).system)


def run_spec(namespace: argparse.Namespace, controller: str | None, parameters: ParameterSet | None) -> RunSpec:
    """The run of one law as described by the command line; None: the usual one of the scenario's system.

    :raises InputError: there is no such scenario.
    """
    law = LawSpec.from_namespace(namespace, run_system(namespace), controller, parameters)
    return RunSpec.from_namespace(namespace, law)


def start_up(namespace: argparse.Namespace) -> StartUp:
    """How to start the bench of a run, from the command line."""
    return StartUp(ask_for_fifo=not namespace.no_rt, appear_s=namespace.appear_timeout)


@contextmanager
def chosen_bus(
    namespace: argparse.Namespace, spec: RunSpec, scenario: AnyScenario, attach: bool = False
) -> Iterator[BusChoice]:
    """The bus of one run, from python-can's options if given; the socket of the run's own hub is in a temporary
    folder. A run in lockstep that would get a hub unasked, and whose faults need none, has none: its nodes get pipes.

    :raises InputError: the chosen bus cannot carry a run.
    """
    if spec.is_local:
        yield no_bus(namespace, spec.pace)
        return
    with private_socket() as private:
        choice = choose_bus(namespace, None if attach else private)
        interface = choice.config.get("interface")
        if interface == "virtual":
            allowed = "an interface that other processes can open"
            raise InputError("command line", "--interface", interface, allowed)
        if gets_pipes(namespace, choice) and not spec.is_realtime and not needs_orders(scenario.faults):
            choice = own_pipes()
        yield choice


def gets_pipes(namespace: argparse.Namespace, choice: BusChoice) -> bool:
    """Whether a run in lockstep whose faults need no hub gets pipes instead of the chosen bus: it is a hub of its own,
    and nobody has named it. A run that waits for its start may be given faults of the bus meanwhile."""
    return choice.needs_hub and "interface" not in namespace and not getattr(namespace, "wait", False)


def recorded(
    scenario: AnyScenario,
    spec: RunSpec,
    start_up: StartUp,
    choice: BusChoice,
    folder: Path,
    made: bool,
    console: Callable[[], Output],
    quiet: bool,
    *,
    keep: bool = True,
    panel: PanelSocket | None = None,
) -> tuple[Run | LocalRun, RunResult]:
    """Run one law and write its folder; a signal that arrives while results are written waits until they are complete.

    :param made: whether the folder was made for the run; it is then removed if the run never began.
    :param keep: whether the folder is kept; else only what the result needs is written.
    :param panel: where a person gives orders.
    :returns: the run, whose ``spec`` has the memory that it began with, and its result.
    :raises NeverBegan: no frame came, or the run was refused; the folder is left as it was.
    :raises RecordFailed: folder or memory cannot be written.
    """
    with ExitStack() as held:
        try:
            on_progress = held.enter_context(progress(scenario, spec, start_up, folder, console, quiet))
            check_faults(scenario, transports_of(choice, start_up.foreign), spec.pace)
            write_inputs(folder, scenario, spec.law.parameters)
            spec = with_memory(spec, folder)
            run = _bench(scenario, spec, start_up, choice, folder, on_progress, panel)
            held.enter_context(run.stop)
        except OSError as error:
            from railhil.supervisor.folder import record_failed

            discard_folder(folder, made)
            raise record_failed(folder, error) from error
        except BaseException:
            # On Ctrl-C, too, no folder without a run may remain.
            discard_folder(folder, made)
            raise
        result = _executed(run, folder, made)
        if run.session.desk is not None and tuple(run.session.desk.sent) != spec.orders:
            # The same run again needs no hand.
            spec = run.spec = replace(spec, orders=tuple(run.session.desk.sent))
        refused = result.exit_code == USAGE and result.sim_time_s == 0
        if refused or result.frames == 0:
            discard_folder(folder, made)
            raise NeverBegan(result.line or "no frame came", result.exit_code)
        complete(scenario, result, run.trace)
        if keep:
            arguments = [] if choice.is_private else choice.arguments
            write_results(folder, scenario, spec, start_up, result, run.trace, arguments)
    if run.stop.number:
        run.stopped_exit_code = 128 + run.stop.number
    return run, result


def complete(scenario: AnyScenario, result: RunResult, trace: Trace) -> None:
    """Complete a result with its events, and with what its faults expected of them."""
    from railhil.supervisor.events.derive import events_of
    from railhil.supervisor.events.injected import fault_events
    from railhil.supervisor.reactions.expected import with_expectations

    injected = [one.as_json() for one in result.faults]
    result.events = events_of(scenario, trace, fault_events(injected, trace.end_s))
    expected = with_expectations(result.score, injected, result.events, scenario, trace)
    if result.trusted and expected is not result.score:
        code = INVALID if expected.verdict == "INVALID" else FAIL
        result.score, result.exit_code, result.line = expected, code, "; ".join(expected.failures)


def write_results(
    folder: Path,
    scenario: AnyScenario,
    spec: RunSpec,
    start_up: StartUp,
    result: RunResult,
    trace: Trace,
    bus_arguments: list[str],
) -> None:
    """Complete a result with the law's memory, and write folder and memory.

    :param result: of :func:`complete`.
    :raises RecordFailed: they cannot be written.
    """
    from railhil.supervisor.folder import write_folder

    result.memory = learned(scenario, spec, folder, result)
    write_folder(folder, scenario, spec, start_up, result, trace, bus_arguments)
    if result.memory is not None:
        keep_memory(spec, folder, result.memory)


def as_recorded(folder: Path, run: Run | LocalRun, result: RunResult) -> RecordedRun:
    """A run that has just ended, as recorded in its folder."""
    from railhil.supervisor.documents import read_certificate
    from railhil.supervisor.report.recorded import recorded_run

    invalid = "" if result.exit_code in (0, 1) else result.line or "no reason given"
    certificate = read_certificate(folder) or {}
    return recorded_run(folder, certificate, run.scenario, run.trace, result.score, invalid, events=result.events)


def report_line(runs: Sequence[RecordedRun], folder: Path, notes: Sequence[str] = ()) -> str:
    """Write ``report.html``; returns the line that says where, or why there is none. The record is complete without
    it."""
    from railhil.supervisor.hash_list import REPORT

    try:
        from railhil.supervisor.report.page import write_report
    except ImportError as error:
        return f"no report: {error.name} is not installed ({install_command('report')})"
    path = folder / REPORT
    try:
        write_report(runs, path, notes)
    except OSError as error:
        return f"no report: {path} cannot be written ({(error.strerror or str(error)).lower()})"
    return f"report {path}"


def load_for_the_end() -> None:
    """Load what the end of a run needs."""
    for name in _FOR_THE_END:
        import_module(name)


def load_for_progress() -> None:
    """Load what the line of progress needs."""
    for name in LOADED_LATER:
        import_module(name)


def _bench(
    scenario: AnyScenario,
    spec: RunSpec,
    start_up: StartUp,
    choice: BusChoice,
    folder: Path,
    on_progress: Callable[[float], None] | None,
    panel: PanelSocket | None = None,
) -> Run | LocalRun:
    if not spec.is_local:
        desk = None if panel is None else Desk(spec.orders, panel, not spec.is_realtime, scenario.faults)
        return Run(
            scenario,
            spec,
            start_up,
            choice,
            folder,
            on_progress,
            desk=desk,
            meanwhile=None if on_progress is None else load_for_progress,
            at_end=load_for_the_end,
        )
    # Laws and plant are loaded only by processes that compute with them.
    from railhil.local_run import LocalRun

    return LocalRun(scenario, spec, folder, on_progress, started_ns=process_start_ns())


def _executed(run: Run | LocalRun, folder: Path, made: bool) -> RunResult:
    """The run's result; whatever goes wrong, a folder without frames is removed and one with frames is kept."""
    try:
        return run.execute()
    except BaseException as error:
        if run.session.frames == 0:
            discard_folder(folder, made)
        elif isinstance(error, OSError) and error.errno in _CANNOT_GROW:
            from railhil.supervisor.folder import record_failed

            raise record_failed(folder, error) from error
        raise
