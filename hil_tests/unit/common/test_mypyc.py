"""What the compiled build (setup.py) rests on, without compiling anything; ``make test-compiled`` compiles."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from hil_tests.support.paths import ROOT
from railhil.common import compilable
from railhil.common.held_code import place_of
from railhil.plant_sim.ato import dynamics, forces

_SETUP = (ROOT / "setup.py").read_text(encoding="utf-8")
MODULES = re.findall(r'"(railhil/[\w/]+\.py)"', _SETUP)
#: Classes of compiled modules that interpreted code subclasses.
_MARK = "mypyc_attr(allow_interpreted_subclasses=True)"
#: Attributes that are read from the class itself, which mypyc looks up as Python does.
_OF_CLASS = {"computes"}


def _source(path: str) -> Path:
    return place_of(path.removeprefix("railhil/"))


def _product() -> list[Path]:
    folders = ("bus", "controller_node", "plant_sim", "railhil")
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]


def test_the_compiled_modules_are_there_each_once_and_in_order() -> None:
    assert sorted(set(MODULES)) == MODULES
    assert all(_source(path).is_file() for path in MODULES)


def _classes(path: Path) -> dict[str, tuple[str, set[str], set[str]]]:
    """For each top-level class its decorators, its bases, and the attributes to which its body gives a value."""
    text = path.read_text(encoding="utf-8")
    found = {}
    for each in re.finditer(r"^((?:@.*\n)*)class (\w+)(?:\((.*)\))?:\n((?:(?: .*)?\n)*)", text, re.MULTILINE):
        bases = {base.partition("[")[0].rpartition(".")[2].strip() for base in (each[3] or "").split(",")}
        attributes = set(re.findall(r"^    (\w+)(?:: [^=\n]+)? = ", each[4], re.MULTILINE))
        found[each[2]] = each[1], bases, attributes
    return found


def test_what_interpreted_code_extends_is_marked_for_it_and_keeps_its_attributes() -> None:
    """mypyc refuses an unmarked class only when one is made, and does not see an attribute that a body replaces."""
    compiled = set(map(_source, MODULES))
    defined = {name: of for path in compiled for name, of in _classes(path).items()}
    wrong, extended = [], set()
    for path in set(_product()) - compiled:
        for name, (_, bases, attributes) in _classes(path).items():
            for base in bases & defined.keys():
                extended.add(base)
                if _MARK not in defined[base][0] or defined[base][2] & attributes - _OF_CLASS:
                    wrong.append(f"{path.name}: {name}({base})")
    assert wrong == []
    assert {"TrainOnBus", "SingleLink", "SwitchPort"} <= extended


def test_no_compiled_function_is_decorated_as_compilable() -> None:
    """mypyc calls a decorated function as an object, and the batch could not read its source."""
    found = {path for path in MODULES if re.search(r"^@compilable", _source(path).read_text("utf-8"), re.M)}
    assert found == set()


def test_the_batch_reads_a_compiled_function_from_its_source(monkeypatch: pytest.MonkeyPatch) -> None:
    # What a compiled module has in place of its functions: built-in ones, which have a name and a module.
    given = forces.effort_limit_n
    native: Any = SimpleNamespace(__module__=given.__module__, __name__=given.__name__)
    function = compilable.interpreted(native)
    limit = forces.EffortLimit(100.0, 200.0, (), ())
    assert function is not given
    assert [function(limit, speed) for speed in (0.0, 4.0)] == [given(limit, speed) for speed in (0.0, 4.0)]
    monkeypatch.setattr(dynamics, "__file__", "/somewhere/dynamics.cpython-311-x86_64-linux-gnu.so")
    assert compilable.source_of(dynamics) == Path("/somewhere/dynamics.py")
    assert compilable.interpreted(given) is given


def test_a_marked_class_is_itself() -> None:
    mark = importlib.import_module("railhil.common.mypyc").mypyc_attr(allow_interpreted_subclasses=True)
    assert mark(Path) is Path
