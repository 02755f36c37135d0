"""Readings and commands of the laws of the system ``stop`` on the bus, and the same in SI units.

Readings, in this order: ``speed1`` to ``speed5`` (mm/s, the oldest first, 3.2 ms apart, the last one of the instant of
the telegram), ``speed_count``, ``speed_valid``, ``slide``; ``odometer`` (mm since the start of the run), ``balise``,
``balise_odometer``; ``load`` (percent), ``wet``, ``standstill``, ``doors``, ``run`` (number of this run, 0: not known);
``report_run``, ``report_error`` (mm); ``level`` (``BrakeLevel``, the train's own reaction). Commands: ``u`` (mm/s2,
brake negative), ``start`` (0.1 ms after the poll), ``valid``. Lengths among the notes are in mm, the variance in 0.0001
m2.

The scenario gives the position and time of the start (``task.start_m``). While it tracks, a law holds the speed at
which the run began; this speed differs from run to run.

The readings of speed, distance and level may be ``STALE_MS`` old: the law has to bridge short gaps (``speed_count``).
After longer ones the node sends ``valid`` 0, and the train acts by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.memory import Remembered
from railhil.controller_node.stop.learning import VARIANCE_Q, Record
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q, Numbers
from railhil.controller_node.vector.law import Answer, Command, Interface, Note, Reading
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
from railhil.wire.stop_counts import MM, SAMPLES, START_PER_S, VARIANCE_PER_M2

#: Q of the command, of its start instant, and of lengths and speeds among the notes, inside a law.
COMMAND_Q = 16
START_Q = 8
NOTE_Q = 8
#: Largest age of the fast readings: twice the three cycles for which a law holds the last speed.
STALE_MS = 96
#: The state of the train is too old after this many periods. A report is never too old: without one only the next run
#: learns nothing.
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


#: Number of cycles without a speed for which the last one is held; then the train must not begin to brake by it.
HELD_CYCLES = 3
#: Limit of a reported error, larger than any error of a stop (:mod:`.learning`).
_REPORT_MAX_MM = 1_000_000.0
#: Counters end here.
COUNT_MAX = 1000.0
_PLACE = {reading.name: index for index, reading in enumerate(STOP.readings)}


class Measured(NamedTuple, Generic[T]):
    """``samples`` m/s; ``odometer`` and ``balise_odometer`` m since the start of the run; ``error`` of the reported
    stop, m; all others Q0: flags are 0 or 1, ``load`` is in percent, ``run`` is the number of this run, ``report`` the
    number of the run whose stop was measured (0: none)."""

    samples: tuple[T, ...]
    number: T
    valid: T
    slide: T
    odometer: T
    balise: T
    balise_odometer: T
    load: T
    wet: T
    standstill: T
    doors: T
    run: T
    report: T
    error: T
    level: T


class Gap(NamedTuple, Generic[T]):
    """Number of the last speed telegram, cycles without one, samples since the last long gap, last sample (m/s)."""

    number: T
    missed: T
    samples: T
    last: T


class Inputs(Generic[T]):
    """Decodes the readings."""

    def __init__(self, numbers: Numbers[T]) -> None:
        self._numbers = numbers
        self._unit = numbers.hold("unit", 1.0 / MM, GAIN_Q, "port table")
        self._reported = [numbers.hold(f"report_{sign}", sign * _REPORT_MAX_MM, 0, "law") for sign in (1, -1)]
        self._none = numbers.hold("no_count", -1.0, 0, "law")
        self._five = numbers.hold("samples", SAMPLES, 0, "port table")
        self._held = numbers.hold("held_cycles", HELD_CYCLES, 0, "law")
        self._most = numbers.hold("count_max", COUNT_MAX, 0, "law")

    def decode(self, readings: Sequence[T]) -> Measured[T]:
        """The readings of the interface in SI units."""
        ar = self._numbers.ar

        def one(name: str) -> T:
            return readings[_PLACE[name]]

        def metres(count: T) -> T:
            return ar.mpy_iqx(count, 0, self._unit, GAIN_Q, DISTANCE_Q)

        return Measured(
            tuple(ar.mpy_iqx(one(f"speed{n}"), 0, self._unit, GAIN_Q, SPEED_Q) for n in range(1, SAMPLES + 1)),
            one("speed_count"),
            one("speed_valid"),
            one("slide"),
            metres(one("odometer")),
            one("balise"),
            metres(one("balise_odometer")),
            one("load"),
            one("wet"),
            one("standstill"),
            one("doors"),
            one("run"),
            one("report_run"),
            metres(ar.clip(one("report_error"), *self._reported)),
            one("level"),
        )

    def start(self, measured: Measured[T]) -> Gap[T]:
        """Before the first step."""
        zero = self._numbers.zero
        return Gap(self._none, zero, zero, measured.samples[-1])

    def bridge_gap(self, gap: Gap[T], measured: Measured[T]) -> tuple[Gap[T], tuple[T, ...], T]:
        """The samples of this cycle, with the last one repeated where there are no new ones, and 1 if there are new
        ones (Q0)."""
        ar, zero, one = self._numbers.ar, self._numbers.zero, self._numbers.one
        change = ar.abs(ar.sub(measured.number, gap.number))
        fresh = ar.where(ar.gt(change, zero), measured.valid, zero)
        new = ar.gt(fresh, zero)
        samples = tuple(ar.where(new, sample, gap.last) for sample in measured.samples)
        missed = ar.where(new, zero, ar.minimum(ar.add(gap.missed, one), self._most))
        seen = ar.minimum(ar.add(gap.samples, ar.where(new, self._five, zero)), self._most)
        seen = ar.where(ar.gt(missed, self._held), zero, seen)
        return Gap(measured.number, missed, seen, samples[-1]), samples, fresh

    def judge_gap(self, gap: Gap[T], warm_up: int) -> T:
        """1 while the estimate must not start the brake (Q0): too long without speed, or not yet warm again."""
        ar, zero, one = self._numbers.ar, self._numbers.zero, self._numbers.one
        enough = self._numbers.hold("warm_up", warm_up - 1, 0, "filter")
        warm = ar.where(ar.gt(gap.samples, enough), zero, one)
        return ar.where(ar.gt(gap.missed, self._held), one, warm)


#: Lengths among the notes are limited to this, m.
_NOTE_MAX_M = 8000.0
_SCALE_Q = 16


class Outputs(Generic[T]):
    """Units of the bus.

    :param memory: that the run began with.
    """

    def __init__(self, numbers: Numbers[T], memory: Remembered) -> None:
        self._numbers = numbers
        hold = numbers.hold
        self._lengths = [
            hold("told_max", _NOTE_MAX_M, DISTANCE_Q, "law"),
            hold("told_min", -_NOTE_MAX_M, DISTANCE_Q, "law"),
        ]
        self._per_m = hold("mm", MM, _SCALE_Q, "port table")
        self._unit = hold("unit", 1.0 / MM, GAIN_Q, "port table")
        self._per_s = hold("start_units", START_PER_S, _SCALE_Q, "port table")
        self._variances = hold("variance_units", VARIANCE_PER_M2, _SCALE_Q, "port table")
        self._source = hold("memory_source", memory.source, 0, "memory")
        self._fault = hold("memory_fault", memory.fault, 0, "memory")

    def code(self, accel: T) -> T:
        """A command (m/s2) as it is on the bus, mm/s2 (Q0)."""
        ar = self._numbers.ar
        return ar.quantise(ar.mpy_iqx(accel, ACCEL_Q, self._per_m, _SCALE_Q, COMMAND_Q), COMMAND_Q, 0)

    def accel(self, code: T) -> T:
        """The command (m/s2) that is on the bus as ``code`` (mm/s2, Q0)."""
        return self._numbers.ar.mpy_iqx(code, 0, self._unit, GAIN_Q, ACCEL_Q)

    def answer(self, stage: T, code: T, start: T, margin: T, distance: T, speed: T, record: Record[T]) -> Answer[T]:
        """Commands and notes of a cycle; ``start``: s (Q ``TIME_Q``), lengths in m, speed in m/s."""
        ar, one = self._numbers.ar, self._numbers.one
        offset = self._mm(record.offset)
        commands = (
            ar.convert(code, 0, COMMAND_Q),
            ar.mpy_iqx(start, TIME_Q, self._per_s, _SCALE_Q, START_Q),
            one,
        )
        notes = (
            stage,
            self._mm(margin),
            self._mm(distance),
            offset,
            ar.mpy_iqx(speed, SPEED_Q, self._per_m, _SCALE_Q, NOTE_Q),
            self._source,
            offset,
            ar.mpy_iqx(record.variance, VARIANCE_Q, self._variances, _SCALE_Q, NOTE_Q),
            record.runs,
            self._fault,
        )
        return Answer(commands, notes)

    def _mm(self, length: T) -> T:
        ar = self._numbers.ar
        return ar.mpy_iqx(ar.clip(length, *self._lengths), DISTANCE_Q, self._per_m, _SCALE_Q, NOTE_Q)
