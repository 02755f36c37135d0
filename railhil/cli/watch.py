"""``railhil watch``: a run on a bus in the terminal, without a browser. It listens only."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from math import isnan
from typing import Any

from rich.console import Group, RenderableType
from rich.live import Live
from rich.panel import Panel
from rich.text import Text

from railhil.bus.can_settings import HUB_INTERFACE, add_bus_arguments, named_bus
from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame
from railhil.bus.link import Link, open_link
from railhil.bus.link.opening import listen_only
from railhil.bus.select import choose_bus
from railhil.cli.run_identity import RunIdentity, named_scenario
from railhil.common.digits import count_of
from railhil.common.output import Output, table, whole
from railhil.live.bus_follower import Listener, Milestones
from railhil.live.live_values import Instruments
from railhil.report.display_columns import LEVEL
from railhil.scenarios.options import add_option, add_options

#: Wall time between two pictures, and simulated time between two lines where there is no terminal.
_REDRAW_S, _LINE_S = 0.25, 1.0
#: Waiting time of one reading of the bus, and number of frames taken between two pictures.
_WAIT_S, _FRAMES_MAX = 0.05, 20_000
#: Frames that the hub hands over together.
_BULK_FRAMES = 256


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "watch",
        examples=["railhil watch -i socketcan -c vcan0", "railhil watch -i railhil > run.txt"],
        description="Shows the run on the bus until Ctrl-C, or until the hub has gone. Into a file or pipe it writes "
        "one line per simulated second.",
    )
    add_option(parser, "scenario", ", if no shipped one runs there", default=None, usual="as the plant tells")
    add_option(parser, "--controller", ", whose notes are then named", usual="")
    add_options(parser, "--set", "--fault")
    add_bus_arguments(parser)


def work(namespace: argparse.Namespace) -> int:
    """Watch the bus.

    :raises InputError: no such scenario, law, or interface.
    :raises BusUnavailable: the bus cannot be opened.
    """
    watched = RunIdentity(named_scenario(namespace.scenario, namespace.set, namespace.fault), namespace.controller)
    choice = choose_bus(named_bus(namespace))
    console = Output()
    link = listening(choice.config)
    console.say(f"bus: {choice.transport} ({choice.reason}), listening only")
    view = View(watched, lines=not console.is_terminal)
    try:
        if console.is_terminal:
            with Live(view.picture(), console=console, auto_refresh=False, transient=False) as live:
                watch(link, view, lambda: live.update(view.picture(), refresh=True))
        else:
            watch(link, view, lambda: console.print("".join(view.new_lines()), end="", soft_wrap=True))
    except BusLost:
        console.say(f"the bus has gone at {view.instant}, after {count_of(view.frames, 'frame')}")
    finally:
        link.close()
    return 0


def listening(config: dict[str, Any]) -> Link:
    """A connection that never sends, set to passive if the interface supports it.

    :raises BusUnavailable: it cannot be opened.
    """
    if config.get("interface") == HUB_INTERFACE:
        config = {**config, "coalesce_frames": _BULK_FRAMES}
    link = open_link(config, "watch")
    listen_only(link)
    return link


def watch(link: Link, view: View, show: Callable[[], object]) -> None:
    """Take frames and show what is new, until the bus has gone.

    :raises BusLost: it has.
    """
    shown_s = time.monotonic()
    lost = 0
    try:
        while True:
            taken = 0
            while time.monotonic() - shown_s < _REDRAW_S and taken < _FRAMES_MAX:
                frames = link.receive(_WAIT_S)
                was_lost, lost = lost, link.counters["rx_lost"]
                # The place of the loss among these frames is unknown.
                view.lose(lost - was_lost)
                view.take(frames)
                view.lose(0 if lost == was_lost else None)
                taken += len(frames)
            shown_s = time.monotonic()
            show()
    except BusLost:
        show()
        raise


class View:
    """The display of the frames of a bus.

    :param lines: lines are wanted, one per simulated second.
    """

    def __init__(self, watched: RunIdentity, lines: bool = False) -> None:
        self._watched = watched
        self._wants_lines = lines
        self._lines: list[str] = []
        self._line_s = -_LINE_S
        self._said = ""
        self.lost = 0
        #: Frames of all runs.
        self.frames = 0
        self._begin()

    def _begin(self) -> None:
        scenario = self._watched.scenario
        #: None: the system is unknown.
        self.listener: Listener | None = None
        if scenario is not None:
            system = scenario.installed_system
            self.milestones = Milestones(system.contract, system.events)
            self.listener = Listener(scenario, system.contract, self.milestones)
        self._instruments = None if scenario is None else Instruments(scenario, self._watched.notes)
        #: Columns that have been received; a silent one is unknown.
        self._told: set[str] = set()

    def take(self, frames: Sequence[Frame]) -> None:
        """Frames in bus order."""
        self.frames += len(frames)
        if self._watched.take(frames):
            self._begin()
        if self.listener is None:
            return
        self.listener.take(frames)
        now_s = self.listener.now_s
        if not self._wants_lines or now_s is None:
            return
        if now_s < self._line_s:
            # Another run has begun.
            self._line_s = -_LINE_S
        if now_s - self._line_s >= _LINE_S and (line := self.line()):
            self._line_s = now_s
            self._lines.append(line + "\n")

    def lose(self, count: int | None) -> None:
        """Number of frames lost before the next ones; None: frames were lost at an unknown place among them."""
        if count == 0:
            return
        if count is not None:
            self.lost += count
            if self._wants_lines:
                self._lines.append(f"{count} FRAMES LOST HERE: what they said is not shown\n")
        if self.listener is not None:
            self.listener.note_loss()

    @property
    def heading(self) -> str:
        """Identity of the run, as sent by the plant, and the remark on it."""
        return "; ".join(filter(None, self._watched.said))

    @property
    def instant(self) -> str:
        """Simulation time of the newest frame, in words."""
        now_s = None if self.listener is None else self.listener.now_s
        return "a time that is not known" if now_s is None else f"{now_s:.2f} s"

    @property
    def _lacks(self) -> str:
        """Reason for which no values are shown."""
        if self.listener is None or self.listener.now_s is None:
            return "the time is not known yet"
        return f"{self.instant}: nothing is told of the train now"

    def values(self) -> dict[str, float]:
        """The values known now; empty while the time is unknown."""
        if self.listener is None or self._instruments is None or self.listener.now_s is None:
            return {}
        return self._instruments.values(self.listener.newest)

    def line(self) -> str:
        """Time and instruments in one line, empty before the first telegram of the truth at a known time."""
        values = self.values()
        return f"{values['time_s']:8.2f} s  {self._instruments.line(values)}" if values and self._instruments else ""

    def new_lines(self) -> list[str]:
        """The lines since the last call, one per simulated second at most."""
        found, self._lines = self._lines, []
        if self._wants_lines and self.frames and self.heading != self._said:
            self._said = self.heading
            found.insert(0, self._said + "\n")
        return found

    def picture(self) -> RenderableType:
        """The whole picture for a terminal: instruments, all columns, milestones."""
        values, listener, instruments = self.values(), self.listener, self._instruments
        run, warning = self._watched.said
        said: list[RenderableType] = [Text(run)] if run else []
        if warning:
            said.append(Text(warning, "bold yellow"))
        if self.lost:
            said.append(Text(f"{self.lost} FRAMES LOST HERE: what they said is not shown", "bold red"))
        scenario = self._watched.scenario
        title = "railhil watch" if scenario is None else scenario.title
        if listener is None or instruments is None or not values:
            heard = "no run on the bus yet" if not self.frames else f"{count_of(self.frames, 'frame')}, {self._lacks}"
            return Panel(Group(*said, Text(heard)), title=title)
        assert scenario is not None
        rate = f", {listener.clock.rate:g} times real time" if listener.clock.rate else ""
        planned = "" if isnan(scenario.planned_s) else f" of {scenario.planned_s:.0f}"
        grid = table("signal", whole("value"), "signal", whole("value"), tight=True)
        cells = []
        self._told |= values.keys()
        for column in instruments.shown.columns:
            value = values.get(column.name)
            if value is not None:
                style = "bold red" if column.kind == LEVEL and value > 0 else ""
                cells.append((Text(column.label), Text(instruments.describe(column, value), style)))
            elif column.name in self._told:
                cells.append((Text(column.label), Text("silent")))
        half = -(-len(cells) // 2)
        for row, left in enumerate(cells[:half]):
            grid.add_row(*left, *(cells[half + row] if half + row < len(cells) else ("", "")))
        lines: list[RenderableType] = [
            Text(f"{listener.now_s:.2f}{planned} s{rate}, {count_of(self.frames, 'frame')}"),
            *said,
            Text(instruments.line(values), "bold"),
        ]
        happened = [f"{event.time_s:.2f} s {event.cause.replace('_', ' ')}" for event in self.milestones.newest]
        return Panel(Group(*lines, grid, Text("; ".join(happened), "dim")), title=title)
