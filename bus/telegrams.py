"""The telegrams of the bench, one dataclass each.

Fields are the raw integers on the wire; a field's name ends in its unit (``_01mm``: 0.1 mm, ``_256th``:
1/256). In the layout diagrams one column is one byte, most significant bit first; ``chk`` is a 2-bit check variable,
``life`` the 4-bit life sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from railhil.bus.layout import CHECK_CORRECT, FLAG_FALSE, FLAG_TRUE, Telegram, signal

#: Number of times each milestone is sent, first at its tick, then at this spacing: longer than the assembly time of one
#: telegram, so that a disturbance of one copy cannot affect the next. All copies of a run's last milestone are sent at
#: once.
EVENT_COPIES = 3
EVENT_SPACING_NS = 20_000_000
#: STOPPED is a standstill after at least this distance.
STOP_LEG_MIN_M = 1.0
#: CTL_STAT: no quantity is reported; the quantity has used no bit, or has no bits.
NO_QUANTITY = 127
HEADROOM_UNUSED = 31


@dataclass(slots=True)
class TimeSync(Telegram):
    """TIME_SYNC, simulation time of the current tick.

    ::

          0    1    2    3    4    5    6    7
        +-------------------+---------+----+-----------------+
        |    seconds u32    | 1/65536 |rate|chk state   life |
        +-------------------+---------+----+-----------------+
    """

    PORT: ClassVar[str] = "TIME_SYNC"
    seconds_s: int = signal("TimeSeconds")
    fraction_65536th_s: int = signal("TimeTicks")
    rate_10th: int = signal("SimRate")
    check: int = signal("TimeChk", CHECK_CORRECT)
    state: int = signal("TimeState")
    life: int = signal("TimeLife")


@dataclass(slots=True)
class SupCmd(Telegram):
    """SUP_CMD, order of the supervisor.

    ::

           0      1     2      3
        +-------+-----+-----+------------------+
        |command|fault|order| chk         life |
        +-------+-----+-----+------------------+

    ``fault``: number of a fault of the run, from 1, or an octet; ``order``: see
    :class:`railhil.bus.codes.FaultOrder`.
    """

    PORT: ClassVar[str] = "SUP_CMD"
    command: int = signal("SupCommand")
    fault_number: int = signal("FaultNumber")
    fault_order: int = signal("FaultOrder")
    check: int = signal("SupChk", CHECK_CORRECT)
    life: int = signal("SupLife")


@dataclass(slots=True)
class NotchCmd(Telegram):
    """NOTCH_CMD, notch command in 1/256 notch, negative brakes.

    ::

          0    1       2           3
        +---------+------------+---------------------+
        |  s16    | mode cause | chk emergency  life |
        +---------+------------+---------------------+

    ``mode``: :class:`railhil.bus.codes.CtlMode` (3 bit); ``cause``: :class:`railhil.bus.codes.CtlCause` (5 bit).
    """

    PORT: ClassVar[str] = "NOTCH_CMD"
    notch_256th: int = signal("NotchCmd")
    mode: int = signal("CtlMode")
    cause: int = signal("CtlCause")
    check: int = signal("NotchChk", CHECK_CORRECT)
    emergency: int = signal("EmergencyBrake", FLAG_FALSE)
    life: int = signal("NotchLife")


@dataclass(slots=True)
class TrnSpeed(Telegram):
    """TRN_SPEED, measured speed in 0.1 mm/s; opens every tick.

    ::

          0    1    2     3
        +--------------+-----------------+
        |     s24      | chk spare  life |
        +--------------+-----------------+
    """

    PORT: ClassVar[str] = "TRN_SPEED"
    speed_01mmps: int = signal("TrainSpeed")
    check: int = signal("SpeedChk", CHECK_CORRECT)
    spare: int = signal("SpeedSpare")
    life: int = signal("SpeedLife")


@dataclass(slots=True)
class TrnPos(Telegram):
    """TRN_POS, odometer and force.

    ::

          0    1    2    3    4    5      6      7
        +-------------------+---------+-------+-------------------+
        |  odometer s32 mm  |effort   | notch |chk chk(eff)  life |
        +-------------------+---------+-------+-------------------+
    """

    PORT: ClassVar[str] = "TRN_POS"
    odometer_mm: int = signal("TrainPos")
    effort_bipolar2: int = signal("EffortActual")
    notch_16th: int = signal("NotchActual")
    check: int = signal("PosChk", CHECK_CORRECT)
    effort_check: int = signal("EffortChk", CHECK_CORRECT)
    life: int = signal("PosLife")


@dataclass(slots=True)
class PltStat(Telegram):
    """PLT_STAT, train status; every flag is ANTIVALENT2 (power, pantograph, main breaker, doors | parking brake,
    safety loop, traction enabled, brake available).

    ::

            0          1         2        3
        +----------+----------+-------+------------+
        | 4 flags  | 4 flags  | line %| fault life |
        +----------+----------+-------+------------+
    """

    PORT: ClassVar[str] = "PLT_STAT"
    power_on: int = signal("PowerOn", FLAG_TRUE)
    pantograph_up: int = signal("PantographUp", FLAG_TRUE)
    main_breaker_closed: int = signal("MainBreakerClosed", FLAG_TRUE)
    doors_closed_locked: int = signal("DoorsClosedLocked", FLAG_TRUE)
    parking_brake_released: int = signal("ParkingBrakeReleased", FLAG_TRUE)
    safety_loop_closed: int = signal("SafetyLoopClosed", FLAG_TRUE)
    traction_enabled: int = signal("TractionEnabled", FLAG_TRUE)
    brake_available: int = signal("BrakeAvailable", FLAG_TRUE)
    line_voltage_half_percent: int = signal("LineVoltage", 200)
    fault: int = signal("PlantFault")
    life: int = signal("PlantLife")


@dataclass(slots=True)
class TrkInfo(Telegram):
    """TRK_INFO, target, limits and grade.

    ::

          0.7-3.3       3.2-5.0     6    7
        +-------------+-----------+---------+
        | target u29  | time u19  | limit   |   1 mm (536 km), 0.1 s (14 h), limits in 4 mm/s
        +-------------+-----------+---------+
          8    9    10   11   12   13   14     15
        +---------+---------+---------+------+------------------+
        |next lim | dist m  | grade   |speed | chk chk chk life |   grade s16 0.01 permil, speed 0.5 m/s
        +---------+---------+---------+------+------------------+
    """

    PORT: ClassVar[str] = "TRK_INFO"
    target_mm: int = signal("TargetPos")
    target_time_ds: int = signal("TargetTime")
    speed_limit_4mmps: int = signal("SpeedLimit")
    next_limit_4mmps: int = signal("NextLimit")
    next_limit_distance_m: int = signal("NextLimitDist")
    grade_001permil: int = signal("Gradient")
    target_speed_half_mps: int = signal("TargetSpeed")
    target_check: int = signal("TargetChk", CHECK_CORRECT)
    limit_check: int = signal("LimitChk", CHECK_CORRECT)
    grade_check: int = signal("GradientChk", CHECK_CORRECT)
    life: int = signal("TrackLife")


@dataclass(slots=True)
class CtlStat(Telegram):
    """CTL_STAT, what the controller is doing.

    ::

             0          1        2    3     4    5     6    7
        +-----------+---------+----------+----------+---------+
        |note1 level|overflow | note2    | note3    | steps   |   notes: declared by the law
        +-----------+---------+----------+----------+---------+
          8    9    10   11     12         13         14       15
        +---------+---------+-------+--------------+---------+----------------+
        | cycles  | extreme |index m|headroom w s z|overruns | chk ready life |
        +---------+---------+-------+--------------+---------+----------------+

    Cycles above 65535 are sent as 65535. ``index`` (7 bit, 127: none) selects a quantity of the law; extreme, headroom
    (5 bit, 31: unused) and the flags wrapped, saturated and divided by zero refer to it, since the start. ``extreme``
    (s16) is its minimum (m = 0), in the next telegram its maximum (m = 1), then the next quantity follows. It is the
    upper half of the int32 after a left shift by the headroom: raw value ~ extreme * 2^(16 - headroom), rounded down.
    """

    PORT: ClassVar[str] = "CTL_STAT"
    note1: int = signal("Note1")
    ladder_level: int = signal("LadderLevel")
    overflow_flags: int = signal("OverflowFlags")
    note2: int = signal("Note2")
    note3: int = signal("Note3")
    step_count: int = signal("StepCount")
    step_cycles: int = signal("StepCycles")
    telemetry_extreme: int = signal("TelemetryExtreme")
    telemetry_index: int = signal("TelemetryIndex", NO_QUANTITY)
    telemetry_maximum: int = signal("TelemetryMaximum")
    telemetry_headroom_bits: int = signal("TelemetryHeadroom", HEADROOM_UNUSED)
    telemetry_wrapped: int = signal("TelemetryWrapped")
    telemetry_saturated: int = signal("TelemetrySaturated")
    telemetry_zero_division: int = signal("TelemetryZeroDivision")
    overruns: int = signal("OverrunCount")
    check: int = signal("CtlChk", CHECK_CORRECT)
    ready: int = signal("CtlReady", FLAG_TRUE)
    life: int = signal("CtlLife")


@dataclass(slots=True)
class BalisePassed(Telegram):
    """BALISE, surveyed position of the balise passed and the odometer at that moment (its low 16 bit).

    ::

          0    1    2    3    4    5    6       7
        +----+-------------------+---------+-----------------+
        | id | surveyed s32 1 mm | odo u16 | chk spare  life |
        +----+-------------------+---------+-----------------+
    """

    PORT: ClassVar[str] = "BALISE"
    balise_id: int = signal("BaliseId")
    surveyed_mm: int = signal("BalisePos")
    odometer_low_mm: int = signal("BaliseOdometer")
    check: int = signal("BaliseChk", CHECK_CORRECT)
    spare: int = signal("BaliseSpare")
    life: int = signal("BaliseLife")


@dataclass(slots=True)
class TrnWatch(Telegram):
    """TRN_WATCH, the train's own watch of NOTCH_CMD.

    ::

            0           1    2      3
        +-------------+---------+------------------+
        | level cause | age u16 | chk spare   life |   level 3 bit, cause 5 bit, age in ms
        +-------------+---------+------------------+
    """

    PORT: ClassVar[str] = "TRN_WATCH"
    level: int = signal("WatchLevel")
    cause: int = signal("WatchCause")
    age_ms: int = signal("WatchAge")
    check: int = signal("WatchChk", CHECK_CORRECT)
    spare: int = signal("WatchSpare")
    life: int = signal("WatchLife")


@dataclass(slots=True)
class SimTruth(Telegram):
    """SIM_TRUTH, the true state of the simulation; for the score only.

    ::

          0.7-4.6        4.5-7.6      7.5-0
        +--------------+------------+-----------+
        | position s34 |   v s24    | chk  life |   0.1 mm (859 km), 0.1 mm/s
        +--------------+------------+-----------+
          8    9    10   11   12   13   14   15
        +---------+---------+---------+---------+
        | a s16   |traction | brake   | grade   |   a 0.1 mm/s2, forces 20 N, grade 0.01 permil
        +---------+---------+---------+---------+
    """

    PORT: ClassVar[str] = "SIM_TRUTH"
    position_01mm: int = signal("TruePos")
    speed_01mmps: int = signal("TrueSpeed")
    check: int = signal("TruthChk", CHECK_CORRECT)
    life: int = signal("TruthLife")
    accel_01mmps2: int = signal("TrueAccel")
    traction_20n: int = signal("TractionForce")
    brake_20n: int = signal("BrakeForce")
    grade_001permil: int = signal("TrueGrade")


@dataclass(slots=True)
class RunEvent(Telegram):
    """RUN_EVENT, a milestone at its exact instant and true position.

    ::

          0     1    2    3     4    5    6    7
        +-----+----+---------+-------------------+
        |event|    | number  |     time u32      |   0.1 ms
        +-----+----+---------+-------------------+
          8    9    10   11   12   13   14   15
        +-----------------------------+---------+
        |        position s48         |         |   0.1 mm
        +-----------------------------+---------+

    It is sent :data:`EVENT_COPIES` times. A receiver recognises repetitions by the number and drops them; a missing
    number means that a milestone was lost.
    """

    PORT: ClassVar[str] = "RUN_EVENT"
    event: int = signal("RunEvent")
    instant_01ms: int = signal("EventTime")
    position_01mm: int = signal("EventPos")
    number: int = signal("EventNumber")
