"""The train with faults, part by part: when its drive is powered, and what is an event for a fault that waits."""

from __future__ import annotations

import pytest

from hil_tests.support.plant_faults import fault, faulty
from railhil.bus.codes import CtlMode
from railhil.bus.telegrams import NotchCmd
from railhil.faults.model import Trigger
from railhil.plant_sim.status import LINE_VOLTAGE_MIN_PERCENT


@pytest.mark.parametrize("field", ["power_on", "pantograph_up", "main_breaker_closed"])
def test_a_drive_is_powered_when_nothing_is_open(field: str) -> None:
    plant = faulty()
    assert plant._powered
    setattr(plant.status, field, False)
    assert not plant._powered


def test_a_drive_is_powered_at_the_lowest_voltage() -> None:
    plant = faulty()
    plant.status.line_voltage_percent = LINE_VOLTAGE_MIN_PERCENT
    assert plant._powered
    plant.status.line_voltage_percent = LINE_VOLTAGE_MIN_PERCENT - 0.01
    assert not plant._powered


@pytest.mark.parametrize("mode", [one for one in CtlMode if one is not CtlMode.INITIALISING])
def test_a_new_mode_of_the_controller_is_an_event(mode: CtlMode) -> None:
    plant = faulty(fault("train.doors", "off", Trigger("event", mode.name.lower())))
    (one,) = plant.injections.activities
    plant.take(NotchCmd(0, mode=CtlMode.INITIALISING, life=0))
    plant.advance()
    plant.advance()
    assert not one.active
    plant.take(NotchCmd(0, mode=mode, life=1))
    plant.advance()
    plant.advance()
    assert one.active
    assert not plant.status.doors_closed_locked


def test_a_mode_that_lasts_is_no_event() -> None:
    plant = faulty(fault("train.doors", "off", Trigger("event", "initialising")))
    (one,) = plant.injections.activities
    modes = CtlMode.INITIALISING, next(one for one in CtlMode if one is not CtlMode.INITIALISING), CtlMode.INITIALISING
    active = []
    for life, mode in enumerate(modes):
        plant.take(NotchCmd(0, mode=mode, life=life))
        plant.advance()
        plant.advance()
        active.append(one.active)
    assert active == [False, False, True]
    assert plant.gate.counters["accepted"] == 3
