"""Two carts on a spring: a system for railhil with two units, each with its own ports."""

from railhil.faults.truth import Truth
from railhil.scenarios.system import System

SYSTEM = System(
    name="two_carts",
    title="two carts on a spring",
    ports="two_carts:ports.toml",
    plant="two_carts.plant:Carts",
    controller="railhil.controller_node.vector.node:VectorNode",
    laws="two_carts.laws",
    law="apart",
    judging="two_carts.judge:JUDGING",
    pictures="two_carts.panels:pictures",
    events={"arrived": 40},
    truth=Truth("TRUTH", position="TruePos1", speed="TrueSpeed1"),
    units=("UNIT1", "UNIT2"),
    task="two_carts.task:CartsTask",
    interface="two_carts.wire:INTERFACE",
)
