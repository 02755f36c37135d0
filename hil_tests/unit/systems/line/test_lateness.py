"""Who has made a departure late, and how late the next arrival may then be."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.lines import four_stops
from railhil.judge.stops import PlannedStop, ScoredStop, Standstill
from railhil.systems.line.judge.doors import Exchange
from railhil.systems.line.judge.lateness import (
    Delay,
    Instants,
    delay_of,
    early_excused_s,
    excused_s,
    nominal_exchange_s,
    recoverable_s,
)
from railhil.systems.line.scenario.model import LineScenario

LINE = four_stops()
#: B of the four stops: due 137 s and 167 s; least dwell 20 s, of which 7.8 s are the doors'.
DWELL_S = 20.0
IN_TIME = Instants(
    due_arrival_s=137.0,
    due_departure_s=167.0,
    stood_s=137.0,
    opened_s=140.0,
    exchange=Exchange(ended_s=152.2, closing_s=163.5),
    locked_s=166.5,
    red_s=0.0,
    departed_s=167.0,
)


def delays(**values: Any) -> Delay:
    return delay_of(LINE, DWELL_S, replace(IN_TIME, **values))


def test_a_stop_in_time_has_no_delay() -> None:
    assert delays() == Delay()
    assert delays().cause == ""
    assert nominal_exchange_s(LINE, DWELL_S) == pytest.approx(12.2)


@pytest.mark.parametrize(
    ("values", "cause", "seconds"),
    [
        ({"stood_s": 147.0, "opened_s": 150.0, "exchange": Exchange(162.2, 166.0), "departed_s": 171.0}, "running", 10),
        ({"exchange": Exchange(182.2, 184.5), "locked_s": 187.5, "departed_s": 188.0}, "dwell", 30.0),
        ({"locked_s": 176.5, "departed_s": 177.0}, "doors", 9.7),
        ({"opened_s": 146.0, "exchange": Exchange(158.2, 163.5)}, "doors", 5.2),
        ({"red_s": 40.0, "departed_s": 207.5}, "signal", 40.0),
        ({"departed_s": 187.0}, "controller", 19.5),
        ({"exchange": Exchange(152.2, 180.0), "locked_s": 183.0, "departed_s": 183.5}, "controller", 15.0),
    ],
)  # fmt: skip
def test_the_longest_delay_is_the_cause(values: dict[str, Any], cause: str, seconds: float) -> None:
    found = delays(**values)
    assert found.cause == cause
    assert getattr(found, cause) == pytest.approx(seconds)


def test_only_what_the_controller_did_not_cause_excuses_the_next_arrival() -> None:
    section = replace(LINE.sections[1], running_time_s=173.0, fastest_s=165.0)
    held = replace(IN_TIME, exchange=Exchange(182.2, 184.5), locked_s=187.5, departed_s=188.0)
    assert excused_s(LINE, section, held, delay_of(LINE, DWELL_S, held)) == pytest.approx(21.0 - 8.0)
    slow = replace(IN_TIME, departed_s=188.0)
    assert excused_s(LINE, section, slow, delay_of(LINE, DWELL_S, slow)) == 0.0
    assert excused_s(LINE, section, IN_TIME, Delay()) == 0.0


@pytest.mark.parametrize(("regulation", "seconds"), [("retime", 10.0), ("profiles", 2.0), ("none", 0.0)])
def test_what_can_be_made_up_depends_on_the_regulation(regulation: Any, seconds: float) -> None:
    line: LineScenario = replace(
        LINE, route=replace(LINE.route, regulation=regulation, profiles_percent=(5.0, 5.0, 12.0))
    )
    section = replace(LINE.sections[1], running_time_s=170.0, fastest_s=160.0)
    assert recoverable_s(line, section) == pytest.approx(seconds)


@given(late_s=st.floats(0, 300), own_s=st.floats(0, 300), reserve_s=st.floats(0, 100))
def test_an_arrival_is_never_excused_for_more_than_the_departure_was_late(
    late_s: float, own_s: float, reserve_s: float
) -> None:
    section = replace(LINE.sections[1], running_time_s=100.0 + reserve_s, fastest_s=100.0)
    before = replace(IN_TIME, departed_s=167.0 + late_s)
    found = excused_s(LINE, section, before, Delay(controller=own_s))
    assert 0.0 <= found <= max(0.0, late_s - own_s) + 1e-9
    assert found >= excused_s(LINE, section, before, Delay(controller=own_s + 1.0)), "own delay never helps"


@pytest.mark.parametrize(
    ("late_s", "missed"),
    [
        (18.0, ""),
        (18.001, "arrival +18.001 s (allowed at most +18.000 s)"),
        (-5.0, ""),
        (-5.5, "arrival -5.500 s (allowed +-5 s)"),
    ],
)
def test_an_excused_arrival_has_a_later_limit(late_s: float, missed: str) -> None:
    planned = PlannedStop("4 D", 3420.0, 0.3, 340.0, 5.0)
    stop = ScoredStop(planned, Standstill(340.0 + late_s, 3420.0), excused_s=13.0)
    assert stop.missed == missed


@pytest.mark.parametrize(
    ("departed_s", "excused", "missed"),
    [
        (177.0, 0.0, ""),
        (178.0, 0.0, "departure +11.000 s (allowed at most +10.000 s)"),
        (240.0, 63.0, ""),
        (None, 0.0, "not departed"),
    ],
)
def test_a_departure_has_a_limit_of_its_own(departed_s: float | None, excused: float, missed: str) -> None:
    planned = PlannedStop("2 B", 0.0, 0.3, 137.0, 5.0, departure_due_s=167.0, departure_late_max_s=10.0)
    stop = ScoredStop(planned, Standstill(137.0, 0.0), departed_s=departed_s, departure_excused_s=excused)
    assert stop.missed == missed
    document = stop.as_json()
    assert (document["departed_s"], document["departure_excused_s"]) == (departed_s, excused)


def test_a_stop_that_is_to_be_passed_need_not_be_made() -> None:
    planned = PlannedStop("3 C", 2300.0, 0.3, service="pass")
    assert ScoredStop(planned, None).missed == "not passed"
    assert ScoredStop(PlannedStop("1 A", 0.0, 0.3, service="start"), None).missed == ""


def test_an_ordered_profile_excuses_what_it_takes_more_or_less_than_the_timetable() -> None:
    section = replace(LINE.sections[1], fastest_s=150.0)

    def ordered(mode: Any) -> LineScenario:
        stops = tuple(replace(stop, mode=mode) for stop in LINE.stops)
        return replace(LINE, stops=stops, route=replace(LINE.route, profiles_percent=(0.0, 5.0, 60.0)))

    fast_s, economy_s = section.fastest_s, 1.6 * section.fastest_s
    assert fast_s < section.running_time_s < economy_s
    more_s = economy_s - section.running_time_s
    assert recoverable_s(ordered("economy"), section) == pytest.approx(-more_s)
    assert excused_s(ordered("economy"), section, IN_TIME, Delay()) == pytest.approx(more_s)
    assert early_excused_s(ordered("economy"), section) == 0.0
    assert early_excused_s(ordered("fast"), section) == pytest.approx(section.running_time_s - fast_s)
    assert early_excused_s(LINE, section) == 0.0


def test_an_early_arrival_is_excused_as_far_as_the_order_goes() -> None:
    planned = PlannedStop("D", 0.0, 0.3, due_s=100.0, late_max_s=5.0)
    ordered = ScoredStop(planned, Standstill(85.0, 0.0), early_excused_s=10.0)
    assert ordered.misses == ()
    assert replace(ordered, early_excused_s=9.5).misses == ("arrival -15.000 s (allowed +-14.5 s)",)
    assert replace(ordered, standstill=Standstill(106.0, 0.0)).misses == ("arrival +6.000 s (allowed +-5 s)",)
