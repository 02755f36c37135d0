"""Telegrams of the two carts, each layout bound to one port per cart, and the interface of the laws."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from railhil.bus.layout import CHECK_CORRECT, Telegram, signal
from railhil.controller_node.vector.law import Command, Interface, Note, Reading
from railhil.dbc import system_contract

CONTRACT = system_contract(Path(__file__).with_name("ports.toml"))


@dataclass(slots=True)
class UnitStat(Telegram):
    """Position of a cart."""

    position_01mm: int = signal("{p}Pos")
    check: int = signal("{p}Chk", CHECK_CORRECT)
    life: int = signal("{p}Life")


@dataclass(slots=True)
class UnitCmd(Telegram):
    """Force on a cart."""

    force_001n: int = signal("{p}Force")
    check: int = signal("{p}CmdChk", CHECK_CORRECT)
    life: int = signal("{p}CmdLife")


@dataclass(slots=True)
class LawStatLayout(Telegram):
    """State of the law."""

    stretch_01mm: int = signal("LawStretch")
    overflow_flags: int = signal("LawFlags")
    step_count: int = signal("LawSteps")
    check: int = signal("LawChk", CHECK_CORRECT)
    life: int = signal("LawLife")


@dataclass(slots=True)
class TruthLayout(Telegram):
    """True state of the simulation."""

    position1_001mm: int = signal("TruePos1")
    position2_001mm: int = signal("TruePos2")
    speed1_01mmps: int = signal("TrueSpeed1")
    speed2_01mmps: int = signal("TrueSpeed2")
    check: int = signal("TruthChk", CHECK_CORRECT)
    life: int = signal("TruthLife")


STATS = tuple(UnitStat.bound(CONTRACT.port(f"UNIT{unit}_STAT")) for unit in (1, 2))
COMMANDS = tuple(UnitCmd.bound(CONTRACT.port(f"UNIT{unit}_CMD")) for unit in (1, 2))
LAW_STAT = LawStatLayout.bound(CONTRACT.port("LAW_STAT"))
TRUTH = TruthLayout.bound(CONTRACT.port("TRUTH"))

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
