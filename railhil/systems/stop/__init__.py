"""The system ``stop``: a train that stops at a platform, and learns from run to run."""

from __future__ import annotations

from pathlib import Path

from railhil.faults.truth import Truth
from railhil.scenarios.system import System

#: Its faults, with the required reactions.
CATALOGUE = Path(__file__).with_name("catalogue.toml")
#: Sentences that its runs have to keep.
REQUIREMENTS = Path(__file__).with_name("requirements.toml")
#: Milestones of the system.
EVENTS = {"slide_begun": 32}

#: Places of faults inside its plant: mutations of brake and rail, safety loop, sensors, traction and brake.
INJECTS = (
    "train.gain",
    "train.lag",
    "train.delay",
    "train.adhesion",
    "train.safety_loop",
    "sensor.speed",
    "sensor.position",
    "sensor.balise",
    "actuator.traction",
    "actuator.brake",
)

STOP = System(
    name="stop",
    title="precise stopping at a platform",
    ports="railhil.dbc:stop.toml",
    plant="railhil.plant_sim.stop.plant:StopPlant",
    controller="railhil.controller_node.vector.node:VectorNode",
    laws="railhil.laws_stop",
    law="ilc_stop",
    arithmetic="float64",
    judging="railhil.systems.stop.judge:STOP",
    pictures="railhil.systems.stop.panels:pictures",
    events=EVENTS,
    numbered=True,
    injects=INJECTS,
    task="railhil.systems.stop.task:StopTask",
    interface="railhil.controller_node.stop.interface:STOP",
    direct="railhil.run.coupled:direct_run",
    batch="railhil.systems.stop.batch:run_stops",
    one_by_one="railhil.systems.stop.batch:one_by_one",
    sequence_batch="railhil.systems.stop.batch:run_together",
    kernel="railhil.systems.stop.kernel",
    digest="railhil.batch.coupled:command_digest",
    catalogue="railhil.systems.stop:CATALOGUE",
    requirements="railhil.systems.stop:REQUIREMENTS",
    faulty_plant="railhil.plant_sim.stop.faults:FaultyStopPlant",
    fmu_plant="railhil.plant_sim.stop.fmu:FmuStopPlant",
    truth=Truth("TRUTH", position="TruePos", speed="TrueSpeed", acceleration="TrueAccel", beside=("TRUE_DATA",)),
)
