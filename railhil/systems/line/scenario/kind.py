"""The scenarios of ``line``: read from files, written into run folders and read back."""

from __future__ import annotations

from typing import ClassVar

from railhil.systems.ato.scenario.kind import TrainScenarios
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.line.scenario.model import LineScenario


class LineScenarios(TrainScenarios):
    """Scenarios of ``line``, see :class:`railhil.scenarios.task.ScenarioKind`."""

    scenario_type: ClassVar[type[Scenario]] = LineScenario
