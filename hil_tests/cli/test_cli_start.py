"""The start of a command: it loads only what it needs, and parses like the whole command line."""

from __future__ import annotations

import subprocess
import sys

import pytest

from railhil.cli import main
from railhil.cli.commands import parser
from railhil.common.exit_codes import USAGE


@pytest.mark.parametrize(
    "name", ["run", "compare", "score", "report", "plot", "watch", "scenarios", "ports", "new", "doctor", "bus", "node"]
)
def test_a_command_alone_is_as_among_all(name, capsys):
    helps = []
    for made in (parser(), parser([name])):
        with pytest.raises(SystemExit):
            made.parse_args([name, "--help"])
        helps.append(capsys.readouterr().out)
    assert helps[0] == helps[1] != ""


def test_the_help_is_that_of_the_whole_command_line(capsys):
    helps = []
    for made in (parser(), parser(["--help"])):
        with pytest.raises(SystemExit):
            made.parse_args(["--help"])
        helps.append(capsys.readouterr().out)
    assert helps[0] == helps[1] != ""


def test_an_unknown_option_is_told_of_the_whole_command_line(capsys):
    for words in (["--bar", "ports"], ["ports", "--bar"]):
        with pytest.raises(SystemExit) as ended:
            main(words)
        assert ended.value.code == USAGE
        assert "unrecognized arguments: --bar" in capsys.readouterr().err


def test_a_command_that_is_not_the_first_word_has_its_options():
    """Whatever argparse makes of the words before it."""
    for words in (["--", "ports"], ["--bar", "ports"]):
        assert parser(words).parse_args(["ports", "--system", "stop"]).system == "stop"


@pytest.mark.parametrize("word", ["--help", "--version", "no_such_command"])
def test_a_word_that_is_no_command_loads_none(word):
    code = (
        "import sys; from railhil.cli import main\n"
        "try: main(sys.argv[1:2])\n"
        "except SystemExit: pass\n"
        "sys.stdout.flush()\n"
        "print(*(name for name in sys.modules if name in sys.argv[2:] or name.startswith('railhil.cli.')))"
    )
    names = ("numpy", "can", "pydantic")
    done = subprocess.run([sys.executable, "-c", code, word, *names], capture_output=True, text=True, check=True)
    assert set(done.stdout.splitlines()[-1].split()) == {"railhil.cli.commands", "railhil.cli.programs"}


@pytest.mark.slow
def test_a_command_loads_no_library_that_it_does_not_use():
    """Each would cost every start of a command, and in an emulated machine seconds."""
    code = (
        "import sys; from railhil.common.exit_codes import run_guarded\n"
        "def work():\n"
        "    from railhil.cli import commands; from railhil.scenarios.load import load\n"
        "    commands.parser(['run']); load('lvshun_tieshan'); return 0\n"
        "run_guarded('test', work); print(*(name for name in sys.argv[1:] if name in sys.modules))\n"
        "import asammdf"
    )
    names = ("cantools", "yaml", "matplotlib", "numba", "pandas", "scipy", "asammdf", "numpy")
    done = subprocess.run([sys.executable, "-c", code, *names], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["numpy"]


@pytest.mark.parametrize(("given", "expected"), [(None, "1"), ("2", "2")])
def test_matrices_are_multiplied_in_one_thread_unless_the_user_says_otherwise(given, expected, monkeypatch):
    """Threads cost every start of a process 40 ms, and sums could depend on their number."""
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    if given is not None:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", given)
    code = (
        "import os; from railhil.common.exit_codes import run_guarded\n"
        "def work():\n"
        "    import numpy; return 0\n"
        "run_guarded('test', work); print(os.environ['OPENBLAS_NUM_THREADS'], len(os.listdir('/proc/self/task')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    told, threads = done.stdout.split()
    assert told == expected
    assert int(threads) <= int(expected)


def test_sequences_need_no_library_of_an_extra():
    code = (
        "import sys\n"
        "sys.modules.update(dict.fromkeys(['pyarrow', 'numba', 'scipy', 'matplotlib', 'jinja2', 'websockets']))\n"
        "from railhil.sequences.sequence_command import main; sys.exit(main(['verify', 'no_such_folder']))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "InputError: no_such_folder" in done.stderr, done.stderr


def test_the_panel_starts_without_what_python_can_loads_for_files():
    """asammdf brings pandas and pyarrow: 90 MB in a process that serves a page."""
    code = (
        "import runpy, sys; from railhil.common.exit_codes import run_guarded; sys.argv[1:] = ['--help']\n"
        "try: runpy.run_module('railhil.panel', run_name='__main__')\n"
        "except SystemExit: print(*(name for name in ('asammdf', 'pandas', 'pyarrow') if name in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == ""
