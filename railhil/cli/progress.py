"""The progress line of a run: how far it is, and speed, target, command, ladder and distance to go."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.bus.ident import CtlIdent
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import system_named
from railhil.supervisor.framelog import LOG_NAME
from railhil.supervisor.start_up import StartUp

if TYPE_CHECKING:
    from railhil.common.output import Output

#: What the line needs. It is loaded while the nodes start, or with the first redraw.
LOADED_LATER = ("railhil.common.output", "rich.progress", "railhil.supervisor.now")

#: Wall time between two redraws, in s. A redraw costs about five milliseconds.
_REDRAW_S = 0.4
#: A narrow terminal has a short bar, so that the values have room.
_NARROW, _BAR, _BAR_NARROW = 120, 30, 8


@contextmanager
def progress(
    scenario: AnyScenario, spec: RunSpec, start_up: StartUp, folder: Path, console: Callable[[], Output], quiet: bool
) -> Iterator[Callable[[float], None] | None]:
    """Progress callback of the run, taking the simulation time in s; None when nothing is to be shown.

    :param folder: of the run, whose log is read while it is written.
    :param console: where the line is shown, if it is a terminal: asked for at the first call.
    """
    if quiet:
        yield None
        return
    with ExitStack() as held:
        redraw: Callable[[float], object] | None = None
        shown_s = -_REDRAW_S

        def on_progress(sim_time_s: float) -> None:
            nonlocal redraw, shown_s
            now_s = time.monotonic()
            if now_s - shown_s >= _REDRAW_S:
                shown_s = now_s
                if redraw is None:
                    redraw = held.enter_context(_shown(scenario, spec, start_up, folder, console()))
                redraw(sim_time_s)

        yield on_progress


@contextmanager
def _shown(
    scenario: AnyScenario, spec: RunSpec, start_up: StartUp, folder: Path, console: Output
) -> Iterator[Callable[[float], object]]:
    """What redraws the line; nothing, if there is no terminal."""
    if not console.is_terminal:
        yield lambda _: None
        return
    with _line(scenario, spec, start_up, folder, console) as redraw:
        yield redraw


@contextmanager
def _line(
    scenario: AnyScenario, spec: RunSpec, start_up: StartUp, folder: Path, console: Output
) -> Iterator[Callable[[float], None]]:
    """The line on the terminal; what redraws it."""
    from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn

    from railhil.supervisor.now import Instruments, LogTail
    from railhil.supervisor.reported import reported

    columns: tuple[ProgressColumn, ...] = (
        TextColumn("{task.description}"),
        BarColumn(_BAR if console.width >= _NARROW else _BAR_NARROW),
        TextColumn("{task.completed:.0f} of {task.total:.0f} s"),
        TextColumn("{task.fields[now]}"),
    )
    instruments = Instruments(scenario)
    tail = LogTail(folder / LOG_NAME, system_named(scenario.system).contract)
    with Progress(*columns, console=console, auto_refresh=False, transient=True) as shown:
        task = shown.add_task("", total=scenario.planned_s, now="")

        def redraw(sim_time_s: float) -> None:
            newest = tail.look()
            now = instruments.line(instruments.values(newest))
            law = reported(start_up, newest.trace(CtlIdent.PORT)).get("controller", spec.law.controller)
            shown.update(task, description=law, completed=sim_time_s, now=now, refresh=True)

        yield redraw
