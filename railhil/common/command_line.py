"""The argument parser of every ``railhil`` command: one line for a usage error, exit codes in each help, allowed values
of the options of running a law."""

from __future__ import annotations

import argparse
import contextlib
import difflib
import io
import math
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from shutil import get_terminal_size
from typing import Any, NoReturn

from railhil.common.errors import did_you_mean
from railhil.common.scheduling import PRIORITY_MAX
from railhil.common.streams import accept_any_text, escape_controls, flush_output

#: The order of these values gives their codes in the handshake: new ones come last.
ARITHMETICS = ("float64", "float32", "iq", "iq-portable", "float32-truncated")
#: Index of the set-points of a law.
INDEXINGS = ("time", "distance")
PACES = ("lockstep", "realtime")
#: Bus of a run: chosen by python-can's options, its configuration and the machine, or none at all.
BUSES = ("auto", "local")
#: Default scenario and law of a run.
USUAL_SCENARIO, USUAL_LAW = "lvshun_tieshan", "ipfc"
#: The shipped law that knows the train's position: for first runs, and as advice where another one misses the stop.
LAW_WITH_POSITION = "ipfc_plus"


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
#: argparse's words on a value that is none of the choices.
_CHOICE = re.compile(r"invalid choice: (.*) \(choose from (.*)\)$")
_SEED_RANGE = re.compile(r"0*([0-9]{1,10})(?:\s*-\s*0*([0-9]{1,10}))?", re.ASCII)
#: Longer words of the command line are truncated in messages.
_WORD_MAX = 200
#: Number of values of a positional argument -> its words in the usage.
_ARITY: Mapping[int | str | None, str] = {
    "?": "[{}]",
    "*": "[{} ...]",
    "+": "{0} [{0} ...]",
    argparse.PARSER: "{} ...",
    argparse.REMAINDER: "...",
}
#: Options and positional arguments for the same thing, of which a command has one.
_SAME_THING = (("--controller", "--laws", "--law", "law"), ("--scenario", "scenario"))
EXIT_CODES = """\
exit codes:
  0    PASS, or the command has done what was asked
  1    FAIL: the run is valid, limits of the scenario are missed
  2    usage or bad input; one line says what was found and what is allowed
  3    INVALID: the run is not trustworthy and says nothing about the controller
  4    TOOL ERROR: a defect of the bench, or the record could not be written
  130  stopped by Ctrl-C; 143 by SIGTERM, 129 by SIGHUP (the log is kept, the run is marked INVALID)"""


def _path(text: str) -> Path:
    """The type of every option that takes a path: an empty text would be the working folder."""
    if not text:
        raise argparse.ArgumentTypeError("found '', allowed a path")
    return Path(text)


class OneLineParser(argparse.ArgumentParser):
    """:class:`argparse.ArgumentParser` that reports an error in one line instead of the whole usage. Its help begins
    with a short usage, and ends with examples and exit codes.

    :param examples: command lines, as a user types them.
    :param sections: title of a part of the help -> the options that stand there; all others stand before them.
    :param remark: makes a text after the examples for a help of this many columns; called only when a help is shown.
    """

    def __init__(
        self,
        *args: Any,
        examples: Sequence[str] = (),
        sections: Mapping[str, Sequence[str]] | None = None,
        remark: Callable[[int], str] | None = None,
        **kwargs: Any,
    ) -> None:
        kwargs.setdefault("epilog", EXIT_CODES)
        kwargs.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        # The parser adds an option of its own, --help.
        self._section_of: dict[str, argparse._ArgumentGroup] = {}
        super().__init__(*args, **kwargs)
        self.register("type", Path, _path)
        self.examples, self._remark = tuple(examples), remark
        for title, options in (sections or {}).items():
            self._section_of |= dict.fromkeys(options, self.add_argument_group(title))

    def add_argument(self, *names: Any, **given: Any) -> argparse.Action:
        """As in argparse, in the section of the option."""
        section = next((self._section_of[name] for name in names if name in self._section_of), None)
        return super().add_argument(*names, **given) if section is None else section.add_argument(*names, **given)

    def format_help(self) -> str:
        """The help. Each option stands in it once: the usage only names what must be given."""
        self.usage = self.usage or self._short_usage()
        own, examples = self.epilog, [f"  {line}" for line in self._shown_examples()]
        said = [self._remark(get_terminal_size().columns), ""] if self._remark else []
        self.epilog = "\n".join([*(["examples:", *examples, ""] if examples else []), *said, own or ""])
        try:
            return super().format_help()
        finally:
            self.epilog = own

    def _shown_examples(self) -> list[str]:
        """Its own examples, or those of the subcommands that its help shows."""
        shown = [action for action in self._actions if action.help is not argparse.SUPPRESS]
        below = [action for action in shown if isinstance(action, argparse._SubParsersAction)]
        inner = [parser for action in below for parser in action.choices.values() if isinstance(parser, OneLineParser)]
        return list(self.examples) or [line for parser in inner for line in parser.examples]

    def _short_usage(self) -> str:
        words = [self.prog]
        for action in self._actions:
            name = action.metavar if isinstance(action.metavar, str) else action.dest.upper()
            if not action.option_strings:
                words.append(_ARITY.get(action.nargs, "{}").format(name))
            elif action.required:
                words.append(f"{action.option_strings[-1]} {name}")
        return " ".join([*words, "[options]"])

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> tuple[Any, list[str]]:
        """As in argparse, but a subcommand reports unknown arguments itself instead of passing them up to its parent
        parser, whose help would be the wrong one to read. An option by two names must have one value."""
        known, unknown = super().parse_known_args(args, namespace)
        if unknown:
            meant = self._meant(unknown[0].partition("=")[0])
            hint = f", did you mean {meant}?" if meant else ""
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
        for action in self._actions:
            if isinstance(action, _FormerName):
                action.settle(self, known)
        return known, unknown

    def _meant(self, word: str) -> str | None:
        """What the command calls the thing that a word, which it does not know, stands for."""
        if not word.startswith("-"):
            return None
        for action in self._actions:
            names = action.option_strings or [action.dest]
            if any(word in same and names[-1] in same for same in _SAME_THING):
                return names[-1] if action.option_strings else f"{action.metavar}, without {word}"
        near = difflib.get_close_matches(word, self._option_string_actions, 1)
        if not near:
            return None
        action = self._option_string_actions[near[0]]
        return action.name if isinstance(action, _FormerName) else near[0]

    def error(self, message: str) -> NoReturn:
        """Print one line and end with exit code 2. If a subcommand or another choice is missing, the line names all."""
        missing = message.partition("arguments are required: ")[2].split(", ")[0]
        for action in self._actions:
            if action.choices and not action.option_strings and action.metavar == missing:
                message = f"{missing} is missing: one of {', '.join(map(str, action.choices))}"
        if found := _CHOICE.search(message):
            word, names = found[1].strip("'"), [name.strip("'") for name in found[2].split(", ")]
            hint = did_you_mean(word, names)
            allowed = f"found {word}, allowed {', '.join(names)}{f' ({hint})' if hint else ''}"
            message = f"{message[: found.start()]}{allowed}"
        words = (word if len(word) <= _WORD_MAX else f"{word[:_WORD_MAX]}..." for word in message.split())
        print(escape_controls(f"{self.prog}: {' '.join(words)} (see {self.prog} --help)"), file=sys.stderr)
        raise SystemExit(2)


class _FormerName(argparse.Action):
    """An option by its former name, which the help does not show.

    Either name leaves its value only if it is given; :meth:`settle` puts the one value in its place.
    """

    def __init__(self, *args: Any, now: argparse.Action, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._now, self._usual = now, now.default
        self.name = now.option_strings[-1]
        now.default = argparse.SUPPRESS

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        print(f"{parser.prog}: {option} is called {self.name} now; a later version will not know it", file=sys.stderr)
        setattr(namespace, self.dest, values)

    def settle(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace) -> None:
        """Set the option from the name that was given, or to its default; other values by both are an error."""
        given = [getattr(namespace, dest) for dest in (self._now.dest, self.dest) if hasattr(namespace, dest)]
        if len(given) > 1 and given[0] != given[1]:
            former = self.option_strings[-1]
            parser.error(
                f"argument {former}: found {given[1]}, allowed {given[0]}, that of {self.name}, or only one of them"
            )
        setattr(namespace, self._now.dest, given[0] if given else self._usual)
        if hasattr(namespace, self.dest):
            delattr(namespace, self.dest)


def accept_former_name(parser: argparse.ArgumentParser, former: str, name: str) -> None:
    """Accept an option by its former name, too, with a line that says so.

    :param name: of the option now, which the parser has.
    """
    now = next(action for action in parser._actions if name in action.option_strings)
    same: dict[str, Any] = {"nargs": now.nargs, "type": now.type}
    hidden, dest = argparse.SUPPRESS, f"former_{now.dest}"
    parser.add_argument(former, action=_FormerName, now=now, dest=dest, default=hidden, help=hidden, **same)


def parse(parser: argparse.ArgumentParser, arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Parsed command line. python-can prints the parsed ``--timing``; this output goes to standard error, so that it
    does not corrupt ``--json``. Options of a real-time run are refused in any other run, if the command line alone
    decides the pace."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            namespace = parser.parse_args(arguments)
    except SystemExit:
        print(said.getvalue(), end="", flush=True)
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


def run_command(
    parser: argparse.ArgumentParser, words: Sequence[str] | None, work: Callable[[argparse.Namespace], int]
) -> int:
    """Parse the words of a command and do its work; returns the exit code.

    :param words: None: those of this process.
    """
    accept_any_text()
    namespace = parse(parser, words)
    try:
        return work(namespace)
    finally:
        flush_output()


def whole_number(low: int, high: int) -> Callable[[str], int]:
    """An option's type: a whole number from ``low`` (0 or more) to ``high``, in ASCII digits."""

    def number(text: str) -> int:
        # Python refuses to convert thousands of digits.
        is_number = text.isascii() and text.isdigit() and len(text.lstrip("0")) <= len(str(high))
        if not is_number or not low <= int(text[-_DIGITS_MAX:]) <= high:
            raise argparse.ArgumentTypeError(f"found {text}, allowed {low}..{high}")
        return int(text[-_DIGITS_MAX:])

    return number


def name_list(text: str) -> tuple[str, ...]:
    """An option's type: names with commas between them."""
    return tuple(name.strip() for name in text.split(","))


def seed_list(text: str, most: int) -> list[int]:
    """Seeds and ranges of seeds such as ``0-7,20``, in the order of the text; for an option's type. Blanks beside
    numbers and leading zeros are allowed.

    :param most: how many seeds are allowed.
    :raises argparse.ArgumentTypeError: another text, or more seeds.
    """
    seeds: list[int] = []
    for part in text.split(","):
        match = _SEED_RANGE.fullmatch(part.strip())
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
        if not first <= last <= SEED_MAX or len(seeds) + last - first >= most:
            allowed = f"seeds and ranges like 0-7,20 from 0 to {SEED_MAX}, at most {most}"
            raise argparse.ArgumentTypeError(f"found {text}, allowed {allowed}")
        seeds += range(first, last + 1)
    return seeds


def number(is_allowed: Callable[[float], bool], allowed: str) -> Callable[[str], float]:
    """An option's type: a number that is allowed; ``allowed`` says which ones are."""

    def parse_number(text: str) -> float:
        try:
            found = float(text)
        except ValueError:
            found = math.nan
        if not is_allowed(found):
            raise argparse.ArgumentTypeError(f"found {text}, allowed {allowed}")
        return found

    return parse_number


#: An option's type: simulated seconds per second.
rate = number(lambda value: RATE_MIN <= value <= RATE_MAX, f"{RATE_MIN:g} to {RATE_MAX:g}")
#: An option's type: wall time to wait for another node.
seconds = number(lambda value: 0 < value <= APPEAR_MAX_S, f"above 0, at most {APPEAR_MAX_S:g} s")


def add_priority_argument(parser: argparse.ArgumentParser, default: int | None, said: str) -> None:
    """Option of every node of a real-time run.

    :param said: help text on the default.
    """
    parser.add_argument(
        "--realtime-priority",
        type=whole_number(0, PRIORITY_MAX),
        default=default,
        metavar="N",
        help=f"SCHED_FIFO priority and locked memory, if permitted; 0: normal scheduling (default: {said})",
    )
