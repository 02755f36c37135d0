"""The own axle sensor of the train protection with faults (:mod:`railhil.faults.sensors`).

It is sampled when the protection looks. A reading without a valid value is 0.
"""

from __future__ import annotations

from typing import Final

from railhil.faults.sensors import Quantity
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.faults.readings import FaultySensor
from railhil.plant_sim.line.onboard import OwnAxle

_MOST: Final = 2**31 - 1


class FaultyAxle:
    """The readings of :class:`OwnAxle` with faults.

    :param period_s: time between two looks.
    """

    def __init__(self, healthy: OwnAxle, injections: Injections, period_s: float) -> None:
        self._healthy = healthy
        self._speed = FaultySensor(injections, Quantity(1e4, 0, _MOST), period_s, "atp_speed")
        self._odometer = FaultySensor(injections, Quantity(1e3, -_MOST, _MOST), period_s, "atp_odometer")

    def speed_01mmps(self, speed_mps: float, tick: int) -> int:
        """Speed in 0.1 mm/s at a tick."""
        self._speed.sample(self._healthy.speed_01mmps(speed_mps, tick))
        reading = self._speed.sent()
        return reading.raw if reading.valid else 0

    def odometer_mm(self, position_m: float) -> int:
        """Odometer in mm at a position."""
        self._odometer.sample(self._healthy.odometer_mm(position_m))
        reading = self._odometer.sent()
        return reading.raw if reading.valid else 0

    def odometer_between_mm(self, position_m: float) -> int:
        """Odometer in mm at a balise, with the last error."""
        return self._healthy.odometer_between_mm(position_m) + self._odometer.error
