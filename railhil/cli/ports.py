"""``railhil ports``: the wire contract - ports, layouts, bus load; its DBC; the check of a user's DBC against it."""

from __future__ import annotations

import argparse
from math import fsum
from pathlib import Path
from typing import Any

from railhil.bus.can_settings import BITRATE_HELP
from railhil.bus.schedule import bus_load
from railhil.common.errors import InputError, Words
from railhil.common.output import Output, number, table, whole
from railhil.common.streams import add_json_argument, print_json
from railhil.common.user_files import given_text, refuse_unreadable, refuse_unwritable, whole_file
from railhil.dbc import Contract, Port
from railhil.dbc.text import dbc_text
from railhil.record.hash_list import check_free
from railhil.scenarios.options import add_option
from railhil.scenarios.system import DEFAULT, system_named

#: Terminal width from which the table has a column with each port's purpose.
_DESCRIBED_COLUMNS = 90


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "ports",
        examples=[
            "railhil ports",
            "railhil ports TRN_SPEED",
            "railhil ports --system hst1 --write-dbc hst1.dbc",
        ],
    )
    parser.add_argument("port", nargs="?", metavar="PORT", help="port whose layout is wanted")
    said = f"{BITRATE_HELP}, for the load (default: that of the port table)"
    parser.add_argument("-b", "--bitrate", type=int, metavar="BPS", help=said)
    parser.add_argument("--system", default=DEFAULT, metavar="NAME", help=f"of which system (default: {DEFAULT})")
    add_option(parser, "--dbc")
    parser.add_argument("--write-dbc", metavar="FILE", type=Path, help="write the DBC, for cantools and other tools")
    add_json_argument(parser)


def _port(contract: Contract, name: str) -> Port:
    try:
        return contract.port(name.upper())
    except KeyError:
        allowed = ", ".join(port.name for port in contract.ports)
        raise InputError("command line", "port", name, allowed) from None


def work(namespace: argparse.Namespace) -> int:
    """Print the requested table or layout."""
    contract = system_named(namespace.system, "command line").contract
    bit_rate = contract.bit_rate if namespace.bitrate is None else namespace.bitrate
    if bit_rate <= 0:
        raise InputError("command line", "--bitrate", namespace.bitrate, "bit/s above 0")
    if namespace.dbc:
        check_foreign_dbc(namespace.dbc, contract)
    if namespace.write_dbc is not None:
        check_free("--write-dbc", namespace.write_dbc)
        with refuse_unwritable("--write-dbc", namespace.write_dbc, "file"), whole_file(namespace.write_dbc) as draft:
            draft.write_text(dbc_text(contract), "utf-8")
    loads = bus_load(contract, bit_rate)
    chosen = [_port(contract, namespace.port)] if namespace.port else list(contract.ports)
    if namespace.json:
        print_json(_document(contract, chosen, bit_rate, loads))
        return 0
    console = Output()
    _print_ports(console, chosen, loads)
    if namespace.port:
        _print_layout(console, chosen[0])
        return 0
    total, optional = _usual(contract, loads), [port.name for port in contract.ports if port.optional]
    console.say(f"load at {bit_rate / 1000:g} kbit/s, longest stuffing: {total:.1%} (limit 40 %)")
    if optional:
        console.say(f"load in scenarios that use {', '.join(optional)}: {fsum(loads.values()):.1%}")
    console.say(f"DBC sha256 {contract.sha256}")
    if namespace.dbc:
        console.say(f"{namespace.dbc}: describes these telegrams")
    return 0


def _usual(contract: Contract, loads: dict[str, float]) -> float:
    """Load of the ports that every run uses."""
    return fsum(loads[port.name] for port in contract.ports if not port.optional)


def _document(contract: Contract, ports: list[Port], bit_rate: int, loads: dict[str, float]) -> dict[str, object]:
    return {
        "bit_rate": bit_rate,
        "load": _usual(contract, loads),
        "load_with_optional": fsum(loads.values()),
        "dbc_sha256": contract.sha256,
        "ports": [
            {
                "name": port.name,
                "address": port.address,
                "can_ids": list(port.can_ids),
                "f_code": port.f_code,
                "period_ms": port.period_ns // 1_000_000,
                "source": port.source,
                "mode": port.mode,
                "optional": port.optional,
                "load": loads[port.name],
                "signals": [
                    {
                        "name": signal.name,
                        "at": f"{signal.byte}.{signal.msb}:{signal.length}",
                        "signed": signal.signed,
                        "scale": signal.scale,
                        "unit": signal.unit,
                    }
                    for signal in port.signals
                ],
            }
            for port in ports
        ],
    }


def _print_ports(console: Output, ports: list[Port], loads: dict[str, float]) -> None:
    # Without room for it, `railhil ports PORT` and the DBC still give the purpose of a port.
    described = console.width >= _DESCRIBED_COLUMNS
    rows = table(whole("port"), whole("id"), "CAN ids", whole("F"), number("ms"), whole("source"), whole("mode"),
                 number("load"), *(["what"] if described else []))  # fmt: skip
    for port in ports:
        cells = [
            port.name,
            f"{port.address:03X}",
            " ".join(f"{can_id:03X}" for can_id in port.can_ids),
            str(port.f_code),
            f"{port.period_ns // 1_000_000}" if port.period_ns else "-",
            port.source,
            port.mode,
            f"{loads[port.name]:.2%}",
        ]
        rows.add_row(*cells, *([port.comment] if described else []))
    console.print(rows)


def _print_layout(console: Output, port: Port) -> None:
    console.say(port.comment)
    rows = table(*map(whole, ("signal", "at", "type", "scale", "unit")), "values or meaning")
    for signal in port.signals:
        values = ", ".join(f"{key} {text}" for key, text in signal.values.items())
        kind = f"{'s' if signal.signed else 'u'}{signal.length}"
        at = f"{signal.byte}.{signal.msb}:{signal.length}"
        rows.add_row(signal.name, at, kind, f"{signal.scale:g}", signal.unit, values or signal.comment)
    console.print(rows)
    console.say("at: byte.msb:length")


def _load(path: Path) -> Any:
    # Imported here, because no other command needs it, and it takes a sixth of a second.
    import cantools

    with refuse_unreadable(path, "a DBC file"):
        text = given_text(path, "cp1252", "replace")
    try:
        return cantools.database.load_string(text, database_format="dbc")
    except Exception as error:
        # The file may contain anything; with any exception of the parser it is not a usable DBC.
        reason = " ".join(str(error).split()).removeprefix('DBC: "').removesuffix('"') or type(error).__name__
        raise InputError(path, "", Words("cannot be read"), "a DBC file", reason[:200]) from None


def _layout(message: Any) -> dict[str, dict[str, Any]]:
    return {
        signal.name: {
            "start bit": signal.start,
            "length": signal.length,
            "byte order": signal.byte_order,
            "signed": signal.is_signed,
            "scale": signal.scale,
            "offset": signal.offset,
            "unit": signal.unit or "",
        }
        for signal in message.signals
    }


def check_foreign_dbc(file: str, contract: Contract) -> None:
    """Compare a DBC file with a wire contract, message by message; additional messages are allowed.

    :raises InputError: first difference, one line.
    """
    path = Path(file)
    theirs = {(message.frame_id, message.is_extended_frame): message for message in _load(path).messages}
    import cantools

    ours: Any = cantools.database.load_string(dbc_text(contract), database_format="dbc")
    for message in ours.messages:
        other = theirs.get((message.frame_id, message.is_extended_frame))
        key = f"message {message.name} ({message.frame_id:#05x})"
        if other is None:
            raise InputError(path, key, Words(), "the telegrams of `railhil ports`")
        if other.length != message.length:
            raise InputError(path, f"{key}: length", other.length, f"{message.length} bytes")
        wanted, found = _layout(message), _layout(other)
        for name in sorted(wanted.keys() | found.keys()):
            if name not in found or name not in wanted:
                present = Words("missing" if name in wanted else "one signal more")
                raise InputError(path, f"{key}: signal {name}", present, "the layout of `railhil ports`")
            for item, value in wanted[name].items():
                if found[name][item] != value:
                    raise InputError(path, f"{key}: signal {name}: {item}", found[name][item], repr(value))
