"""The bounds of a line's sections for ``railhil bound``."""

from __future__ import annotations

from collections.abc import Iterator

from railhil.scenarios.section_bound import SectionBound
from railhil.systems.ato.energy.section import bound_of_section
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.sections import section_scenario


def list_bounds(scenario: LineScenario) -> Iterator[SectionBound]:
    """The sections in running order, each in the time of the timetable.

    :raises InputError: see :func:`railhil.systems.ato.energy.section.bound_of_section`.
    """
    for index, section in enumerate(scenario.sections):
        here, there = scenario.stops[section.departure], scenario.stops[section.arrival]
        yield bound_of_section(section_scenario(scenario, index), f"{here.name} - {there.name}")
