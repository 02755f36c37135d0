"""Sensors of the plants with faults: sensors of one number (:mod:`railhil.faults.sensors`), and the balise reader.

============ ================================================================================
missed       no report of a balise
doubled      two reports
wrong        ``error_m`` away from the surveyed position
wrong_number another number
shifted      none here: the plant passes the balise elsewhere (:meth:`FaultyReader.shift_m`)
off          a report without a valid value; ``intermittent``: for a share of the balises
============ ================================================================================
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from railhil.bus.layout import Telegram
from railhil.faults.activity import Activity
from railhil.faults.model import Fault, Random
from railhil.faults.sensors import SENSOR_KINDS, Quantity, Reading, SensorFault
from railhil.faults.words import ONLY
from railhil.plant_sim.faults.injections import Injections


def quantity_of(telegram: type[Telegram], field: str, per_unit: float) -> Quantity:
    """The quantity in a field of a telegram.

    :param per_unit: raw counts per m/s or m.
    """
    low, high = dict(telegram.signals())[field].raw_range
    return Quantity(per_unit, low, high)


class FaultySensor:
    """The readings of one sensor with its faults, in the order of their numbers.

    :param names: names of the place of its faults.
    :param unit: the unit that has the sensor, from 1; 0: the train has one.
    """

    def __init__(self, injections: Injections, quantity: Quantity, tick_s: float, *names: str, unit: int = 0) -> None:
        self._injections = injections
        self._faults: list[SensorFault] = []
        injections.attach(lambda: self._take(injections.at("sensor", *names, unit=unit), quantity, tick_s))
        #: The reading at the present tick.
        self.reading = Reading(0)
        #: Difference of its reading from the healthy one, in raw counts.
        self.error = 0
        self._changes: list[tuple[Activity, Reading, Reading]] = []

    def _take(self, activities: Sequence[Activity], quantity: Quantity, tick_s: float) -> None:
        kinds = {kind.word.name: kind for kind in SENSOR_KINDS}
        before = {one.activity: one for one in self._faults}
        self._faults = [
            before.get(one) or kinds[one.fault.what](one, quantity, self._injections.samples(one), tick_s)
            for one in activities
            if one.fault.what in kinds
        ]

    def __bool__(self) -> bool:
        """Whether it has any fault."""
        return bool(self._faults)

    def sample(self, raw: int) -> None:
        """The healthy reading of a tick; ticks come in order."""
        reading = Reading(raw)
        self._changes = []
        for fault in self._faults:
            before, reading = reading, fault.change(reading)
            if reading != before:
                self._changes.append((fault.activity, before, reading))
        self.reading = reading
        self.error = reading.raw - raw

    def sent(self) -> Reading:
        """The reading at the present tick, which is sent now: each fault that changed it has hit a telegram."""
        for activity, before, after in self._changes:
            self._injections.hit(activity, _text(before), _text(after))
        self._changes = []
        return self.reading


def _text(reading: Reading) -> str:
    return str(reading.raw) if reading.valid else "invalid"


@dataclass(frozen=True, slots=True)
class BaliseReport:
    """The reader's report of a balise: its number and the position in its telegram; not ``valid``: only the number."""

    number: int
    position_m: float
    valid: bool = True


def _unread(reports: list[BaliseReport]) -> list[BaliseReport]:
    return [BaliseReport(each.number, 0.0, valid=False) for each in reports]


def _misplaced(reports: list[BaliseReport], error_m: float) -> list[BaliseReport]:
    return [replace(each, position_m=each.position_m + error_m) for each in reports]


#: Word of a fault of the reader -> the reports that remain.
_BALISE_WORDS: Mapping[str, Callable[[list[BaliseReport], Fault, Random], list[BaliseReport]]] = {
    "missed": lambda reports, fault, source: [],
    "doubled": lambda reports, fault, source: [each for each in reports for _ in range(2)],
    "wrong": lambda reports, fault, source: _misplaced(reports, fault.parameter("error_m")),
    "wrong_number": lambda reports, fault, source: [
        replace(each, number=int(fault.parameter("number"))) for each in reports
    ],
    "shifted": lambda reports, fault, source: reports,
    "off": lambda reports, fault, source: _unread(reports),
    "intermittent": lambda reports, fault, source: (
        _unread(reports) if source.random() < fault.parameter("share") else reports
    ),
}


class FaultyReader:
    """The reader's reports of a balise under the active faults, in the order of their numbers."""

    def __init__(self, injections: Injections) -> None:
        self._injections = injections
        self._faults: list[tuple[Activity, Random]] = []
        injections.attach(self._take)

    def _take(self) -> None:
        before, injections = dict(self._faults), self._injections
        self._faults = [(one, before.get(one) or injections.samples(one)) for one in injections.at("sensor", "balise")]

    def reported(self, healthy: BaliseReport) -> list[BaliseReport]:
        """The reports for one passing: none, one or several."""
        found = [healthy]
        for one, source in self._faults:
            if not one.active or not _is_meant(one.fault, healthy.number):
                continue
            before = found
            found = _BALISE_WORDS[one.fault.what](found, one.fault, source)
            if found != before:
                self._injections.hit(one, _reports_text(before), _reports_text(found))
        return found

    def shift_m(self, number: int) -> float:
        """How far a balise lies from its place, forwards, under the active faults."""
        return sum(one.fault.parameter("by_m") for one in self._shifts(number))

    def note_shift(self, number: int, true_m: float) -> None:
        """Note the faults by which a balise that is passed lies elsewhere."""
        for one in self._shifts(number):
            self._injections.hit(one, f"{true_m - one.fault.parameter('by_m'):g} m", f"{true_m:g} m")

    def _shifts(self, number: int) -> list[Activity]:
        return [
            one
            for one, _ in self._faults
            if one.active and one.fault.what == "shifted" and _is_meant(one.fault, number)
        ]


def _is_meant(fault: Fault, number: int) -> bool:
    """Whether a fault acts on the balise of this number."""
    return fault.values.get(ONLY.name, 0.0) in (0.0, number)


def _reports_text(reports: list[BaliseReport]) -> str:
    if not reports:
        return "none"
    return " ".join(f"{each.number}:{each.position_m:g}" if each.valid else "invalid" for each in reports)
