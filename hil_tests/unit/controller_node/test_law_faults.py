"""Plug-in laws that cannot be made: bad input, in one line that names law and cause."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import railhil
from railhil.common.errors import InputError
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.laws import load as load_law
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec

MODULE = """\
from railhil.controller_node.laws.base import SPEED_Q
from railhil.controller_node.ato.laws.ipfc import Ipfc
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

class Failing(Ipfc):
    def fail(self, inputs):
        raise NotImplementedError

    def step(self, state, inputs):
        self._ar.note("mine", inputs.speed, SPEED_Q, "km/h")
        self.fail(inputs)
        return super().step(state, inputs)

class Dividing(Failing):
    def fail(self, inputs):
        return inputs.speed / (1 - 1)

class Mixing(Failing):
    def fail(self, inputs):
        return inputs.set_point - inputs.speed

class Counting(Failing):
    def fail(self, inputs):
        return self._ar.add(inputs.speed, 3)

class Comparing(Failing):
    def fail(self, inputs):
        return max(inputs.speed, inputs.set_point)

class Branching(Failing):
    def fail(self, inputs):
        return self._ar.gt(inputs.speed, inputs.set_point) or 3

class Formats(Failing):
    def fail(self, inputs):
        return self._ar.add(inputs.speed, self._ar.convert(inputs.speed, SPEED_Q, 8))

class Raising(Failing):
    def fail(self, inputs):
        return 1 / 0

class Silent(Ipfc):
    def step(self, state, inputs):
        return None

class Late(Failing):
    calls = 0
    def fail(self, inputs):
        if isinstance(inputs.speed, (int, float)):
            Late.calls += 1
            1 / (5 - Late.calls)

class LateOnArrays(Failing):
    calls = 0
    def fail(self, inputs):
        if type(inputs.speed).__name__ == "ndarray":
            LateOnArrays.calls += 1
            2 / (5 - LateOnArrays.calls)
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
dividing = plugged_laws:Dividing
mixing = plugged_laws:Mixing
counting = plugged_laws:Counting
comparing = plugged_laws:Comparing
branching = plugged_laws:Branching
formats = plugged_laws:Formats
raising = plugged_laws:Raising
silent = plugged_laws:Silent
late = plugged_laws:Late
late_on_arrays = plugged_laws:LateOnArrays
"""
LINES = {
    "fussy": "controller: fussy: a law that fails at its start, expected a law that can be made for 0.5 s and 7 "
    "notches (ValueError: no good parameters, at {plugged_laws.py}:7)",
    "endless": "controller: endless: a law that fails at its start, expected a law that can be made for 0.5 s and "
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
            Controller(load("lvshun_tieshan"), LawSpec(name))
        line = line.replace("{plugged_laws.py}", str(plugged / "plug" / "plugged_laws.py"))
        assert line in str(caught.value)
        assert "\n" not in str(caught.value)


def test_the_cause_stays_with_the_line(plugged: Path) -> None:
    """For the one who mends the law: ``RAILHIL_TRACEBACK`` shows it."""
    with pytest.raises(InputError) as caught:
        load_law("broken")
    assert isinstance(caught.value.__cause__, RuntimeError)


#: Text of the line that fails, what is said of it.
FAULTS = {
    "dividing": ("return inputs.speed / (1 - 1)", "OperandError: / on a value of the law: use ar.div"),
    "mixing": ("return inputs.set_point - inputs.speed", "OperandError: - on a value of the law: use ar.sub"),
    "counting": ("return self._ar.add(inputs.speed, 3)", "OperandError: 3 as an operand: use ar.const of a Constant"),
    "comparing": ("return max(", "OperandError: a comparison on a value of the law: use ar.gt with ar.where, "),
    "branching": ("or 3", "BranchError: a branch in Python on a value of the law: Arithmetic.where chooses"),
    "formats": ("SPEED_Q, 8))", "FormatError: first step: add of Q8 and Q20: ar.convert changes a format"),
    "raising": ("return 1 / 0", "ZeroDivisionError: division by zero"),
}


def line_of(text: str) -> int:
    return next(number for number, line in enumerate(MODULE.splitlines(), 1) if text in line)


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
@pytest.mark.parametrize("law", FAULTS)
def test_a_law_that_fails_is_told_where_and_what_to_use(plugged: Path, law: str, arithmetic: str) -> None:
    text, said = FAULTS[law]
    if law == "formats" and arithmetic == "float64":
        return
    with pytest.raises(InputError) as caught:
        Controller(load("lvshun_tieshan"), LawSpec(law, arithmetic))
    at = f"{plugged / 'plug' / 'plugged_laws.py'}:{line_of(text)}: "
    assert str(caught.value).startswith(f"{at}law {law}, step, after quantity mine: an operation that fails, ")
    assert said in str(caught.value)


def test_a_law_that_answers_nonsense_is_told_where_its_function_begins(plugged: Path) -> None:
    with pytest.raises(InputError, match=f"plugged_laws.py:{line_of('return None') - 1}: law silent, step, before"):
        Controller(load("lvshun_tieshan"), LawSpec("silent"))


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
def test_a_law_that_fails_while_it_drives_is_told_the_same(plugged: Path, arithmetic: str) -> None:
    controller = Controller(load("lvshun_tieshan"), LawSpec("late", arithmetic))
    for k in range(4):
        controller.step(k, 0, 0)
    at = f"plugged_laws.py:{line_of('1 / (5')}: law late, step, after quantity mine: "
    with pytest.raises(InputError, match=re.escape(at)) as caught:
        controller.step(4, 0, 0)
    assert "(ZeroDivisionError: division by zero)" in str(caught.value)


@pytest.mark.slow
@pytest.mark.loop
def test_a_run_whose_law_fails_keeps_its_record_and_ends_with_exit_code_2(plugged: Path) -> None:
    done = railhil("run", "short.toml", "--controller", "late", "--quiet", "--no-report", "--out", "run", cwd=plugged)
    last = done.out.splitlines()[-1]
    assert done.exit_code == 2, done.out
    assert f"plugged_laws.py:{line_of('1 / (5')}: law late, step, after quantity mine: an operation " in last
    assert (plugged / "run" / "frames.log").stat().st_size > 0
    assert (plugged / "run" / "certificate.json").is_file()


@pytest.mark.slow
def test_a_law_that_fails_in_a_later_step_of_a_campaign_is_told_where(plugged: Path) -> None:
    words = ("--laws", "late_on_arrays", "--runs", "3", "--out", "mine")
    done = railhil("campaign", "short.toml", *words, cwd=plugged)
    assert done.exit_code == 2
    at = f"plugged_laws.py:{line_of('2 / (5')}: law late_on_arrays, step: an operation that fails"
    assert at in done.err.splitlines()[-1]
    assert "(ZeroDivisionError: division by zero)" in done.err


@pytest.mark.slow
@pytest.mark.loop
def test_a_controller_whose_law_cannot_be_made_ends_the_run_with_its_line(plugged: Path) -> None:
    """Over the hub: the supervisor repeats what that process has said."""
    done = railhil(
        "run", "short.toml", "--controller", "fussy", "-i", "railhil", "--quiet", "--out", "run", cwd=plugged
    )
    assert done.exit_code == 2
    assert LINES["fussy"].replace("{plugged_laws.py}", str(plugged / "plug" / "plugged_laws.py")) in done.one_line()
    assert sorted(path.name for path in plugged.iterdir()) == ["plug", "short.toml"]


@pytest.mark.parametrize("law", ["fussy", "missing"])
@pytest.mark.parametrize(
    "command", [("run", "--bus", "local", "--out", "run"), ("audit", "--runs", "0"), ("export-c", "--out", "c")]
)
def test_every_command_says_so_with_exit_code_2(plugged: Path, law: str, command: tuple[str, ...]) -> None:
    program, *options = command
    named = [law, "short.toml"] if program == "export-c" else ["short.toml", "--controller", law]
    done = railhil(program, *named, *options, cwd=plugged)
    assert done.exit_code == 2
    assert LINES[law].replace("{plugged_laws.py}", str(plugged / "plug" / "plugged_laws.py")) in done.one_line()
    assert sorted(path.name for path in plugged.iterdir()) == ["plug", "short.toml"]
