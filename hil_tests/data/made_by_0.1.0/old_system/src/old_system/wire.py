"""Telegrams of the cart, and the interface of its laws: the signals that they read and set."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from railhil.bus.layout import CHECK_CORRECT, Telegram, signal
from railhil.controller_node.vector.law import Command, Interface, Note, Reading
from railhil.dbc import system_contract

CONTRACT = system_contract(Path(__file__).with_name("ports.toml"))


@dataclass(slots=True)
class CartStat(Telegram):
    """Measured position of the cart."""

    position_01mm: int = signal("CartPos")
    check: int = signal("CartChk", CHECK_CORRECT)
    life: int = signal("CartLife")


@dataclass(slots=True)
class CartCmd(Telegram):
    """Force on the cart."""

    force_001n: int = signal("CartForce")
    check: int = signal("CmdChk", CHECK_CORRECT)
    life: int = signal("CmdLife")


@dataclass(slots=True)
class LawStat(Telegram):
    """State of the law."""

    error_01mm: int = signal("LawError")
    overflow_flags: int = signal("LawFlags")
    step_count: int = signal("LawSteps")
    check: int = signal("LawChk", CHECK_CORRECT)
    life: int = signal("LawLife")


@dataclass(slots=True)
class Truth(Telegram):
    """True state of the simulation."""

    position_001mm: int = signal("TruePos")
    speed_01mmps: int = signal("TrueSpeed")
    check: int = signal("TruthChk", CHECK_CORRECT)
    life: int = signal("TruthLife")


STAT = CartStat.bound(CONTRACT.port("CART_STAT"))
COMMAND = CartCmd.bound(CONTRACT.port("CART_CMD"))
LAW_STAT = LawStat.bound(CONTRACT.port("LAW_STAT"))
TRUTH = Truth.bound(CONTRACT.port("TRUTH"))

#: Fraction bits of the force (0.01 N) inside the law.
FORCE_Q = 8
#: The inputs of a law, its commands and its notes, as raw integers of the telegrams.
INTERFACE = Interface(
    readings=(Reading("position", STAT, "position_01mm", unit="0.1 mm"),),
    commands=(Command("force", COMMAND, "force_001n", FORCE_Q, unit="0.01 N", lowest=-2000, highest=2000),),
    notes=(Note("error", "error_01mm", 0, unit="0.1 mm"),),
    status=LAW_STAT,
)
