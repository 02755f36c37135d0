"""The scenarios of ``line``: read from files, written into run folders and read back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, cast

from pydantic import BaseModel

from railhil.common.errors import InputError
from railhil.scenarios.layers import Layers, faults_of_rows
from railhil.systems.ato.scenario.canonical import scenario_sha256 as section_sha256
from railhil.systems.ato.scenario.kind import TrainScenarios, scenario_of
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.line.scenario.canonical import scenario_sha256
from railhil.systems.line.scenario.keys import MEANING, USUAL
from railhil.systems.line.scenario.model import LineScenario, StationStop, find_marks


class LineScenarios(TrainScenarios):
    """Scenarios of ``line``, see :class:`railhil.scenarios.task.ScenarioKind`."""

    meaning: ClassVar[Mapping[str, str]] = MEANING
    usual: ClassVar[tuple[str, ...]] = USUAL
    scenario_type: ClassVar[type[Scenario]] = LineScenario

    def read(self, layers: Layers) -> Scenario:
        """The scenario of a line, or that of the section which the key ``section`` names.

        A section is a scenario of ``ato``, and so are its faults.

        :raises InputError: the scenario is wrong, or has no such section.
        """
        # A record's scenario is complete: readers of records need neither tables of files nor their checks.
        from railhil.systems.line.scenario.files import read_line_scenario

        table = layers.merge()
        rows, number = table.get("fault", ()), table.get("section")

        def faults_of(stops: Sequence[StationStop]) -> tuple[str, ...]:
            if not rows or number is not None:
                return ()
            return faults_of_rows(rows, self._system, lambda row: layers.origin("fault", row), find_marks(stops))

        line = read_line_scenario(layers, self._system.contract, faults_of)
        if number is None:
            return line
        if number > len(line.sections):
            allowed = f"1 to {len(line.sections)}, a section of {line.name}"
            raise InputError(layers.origin("section"), "section", number, allowed)
        from railhil.systems.line.scenario.sections import section_scenario

        section = section_scenario(line, number - 1)
        faults = faults_of_rows(rows, section.installed_system, lambda row: layers.origin("fault", row))
        section = replace(section, faults=faults)
        return replace(section, sha256=section_sha256(section))

    def restore(self, fields: dict[str, Any], file: Path) -> LineScenario:
        scenario = cast("LineScenario", scenario_of(fields, file, self.scenario_type))
        return replace(scenario, sha256=scenario_sha256(scenario))

    @property
    def file_type(self) -> type[BaseModel]:
        from railhil.systems.line.scenario.schema import LineScenarioFile

        return LineScenarioFile
