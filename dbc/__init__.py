"""The wire contract: ports, telegram layouts, and the DBC file that says the same to every other tool."""

from railhil.dbc.contract import (
    DBC,
    HOUSE_PORTS,
    PORTS,
    Contract,
    ContractError,
    Port,
    Signal,
    load_contract,
    recorded_contract,
    system_contract,
    wire_contract,
)

__all__ = [
    "DBC",
    "HOUSE_PORTS",
    "PORTS",
    "Contract",
    "ContractError",
    "Port",
    "Signal",
    "load_contract",
    "recorded_contract",
    "system_contract",
    "wire_contract",
]
