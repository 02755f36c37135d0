"""``railhil ports``: the wire contract - ports, layouts and the load that they put on the bus."""

from __future__ import annotations

import argparse
import json

from rich.console import Console
from rich.table import Table

from bus.load import bus_load
from dbc import Port, wire_contract
from scenarios.errors import InputError
from supervisor.cli.dbcfile import check_foreign_dbc


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("ports", help="print ports, telegram layouts and bus load")
    parser.add_argument("port", nargs="?", help="port whose layout is wanted")
    parser.add_argument("-b", "--bitrate", type=int, default=0, help="bit/s for the load (default: the port table's)")
    parser.add_argument("--dbc", metavar="FILE", help="check that a DBC file describes the same telegrams")
    parser.add_argument("--json", action="store_true", help="machine-readable output")
    parser.set_defaults(work=work)


def _port(name: str) -> Port:
    try:
        return wire_contract().port(name.upper())
    except KeyError:
        allowed = ", ".join(port.name for port in wire_contract().ports)
        raise InputError("command line", "port", name, allowed) from None


def work(namespace: argparse.Namespace) -> int:
    """Print what was asked for."""
    contract = wire_contract()
    bit_rate = namespace.bitrate or contract.bit_rate
    if bit_rate <= 0:
        raise InputError("command line", "--bitrate", namespace.bitrate, "bit/s above 0")
    if namespace.dbc:
        check_foreign_dbc(namespace.dbc)
    loads = bus_load(contract, bit_rate)
    chosen = [_port(namespace.port)] if namespace.port else list(contract.ports)
    if namespace.json:
        print(json.dumps(_document(chosen, bit_rate, loads), indent=2))
        return 0
    console = Console()
    _print_ports(console, chosen, loads)
    if namespace.port:
        _print_layout(console, chosen[0])
        return 0
    total = sum(loads.values())
    console.print(f"load at {bit_rate / 1000:g} kbit/s, longest stuffing: {total:.1%} (limit 40 %)", highlight=False)
    console.print(f"DBC sha256 {contract.sha256}", highlight=False)
    return 0


def _document(ports: list[Port], bit_rate: int, loads: dict[str, float]) -> dict[str, object]:
    return {
        "bit_rate": bit_rate,
        "load": sum(loads.values()),
        "dbc_sha256": wire_contract().sha256,
        "ports": [
            {
                "name": port.name,
                "address": port.address,
                "can_ids": list(port.can_ids),
                "f_code": port.f_code,
                "period_ms": port.period_ns // 1_000_000,
                "source": port.source,
                "mode": port.mode,
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


def _print_ports(console: Console, ports: list[Port], loads: dict[str, float]) -> None:
    table = Table("port", "address", "CAN ids", "F", "period ms", "source", "mode", "load", "what")
    for port in ports:
        period = f"{port.period_ns // 1_000_000}" if port.period_ns else "-"
        ids = " ".join(f"{can_id:03X}" for can_id in port.can_ids)
        table.add_row(
            port.name,
            f"{port.address:03X}",
            ids,
            str(port.f_code),
            period,
            port.source,
            port.mode,
            f"{loads[port.name]:.2%}",
            port.comment,
        )
    console.print(table)


def _print_layout(console: Console, port: Port) -> None:
    table = Table("signal", "byte.msb:length", "type", "scale", "unit", "values or meaning")
    for signal in port.signals:
        values = ", ".join(f"{key} {text}" for key, text in signal.values.items())
        kind = f"{'s' if signal.signed else 'u'}{signal.length}"
        at = f"{signal.byte}.{signal.msb}:{signal.length}"
        table.add_row(signal.name, at, kind, f"{signal.scale:g}", signal.unit, values or signal.comment)
    console.print(table)
