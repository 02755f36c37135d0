"""Telegram classes and enumerations made from a port table, and their declarations for type checkers."""

from __future__ import annotations

import ast
import inspect
import pickle
import subprocess
import sys
from dataclasses import fields
from enum import IntEnum
from pathlib import Path
from types import ModuleType

import pytest

from hil_tests.support.paths import make_tree
from railhil.bus import telegrams as house
from railhil.bus.layout import Telegram
from railhil.bus.made import telegrams_of
from railhil.dbc import ContractError, Port, house_contract, load_contract, own_ports, wire_contract
from railhil.dbc.drawing import drawing
from railhil.dbc.stubs import stub
from railhil.systems.line import LINE
from railhil.wire import ato, high_speed, line, stop
from railhil.wire.power_units import wire
from railhil.wire.stop_counts import CONTRACT

MODULES = {
    house: house_contract().ports,
    ato: own_ports(wire_contract()),
    stop: own_ports(CONTRACT),
    high_speed: own_ports(wire(1).contract),
    line: own_ports(LINE.contract, wire_contract()),
}
#: A table with what may stand in one: names of its own, names by default, an enumeration, a shared layout.
TABLE = """
[[port]]
name = "CART_STAT"
address = 0x110
f_code = 1
period_ms = 10
source = "plant"
mode = "publish"
comment = "Position of the cart"
signals = [
  { name = "CartPos", at = "0.7:16", field = "position_mm", signed = true, scale = 0.001, unit = "m" },
  { name = "DoorState", at = "2.7:2", enum = "Door", values = { 0 = "shut", 2 = "open" }, more_values = { 3 = "x" } },
  { name = "CartChk", at = "3.7:2", check = "chk" },
  { name = "CartLife", at = "3.3:4", comment = "Life sign" },
]
[[port]]
name = "UNIT1_CMD"
telegram = "FirstCommand"
address = 0x118
f_code = 2
period_ms = 20
source = "controller"
mode = "poll"
comment = "Force"
signals = "force"
[[port]]
name = "UNIT2_CMD"
address = 0x120
f_code = 2
period_ms = 20
source = "controller"
mode = "poll"
comment = "Force"
signals = "force"
[shared]
force = [
  { name = "{p}FrontForce", at = "0.7:16", default = -5, signed = true },
  { name = "{p}FrontChk", at = "2.7:2", check = "chk" },
  { name = "{p}RearChk", at = "2.5:2", check = "chk" },
]
"""


def ports_of(folder: Path, text: str = TABLE) -> list[Port]:
    path = folder / "ports.toml"
    path.write_text(text, encoding="utf-8")
    return own_ports(load_contract(path, check_dbc=False))


def test_fields_defaults_and_enumerations_are_those_of_the_table(tmp_path: Path) -> None:
    made = telegrams_of(ports_of(tmp_path), "somewhere")
    assert sorted(made) == ["CartStat", "Door", "FirstCommand", "Force", "Unit2Cmd"]
    assert list(made["CartStat"]().items()) == [("position_mm", 0), ("door_state", 0), ("check", 1), ("life", 0)]
    assert list(made["Unit2Cmd"]().items()) == [("front_force", -5), ("front_chk", 1), ("rear_chk", 1)]
    assert {member.name: member.value for member in made["Door"]} == {"SHUT": 0, "OPEN": 2, "X": 3}
    telegram = made["CartStat"](-2, made["Door"].OPEN, life=9)
    assert telegram.encode() == b"\xff\xfe\x80\x49"
    assert made["CartStat"].decode(telegram.encode()) == telegram


def test_ports_with_a_shared_layout_have_one_base(tmp_path: Path) -> None:
    made = telegrams_of(ports_of(tmp_path), "somewhere")
    first, second = made["FirstCommand"], made["Unit2Cmd"]
    assert issubclass(first, made["Force"])
    assert issubclass(second, made["Force"])
    assert (first.PORT, second.PORT) == ("UNIT1_CMD", "UNIT2_CMD")
    assert [entry.name for _, entry in second.signals()] == ["Unit2FrontForce", "Unit2FrontChk", "Unit2RearChk"]


def test_names_that_a_class_cannot_have_are_refused(tmp_path: Path) -> None:
    for name in ("class", "door_state", "1st"):
        with pytest.raises(ContractError, match=f"'{name}'"):
            ports_of(tmp_path, TABLE.replace("position_mm", name))


def test_the_drawing_shows_each_signal_at_its_place(tmp_path: Path) -> None:
    cart, first, _ = ports_of(tmp_path)
    assert drawing(cart).splitlines() == [
        " 0.7           2.7          2.5   3.7     3.5   3.3",
        "+-------------+------------+-----+-------+-----+------+",
        "| position_mm | door_state |     | check |     | life |",
        "|     s16     |     u2     |     |  u2   |     |  u4  |",
        "+-------------+------------+-----+-------+-----+------+",
    ]
    text = inspect.getdoc(telegrams_of([cart], "somewhere")["CartStat"])
    assert text is not None
    assert text.startswith("CART_STAT: Position of the cart.")
    assert all(line in text for line in drawing(cart).splitlines())
    assert "- ``position_mm``: CartPos; 1 is 0.001 m" in text
    assert "- ``door_state``: DoorState; 0 shut, 2 open" in text
    assert drawing(first).count("front_force") == 1


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_a_module_has_a_class_for_each_port_of_its_table(module: ModuleType) -> None:
    for port in MODULES[module]:
        kind = getattr(module, port.telegram)
        assert kind.port() == port
        assert pickle.loads(pickle.dumps(kind(life=0) if port.life else kind())) == kind()
        assert max(map(len, drawing(port).splitlines())) <= 110


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_the_declarations_are_what_is_made(module: ModuleType) -> None:
    tree = ast.parse(stub(MODULES[module], "a table"))
    declared = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    made = {name: kind for name, kind in vars(module).items() if getattr(kind, "__module__", "") == module.__name__}
    assert declared.keys() == made.keys()
    for name, node in declared.items():
        kind = made[name]
        if issubclass(kind, IntEnum):
            assert [ast.unparse(each) for each in node.body] == [f"{member.name} = {member.value}" for member in kind]
        elif issubclass(kind, Telegram) and kind.__base__ is Telegram:
            rows = [ast.unparse(each) for each in node.body if isinstance(each, ast.AnnAssign)]
            assert rows == [f"{item.name}: int = {item.default}" for item in fields(kind)]


@pytest.mark.long
@pytest.mark.slow
def test_type_checkers_know_the_fields(tmp_path: Path) -> None:
    """mypy --strict, with the declarations that setup.py writes."""
    program = tmp_path / "program.py"
    program.write_text(
        "from railhil.bus.ident import PltIdent\n"
        "from railhil.wire.ato import CtlCause, TrnSpeed\n"
        "speed: int = TrnSpeed(5, life=3).speed_01mmps\n"
        "cause: int = CtlCause.SPEED_AGE\n"
        "role: int = PltIdent().role\n"
        "TrnSpeed(speed=5)\n"
    )
    make_tree(tmp_path / "tree")
    words = ["--strict", "--follow-imports=silent", "--cache-dir", str(tmp_path / "cache"), str(program)]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *words],
        env={"MYPYPATH": str(tmp_path / "tree"), "PATH": ""},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.splitlines()[0] == (
        'program.py:6: error: Unexpected keyword argument "speed" for "TrnSpeed"  [call-arg]'
    )
    assert "Found 1 error" in done.stdout
