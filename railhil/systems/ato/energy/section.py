"""The bound of a section for ``railhil bound``; a scenario of ``ato`` is one section."""

from __future__ import annotations

from collections.abc import Iterator

from railhil.common.errors import InputError, Words
from railhil.scenarios.section_bound import SectionBound, WorkBound
from railhil.systems.ato.energy.ideal_train import shortest_time_s
from railhil.systems.ato.energy.programme import EnergyBound, energy_bound
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.model import Scenario


def list_bounds(scenario: Scenario) -> Iterator[SectionBound]:
    """The section of a scenario.

    :raises InputError: see :func:`bound_of_section`.
    """
    # A section that was cut out of a line has the name of the line before its own.
    yield bound_of_section(scenario, scenario.line.name.rpartition(": ")[2])


def bound_of_section(scenario: Scenario, name: str) -> SectionBound:
    """Shortest time of a section, and least work in its running time.

    :param name: of the section.
    :raises InputError: the running time is shorter than the shortest, or the train cannot climb a grade.
    """
    running_time_s = scenario.plan.running_time_s
    try:
        ideal = energy_bound(scenario, running_time_s)
        is_comfortable = running_time_s >= shortest_time_s(scenario, comfort=True)
        comfort = energy_bound(scenario, running_time_s, "comfort") if is_comfortable else None
    except CurveError as error:
        raise InputError(scenario.name, name, Words(str(error)), "a run that line and train permit") from None
    return SectionBound(
        name=name,
        length_m=scenario.plan.distance_m,
        running_time_s=running_time_s,
        shortest_s=ideal.shortest_s,
        ideal=_work_bound(ideal),
        comfort=None if comfort is None else _work_bound(comfort),
    )


def _work_bound(found: EnergyBound) -> WorkBound:
    return WorkBound(found.dual_kj, found.feasible_kj)
