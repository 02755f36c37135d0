"""Telegrams of the two carts, whose ports share their layouts, and the interface of the laws."""

from __future__ import annotations

from pathlib import Path

from railhil.bus.made import telegrams_of
from railhil.controller_node.vector.law import Command, Interface, Note, Reading
from railhil.dbc import own_ports, system_contract

CONTRACT = system_contract(Path(__file__).with_name("ports.toml"))
TELEGRAMS = telegrams_of(own_ports(CONTRACT), __name__)
STATS = tuple(TELEGRAMS[f"Unit{unit}Stat"] for unit in (1, 2))
COMMANDS = tuple(TELEGRAMS[f"Unit{unit}Cmd"] for unit in (1, 2))
LAW_STAT, TRUTH = TELEGRAMS["LawStat"], TELEGRAMS["Truth"]

#: Q of forces (0.01 N) inside the law.
FORCE_Q = 8
INTERFACE = Interface(
    readings=tuple(
        Reading(f"position[{unit}]", kind, "position_01mm", unit="0.1 mm") for unit, kind in enumerate(STATS)
    ),
    commands=tuple(
        Command(f"force[{unit}]", kind, "force_001n", FORCE_Q, unit="0.01 N", lowest=-2000, highest=2000)
        for unit, kind in enumerate(COMMANDS)
    ),
    notes=(Note("stretch", "stretch_01mm", 0, unit="0.1 mm"),),
    status=LAW_STAT,
)
