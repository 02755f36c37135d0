"""Axle sensors of the train: speed and odometer, with wheel wear, noise and resolution.

The batch compiles the two readings (:mod:`railhil.common.compilable` says what they may be made of).
"""

from __future__ import annotations

from typing import Final

from railhil.common.compilable import compilable_functions
from railhil.common.floats import rounded
from railhil.scenarios import streams
from railhil.scenarios.counted_normals import key_of, normals
from railhil.systems.ato.scenario.model import Sensors

#: Speed noise is drawn in blocks of this many ticks.
_NOISE_BLOCK: Final = 4096


def speed_reading_01mmps(speed_mps: float, noise_mps: float, wheel_factor: float, lsb_mps: float) -> int:
    """Reading of a true speed >= 0, in 0.1 mm/s. A standing axle reads 0, and the reading is never negative."""
    if speed_mps <= 0.0:
        return 0
    counts = rounded((speed_mps * wheel_factor + noise_mps) / lsb_mps)
    return rounded(counts * lsb_mps * 1e4) if counts > 0 else 0


def odometer_reading_mm(position_m: float, wheel_factor: float, lsb_m: float) -> int:
    """Odometer at a true position, in mm, to its resolution."""
    return rounded(rounded(position_m * wheel_factor / lsb_m) * lsb_m * 1000)


class AxleSensors:
    """Readings of one run. Each tick has its own speed noise, whether it is read or not, and however often."""

    def __init__(self, sensors: Sensors, seed: int) -> None:
        self.sensors = sensors
        self._key = key_of(seed, streams.AXLE_NOISE)
        self._first_tick = 0
        self._block_mps: list[float] = []

    def speed_01mmps(self, speed_mps: float, tick: int) -> int:
        """Reading of a true speed >= 0 at a tick, in 0.1 mm/s."""
        sensors = self.sensors
        return speed_reading_01mmps(speed_mps, self.noise_mps(tick), sensors.wheel_factor, sensors.speed_lsb_mps)

    def noise_mps(self, tick: int) -> float:
        """Noise of the speed at a tick."""
        index = tick - self._first_tick
        if not 0 <= index < len(self._block_mps):
            index = tick % _NOISE_BLOCK
            self._first_tick = tick - index
            draws = normals(self._key, self._first_tick, _NOISE_BLOCK)
            self._block_mps = (draws * self.sensors.speed_noise_sigma_mps).tolist()
        return self._block_mps[index]

    def odometer_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, to its resolution."""
        return odometer_reading_mm(position_m, self.sensors.wheel_factor, self.sensors.odometer_lsb_m)

    def odometer_between_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, interpolated between its counts as a balise reader does."""
        return round(position_m * self.sensors.wheel_factor * 1000)


compilable_functions(speed_reading_01mmps, odometer_reading_mm)
