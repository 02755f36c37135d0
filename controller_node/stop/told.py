"""What a stopping law tells the bus: its command as the train gets it, and its notes."""

from __future__ import annotations

from typing import Generic

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.memory import Remembered
from railhil.controller_node.stop.interface import COMMAND_Q, NOTE_Q, START_Q
from railhil.controller_node.stop.learning import VARIANCE_Q, Record
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q, Numbers
from railhil.controller_node.vector.law import Answer
from railhil.wire.stop_counts import MM, START_PER_S, VARIANCE_PER_M2

#: Lengths among the notes are limited to this, m.
_TOLD_M = 8000.0
_SCALE_Q = 16


class Told(Generic[T]):
    """Units of the bus.

    :param memory: that the run began with.
    """

    def __init__(self, numbers: Numbers[T], memory: Remembered) -> None:
        self._numbers = numbers
        hold = numbers.hold
        self._lengths = [hold("told_max", _TOLD_M, DISTANCE_Q, "law"), hold("told_min", -_TOLD_M, DISTANCE_Q, "law")]
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
