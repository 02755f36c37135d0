"""The systems of high-speed trains: ``hst1``, the train as one power unit, and ``emu3``, three units."""

from __future__ import annotations

from railhil.faults.model import Truth
from railhil.scenarios.system import System

#: Milestones of both systems.
EVENTS = {"emergency_called": 32, "arrived": 33}

#: Places of faults inside their plants: mutations of the dynamics, sensors, traction and brakes.
INJECTS = ("train.gain", "train.lag", "train.delay", "sensor.speed", "actuator.traction", "actuator.brake")

HST1 = System(
    name="hst1",
    title="high-speed train as one power unit",
    ports="railhil.dbc:hst1.toml",
    plant="railhil.plant_sim.high_speed.plant:HighSpeedPlant",
    controller="railhil.controller_node.vector.node:VectorNode",
    laws="railhil.laws_high_speed",
    law="pid",
    # Most of its laws have no formats for fixed point.
    arithmetic="float64",
    judging="railhil.supervisor.high_speed.judging:HST1",
    pictures="railhil.supervisor.high_speed.panels:pictures",
    events=EVENTS,
    own={
        "task": "railhil.scenarios.high_speed.task:SingleUnitTask",
        "interface": "railhil.controller_node.laws.high_speed.interface:HST1",
        "direct": "railhil.vector_bench:direct_run",
        "faulty_plant": "railhil.plant_sim.high_speed.faults:FaultyHighSpeedPlant",
    },
    truth=Truth(
        "TRUTH",
        position="TruePos",
        speed="TrueSpeed",
        acceleration="TrueAccel",
        beside=("MUTATION",),
    ),
    injects=INJECTS,
)
