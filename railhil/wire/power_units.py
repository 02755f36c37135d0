"""The wire contracts of the systems of high-speed trains: ``hst1`` has one power unit, ``emu3`` three.

The telegrams of a unit have one layout, and a port for each unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from railhil.bus.made import telegrams_of
from railhil.dbc import Contract, system_contract
from railhil.wire.high_speed import (
    Feedback,
    Mutation,
    Reference,
    TrainPlace,
    UnitCommand,
    UnitForce,
    UnitMode,
    WaysideEvent,
)

#: Points of the preview in REF, and their spacing.
PREVIEW = 14
PREVIEW_STEP_S = 0.25
#: Counts of speeds and accelerations on the wire.
SPEED_PER_MPS = 360.0
ACCEL_PER_MPS2 = 1000.0
#: Counts in TRUTH.
TRUE_PER_UNIT = 10_000.0
#: Figures that the laws report for each unit, with their counts per unit of measure.
NOTES: Mapping[str, float] = {"model_error": 10_000.0, "xi": 10_000.0, "gain": 1000.0, "delay": 1000.0}
#: Modes of a command: the requested action, and ``SAFE`` while the controller has no readings to compute it from.
COAST, TRACTION, BRAKE, EMERGENCY, SAFE = map(int, UnitMode)


@dataclass(frozen=True, slots=True)
class Wire:
    """Contract and telegrams of one system; tuples have one class for each unit.

    ``status``: for unit n the fields of :data:`NOTES` followed by n. ``truth``: ``position``, ``speed``, ``accel``,
    ``drive``, ``target``; with several units also ``speed1``, ..., and ``coupler1``, ...; for each unit ``level1``,
    ``cause1``, ....
    """

    contract: Contract
    feedback: tuple[type[Feedback], ...]
    commands: tuple[type[UnitCommand], ...]
    forces: tuple[type[UnitForce], ...]
    reference: type[Reference]
    event: type[WaysideEvent]
    place: type[TrainPlace]
    status: type[Any]
    truth: type[Any]
    mutation: type[Mutation]


@cache
def wire(units: int) -> Wire:
    """The telegrams of a train of one unit (``hst1``) or three (``emu3``)."""
    table = {1: "hst1.toml", 3: "emu3.toml"}[units]
    contract = system_contract(Path(str(files("railhil.dbc"))) / table)
    numbers = range(1, units + 1)
    own = telegrams_of([contract.port("LAW_STAT"), contract.port("TRUTH")], __name__)
    return Wire(
        contract,
        tuple(Feedback.bound(contract.port(f"UNIT{unit}_FB")) for unit in numbers),
        tuple(UnitCommand.bound(contract.port(f"UNIT{unit}_CMD")) for unit in numbers),
        tuple(UnitForce.bound(contract.port(f"UNIT{unit}_FORCE")) for unit in numbers),
        Reference.bound(contract.port("REF")),
        WaysideEvent.bound(contract.port("EVENT")),
        TrainPlace.bound(contract.port("TRAIN")),
        own["LawStatus"],
        own["TrueMotion"],
        Mutation.bound(contract.port("MUTATION")),
    )
