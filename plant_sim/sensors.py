"""Axle sensors of the train: speed and odometer, with worn wheel, noise and resolution."""

from __future__ import annotations

from railhil.scenarios import streams
from railhil.scenarios.model import Sensors

#: Speed noise is drawn in blocks of so many ticks.
_NOISE_BLOCK = 4096


class AxleSensors:
    """Readings of one run. Speed noise is drawn per tick from its own stream, whether anybody reads it or not.

    The readings use ``sensors`` and ``noise_mps`` alone, so that they can be compiled for many trains.
    """

    def __init__(self, sensors: Sensors, seed: int) -> None:
        self.sensors = sensors
        self._source = streams.generator(seed, streams.SPEED_NOISE)
        self._block_mps = self._next_block_mps()
        #: Noise of the speed at the current tick.
        self.noise_mps = self._block_mps[0]

    def begin_tick(self, tick: int) -> None:
        """Take the noise of a tick; ticks come in order from 1 (that of tick 0 is there from the start)."""
        index = tick % _NOISE_BLOCK
        if index == 0:
            self._block_mps = self._next_block_mps()
        self.noise_mps = self._block_mps[index]

    def _next_block_mps(self) -> list[float]:
        draws = self._source.standard_normal(_NOISE_BLOCK)
        noise: list[float] = (draws * self.sensors.speed_noise_sigma_mps).tolist()
        return noise

    def speed_01mmps(self, speed_mps: float) -> int:
        """Reading of a true speed >= 0, in 0.1 mm/s. A standing axle reads 0, and none runs backwards."""
        if speed_mps <= 0.0:
            return 0
        sensors = self.sensors
        lsb_mps = sensors.speed_lsb_mps
        counts = round((speed_mps * sensors.wheel_factor + self.noise_mps) / lsb_mps)
        return round(counts * lsb_mps * 1e4) if counts > 0 else 0

    def odometer_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, to its resolution."""
        lsb_m = self.sensors.odometer_lsb_m
        return round(round(position_m * self.sensors.wheel_factor / lsb_m) * lsb_m * 1000)

    def odometer_between_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, interpolated between its counts as a balise reader does."""
        return round(position_m * self.sensors.wheel_factor * 1000)
