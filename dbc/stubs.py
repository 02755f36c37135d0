"""Declarations of the telegram classes for type checkers and editors, in a stub beside each module with them.

The classes are made from a port table when a program imports their module (:mod:`railhil.bus.made`). ``setup.py``
writes the stubs from the same tables; they are not in git.
"""

from __future__ import annotations

import textwrap
import tomllib
from collections.abc import Iterable
from pathlib import Path

from railhil.dbc.contract import HOUSE, PORTS, Port, Signal
from railhil.dbc.drawing import described
from railhil.dbc.house import house_contract, own_ports, system_contract

#: Stub -> the table with the ports of its module.
_TABLES = {
    "bus/telegrams.pyi": HOUSE,
    "railhil/wire/ato.pyi": PORTS,
    "railhil/wire/high_speed.pyi": "hst1.toml",
    "railhil/wire/line.pyi": "line.toml",
    "railhil/wire/stop.pyi": "stop.toml",
}


def write_stubs(root: Path) -> None:
    """Write the stubs that differ from their tables.

    :param root: folder with ``bus/`` and ``railhil/``.
    :raises ContractError: a table is unusable.
    """
    for name, table in _TABLES.items():
        path, place = root / name, Path(__file__).with_name(table)
        text = stub(_ports_of(place), table)
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _ports_of(table: Path) -> Iterable[Port]:
    """The ports whose telegrams the module of a table has: not those of the house, nor of a table that it extends."""
    if table.name == HOUSE:
        return house_contract().ports
    base = tomllib.loads(table.read_text(encoding="utf-8")).get("extends")
    extended = None if base is None else system_contract(table.with_name(base))
    return own_ports(system_contract(table), extended)


def stub(ports: Iterable[Port], table: str) -> str:
    """The stub of a module with the telegram classes of these ports and their enumerations.

    :param table: name of the file of their table.
    """
    parts: dict[str, str] = {}
    for port in ports:
        for name, members in port.codes.items():
            rows = "".join(f"    {member} = {code}\n" for member, code in members.items())
            parts[name] = f"class {name}(IntEnum):\n{rows}"
        if port.layout:
            parts.setdefault(port.layout, _class(port.layout, "Telegram", described(port), port.signals))
        fields = () if port.layout else port.signals
        parts[port.telegram] = _class(port.telegram, port.layout or "Telegram", described(port), fields)
    head = (
        f"# Written from {table} by setup.py; not in git.\n"
        "from dataclasses import dataclass\nfrom enum import IntEnum\n\nfrom railhil.bus.layout import Telegram\n"
    )
    return "\n".join([head, *parts.values()])


def _class(name: str, base: str, text: str, signals: Iterable[Signal]) -> str:
    body = f'"""{text}"""\n' + "".join(f"{signal.field_name}: int = {signal.default}\n" for signal in signals)
    return f"@dataclass(slots=True)\nclass {name}({base}):\n{textwrap.indent(body, '    ')}"
