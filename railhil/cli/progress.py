"""The progress line of a run: its share done, and speed, target, command, ladder and distance to go."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib import import_module
from typing import TYPE_CHECKING

from railhil.bus.ident import CtlIdent
from railhil.record.framelog import LOG_NAME
from railhil.run.run import Observer, Plan

if TYPE_CHECKING:
    from railhil.common.output import Output

#: The modules of the line are imported while the nodes start, or with the first redraw.
_LOADED_LATER = ("railhil.common.output", "rich.progress", "railhil.live.live_values")

#: Wall time between two redraws, in s. A redraw costs about five milliseconds.
_REDRAW_S = 0.4
#: A narrow terminal has a short bar, so that the values have room.
_NARROW, _BAR, _BAR_NARROW = 120, 30, 8


class Progress(Observer):
    """Shows the line while a run is made, if its console is a terminal.

    :param console: asked for at the first redraw.
    """

    def __init__(self, console: Callable[[], Output]) -> None:
        self._console = console
        self._held = ExitStack()
        self._plan: Plan | None = None
        self._redraw: Callable[[float], object] | None = None
        self._shown_s = -_REDRAW_S

    @contextmanager
    def beside(self, plan: Plan) -> Iterator[Plan]:
        with ExitStack() as self._held:
            self._plan = plan
            yield plan

    def on_started(self) -> None:
        for name in _LOADED_LATER:
            import_module(name)

    def on_progress(self, sim_time_s: float) -> None:
        now_s = time.monotonic()
        if now_s - self._shown_s < _REDRAW_S or self._plan is None:
            return
        self._shown_s = now_s
        if self._redraw is None:
            console = self._console()
            self._redraw = (
                self._held.enter_context(_line(self._plan, console)) if console.is_terminal else lambda _: None
            )
        self._redraw(sim_time_s)


@contextmanager
def _line(plan: Plan, console: Output) -> Iterator[Callable[[float], None]]:
    """The line on the terminal, and the object that redraws it."""
    scenario, spec = plan.scenario, plan.spec
    from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn

    from railhil.live.live_values import Instruments, LogTail
    from railhil.record.telemetry import reported

    columns: tuple[ProgressColumn, ...] = (
        TextColumn("{task.description}"),
        BarColumn(_BAR if console.width >= _NARROW else _BAR_NARROW),
        TextColumn("{task.completed:.0f} of {task.total:.0f} s"),
        TextColumn("{task.fields[now]}"),
    )
    instruments = Instruments(scenario)
    tail = LogTail(plan.folder / LOG_NAME, scenario.installed_system.contract)
    with Progress(*columns, console=console, auto_refresh=False, transient=True) as shown:
        task = shown.add_task("", total=scenario.planned_s, now="")

        def redraw(sim_time_s: float) -> None:
            newest = tail.look()
            now = instruments.line(instruments.values(newest))
            law = reported(spec.start_up, newest.trace(CtlIdent.PORT)).get("controller", spec.law.controller)
            shown.update(task, description=law, completed=sim_time_s, now=now, refresh=True)

        yield redraw
