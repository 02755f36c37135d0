"""The console of the commands: prints text without markup and survives a closed pipe."""

from __future__ import annotations

import os
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from railhil.common.plain_text import plain
from railhil.common.streams import discard_output

#: Width of output into a file or pipe unless COLUMNS is set.
_FILE_COLUMNS = 100


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
        return super().render_str(plain(text), **options)

    def on_broken_pipe(self) -> None:
        """Print nothing from here on; rich would end the process with exit code 1, which means FAIL."""
        self.quiet = True
        discard_output()

    def say(self, text: str, style: str | None = None) -> None:
        """Print one line, however long."""
        self.print(text, style=style, soft_wrap=True)


def table(tight: bool = False) -> Table:
    """An empty table with two spaces between its columns, one if ``tight``."""
    return Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 0 if tight else 1, 0, 0))
