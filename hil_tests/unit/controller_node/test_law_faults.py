"""Laws that somebody plugs in and that cannot be made: bad input, in one line that names law and cause."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil
from railhil.common.errors import InputError
from railhil.controller_node.controller import Controller
from railhil.controller_node.laws import load as load_law
from railhil.scenarios.load import load

MODULE = """\
from railhil.controller_node.laws.ipfc import Ipfc
from railhil.common.errors import InputError

class Fussy(Ipfc):
    def __init__(self, *given):
        raise ValueError("no good\\nparameters")

class Endless(Ipfc):
    @property
    def horizon(self):
        return 10**15

class Refusing(Ipfc):
    def __init__(self, *given):
        raise InputError("pid.toml", "gain", -1, "above 0")
"""
BROKEN = "raise RuntimeError('half installed')\n"
ENTRIES = """\
[railhil.laws]
fussy = plugged_laws:Fussy
endless = plugged_laws:Endless
refusing = plugged_laws:Refusing
missing = no_such_module_of_ours:Law
nameless = plugged_laws:Nothing
broken = plugged_broken:Law
"""
LINES = {
    "fussy": "controller: fussy: found a law that fails at its start, allowed a law that can be made for 0.5 s and 7 "
    "notches (ValueError: no good parameters)",
    "endless": "controller: endless: found a law that fails at its start, allowed a law that can be made for 0.5 s and "
    "7 notches (",
    "refusing": "pid.toml: gain: found -1, allowed above 0",
    "missing": "controller: missing: found 'no_such_module_of_ours:Law', allowed an entry point that can be imported "
    "(ModuleNotFoundError: No module named 'no_such_module_of_ours')",
    "nameless": "(AttributeError: module 'plugged_laws' has no attribute 'Nothing')",
    "broken": "controller: broken: found 'plugged_broken:Law', allowed an entry point that can be imported "
    "(RuntimeError: half installed)",
}


@pytest.fixture
def plugged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A distribution with such laws on the path of this process and its children; the folder of a short scenario."""
    package = tmp_path / "plug" / "plugged-0.1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: plugged\nVersion: 0.1\n")
    (package / "entry_points.txt").write_text(ENTRIES)
    (package.parent / "plugged_laws.py").write_text(MODULE)
    (package.parent / "plugged_broken.py").write_text(BROKEN)
    monkeypatch.syspath_prepend(str(package.parent))
    monkeypatch.setenv("PYTHONPATH", str(package.parent))
    for name in ("plugged_laws", "plugged_broken"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    importlib.invalidate_caches()
    (tmp_path / "short.toml").write_text(QUICK_TOML)
    return tmp_path


def test_a_law_that_cannot_be_made_is_bad_input(plugged: Path) -> None:
    for name, line in LINES.items():
        with pytest.raises(InputError) as caught:
            Controller(load("lvshun_tieshan"), name)
        assert line in str(caught.value)
        assert "\n" not in str(caught.value)


def test_the_cause_stays_with_the_line(plugged: Path) -> None:
    """For the one who mends the law: ``RAILHIL_TRACEBACK`` shows it."""
    with pytest.raises(InputError) as caught:
        load_law("broken")
    assert isinstance(caught.value.__cause__, RuntimeError)


@pytest.mark.slow
@pytest.mark.loop
@pytest.mark.parametrize("law", ["fussy", "missing"])
@pytest.mark.parametrize(
    "command", [("run", "--quiet", "--out", "run"), ("audit", "--runs", "0"), ("export-c", "--out", "c")]
)
def test_every_command_says_so_with_exit_code_2(plugged: Path, law: str, command: tuple[str, ...]) -> None:
    program, *options = command
    named = [law, "short.toml"] if program == "export-c" else ["short.toml", "--controller", law]
    done = railhil(program, *named, *options, cwd=plugged)
    assert done.exit_code == 2
    assert LINES[law] in done.one_line()
    assert sorted(path.name for path in plugged.iterdir()) == ["plug", "short.toml"]
