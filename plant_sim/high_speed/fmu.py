"""The high-speed train with an FMU for the motion of each unit; all other parts are the bench's."""

from __future__ import annotations

from functools import partial
from typing import Any

from railhil.fmu.names import Input, Output, Quantities
from railhil.plant_sim.fmu import TrainFmu, place_of
from railhil.plant_sim.high_speed.dynamics import GRAVITY_MPS2, Drive, Grades, UnitLimits, UnitMotion, grade_mps2
from railhil.plant_sim.high_speed.plant import HighSpeedPlant
from railhil.plant_sim.high_speed.train import STEP_S
from railhil.scenarios.plant_fmu import PlantFmu

_NEEDED = ("command_mps2", "position_m", "speed_mps", "drive_mps2")
_OUTSIDE = "outside_mps2"


def quantities_of(units: int) -> Quantities:
    """Quantities that an FMU of a unit exchanges with the bench; coupled units must take the force between them."""
    return Quantities(
        {
            "command_mps2": Input("m/s2", 0.0, 0.5),
            _OUTSIDE: Input("m/s2", 0.0, 0.02),
            "grade_permil": Input("permil", 0.0, 4.0),
        },
        {"position_m": Output("m"), "speed_mps": Output("m/s"), "drive_mps2": Output("m/s2")},
        _NEEDED if units == 1 else (*_NEEDED, _OUTSIDE),
    )


class FmuHighSpeedPlant(HighSpeedPlant):
    """Delays of the commands, watches, couplers, wind, wayside and sensors are as in :class:`HighSpeedPlant`.

    The FMU of a unit gets the commanded acceleration after its delay and the acceleration from outside. It answers with
    position, speed and the acceleration by traction and brake.
    """

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float, named: PlantFmu) -> None:
        super().__init__(scenario, seed, drawn, rate)
        train, limits = self.train, self.train.limits
        several = "" if len(train.units) == 1 else "each unit of the train"
        self.fmus: list[TrainFmu] = []
        for unit, mass_kg in zip(train.units, train.mass_kg, strict=True):
            start = unit.motion
            numbers = {
                "inertial_mass_kg": mass_kg,
                "gain": unit.data.gain,
                "lag_s": unit.data.lag_s,
                "pole_per_s": 1.0 / unit.data.lag_s,
                "traction_max_mps2": limits.traction_mps2,
                "braking_max_mps2": limits.braking_mps2,
                "power_w_per_kg": limits.power_w_per_kg,
                "resistance_a_mps2": limits.resistance_a,
                "resistance_b_per_s": limits.resistance_b,
                "resistance_c_per_m": limits.resistance_c,
                "grade_mps2_per_permil": GRAVITY_MPS2 / 1000.0,
                "start_position_m": start.position_m,
                "start_speed_mps": start.speed_mps,
                "start_drive_mps2": start.drive_mps2,
            }
            fmu = TrainFmu(named, quantities_of(len(train.units)), numbers, STEP_S, several)
            self.fmus.append(fmu)
            unit.moved = partial(_moved, fmu, place_of(fmu, start.position_m, start.speed_mps))


def _moved(
    fmu: TrainFmu,
    place_m: float,
    limits: UnitLimits,
    side: Drive,
    grades: Grades,
    now: UnitMotion,
    command_mps2: float,
    outside_mps2: float,
    step_s: float,
) -> UnitMotion:
    """As :func:`railhil.plant_sim.high_speed.dynamics.moved`; drive, resistance and grade are the FMU's.

    :param place_m: position of the unit at the FMU's 0.
    """
    found = fmu.step(
        {
            "command_mps2": command_mps2,
            "outside_mps2": outside_mps2,
            "grade_permil": grade_mps2(grades, now.position_m) / (GRAVITY_MPS2 / 1000.0),
        },
        step_s,
    )
    speed_mps = max(0.0, found["speed_mps"])
    accel_mps2 = (speed_mps - now.speed_mps) / step_s if speed_mps > 0.0 else 0.0
    return UnitMotion(place_m + found["position_m"], speed_mps, found["drive_mps2"], accel_mps2)
