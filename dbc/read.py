"""Reads a port table ``ports.toml``: of this installation, of a record, or of a system.

The table is the single source: telegram classes check their fields against it, ``railhil.dbc`` is written from it, and
the nodes compare its DBC's SHA-256 before a run.
"""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from railhil.dbc.contract import (
    ANTIVALENT_VALUES,
    CHECK_CORRECT,
    CHECK_VALUES,
    DATA_BITS,
    DBC,
    HOUSE,
    PORTS,
    Contract,
    ContractError,
    Port,
    Signal,
    snake_case,
)
from railhil.dbc.table_keys import check_table
from railhil.dbc.text import dbc_text, table_text

_FOLDER = Path(__file__).parent
_AT = re.compile(r"^(\d+)\.([0-7]):(\d+)$")


def _camel_case(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def _field(name: str, check: str, is_only_check: bool) -> str:
    """Field of a telegram class for a signal whose table does not name one: ``life``, ``check``, or its name."""
    if name.endswith("Life"):
        return "life"
    if check == "chk" and is_only_check:
        return "check"
    return snake_case(name.replace("{p}", ""))


def _signal(file: str, port: str, entry: Mapping[str, Any], prefix: str, is_only_check: bool) -> Signal:
    match = _AT.match(str(entry.get("at", "")))
    if match is None:
        raise ContractError(
            f"{file}: {port}.{entry.get('name')}.at: found {entry.get('at')!r}, allowed byte.msb:length"
        )
    check = entry.get("check", "")
    values = {"chk": CHECK_VALUES, "antivalent": ANTIVALENT_VALUES}.get(check) or {
        int(key): str(text) for key, text in entry.get("values", {}).items()
    }
    codes = None
    if name := entry.get("enum"):
        members = {**values, **{int(key): str(text) for key, text in entry.get("more_values", {}).items()}}
        codes = str(name), {text.upper(): key for key, text in members.items()}
    return Signal(
        name=str(entry["name"]).replace("{p}", prefix),
        byte=int(match[1]),
        msb=int(match[2]),
        length=int(match[3]),
        signed=bool(entry.get("signed", False)),
        scale=float(entry.get("scale", 1.0)),
        unit=str(entry.get("unit", "")),
        minimum=entry.get("min"),
        maximum=entry.get("max"),
        comment=str(entry.get("comment", "")),
        check=check,
        values=values,
        field_name=str(entry.get("field") or _field(str(entry["name"]), check, is_only_check)),
        default=int(entry.get("default", CHECK_CORRECT if check == "chk" else 0)),
        codes=codes,
    )


def _checked(file: str, port: Port) -> Port:
    """The port, after the rules of the CAN mapping: address grid, room, no overlap, no signal across blocks."""
    if port.address % 8 or not 0x100 <= port.address <= 0x3F8:
        raise ContractError(
            f"{file}: {port.name}.address: found {port.address:#x}, allowed multiples of 8, 0x100..0x3f8"
        )
    if port.f_code not in DATA_BITS:
        raise ContractError(f"{file}: {port.name}.f_code: found {port.f_code}, allowed 0..4")
    if port.source not in ("plant", "controller", "supervisor"):
        raise ContractError(f"{file}: {port.name}.source: found {port.source!r}, allowed plant, controller, supervisor")
    if port.mode not in ("publish", "poll", "event"):
        raise ContractError(f"{file}: {port.name}.mode: found {port.mode!r}, allowed publish, poll, event")
    taken: set[int] = set()
    fields: set[str] = set()
    for signal in port.signals:
        if signal.field_name in fields:
            raise ContractError(
                f"{file}: {port.name}.{signal.name}.field: found {signal.field_name!r} twice, allowed each once"
            )
        fields.add(signal.field_name)
        bits = set(range(signal.first_bit, signal.first_bit + signal.length))
        if bits & taken:
            raise ContractError(
                f"{file}: {port.name}.{signal.name}.at: found bits of another signal, allowed free bits"
            )
        if max(bits) >= port.data_bytes * 8 or min(bits) // 64 != max(bits) // 64:
            raise ContractError(
                f"{file}: {port.name}.{signal.name}.at: found bits {min(bits)}..{max(bits)}, "
                f"allowed inside one 64-bit block of {port.data_bytes} bytes"
            )
        taken |= bits
    return port


def load_contract(path: Path = _FOLDER / PORTS, check_dbc: bool = True) -> Contract:
    """Read the port table and, unless ``check_dbc`` is false, check it against the DBC file in the same folder.

    :raises ContractError: one line with file, key, found and allowed; also when the DBC does not match the table (a
        foreign or outdated DBC).
    """
    file = path.name
    text = _text(path)
    digest = _dbc_sha256(file, text)
    dbc_path = path.with_name(DBC)
    found = hashlib.sha256(dbc_path.read_bytes()).hexdigest() if dbc_path.exists() else "no file"
    if check_dbc and found != digest:
        raise ContractError(
            f"{dbc_path.name}: sha256: found {found[:16]}, allowed {digest[:16]} (from {file}; `make dbc` writes it)"
        )
    return replace(parsed_contract(file, text), sha256=digest)


def _read(path: Path, sha256: str, current: Contract | None = None) -> Contract:
    """The port table in a file whose DBC has this hash; usually ``current`` has it. Raises ContractError."""
    text = _text(path)
    if current is not None and current.sha256 == sha256 and text == table_text(current):
        return current
    # The table decodes the record, but the certificate has the hash of the DBC.
    if (derived := _dbc_sha256(path.name, text)) != sha256:
        allowed = f"{sha256}, that of the record: a port table that nobody changed"
        raise ContractError(f"{path}: sha256 of its DBC: found {derived}, allowed {allowed}")
    return replace(parsed_contract(path.name, text), sha256=sha256)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise ContractError(f"{path.name}: {error}") from error


@lru_cache(maxsize=4)
def parsed_contract(file: str, text: str) -> Contract:
    """The contract of a port table, without the hash of its DBC, once for each text.

    :param file: name of the file, for errors.
    :raises ContractError: one line with file, key, found and allowed.
    """
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise ContractError(f"{file}: {error}") from error
    check_table(file, table)
    try:
        return _made(file, table)
    except KeyError as error:
        raise ContractError(f"{file}: key {error}: missing, expected a value: the key is required") from None
    except (TypeError, ValueError, AttributeError) as error:
        raise ContractError(f"{file}: {error}; allowed a port table like that of railhil") from error


@lru_cache(maxsize=4)
def _dbc_sha256(file: str, text: str) -> str:
    """Hash of the DBC that belongs to a port table. Raises ContractError."""
    return hashlib.sha256(dbc_text(parsed_contract(file, text)).encode()).hexdigest()


def _made(file: str, table: Mapping[str, Any]) -> Contract:
    """The contract of a parsed port table, without the hash of its DBC; the ports of the house are added unless the
    table repeats them, and those of the table that it extends."""
    base = _base_table(file, table)
    ports = _ports(file, table, base) + _extended_ports(file, table, base)
    bus, house = {**base.get("bus", {}), **table.get("bus", {})}, _house_table()
    names = [port.name for port in ports]
    repeated = [entry["name"] for entry in house["port"] if entry["name"] in names]
    if repeated and "bit_rate" not in bus:
        allowed = "the system's own ports, or a whole table with [bus] and all ports of the bench"
        raise ContractError(f"{file}: {repeated[0]}.name: found a port of the bench, allowed {allowed}")
    if file != HOUSE and not repeated:
        if twice := sorted(table.get("shared", {}).keys() & house["shared"].keys()):
            raise ContractError(f"{file}: shared.{twice[0]}: found a layout of the house, allowed another name")
        ports += _ports(HOUSE, house)
        bus = {**house["bus"], **bus}
    return Contract(
        bit_rate=int(bus["bit_rate"]),
        poll_id=int(bus["poll_id"]),
        device_status_id=int(bus["device_status_id"]),
        base_tick_ns=int(bus["base_tick_ms"]) * 1_000_000,
        ports=tuple(sorted(ports, key=lambda port: port.address)),
        sha256="",
    )


def _base_table(file: str, table: Mapping[str, Any]) -> Mapping[str, Any]:
    """The table of railhil that a table extends; empty: it extends none.

    :raises ContractError: there is no such table, or it extends another one.
    """
    name = table.get("extends")
    if name is None:
        return {}
    base = _FOLDER / str(name)
    if base.name != name or name == HOUSE or not base.is_file():
        known = sorted(path.name for path in _FOLDER.glob("*.toml") if path.name not in (HOUSE, file))
        raise ContractError(f"{file}: extends: found {name!r}, allowed a port table of railhil: {', '.join(known)}")
    base_table = tomllib.loads(_text(base))
    if "extends" in base_table:
        raise ContractError(f"{file}: extends: found {name!r}, which extends another table, allowed one that does not")
    return base_table


def _extended_ports(file: str, table: Mapping[str, Any], base: Mapping[str, Any]) -> list[Port]:
    """The ports of the extended table that are not replaced.

    :raises ContractError: a port is in both, or replaces none.
    """
    own = {str(entry["name"]): bool(entry.get("replaces")) for entry in table["port"]}
    ports = _ports(table["extends"], base) if base else []
    known = {port.name for port in ports}
    for port, replaces in own.items():
        if port in known and not replaces:
            allowed = "another name, or replaces = true"
            raise ContractError(f"{file}: {port}.name: found a port of {table['extends']}, allowed {allowed}")
        if replaces and port not in known:
            raise ContractError(f"{file}: {port}.replaces: found true, allowed only for a port of the extended table")
    return [port for port in ports if port.name not in own]


@cache
def _house_table() -> Mapping[str, Any]:
    return tomllib.loads((_FOLDER / HOUSE).read_text(encoding="utf-8"))


def _ports(file: str, table: Mapping[str, Any], base: Mapping[str, Any] | None = None) -> list[Port]:
    """The ports of a parsed port table, in its order.

    :param base: the table that it extends, whose shared layouts it may name.
    """
    ports: list[Port] = []
    shared = {**(base or {}).get("shared", {}), **table.get("shared", {})}
    for entry in table["port"]:
        name = str(entry["name"])
        entries, layout = entry["signals"], ""
        if isinstance(entries, str):
            layout, entries = _camel_case(entries), shared[entries]
        prefix = name.split("_")[0].capitalize()
        is_only_check = [item.get("check") for item in entries].count("chk") == 1
        port = Port(
            name=name,
            address=int(entry["address"]),
            f_code=int(entry["f_code"]),
            period_ns=int(entry["period_ms"]) * 1_000_000,
            source=str(entry["source"]),
            mode=str(entry["mode"]),
            comment=str(entry["comment"]),
            signals=tuple(_signal(file, name, item, prefix, is_only_check) for item in entries),
            optional=bool(entry.get("optional", False)),
            telegram=str(entry.get("telegram") or _camel_case(name)),
            layout=layout,
        )
        ports.append(_checked(file, port))
    return ports


def recorded_contract(folder: Path, sha256: str | None, current: Contract) -> Contract:
    """The contract with which a record was made: from its folder, else this version's, else an earlier one's.

    :param folder: run folder; its port table and DBC, if it has them, are :data:`PORTS` and :data:`DBC`.
    :param sha256: of the DBC, from the certificate; None if unknown.
    :param current: today's contract of the record's system.
    :raises ContractError: the folder's DBC has another hash, its port table another DBC, or no version of railhil had
        the requested one.
    """
    if (folder / PORTS).is_file() and (folder / DBC).is_file():
        found = hashlib.sha256((folder / DBC).read_bytes()).hexdigest()
        if sha256 not in (None, found):
            raise ContractError(f"{folder / DBC}: sha256: found {found}, allowed {sha256}, as in the certificate")
        return _read(folder / PORTS, found, current)
    if sha256 in (None, current.sha256):
        return current
    earlier = _FOLDER / "history" / f"{sha256}.toml"
    if not earlier.is_file():
        allowed = f"one of a version of railhil, or {PORTS} and {DBC} in the folder"
        raise ContractError(f"{folder}: DBC: found sha256 {sha256}, allowed {allowed}")
    return _read(earlier, str(sha256))


@cache
def wire_contract() -> Contract:
    """The contract of this installation, loaded at first use (so that a broken file is reported by the command)."""
    return load_contract()
