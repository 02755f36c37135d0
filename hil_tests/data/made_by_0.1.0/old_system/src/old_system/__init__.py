"""The system old_system for railhil: a cart moved by a force."""

from railhil.scenarios.system import System

SYSTEM = System(
    name="old_system",
    title="a cart moved by a force",
    ports="old_system:ports.toml",
    plant="old_system.plant:Cart",
    controller="railhil.controller_node.vector.node:VectorNode",
    laws="old_system.laws",
    law="hold",
    judging="old_system.judge:JUDGING",
    pictures="old_system.panels:pictures",
    # The system's own milestones, numbered from 32.
    events={"arrived": 32},
    own={
        "task": "old_system.task:CartTask",
        "interface": "old_system.wire:INTERFACE",
    },
)
