"""The train of the system ``stop`` with an FMU for its motion; all other parts are the bench's."""

from __future__ import annotations

from bisect import bisect_right
from functools import partial
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.fmu.names import Input, Output, Quantities
from railhil.plant_sim.fmu import TrainFmu, place_of
from railhil.plant_sim.stop.brake import GRAVITY_MPS2, Course, Going, Motion
from railhil.plant_sim.stop.draws import RunDraw, TrainDraw
from railhil.plant_sim.stop.plant import StopPlant
from railhil.plant_sim.stop.train import StopTrain
from railhil.scenarios.plant_fmu import PlantFmu
from railhil.wire.stop_counts import SAMPLE_S

QUANTITIES = Quantities(
    {
        "command_mps2": Input("m/s2", 0.0, 1.0),
        "outside_mps2": Input("m/s2", 0.0, 0.02),
        "grade_permil": Input("permil", 0.0, 3.0),
    },
    {"position_m": Output("m"), "speed_mps": Output("m/s"), "drive_mps2": Output("m/s2"), "slides": Output("1")},
    ("command_mps2", "position_m", "speed_mps", "drive_mps2"),
)


class FmuStopPlant(StopPlant):
    """Delay, notches and gain of the brake, watch, grades, sensors and balises are as in :class:`StopPlant`.

    The FMU gets the acceleration that traction and brake are to reach. It answers with position, speed, the
    acceleration reached before any loss, and whether the wheels slide.

    :raises InputError: the FMU cannot make steps of any length, which commands within a cycle need.
    """

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float, run_number: int, named: PlantFmu) -> None:
        self._named = named
        self.fmus: list[TrainFmu] = []
        super().__init__(scenario, seed, drawn, rate, run_number)

    def made_train(self, train: TrainDraw, run: RunDraw, seed: int, run_number: int) -> StopTrain:
        """The train of the run, moved by the FMU."""
        made = super().made_train(train, run, seed, run_number)
        course, start = made.course, made.motion
        numbers = {
            "lag_s": course.lag_s,
            "pole_per_s": 1.0 / course.lag_s,
            "low_speed_loss": course.loss,
            "low_speed_mps": course.loss_below_mps,
            "adhesion_mps2": course.adhesion_mps2,
            "grade_mps2_per_permil": GRAVITY_MPS2 / 1000.0,
            "start_position_m": start.position_m,
            "start_speed_mps": start.speed_mps,
            "start_drive_mps2": start.drive_mps2,
        }
        fmu = TrainFmu(self._named, QUANTITIES, numbers, SAMPLE_S)
        if not fmu.variable_step:
            found = Words("canHandleVariableCommunicationStepSize is false")
            raise InputError(fmu.file, "step", found, "true: commands begin to act within a step")
        self.fmus = [fmu]
        made.gone_on = partial(_gone_on, fmu, place_of(fmu, start.position_m, start.speed_mps))
        return made


def _gone_on(
    fmu: TrainFmu, place_m: float, course: Course, going: Going, target_mps2: float, wander_mps2: float, end_s: float
) -> Going:
    """As :func:`railhil.plant_sim.stop.brake.gone_on`, always to ``end_s``; brake, loss and rail are the FMU's.

    :param place_m: position of the train at the FMU's 0.
    """
    before, step_s = going.motion, end_s - going.now_s
    found = fmu.step(
        {
            "command_mps2": target_mps2,
            "outside_mps2": wander_mps2,
            "grade_permil": -course.grades_mps2[going.piece] / (GRAVITY_MPS2 / 1000.0),
        },
        step_s,
    )
    position_m, speed_mps = place_m + found["position_m"], max(0.0, found["speed_mps"])
    stopped_s = going.stopped_s
    if speed_mps == 0.0 and before.speed_mps > 0.0:
        stopped_s = going.now_s + min(step_s, max(0.0, 2.0 * (position_m - before.position_m) / before.speed_mps))
    piece = bisect_right(course.bounds_m, position_m)
    slides = found.get("slides", 0.0) > 0.5
    return Going(end_s, Motion(position_m, speed_mps, found["drive_mps2"]), piece, slides, stopped_s)
