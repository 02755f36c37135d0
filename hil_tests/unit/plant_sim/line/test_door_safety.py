"""Orders, faults and motions in any order: no door opens in motion, outside the window or on the wrong side, and no
traction acts with a door that is not locked."""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import replace

import pytest

from hil_tests.support.lines import STOPS, four_stops
from railhil.bus.acceptance import Acceptance
from railhil.plant_sim.ato.dynamics import Motion
from railhil.plant_sim.ato.gate import CommandGate
from railhil.plant_sim.ato.train_watch import TrainWatch
from railhil.plant_sim.line.docking import ERROR_MAX_M, DockingLoop
from railhil.plant_sim.line.doors import LEFT, OPEN, OPENING, RIGHT, SIDES, TrainDoors
from railhil.plant_sim.line.journey import Journey
from railhil.plant_sim.line.train import LineTrain
from railhil.systems.line.scenario.dwell import DrawnDwell
from railhil.systems.line.scenario.model import Doors, LineScenario, Side
from railhil.wire.ato import NotchCmd
from railhil.wire.line import DoorCmd

SIDE_NAMES: tuple[Side, ...] = ("left", "right", "both", "none")


def lines() -> list[LineScenario]:
    """The line of four stops with each kind of platform, with and without doors of the platform.

    Its doors are fast: the automaton is the same, and a sequence takes fewer ticks.
    """
    plain = four_stops(doors=Doors(open_s=0.2, close_s=0.3))
    plain = replace(plain, atp=replace(plain.atp, enabled=False))
    return [
        replace(plain, stops=(STOPS[0], replace(STOPS[1], platform=side, psd=psd), *STOPS[2:]))
        for side in SIDE_NAMES
        for psd in (True, False)
    ]


class Sequence:
    """One generated sequence on a train that is reused: a new train for each would take longer than the sequence."""

    def __init__(self, train: LineTrain, line: LineScenario, seed: int) -> None:
        self.train, self.line, self.draw = train, line, random.Random(seed)
        self.opened = self.pulled = 0
        self.lives = [0, 0]
        self.choose()
        self.place()

    def place(self) -> None:
        """Put the train near its second stop, or under way, with equipment that works."""
        train, draw, line = self.train, self.draw, self.line
        train.journey = Journey(line, (DrawnDwell(0.0, 0.0),) * len(line.stops))
        train.journey.depart(train.tick)
        train.doors = TrainDoors(line.route.doors, 0.01)
        train.docking = DockingLoop(line.route.door_window_m, self.draw.randrange(1000), 0.01)
        train.holding.share = 1.0
        train.status.doors_closed_locked = True
        train.gate = CommandGate(7 * 256, 254 * 256, 6)
        train._door_gate = Acceptance(DoorCmd, Counter())
        train._watch = TrainWatch(line.watch, 10_000_000, 1.0)
        is_far = draw.random() < 0.5
        offset_m = is_far * draw.choice((0.0, 0.1, 0.2, 0.3, 0.45, 0.49, 0.5, 0.51, 0.55, 3.0)) * draw.choice((-1, 1))
        speed_mps = draw.choice((0.0, 0.0, 0.0, 0.0, 0.02, 0.3, 20.0))
        self.stop_m = line.stops[1].position_m
        train._motion = Motion(self.stop_m + offset_m, speed_mps, 0.0, 0.0)
        train.holding.is_applied = speed_mps == 0.0
        train.is_busy = True
        train.journey.has_arrived = speed_mps == 0.0 and offset_m >= -5.0
        train._balises.clear()

    def run(self) -> None:
        draw = self.draw
        for _ in range(draw.randint(3, 6)):
            self.choose()
            if draw.random() < 0.3:
                self.fail()
            for _ in range(draw.choice((1, 3, 11, 40))):
                self.tick()

    def choose(self) -> None:
        """Other orders for the doors and another notch, most of them plausible."""
        draw = self.draw
        self.notch = draw.choice((0, 0, 1792, 600, -1792))
        self.orders = {
            "order": draw.choice((SIDES[self.line.stops[1].platform], 1, 2, 3, 4, 4, 0, 7)),
            "depart_ready": draw.choice((1, 1, 1, 1, 1, 2, 0)),
            "hold_brake": draw.choice((1, 2, 2, 0, 3)),
            "station": draw.choice((2, 2, 2, 2, 2, 2, 1, 4, 0)),
            "check": draw.choice((1, 1, 1, 1, 1, 1, 0)),
        }

    def fail(self) -> None:
        """A fault of the doors, the docking loop or the holding brake begins."""
        train, draw = self.train, self.draw
        doors = train.doors
        door = draw.choice((doors.left, doors.right, doors.psd))
        fault = draw.randrange(7)
        if fault == 0:
            door.obstacles = draw.randint(1, 5)
        elif fault == 1:
            door.is_stuck = True
        elif fault == 2:
            door.slowness = 3.0
        elif fault == 3:
            door.has_lost_lock = not door.has_lost_lock
            train.show_doors()
        elif fault == 4:
            door.isolate()
            train.show_doors()
        elif fault == 5:
            train.docking.stuck = train.docking.is_in_window
        else:
            train.holding.share = draw.choice((0.0, 0.5))

    def tick(self) -> None:
        train = self.train
        before, motion = self.states(), train._motion
        if train.tick % 2 == 0:
            train.take(NotchCmd(self.notch, life=self.lives[1]))
            self.lives[1] = (self.lives[1] + 1) % 16
        if train.tick % 4 == 0:
            self.lives[0] = (self.lives[0] + self.draw.choice((1, 1, 1, 2, 0))) % 16
            train.take(DoorCmd(**self.orders, life=self.lives[0]))
        are_locked = train.doors.are_locked
        train.advance()
        train.events.clear()
        self.check_openings(before, motion)
        if train.traction_n > 0.0:
            self.pulled += 1
            assert are_locked

    def states(self) -> tuple[int, int]:
        return self.train.doors.left.state, self.train.doors.right.state

    def check_openings(self, before: tuple[int, int], motion: Motion) -> None:
        """Doors that now open, and did not, do so at standstill, in the window and on the platform's side; they become
        open at standstill."""
        for side, was, state in zip((LEFT, RIGHT), before, self.states(), strict=True):
            if state == OPEN != was:
                assert motion.speed_mps == 0.0
            if state == OPENING != was:
                self.opened += 1
                assert motion.speed_mps == 0.0
                assert abs(motion.position_m - self.stop_m) <= self.line.route.door_window_m + ERROR_MAX_M
                assert side & SIDES[self.line.stops[1].platform]


def check_sequences(count: int, seed: int) -> tuple[int, int]:
    """Run so many sequences.

    :returns: how often doors have opened, and ticks with traction.
    """
    opened = pulled = 0
    made = [(line, LineTrain(line, 0)) for line in lines()]
    for number in range(count):
        line, train = made[number % len(made)]
        sequence = Sequence(train, line, seed + number)
        try:
            sequence.run()
        except AssertionError as error:
            raise AssertionError(f"sequence {seed + number} of {line.stops[1]}") from error
        opened, pulled = opened + sequence.opened, pulled + sequence.pulled
    return opened, pulled


def test_no_sequence_opens_a_door_where_or_when_it_must_not() -> None:
    opened, pulled = check_sequences(400, 0)
    assert opened > 60
    assert pulled > 1000


@pytest.mark.long
def test_no_sequence_of_a_hundred_thousand_opens_a_door_where_or_when_it_must_not() -> None:
    opened, pulled = check_sequences(100_000, 1_000_000)
    assert opened > 12_000
    assert pulled > 500_000
