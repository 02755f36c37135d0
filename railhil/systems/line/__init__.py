"""The system ``line``: a train of ``ato`` on a line with stations, doors, timetable and train protection."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from railhil.scenarios.system import System
from railhil.systems import ato

#: Milestones of the system.
EVENTS = {
    "arrived": 32,
    "departure": 33,
    "doors_open": 34,
    "doors_locked": 35,
    "passed": 36,
    "missed": 37,
    "jog": 38,
    "door_refused": 39,
    "atp": 40,
    "turn_back": 41,
}

#: Its faults, with the required reactions.
CATALOGUE = Path(__file__).with_name("catalogue.toml")
#: Sentences that its runs have to keep.
REQUIREMENTS = Path(__file__).with_name("requirements.toml")
#: Places of faults inside its plant, besides those of a train of ``ato``: doors, stops, track side, train protection.
INJECTS = (
    *("train.door", "train.door_left", "train.door_right", "train.psd", "train.dwell", "train.signal"),
    *("train.authority", "train.atp", "train.holding_brake", "train.emergency_brake"),
    *("sensor.docking_loop", "sensor.atp_speed", "sensor.atp_odometer"),
)

LINE = System(
    name="line",
    title="one train on a line with stations, doors, timetable and train protection",
    ports="railhil.dbc:line.toml",
    scenarios="railhil.systems.line.scenario.kind:LineScenarios",
    plant="railhil.plant_sim.line.train:LineTrain",
    controller="railhil.controller_node.line.node:LineNode",
    laws="railhil.laws",
    law="ipfc_plus",
    judging="railhil.systems.line.judge.judging:JUDGING",
    pictures="railhil.systems.line.panels:pictures",
    bound="railhil.systems.line.energy:list_bounds",
    events=EVENTS,
    injects=(*ato.INJECTS, *INJECTS),
    catalogue="railhil.systems.line:CATALOGUE",
    requirements="railhil.systems.line:REQUIREMENTS",
    faulty_plant="railhil.plant_sim.line.faults.train:FaultyLineTrain",
    given="railhil.controller_node.ato.given:GivenNotchLaw",
    statement="railhil.systems.line.scenario.statement:STATEMENT",
    by_section=("tune", "export-c", "audit"),
    truth=replace(ato.TRUTH, levels={**ato.TRUTH.levels, "ATP_STAT": "AtpCause"}),
    named=ato.ATO.named,
)
