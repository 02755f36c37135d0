"""Pages of the site that are made from railhil itself: commands from their parsers, keys of scenarios from their
schemas, the library from its docstrings."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Mapping
from inspect import isfunction
from types import ModuleType
from typing import Any

import railhil
import railhil.testing
from railhil import pytest_plugin
from railhil.cli.commands import GROUPS
from railhil.cli.completion import whole_parser
from railhil.common.callable_package import CallablePackage
from railhil.common.command_line import EXIT_CODES, OneLineParser
from railhil.scenarios.reference import tables
from railhil.scenarios.system import DEFAULT, names

#: What reStructuredText would read as markup.
_MARKUP = re.compile(r"([\\*`|_])")
#: An example of an address, such as tcp://HOST:PORT: nothing to follow.
_ADDRESS = re.compile(r"((?:tcp|ws|http)://[\w.:]*\w)")
_COMMANDS = "reference/commands"
_API = "reference/api"
_KEYS = """\
# Every key of a scenario file of {name}

For files with `system = "{name}"`; how keys are written stands on [the page of the other ones](scenario_keys.md).
"""


def made_pages() -> Mapping[str, str]:
    """Path of each page below docs -> its text."""
    commands = _below(whole_parser())
    pages = {f"{_COMMANDS}/{name}.rst": "\n".join(_command(commands[name], "=")) for name in commands}
    others = [name for name in names() if name != DEFAULT]
    pages |= {f"reference/scenario_keys_{name}.md": _KEYS.format(name=name) + tables(name) for name in others}
    return {**pages, f"{_COMMANDS}.rst": "\n".join(_list_commands()), f"{_API}.rst": "\n".join(_list_api())}


def _title(text: str, line: str) -> Iterator[str]:
    yield from (text, line * len(text), "")


def _toctree(names: list[str]) -> Iterator[str]:
    yield from (".. toctree::", "   :hidden:", "", *(f"   {name}" for name in names), "")


def _literal(text: str) -> Iterator[str]:
    yield from ("::", "", *(f"   {line}".rstrip() for line in text.splitlines()), "")


def _plain(text: str) -> str:
    parts = _ADDRESS.split(" ".join(text.split()))
    return "".join(f"``{part}``" if place % 2 else _MARKUP.sub(r"\\\1", part) for place, part in enumerate(parts))


def _list_commands() -> Iterator[str]:
    yield from _title("Commands", "=")
    yield from ("Every command with its options, as its ``--help`` names them.", "")
    yield from _toctree([f"/{_COMMANDS}/{name}" for group in GROUPS.values() for name in group])
    for title, group in GROUPS.items():
        yield from _title(title.capitalize(), "-")
        yield from (f"* :doc:`railhil {name} </{_COMMANDS}/{name}>`: {_plain(what)}" for name, what in group.items())
        yield ""
    title, _, codes = EXIT_CODES.partition(":\n")
    yield from _title(title.capitalize(), "-")
    yield from _literal(codes)


def _below(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    found = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    return {name: below for action in found for name, below in action.choices.items()}


def _command(parser: argparse.ArgumentParser, line: str) -> Iterator[str]:
    """A command and those below it."""
    yield from _title(parser.prog, line)
    for part in re.split(r"\n\s*\n", parser.description or ""):
        is_plain = not re.search(r"^\s", part, re.M)
        yield from (_plain(part), "") if is_plain else _literal(part)
    if isinstance(parser, OneLineParser) and parser.examples:
        yield from _literal("\n".join(parser.examples))
    yield from (f".. program:: {parser.prog}", "")
    for group in parser._action_groups:
        shown = [action for action in group._group_actions if action.help is not argparse.SUPPRESS]
        options = [action for action in shown if not isinstance(action, argparse._SubParsersAction)]
        if options:
            yield from (f".. rubric:: {_plain(group.title or 'options').capitalize()}", "")
        for action in options:
            what = (action.help or "") % {**vars(action), "prog": parser.prog}
            yield from (f".. option:: {_signature(action)}", "", f"   {_plain(what)}", "")
    for below in dict.fromkeys(_below(parser).values()):
        yield from _command(below, "-" if line == "=" else "~")


def _signature(action: argparse.Action) -> str:
    """An option by all its names, or a positional argument, with its value."""
    names = action.metavar or (f"{{{','.join(map(str, action.choices))}}}" if action.choices else action.dest.upper())
    value = names if isinstance(names, str) else " ".join(names)
    if not action.option_strings:
        return value
    return ", ".join(name if action.nargs == 0 else f"{name} {value}" for name in action.option_strings)


def _list_api() -> Iterator[str]:
    yield from _title("Python API", "=")
    yield from ("What ``import railhil``, tests and the pytest plugin offer.", "")
    for title, module in {"import railhil": railhil, "railhil.testing": railhil.testing}.items():
        yield from _title(title, "-")
        names = [_defined(module, name) for name in module.__all__]
        for found in sorted(names, key=lambda one: not isfunction(one)):
            yield from _documented(found)
    yield from _title("Fixtures of pytest", "-")
    for name in ("bench", "railhil_config"):
        yield from (f".. autofunction:: {pytest_plugin.__name__}.{name}", "")


def _defined(module: ModuleType, name: str) -> Any:
    """What a public name stands for: a package that can be called is a function."""
    found = getattr(module, name)
    return found.function if isinstance(found, CallablePackage) else found


def _documented(found: Any) -> Iterator[str]:
    """The directive that takes the docstrings of a function or class from where it is defined."""
    place = f"{found.__module__}.{found.__qualname__}"
    yield from (
        (f".. autofunction:: {place}", "") if isfunction(found) else (f".. autoclass:: {place}", "   :members:", "")
    )
