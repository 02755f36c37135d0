"""Runs a campaign from its plan to its summary, using the parts that already exist."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from time import monotonic, process_time
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, TextColumn, TimeRemainingColumn
from rich.progress import Task as Shown
from rich.text import Text

from railhil.campaign.engines import Engine, Task
from railhil.campaign.folder import opened
from railhil.campaign.parts import C, PartsFolder
from railhil.campaign.plan import Plan
from railhil.campaign.results_table import NotThePart
from railhil.campaign.summary import summary
from railhil.campaign.work import task_of
from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.common.exit_codes import TOOL_ERROR, exit_code_of

T = TypeVar("T")
#: Maximum updates of the progress display per second.
_REFRESH_HZ = 4
#: Averaging time of the displayed speed, s.
_SPEED_S = 60


class Stopped(Exception):
    """A campaign that could not be finished: the reason, what is kept, how to resume."""

    def __init__(self, text: str, exit_code: int) -> None:
        super().__init__(text)
        self.exit_code = exit_code


class _Speed(ProgressColumn):
    """Runs per second of this session."""

    def render(self, task: Shown) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.0f} runs/s")


def execute(
    plan: Plan, out: str | None, console: Console, engine: Engine, say: Callable[[str], None]
) -> tuple[Path, dict[str, Any]]:
    """Run the missing parts of a campaign, then join and summarise it.

    :param out: its folder; None creates a new one.
    :param console: for progress (standard error).
    :param say: for remarks.
    :returns: the folder and the content of ``summary.json``.
    :raises scenarios.errors.InputError: the folder cannot be used.
    :raises Stopped: workers or parts were lost, or the record can no longer be written.
    """
    with opened(out, plan) as folder:

        def finish() -> dict[str, Any]:
            found = summary(plan, folder.write_results())
            folder.write_summary(found)
            return found

        wanted = partial(task_of, plan)
        return folder.path, completed(folder, wanted, engine, console, say, "railhil campaign", finish)


def completed(
    folder: PartsFolder[C],
    task: Callable[[C], Task],
    engine: Engine,
    console: Console,
    say: Callable[[str], None],
    command: str,
    finish: Callable[[], T],
) -> T:
    """Make the missing parts of a folder, then finish it.

    :param task: what a worker is given for a chunk.
    :param console, say: as for :func:`execute`.
    :param command: that goes on with ``--resume`` after an interruption.
    :param finish: called when all parts are there; its result is returned.
    :raises scenarios.errors.InputError: of a task.
    :raises Stopped: workers or parts were lost, or the record can no longer be written.
    """
    total = folder.total

    def how_on() -> str:
        return f"{folder.kept():,} of {total:,} runs are kept; {command} --resume {folder.path} goes on"

    try:
        left, complaints = folder.missing()
        for complaint in complaints:
            say(complaint)
        if kept := folder.kept():
            say(f"{folder.path}: {kept:,} of {total:,} runs are there already")
        # Close it at once after an exception, so that workers do not continue.
        with _progress(console, kept, total) as shown, closing(_made(folder, left, task, engine)) as made:
            began_s, used_s, new = monotonic(), process_time(), 0
            for runs in made:
                shown(runs)
                new += runs
        if new:
            wall_s, cpu_s = monotonic() - began_s, process_time() - used_s
            said = count_of(new, "run", spec=",")
            say(f"{said} in {wall_s:.1f} s; this process used {cpu_s:.1f} s of processor time for them")
        return finish()
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"stopped; {how_on()}") from None
    except SystemExit:
        say(f"{command}: stopped; {how_on()}")
        raise
    except NotThePart as why:
        raise Stopped(f"a part in {folder.path} has become {why}; {how_on()}", TOOL_ERROR) from why
    except InputError:
        raise
    except Exception as error:
        # A worker, a law or a driver may fail in any way: the message gives the reason and what is kept.
        text = " ".join(str(error).split()) or type(error).__name__
        code = exit_code_of(error)
        kind = f"{type(error).__name__}: " if not hasattr(error, "exit_code") else ""
        raise Stopped(f"{kind}{text}; {how_on()}", code) from error


def _made(
    folder: PartsFolder[C], left: Sequence[C], task: Callable[[C], Task], engine: Engine
) -> Generator[int, None, None]:
    """Write the missing parts; yields the number of runs of each as soon as it is safely written."""
    if not left:
        return
    runs = {chunk.name: chunk.runs for chunk in left}
    with closing(engine([task(chunk) for chunk in left])) as parts:
        for name, content in parts:
            folder.write_part(name, content)
            yield runs[name]


@contextmanager
def _progress(console: Console, done: int, total: int) -> Iterator[Callable[[int], None]]:
    """A progress bar on a terminal, nothing elsewhere; called with the number of newly finished runs."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _Speed(),
        TimeRemainingColumn(),
    )
    with Progress(
        *columns,
        console=console,
        transient=True,
        disable=not console.is_terminal,
        refresh_per_second=_REFRESH_HZ,
        speed_estimate_period=_SPEED_S,
    ) as bar:
        task = bar.add_task("runs", total=total, completed=done)
        yield lambda runs: bar.advance(task, runs)
