"""The fault language: texts and tables to faults and back, and what it says about a bad one."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railhil.common.errors import InputError
from railhil.faults.language import fault_text, parse
from railhil.faults.model import CONTINUING, COUNT, NAME, Draw, Expect, Fault, Parameter, Place, Trigger, Value, Word
from railhil.faults.tables import fault_of
from railhil.faults.words import PLACES, WORDS
from railhil.scenarios.fault_list import draw_values, fault_texts
from railhil.scenarios.load import load_any
from railhil.scenarios.system import system_named


def refused(text: str) -> str:
    with pytest.raises(InputError) as caught:
        parse(text)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "place", "what", "values", "trigger", "rest"),
    [
        ("speed stuck @60s for 2s", Place("sensor", "speed"), "stuck", {}, Trigger("time", 60.0), {"duration_s": 2.0}),
        (
            "TRN_SPEED loss 30% @20s for 5s",
            Place("telegram", "TRN_SPEED"),
            "loss",
            {"share": 0.3, "enter": 0.0, "leave": 1.0},
            Trigger("time", 20.0),
            {"duration_s": 5.0},
        ),
        (
            "TRN_SPEED loss gemodel 5% 40% @20s for 5s",
            Place("telegram", "TRN_SPEED"),
            "loss",
            {"share": 1.0, "enter": 0.05, "leave": 0.4},
            Trigger("time", 20.0),
            {"duration_s": 5.0},
        ),
        (
            "NOTCH_CMD.counter freeze x5 @v>60km/h",
            Place("telegram", "NOTCH_CMD", "counter"),
            "freeze",
            {},
            Trigger("speed", 60 / 3.6),
            {"count": 5},
        ),
        ("controller kill @1200m", Place("node", "controller"), "kill", {}, Trigger("position", 1200.0), {}),
        ("bus off @60s for 300ms", Place("bus"), "off", {}, Trigger("time", 60.0), {"duration_s": 0.3}),
        (
            "TRN_SPEED delay 100ms jitter 20ms @10s",
            Place("telegram", "TRN_SPEED"),
            "delay",
            {"delay_s": 0.1, "jitter_s": 0.02},
            Trigger("time", 10.0),
            {},
        ),
        (
            "pantograph off @braking+2s",
            Place("train", "pantograph"),
            "off",
            {},
            Trigger("event", "braking", delay_s=2),
            {},
        ),
        ("speed ok @manual", Place("sensor", "speed"), "ok", {}, Trigger("manual"), {}),
        ("TRN_POS loss x1 @#4711", Place("telegram", "TRN_POS"), "loss", None, Trigger("telegram", 4711), {"count": 1}),
        (
            "speed wrong uniform(0.9, 1.1) @ v < 5 km/h until stopped seed 7 unit 2 combine id S1",
            Place("sensor", "speed"),
            "wrong",
            {"factor": Draw("uniform", 0.9, 1.1)},
            Trigger("speed", 5 / 3.6, "falling"),
            {"until": "stopped", "seed": 7, "units": (2,), "combine": True, "id": "S1"},
        ),
        (
            "speed off @1s expect TRACTION_CUT within 500ms by speed_age verdict PASS",
            Place("sensor", "speed"),
            "off",
            {},
            Trigger("time", 1.0),
            {"expect": Expect("TRACTION CUT", 0.5, "speed_age", "PASS")},
        ),
    ],
)
def test_a_text_is_a_fault(
    text: str, place: Place, what: str, values: dict[str, Value] | None, trigger: Trigger, rest: dict[str, Any]
) -> None:
    found = parse(text)
    wanted = Fault(place, what, trigger, found.values if values is None else values, **rest)
    assert found == wanted
    assert parse(fault_text(found)) == found


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "missing, expected a port"),
        ("sped stuck @60s", "found 'sped'"),
        ("sped stuck @60s", "(did you mean speed?)"),
        ("speed stukc @60s", "found 'stukc', allowed speed with one of off, stuck"),
        ("speed stukc @60s", "(did you mean stuck?)"),
        ("speed stuck", "missing, expected @WHEN"),
        ("TRN_SPEED delay @2s", "missing, expected delay with delay, such as 500ms"),
        ("TRN_SPEED loss 130% @2s", "found '130%', allowed share of the telegrams that are lost: 0% to 100%"),
        ("TRN_SPEED loss 30 m @2s", "found '30m'"),
        ("TRN_SPEED loss gemodel 5% @2s", "found '@'"),
        ("TRN_SPEED loss 1% 2% @2s", "found '2%', allowed gemodel 30% or gemodel 30% or @WHEN"),
        ("bus off @60 for 3s", "found '@60', allowed @ and 60s, 1200m"),
        ("bus off @60s for 3", "found '3', allowed a duration above 0"),
        ("bus off @60s for 3s x5", "found 'for and x', allowed one of for, xCOUNT and until"),
        ("bus off @60s for 1s for 2s", "found 'for', allowed for only once"),
        ("bus off @60s vor 3s", "found '@60svor3s'"),
        ("bus off @#7", "found '@#7', allowed the number of a telegram only for a port"),
        ("controller kill @1200m for 3s", "found 'for', allowed kill without a duration"),
        ("TRN_SPEED loss @1s after deliver", "found 'deliver', allowed loss without after"),
        ("TRN_SPEED delay 1s @1s after delivr", "(did you mean deliver?)"),
        ("TRN_SPEED loss x0 @1s", "found 'x0', allowed a count from x1"),
        ("TRN_SPEED loss @1s seed 5000000000", "found '5000000000', allowed a seed from 0 to 4294967295"),
        ("TRN_SPEED loss @1s units 0", "found '0', allowed units from 1"),
        ("TRN_SPEED loss @1s expect", "missing, expected expect with a level"),
        ("speed wrong uniform(2,1) @1s", "found 'uniform(2,1)'"),
        (
            "balise stuck @1s",
            "found 'stuck', allowed balise with one of off, intermittent, missed, doubled, wrong, shifted",
        ),
        ("signal red @braking until 400s", "found 'until 400s', allowed until a time only for a fault that begins at"),
        ("signal red @500s until 400s", "found 'until 400s', allowed a time after @500s"),
        ("emergency_brake 170% @1s", "found '170%', allowed share of the force that is left: 0% to 100%"),
        ("emergency_brake 70%", "missing, expected @WHEN"),
        ("brake 70% @1s", "found '70%', allowed brake with one of weak"),
        ("dwell 45s @1s", "found '45s', allowed dwell with one of hold"),
        ("speed 3 stuck @1s", "found '3', allowed stuck, without a number before it"),
        ("balise 3 missed only 4 @1s", "found '3', allowed missed, without a number before it"),
    ],
)
def test_a_bad_text_is_refused_in_one_line(text: str, said: str) -> None:
    line = refused(text)
    assert said in line
    assert "\n" not in line
    assert line.startswith("--fault: ")


def test_a_text_without_a_time_takes_the_given_one() -> None:
    assert parse("pantograph off", trigger=Trigger("manual")) == parse("pantograph off @manual")


@pytest.mark.parametrize(
    ("text", "canonical"),
    [
        ("door left stuck open @STOP 3", "door_left stuck_open @stop 3"),
        ("door right slow 3x @10s", "door_right slow @10s"),
        ("door obstacle 2x @Stop 2 + 3s", "door obstacle 2 @stop 2+3s"),
        ("balise 12 missed @0s", "balise missed only 12 @0s"),
        ("balise 4 wrong number 9 @section 5 40s", "balise wrong_number 9 only 4 @section 5+40s"),
        ("signal 2 red @stop 2 until 400s", "signal red only 2 @stop 2 until 400s"),
        ("signal red @20s until 400s", "signal red @20s for 380s"),
        ("atp.speed wrong 110% @30s", "atp_speed wrong 1.1 @30s"),
        ("emergency_brake 70% @30s", "emergency_brake weak 70% @30s"),
        ("holding brake 0% @stop 2", "holding_brake weak 0% @stop 2"),
    ],
)
def test_a_name_of_two_words_a_number_and_a_planned_instant_have_one_canonical_text(text: str, canonical: str) -> None:
    assert fault_text(parse(text)) == canonical
    assert parse(canonical) == parse(text)


def planned(*texts: str) -> tuple[str, ...]:
    marks = {"stop": (0.0, 137.0, None), "section": (30.0,)}
    return fault_texts(texts, system_named("ato"), lambda row: Path("run.toml"), marks)


def test_a_fault_at_a_planned_instant_begins_at_its_time() -> None:
    found = planned("speed off @stop 2+3s for 1s", "position off @section 1 40s until 100s")
    assert found == ("speed off @140s for 1s", "position off @70s for 30s")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("speed off @stop 3", "found '@stop 3', allowed stop 1, stop 2"),
        ("speed off @stop 9", "found '@stop 9', allowed stop 1, stop 2"),
        ("speed off @sektion 1", "found '@sektion 1', allowed stop 1, section 1 (did you mean section?)"),
        ("speed off @stop 2 until 100s", "found 'until 100s', allowed a time after @137s"),
    ],
)
def test_an_instant_that_is_not_planned_is_refused(text: str, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        planned(text)


def test_a_scenario_without_planned_instants_has_none() -> None:
    with pytest.raises(InputError, match=re.escape("found '@stop 2', allowed 60s, 1200m")):
        load_any("lvshun_tieshan", (), ("speed off @stop 2",))


_TIMES = st.floats(0.001, 1e4).filter(lambda value: value > 0)


def _numbers(parameter: Parameter) -> st.SearchStrategy[float]:
    low, high = max(parameter.low, -1e6), min(parameter.high, 1e6)
    if parameter.unit == COUNT:
        return st.integers(int(low), int(high)).map(float)
    return st.floats(low, high).map(lambda value: value + 0.0)


def _values(parameter: Parameter) -> st.SearchStrategy[Value]:
    if parameter.unit == NAME:
        return st.sampled_from(("TRN_POS", "NOTCH_CMD"))
    numbers = _numbers(parameter)
    drawn = st.tuples(numbers, numbers).map(lambda two: Draw("uniform", min(two), max(two)))
    return st.one_of(numbers, drawn)


_TRIGGERS: st.SearchStrategy[Trigger] = st.one_of(
    st.builds(Trigger, st.just("time"), _TIMES, st.just("rising"), st.sampled_from((0.0, 0.3))),
    st.builds(Trigger, st.just("position"), st.floats(-1e5, 1e5).map(lambda value: value + 0.0)),
    st.builds(
        Trigger,
        st.just("speed"),
        st.floats(0, 200).map(lambda value: value + 0.0),
        st.sampled_from(("rising", "falling")),
    ),
    st.builds(
        Trigger, st.just("event"), st.sampled_from(("braking", "stopped", "traction_cut")), st.just("rising"), _TIMES
    ),
    st.just(Trigger("manual")),
    st.builds(Trigger, st.just("mark"), st.sampled_from(("stop 1", "section 12")), st.just("rising"), _TIMES),
)


@st.composite
def faults(draw: st.DrawFn) -> Fault:
    """Any fault that the table of words permits."""
    word: Word = draw(st.sampled_from(WORDS))
    part = ""
    if word.level == "telegram":
        name = draw(st.sampled_from(("TRN_SPEED", "NOTCH_CMD")))
        part = {"whole": "", "signal": "TrainSpeed"}.get(word.part, word.part)
    else:
        name = draw(st.sampled_from(word.names or tuple(PLACES[word.level])))
        part = draw(st.sampled_from(("a", "b"))) if word.part == "line" else ""
    values = {one.name: draw(_values(one)) for one in word.parameters}
    ends: dict[str, Any] = {}
    if word.name == "restart":
        ends = {"duration_s": draw(_TIMES)}
    elif word.lasts:
        ends = draw(
            st.one_of(
                st.just({}),
                _TIMES.map(lambda value: {"duration_s": value}),
                st.integers(1, 1000).map(lambda value: {"count": value}),
                st.just({"until": "standstill"}),
            )
        )
    expect = draw(st.one_of(st.none(), st.builds(Expect, st.just("HOLD"), st.one_of(st.none(), _TIMES))))
    return Fault(
        Place(word.level, name, part),
        word.name,
        draw(_TRIGGERS),
        MappingProxyType(values),
        after=draw(st.sampled_from(("", *word.after))),
        seed=draw(st.one_of(st.none(), st.integers(0, 0xFFFF_FFFF))),
        units=draw(st.sampled_from(((), (1,), (1, 3)))),
        combine=draw(st.booleans()),
        expect=expect,
        id=draw(st.sampled_from(("", "T3"))),
        **ends,
    )


@pytest.mark.slow
@given(faults())
def test_every_fault_has_a_text_that_is_read_back(fault: Fault) -> None:
    text = fault_text(fault)
    again = parse(text)
    assert again == fault
    assert fault_text(again) == text


@given(faults(), st.integers(0, 9))
def test_what_was_drawn_is_a_fault_that_can_be_pasted(fault: Fault, seed: int) -> None:
    """Counts are whole, and nothing is beyond its bounds."""
    found = draw_values(fault, 1, seed)
    assert parse(fault_text(found)) == found


@pytest.mark.slow
@given(st.text(max_size=60))
def test_no_text_raises_anything_else(text: str) -> None:
    with suppress(InputError):
        parse(text)


def test_a_table_is_the_same_fault() -> None:
    def complain(found: str, allowed: str, hint: str | None = None) -> InputError:
        return InputError("run.toml", "fault[0]", found, allowed, hint)

    row = {
        "where": "sensor.speed",
        "what": "wrong",
        "when": {"speed": "60 km/h", "edge": "rising", "delay": "2 s"},
        "for": "300 ms",
        "with": {"factor": "uniform(0.9, 1.1)"},
        "expect": {"level": "TRACTION CUT", "within": "500 ms", "detected_by": "speed_implausible"},
        "units": [1, 3],
        "id": "S1",
    }
    text = (
        "speed wrong uniform(0.9,1.1) @v>60km/h+2s for 300ms units 1,3 id S1 "
        "expect TRACTION_CUT within 500ms by speed_implausible"
    )
    assert fault_text(fault_of(row, complain, "run.toml")) == text
    assert fault_of(text, complain, "run.toml") == fault_of(row, complain, "run.toml")
    simple = {"where": "NOTCH_CMD.counter", "what": "freeze", "when": {"telegram": 4711}, "count": 5, "after": "last"}
    assert fault_text(fault_of(simple, complain, "")) == "NOTCH_CMD.counter freeze @#4711 x5 after last"
    assert simple["after"] in CONTINUING
    assert (
        fault_text(fault_of({"where": "bus", "what": "off", "when": 60, "for": 1}, complain, ""))
        == "bus off @60s for 1s"
    )
    for bad, said in (
        ({"where": "buss"}, "(did you mean bus?)"),
        ({"what": "of"}, "(did you mean off?)"),
        ({"when": "60"}, "found '60', allowed 60s, 1200m"),
        ({"when": {"time": 1, "speed": 2}}, "found 'time, speed', allowed when with one of"),
        ({"when": {"time": 1, "edge": "rising"}}, "found 'edge', allowed edge only with speed"),
        ({"for": "2 m"}, "found '2 m', allowed for: a time"),
        ({"with": {"shar": 1}}, "found 'shar', allowed off with no values"),
        ({"unit": 1, "units": [2]}, "one of the two"),
    ):
        with pytest.raises(InputError) as caught:
            fault_of({"where": "bus", "what": "off", "when": "60s", **bad}, complain, "")
        assert said in str(caught.value), bad
