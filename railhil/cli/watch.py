"""``railhil watch``: a run on a bus in the terminal, for those without a browser. It listens only."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.live import Live
from rich.panel import Panel
from rich.text import Text

from railhil.bus.can_settings import HUB_INTERFACE, add_bus_arguments
from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame
from railhil.bus.link import Link, open_link
from railhil.bus.link.passive import be_passive
from railhil.bus.select import choose_bus
from railhil.common.choices import USUAL_SCENARIO
from railhil.common.output import Output, table
from railhil.controller_node.telemetry_file import law_notes
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.settings import add_fault_argument, add_set_argument
from railhil.scenarios.system import system_named
from railhil.supervisor.follow import Follower
from railhil.supervisor.now import Instruments
from railhil.supervisor.shown import LEVEL

#: Wall time between two pictures, and simulated time between two lines where there is no terminal.
_REDRAW_S, _LINE_S = 0.25, 1.0
#: How long one look at the bus waits, and how many frames are taken between two pictures.
_WAIT_S, _FRAMES_MAX = 0.05, 20_000
#: Frames that the hub hands over together.
_BULK_FRAMES = 256


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "watch",
        description="Shows what is on the bus until Ctrl-C, or until the hub has gone. Into a file or pipe it writes "
        "one line per simulated second.",
    )
    parser.add_argument(
        "scenario", nargs="?", default=USUAL_SCENARIO, help=f"what runs there (default {USUAL_SCENARIO})"
    )
    parser.add_argument("--controller", metavar="LAW", help="the law that runs, whose notes are then named")
    add_set_argument(parser)
    add_fault_argument(parser)
    add_bus_arguments(parser)
    parser.set_defaults(work=work)


def work(namespace: argparse.Namespace) -> int:
    """Watch the bus.

    :raises InputError: no such scenario, law, or interface.
    :raises BusUnavailable: the bus cannot be opened.
    """
    scenario = load_any(namespace.scenario, namespace.set, namespace.fault)
    notes = law_notes(system_named(scenario.system), namespace.controller)
    choice = choose_bus(namespace)
    console = Output()
    link = listening(choice.config)
    console.say(f"bus: {choice.transport} ({choice.reason}), listening only")
    view = View(scenario, notes, lines=not console.is_terminal)
    try:
        if console.is_terminal:
            with Live(view.picture(), console=console, auto_refresh=False, transient=False) as live:
                watch(link, view, lambda: live.update(view.picture(), refresh=True))
        else:
            watch(link, view, lambda: console.print("".join(view.new_lines()), end="", soft_wrap=True))
    except BusLost:
        console.say(f"the bus has gone at {view.follower.now_s:.2f} s, after {view.follower.frames} frames")
    finally:
        link.close()
    return 0


def listening(config: dict[str, Any]) -> Link:
    """A connection that never sends, told to be passive where the interface knows that.

    :raises BusUnavailable: it cannot be opened.
    """
    if config.get("interface") == HUB_INTERFACE:
        config = {**config, "coalesce_frames": _BULK_FRAMES}
    link = open_link(config, "watch")
    be_passive(link)
    return link


def watch(link: Link, view: View, show: Callable[[], object]) -> None:
    """Take frames and show what is new, until the bus has gone.

    :raises BusLost: it has.
    """
    shown_s = time.monotonic()
    try:
        while True:
            taken = 0
            while time.monotonic() - shown_s < _REDRAW_S and taken < _FRAMES_MAX:
                frames = link.receive(_WAIT_S)
                view.take(frames)
                taken += len(frames)
            shown_s = time.monotonic()
            show()
    except BusLost:
        show()
        raise


class View:
    """What is shown of the frames of a bus.

    :param notes: the law's declaration of its notes; None: not known.
    :param lines: lines are wanted, one per simulated second.
    """

    def __init__(
        self, scenario: AnyScenario, notes: Sequence[Mapping[str, Any]] | None = None, lines: bool = False
    ) -> None:
        self._scenario = scenario
        self._instruments = Instruments(scenario, notes)
        self.follower = Follower(scenario)
        self._wants_lines = lines
        self._lines: list[str] = []
        self._line_s = -_LINE_S

    def take(self, frames: Sequence[Frame]) -> None:
        """Frames in bus order."""
        self.follower.take(frames)
        now_s = self.follower.now_s
        if now_s < self._line_s:
            # Another run has begun.
            self._line_s = -_LINE_S
        if self._wants_lines and now_s - self._line_s >= _LINE_S and (line := self.line()):
            self._line_s = now_s
            self._lines.append(line + "\n")

    def line(self) -> str:
        """Time and instruments in one line, empty before the first telegram of the truth."""
        values = self._instruments.values(self.follower.newest)
        return f"{values['time_s']:8.2f} s  {self._instruments.line(values)}" if values else ""

    def new_lines(self) -> list[str]:
        """The lines since the last call, one per simulated second at most."""
        found, self._lines = self._lines, []
        return found

    def picture(self) -> RenderableType:
        """Everything for a terminal: instruments, all columns, milestones."""
        values, follower = self._instruments.values(self.follower.newest), self.follower
        rate = f", {follower.clock.rate:g} times real time" if follower.clock.rate else ""
        head = f"{follower.now_s:.2f} of {self._scenario.planned_s:.0f} s{rate}, {follower.frames} frames"
        if not values:
            return Panel(Text(f"{head}: no run on the bus yet"), title=self._scenario.title)
        grid = table(tight=True)
        for heading in ("signal", "value", "signal", "value"):
            grid.add_column(heading, no_wrap=True)
        cells = []
        for column in self._instruments.shown.columns:
            if column.name in values:
                value = values[column.name]
                style = "bold red" if column.kind == LEVEL and value > 0 else ""
                cells.append((Text(column.label), Text(self._instruments.said(column, value), style)))
        half = -(-len(cells) // 2)
        for row, left in enumerate(cells[:half]):
            grid.add_row(*left, *(cells[half + row] if half + row < len(cells) else ("", "")))
        lines: list[RenderableType] = [Text(head), Text(self._instruments.line(values), "bold")]
        if follower.other_scenario:
            lines.append(
                Text(
                    "the plant runs another scenario: name it, with its --set and --fault, on the command line",
                    "bold yellow",
                )
            )
        happened = [f"{event.time_s:.2f} s {event.cause.replace('_', ' ')}" for event in follower.milestones]
        return Panel(Group(*lines, grid, Text("; ".join(happened), "dim")), title=self._scenario.title)
