"""What plants of systems that plug in have beside their physics."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from railhil.bus.layout import CHECK_CORRECT, Telegram
from railhil.plant_sim.timed_run import TimedPlant
from railhil.wire.ato import NotchCmd, TrnSpeed

SCENARIO = SimpleNamespace(timing=SimpleNamespace(base_tick_ns=10_000_000), task=SimpleNamespace(duration_s=1.0))


class Plant(TimedPlant):
    """Writes down what acts."""

    def __init__(self) -> None:
        super().__init__(SCENARIO, 0, {})
        self.acted: list[Telegram] = []

    def act(self, telegram: Telegram) -> None:
        self.acted.append(telegram)


def test_a_repeated_or_old_command_does_not_act() -> None:
    plant = Plant()
    commands = [NotchCmd(1, life=3), NotchCmd(2, life=3), NotchCmd(3, life=2), NotchCmd(4, life=4), NotchCmd(5, life=6)]
    for command in commands:
        plant.take(command)
    assert plant.acted == [commands[0], commands[3], commands[4]]
    assert plant.refused == {"duplicate": 1, "out_of_order": 1, "gap": 1}


@pytest.mark.parametrize("check", [value for value in range(4) if value != CHECK_CORRECT])
def test_an_invalid_command_does_not_act(check: int) -> None:
    plant = Plant()
    plant.take(NotchCmd(1, life=0, check=check))
    assert plant.acted == []
    assert plant.refused == {"check_variable": 1}


def test_each_port_has_its_own_life_sign() -> None:
    plant = Plant()
    commands = [NotchCmd(1, life=3), TrnSpeed(1, life=3), NotchCmd(2, life=4), TrnSpeed(2, life=4)]
    for command in commands:
        plant.take(command)
    assert plant.acted == commands
    assert not plant.refused


def test_a_milestone_may_be_told_only_once() -> None:
    plant = Plant()
    for place in (1, 2):
        plant.milestone("arrived", place, once=True)
        plant.milestone("passed", place)
    assert [(item.kind, item.position_01mm) for item in plant.drain_events()] == [
        ("arrived", 1),
        ("passed", 1),
        ("passed", 2),
    ]
    plant.milestone("arrived", 3, once=True)
    assert plant.drain_events() == []
