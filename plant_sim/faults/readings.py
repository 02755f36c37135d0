"""Faults of a sensor that gives one number: what each word makes of its readings.

A sensor is sampled at every tick, whether its reading is sent or not; a fault changes the sample. ``x`` is the reading
without this fault in m/s or m, ``t`` the time since the fault began:

============ =========================================================================================
off          no valid value: 0, and the check variable of the telegram says erroneous
intermittent off at a share of the samples, drawn for each
stuck        the reading at its beginning
value        a given reading
garbage      any number that the signal can hold, drawn for each sample
wrong        factor * x
offset, jump x + error
drift        x + per_s * t
noise        x + sigma * n, n drawn from the standard normal distribution for each sample
slow         y' = (x - y) / time_constant_s, solved exactly for each tick
delayed      the reading of an earlier tick
============ =========================================================================================

Words and parameters: :mod:`railhil.faults.words`. A changed reading keeps to the numbers that its signal can hold.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from math import exp
from typing import NamedTuple

import numpy as np

from railhil.bus.injector.activity import Activity
from railhil.bus.layout import Telegram
from railhil.plant_sim.faults.injections import Injections, longest, number_of


class Reading(NamedTuple):
    """A raw reading, and whether the sensor vouches for it."""

    raw: int
    valid: bool = True


class Quantity(NamedTuple):
    """What a sensor measures: raw counts per m/s or m, and the raw numbers that its signal can hold."""

    per_unit: float
    low: int
    high: int

    @classmethod
    def of(cls, telegram: type[Telegram], field: str, per_unit: float) -> Quantity:
        """The quantity in a field of a telegram."""
        low, high = dict(telegram.signals())[field].raw_range
        return cls(per_unit, low, high)

    def raw(self, value: float) -> int:
        """A value as a raw number, to the ends of the range."""
        return min(max(round(value * self.per_unit), self.low), self.high)


class ReadingFault:
    """One fault of one sensor; :meth:`take` gets the sensor's reading at every tick, in order."""

    def __init__(self, activity: Activity, quantity: Quantity, source: np.random.Generator, tick_s: float) -> None:
        self.activity = activity
        self.quantity = quantity
        self.source = source
        self.tick_s = tick_s
        self._was_active = False

    def take(self, reading: Reading) -> Reading:
        """The reading with this fault."""
        self.seen(reading)
        if not self.activity.active:
            self._was_active = False
            return reading
        if not self._was_active:
            self._was_active = True
            self.begin(reading)
        return self.changed(reading)

    def parameter(self, name: str) -> float:
        """A parameter of the fault, in its base unit."""
        return number_of(self.activity.fault, name)

    def shifted(self, reading: Reading, by: float) -> Reading:
        """The reading plus a number of m/s or m."""
        return Reading(self.quantity.raw(reading.raw / self.quantity.per_unit + by), reading.valid)

    def seen(self, reading: Reading) -> None:
        """A reading, also while the fault is not active."""

    def begin(self, reading: Reading) -> None:
        """The first reading of the active fault."""

    def changed(self, reading: Reading) -> Reading:
        """What becomes of a reading."""
        raise NotImplementedError


class Off(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return Reading(0, False)


class Intermittent(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return Reading(0, False) if self.source.random() < self.parameter("share") else reading


class Stuck(ReadingFault):
    def begin(self, reading: Reading) -> None:
        self._held = reading

    def changed(self, reading: Reading) -> Reading:
        return self._held


class Value(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return Reading(self.quantity.raw(self.parameter("value")))


class Garbage(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return Reading(int(self.source.integers(self.quantity.low, self.quantity.high, endpoint=True)))


class Wrong(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return Reading(
            self.quantity.raw(reading.raw / self.quantity.per_unit * self.parameter("factor")), reading.valid
        )


class Offset(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return self.shifted(reading, self.parameter("error"))


class Jump(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return self.shifted(reading, self.parameter("distance_m"))


class Drift(ReadingFault):
    def begin(self, reading: Reading) -> None:
        self._ticks = 0

    def changed(self, reading: Reading) -> Reading:
        self._ticks += 1
        return self.shifted(reading, self.parameter("per_s") * (self._ticks - 1) * self.tick_s)


class Noise(ReadingFault):
    def changed(self, reading: Reading) -> Reading:
        return self.shifted(reading, self.parameter("sigma") * float(self.source.standard_normal()))


class Slow(ReadingFault):
    def begin(self, reading: Reading) -> None:
        self._raw = float(reading.raw)
        self._share = 1.0 - exp(-self.tick_s / self.parameter("time_constant_s"))

    def changed(self, reading: Reading) -> Reading:
        self._raw += (reading.raw - self._raw) * self._share
        return Reading(round(self._raw), reading.valid)


class Delayed(ReadingFault):
    def __init__(self, activity: Activity, quantity: Quantity, source: np.random.Generator, tick_s: float) -> None:
        super().__init__(activity, quantity, source, tick_s)
        self._past: deque[Reading] = deque(maxlen=round(longest(activity.fault, "delay_s") / tick_s) + 1)

    def seen(self, reading: Reading) -> None:
        self._past.append(reading)

    def changed(self, reading: Reading) -> Reading:
        return self._past[max(0, len(self._past) - 1 - round(self.parameter("delay_s") / self.tick_s))]


WORDS: Mapping[str, type[ReadingFault]] = {
    "off": Off,
    "intermittent": Intermittent,
    "stuck": Stuck,
    "value": Value,
    "garbage": Garbage,
    "wrong": Wrong,
    "offset": Offset,
    "jump": Jump,
    "drift": Drift,
    "noise": Noise,
    "slow": Slow,
    "delayed": Delayed,
}


class FaultySensor:
    """The readings of one sensor with its faults, in the order of their numbers.

    :param names: names of the place of its faults.
    :param unit: the unit that has the sensor, from 1; 0: the train has one.
    """

    def __init__(self, injections: Injections, quantity: Quantity, tick_s: float, *names: str, unit: int = 0) -> None:
        self._injections = injections
        self._faults = [
            WORDS[one.fault.what](one, quantity, injections.samples(one), tick_s)
            for one in injections.at("sensor", *names, unit=unit)
            if one.fault.what in WORDS
        ]
        #: The reading at the present tick.
        self.reading = Reading(0)
        #: How much its reading differs from the healthy one, in raw counts.
        self.error = 0
        self._changes: list[tuple[Activity, Reading, Reading]] = []

    def __bool__(self) -> bool:
        """Whether it has any fault."""
        return bool(self._faults)

    def sample(self, raw: int) -> None:
        """The healthy reading of a tick; ticks come in order."""
        reading = Reading(raw)
        self._changes = []
        for fault in self._faults:
            before, reading = reading, fault.take(reading)
            if reading != before:
                self._changes.append((fault.activity, before, reading))
        self.reading = reading
        self.error = reading.raw - raw

    def sent(self) -> Reading:
        """The reading at the present tick, which is sent now: whatever changed it has hit a telegram."""
        for activity, before, after in self._changes:
            self._injections.hit(activity, _text(before), _text(after))
        self._changes = []
        return self.reading


def _text(reading: Reading) -> str:
    return str(reading.raw) if reading.valid else "invalid"
