"""What a lost, repeated, late or foreign telegram does to the verdict on a line: nothing, unless it says so.

A record that is changed in one telegram keeps its verdict, or is INVALID with a reason that names the telegram. It
never turns from PASS to FAIL or from FAIL to PASS.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.line_records import JUDGED, Told, driven_run, milestones_in, trace_of
from railhil.bus.layout import Telegram
from railhil.bus.telegrams import RunEvent
from railhil.judge.record_checks import UNCLEAR
from railhil.judge.score import Score
from railhil.systems.line.judge.score import score
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire import ato, line
from railhil.wire.line import AtpLim, AtpStat, AtpStatus, DoorStat

LINE, TOLD = driven_run(short=True)
KINDS: dict[str, type[Telegram]] = {
    "SIM_TRUTH": ato.SimTruth,
    "PLT_STAT": ato.PltStat,
    "RUN_EVENT": RunEvent,
    "DOOR_STAT": line.DoorStat,
    "STN_INFO": line.StnInfo,
    "ATP_LIM": line.AtpLim,
    "ATP_STAT": line.AtpStat,
    "ATO_STAT": line.AtoStat,
}
#: The same run on lines whose limits it misses, each in another way.
MISSED: dict[str, LineScenario] = {
    "in order": LINE,
    "stop error": replace(LINE, stops=(LINE.stops[0], replace(LINE.stops[1], stop_error_max_m=0.05), *LINE.stops[2:])),
    "lateness": replace(LINE, stops=(*LINE.stops[:3], replace(LINE.stops[3], arrive_s=120.0))),
    "side": replace(LINE, stops=(LINE.stops[0], replace(LINE.stops[1], platform="right"), *LINE.stops[2:])),
    "authority": replace(LINE, stops=(*LINE.stops[:3], replace(LINE.stops[3], svl_overlap_m=0.01))),
}


def judged(told: Sequence[Told], scenario: LineScenario = LINE) -> Score:
    return score(scenario, trace_of(scenario, sorted(told, key=lambda one: one.time_ns)))


BEFORE = {name: judged(TOLD, scenario) for name, scenario in MISSED.items()}


@st.composite
def foreign_telegrams(draw: st.DrawFn) -> Told:
    """A telegram of any content, or one of the record in which a field is another, at any time."""
    port = draw(st.sampled_from(JUDGED))
    kind = KINDS[port]
    own = [one for one in TOLD if one.port == port]
    at = own[draw(st.integers(0, len(own) - 1))]
    fields = dict(kind.signals())
    names = list(fields) if draw(st.booleans()) else [draw(st.sampled_from(sorted(fields)))]
    values: dict[str, Any] = {}
    for name in names:
        low, high = fields[name].raw_range
        values[name] = draw(st.integers(low, high))
    return Told(at.time_ns + draw(st.sampled_from((0, 5_000_000, 40_000_000))), port, _made(kind, at.data, values))


def _made(kind: type[Telegram], data: bytes, values: dict[str, Any]) -> bytes:
    return replace(kind.decode(data), **values).encode()  # type: ignore[type-var]


@st.composite
def changed_records(draw: st.DrawFn) -> list[Told]:
    """The record with one telegram lost, repeated, late or added."""
    told = list(TOLD)
    port = draw(st.sampled_from(JUDGED))
    places = [place for place, one in enumerate(told) if one.port == port]
    place = places[draw(st.integers(0, len(places) - 1))]
    kind = draw(st.sampled_from(("lost", "again", "late", "foreign", "foreign")))
    delay_ns = draw(st.sampled_from((1_000_000, 10_000_000, 80_000_000, 500_000_000)))
    later = told[place]._replace(time_ns=told[place].time_ns + delay_ns)
    if kind == "lost":
        del told[place]
    elif kind == "again":
        told.append(later)
    elif kind == "late":
        told[place] = later
    else:
        told.append(draw(foreign_telegrams()))
    return told


@pytest.mark.slow
@settings(max_examples=120, deadline=None)
@given(told=changed_records(), name=st.sampled_from(sorted(MISSED)))
def test_one_changed_telegram_never_turns_a_verdict_without_a_word(told: list[Told], name: str) -> None:
    before, after = BEFORE[name], judged(told, MISSED[name])
    if after.verdict == "INVALID":
        assert all(text.startswith((UNCLEAR, "run ")) for text in after.failures), after.failures
    else:
        assert after.verdict == before.verdict, (before.failures, after.failures)


def test_the_records_of_these_tests_have_the_verdicts_that_they_are_made_for() -> None:
    assert BEFORE["in order"].verdict == "PASS"
    for name, said in (("stop error", "+0.090"), ("lateness", "+14."), ("side", "invariant 8"), ("authority", "9")):
        assert BEFORE[name].verdict == "FAIL"
        assert said in BEFORE[name].failures[0]


def _milestone(number: int, **values: int) -> list[Told]:
    """The record with another content of all copies of a milestone."""
    return [
        one._replace(data=_made(RunEvent, one.data, values)) if _number(one) == number else one for one in TOLD
    ]  # fmt: skip


def _number(one: Told) -> int:
    return RunEvent.decode(one.data).number if one.port == RunEvent.PORT else 0


def _added(kind: str, number: int, at_s: float) -> list[Told]:
    code = LINE.installed_system.events[kind]
    return [*TOLD, Told(round(at_s * 1e9), RunEvent.PORT, RunEvent(code, number, round(at_s * 1e4), 0).encode())]


LAST = max(map(_number, TOLD))


@pytest.mark.parametrize("kind", ["arrived", "doors_open", "departure", "passed", "doors_locked"])
def test_a_lost_milestone_is_told(kind: str) -> None:
    number = milestones_in(TOLD, kind, LINE)[-1]
    kept = [one for one in TOLD if _number(one) != number]
    assert judged(kept).failures == (f"record: RUN_EVENT {number} of {LAST} is missing",)
    once = [one for place, one in enumerate(TOLD) if _number(one) != number or _is_first(place, number)]
    assert judged(once).verdict == "PASS", "one copy is enough"


def _is_first(place: int, number: int) -> bool:
    return place == next(at for at, one in enumerate(TOLD) if _number(one) == number)


@pytest.mark.parametrize(
    ("told", "said"),
    [
        (_milestone(milestones_in(TOLD, "arrived", LINE)[0], event=38), "record: RUN_EVENT 4 says jog at 48."),
        (_milestone(milestones_in(TOLD, "passed", LINE)[0], event=39), "record: RUN_EVENT"),
        (_milestone(milestones_in(TOLD, "doors_open", LINE)[0], event=39), "record: no doors_open at stop 2 B, but"),
        (_milestone(milestones_in(TOLD, "arrived", LINE)[1], instant_01ms=900_000), "record: RUN_EVENT"),
        (_milestone(milestones_in(TOLD, "arrived", LINE)[1], position_01mm=3_300_000), "record: arrived at stop 4 D"),
        (_milestone(LAST - 1, event=40), "record: no doors_open at stop 4 D"),
        (_added("atp", 1, 5.0), "record: RUN_EVENT 1 says"),
        (_added("atp", 0, 5.0), "record: RUN_EVENT 0 says atp"),
        (_added("arrived", LAST + 1, 138.0), f"record: RUN_EVENT {LAST + 1} says arrived after ended_complete"),
    ],
)  # fmt: skip
def test_a_milestone_that_the_record_contradicts_makes_it_invalid(told: list[Told], said: str) -> None:
    found = judged(told)
    assert found.verdict == "INVALID"
    assert found.failures[0].startswith(said), found.failures


def test_a_standstill_without_an_arrival_is_told() -> None:
    """The milestones end with the departure from the last stop but one, and the end of the run."""
    number = milestones_in(TOLD, "passed", LINE)[-1]
    told = [one for one in TOLD if _number(one) in (*range(number + 1), LAST)]
    told = [one._replace(data=_made(RunEvent, one.data, {"number": number + 1})) if _number(one) == LAST else one
            for one in told]  # fmt: skip
    (said,) = judged(told).failures
    assert said.startswith("record: no arrived at stop 4 D, but SIM_TRUTH shows that the train stands at 342.")


def test_the_protection_is_believed_only_if_two_sources_agree() -> None:
    def reacting(ports: tuple[type[Telegram], ...], count: int, **values: int) -> list[Told]:
        left = dict.fromkeys((kind.PORT for kind in ports), count)
        told = []
        for one in TOLD:
            if left.get(one.port) and one.time_ns >= 60e9:
                left[one.port] -= 1
                kind = KINDS[one.port]
                known = {name: value for name, value in values.items() if name in dict(kind.signals())}
                one = one._replace(data=_made(kind, one.data, known))
            told.append(one)
        return told

    (alone,) = judged(reacting((AtpStat,), 1, service_brake=2)).failures
    assert alone.startswith("record: one ATP_LIM or ATP_STAT alone says that the train protection intervenes, at 60.")
    (untold,) = judged(reacting((AtpLim, AtpStat), 5, status=AtpStatus.INTERVENTION, service_brake=2)).failures
    assert untold.startswith("record: ATP_LIM or ATP_STAT shows a reaction of the train protection at 60.")


def test_a_record_without_doors_or_protection_for_more_than_a_second_is_invalid() -> None:
    def without(*ports: str) -> list[Told]:
        return [one for one in TOLD if one.port not in ports or not 60e9 < one.time_ns < 62e9]

    assert judged(without("DOOR_STAT")).verdict == "PASS", "PLT_STAT shows whether the doors are locked"
    assert judged(without("DOOR_STAT", "PLT_STAT")).failures[0].startswith("record: no DOOR_STAT or PLT_STAT for 2.")
    assert judged(without("ATP_LIM", "ATP_STAT")).failures[0].startswith("record: no ATP_LIM or ATP_STAT for 2.")
    assert judged(without("SIM_TRUTH")).failures[0].startswith("record: no SIM_TRUTH for 2.")


def test_a_door_telegram_that_stands_alone_is_not_believed() -> None:
    place = next(at for at, one in enumerate(TOLD) if one.port == DoorStat.PORT and one.time_ns > 20e9)
    told = list(TOLD)
    told[place] = told[place]._replace(data=_made(DoorStat, told[place].data, {"right_state": 2}))
    (said,) = judged(told).failures
    assert said.startswith("record: one DOOR_STAT alone says right doors open in motion at 20.")


@pytest.mark.parametrize("name", ["in order", "side"])
def test_doors_that_were_open_while_nothing_shows_their_side_are_not_judged(name: str) -> None:
    begun_ns, until_ns = 47_000_000_000, 79_000_000_000
    silent = [one for one in TOLD if one.port != DoorStat.PORT or not begun_ns < one.time_ns < until_ns]
    found = judged(silent, MISSED[name])
    assert found.verdict == "INVALID"
    assert f"no {DoorStat.PORT} within 1 s" in found.failures[0]
