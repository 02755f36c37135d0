"""Every option of a run is declared once, and a parsed command line stays in the modules of its command."""

from __future__ import annotations

import argparse
import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import railhil
from railhil import AT_TOP
from railhil.common.errors import InputError
from railhil.common.held_code import place_of
from railhil.scenarios import options
from railhil.scenarios.options import add_fmu_options, add_option, add_run_options, named_fmu

#: Modules of commands by name, and those that read options for them.
_COMMANDS = ("command.py", "__main__.py", "sequence_command.py", "cli.py", "vcan.py", "service.py")
_READERS = ("can_settings.py", "options.py", "command_line.py")


def modules(word: str) -> Iterator[tuple[Path, ast.Module]]:
    """Modules in which this word stands: their places below the package, and what they hold."""
    root = Path(railhil.__file__).parent
    for place in [*sorted(root.iterdir()), *map(place_of, AT_TOP)]:
        for path in sorted(place.rglob("*.py")) if place.is_dir() else [place] * (place.suffix == ".py"):
            if word in (text := path.read_text(encoding="utf-8")):
                yield Path(place.name, path.relative_to(place)), ast.parse(text)


def test_each_is_declared_once() -> None:
    found = [
        (path.parts[0], word.value)
        for path, tree in modules("add_argument")
        if path.name != "options.py"
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute) and call.func.attr == "add_argument"
        for word in call.args
        if isinstance(word, ast.Constant) and str(word.value).startswith("--")
        if word.value in {name.partition(" ")[0] for name in options._DECLARED}
    ]
    assert not found


def test_a_parsed_command_line_stays_with_its_command() -> None:
    found = {
        str(path)
        for path, tree in modules("Namespace")
        if path.parts[0] != "cli" and path.name not in (*_COMMANDS, *_READERS)
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and node.attr == "Namespace"
    }
    assert not found


def test_a_command_may_add_words_and_change_the_default() -> None:
    parser = argparse.ArgumentParser()
    add_run_options(parser)
    add_option(parser, "--arithmetic", ", mine", default="float64", usual="float64")
    assert parser.parse_args([]).arithmetic == "float64"
    assert "arithmetic of the law, mine (default: float64)" in parser.format_help()


def test_a_map_needs_its_fmu() -> None:
    parser = argparse.ArgumentParser()
    add_fmu_options(parser)
    assert named_fmu(parser.parse_args([])) is None
    with pytest.raises(InputError, match="fmu-map"):
        named_fmu(parser.parse_args(["--fmu-map", "x.toml"]))
