"""The wire contract: ports, telegram layouts, and the equivalent DBC file for other tools."""

from railhil.dbc.contract import DBC, PORTS, Contract, ContractError, Port, Signal
from railhil.dbc.house import house_contract, own_ports, system_contract
from railhil.dbc.read import load_contract, recorded_contract, wire_contract

__all__ = [
    "DBC",
    "PORTS",
    "Contract",
    "ContractError",
    "Port",
    "Signal",
    "house_contract",
    "load_contract",
    "own_ports",
    "recorded_contract",
    "system_contract",
    "wire_contract",
]
