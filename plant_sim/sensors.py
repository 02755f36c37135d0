"""Axle sensors of the train: speed and odometer, with wheel wear, noise and resolution.

The batch compiles the two readings (:mod:`railhil.common.compilable` says what they may be made of).
"""

from __future__ import annotations

from typing import Final

from railhil.common.compilable import compilable_functions
from railhil.common.floats import rounded
from railhil.scenarios import streams
from railhil.scenarios.model import Sensors

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
    """Readings of one run. Speed noise is drawn in every tick from its own stream, whether it is read or not."""

    def __init__(self, sensors: Sensors, seed: int) -> None:
        self.sensors = sensors
        self._source = streams.generator(seed, streams.SPEED_NOISE)
        self._block_mps = self._next_block_mps()
        #: Noise of the speed at the current tick.
        self.noise_mps = self._block_mps[0]

    def begin_tick(self, tick: int) -> None:
        """Take the noise of a tick; ticks come in order from 1 (the noise of tick 0 is drawn at the start)."""
        index = tick % _NOISE_BLOCK
        if index == 0:
            self._block_mps = self._next_block_mps()
        self.noise_mps = self._block_mps[index]

    def _next_block_mps(self) -> list[float]:
        draws = self._source.standard_normal(_NOISE_BLOCK)
        noise: list[float] = (draws * self.sensors.speed_noise_sigma_mps).tolist()
        return noise

    def speed_01mmps(self, speed_mps: float) -> int:
        """Reading of a true speed >= 0, in 0.1 mm/s."""
        sensors = self.sensors
        return speed_reading_01mmps(speed_mps, self.noise_mps, sensors.wheel_factor, sensors.speed_lsb_mps)

    def odometer_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, to its resolution."""
        return odometer_reading_mm(position_m, self.sensors.wheel_factor, self.sensors.odometer_lsb_m)

    def odometer_between_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, interpolated between its counts as a balise reader does."""
        return round(position_m * self.sensors.wheel_factor * 1000)


compilable_functions(speed_reading_01mmps, odometer_reading_mm)
