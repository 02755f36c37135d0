"""Doors of the train and of the platform as an automaton of ticks."""

from __future__ import annotations

import pytest

from railhil.plant_sim.line.doors import (
    CLOSING,
    FAULT,
    LEFT,
    LOCKED,
    OBSTRUCTED,
    OPEN,
    OPENING,
    RIGHT,
    DoorSet,
    TrainDoors,
    door_ticks,
)
from railhil.systems.line.scenario.model import Doors

TICKS = door_ticks(Doors(), 0.01)


def steps(door: DoorSet | TrainDoors, ticks: int) -> None:
    for _ in range(ticks):
        door.step()


def open_doors(obstacles: int = 0, reopen_max: int = 3) -> DoorSet:
    door = DoorSet(TICKS, reopen_max)
    door.obstacles = obstacles
    door.open()
    steps(door, 250)
    assert door.state == OPEN
    return door


def closing_states(door: DoorSet, ticks: int) -> list[int]:
    """States of doors that are ordered to close for so long, without repetitions."""
    states = [door.state]
    for _ in range(ticks):
        door.close()
        door.step()
        if door.state != states[-1]:
            states.append(door.state)
    return states


def test_doors_open_in_two_and_a_half_seconds_and_close_in_three() -> None:
    door = DoorSet(TICKS, 3)
    door.open()
    steps(door, 249)
    assert door.state == OPENING
    steps(door, 1)
    assert door.state == OPEN
    door.close()
    steps(door, 299)
    assert (door.state, door.is_locked) == (CLOSING, False)
    steps(door, 1)
    assert (door.state, door.is_locked) == (LOCKED, True)


def test_the_doors_of_the_platform_open_three_tenths_later() -> None:
    doors = TrainDoors(Doors(), 0.01)
    doors.has_psd = True
    doors.open(LEFT)
    steps(doors, 250)
    assert (doors.left.state, doors.right.state, doors.psd.state) == (OPEN, LOCKED, OPENING)
    assert not doors.are_open
    steps(doors, 30)
    assert doors.are_open


def test_an_obstacle_opens_the_doors_and_they_close_again() -> None:
    door = open_doors(obstacles=1)
    assert closing_states(door, 1000) == [OPEN, CLOSING, OBSTRUCTED, OPENING, OPEN, CLOSING, LOCKED]
    assert (door.obstructions, door.reopened) == (1, 0)


@pytest.mark.parametrize("most", [0, 1, 3])
def test_more_obstacles_than_allowed_are_a_fault(most: int) -> None:
    door = open_doors(obstacles=most + 1, reopen_max=most)
    states = closing_states(door, 5000)
    assert states[-2:] == [CLOSING, FAULT]
    assert states.count(OBSTRUCTED) == door.reopened == most
    assert not door.is_locked


def test_stuck_doors_open_and_fail_to_close() -> None:
    door = open_doors()
    door.is_stuck = True
    assert closing_states(door, 400) == [OPEN, CLOSING, FAULT]


def test_slow_doors_take_longer() -> None:
    door = DoorSet(TICKS, 3)
    door.slowness = 3.0
    door.open()
    steps(door, 749)
    assert door.state == OPENING
    steps(door, 1)
    assert door.state == OPEN


def test_isolated_doors_count_as_locked_and_do_not_open() -> None:
    doors = TrainDoors(Doors(), 0.01)
    doors.has_psd = True
    doors.psd.isolate()
    doors.open(LEFT | RIGHT)
    steps(doors, 250)
    assert doors.are_open
    assert doors.is_psd_locked
    assert not doors.are_locked


def test_closed_doors_without_their_lock_are_not_locked() -> None:
    doors = TrainDoors(Doors(), 0.01)
    assert doors.are_locked
    doors.right.has_lost_lock = True
    assert not doors.are_locked
