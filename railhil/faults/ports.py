"""The ports at which a fault of a telegram or a command acts, and their life signs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from railhil.dbc import Contract, Port, Signal
from railhil.faults.model import Fault
from railhil.faults.truth import Truth

#: Ports of the bench itself, by which it observes and judges.
_BENCH = frozenset(("RUN_EVENT", "SUP_CMD", "PLT_IDENT", "CTL_IDENT", "SUP_IDENT"))


def instruments(truth: Truth | None) -> frozenset[str]:
    """Names of the ports that no fault touches: those of the bench, and the truth of the system."""
    return _BENCH if truth is None else _BENCH | {truth.port, *truth.beside}


def port_names(fault: Fault, contract: Contract, units: Sequence[str], named: Mapping[str, str]) -> list[str]:
    """Names of the ports of a fault of a telegram or a command; they need not exist.

    With units the fault names what follows the unit in the names of their ports.

    :param units: first words of the ports of each unit.
    :param named: commands by name, each ``PORT.Signal``.
    """
    place = fault.place
    name = named.get(place.name, "").partition(".")[0] if place.level == "command" else place.name
    if not units or any(port.name == name for port in contract.ports):
        return [name]
    chosen = [units[number - 1] for number in fault.units if number <= len(units)] if fault.units else units
    return [f"{unit}_{name}" for unit in chosen]


def signal_of(fault: Fault, named: Mapping[str, str]) -> str:
    """Name of the signal that a fault changes; empty if it is none."""
    place = fault.place
    if place.level == "command":
        return named.get(place.name, "").partition(".")[2]
    return "" if place.part in ("counter", "checksum") else place.part


def life_signal(port: Port) -> Signal | None:
    """The life sign of a port; None: it has none."""
    return next((signal for signal in port.signals if signal.name.endswith("Life")), None)
