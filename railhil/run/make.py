"""Makes a run on any transport, records it into its folder, and judges it."""

from __future__ import annotations

import errno
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.common.errors import InputError, OptionError
from railhil.common.exit_codes import FAIL, INVALID, USAGE
from railhil.common.user_files import NO_ROOM
from railhil.judge.fault_report import check_faults, transports_of
from railhil.live.processes import process_start_ns
from railhil.record.run_folder import PARAMETERS, discard_folder, run_folder, write_inputs
from railhil.run.bus_run import BusRun
from railhil.run.memory import keep_memory, learned, with_memory
from railhil.run.node_commands import chosen_bus
from railhil.run.run import Observer, Plan, Run
from railhil.scenarios.given import RecordedController
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.judge.result import Result

#: Modules for the end of a run. They are loaded while the nodes end, or when they are used: while the nodes start,
#: three processes would share the two processors of many machines.
_FOR_THE_END = (
    "railhil.run.conclusion",
    "railhil.judge.folder",
    "railhil.judge.reactions.expected",
    "railhil.report.recorded",
)
#: Errors of the operating system when a log cannot grow.
_CANNOT_GROW = (*NO_ROOM, errno.EROFS)


class NeverBegan(Exception):
    """A run that never began; carries its exit code."""

    def __init__(self, line: str, exit_code: int) -> None:
        super().__init__(line)
        self.exit_code = exit_code

    def __reduce__(self) -> tuple[type[NeverBegan], tuple[str, int]]:
        """Needed to pass it back from the process that made the run."""
        return type(self), (str(self), self.exit_code)


class _Observers(Observer):
    """All observers, in order."""

    def __init__(self, observers: Sequence[Observer]) -> None:
        self._observers = observers

    @contextmanager
    def beside(self, plan: Plan) -> Iterator[Plan]:
        with ExitStack() as held:
            for observer in self._observers:
                plan = held.enter_context(observer.beside(plan))
            yield plan

    def on_started(self) -> None:
        for observer in self._observers:
            observer.on_started()

    def on_progress(self, sim_time_s: float) -> None:
        for observer in self._observers:
            observer.on_progress(sim_time_s)

    def on_ended(self) -> None:
        for name in _FOR_THE_END:
            import_module(name)
        for observer in self._observers:
            observer.on_ended()

    def on_result(self, result: Result) -> None:
        for observer in self._observers:
            observer.on_result(result)


def record_run(spec: RunSpec, *observers: Observer, scenario: AnyScenario | None = None, keep: bool = True) -> Result:
    """Make a run, and write its folder; a signal that arrives while results are written waits until they are complete.

    :param scenario: None: that of the spec.
    :param keep: whether the folder is kept; else only what the result needs is written.
    :raises InputError: a part of the run is not allowed; one line.
    :raises NeverBegan: no frame came, or the run was refused; the folder is left as it was.
    :raises RecordFailed: folder or memory cannot be written.
    """
    _check_given(spec)
    scenario = spec.load() if scenario is None else scenario
    if spec.law.given is not None:
        spec.law.given.prepare(scenario, spec)
    if spec.requirements:
        from railhil.judge.requirements.requirement import requirements_of

        requirements_of(spec, scenario)
    observer = _Observers(observers)
    with ExitStack() as held:
        choice = held.enter_context(chosen_bus(spec, scenario))
        folder, made = run_folder(spec.out, scenario.name, spec.folder_controller)
        try:
            plan = held.enter_context(observer.beside(Plan(placed(spec, folder), scenario, choice, folder)))
            run = _begun(plan, observer)
            run.started_ns = process_start_ns()
            held.enter_context(run.stop)
        except BaseException:
            # No folder without a run may remain on Ctrl-C, too.
            discard_folder(folder, made)
            raise
        result = _executed(run, made)
        refused = result.exit_code == USAGE and result.sim_time_s == 0
        if refused or result.frames == 0:
            discard_folder(folder, made)
            raise NeverBegan(result.line or "no frame came", result.exit_code)
        complete(result)
        if keep:
            write_results(result)
        observer.on_result(result)
    if run.stop.number:
        result.stopped_exit_code = 128 + run.stop.number
    return result


def _check_given(spec: RunSpec) -> None:
    """Refuse a controller of the user in a run that it cannot be in.

    :raises InputError: it is only recorded, or another program is the controller, or other processes do not have it.
    """
    given = spec.law.given
    if given is None:
        return
    if isinstance(given, RecordedController):
        raise given.refuse()
    if spec.start_up.foreign and not given.may_be_foreign:
        raise OptionError(
            f"--controller {given.text}", "cannot be given with --no-controller: another program is the controller"
        )
    if given.is_here_only and not spec.is_local:
        allowed = "local with a function or an object; FILE.py:NAME runs on every bus"
        raise InputError("railhil.run", "bus", spec.bus, allowed)


def run_into(folder: Path, spec: RunSpec, *, keep: bool = True) -> Result:
    """The result of a run into a folder; one that is made here is removed if the run never began.

    :param keep: whether the folder is to be complete; else it has only the files that the result needs.
    :raises InputError: the run cannot inject one of its faults.
    :raises NeverBegan: no frame came.
    :raises SystemExit: a signal has ended the run.
    """
    result = record_run(replace(spec, out=folder), keep=keep)
    if result.stopped_exit_code:
        raise SystemExit(result.stopped_exit_code)
    return result


def complete(result: Result) -> None:
    """Complete a result with its events, and with the expectations of its faults."""
    from railhil.judge.events.summary import fault_events
    from railhil.judge.events.telegrams import events_of
    from railhil.judge.reactions.expected import with_expectations

    scenario, trace = result.scenario, result.trace
    injected = [one.as_json() for one in result.faults]
    result.events = events_of(scenario, trace, fault_events(injected, trace.end_s))
    expected = with_expectations(result.score, injected, result.events, scenario, trace)
    if result.trusted and expected is not result.score:
        code = INVALID if expected.verdict == "INVALID" else FAIL
        result.score, result.exit_code, result.line = expected, code, "; ".join(expected.failures)
    if result.spec.requirements:
        _judge_requirements(result)


def _judge_requirements(result: Result) -> None:
    """Complete a result with the outcomes of its requirements: a violated one is a FAIL."""
    # A run without requirements does not load their language.
    from railhil.judge.requirements.outcome import with_requirements
    from railhil.judge.requirements.requirement import requirements_of

    result.score = with_requirements(result.as_record(), requirements_of(result.spec, result.scenario))
    if result.trusted and any(one.violated for one in result.score.requirements):
        result.exit_code, result.line = FAIL, "; ".join(result.score.failures)


def write_results(result: Result) -> None:
    """Complete a result with the law's memory, and write folder and memory.

    :param result: of :func:`complete`.
    :raises RecordFailed: they cannot be written.
    """
    from railhil.judge.folder import write_folder

    result.memory = learned(result)
    write_folder(result)
    keep_memory(result)


def placed(spec: RunSpec, folder: Path) -> RunSpec:
    """The run with parameters that were given as values read from the run folder, where they will be written."""
    given = spec.law.parameters
    if given is None or given.source != Path(PARAMETERS):
        return spec
    return replace(spec, law=replace(spec.law, parameters=replace(given, source=folder.resolve() / PARAMETERS)))


def _begun(plan: Plan, observer: Observer) -> Run:
    """The run, ready to be executed: its inputs are in its folder.

    :raises RecordFailed: they cannot be written.
    """
    spec, scenario, folder = plan.spec, plan.scenario, plan.folder
    check_faults(scenario, transports_of(plan.choice, spec.start_up.foreign), spec.pace)
    try:
        write_inputs(folder, scenario, spec.law.parameters)
        plan = replace(plan, spec=with_memory(spec, folder))
        if spec.is_local:
            # Laws and plant are loaded only by processes that compute with them.
            from railhil.run.local import LocalRun

            return LocalRun(plan, observer)
        return BusRun(plan, observer)
    except OSError as error:
        from railhil.judge.folder import record_failed

        raise record_failed(folder, error) from error


def _executed(run: Run, made: bool) -> Result:
    """The run's result; on any error a folder without frames is removed and a folder with frames is kept."""
    try:
        result = run.execute()
    except BaseException as error:
        if run.session.frames == 0:
            discard_folder(run.folder, made)
        elif isinstance(error, OSError) and error.errno in _CANNOT_GROW:
            from railhil.judge.folder import record_failed

            raise record_failed(run.folder, error) from error
        raise
    if run.session.commands.operator is not None and tuple(run.session.commands.operator.sent) != run.spec.orders:
        # A repetition of the run needs no operator.
        result.spec = replace(run.spec, orders=tuple(run.session.commands.operator.sent))
    return result
