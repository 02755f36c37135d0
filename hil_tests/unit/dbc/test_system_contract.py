"""The wire contract of a plug-in system: checked against the part common to all systems."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.dbc import HOUSE_PORTS, ContractError, system_contract, wire_contract

TOY = Path(__file__).parents[2] / "data" / "toy_system" / "two_carts" / "ports.toml"


def changed(folder: Path, old: str, new: str) -> Path:
    text = TOY.read_text(encoding="utf-8")
    assert old in text
    path = folder / "ports.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def test_a_system_has_ports_of_its_own_beside_those_of_the_house() -> None:
    contract = system_contract(TOY)
    own = [port.name for port in contract.ports if port.name not in HOUSE_PORTS]
    assert own == ["UNIT1_STAT", "UNIT2_STAT", "UNIT1_CMD", "UNIT2_CMD", "LAW_STAT", "TRUTH"]
    assert contract.clock_port.name == "UNIT1_STAT"
    assert contract.sha256 != wire_contract().sha256


def test_railhils_own_table_is_that_of_a_system() -> None:
    from railhil import dbc

    assert system_contract(Path(dbc.__file__).with_name("ports.toml")).sha256 == wire_contract().sha256


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('name = "SUP_IDENT"', 'name = "SUP_OTHER"', "SUP_IDENT: found no such port"),
        ('"SupCommand", at = "0.7:8"', '"SupCommand", at = "0.7:7"', "SUP_CMD.signals: found another layout"),
        (
            'period_ms = 1280\nsource = "plant"\nmode = "event"',
            'period_ms = 0\nsource = "plant"\nmode = "event"',
            "PLT_IDENT.period_ms: found 0, allowed 1280, as in every system",
        ),
        ("bit_rate = 500000", "bit_rate = 250000", "bus.bit_rate: found 250000, allowed 500000"),
        ("address = 0x120", "address = 0x110", "UNIT1_CMD.address: found that of UNIT1_STAT"),
        ("f_code = 1\nperiod_ms = 10\n", "f_code = 2\nperiod_ms = 10\n", "UNIT1_STAT: found F2, allowed F1"),
        ("f_code = 1\nperiod_ms = 10\n", "period_ms = 10\n", "key 'f_code': found nothing"),
        ("address = 0x120", "address = 'x'", "invalid literal"),
    ],
)
def test_a_table_that_cannot_serve_is_refused_in_one_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(ContractError) as caught:
        system_contract(changed(tmp_path, old, new))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
