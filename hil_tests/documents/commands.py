"""Runs the commands, examples and test files of a page, all in one folder, in the order of the page."""

from __future__ import annotations

import ast
import doctest
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import chdir
from pathlib import Path

from hil_tests.documents.compared import Change, OtherWords, printed
from hil_tests.documents.pages import Block
from hil_tests.support.paths import ROOT
from hil_tests.support.user_suite import run_suite

#: Languages of blocks that this module runs or parses, and those of which nothing is run.
RUN, SHOWN = ("console", "sh", "python", "toml"), ("usage", "text", "c", "yaml")
#: Further words after the language.
WORDS = ("long", "machine", "pytest")
#: A command that ends with PASS or FAIL has worked.
_VERDICTS = (0, 1)
_TIMEOUT_S = 900
_END = "\x01"


class Failed(Exception):
    """A command of a page does not do what the page says."""


def check(block: Block, folder: Path) -> list[Change]:
    """Do what a block says; the lines that would have to change.

    :raises Failed: a command ended with an error.
    :raises OtherWords: a command prints other words.
    """
    language, *words = block.info
    if "machine" in words:
        return []
    if language == "toml":
        tomllib.loads(block.text)
    elif language == "python" and "pytest" in words:
        _pytest(block, folder)
    elif language == "python" and ">>> " not in block.text:
        ast.parse(block.text)
    elif language == "console":
        return list(_console(block, folder))
    elif language == "sh":
        for line, (code, out) in zip(lines_of(block.lines), _run(block, lines_of(block.lines), folder), strict=True):
            if code not in _VERDICTS:
                raise Failed(f"{block}: ended with {code}: {line}\n{out}")
    return []


def examples(blocks: Sequence[Block], folder: Path) -> list[Change]:
    """Examples of a page after ``>>>``, with the names of those above."""
    changes: list[Change] = []

    class Runner(doctest.DocTestRunner):
        def report_failure(self, out: object, test: object, example: doctest.Example, got: str) -> None:
            block = next(one for one in blocks if one.first == test.lineno)  # type: ignore[attr-defined]
            first = example.lineno + example.source.count("\n")
            found = printed(block, first, example.want.splitlines(), got)
            if not found:
                raise OtherWords(f"{test.name}: {example.source}{got}")  # type: ignore[attr-defined]
            changes.extend(found)

        def report_unexpected_exception(
            self, out: object, test: object, example: doctest.Example, info: object
        ) -> None:
            raise Failed(f"{test.name}: {example.source}{info}")  # type: ignore[attr-defined]

    names: dict[str, object] = {}
    with chdir(folder):
        for block in blocks:
            test = doctest.DocTestParser().get_doctest(block.text + "\n", names, str(block), block.page, block.first)
            Runner(optionflags=doctest.ELLIPSIS).run(test, out=lambda _: None, clear_globs=False)
            names = test.globs
    return changes


def _pytest(block: Block, folder: Path) -> None:
    """A block with tests is a file of a user's suite beside the line of docs/examples."""
    suite = folder / f"suite_{block.first}"
    suite.mkdir()
    for name in ("my_line.toml",):
        (suite / name).write_bytes((ROOT / "docs/examples/suite" / name).read_bytes())
    (suite / "test_page.py").write_text(block.text + "\n", encoding="utf-8")
    done = run_suite(suite, "-q")
    if done.ret != 0:
        raise Failed(f"{block}: " + "\n".join(done.outlines))


def lines_of(lines: Sequence[str]) -> list[str]:
    """Command lines; one that ends with a backslash goes on."""
    joined = re.sub(r"\\\n *", "", "\n".join(lines)).split("\n")
    return [line for line in joined if line.strip()]


def _console(block: Block, folder: Path) -> Iterator[Change]:
    starts = [n for n, line in enumerate(block.lines) if line.startswith("$ ")]
    if not starts or starts[0] != 0:
        raise OtherWords(f"{block}: a block of the kind console begins with a command after $")
    commands = [block.lines[n][2:] for n in starts]
    for start, end, (_, out) in zip(
        starts, [*starts[1:], len(block.lines)], _run(block, commands, folder), strict=True
    ):
        yield from printed(block, start + 1, block.lines[start + 1 : end], out)


def _run(block: Block, commands: Sequence[str], folder: Path) -> list[tuple[int, str]]:
    """Exit code and output of each command line, in one shell; what is left in the background ends with it."""
    made = "".join(f"{{ {line}; }} >/dev/null; [ $? -le 1 ] || exit\n" for line in block.before)
    script = made + "".join(f"{line}\nprintf '{_END}%s{_END}' $?\n" for line in commands)
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTEST_", "CAN_"))}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    environment["PYTHONPATH"] = str(ROOT)
    environment["COLUMNS"] = "120"
    for name in ("docs", "controller_node", "dbc"):
        if not (folder / name).exists():
            (folder / name).symlink_to(ROOT / name)
    if _needs_no_bus(block):
        environment["RAILHIL_BUS"] = "local"
    limited = ["timeout", "--kill-after=5", str(_TIMEOUT_S), "bash", "-c"]
    done = subprocess.run(
        [*limited, script + "\nkill $(jobs -p) 2>/dev/null; wait"], cwd=folder, env=environment,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True, check=False,
    )  # fmt: skip
    parts = done.stdout.split(_END)
    if len(parts) != 2 * len(commands) + 1:
        raise Failed(f"{block}: the shell ended early\n{done.stdout}")
    return [(int(code), out) for out, code in zip(parts[:-1:2], parts[1::2], strict=True)]


def _needs_no_bus(block: Block) -> bool:
    """Whether the runs of a block go without a bus: where none is named and nothing is said about what is printed."""
    return block.info[0] == "sh" and not re.search(r" -i | --bus |node|--panel|realtime|--attach", block.text)
