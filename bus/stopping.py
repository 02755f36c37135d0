"""Telegrams of the system ``stop``, precise stopping at a platform.

Layouts and units are those of ``dbc/stop.toml``; fields are named here. Lengths are in mm, speeds in mm/s,
accelerations in mm/s2 (braking negative), times in 0.1 ms, unless a field says otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from importlib.resources import files
from pathlib import Path

from railhil.bus.layout import CHECK_CORRECT, Telegram, signal
from railhil.dbc import system_contract

CONTRACT = system_contract(Path(str(files("railhil.dbc"))) / "stop.toml")
#: Samples of the speed in SPEED_RAW, and their spacing.
SAMPLES = 5
SAMPLE_S = 0.0032
#: Counts on the wire per m, m/s and m/s2, and per second of a start instant.
MM = 1000.0
START_PER_S = 10_000.0
#: Counts in TRUTH per unit of measure.
TRUE_PER_UNIT = 10_000.0
#: Counts of a variance per m2.
VARIANCE_PER_M2 = 10_000.0


class Stage(IntEnum):
    """What the law does (ATO_STATE)."""

    IDLE = 0
    START = 1
    ACCELERATE = 2
    TRACK = 3
    ARMED = 4
    BRAKE = 5
    STANDSTILL = 6
    LEARN = 7


class BrakeLevel(IntEnum):
    """What the train's brake does of itself, in the order of its ladder."""

    NORMAL = 0
    HOLD = 1
    TRACTION_CUT = 2
    SERVICE_BRAKE = 3
    EMERGENCY = 4


class BrakeCause(IntEnum):
    """Why the brake left its level NORMAL."""

    NONE = 0
    COMMAND_AGE = 1
    CONTROLLER_SAFE = 2
    BRAKE_NOT_ANSWERING = 3


@dataclass(slots=True)
class _BrakeStatus(Telegram):
    """Level and cause of the train's own watch."""

    level: int = signal("BrakeLevel")
    cause: int = signal("BrakeCause")
    check: int = signal("BrakeStatChk", CHECK_CORRECT)
    life: int = signal("BrakeStatLife")


@dataclass(slots=True)
class _SpeedRaw(Telegram):
    """Five samples of the speed, the oldest first; number of the telegram; whether the wheels slide."""

    speed1: int = signal("Speed1")
    speed2: int = signal("Speed2")
    speed3: int = signal("Speed3")
    speed4: int = signal("Speed4")
    speed5: int = signal("Speed5")
    count: int = signal("SpeedCount")
    valid: int = signal("SpeedValid")
    slide: int = signal("SpeedSlide")
    check: int = signal("SpeedChk", CHECK_CORRECT)
    life: int = signal("SpeedLife")


@dataclass(slots=True)
class _Odo(Telegram):
    """Distance by the wheels since the start of the run; last balise (0: none) and the distance at it."""

    odometer: int = signal("OdoDistance")
    balise: int = signal("BaliseId")
    balise_odometer: int = signal("BaliseDistance")
    check: int = signal("OdoChk", CHECK_CORRECT)
    life: int = signal("OdoLife")


@dataclass(slots=True)
class _BrakeCommand(Telegram):
    """Target acceleration, the time after the poll from which it applies, and whether the controller has readings."""

    accel: int = signal("CmdAccel")
    start: int = signal("CmdStart")
    valid: int = signal("CmdValid")
    check: int = signal("CmdChk", CHECK_CORRECT)
    life: int = signal("CmdLife")


@dataclass(slots=True)
class _TrainState(Telegram):
    """Load in percent of the full one; rail announced as wet, standstill, doors open; number of this run (0: not
    known)."""

    load: int = signal("LoadPercent")
    wet: int = signal("RailWet")
    standstill: int = signal("Standstill")
    doors: int = signal("DoorsOpen")
    run: int = signal("TrainRun")
    check: int = signal("TrainChk", CHECK_CORRECT)
    life: int = signal("TrainLife")


@dataclass(slots=True)
class _StopReport(Telegram):
    """Stop of a run as the mark balise measured it, overshoot positive; run 0: none yet."""

    run: int = signal("ReportRun")
    error: int = signal("ReportError")
    check: int = signal("ReportChk", CHECK_CORRECT)
    life: int = signal("ReportLife")


@dataclass(slots=True)
class _AtoState(Telegram):
    """What the law does: see the notes of the interface."""

    margin: int = signal("AtoMargin")
    stop_distance: int = signal("AtoDistance")
    offset: int = signal("AtoOffset")
    speed_estimate: int = signal("AtoSpeed")
    stage: int = signal("AtoStage")
    overflow_flags: int = signal("LawFlags")
    step_count: int = signal("LawSteps")
    check: int = signal("AtoChk", CHECK_CORRECT)
    life: int = signal("AtoLife")


@dataclass(slots=True)
class _IlcStatus(Telegram):
    """The memory with which the run began: variance in 0.0001 m2."""

    memory_source: int = signal("MemorySource")
    memory_fault: int = signal("MemoryFault")
    memory_offset: int = signal("MemoryOffset")
    memory_variance: int = signal("MemoryVariance")
    memory_runs: int = signal("MemoryRuns")
    check: int = signal("IlcChk", CHECK_CORRECT)
    life: int = signal("IlcLife")


@dataclass(slots=True)
class _Truth(Telegram):
    """True motion for the record (0.0001 m, m/s, m/s2); ``slide``: the adhesion limits the brake."""

    position: int = signal("TruePos")
    speed: int = signal("TrueSpeed")
    slide: int = signal("TrueSlide")
    accel: int = signal("TrueAccel")
    drive: int = signal("TrueDrive")
    check: int = signal("TruthChk", CHECK_CORRECT)
    life: int = signal("TruthLife")


@dataclass(slots=True)
class _TrueData(Telegram):
    """What has been drawn for train and run, for the record: gain, delay and lag in 0.0001, wheel error in 1e-6."""

    gain: int = signal("TrueGain")
    delay: int = signal("TrueDelay")
    lag: int = signal("TrueLag")
    wheel: int = signal("TrueWheel")
    run: int = signal("TrueRun")
    cruise: int = signal("TrueCruise")
    adhesion: int = signal("TrueAdhesion")
    check: int = signal("DataChk", CHECK_CORRECT)
    life: int = signal("DataLife")


BrakeStatus = _BrakeStatus.bound(CONTRACT.port("BRAKE_STAT"))
SpeedRaw = _SpeedRaw.bound(CONTRACT.port("SPEED_RAW"))
Odo = _Odo.bound(CONTRACT.port("ODO"))
BrakeCommand = _BrakeCommand.bound(CONTRACT.port("BRAKE_CMD"))
TrainState = _TrainState.bound(CONTRACT.port("TRAIN_STATE"))
StopReport = _StopReport.bound(CONTRACT.port("STOP_REPORT"))
AtoState = _AtoState.bound(CONTRACT.port("ATO_STATE"))
IlcStatus = _IlcStatus.bound(CONTRACT.port("ILC_STATUS"))
Truth = _Truth.bound(CONTRACT.port("TRUTH"))
TrueData = _TrueData.bound(CONTRACT.port("TRUE_DATA"))
