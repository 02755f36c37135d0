"""The part that is common to the wire contracts of all systems, and its check."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

from railhil.dbc.contract import PORTS, Contract, ContractError, Port
from railhil.dbc.read import load_contract, wire_contract

#: Ports that every system has with the same layout: clock, orders, milestones and handshake of the bench itself.
HOUSE_PORTS = ("TIME_SYNC", "SUP_CMD", "RUN_EVENT", "PLT_IDENT", "CTL_IDENT", "SUP_IDENT")


def house_table() -> str:
    """What is the same in the port table of every system, as text: ``[bus]``, :data:`HOUSE_PORTS`, what they share.

    It is cut out of our own table when it is asked for.
    """
    tables = re.split(r"(?m)^(?=\[)", Path(__file__).with_name(PORTS).read_text(encoding="utf-8"))[1:]
    return "".join(
        text
        for text in tables
        if not text.startswith("[[port]]") or tomllib.loads(text)["port"][0]["name"] in HOUSE_PORTS
    )


def _check_same(file: str, port: Port, house: Port) -> None:
    """Whether a port of the bench is as in every system; what its comments say is free.

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


@cache
def system_contract(path: Path) -> Contract:
    """The contract of a system from its port table; the DBC is made from the table and need not exist as a file.

    The bench's own ports (:data:`HOUSE_PORTS`) and the identifiers of its polls are the same in every system, and the
    plant's fastest port opens every tick: one frame with its life sign in the last four bits.

    :raises ContractError: one line with file, key, found and allowed.
    """
    contract, house = load_contract(path, check_dbc=False), wire_contract()
    file = path.name
    for key in ("bit_rate", "poll_id", "device_status_id"):
        if getattr(contract, key) != getattr(house, key):
            raise ContractError(
                f"{file}: bus.{key}: found {getattr(contract, key)}, allowed {getattr(house, key)}, as in every system"
            )
    taken: dict[int, str] = {}
    for port in contract.ports:
        if port.address in taken:
            raise ContractError(
                f"{file}: {port.name}.address: found that of {taken[port.address]}, allowed one of its own"
            )
        taken[port.address] = port.name
    names = set(taken.values())
    if len(names) < len(contract.ports):
        raise ContractError(f"{file}: port.name: found one twice, allowed each once")
    for name in HOUSE_PORTS:
        if name not in names:
            raise ContractError(f"{file}: {name}: found no such port, allowed a table with the ports of every system")
        _check_same(file, contract.port(name), house.port(name))
    if not any(port.source == "plant" and port.mode == "publish" and port.period_ns for port in contract.ports):
        raise ContractError(f"{file}: port: found none that the plant publishes, allowed at least one")
    clock = contract.clock_port
    if clock.f_code != 1 or not any((s.byte, s.msb, s.length) == (3, 3, 4) for s in clock.signals):
        raise ContractError(
            f"{file}: {clock.name}: found F{clock.f_code}, allowed F1 with a life sign at 3.3:4: it opens every tick"
        )
    return contract
