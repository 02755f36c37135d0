"""The first system: a train under automatic train operation, one notch, one target curve, one stop."""

from __future__ import annotations

from pathlib import Path

from railhil.faults.truth import Truth
from railhil.scenarios.system import System

#: Sentences that its runs have to keep.
REQUIREMENTS = Path(__file__).with_name("requirements.toml")
#: Places of faults inside its plant: sensors, traction and brake, mass and line, equipment.
INJECTS = (
    *("sensor.speed", "sensor.position", "sensor.balise", "actuator.traction", "actuator.brake"),
    *("train.mass", "train.gradient", "train.resistance", "train.adhesion", "train.model", "train.line_voltage"),
    *("train.power", "train.pantograph", "train.main_breaker", "train.doors", "train.parking_brake"),
    "train.safety_loop",
)

#: What the plant tells of the train as it is.
TRUTH = Truth(
    port="SIM_TRUTH",
    position="TruePos",
    speed="TrueSpeed",
    acceleration="TrueAccel",
    traction="TractionForce",
    levels={"TRN_WATCH": "WatchLevel", "NOTCH_CMD": "CtlMode"},
    beside=("TRN_WATCH",),
)

ATO = System(
    name="ato",
    title="one train, one notch, one stop",
    ports="railhil.dbc:ports.toml",
    scenarios="railhil.systems.ato.scenario.kind:TrainScenarios",
    plant="railhil.plant_sim.ato.train:TrainOnBus",
    controller="railhil.controller_node.ato.node:ControllerNode",
    laws="railhil.laws",
    law="ipfc",
    judging="railhil.systems.ato.judge.judging:JUDGING",
    pictures="railhil.systems.ato.panels:pictures",
    batch="railhil.systems.ato.batch:run_batch",
    kernel="railhil.systems.ato.batch.kernel",
    vectors="railhil.systems.ato.batch:VectorRuns",
    draws="railhil.systems.ato.scenario.perturb:name_draws",
    tuning="railhil.systems.ato.tuning:TUNING",
    faulty_plant="railhil.plant_sim.ato.faults.train:FaultyTrain",
    fmu_plant="railhil.plant_sim.ato.fmu:FmuTrain",
    digest="railhil.systems.ato.batch.replay:trace_digest",
    direct="railhil.run.coupled:direct_run",
    coupling="railhil.systems.ato.coupled:couple",
    audit="railhil.systems.ato.standstill:look",
    given="railhil.controller_node.ato.given:GivenNotchLaw",
    export="railhil.controller_node.ato.export:NotchControl",
    picture="railhil.systems.ato.panels:draw",
    bound="railhil.systems.ato.energy.section:list_bounds",
    new_line="railhil.systems.ato.scenario.importers.new_line:read_new_line",
    truth=TRUTH,
    requirements="railhil.systems.ato:REQUIREMENTS",
    named={"notch": "NOTCH_CMD.NotchCmd"},
    injects=INJECTS,
)
