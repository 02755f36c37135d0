"""A law knows the nominal scenario only: nothing that a run is drawn with reaches its tables."""

from __future__ import annotations

from dataclasses import replace

import pytest

from railhil.controller_node.laws import names
from railhil.controller_node.program.model import Program
from railhil.controller_node.program.record import record
from railhil.scenarios.load import load
from railhil.scenarios.model import Perturbations, Scenario
from railhil.scenarios.perturb import perturbed
from railhil.scenarios.run_spec import LawSpec

SCENARIO = load("yizhuang_04_jiugong_yizhuang_qiao")
DRAWN = perturbed(load("lvshun_tieshan_worn_wheels"), 1003)


def recorded(scenario: Scenario, law: str) -> Program:
    return record(scenario, LawSpec(law))


@pytest.mark.parametrize("law", names())
def test_nothing_drawn_is_in_the_program(law: str) -> None:
    """Sensors, loop delay, where the balises really lie, and the ranges from which all is drawn."""
    balises = tuple(replace(balise, true_m=balise.true_m + 7.0) for balise in SCENARIO.line.balises)
    assert balises
    told = replace(
        SCENARIO,
        sensors=DRAWN.sensors,
        timing=replace(SCENARIO.timing, loop_delay_s=DRAWN.timing.loop_delay_s),
        line=replace(SCENARIO.line, balises=balises),
        perturbations=Perturbations(),
    )
    assert told.sensors != SCENARIO.sensors
    assert told.timing != SCENARIO.timing
    assert told.perturbations != SCENARIO.perturbations
    assert recorded(told, law) == recorded(SCENARIO, law)


def test_what_a_law_may_know_is_in_the_program() -> None:
    """The comparison sees a difference when there is one."""
    heavier = replace(SCENARIO, train=replace(SCENARIO.train, inertial_mass_kg=SCENARIO.train.inertial_mass_kg * 1.1))
    assert recorded(heavier, "ipfc_plus") != recorded(SCENARIO, "ipfc_plus")
