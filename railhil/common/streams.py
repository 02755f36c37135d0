"""Standard output and error of the commands, for text that needs no library: those of tables and styles are loaded
later (:mod:`railhil.common.output`)."""

from __future__ import annotations

import argparse
import io
import json
import os
import sys
from typing import Any

from railhil.common.plain_text import plain


def say(text: str, stderr: bool = False) -> None:
    """Print one line as :meth:`railhil.common.output.Output.say` does without a style."""
    try:
        print(plain(text), file=sys.stderr if stderr else sys.stdout, flush=True)
    except BrokenPipeError:
        discard_output()


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
