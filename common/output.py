"""The console of the commands: prints text without markup and survives a closed pipe."""

from __future__ import annotations

import argparse
import io
import json
import os
import sys
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from railhil.common.plain_text import plain

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


def add_json_argument(parser: argparse.ArgumentParser) -> None:
    """The same option on every command that has a result."""
    parser.add_argument(
        "--json", action="store_true", help="print the result as one JSON document, all else to standard error"
    )


def print_json(document: object) -> None:
    """Print a JSON document (ASCII, no NaN) and nothing else to standard output."""
    text = json.dumps(document, indent=2, allow_nan=False)
    try:
        print(text, flush=True)
    except BrokenPipeError:
        discard_output()


def flush_output() -> None:
    """Flush buffered output, so that nothing can fail later when the process ends."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        discard_output()


def discard_output() -> None:
    """Discard standard output."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)


def accept_any_text() -> None:
    """Print a question mark for a character that the terminal's encoding does not have."""
    streams: tuple[Any, ...] = (sys.stdout, sys.stderr)
    for stream in streams:
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
