"""The train's side of the loop: commands that fail a check stop the train by its own watch."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.layout import CHECK_ERRONEOUS
from railhil.bus.local import LocalBus
from railhil.bus.mvb import TelegramSource
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.node import PlantNode, make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, WatchLevel

NOTCH_ID = NotchCmd.port().address
Wire = Callable[[Frame], list[Frame]]


def run_with_answers(scenario: Scenario, change: Wire) -> tuple[PlantNode, Event]:
    """A run in which ``change`` does something to the controller's NOTCH_CMD answers."""
    session = make_session(scenario, lambda line: None, RunSpec())
    node = ControllerNode(scenario, LawSpec())

    def controller(frame: Frame) -> list[Frame]:
        return [
            item
            for answer in node.handle(frame)
            for item in (change(answer) if answer.can_id == NOTCH_ID else [answer])
        ]

    plant = make_plant_node(scenario, RunSpec(), LocalBus([controller, session.handle]))
    return plant, plant.run()


class AnswerFault:
    """Changes every NOTCH_CMD answer from the given one on."""

    def __init__(self, first: int, fault: Callable[[NotchCmd], NotchCmd]) -> None:
        self.count = 0
        self._first = first
        self._fault = fault
        self._source = TelegramSource(NotchCmd.port())

    def __call__(self, frame: Frame) -> list[Frame]:
        self.count += 1
        if self.count <= self._first:
            return [frame]
        return self._source.frames(self._fault(NotchCmd.decode(frame.data[:4])).encode())


def bad_check(command: NotchCmd) -> NotchCmd:
    command.check = CHECK_ERRONEOUS
    return command


def out_of_range(command: NotchCmd) -> NotchCmd:
    command.notch_256th = 7 * 256 + 1
    return command


def stuck_life(command: NotchCmd) -> NotchCmd:
    command.life = GOOD_ANSWERS & 15
    return command


#: NOTCH_CMD answers before the fault: one per 20 ms, while the train still accelerates.
GOOD_ANSWERS = 500


@pytest.mark.parametrize(
    ("fault", "cause"),
    [(bad_check, "check_variable"), (out_of_range, "out_of_range"), (stuck_life, "duplicate")],
)
def test_the_train_stops_by_itself_when_commands_fail_a_check(
    short: Scenario, train: list[tuple[WatchLevel, float]], fault: Callable[[NotchCmd], NotchCmd], cause: str
) -> None:
    answers = AnswerFault(GOOD_ANSWERS, fault)
    plant, _ = run_with_answers(short, answers)
    assert plant.plant.gate.counters["accepted"] in (GOOD_ANSWERS, GOOD_ANSWERS + 1)
    # The life sign is judged first: of a telegram that is refused nothing is remembered, so it runs away and around.
    refused = [cause, "duplicate", "out_of_order"] if cause != "duplicate" else ["duplicate"]
    assert plant.plant.gate.counters[cause] > 100
    assert sum(plant.plant.gate.counters[key] for key in ("accepted", *refused)) == answers.count
    first_tick = 2 * GOOD_ANSWERS
    assert train[first_tick - 10][1] > 0
    levels = [level for level, _ in train[first_tick:]]
    reached_ticks = {
        level: levels.index(level)
        for level in (WatchLevel.TRACTION_CUT, WatchLevel.SERVICE_BRAKE, WatchLevel.EMERGENCY)
    }
    # One command more when the first frozen one was still good.
    spare = 2 if plant.plant.gate.counters["accepted"] > GOOD_ANSWERS else 0
    assert reached_ticks[WatchLevel.TRACTION_CUT] <= 7 + spare
    assert reached_ticks[WatchLevel.SERVICE_BRAKE] <= 27 + spare
    assert reached_ticks[WatchLevel.EMERGENCY] <= 102 + spare
    for level, traction_n in train:
        assert level < WatchLevel.TRACTION_CUT or traction_n == 0
    assert plant.plant.true_speed_01mmps == 0


@pytest.mark.slow
def test_damaged_commands_age_and_nobody_is_called_silent(
    short: Scenario, train: list[tuple[WatchLevel, float]]
) -> None:
    """One to three bits flipped in every fiftieth NOTCH_CMD answer."""
    draw = random.Random(3)
    damaged = 0
    seen = 0

    def flip(frame: Frame) -> list[Frame]:
        nonlocal damaged, seen
        seen += 1
        if seen % 50:
            return [frame]
        damaged += 1
        word = int.from_bytes(frame.data)
        for bit in draw.sample(range(64), draw.randint(1, 3)):
            word ^= 1 << bit
        return [frame._replace(data=word.to_bytes(8))]

    plant, ended = run_with_answers(short, flip)
    assert damaged > 30
    assert plant.counters["missed_polls"] == damaged
    assert plant.counters["wrong_check_sequence"] + plant.counters.get("wrong_master_word", 0) == damaged
    assert plant.plant.gate.counters == {"accepted": seen - damaged, "gap": damaged}
    assert ended is Event.ENDED_COMPLETE
    assert max(level for level, _ in train[300:]) <= WatchLevel.HOLD
