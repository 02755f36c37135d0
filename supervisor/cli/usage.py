"""The argument parser of every ``railhil`` command: one line for a usage error, exit codes in each help."""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

EXIT_CODES = """\
exit codes:
  0    PASS, or the command has done what was asked
  1    FAIL: the run is good, limits of the scenario are missed
  2    usage or bad input; one line says what was found and what is allowed
  3    INVALID: the bench cannot be trusted, nothing is said about the controller
  4    TOOL ERROR: a defect of the bench, or the record could not be written
  130  stopped by Ctrl-C; 143 by SIGTERM (the log is kept, the run is marked INVALID)"""


class OneLineParser(argparse.ArgumentParser):
    """:class:`argparse.ArgumentParser` whose complaint is one line instead of the whole usage."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        kwargs.setdefault("epilog", EXIT_CODES)
        kwargs.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        super().__init__(*args, **kwargs)

    def error(self, message: str) -> NoReturn:
        """Print one line and end with exit code 2."""
        print(f"{self.prog}: {' '.join(message.split())} (see {self.prog} --help)", file=sys.stderr)
        raise SystemExit(2)


def parse(parser: argparse.ArgumentParser, arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Parsed command line. python-can prints a ``--timing`` that it has understood: that goes to standard error,
    where it does not spoil ``--json``."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            namespace = parser.parse_args(arguments)
    except SystemExit:
        print(said.getvalue(), end="")
        raise
    print(said.getvalue(), end="", file=sys.stderr)
    return namespace
