"""A file or folder that is not there: one line in the same words from every command that would read it."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint, railhil
from hil_tests.support.command_parsers import COMMANDS
from railhil.cli.programs import PROGRAMS

#: Options that name a file or folder to be written.
WRITTEN = {"--out", "--memory", "--write-dbc", "--fault-logs", "--telemetry", "--timing-file", "--measured"}
#: Options that are read only beside another, or after a recorded run has been found.
LATER = {"--fmu-map", "--controller-fmu-map", "--key", "--share"}
#: Further words that a command needs.
BESIDE = {
    "railhil replay": ("--node", "plant"), "railhil export": ("--csv",), "railhil memory export": ("--out", "x"),
    "railhil export-c": ("ipfc", "--out", "x"), "railhil panel": ("--port", "0"), "railhil new line": ("mine",),
    "railhil learn": ("yizhuang_stop",), "railhil sequence run": ("yizhuang_stop",),
    "railhil branch": ("--no-return",), "railhil probability": ("--requirement", "A-1"),
    "railhil query": ("select 1",),
}  # fmt: skip


def _cases() -> list[tuple[str, tuple[str, ...]]]:
    """Command, and words that name the missing file."""
    found = []
    for prog, parser in COMMANDS.items():
        read = [one for one in parser._actions if one.metavar in ("FILE", "DIR", "RUN", "KEY", "DIR|FILE")]
        needed = [one for one in read if not one.option_strings]
        for action in needed or read:
            option = action.option_strings[-1:]
            if not {*option} & (WRITTEN | LATER):
                found.append((prog, (*option, "nowhere.fmu" if "fmu" in action.dest else "nowhere.toml")))
    return found


CASES = _cases()


def test_every_kind_of_file_is_among_the_cases() -> None:
    assert len(CASES) > 25
    asked = {prog.removeprefix("railhil ") for prog, _ in CASES}
    assert {"run", "score", "rerun", "campaign", "sequence verify", "node controller"} <= asked


@pytest.mark.slow
@pytest.mark.parametrize(("prog", "words"), CASES, ids=lambda case: "_".join(case) if isinstance(case, tuple) else case)
def test_one_line_says_that_it_does_not_exist(here: Railhil, tmp_path: Path, prog: str, words: tuple[str, ...]) -> None:
    command = prog.split()[1:]
    is_program = command[0] in PROGRAMS or command[0] == "node"
    # What is made again is said by the folder of --verify alone.
    beside = () if "--verify" in words else BESIDE.get(prog, ())
    arguments = [*command, *beside, *words]
    line = complaint(railhil(*arguments, cwd=tmp_path) if is_program else here(*arguments))
    assert "nowhere" in line
    assert "does not exist, expected " in line
    assert "rrno" not in line
    assert not list(tmp_path.iterdir())
