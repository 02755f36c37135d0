"""The train of the system ``ato`` with an FMU for its motion; all other parts are the bench's."""

from __future__ import annotations

from dataclasses import fields

from railhil.common.errors import InputError, Words
from railhil.fmu.names import Input, Output, Quantities
from railhil.plant_sim.ato.dynamics import Lag, Motion, Step, Window
from railhil.plant_sim.ato.forces import GradeTable, TrainConstants, mean_grade_permil
from railhil.plant_sim.ato.train import TrainOnBus
from railhil.plant_sim.fmu import TrainFmu
from railhil.scenarios.plant_fmu import PlantFmu
from railhil.systems.ato.scenario.model import Scenario, Train

QUANTITIES = Quantities(
    {
        "force_n": Input("N", 0.0, 3e5),
        "traction_allowed": Input("1", 1.0, 0.0),
        "brake_min_n": Input("N", 0.0, 1e5),
        "grade_permil": Input("permil", 0.0, 10.0),
    },
    {"position_m": Output("m"), "speed_mps": Output("m/s"), "effort_n": Output("N")},
    ("force_n", "position_m", "speed_mps", "effort_n"),
    ("traction_allowed",),
)
#: The train waits at the beginning of its run.
_AT_REST = 1e-6


class FmuTrain(TrainOnBus):
    """Commands, gate, watch, interlocks, sensors, balises and telegrams are as in :class:`TrainOnBus`.

    The FMU gets the force that the notch demands and the limits set by the train's protection. It answers with
    position, speed and force at the end of the step.
    """

    def __init__(self, scenario: Scenario, seed: int, drawn: bool, rate: float, named: PlantFmu) -> None:
        super().__init__(scenario, seed, drawn, rate)
        train = self._train
        self._fmu = TrainFmu(named, QUANTITIES, _numbers(train, self._constants), self._step_s)
        self.fmus = [self._fmu]
        if not self._fmu.variable_step and not float(self._delay_ticks).is_integer():
            found = Words(f"steps of {self._step_s:g} s only (canHandleVariableCommunicationStepSize is false)")
            delay_s = scenario.timing.loop_delay_s
            raise InputError(self._fmu.file, "step", found, f"parts of it too: the loop delay is {delay_s:g} s")
        begun = self._fmu.begun
        for name in ("position_m", "speed_mps"):
            if abs(begun[name]) > _AT_REST:
                variable = self._fmu.names.outputs[name].variable
                raise InputError(self._fmu.file, f"{variable}: start", begun[name], "0: the run begins at rest")
        self._brake_max_n = train.brake.force_max_n
        self._take = set(self._fmu.names.inputs)
        self._moved = self._fmu_step

    @property
    def motion(self) -> Motion:
        """Position, speed, force and mean acceleration now."""
        return self._motion

    @property
    def accel_mps2(self) -> float:
        """Mean acceleration of the last step, in m/s2."""
        return self._motion.accel_mps2

    def _fmu_step(
        self,
        constants: TrainConstants,
        grades: GradeTable,
        window: Window,
        motion: Motion,
        steady_n: float,
        lag_step: Lag,
    ) -> Step:
        """As :func:`railhil.plant_sim.ato.dynamics.step`; actuator and forces are the FMU's."""
        step_s = lag_step.step_s
        brake_min_n = min(window.brake_min_n, self._brake_max_n)
        force_n = steady_n
        # The demanded force contains the limits for which the FMU has no input.
        if "traction_allowed" not in self._take and not window.traction:
            force_n = min(force_n, 0.0)
        if "brake_min_n" not in self._take and brake_min_n > 0.0:
            force_n = min(force_n, -brake_min_n)
        given = {
            "force_n": force_n,
            "traction_allowed": float(window.traction),
            "brake_min_n": brake_min_n,
            "grade_permil": mean_grade_permil(grades, motion.position_m),
        }
        found = self._fmu.step(given, step_s)
        position_m, speed_mps = found["position_m"], max(0.0, found["speed_mps"])
        before_mps = motion.speed_mps
        accel_mps2 = (speed_mps - before_mps) / step_s if speed_mps > 0.0 else 0.0
        moved_m = position_m - motion.position_m
        from_s, to_s = 0.0, step_s
        if before_mps <= 0.0:
            # Departed inside the step, or not at all.
            from_s = step_s - min(step_s, 2 * moved_m / speed_mps) if speed_mps > 0.0 else step_s
        elif speed_mps <= 0.0:
            to_s = min(step_s, max(0.0, 2 * moved_m / before_mps))
        return Step(Motion(position_m, speed_mps, found["effort_n"], accel_mps2), from_s, to_s)


def _numbers(train: Train, constants: TrainConstants) -> dict[str, float]:
    """Values for parameters of an FMU, by name: keys of the train, resistance in SI units, force limits."""
    found = {field.name: getattr(train, field.name) for field in fields(train)}
    found |= constants._asdict()
    # The mass of the constants includes the rotating parts.
    found |= {"mass_kg": train.mass_kg, "inertial_mass_kg": constants.mass_kg}
    for side, limit in (("traction", constants.traction), ("brake", constants.brake)):
        found |= {f"{side}_force_max_n": limit.force_max_n, f"{side}_power_max_w": limit.power_max_w}
    return {name: float(value) for name, value in found.items() if isinstance(value, (int, float))}
