"""What the laws of the system ``stop`` read and write on the bus.

Readings, in this order: ``speed1`` to ``speed5`` (mm/s, the oldest first, 3.2 ms apart, the last one of the instant of
the telegram), ``speed_count``, ``speed_valid``, ``slide``; ``odometer`` (mm since the start of the run), ``balise``,
``balise_odometer``; ``load`` (percent), ``wet``, ``standstill``, ``doors``, ``run`` (number of this run, 0: not known);
``report_run``, ``report_error`` (mm); ``level`` (``BrakeLevel``, what the train does of
itself). Commands: ``u`` (mm/s2, brake negative), ``start`` (0.1 ms after the poll), ``valid``. Lengths among the notes
are in mm, the variance in 0.0001 m2.

The position and time of the start are those of the scenario (``task.start_m``). While it tracks, a law holds the speed
at which the run began: this is what differs from run to run.

The readings of speed, distance and level may be ``STALE_MS`` old: short gaps are the law's to bear (``speed_count``).
Beyond that the node sends ``valid`` 0, and the train acts by itself.
"""

from __future__ import annotations

from railhil.controller_node.vector.law import Command, Interface, Note, Reading
from railhil.wire.stop import (
    AtoState,
    BrakeCommand,
    BrakeStatus,
    IlcStatus,
    Odo,
    SpeedRaw,
    StopReport,
    TrainState,
)

#: Q of the command, of its start instant, and of lengths and speeds among the notes, inside a law.
COMMAND_Q = 16
START_Q = 8
NOTE_Q = 8
#: Largest age of the fast readings: twice the three cycles for which a law holds the last speed.
STALE_MS = 96
#: The state of the train is too old after this many periods. Without a report only the next run learns nothing: a
#: report never is too old.
_SLOW_PERIODS = 3
_REPORT_MS = 86_400_000
#: Bounds of the command, mm/s2; scenarios may allow less. A start instant lies within the cycle of 16 ms.
_LOWEST, _HIGHEST = -2000, 2000
_START_MAX = 160


_STATE_MS = _SLOW_PERIODS * TrainState.port().period_ns // 1_000_000


STOP = Interface(
    readings=(
        *(Reading(f"speed{n}", SpeedRaw, f"speed{n}", unit="mm/s", age_max_ms=STALE_MS) for n in range(1, 6)),
        Reading("speed_count", SpeedRaw, "count", age_max_ms=STALE_MS),
        Reading("speed_valid", SpeedRaw, "valid", age_max_ms=STALE_MS),
        Reading("slide", SpeedRaw, "slide", age_max_ms=STALE_MS),
        Reading("odometer", Odo, "odometer", unit="mm", age_max_ms=STALE_MS),
        Reading("balise", Odo, "balise", age_max_ms=STALE_MS),
        Reading("balise_odometer", Odo, "balise_odometer", unit="mm", age_max_ms=STALE_MS),
        Reading("load", TrainState, "load", unit="%", age_max_ms=_STATE_MS),
        Reading("wet", TrainState, "wet", age_max_ms=_STATE_MS),
        Reading("standstill", TrainState, "standstill", age_max_ms=_STATE_MS),
        Reading("doors", TrainState, "doors", age_max_ms=_STATE_MS),
        Reading("run", TrainState, "run", age_max_ms=_STATE_MS),
        Reading("report_run", StopReport, "run", age_max_ms=_REPORT_MS),
        Reading("report_error", StopReport, "error", unit="mm", age_max_ms=_REPORT_MS),
        Reading("level", BrakeStatus, "level", age_max_ms=STALE_MS),
    ),
    commands=(
        Command("u", BrakeCommand, "accel", COMMAND_Q, 0, "mm/s2", _LOWEST, _HIGHEST),
        Command("start", BrakeCommand, "start", START_Q, 0, "0.1 ms", 0, _START_MAX),
        Command("valid", BrakeCommand, "valid", 0),
    ),
    notes=(
        Note("stage", "stage", 0),
        Note("margin", "margin", NOTE_Q, unit="mm"),
        Note("stop_distance", "stop_distance", NOTE_Q, unit="mm"),
        Note("offset", "offset", NOTE_Q, unit="mm"),
        Note("speed_estimate", "speed_estimate", NOTE_Q, unit="mm/s"),
        Note("memory_source", "memory_source", 0, telegram=IlcStatus),
        Note("memory_offset", "memory_offset", NOTE_Q, unit="mm", telegram=IlcStatus),
        Note("memory_variance", "memory_variance", NOTE_Q, unit="0.0001 m2", telegram=IlcStatus),
        Note("memory_runs", "memory_runs", 0, telegram=IlcStatus),
        Note("memory_fault", "memory_fault", 0, telegram=IlcStatus),
    ),
    status=AtoState,
    further_status=(IlcStatus,),
)
