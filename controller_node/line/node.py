"""The controller of the system ``line`` on the bus."""

from __future__ import annotations

from typing import Any

from railhil.controller_node.ato.node import ControllerNode
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.line.scenario.model import LineScenario


class LineNode(ControllerNode):
    """A station automaton over a law for each section."""

    def __init__(self, scenario: LineScenario, law: LawSpec, controller: Any = None, **bus: Any) -> None:
        super().__init__(scenario, law, controller, **bus)
