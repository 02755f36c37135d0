"""Code that plugs in cannot end a command without a word."""

from __future__ import annotations

import importlib
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.common.exit_codes import Signalled
from railhil.common.plug_ins import RENAMED, SHIPPED, EndsInterpreter, cause_of, entries, guard_plug_in
from railhil.library import run


@pytest.mark.parametrize("code", [None, 0, 2, "bye"])
def test_an_exit_is_an_error(code: int | str | None) -> None:
    with pytest.raises(EndsInterpreter, match="it ends the interpreter"), guard_plug_in():
        sys.exit(code)


def test_a_signal_is_none() -> None:
    with pytest.raises(Signalled), guard_plug_in():
        raise Signalled(143)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("import sys\nsys.exit()\n", r"found 'ending:Law', allowed an entry point that can be imported \(EndsInter"),
        (
            "import sys\nfrom railhil.controller_node.ato.laws.ipfc import Ipfc\n"
            "class Law(Ipfc):\n    def __init__(self, *given):\n        sys.exit(0)\n",
            "a law that fails at its start, expected .*EndsInterpreter: it ends the interpreter",
        ),
    ],
)
def test_a_law_that_ends_the_interpreter_is_bad_input(
    text: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    about = tmp_path / "ending-1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: ending\nVersion: 1\n")
    (about / "entry_points.txt").write_text("[railhil.laws]\nends = ending:Law\n")
    (tmp_path / "ending.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    sys.modules.pop("ending", None)
    with pytest.raises(InputError, match=said):
        run("lvshun_tieshan", controller="ends", arithmetic="float64")


@pytest.mark.parametrize("group", SHIPPED)
def test_a_shipped_law_is_its_module(group: str) -> None:
    laws = {name: entry.load() for name, entry in entries(group).items() if entry.module.startswith(SHIPPED[group])}
    assert laws
    assert {name: law.name for name, law in laws.items()} == {name: name for name in laws}


@pytest.mark.parametrize(
    ("before", "said"),
    [
        ("railhil.controller_node.laws.pfc", "; railhil has railhil.controller_node.ato.pfc; CHANGELOG"),
        ("railhil.plant_sim.dynamics", "railhil.plant_sim.ato.dynamics and railhil.plant_sim.high_speed.dynamics"),
        ("railhil.record.status", "'railhil.record.status'; import it from railhil.record.notes"),
        ("railhil.judge.journey", "; railhil has railhil.systems.ato.judge.journey; "),
        ("railhil.controller_node.nothing", "'railhil.controller_node.nothing'; CHANGELOG.md says what has moved"),
        ("nothing_of_ours", "No module named 'nothing_of_ours'"),
    ],
)
def test_a_module_that_has_moved_is_named(before: str, said: str) -> None:
    with pytest.raises(ModuleNotFoundError) as caught:
        importlib.import_module(before)
    assert said in cause_of(caught.value)


def test_what_a_module_is_renamed_to_can_be_imported() -> None:
    for before, now in RENAMED.items():
        assert find_spec(before) is None
        importlib.import_module(now)
