"""The operator's desk: what becomes of the panel's commands in SUP_CMD."""

from __future__ import annotations

from typing import Any

import pytest

from railhil.bus.codes import FaultOrder, SupCommand
from railhil.supervisor import desk as module
from railhil.supervisor.desk import Desk

FAULTS = ("TRN_SPEED loss @manual", "TRN_POS loss @20s")
STARTED = (SupCommand.START, 0, FaultOrder.NONE)
PAUSED = (SupCommand.NONE, 0, FaultOrder.NONE)


class ScriptedPanel:
    """Hands over one list of commands at each look; a look without one takes the time that was asked for."""

    def __init__(self, *looks: list[dict[str, Any]]) -> None:
        self.looks = list(looks)
        self.told: list[dict[str, Any]] = []
        self.waited_s = 0.0

    def take(self, timeout_s: float) -> list[dict[str, Any]]:
        self.waited_s += timeout_s
        return self.looks.pop(0) if self.looks else []

    def tell(self, report: dict[str, Any]) -> None:
        self.told.append(report)

    @property
    def refusals(self) -> list[str]:
        return [report["refused"] for report in self.told if "refused" in report]


@pytest.fixture
def clock(monkeypatch) -> list[float]:
    """A wall clock that goes on by 10 ms at each look."""
    now = [100.0]

    def monotonic() -> float:
        now[0] += 0.01
        return now[0]

    monkeypatch.setattr(module.time, "monotonic", monotonic)
    return now


def desk(
    *looks: list[dict[str, Any]], lockstep: bool = True, planned: tuple[str, ...] = ()
) -> tuple[Desk, ScriptedPanel]:
    panel = ScriptedPanel(*looks)
    return Desk(planned, panel, lockstep, FAULTS), panel


def test_a_fault_is_ordered_once_and_noted(clock):
    one, panel = desk([{"do": "inject", "fault": 1, "id": 7}])
    assert one.answer(75, 12.0) == (SupCommand.START, 1, FaultOrder.INJECT)
    assert one.answer(76, 12.16) == STARTED
    assert one.sent == ["75 inject 1"]
    assert {"answer": 7, "refused": ""} in panel.told


def test_a_fault_of_some_duration_is_cleared_with_the_first_telegram_after_it(clock):
    one, panel = desk([{"do": "inject", "fault": 1, "for_s": 0.3}])
    said = [one.answer(number, 12.0 + 0.16 * (number - 75)) for number in range(75, 79)]
    assert said == [(SupCommand.START, 1, FaultOrder.INJECT), STARTED, (SupCommand.START, 1, FaultOrder.CLEAR), STARTED]
    assert one.sent == ["75 inject 1", "77 clear 1"]
    panel.looks = [[{"do": "inject", "fault": 1}]]
    assert one.answer(79, 13.0) == STARTED
    assert "injected once" in panel.refusals[-1]


def test_a_prepared_fault_is_injected_by_its_text(clock):
    faults = (*FAULTS, "TRN_SPEED loss 5% @manual combine id T1b", "speed off @manual combine id S1a")
    panel = ScriptedPanel([{"do": "fault", "text": "sensor.speed off for 200 ms"}])
    one = Desk((), panel, True, faults)
    assert one.answer(75, 12.0) == (SupCommand.START, 4, FaultOrder.INJECT)
    assert one.answer(76, 12.16) == STARTED
    assert one.answer(77, 12.32) == (SupCommand.START, 4, FaultOrder.CLEAR)


def test_orders_that_come_together_are_sent_one_by_one(clock):
    one, _ = desk([{"do": "inject", "fault": 1}, {"do": "clear", "fault": 1}, {"do": "stop"}])
    assert one.answer(75, 12.0)[2] is FaultOrder.INJECT
    assert one.answer(76, 12.16)[2] is FaultOrder.CLEAR
    assert one.answer(77, 12.32)[0] is SupCommand.STOP


def test_nothing_is_ordered_after_stop(clock):
    one, panel = desk([{"do": "inject", "fault": 1, "for_s": 0.1}], planned=("80 inject 1",))
    assert one.answer(75, 12.0)[2] is FaultOrder.INJECT
    panel.looks = [[{"do": "stop"}, {"do": "clear", "fault": 1}, {"do": "pause"}]]
    assert one.answer(76, 12.05)[0] is SupCommand.STOP
    assert panel.refusals[1:] == ["", "the run has been stopped", "the run has been stopped"]
    # The duration of the fault is over, and an order of the run's own list is due.
    assert [one.answer(number, 12.2) for number in range(77, 82)] == [STARTED] * 5
    assert one.sent == ["75 inject 1", "76 stop"]


def test_a_pause_lasts_until_start_and_each_of_its_answers_is_noted(clock):
    one, panel = desk([{"do": "pause"}])
    assert one.answer(75, 12.0) == PAUSED
    assert one.answer(76, 12.0) == PAUSED
    panel.looks = [[], [], [{"do": "start"}]]
    assert one.answer(77, 12.0) == STARTED
    assert one.sent == ["75 pause", "76 pause"]
    assert [report["phase"] for report in panel.told if "phase" in report][-1] == "paused"


def test_signals_are_looked_for_during_a_pause(clock):
    one, _ = desk([{"do": "pause"}])
    one.answer(75, 12.0)

    def stop() -> None:
        raise KeyboardInterrupt

    one.while_waiting = stop
    with pytest.raises(KeyboardInterrupt):
        one.answer(76, 12.0)


def test_a_pace_holds_the_answer_back(clock):
    one, panel = desk([{"do": "pace", "pace": 1}])
    one.answer(75, 12.0)
    panel.waited_s = 0.0
    one.answer(76, 12.5)
    assert panel.waited_s > 0.0
    panel.looks, panel.waited_s = [[{"do": "pace", "pace": 0}]], 0.0
    one.answer(77, 99.0)
    one.answer(78, 999.0)
    # The answer that was already due at the old pace has looked once more.
    assert panel.waited_s < 1.0


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ({"do": "inject", "fault": 3}, "no fault 3"),
        ({"do": "inject", "fault": "1"}, "no fault 1"),
        ({"do": "inject", "fault": 2}, "not triggered by hand"),
        ({"do": "inject", "fault": 1, "for_s": 0}, "duration: found 0, allowed above 0 s"),
        ({"do": "inject", "fault": 1, "for_s": float("nan")}, "duration: found nan"),
        ({"do": "inject", "fault": 1, "for_s": "5"}, "duration: found 5"),
        ({"do": "clear", "fault": 1}, "not injected"),
        ({"do": "fault", "text": "TRN_SPEED lost"}, "did you mean loss?"),
        ({"do": "fault", "text": "TRN_SPEED loss @30s"}, "begins now"),
        ({"do": "fault", "text": "TRN_SPEED loss 30%"}, "not prepared in this run"),
        ({"do": "fault"}, "found nothing"),
        ({"do": "pace", "pace": 0.01}, "allowed 0"),
        ({"do": "pace", "pace": "fast"}, "allowed 0"),
        ({"do": "explode"}, "no such command"),
        ({}, "no such command"),
    ],
)
def test_what_cannot_be_done_is_refused_and_changes_nothing(clock, command, words):
    one, panel = desk([command])
    assert one.answer(75, 12.0) == STARTED
    assert words in panel.refusals[0]
    assert one.sent == []


@pytest.mark.parametrize("what", ["pause", "start", "pace"])
def test_real_time_cannot_stand_still(clock, what):
    one, panel = desk([{"do": what, "pace": 2}], lockstep=False)
    assert one.answer(75, 12.0) == STARTED
    assert panel.refusals[0]


def test_planned_orders_need_no_panel():
    one = Desk(("75 inject 1", "80 pause", "90 stop"), None, True)
    said = [one.answer(number, 0.0) for number in range(74, 92)]
    assert [said.index(item) + 74 for item in ((SupCommand.START, 1, FaultOrder.INJECT), PAUSED)] == [75, 80]
    assert one.sent == ["75 inject 1", "80 pause", "90 stop"]
