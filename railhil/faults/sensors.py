"""Kinds of faults of a sensor that gives one number, each with its word.

A sensor is sampled at every tick, even if its reading is not sent; a fault changes the sample. A changed reading is
limited to the numbers that its signal can hold. A new kind is a class here, listed in :data:`SENSOR_KINDS`. The
language, its documentation and the plants of all systems read that list.
"""

from __future__ import annotations

from collections import deque
from math import exp
from typing import TYPE_CHECKING, NamedTuple

from railhil.faults.model import LENGTH, NUMBER, PX4, RAILWAY, SHARE, TIME, Kind, Parameter, Word

if TYPE_CHECKING:
    from railhil.faults.activity import Activity
    from railhil.faults.model import Random

_MODELS = "sensor models"
#: Sensors that count a distance, and all that give one number.
_COUNTERS = ("position", "atp_odometer")
_NUMBERS = (*_COUNTERS, "speed", "atp_speed")


class Reading(NamedTuple):
    """A raw reading, and whether the sensor marks it as valid."""

    raw: int
    valid: bool = True


class Quantity(NamedTuple):
    """Scale of a sensor: raw counts per m/s or m, and the raw numbers that its signal can hold."""

    per_unit: float
    low: int
    high: int

    def raw(self, value: float) -> int:
        """A value as a raw number, limited to the range."""
        return min(max(round(value * self.per_unit), self.low), self.high)


class SensorFault(Kind):
    """A fault of one sensor. :meth:`change` gets the sensor's reading at every tick, in order.

    :param source: random numbers, drawn only while the fault is active.
    """

    def __init__(self, activity: Activity, quantity: Quantity, source: Random, tick_s: float) -> None:
        super().__init__(activity)
        self.quantity = quantity
        self.source = source
        self.tick_s = tick_s

    def change(self, reading: Reading) -> Reading:
        """The reading with this fault."""
        self.look(reading)
        if self.begins():
            self.begin(reading)
        return self.changed(reading) if self.activity.active else reading

    def shifted(self, reading: Reading, by: float) -> Reading:
        """The reading plus a number of m/s or m."""
        return Reading(self.quantity.raw(reading.raw / self.quantity.per_unit + by), reading.valid)

    def look(self, reading: Reading) -> None:
        """Take note of a reading, also while the fault is not active."""

    def begin(self, reading: Reading) -> None:
        """Take note of the first reading of the active fault."""

    def changed(self, reading: Reading) -> Reading:
        """The changed reading."""
        raise NotImplementedError


class SensorOff(SensorFault):
    word = Word("off", "sensor", "no value: the telegram's check variable is erroneous, the value is 0", PX4)

    def changed(self, reading: Reading) -> Reading:
        return Reading(0, False)


class SensorStuck(SensorFault):
    word = Word("stuck", "sensor", "the value of the first instant stays", PX4, names=(*_NUMBERS, "docking_loop"))

    def begin(self, reading: Reading) -> None:
        self._held = reading

    def changed(self, reading: Reading) -> Reading:
        return self._held


class SensorGarbage(SensorFault):
    word = Word("garbage", "sensor", "random values over the whole range of the wire", PX4, names=_NUMBERS)

    def changed(self, reading: Reading) -> Reading:
        return Reading(int(self.source.integers(self.quantity.low, self.quantity.high, endpoint=True)))


class SensorWrong(SensorFault):
    word = Word("wrong", "sensor", "multiplied by a wrong factor", PX4,
                (Parameter("factor", NUMBER, 1.05, "factor", low=-100.0, high=100.0),), names=_NUMBERS)  # fmt: skip

    def changed(self, reading: Reading) -> Reading:
        value = reading.raw / self.quantity.per_unit * self.parameter("factor")
        return Reading(self.quantity.raw(value), reading.valid)


class SensorSlow(SensorFault):
    """``y' = (x - y) / time_constant_s``, solved exactly for each tick."""

    word = Word("slow", "sensor", "first-order lag", PX4,
                (Parameter("time_constant_s", TIME, 1.0, "time constant", low=0.001, high=1000.0),),
                names=_NUMBERS)  # fmt: skip

    def begin(self, reading: Reading) -> None:
        self._raw = float(reading.raw)
        self._share = 1.0 - exp(-self.tick_s / self.parameter("time_constant_s"))

    def changed(self, reading: Reading) -> Reading:
        self._raw += (reading.raw - self._raw) * self._share
        return Reading(round(self._raw), reading.valid)


class SensorDelayed(SensorFault):
    word = Word("delayed", "sensor", "the value of some time ago", PX4,
                (Parameter("delay_s", TIME, 0.5, "delay", low=0.001, high=100.0),), names=_NUMBERS,
                looks_back=True)  # fmt: skip

    def __init__(self, activity: Activity, quantity: Quantity, source: Random, tick_s: float) -> None:
        super().__init__(activity, quantity, source, tick_s)
        self._past: deque[Reading] = deque(maxlen=round(self.largest("delay_s") / tick_s) + 1)

    def look(self, reading: Reading) -> None:
        self._past.append(reading)

    def changed(self, reading: Reading) -> Reading:
        return self._past[max(0, len(self._past) - 1 - round(self.parameter("delay_s") / self.tick_s))]


class SensorIntermittent(SensorFault):
    word = Word("intermittent", "sensor", "off for some of the samples, at random", PX4,
                (Parameter("share", SHARE, 0.5, "share of the samples that are off", low=0.0, high=1.0),))  # fmt: skip

    def changed(self, reading: Reading) -> Reading:
        return Reading(0, False) if self.source.random() < self.parameter("share") else reading


class SensorDrift(SensorFault):
    word = Word("drift", "sensor", "an error that grows with time", _MODELS,
                (Parameter("per_s", NUMBER, 0.01, "growth per s, in m/s or m", low=-1000.0, high=1000.0),),
                names=_NUMBERS)  # fmt: skip

    def begin(self, reading: Reading) -> None:
        self._ticks = 0

    def changed(self, reading: Reading) -> Reading:
        self._ticks += 1
        return self.shifted(reading, self.parameter("per_s") * (self._ticks - 1) * self.tick_s)


class SensorNoise(SensorFault):
    word = Word("noise", "sensor", "normally distributed error", _MODELS,
                (Parameter("sigma", NUMBER, 0.1, "standard deviation, in m/s or m", low=0.0, high=1000.0),),
                names=_NUMBERS)  # fmt: skip

    def changed(self, reading: Reading) -> Reading:
        return self.shifted(reading, self.parameter("sigma") * float(self.source.standard_normal()))


class SensorOffset(SensorFault):
    word = Word("offset", "sensor", "constant error", _MODELS,
                (Parameter("error", NUMBER, None, "error, in m/s or m", low=-1e6, high=1e6, example="0.5"),),
                names=_NUMBERS)  # fmt: skip

    def changed(self, reading: Reading) -> Reading:
        return self.shifted(reading, self.parameter("error"))


class SensorValue(SensorFault):
    word = Word("value", "sensor", "a fixed value, also a negative or impossible one", _MODELS,
                (Parameter("value", NUMBER, None, "value, in m/s or m", low=-1e6, high=1e6, example="20"),),
                names=_NUMBERS)  # fmt: skip

    def changed(self, reading: Reading) -> Reading:
        return Reading(self.quantity.raw(self.parameter("value")))


class SensorJump(SensorFault):
    word = Word("jump", "sensor", "the count jumps once and continues from there", RAILWAY,
                (Parameter("distance_m", LENGTH, None, "distance", low=-1e6, high=1e6),), names=_COUNTERS,
                lasts=False)  # fmt: skip

    def changed(self, reading: Reading) -> Reading:
        return self.shifted(reading, self.parameter("distance_m"))


#: In the order of the documentation, in which random faults are drawn, too.
SENSOR_KINDS: tuple[type[SensorFault], ...] = (
    SensorOff, SensorStuck, SensorGarbage, SensorWrong, SensorSlow, SensorDelayed, SensorIntermittent, SensorDrift,
    SensorNoise, SensorOffset, SensorValue, SensorJump,
)  # fmt: skip
