"""Sources of the events and notes of the system ``ato``: status, two watches, interlocks, and judged telegrams."""

from __future__ import annotations

from dataclasses import replace

from railhil.bus.layout import FLAG_TRUE
from railhil.judge.declared import Interlocks, Received, Watch
from railhil.record.notes import ReportedNote, Status
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlMode, CtlStat, NotchCmd, PltStat, TrnPos, TrnSpeed, TrnWatch

_NOTCH_LSB_PER_NOTCH = 256
#: Speeds that the controller accepts (0.1 mm/s); a test compares with :mod:`railhil.controller_node.ato.guard`.
SPEED_RANGE_01MMPS = (0, 1_500_000)
_KMH = 3.6
#: UNIPOLAR2.16: 1/16384.
_UNIPOLAR2 = 2.0**-14
#: The controller's status; the law defines the notes. Up to version 0.1.0 they were those of IPFC.
STATUS = Status(
    CtlStat.PORT,
    "OverflowFlags",
    slots=(
        ReportedNote("Note1", "note_1", "note 1", "", "", 1.0, False, ()),
        ReportedNote("Note2", "note_2", "note 2", "", "", _UNIPOLAR2, False, ()),
        ReportedNote("Note3", "note_3", "note 3", "", "", _UNIPOLAR2, False, ()),
    ),
    earlier=(
        ReportedNote("BasisInUse", "basis_in_use", "basis functions", "", "", 1.0, False, ("step", "wavelet", "ramp")),
        ReportedNote("SofteningFactor", "softening_factor", "softening factor", "α", "", _UNIPOLAR2, False, ()),
        ReportedNote("Satisfaction", "satisfaction", "satisfaction", "μ", "", _UNIPOLAR2, False, ()),
    ),
)


def _age_ms(scenario: Scenario, level: str) -> int:
    """Age of the last accepted telegram at which a level is entered."""
    watch = scenario.watch
    ages = {
        "hold": watch.hold_ms,
        "traction_cut": watch.traction_cut_ms,
        "service_brake": watch.service_brake_ms,
        "emergency": watch.emergency_ms,
    }
    return ages[level]


def _overspeed(scenario: Scenario) -> str:
    return f"more than {scenario.watch.overspeed_margin_mps * _KMH:g} km/h above the speed limit"


def controller_cause(scenario: Scenario, level: str, cause: str) -> str:
    """Cause of a level of the controller's watch, in words."""
    if cause == "speed_age":
        return f"TRN_SPEED older than {_age_ms(scenario, level)} ms"
    if cause == "overspeed":
        return _overspeed(scenario)
    if cause == "track_age":
        if level == "traction_cut":
            return "TRK_INFO missing for three periods"
        return f"TRK_INFO older than {_age_ms(scenario, 'emergency')} ms"
    words = {
        "bad_telegrams": "bad TRN_SPEED telegrams",
        "channel_monitor": "too many bad TRN_SPEED telegrams",
        "position_lost": "position lost",
        "clock": "time of the run not known",
    }
    return words.get(cause, cause.replace("_", " "))


def train_cause(scenario: Scenario, level: str, cause: str) -> str:
    """Cause of a level of the train's watch, in words."""
    if cause == "command_age":
        return f"NOTCH_CMD older than {_age_ms(scenario, level)} ms"
    if cause == "overspeed":
        return _overspeed(scenario)
    words = {"no_command": "no NOTCH_CMD yet", "bad_commands": "bad NOTCH_CMD telegrams"}
    return words.get(cause, cause.replace("_", " "))


def received(scenario: Scenario) -> tuple[Received, ...]:
    """Telegrams that controller and train accept only after a check of their content."""
    notch_max = round(scenario.train.notch_max * _NOTCH_LSB_PER_NOTCH)
    return (
        Received.of(TrnSpeed, {"TrainSpeed": SPEED_RANGE_01MMPS}),
        # The controller takes the odometer only: the effort's check variable does not matter to it.
        replace(Received.of(TrnPos), checks=("PosChk",)),
        replace(Received.of(NotchCmd, {"NotchCmd": (-notch_max, notch_max)}), follows_bad=False),
    )


WATCHES = (
    Watch(
        "controller",
        "",
        NotchCmd.PORT,
        "CtlMode",
        "CtlCause",
        (CtlMode.RUNNING, CtlMode.HOLD, CtlMode.TRACTION_CUT, CtlMode.SERVICE_BRAKE, CtlMode.EMERGENCY),
        said=controller_cause,
    ),
    Watch(
        "train",
        "train's",
        TrnWatch.PORT,
        "WatchLevel",
        "WatchCause",
        (0, 1, 2, 3, 4),
        frozenset({"no_command"}),
        train_cause,
    ),
)
#: The fields of PLT_STAT that are true for a train in order.
INTERLOCKS = (
    Interlocks(
        PltStat.PORT,
        {
            "PowerOn": FLAG_TRUE,
            "PantographUp": FLAG_TRUE,
            "MainBreakerClosed": FLAG_TRUE,
            "DoorsClosedLocked": FLAG_TRUE,
            "ParkingBrakeReleased": FLAG_TRUE,
            "SafetyLoopClosed": FLAG_TRUE,
            "TractionEnabled": FLAG_TRUE,
            "BrakeAvailable": FLAG_TRUE,
            "PlantFault": 0,
        },
    ),
)
