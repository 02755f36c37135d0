"""A train moved by hand under its protection."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from railhil.plant_sim.atp.protection import PERIOD_S, TrainProtection
from railhil.plant_sim.atp.readings import Authority, Demands, Readings, Track, TrainData
from railhil.systems.line.scenario.protection import Protection

TRAIN = TrainData(118.0, 80 / 3.6)
LEVEL = Track(((-118.0, 0.0),), ((-118.0, 100 / 3.6),), ((1, 500.0), (2, 700.0), (3, 900.0)))
FAR = Authority(5000.0, 5020.0)
NEAR = Authority(1010.0, 1030.0)


class Ride:
    """A train that is moved by hand, look by look; the odometer follows its speed."""

    def __init__(
        self, track: Track = LEVEL, authority: Authority | None = FAR, start_m: float = 0.0, **settings: Any
    ) -> None:
        self.protection = TrainProtection(replace(Protection(), **settings), TRAIN, track, start_m)
        self.authority = authority
        self.time_s = -PERIOD_S
        self.odometer_m = self.speed_mps = 0.0
        self.demands = Demands()
        self.look(0.0)

    def look(self, speed_mps: float, /, looks: int = 1, **changed: Any) -> Demands:
        """Go on for some periods with a speed, in one step up to it."""
        for _ in range(looks):
            self.time_s += PERIOD_S
            self.odometer_m += 0.5 * (self.speed_mps + speed_mps) * PERIOD_S
            self.speed_mps = speed_mps
            usual: dict[str, Any] = {
                "time_s": self.time_s,
                "speed_mps": speed_mps,
                "odometer_m": self.odometer_m,
                "balises": (),
                "authority": self.authority,
                "doors_locked": True,
                "train_held": False,
            }
            self.demands = self.protection.step(Readings(**usual | changed))
        return self.demands

    def go_to(self, odometer_m: float, speed_mps: float) -> Demands:
        """Accelerate within 10 s, then look every period until the odometer is there."""
        while self.speed_mps < speed_mps - 1e-9:
            self.look(min(self.speed_mps + speed_mps / 100, speed_mps))
        while self.odometer_m + speed_mps * PERIOD_S <= odometer_m:
            self.look(speed_mps)
        return self.demands


def demanded(demands: Demands) -> tuple[bool, bool, bool]:
    return demands.traction_cut, demands.service_brake, demands.emergency_brake
