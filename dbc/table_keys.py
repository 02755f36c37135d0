"""The keys of a port table, and the values allowed for each."""

from __future__ import annotations

import keyword
import math
from collections.abc import Mapping
from typing import Any

from railhil.dbc.contract import ContractError

_TEXT, _WHOLE, _NUMBER, _FLAG = "a text", "a whole number", "a number", "true or false"
_TABLE, _TABLES, _LAYOUT = "a table", "a list of tables", "a list of signals, or the name of a shared one"
_KINDS: Mapping[str, tuple[type, ...]] = {
    _TEXT: (str,),
    _WHOLE: (int,),
    _NUMBER: (int, float),
    _FLAG: (bool,),
    _TABLE: (dict,),
    _TABLES: (list,),
    _LAYOUT: (list, str),
}
#: Required keys, and optional ones.
_OF_TABLE = {"port": _TABLES}, {"bus": _TABLE, "shared": _TABLE, "extends": _TEXT}
_OF_PORT = (
    {
        "name": _TEXT,
        "address": _WHOLE,
        "f_code": _WHOLE,
        "period_ms": _WHOLE,
        "source": _TEXT,
        "mode": _TEXT,
        "comment": _TEXT,
        "signals": _LAYOUT,
    },
    {"optional": _FLAG, "telegram": _TEXT, "replaces": _FLAG},
)
_OF_SIGNAL = (
    {"name": _TEXT, "at": _TEXT},
    {
        "signed": _FLAG,
        "scale": _NUMBER,
        "unit": _TEXT,
        "min": _NUMBER,
        "max": _NUMBER,
        "comment": _TEXT,
        "check": _TEXT,
        "values": _TABLE,
        "more_values": _TABLE,
        "enum": _TEXT,
        "field": _TEXT,
        "default": _WHOLE,
    },
)
_CHECKS = ("chk", "antivalent")


def check_table(file: str, table: Mapping[str, Any]) -> None:
    """Check the keys of a parsed port table and the values of each by itself.

    :raises ContractError: one line with file, key, found and allowed.
    """
    _check_keys(f"{file}: ", table, _OF_TABLE)
    for number, port in enumerate(table["port"], 1):
        where = f"{file}: {_named(port, f'port {number}')}"
        _check_keys(f"{where}.", port, _OF_PORT)
        _check_identifier(f"{where}.name", port["name"])
        if "telegram" in port:
            _check_identifier(f"{where}.telegram", port["telegram"])
        if port["period_ms"] < 0 or (port["mode"] == "publish" and port["period_ms"] == 0):
            raise ContractError(f"{where}.period_ms: found {port['period_ms']}, allowed more than 0 if it is published")
        if isinstance(port["signals"], list):
            _check_signals(where, port["signals"])
    for name, signals in table.get("shared", {}).items():
        if not isinstance(signals, list):
            raise ContractError(f"{file}: shared.{name}: found {signals!r}, allowed a list of signals")
        _check_signals(f"{file}: shared.{name}", signals)


def _check_signals(where: str, signals: list[Any]) -> None:
    for number, signal in enumerate(signals, 1):
        place = f"{where}.{_named(signal, f'signal {number}')}"
        _check_keys(f"{place}.", signal, _OF_SIGNAL)
        if signal.get("check", _CHECKS[0]) not in _CHECKS:
            raise ContractError(f"{place}.check: found {signal['check']!r}, allowed {', '.join(_CHECKS)}")
        scale = signal.get("scale", 1)
        if not scale or not math.isfinite(scale):
            raise ContractError(f"{place}.scale: found {scale}, allowed a number other than 0")
        if "field" in signal:
            _check_identifier(f"{place}.field", signal["field"])


def _named(entry: Any, otherwise: str) -> str:
    name = entry.get("name") if isinstance(entry, dict) else None
    return name if isinstance(name, str) and name else otherwise


def _check_identifier(where: str, name: str) -> None:
    if not name.isidentifier() or keyword.iskeyword(name):
        raise ContractError(f"{where}: found {name!r}, allowed letters, digits and _, no word of Python")


def _check_keys(where: str, entry: Any, keys: tuple[Mapping[str, str], Mapping[str, str]]) -> None:
    required, others = keys
    if not isinstance(entry, dict):
        raise ContractError(f"{where.rstrip('.')}: found {entry!r}, allowed a table")
    kinds = {**required, **others}
    for key, value in entry.items():
        if key not in kinds:
            raise ContractError(f"{where}{key}: found an unknown key, allowed {', '.join(kinds)}")
        # In Python a truth value is a whole number, too.
        if not isinstance(value, _KINDS[kinds[key]]) or (isinstance(value, bool) and kinds[key] != _FLAG):
            raise ContractError(f"{where}{key}: found {value!r}, allowed {kinds[key]}")
    for key in required:
        if key not in entry:
            raise ContractError(f"{where}{key}: missing, expected {kinds[key]}: the key is required")
