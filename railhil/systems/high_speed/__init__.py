"""The systems of high-speed trains: ``hst1``, the train as one power unit, and ``emu3``, three units."""

from __future__ import annotations

from pathlib import Path

from railhil.faults.truth import Truth
from railhil.scenarios.system import System

#: Its faults, with the required reactions.
CATALOGUE = Path(__file__).with_name("catalogue.toml")
#: Sentences that their runs have to keep.
HST1_REQUIREMENTS = Path(__file__).with_name("requirements_hst1.toml")
EMU3_REQUIREMENTS = Path(__file__).with_name("requirements_emu3.toml")
#: Milestones of both systems.
EVENTS = {"emergency_called": 32, "arrived": 33}

#: Places of faults inside their plants: mutations of the dynamics, safety loop, sensors, traction and brakes.
INJECTS = (
    "train.gain",
    "train.lag",
    "train.delay",
    "train.safety_loop",
    "sensor.speed",
    "actuator.traction",
    "actuator.brake",
)


def _system(name: str, title: str, task: str, units: tuple[str, ...]) -> System:
    constant = name.upper()
    return System(
        name=name,
        title=title,
        ports=f"railhil.dbc:{name}.toml",
        plant="railhil.plant_sim.high_speed.plant:HighSpeedPlant",
        controller="railhil.controller_node.vector.node:VectorNode",
        laws="railhil.laws_high_speed",
        law="pid",
        # Most of its laws have no formats for fixed point.
        arithmetic="float64",
        judging=f"railhil.systems.high_speed.judge:{constant}",
        pictures="railhil.systems.high_speed.panels:pictures",
        events=EVENTS,
        task=f"railhil.systems.high_speed.task:{task}",
        interface=f"railhil.controller_node.high_speed.interface:{constant}",
        direct="railhil.run.coupled:direct_run",
        batch="railhil.systems.high_speed.batch:run_high_speed",
        one_by_one="railhil.systems.high_speed.batch:one_by_one",
        kernel="railhil.systems.high_speed.kernel",
        digest="railhil.batch.coupled:command_digest",
        audit_limits="railhil.systems.high_speed.judge:AUDIT_LIMITS",
        catalogue="railhil.systems.high_speed:CATALOGUE",
        requirements=f"railhil.systems.high_speed:{constant}_REQUIREMENTS",
        faulty_plant="railhil.plant_sim.high_speed.faults:FaultyHighSpeedPlant",
        fmu_plant="railhil.plant_sim.high_speed.fmu:FmuHighSpeedPlant",
        truth=Truth("TRUTH", position="TruePos", speed="TrueSpeed", acceleration="TrueAccel", beside=("MUTATION",)),
        units=units,
        injects=INJECTS,
    )


HST1 = _system("hst1", "high-speed train as one power unit", "SingleUnitTask", ())
EMU3 = _system("emu3", "high-speed train of three power units", "ThreeUnitsTask", ("UNIT1", "UNIT2", "UNIT3"))
