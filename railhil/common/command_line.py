"""The argument parser of every ``railhil`` command: one line for a usage error, exit codes in each help."""

from __future__ import annotations

import argparse
import contextlib
import difflib
import io
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from railhil.common.choices import ARITHMETICS, INDEXINGS, PACES
from railhil.common.patience import APPEAR_S, PATIENCE_S
from railhil.common.plain_text import plain
from railhil.common.scheduling import PRIORITY_MAX

#: Seeds travel as 32 bit in the handshake.
SEED_MAX = 0xFFFF_FFFF
#: Numbers of runs are reported in 16 bit.
RUN_NUMBER_MAX = 0xFFFF
#: Below this rate ticks are so rare that a dead bench cannot be told from a slow one.
RATE_MIN, RATE_MAX = 0.01, 1000.0
#: Rate of a real-time run started without ``--rate``.
RATE = 1.0
APPEAR_MAX_S = 3600.0
TASK_PERIOD_MAX_MS = 10_000
#: Longest number accepted on the command line, in digits.
_DIGITS_MAX = 20
#: Longer words of the command line are truncated in messages.
_WORD_MAX = 200
EXIT_CODES = """\
exit codes:
  0    PASS, or the command has done what was asked
  1    FAIL: the run is valid, limits of the scenario are missed
  2    usage or bad input; one line says what was found and what is allowed
  3    INVALID: the run is not trustworthy and says nothing about the controller
  4    TOOL ERROR: a defect of the bench, or the record could not be written
  130  stopped by Ctrl-C; 143 by SIGTERM, 129 by SIGHUP (the log is kept, the run is marked INVALID)"""


class OneLineParser(argparse.ArgumentParser):
    """:class:`argparse.ArgumentParser` that reports an error in one line instead of the whole usage."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        kwargs.setdefault("epilog", EXIT_CODES)
        kwargs.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        super().__init__(*args, **kwargs)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> tuple[Any, list[str]]:
        """As in argparse, but a subcommand reports unknown arguments itself instead of passing them up to its parent
        parser, whose help would be the wrong one to read."""
        known, unknown = super().parse_known_args(args, namespace)
        if unknown:
            near = difflib.get_close_matches(unknown[0].partition("=")[0], self._option_string_actions, 1)
            hint = f", did you mean {near[0]}?" if near else ""
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
        return known, unknown

    def error(self, message: str) -> NoReturn:
        """Print one line and end with exit code 2."""
        words = (word if len(word) <= _WORD_MAX else f"{word[:_WORD_MAX]}..." for word in message.split())
        print(plain(f"{self.prog}: {' '.join(words)} (see {self.prog} --help)"), file=sys.stderr)
        raise SystemExit(2)


def parse(parser: argparse.ArgumentParser, arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Parsed command line. python-can prints the parsed ``--timing``; this output goes to standard error, so that it
    does not corrupt ``--json``. Options of a real-time run are refused in any other run, if the command line alone
    decides the pace."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            namespace = parser.parse_args(arguments)
    except SystemExit:
        print(said.getvalue(), end="")
        raise
    print(said.getvalue(), end="", file=sys.stderr)
    if getattr(namespace, "pace", "realtime") != "realtime":
        for option, is_given in (
            ("--rate", getattr(namespace, "rate", None) is not None),
            ("--no-rt", getattr(namespace, "no_rt", False)),
        ):
            if is_given:
                parser.error(f"argument {option}: allowed only with --pace realtime")
    return namespace


def whole_number(low: int, high: int) -> Callable[[str], int]:
    """An option's type: a whole number from ``low`` (0 or more) to ``high``, in ASCII digits."""

    def number(text: str) -> int:
        # Python refuses to convert thousands of digits.
        is_number = text.isascii() and text.isdigit() and len(text.lstrip("0")) <= len(str(high))
        if not is_number or not low <= int(text[-_DIGITS_MAX:]) <= high:
            raise argparse.ArgumentTypeError(f"found {text}, allowed {low}..{high}")
        return int(text[-_DIGITS_MAX:])

    return number


def _rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = float("nan")
    if not RATE_MIN <= rate <= RATE_MAX:
        raise argparse.ArgumentTypeError(f"found {text}, allowed {RATE_MIN:g} to {RATE_MAX:g}")
    return rate


def seconds(text: str) -> float:
    """An option's type: wall time to wait for another node."""
    try:
        found = float(text)
    except ValueError:
        found = float("nan")
    if not 0 < found <= APPEAR_MAX_S:
        raise argparse.ArgumentTypeError(f"found {text}, allowed above 0, at most {APPEAR_MAX_S:g} s")
    return found


def add_patience_argument(parser: argparse.ArgumentParser, awaited: str) -> None:
    """Option of every node that waits for another in lockstep.

    :param awaited: what the node waits for, for the help text.
    """
    parser.add_argument(
        "--patience",
        type=seconds,
        default=PATIENCE_S,
        metavar="S",
        help=f"lockstep: wall time for {awaited} when nobody says that its node has ended (default {PATIENCE_S:g} s)",
    )


def add_lifeline_argument(parser: argparse.ArgumentParser) -> None:
    """Option of the plant, for the command that starts all nodes: see :class:`railhil.common.patience.Lifelines`."""
    parser.add_argument("--lifeline", type=_lifeline, action="append", default=[], help=argparse.SUPPRESS)


def add_sent_argument(parser: argparse.ArgumentParser) -> None:
    """Option of plant and controller, for the command that starts all nodes: where to write what the node has sent."""
    parser.add_argument("--sent-file", type=Path, help=argparse.SUPPRESS)


def _lifeline(text: str) -> tuple[str, int]:
    node, _, descriptor = text.partition("=")
    try:
        os.fstat(int(descriptor))
    except (ValueError, OverflowError, OSError):
        raise argparse.ArgumentTypeError(f"found {text}, allowed NODE=DESCRIPTOR of an open file") from None
    return node, int(descriptor)


def add_law_arguments(parser: argparse.ArgumentParser) -> None:
    """Options that say how a law is run: the same for the controller node and for the command that starts it."""
    parser.add_argument("--arithmetic", choices=sorted(ARITHMETICS), help="(default: that of the scenario's system)")
    add_indexing_argument(parser)
    parser.add_argument(
        "--task-period-ms",
        type=whole_number(0, TASK_PERIOD_MAX_MS),
        default=0,
        metavar="N",
        help="the controller reads its mailboxes every N ms of simulation time only (default 0: each frame at once)",
    )


def add_indexing_argument(parser: argparse.ArgumentParser) -> None:
    """Option of every command that makes a law."""
    parser.add_argument("--indexing", choices=INDEXINGS, default="time", help="set-point indexing (default time)")


def add_priority_argument(parser: argparse.ArgumentParser, default: int | None, said: str) -> None:
    """Option of every node of a real-time run.

    :param said: the help text on the default.
    """
    parser.add_argument(
        "--realtime-priority",
        type=whole_number(0, PRIORITY_MAX),
        default=default,
        metavar="N",
        help=f"SCHED_FIFO priority and locked memory, if permitted; 0: normal scheduling ({said})",
    )


def add_run_arguments(parser: argparse.ArgumentParser) -> None:
    """Options that identify the run: the same for the plant node and for the supervisor."""
    parser.add_argument("scenario", nargs="?", default="lvshun_tieshan", help="shipped name or TOML file")
    parser.add_argument("--seed", type=whole_number(0, SEED_MAX), default=0, help="random seed of the run (default 0)")
    parser.add_argument("--perturbed", action="store_true", help="draw parameters from the scenario's distributions")
    parser.add_argument(
        "--run-number",
        type=whole_number(1, RUN_NUMBER_MAX),
        default=1,
        metavar="N",
        help="number of the run in the sequence of its seed, for systems that learn from run to run (default 1)",
    )
    parser.add_argument(
        "--pace",
        choices=PACES,
        default="lockstep",
        help="as fast as the nodes answer, or by the clock (default lockstep)",
    )
    parser.add_argument(
        "--appear-timeout",
        type=seconds,
        default=APPEAR_S,
        metavar="S",
        help=f"wall time for the other nodes to appear (default {APPEAR_S:g} s)",
    )
    add_patience_argument(parser, "an answer")
    parser.add_argument("--rate", type=_rate, help=f"realtime: simulated seconds per second (default {RATE:g})")
