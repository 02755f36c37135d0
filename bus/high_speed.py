"""Telegrams of the systems of high-speed trains: ``hst1`` has one power unit, ``emu3`` three.

Layouts and units are those of ``dbc/hst1.toml`` and ``dbc/emu3.toml``; fields are named here. What belongs to a unit is
bound to one port for each unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, make_dataclass
from enum import IntEnum
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from railhil.bus.layout import CHECK_CORRECT, Telegram, signal
from railhil.dbc import Contract, system_contract

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
#: Modes of a command: what it asks for, and ``SAFE`` while the controller has no readings to compute it from.
COAST, TRACTION, BRAKE, EMERGENCY, SAFE = range(5)


class UnitLevel(IntEnum):
    """Level of a unit's own watch: at ``TRACTION_CUT`` it coasts, whatever is commanded."""

    NORMAL = 0
    TRACTION_CUT = 2
    SERVICE_BRAKE = 3


class UnitCause(IntEnum):
    """Why the watch of a unit left its level NORMAL."""

    NONE = 0
    COMMAND_AGE = 1
    CONTROLLER_SAFE = 2
    BRAKE_NOT_ANSWERING = 3


@dataclass(slots=True)
class Feedback(Telegram):
    """Speed of a unit (0.01 km/h)."""

    speed: int = signal("{p}Speed")
    check: int = signal("{p}Chk", CHECK_CORRECT)
    life: int = signal("{p}Life")


@dataclass(slots=True)
class UnitCommand(Telegram):
    """Target acceleration of a unit (0.001 m/s2) and mode."""

    accel: int = signal("{p}Accel")
    mode: int = signal("{p}Mode")
    check: int = signal("{p}CmdChk", CHECK_CORRECT)
    life: int = signal("{p}CmdLife")


@dataclass(slots=True)
class UnitForce(Telegram):
    """Achieved and available acceleration of a unit (0.001 m/s2), its coupler's force (0.1 kN) and extension (mm)."""

    drive: int = signal("{p}Drive")
    coupler: int = signal("{p}Coupler")
    gap: int = signal("{p}Gap")
    available: int = signal("{p}Available")
    check: int = signal("{p}ForceChk", CHECK_CORRECT)
    life: int = signal("{p}ForceLife")


@dataclass(slots=True)
class WaysideEvent(Telegram):
    """Whether the emergency has been triggered."""

    emergency: int = signal("Emergency")
    check: int = signal("EventChk", CHECK_CORRECT)
    life: int = signal("EventLife")


@dataclass(slots=True)
class TrainPlace(Telegram):
    """Position (0.01 m) and time (0.01 s)."""

    position: int = signal("TrainPos")
    time: int = signal("TrainTime")
    check: int = signal("TrainChk", CHECK_CORRECT)
    life: int = signal("TrainLife")


@dataclass(slots=True)
class Mutation(Telegram):
    """How the plant differs from its data at present; only for the record."""

    gain: int = signal("TrueGain")
    lag: int = signal("TrueLag")
    traction_delay: int = signal("TrueTractionDelay")
    braking_delay: int = signal("TrueBrakingDelay")
    grade: int = signal("TrueGrade")
    wind: int = signal("TrueWind")
    check: int = signal("MutationChk", CHECK_CORRECT)
    life: int = signal("MutationLife")


def _layout(name: str, text: str, fields: Mapping[str, str]) -> Any:
    """A telegram class with these fields and the usual check variable and life sign (``check``, ``life``)."""
    rows = [(field, int, signal(word, CHECK_CORRECT if field == "check" else 0)) for field, word in fields.items()]
    made = make_dataclass(name, rows, bases=(Telegram,), slots=True)
    made.__doc__ = text
    return made


@dataclass(frozen=True, slots=True)
class Wire:
    """Contract and telegrams of one system; tuples have one class for each unit.

    ``reference``: fields ``ref1`` to ``ref14``, ``ref0`` (now), ``index``. ``status``: for unit n the fields of
    :data:`NOTES` followed by n. ``truth``: ``position``, ``speed``, ``accel``, ``drive``, ``target``; with several
    units also ``speed1``, ..., and ``coupler1``, ...; for each unit ``level1``, ``cause1``, ....
    """

    contract: Contract
    feedback: tuple[type[Feedback], ...]
    commands: tuple[type[UnitCommand], ...]
    forces: tuple[type[UnitForce], ...]
    reference: type[Any]
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
    preview = {f"ref{j}": f"Ref{j}" for j in range(1, PREVIEW + 1)}
    tail = {"ref0": "RefNow", "index": "RefIndex", "check": "RefChk", "life": "RefLife"}
    notes = {f"{note}{unit}": f"{note.title().replace('_', '')}{unit}" for unit in numbers for note in NOTES}
    notes |= {"step_count": "LawSteps", "overflow_flags": "LawFlags", "check": "LawChk", "life": "LawLife"}
    truth = {
        "position": "TruePos",
        "speed": "TrueSpeed",
        "accel": "TrueAccel",
        "drive": "TrueDrive",
        "target": "Target",
    }
    if units > 1:
        truth |= {f"speed{unit}": f"TrueSpeed{unit}" for unit in numbers}
        truth |= {f"coupler{unit}": f"Coupler{unit}" for unit in numbers[:-1]}
    truth |= {f"{word}{unit}": f"{word.title()}{unit}" for unit in numbers for word in ("level", "cause")}
    truth |= {"check": "TruthChk", "life": "TruthLife"}
    return Wire(
        contract,
        tuple(Feedback.bound(contract.port(f"UNIT{unit}_FB")) for unit in numbers),
        tuple(UnitCommand.bound(contract.port(f"UNIT{unit}_CMD")) for unit in numbers),
        tuple(UnitForce.bound(contract.port(f"UNIT{unit}_FORCE")) for unit in numbers),
        _layout("Reference", "Target speeds (0.01 km/h).", preview | tail).bound(contract.port("REF")),
        WaysideEvent.bound(contract.port("EVENT")),
        TrainPlace.bound(contract.port("TRAIN")),
        _layout("LawStatus", "Estimates of the law.", notes).bound(contract.port("LAW_STAT")),
        _layout("TrueMotion", "True motion.", truth).bound(contract.port("TRUTH")),
        Mutation.bound(contract.port("MUTATION")),
    )
