"""The part that is common to the wire contracts of all systems, and its check."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from railhil.dbc.contract import HOUSE, Contract, ContractError, Port
from railhil.dbc.read import load_contract, parsed_contract


@cache
def house_contract() -> Contract:
    """The contract of the bench alone: the ports that every system has. Its hash is empty because no run has it."""
    return parsed_contract(HOUSE, Path(__file__).with_name(HOUSE).read_text(encoding="utf-8"))


def own_ports(contract: Contract, base: Contract | None = None) -> list[Port]:
    """The ports of a system beside the ports of the house.

    :param base: the contract that it extends, whose ports are not its own either.
    """
    others = {port.name for port in (base or house_contract()).ports}
    return [port for port in contract.ports if port.name not in others]


def _check_same(file: str, port: Port, house: Port) -> None:
    """Check that a port of the bench is as in every system; its comments are free.

    :raises ContractError: it is not.
    """
    for key in ("address", "f_code", "period_ns", "source", "mode", "optional"):
        found, allowed = getattr(port, key), getattr(house, key)
        if found != allowed:
            if key == "period_ns":
                key, found, allowed = "period_ms", found // 10**6, allowed // 10**6
            raise ContractError(f"{file}: {port.name}.{key}: found {found}, allowed {allowed}, as in every system")
    layouts = [[replace(signal, comment="") for signal in one.signals] for one in (port, house)]
    if layouts[0] != layouts[1]:
        raise ContractError(f"{file}: {port.name}.signals: found another layout, allowed that of every system")


def _name_as_house(port: Port, house: Port) -> Port:
    """A port of the bench with its own comments, and the names of the house for its telegram, fields and enumerations:
    a table of version 0.1.0 has none."""
    signals = tuple(replace(one, comment=own.comment) for own, one in zip(port.signals, house.signals, strict=True))
    return replace(port, signals=signals, telegram=house.telegram, layout=house.layout)


@cache
def system_contract(path: Path) -> Contract:
    """The contract of a system from its port table; the DBC is made from the table and need not exist as a file.

    The ports of the house (:func:`house_contract`) and the identifiers of its polls are the same in every system; the
    table need not contain them. The plant's fastest port opens every tick: one frame with its life sign in the last
    four bits.

    :raises ContractError: one line with file, key, found and allowed.
    """
    contract, house = load_contract(path, check_dbc=False), house_contract()
    file = path.name
    for key in ("bit_rate", "poll_id", "device_status_id"):
        if getattr(contract, key) != getattr(house, key):
            raise ContractError(
                f"{file}: bus.{key}: found {getattr(contract, key)}, allowed {getattr(house, key)}, as in every system"
            )
    taken: dict[int, str] = {}
    for port in contract.ports:
        if port.address in taken:
            # The port of the bench keeps its address.
            own, other = sorted((port.name, taken[port.address]), key={one.name for one in house.ports}.__contains__)
            raise ContractError(f"{file}: {own}.address: found that of {other}, allowed one of its own")
        taken[port.address] = port.name
    names = set(taken.values())
    if len(names) < len(contract.ports):
        raise ContractError(f"{file}: port.name: found one twice, allowed each once")
    ports = {port.name: port for port in contract.ports}
    for port in house.ports:
        if port.name not in names:
            allowed = "a table with all ports of the house, or without any"
            raise ContractError(f"{file}: {port.name}: no such port, expected {allowed}")
        _check_same(file, ports[port.name], port)
        ports[port.name] = _name_as_house(ports[port.name], port)
    if not any(port.source == "plant" and port.mode == "publish" and port.period_ns for port in contract.ports):
        raise ContractError(f"{file}: port: found none that the plant publishes, allowed at least one")
    clock = contract.clock_port
    life = clock.life
    if clock.f_code != 1 or life is None or (life.byte, life.msb, life.length) != (3, 3, 4):
        found = f"F{clock.f_code} with {'no life sign' if life is None else f'{life.name} at {life.byte}.{life.msb}'}"
        allowed = "F1 with a life sign (a name that ends in Life) at 3.3:4: it opens every tick"
        raise ContractError(f"{file}: {clock.name}: found {found}, allowed {allowed}")
    if clock.period_ns != contract.base_tick_ns:
        found, allowed = (f"{ns / 1e6:g}" for ns in (clock.period_ns, contract.base_tick_ns))
        raise ContractError(
            f"{file}: {clock.name}.period_ms: found {found}, allowed base_tick_ms = {allowed}: it opens every tick"
        )
    return replace(contract, ports=tuple(ports.values()))
