"""A command in the Python that the tests keep loaded is as one in a new Python."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.warm import run_module

_TELLING = """\
import json, os, sys
json.dump([sys.argv, sys.path, os.getcwd(), dict(os.environ), sys.stdin.read(), __name__], sys.stdout)
print("to the other", file=sys.stderr)
sys.exit(7)
"""


def test_a_module_gets_what_a_new_process_would(tmp_path: Path) -> None:
    plug, here = tmp_path / "plug", tmp_path / "here"
    plug.mkdir()
    here.mkdir()
    (plug / "telling.py").write_text(_TELLING)
    environment = {"PYTHONPATH": str(plug), "PATH": os.environ["PATH"], "ONLY": "this"}
    done = run_module("telling", ["a word", "--x"], environment=environment, cwd=here, text="said\n")
    argv, path, cwd, found, text, name = json.loads(done.stdout)
    assert (done.returncode, done.stderr) == (7, "to the other\n")
    assert argv == [str(plug / "telling.py"), "a word", "--x"]
    assert path[:2] == [str(here), str(plug)]
    assert (cwd, found, text, name) == (str(here), environment, "said\n", "__main__")
    # The next one knows nothing of it.
    done = run_module("telling", [], environment={"PATH": os.environ["PATH"]}, cwd=here)
    assert done.returncode == 1
    assert "No module named telling" in done.stderr


def test_a_signal_ends_that_process_only(tmp_path: Path) -> None:
    (tmp_path / "killed.py").write_text("import os, signal; os.kill(os.getpid(), signal.SIGKILL)")
    assert run_module("killed", [], environment=os.environ, cwd=tmp_path).returncode == -signal.SIGKILL
    assert railhil("--version").exit_code == 0


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ("--help",),
        ("run", "nowhere.toml"),
        ("audit", "nowhere.toml"),
        ("node", "plant", "nowhere.toml"),
    ],
    ids=" ".join,
)
def test_commands_say_the_same(words: tuple[str, ...], tmp_path: Path) -> None:
    assert railhil(*words, cwd=tmp_path) == railhil(*words, cwd=tmp_path, anew=True)
