"""The system ``line``: a train of ``ato`` on a line with stations, doors, timetable and train protection."""

from __future__ import annotations

from railhil.faults.truth import Truth
from railhil.scenarios.system import System

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
    events=EVENTS,
    truth=Truth(
        port="SIM_TRUTH",
        position="TruePos",
        speed="TrueSpeed",
        acceleration="TrueAccel",
        traction="TractionForce",
        levels={"TRN_WATCH": "WatchLevel", "NOTCH_CMD": "CtlMode", "ATP_STAT": "AtpCause"},
        beside=("TRN_WATCH",),
    ),
    named={"notch": "NOTCH_CMD.NotchCmd"},
)
