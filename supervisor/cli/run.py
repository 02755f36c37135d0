"""``railhil run``: one scenario over the bus in three processes, recorded and scored."""

from __future__ import annotations

import argparse
import errno
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import entry_points
from pathlib import Path

import can
from can.cli import add_bus_arguments
from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn

from bus.exitcodes import USAGE
from bus.ident import ARITHMETICS
from bus.select import BusChoice, choose_bus
from bus.usage import add_run_arguments, add_task_argument
from scenarios.errors import InputError, Words
from scenarios.load import load
from scenarios.model import Scenario
from scenarios.parameters import load_parameters
from supervisor.cli.dbcfile import check_foreign_dbc
from supervisor.cli.output import Output, print_json
from supervisor.cli.show import print_result
from supervisor.folder import discard_folder, record_failed, run_folder, score_json, write_folder
from supervisor.run import Run, RunOptions, RunResult

#: What the operating system says when a log cannot grow.
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS)


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("run", help="run a scenario over the bus, record it, score it")
    add_run_arguments(parser)
    parser.add_argument("--controller", default="ipfc", metavar="LAW", help=f"one of {', '.join(law_names())}")
    parser.add_argument("--arithmetic", choices=sorted(ARITHMETICS[1:]), default="iq")
    parser.add_argument("--parameters", type=Path, metavar="FILE", help="parameters of the law (default: its own)")
    parser.add_argument("--indexing", choices=("time", "distance"), default="time", help="set-point indexing")
    add_task_argument(parser)
    parser.add_argument("--out", metavar="DIR", help="run folder (default runs/<utc>-<scenario>-<controller>)")
    parser.add_argument("--attach", action="store_true", help="plant and controller are running already")
    parser.add_argument("--dbc", metavar="FILE", help="refuse to run unless this DBC describes the telegrams")
    parser.add_argument("--json", action="store_true", help="print score.json instead of the table")
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    add_bus_arguments(parser)
    parser.set_defaults(work=work)


def law_names() -> list[str]:
    """Names of the registered control laws."""
    return sorted(entry.name for entry in entry_points(group="railhil.laws"))


def _options(namespace: argparse.Namespace) -> RunOptions:
    if namespace.controller not in law_names():
        raise InputError("command line", "--controller", namespace.controller, ", ".join(law_names()))
    if namespace.attach and namespace.task_period_ms:
        raise InputError("command line", "--task-period-ms", namespace.task_period_ms, "0 with --attach")
    scenario = namespace.scenario
    parameters = None if namespace.parameters is None else load_parameters(namespace.parameters.resolve())
    return RunOptions(
        scenario=str(Path(scenario).resolve()) if scenario.endswith(".toml") else scenario,
        controller=namespace.controller,
        arithmetic=namespace.arithmetic,
        indexing=namespace.indexing,
        pace=namespace.pace,
        rate=namespace.rate,
        seed=namespace.seed,
        perturbed=namespace.perturbed,
        task_period_ms=namespace.task_period_ms,
        parameters=parameters,
        attach=namespace.attach,
        appear_s=namespace.appear_timeout,
    )


def _bus(namespace: argparse.Namespace, private_hub: Path | None) -> BusChoice:
    """The bus of the run.

    :raises InputError: what is chosen cannot carry a run.
    """
    choice = choose_bus(namespace, private_hub)
    interface = choice.config.get("interface")
    if interface is None:
        try:
            can.util.load_config(config=dict(choice.config))
        except can.CanInterfaceNotImplementedError:
            found = Words(f"only {' '.join(choice.arguments)}")
            raise InputError("command line", "--interface", found, "-i INTERFACE beside it, or can.rc") from None
    if interface == "virtual":
        raise InputError("command line", "--interface", interface, "an interface that other processes can open")
    return choice


def work(namespace: argparse.Namespace) -> int:
    """Run, write the run folder, print; the exit code is the verdict."""
    options = _options(namespace)
    scenario = load(options.scenario)
    if namespace.dbc is not None:
        check_foreign_dbc(namespace.dbc)
    console = Output(stderr=namespace.json)
    with tempfile.TemporaryDirectory(prefix="railhil-") as private:
        choice = _bus(namespace, None if options.attach else Path(private) / "hub.sock")
        folder, made = run_folder(namespace.out, scenario.name, options.controller)
        console.say(f"bus: {choice.transport} ({choice.reason})")
        quiet = namespace.quiet or namespace.json or not console.is_terminal
        with _progress(scenario, options, console, quiet) as on_progress:
            run = Run(scenario, options, choice, folder, on_progress)
            result = _executed(run, folder, made)
    refused = result.exit_code == USAGE and result.sim_time_s == 0
    if refused or result.frames == 0:
        discard_folder(folder, made)
        raise NeverBegan(result.line or "no frame came", result.exit_code)
    given = [] if choice.needs_hub else choice.arguments
    write_folder(folder, scenario, options, result, run.trace, given)
    if namespace.json:
        print_json(score_json(result, options))
    else:
        print_result(console, scenario, result, options, folder)
    return run.stopped_exit_code or result.exit_code


class NeverBegan(Exception):
    """A run that never began; carries its exit code."""

    def __init__(self, line: str, exit_code: int) -> None:
        super().__init__(line)
        self.exit_code = exit_code


def _executed(run: Run, folder: Path, made: bool) -> RunResult:
    """The run's result; whatever goes wrong, a folder without a frame goes and a folder with frames stays."""
    try:
        return run.execute()
    except BaseException as error:
        if run.session.frames == 0:
            discard_folder(folder, made)
        elif isinstance(error, OSError) and error.errno in _NO_ROOM:
            raise record_failed(folder, error) from error
        raise


@contextmanager
def _progress(
    scenario: Scenario, options: RunOptions, console: Output, quiet: bool
) -> Iterator[Callable[[float], None] | None]:
    """What the run calls with its simulation time in s; None when nothing is to be shown."""
    if quiet:
        yield None
        return
    columns: tuple[ProgressColumn, ...] = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:6.1f} of {task.total:.0f} s simulated"),
    )
    with Progress(*columns, console=console, auto_refresh=False, transient=True) as progress:
        task = progress.add_task(options.controller, total=scenario.plan.running_time_s)
        shown_s = -1e9

        def on_progress(sim_time_s: float) -> None:
            nonlocal shown_s
            # A redraw costs about a millisecond: one per ten simulated seconds is smooth enough for the eye.
            if sim_time_s - shown_s >= (10.0 if options.pace == "lockstep" else 0.5):
                shown_s = sim_time_s
                progress.update(task, completed=sim_time_s, refresh=True)

        yield on_progress
