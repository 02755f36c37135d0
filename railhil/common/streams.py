"""Standard output and error of the commands, for text that needs no library; the libraries of tables and styles are
loaded later (:mod:`railhil.common.output`).
"""

from __future__ import annotations

import errno
import io
import json
import os
import re
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    # Loaded only after a command listens to Ctrl-C.
    import argparse

#: Control characters except line feed and tab, line and paragraph separators, invisible marks (direction, width,
#: annotation, language), surrogates and noncharacters. Joiners and the soft hyphen count as text.
_UNSAFE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ufffe\uffff"
    "\ud800-\udfff\U000e0001-\U000e007f]"
)


def escape_controls(text: str) -> str:
    r"""The text with such characters escaped: ``\x1b`` for the character that begins an escape sequence."""
    return text if text.isprintable() else _UNSAFE.sub(_written_out, text)


def one_line(text: str) -> str:
    """The text in one line, without the control characters that XML cannot represent."""
    return escape_controls(" ".join(text.split()))


def _written_out(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def say(text: str, stderr: bool = False) -> None:
    """Print one line as :meth:`railhil.common.output.Output.say` does without a style."""
    try:
        print(escape_controls(text), file=sys.stderr if stderr else sys.stdout, flush=True)
    except BrokenPipeError:
        discard_output()


def announce(line: str) -> None:
    """Print a line of a service, whose work is not what it prints: it goes on with standard output closed (``>&-``) or
    without a reader.

    :raises OSError: the output cannot be written for another reason, such as a full disk.
    """
    try:
        print(escape_controls(line), flush=True)
    except OSError as error:
        if error.errno not in (errno.EPIPE, errno.EBADF):
            raise
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
    """Flush buffered output, so that no write can fail later when the process ends."""
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
