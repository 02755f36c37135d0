"""The wire contract of a plug-in system: checked against the part common to all systems."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.common.held_code import place_of
from railhil.dbc import (
    Contract,
    ContractError,
    house_contract,
    load_contract,
    own_ports,
    system_contract,
    wire_contract,
)
from railhil.dbc.text import dbc_text, table_text

TOY = Path(__file__).parents[2] / "data" / "toy_system" / "two_carts" / "ports.toml"


SYSTEMS = [system_contract(place_of("dbc") / f"{name}.toml") for name in ("ports", "hst1", "emu3", "stop", "line")]


def changed(folder: Path, old: str, new: str) -> Path:
    """The toy's table with another text, if need be in the long form, with the ports of the house."""
    text = TOY.read_text(encoding="utf-8")
    if old not in text:
        text = table_text(system_contract(TOY))
    assert old in text
    path = folder / "ports.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def test_a_system_has_ports_of_its_own_beside_those_of_the_house() -> None:
    contract = system_contract(TOY)
    house = [port.name for port in house_contract().ports]
    assert house == ["TIME_SYNC", "SUP_CMD", "RUN_EVENT", "PLT_IDENT", "CTL_IDENT", "SUP_IDENT"]
    own = [port.name for port in contract.ports if port.name not in house]
    assert own == ["UNIT1_STAT", "UNIT2_STAT", "UNIT1_CMD", "UNIT2_CMD", "LAW_STAT", "TRUTH"]
    assert all(contract.port(port.name) == port for port in house_contract().ports)
    assert contract.clock_port.name == "UNIT1_STAT"
    assert contract.sha256 != wire_contract().sha256


@pytest.mark.parametrize("contract", [*SYSTEMS, system_contract(TOY)], ids=lambda one: one.sha256[:8])
def test_a_table_that_repeats_the_ports_of_the_house_is_the_same_contract(contract: Contract, tmp_path: Path) -> None:
    """A record keeps this form, and tables of version 0.1.0 have it."""
    path = tmp_path / "ports.toml"
    path.write_text(table_text(contract), encoding="utf-8")
    again = load_contract(path, check_dbc=False)
    assert again == contract
    assert dbc_text(again) == dbc_text(contract)
    assert system_contract(path) == contract


def test_ports_of_the_house_have_their_names_whoever_wrote_the_table(tmp_path: Path) -> None:
    """A table of version 0.1.0 names no fields and no enumerations; the exported C uses those of the house."""
    (old,) = (TOY.parents[2] / "made_by_0.1.0").rglob("ports.toml")
    path = tmp_path / "ports.toml"
    before, name, after = old.read_text(encoding="utf-8").partition('name = "PLT_IDENT"')
    path.write_text(before + name + after.replace("period_ms = 0", "period_ms = 1280", 1), encoding="utf-8")
    contract = system_contract(path)
    for house in house_contract().ports:
        port = contract.port(house.name)
        assert (port.telegram, port.layout, port.codes) == (house.telegram, house.layout, house.codes)
        names = [[(one.field_name, one.default) for one in table.signals] for table in (port, house)]
        assert names[0] == names[1]
    assert dbc_text(contract) == dbc_text(load_contract(path, check_dbc=False))


def test_railhils_own_table_is_that_of_a_system() -> None:
    assert SYSTEMS[0] == wire_contract()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('name = "SUP_IDENT"', 'name = "SUP_OTHER"', "SUP_IDENT: no such port"),
        ('"SupCommand", at = "0.7:8"', '"SupCommand", at = "0.7:7"', "SUP_CMD.signals: found another layout"),
        (
            'period_ms = 1280\nsource = "plant"\nmode = "event"',
            'period_ms = 0\nsource = "plant"\nmode = "event"',
            "PLT_IDENT.period_ms: found 0, allowed 1280, as in every system",
        ),
        ("bit_rate = 500000", "bit_rate = 250000", "bus.bit_rate: found 250000, allowed 500000"),
        ("[shared]", "[shared]\nident = []", "shared.ident: found a layout of the house, allowed another name"),
        ("address = 0x120", "address = 0x110", "UNIT1_CMD.address: found that of UNIT1_STAT"),
        ("f_code = 1\nperiod_ms = 10\n", "f_code = 2\nperiod_ms = 10\n", "UNIT1_STAT: found F2 with"),
        ("f_code = 1\nperiod_ms = 10\n", "period_ms = 10\n", "UNIT1_STAT.f_code: missing"),
        ("base_tick_ms = 10", "base_tick_ms = 20", "UNIT1_STAT.period_ms: found 10, allowed base_tick_ms = 20"),
        ("address = 0x120", "address = 'x'", "address: found 'x', allowed a whole number"),
    ],
)
def test_a_table_that_cannot_serve_is_refused_in_one_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(ContractError) as caught:
        system_contract(changed(tmp_path, old, new))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_table_extends_one_of_railhil_by_its_own_ports() -> None:
    whole, base = system_contract(place_of("dbc") / "line.toml"), wire_contract()
    assert [port for port in whole.ports if port in base.ports] == list(base.ports)
    assert {port.name for port in own_ports(whole, base)} >= {"DOOR_CMD", "ATP_STAT"}


def test_a_table_may_replace_ports_of_the_one_that_it_extends(tmp_path: Path) -> None:
    one, three = (system_contract(place_of("dbc") / f"{name}.toml") for name in ("hst1", "emu3"))
    assert [port.name for port in one.ports if port not in three.ports] == ["LAW_STAT", "TRUTH"]
    assert {port.name for port in one.ports} < {port.name for port in three.ports}
    path = changed(tmp_path, "f_code = 1", "replaces = true\nf_code = 1")
    with pytest.raises(ContractError, match="replaces: found true, allowed only for a port of the extended table"):
        system_contract(path)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("nothing.toml", "extends: found 'nothing.toml', allowed a port table of railhil: "),
        ("house.toml", "extends: found 'house.toml', allowed a port table of railhil: "),
        ("../dbc/ports.toml", "extends: found '../dbc/ports.toml', allowed a port table of railhil: "),
        ("line.toml", "extends: found 'line.toml', which extends another table"),
        ("ports.toml", "TIME_SYNC.name: found a port of ports.toml"),
    ],
)
def test_a_table_that_cannot_be_extended_is_refused_in_one_line(tmp_path: Path, name: str, said: str) -> None:
    path = tmp_path / "own.toml"
    port = table_text(house_contract()).partition("[[port]]")[2].partition("[[port]]")[0]
    own = port.replace("TIME_SYNC", "TRN_SPEED") if name == "ports.toml" else port
    path.write_text(f'extends = "{name}"\n\n[[port]]\n{own}', encoding="utf-8")
    with pytest.raises(ContractError) as caught:
        system_contract(path)
    assert said.replace("TIME_SYNC", "TRN_SPEED") in str(caught.value)
