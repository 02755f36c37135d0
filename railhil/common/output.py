"""The console of the commands: prints text without markup and survives a closed pipe."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from time import monotonic
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Column, Table
from rich.text import Text

from railhil.common.streams import discard_output, escape_controls

#: Width of output into a file or pipe unless COLUMNS is set.
_FILE_COLUMNS = 100
#: Longest word that a column keeps together, in letters; a longer one is a name, which may be folded.
_WORD_LETTERS = 5
#: A word that counts as a number, with sign, brackets and unit around it; a longer one is a hash.
_NUMBER = re.compile(r"[^\w\s]*\d\S{0,29}")
#: Maximum updates of a progress bar per second.
_REFRESH_HZ = 4
#: Width of a console that cuts nothing.
_UNLIMITED = 10_000


class Output(Console):
    """Prints text unchanged: names and paths of users may contain brackets and colons.

    A closed pipe (``railhil run | head``) must neither stop a run nor change its exit code.
    """

    def __init__(self, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, markup=False, emoji=False, highlight=False)
        if not self.is_terminal and not os.environ.get("COLUMNS", "").isdigit():
            self.width = _FILE_COLUMNS

    def render_str(self, text: str, **options: Any) -> Text:
        """Called by rich for every text and every table cell before it is printed."""
        return super().render_str(escape_controls(text), **options)

    def on_broken_pipe(self) -> None:
        """Print nothing from here on; rich would end the process with exit code 1, which means FAIL."""
        self.quiet = True
        discard_output()

    def print(self, *objects: Any, **options: Any) -> None:
        """As rich, but a line that is longer than the console is not cut."""
        super().print(*objects, **{"crop": False, **options})

    def say(self, text: str, style: str | None = None) -> None:
        """Print one line of any length."""
        self.print(text, style=style, soft_wrap=True)

    def show(self, results: Iterable[str | Text | Table]) -> None:
        """Print lines of any length, and tables."""
        for one in results:
            self.print(one, soft_wrap=not isinstance(one, Table))


def styled(text: str, style: str) -> Text:
    """A line with a style, for :meth:`Output.show`."""
    return Text(escape_controls(text), style)


class WholeTable(Table):
    """A table that breaks and cuts no number: where the console is too narrow, words are wrapped, and if that is not
    enough, lines are longer than the console."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        for column in self.columns:
            if not column.no_wrap and column.overflow == "ellipsis":
                column.overflow = "fold"
            column.min_width = max(column.min_width or 0, _least_width(console, options, column))
        least = Measurement.get(console, options.update(width=_UNLIMITED), self).minimum
        return super().__rich_console__(console, options.update(width=max(options.max_width, least)))


def _least_width(console: Console, options: ConsoleOptions, column: Column) -> int:
    """Room for every cell where nothing is wrapped, else for every number and the beginning of a word."""
    cells = [column.header, *column.cells]
    if column.no_wrap:
        return max(Measurement.get(console, options.update(width=_UNLIMITED), cell).maximum for cell in cells)
    words = [word for cell in cells for word in str(cell).split()]
    least = max((min(len(word), _WORD_LETTERS) for word in words), default=1)
    numbers = [len(word) for word in words if _NUMBER.fullmatch(word)]
    return max(least, *numbers, 1)


def whole(name: str) -> Column:
    """A column of words that are never wrapped, for :func:`table`."""
    return Column(name, no_wrap=True)


def number(name: str) -> Column:
    """A column of numbers that are never wrapped, for :func:`table`."""
    return Column(name, justify="right", no_wrap=True)


def table(*columns: str | Column, rows: Iterable[Iterable[str]] = (), tight: bool = False) -> Table:
    """A table with two spaces between its columns, one if ``tight``."""
    padding = (0, 0 if tight else 1, 0, 0)
    made = WholeTable(*columns, box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=padding)
    for row in rows:
        made.add_row(*row)
    return made


def titled_table(
    title: str,
    left: Sequence[str],
    right: Sequence[str],
    rows: Iterable[Iterable[str]] = (),
    *,
    is_whole: bool = True,
) -> Table:
    """A table with a title: columns of words, and then of numbers.

    :param is_whole: no column is wrapped, and they stand closer together; else only the first is never wrapped.
    """
    columns = [Column(name) for name in left] + [Column(name, justify="right") for name in right]
    for place, column in enumerate(columns):
        column.no_wrap = is_whole or place == 0
    made = table(*columns, rows=rows, tight=is_whole)
    made.title, made.title_justify, made.title_style = title, "left", "bold"
    # Keeps the title of a narrow table on one line.
    made.min_width = len(title)
    return made


@contextmanager
def show_progress(console: Console, title: str, total: int, done: int = 0) -> Iterator[Callable[[int, str], None]]:
    """A progress bar on a terminal, nothing elsewhere; called with how much of the total is done, and a title."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    is_hidden, shown_s = not console.is_terminal, 0.0
    # No thread refreshes it: processes can be forked beside it.
    with Progress(*columns, console=console, transient=True, disable=is_hidden, auto_refresh=False) as bar:
        task = bar.add_task(title, total=total, completed=done)

        def show(completed: int, said: str) -> None:
            nonlocal shown_s
            bar.update(task, completed=completed, description=said)
            if monotonic() - shown_s > 1 / _REFRESH_HZ:
                shown_s = monotonic()
                bar.refresh()

        yield show
