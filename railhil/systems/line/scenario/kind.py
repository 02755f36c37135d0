"""The scenarios of ``line``: read from files, written into run folders and read back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, cast

from pydantic import BaseModel

from railhil.scenarios.layers import Layers, faults_of_rows
from railhil.systems.ato.scenario.kind import TrainScenarios, scenario_of
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.line.scenario.canonical import scenario_sha256
from railhil.systems.line.scenario.model import LineScenario, StationStop


class LineScenarios(TrainScenarios):
    """Scenarios of ``line``, see :class:`railhil.scenarios.task.ScenarioKind`."""

    scenario_type: ClassVar[type[Scenario]] = LineScenario

    def read(self, layers: Layers) -> LineScenario:
        # A record's scenario is complete: readers of records need neither tables of files nor their checks.
        from railhil.systems.line.scenario.files import read_line_scenario

        rows = layers.merge().get("fault", ())

        def faults_of(stops: Sequence[StationStop]) -> tuple[str, ...]:
            if not rows:
                return ()
            from railhil.systems.line.scenario.marks import find_marks

            return faults_of_rows(rows, self._system, lambda row: layers.origin("fault", row), find_marks(stops))

        return read_line_scenario(layers, self._system.contract, faults_of)

    def restore(self, fields: dict[str, Any], file: Path) -> LineScenario:
        scenario = cast("LineScenario", scenario_of(fields, file, self.scenario_type))
        return replace(scenario, sha256=scenario_sha256(scenario))

    @property
    def file_type(self) -> type[BaseModel]:
        from railhil.systems.line.scenario.schema import LineScenarioFile

        return LineScenarioFile
