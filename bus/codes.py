"""Meaning of the numbers in the telegrams: modes, causes, orders, milestones (value tables of the port table)."""

from __future__ import annotations

from enum import IntEnum, IntFlag


class SupCommand(IntEnum):
    """Orders of the supervisor."""

    NONE = 0
    START = 2
    STOP = 4


class CtlMode(IntEnum):
    """Mode that the controller reports with each notch command."""

    INITIALISING = 0
    RUNNING = 1
    HOLD = 2
    TRACTION_CUT = 3
    SERVICE_BRAKE = 4
    EMERGENCY = 5
    ENDED = 6


class CtlCause(IntEnum):
    """Why the controller's watch left its level NORMAL."""

    NONE = 0
    SPEED_AGE = 1
    BAD_TELEGRAMS = 2
    POSITION_LOST = 3
    OVERSPEED = 4
    SPEED_IMPLAUSIBLE = 5
    POSITION_IMPLAUSIBLE = 6
    SPEED_LATENCY = 7
    CHANNEL_MONITOR = 8
    BUS_OFF = 9
    BRAKE_NOT_ANSWERING = 10
    RUNAWAY = 11
    OVERRUNS = 12
    CLOCK = 13
    SAFETY_CODE = 14
    INITIALISING = 15
    TWO_SOURCES = 16
    TRACK_AGE = 17


class WatchCause(IntEnum):
    """Why the train's watch left its level NORMAL."""

    NONE = 0
    COMMAND_AGE = 1
    NO_COMMAND = 2
    BAD_COMMANDS = 3
    NOTCH_RANGE = 4
    NOTCH_STEP = 5
    TWO_SOURCES = 6
    RUNAWAY = 7
    OVERSPEED = 8
    EMERGENCY_COMMAND = 9
    SAFETY_LOOP = 10
    END_OF_AUTHORITY = 11
    BRAKE_NOT_ANSWERING = 12
    SAFETY_CODE = 13
    DRIVER = 14


class FaultOrder(IntEnum):
    """What SUP_CMD asks for a fault that is triggered by hand.

    ``VALUE``: ``fault_number`` is an octet of the values of the fault that is injected next
    (:mod:`railhil.faults.operator_values`). The DBC does not name it.
    """

    NONE = 0
    INJECT = 1
    CLEAR = 2
    VALUE = 3


class TimeState(IntEnum):
    """State of the simulation in TIME_SYNC."""

    IDLE = 0
    READY = 1
    RUNNING = 2
    ENDED = 3


class Event(IntEnum):
    """Milestones in RUN_EVENT; everything from ``ENDED_COMPLETE`` on ends the run."""

    NONE = 0
    DEPARTED = 1
    STOPPED = 2
    EMERGENCY = 3
    ENDED_COMPLETE = 4
    ENDED_NOT_STOPPED = 5
    ENDED_BY_SUPERVISOR = 6
    ENDED_CONTROLLER_LOST = 7
    ENDED_REFUSED = 8
    ENDED_PLANT_ERROR = 9
    ENDED_SUPERVISOR_LOST = 10

    @property
    def ends_run(self) -> bool:
        """True for the events after which nothing more comes."""
        return self >= Event.ENDED_COMPLETE


class ControllerFlag(IntFlag):
    """OverflowFlags of CTL_STAT: events in the controller since its start."""

    WRAP = 1
    SATURATION = 2
    DIVISION_BY_ZERO = 4
    MESSAGE_LOST = 8
