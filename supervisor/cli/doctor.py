"""``railhil doctor``: what this machine can promise, and what each transport does not model."""

from __future__ import annotations

import argparse
import os
import platform
import socket
import sys
import time
from importlib.metadata import version
from typing import Any

import can
from can.cli import add_bus_arguments

from bus.limits import LIMITS
from bus.select import choose_bus, vcan_available
from dbc import wire_contract
from supervisor.cli.output import Output, print_json, table


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("doctor", help="what this machine and its transports can promise")
    parser.add_argument("--json", action="store_true", help="machine-readable output")
    add_bus_arguments(parser)
    parser.set_defaults(work=work)


def _kernel_can() -> str:
    if not hasattr(socket, "AF_CAN"):
        return "no (this Python has no AF_CAN)"
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError as error:
        return f"no ({error.strerror}); load can, can_raw and vcan, or use the hub"
    return (
        "yes, vcan0 is up"
        if vcan_available()
        else "yes, but no vcan0 (ip link add vcan0 type vcan; ip link set vcan0 up)"
    )


def _realtime() -> str:
    try:
        parameter = os.sched_param(os.sched_get_priority_min(os.SCHED_FIFO))
        policy, previous = os.sched_getscheduler(0), os.sched_getparam(0)
        os.sched_setscheduler(0, os.SCHED_FIFO, parameter)
        os.sched_setscheduler(0, policy, previous)
    except (OSError, AttributeError) as error:
        return f"no SCHED_FIFO ({getattr(error, 'strerror', error)}); give CAP_SYS_NICE or an rtprio limit"
    return "SCHED_FIFO permitted"


def facts(namespace: argparse.Namespace) -> dict[str, Any]:
    """Everything that the command prints, as plain values."""
    choice = choose_bus(namespace)
    clock = time.get_clock_info("monotonic")
    return {
        "railhil": version("railhil"),
        "python": f"{platform.python_version()} ({sys.executable})",
        "python-can": version("python-can"),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "cores": len(os.sched_getaffinity(0)),
        "clock": f"{clock.implementation}, resolution {clock.resolution:g} s",
        "kernel CAN": _kernel_can(),
        "realtime": _realtime(),
        "bus": f"{choice.transport} ({choice.reason})",
        "hub interface": "registered" if "railhil" in can.VALID_INTERFACES else "not registered: reinstall the package",
        "DBC sha256": wire_contract().sha256,
    }


def work(namespace: argparse.Namespace) -> int:
    """Print facts and limits."""
    found = facts(namespace)
    if namespace.json:
        print_json({**found, "limits": LIMITS})
        return 0
    console = Output()
    for key, value in found.items():
        console.say(f"{key:14} {value}")
    limits = table()
    limits.add_column("transport", no_wrap=True)
    limits.add_column("what it does not model")
    for transport, text in LIMITS.items():
        limits.add_row(transport, text)
    console.print(limits)
    return 0
