"""A port table with a wrong key or value is refused in one line that names file, port, key, found and allowed."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.dbc import ContractError
from railhil.dbc.house import system_contract

TABLE = """
[[port]]
name = "CART_STAT"
address = 0x110
f_code = 1
period_ms = 10
source = "plant"
mode = "publish"
comment = "Position"
signals = [
  { name = "CartPos", at = "0.7:16", field = "position", signed = true, scale = 0.1, unit = "m" },
  { name = "CartSpeed", at = "2.7:8", field = "speed" },
  { name = "CartChk", at = "3.7:2", check = "chk" },
  { name = "CartLife", at = "3.3:4" },
]
"""


def test_the_table_is_good(tmp_path: Path) -> None:
    path = tmp_path / "ports.toml"
    path.write_text(TABLE)
    assert system_contract(path).port("CART_STAT").signal("CartPos").field_name == "position"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('unit = "m"', 'units = "m"', "CART_STAT.CartPos.units: found an unknown key"),
        ("signed = true", 'signed = "no"', "CART_STAT.CartPos.signed: found 'no', allowed true or false"),
        ("scale = 0.1", "scale = 0", "CART_STAT.CartPos.scale: found 0,"),
        ("scale = 0.1", "scale = inf", "CART_STAT.CartPos.scale: found inf,"),
        ("scale = 0.1", "scale = true", "CART_STAT.CartPos.scale: found True,"),
        ('check = "chk"', 'check = "crc"', "CART_STAT.CartChk.check: found 'crc'"),
        ('field = "speed"', 'field = "position"', "CART_STAT.CartSpeed.field: found 'position' twice"),
        ('field = "speed"', 'field = "9 a"', "CART_STAT.CartSpeed.field: found '9 a'"),
        ('field = "speed"', 'field = "class"', "CART_STAT.CartSpeed.field: found 'class'"),
        ('"CART_STAT"', '"CART STAT"', "CART STAT.name: found 'CART STAT'"),
        ('"CART_STAT"', '"CTL_IDENT"', "CTL_IDENT.name: found a port of the bench"),
        ("[[port]]", "[[ports]]", "ports: found an unknown key, allowed port"),
        ("period_ms = 10", "period_ms = 0", "CART_STAT.period_ms: found 0"),
        ("comment =", "coment =", "CART_STAT.coment: found an unknown key"),
        ("address = 0x110", 'address = "x"', "CART_STAT.address: found 'x', allowed a whole number"),
        ("address = 0x110", "address = 0x108", "CART_STAT.address: found that of SUP_CMD"),
        ("f_code = 1\n", "", "CART_STAT.f_code: missing"),
        ('"CartLife"', '"CartLive"', "CART_STAT: found F1 with no life sign"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = tmp_path / "ports.toml"
    assert old in TABLE
    path.write_text(TABLE.replace(old, new))
    with pytest.raises(ContractError) as error:
        system_contract(path)
    assert str(error.value).startswith(f"ports.toml: {said}")
    assert "\n" not in str(error.value)
