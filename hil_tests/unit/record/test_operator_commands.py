"""The operator's operator: what becomes of the panel's commands in SUP_CMD."""

from __future__ import annotations

from typing import Any

import pytest

from railhil.bus.codes import FaultOrder, SupCommand
from railhil.faults.language import parse
from railhil.faults.operator_values import octets_of
from railhil.record import operator_commands as module
from railhil.record.operator_commands import OperatorCommands

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


def operator(
    *looks: list[dict[str, Any]], lockstep: bool = True, planned: tuple[str, ...] = ()
) -> tuple[OperatorCommands, ScriptedPanel]:
    panel = ScriptedPanel(*looks)
    return OperatorCommands(planned, panel, lockstep, FAULTS), panel


def test_a_fault_is_ordered_once_and_noted(clock):
    one, panel = operator([{"do": "inject", "fault": 1, "id": 7}])
    assert one.answer(75, 12.0) == (SupCommand.START, 1, FaultOrder.INJECT)
    assert one.answer(76, 12.16) == STARTED
    assert one.sent == ["75 inject 1"]
    assert {"answer": 7, "refused": ""} in panel.told


def test_a_fault_of_some_duration_is_cleared_with_the_first_telegram_after_it(clock):
    one, panel = operator([{"do": "inject", "fault": 1, "for_s": 0.3}])
    said = [one.answer(number, 12.0 + 0.16 * (number - 75)) for number in range(75, 79)]
    assert said == [(SupCommand.START, 1, FaultOrder.INJECT), STARTED, (SupCommand.START, 1, FaultOrder.CLEAR), STARTED]
    assert one.sent == ["75 inject 1", "77 clear 1"]
    panel.looks = [[{"do": "inject", "fault": 1}]]
    assert one.answer(79, 13.0) == STARTED
    assert "injected once" in panel.refusals[-1]


def test_the_panel_is_told_when_each_fault_ends_and_that_it_is_over(clock):
    faults = ("TRN_SPEED loss @manual", "NOTCH_CMD loss @manual for 300ms", "TRN_POS loss @manual")
    panel = ScriptedPanel(
        [{"do": "inject", "fault": 1, "for_s": 0.5}, {"do": "inject", "fault": 2}, {"do": "inject", "fault": 3}]
    )
    one = OperatorCommands((), panel, True, faults)
    clock[0] += 1.0
    for number in range(75, 79):
        one.answer(number, 12.0 + 0.16 * (number - 75))
        clock[0] += 1.0
    told = [report for report in panel.told if "phase" in report]
    # The second SUP_CMD has the second fault, whose node ends it by itself.
    assert told[-1]["ends_s"] == pytest.approx({1: 12.5, 2: 12.46})
    assert told[-1]["active"] == [1, 2, 3]
    one.answer(79, 12.64)
    clock[0] += 1.0
    one.answer(80, 12.8)
    told = [report for report in panel.told if "phase" in report]
    assert (told[-1]["ends_s"], told[-1]["active"], told[-1]["injected"]) == ({}, [3], [1, 2, 3])
    assert one.sent == ["75 inject 1", "76 inject 2", "77 inject 3", "79 clear 1"]
    panel.looks = [[{"do": "clear", "fault": 2}]]
    one.answer(81, 13.0)
    assert panel.refusals[-1] == "fault 2 is over"


def test_a_run_begins_at_the_pace_that_was_chosen_before(clock):
    panel = ScriptedPanel()
    one = OperatorCommands((), panel, True, FAULTS, 2.0)
    one.answer(1, 0.0)
    assert panel.waited_s == 0.0
    before_s = clock[0]
    one.answer(2, 4.0)
    assert clock[0] - before_s == pytest.approx(2.0, abs=0.1)


def test_a_prepared_fault_is_injected_by_its_text(clock):
    faults = (*FAULTS, "TRN_SPEED loss 5% @manual combine id T1b", "speed off @manual combine id S1a")
    panel = ScriptedPanel([{"do": "fault", "text": "sensor.speed off for 200 ms"}])
    one = OperatorCommands((), panel, True, faults)
    assert one.answer(75, 12.0) == (SupCommand.START, 4, FaultOrder.INJECT)
    assert one.answer(76, 12.16) == STARTED
    assert one.answer(77, 12.32) == (SupCommand.START, 4, FaultOrder.CLEAR)


def carried(one: OperatorCommands, first: int, last: int) -> list[tuple[int, FaultOrder]]:
    """What the SUP_CMD of these numbers carry."""
    return [one.answer(number, 12.0 + 0.16 * (number - first))[1:] for number in range(first, last + 1)]


def test_values_go_out_as_octets_before_the_fault_and_the_certificate_has_them(clock):
    one, panel = operator([{"do": "fault", "text": "TRN_SPEED loss 12% for 300ms"}])
    octets = octets_of(1, parse(FAULTS[0]), parse("TRN_SPEED loss 12% @manual"))
    expected = [*((octet, FaultOrder.VALUE) for octet in octets), (1, FaultOrder.INJECT)]
    assert carried(one, 75, 80 + len(octets)) == [
        *expected, (0, FaultOrder.NONE), (1, FaultOrder.CLEAR), *[(0, FaultOrder.NONE)] * 3
    ]  # fmt: skip
    assert carried(OperatorCommands(one.sent, None, True, FAULTS), 75, 74 + len(expected)) == expected
    assert [report["faults"][0] for report in panel.told if "faults" in report][-1] == "TRN_SPEED loss 12% @manual"


def test_values_begin_again_after_another_order_and_wait_for_the_end_of_a_pause(clock):
    panel = ScriptedPanel([{"do": "fault", "text": "TRN_SPEED loss 12%"}], [], [{"do": "inject", "fault": 3}])
    one = OperatorCommands((), panel, True, (*FAULTS, "safety_loop off @manual"))
    octets = octets_of(1, parse(FAULTS[0]), parse("TRN_SPEED loss 12% @manual"))
    assert carried(one, 2, 4) == [(octets[0], FaultOrder.VALUE), (octets[1], FaultOrder.VALUE), (3, FaultOrder.INJECT)]
    panel.looks = [[{"do": "pause"}]]
    assert one.answer(5, 12.0) == PAUSED
    panel.looks = [[{"do": "start"}]]
    assert carried(one, 6, 6 + len(octets)) == [
        *((octet, FaultOrder.VALUE) for octet in octets),
        (1, FaultOrder.INJECT),
    ]


def test_a_fault_whose_values_are_on_their_way_can_be_cleared(clock):
    one, _ = operator([{"do": "fault", "text": "TRN_SPEED loss 12%"}], [{"do": "clear", "fault": 1}])
    assert [order for _, order in carried(one, 2, 4)] == [FaultOrder.VALUE, FaultOrder.CLEAR, FaultOrder.NONE]


def test_orders_that_come_together_are_sent_one_by_one(clock):
    one, _ = operator([{"do": "inject", "fault": 1}, {"do": "clear", "fault": 1}, {"do": "stop"}])
    assert one.answer(75, 12.0)[2] is FaultOrder.INJECT
    assert one.answer(76, 12.16)[2] is FaultOrder.CLEAR
    assert one.answer(77, 12.32)[0] is SupCommand.STOP


def test_nothing_is_ordered_after_stop(clock):
    one, panel = operator([{"do": "inject", "fault": 1, "for_s": 0.1}], planned=("80 inject 1",))
    assert one.answer(75, 12.0)[2] is FaultOrder.INJECT
    panel.looks = [[{"do": "stop"}, {"do": "clear", "fault": 1}, {"do": "pause"}]]
    assert one.answer(76, 12.05)[0] is SupCommand.STOP
    assert panel.refusals[1:] == ["", "the run has been stopped", "the run has been stopped"]
    # The duration of the fault is over, and an order of the run's own list is due.
    assert [one.answer(number, 12.2) for number in range(77, 82)] == [STARTED] * 5
    assert one.sent == ["75 inject 1", "76 stop"]


def test_a_pause_lasts_until_start_and_each_of_its_answers_is_noted(clock):
    one, panel = operator([{"do": "pause"}])
    assert one.answer(75, 12.0) == PAUSED
    assert one.answer(76, 12.0) == PAUSED
    panel.looks = [[], [], [{"do": "start"}]]
    assert one.answer(77, 12.0) == STARTED
    assert one.sent == ["75 pause", "76 pause"]
    assert [report["phase"] for report in panel.told if "phase" in report][-1] == "paused"


def test_signals_are_looked_for_during_a_pause(clock):
    one, _ = operator([{"do": "pause"}])
    one.answer(75, 12.0)

    def stop() -> None:
        raise KeyboardInterrupt

    one.while_waiting = stop
    with pytest.raises(KeyboardInterrupt):
        one.answer(76, 12.0)


def test_a_pace_holds_the_answer_back(clock):
    one, panel = operator([{"do": "pace", "pace": 1}])
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
        ({"do": "fault", "text": "TRN_SPEED loss x3"}, "not prepared in this run"),
        ({"do": "fault", "text": "TRN_SPEED stuck"}, "not prepared in this run"),
        (
            {"do": "fault", "text": "TRN_SPEED loss 130%"},
            "found '130%', allowed share of the telegrams that are lost: 0%",
        ),
        ({"do": "fault", "text": "TRN_SPEED loss uniform(1%,2%)"}, "numbers only"),
        ({"do": "fault", "text": "TRN_SPEED loss 5% for 0s"}, "a duration above 0"),
        ({"do": "fault"}, "missing"),
        ({"do": "pace", "pace": 0.01}, "allowed 0"),
        ({"do": "pace", "pace": "fast"}, "allowed 0"),
        ({"do": "explode"}, "no such command"),
        ({}, "no such command"),
    ],
)
def test_what_cannot_be_done_is_refused_and_changes_nothing(clock, command, words):
    one, panel = operator([command])
    assert one.answer(75, 12.0) == STARTED
    assert words in panel.refusals[0]
    assert one.sent == []


def test_the_lateness_of_a_real_time_run_is_measured_once_a_second_and_told(clock):
    one, panel = operator(lockstep=False)
    measured = iter(range(10))
    one.lateness = lambda: {"worst_ms": next(measured)}
    for number in range(75, 95):
        one.answer(number, 12.0)
        clock[0] += 0.16
    told = [report["lateness"]["worst_ms"] for report in panel.told]
    assert told[0] == 0
    assert told[-1] in (2, 3)


@pytest.mark.parametrize("what", ["pause", "start", "pace"])
def test_real_time_cannot_stand_still(clock, what):
    one, panel = operator([{"do": what, "pace": 2}], lockstep=False)
    assert one.answer(75, 12.0) == STARTED
    assert panel.refusals[0]


def test_planned_orders_need_no_panel():
    one = OperatorCommands(("75 inject 1", "80 pause", "90 stop"), None, True)
    said = [one.answer(number, 0.0) for number in range(74, 92)]
    assert [said.index(item) + 74 for item in ((SupCommand.START, 1, FaultOrder.INJECT), PAUSED)] == [75, 80]
    assert one.sent == ["75 inject 1", "80 pause", "90 stop"]
