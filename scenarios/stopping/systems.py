"""The system ``stop``: a train that stops at a platform, and learns from run to run."""

from __future__ import annotations

from railhil.faults.truth import Truth
from railhil.scenarios.system import System

#: Milestones of the system.
EVENTS = {"slide_begun": 32}

STOP = System(
    name="stop",
    title="precise stopping at a platform",
    ports="railhil.dbc:stop.toml",
    plant="railhil.plant_sim.stopping.plant:StopPlant",
    controller="railhil.controller_node.vector.node:VectorNode",
    laws="railhil.laws_stop",
    law="one_shot",
    arithmetic="float64",
    judging="railhil.supervisor.precise_stopping.judging:STOP",
    pictures="railhil.supervisor.precise_stopping.panels:pictures",
    events=EVENTS,
    numbered=True,
    own={
        "task": "railhil.scenarios.stopping.task:StopTask",
        "interface": "railhil.controller_node.laws.stopping.interface:STOP",
        "direct": "railhil.vector_bench:direct_run",
    },
    truth=Truth("TRUTH", position="TruePos", speed="TrueSpeed", acceleration="TrueAccel", beside=("TRUE_DATA",)),
)
