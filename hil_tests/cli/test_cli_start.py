"""The start of a command: it loads only what it needs, and parses like the whole command line."""

from __future__ import annotations

import subprocess
import sys

import pytest

from railhil.cli.commands import parser


@pytest.mark.parametrize(
    "name", ["run", "compare", "score", "report", "plot", "scenarios", "ports", "doctor", "bus", "node"]
)
def test_a_command_alone_is_as_among_all(name, capsys):
    helps = []
    for made in (parser(), parser(name)):
        with pytest.raises(SystemExit):
            made.parse_args([name, "--help"])
        helps.append(capsys.readouterr().out)
    assert helps[0] == helps[1] != ""


def test_a_command_loads_no_library_that_it_does_not_use():
    """Each would cost every start of a command, and in an emulated machine seconds."""
    code = (
        "import sys; from railhil.cli import commands; from railhil.scenarios.load import load; commands.parser('run');"
        "load('lvshun_tieshan'); print(*(name for name in sys.argv[1:] if name in sys.modules))"
    )
    names = ("cantools", "yaml", "matplotlib", "numba", "pandas", "scipy", "numpy")
    done = subprocess.run([sys.executable, "-c", code, *names], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["numpy"]
