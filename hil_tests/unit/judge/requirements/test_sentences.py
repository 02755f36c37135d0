"""Sentences that are not of the language, or do not fit the scenario, are refused in a line with the column."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.unit.judge.requirements.records import names, scenario
from railhil.common.errors import InputError
from railhil.judge.requirements.parser import parse_sentence
from railhil.judge.requirements.requirement import Requirement, check_requirements, read_requirements
from railhil.judge.requirements.sentence import BoundSentence
from railhil.judge.requirements.units import given_unit, unit_of
from railhil.judge.requirements.words import FUNCTIONS, KEYWORDS, SentenceError

#: A sentence, the column of what is wrong with it (from 1), and words of the message.
BAD = [
    # Not of the language.
    ("", 1, "always, never, whenever, at, eventually is missing"),
    ("allways true_speed > 1 m/s", 1, "did you mean always?"),
    ("never", 6, "a value is missing before the end"),
    ("never true_speed", 7, '"true_speed" is a value, and a condition is needed'),
    ("never true_speed > 1 m/s for 2 s", 30, '"longer" is missing'),
    ("never true_speed > 1 m/s for longer than", 41, "a time such as 20 ms is missing"),
    ("never true_speed > 1 m/s true_accel", 26, "could end before this word"),
    ("never true_speed > 1 m/s > 2 m/s", 26, "a comparison has two sides"),
    ("never (true_speed > 1 m/s", 26, '")" is missing'),
    ("never true_speed ? 1 m/s", 18, "no word of the language has this character"),
    ("never true_speed == 1 m/s", 19, "a value is missing"),
    ("whenever true_speed > 1 m/s notch_command <= 0", 29, '"," is missing'),
    ("whenever true_speed > 1 m/s, at one notch_command <= 0", 33, '"once" is missing'),
    ("whenever true_speed > 1 m/s, within notch_command <= 0", 37, "a time such as 20 ms is missing"),
    ("from 1 s always true_speed > 1 m/s", 10, '"to" is missing'),
    ("after 3 always true_speed > 1 m/s", 7, "an event is missing"),
    ("never abs(true_speed, 20 ms) > 1 m/s", 21, '")" is missing'),
    ("never rate(true_speed) > 1 m/s2", 22, '"," is missing'),
    ("never (true_speed > 1 m/s) + 1 m/s > 2 m/s", 7, "is a condition, and a value is needed"),
    ("never train_level in traction_cut", 22, '"(" is missing'),
    ("never " + "not " * 60 + "fault", 211, "is nested deeper than 50"),
    # Units.
    ("whenever age(TRN_SPEED) > 64 m, at once notch_command <= 0", 27, "a time is compared with a length"),
    ("never true_speed > 5", 20, "a speed is compared with a number without a unit"),
    ("never true_speed > 5 parsec", 20, '"parsec" is no unit'),
    ("never true_speed > 5 kmh", 20, '"kmh" is no unit'),
    ("never true_speed + true_position > 5 m/s", 7, "a speed is added to a length"),
    ("never true_speed > limit_at_train + 5 km", 20, "a speed is added to a length"),
    ("never min(true_speed, 3 m) > 5 m/s", 7, "a speed stands beside a length"),
    ("whenever true_speed > 1 m/s, within 20 m notch_command <= 0", 37, "a length, and a time such as 20 ms is needed"),
    ("never rate(true_speed, 20 ms) > 1 m/s", 33, "an acceleration is compared with a speed"),
    ("never true_speed / 0 > 1 m/s", 7, "is a division by 0"),
    # Names.
    ("never tru_speed > 5 m/s", 7, "is no signal and no name, did you mean true_speed?"),
    ("never age(TRN_SPED) > 64 ms", 11, "is no port, did you mean TRN_SPEED?"),
    ("never TRN_SPEED.Speed > 1 m/s", 7, "is no signal of TRN_SPEED"),
    ("at stoped abs(stop_error) <= 0.3 m", 4, "did you mean stopped?"),
    ("never stop_error > 0.3 m", 7, "is a score, which is known only after: at stopped"),
    ("at departed stop_error <= 0.3 m", 13, "is a score, which is known only after: at stopped, or: at end"),
    ("at begin of true_speed <= 0 m/s energy < 1 kJ", 33, "is a score, which is known only after: at stopped"),
    ("never train_level >= traction_cutt", 22, "did you mean traction_cut?"),
    ("never train_level >= 2", 22, "stands beside a level"),
    ("never train_level + 1 > 2", 7, "is a level, with which nothing can be computed"),
    ("never NOTCH_CMD.CtlCause > speed_age", 7, "asks for an order"),
    ("never true_speed in (hold, emergency)", 7, "is no level"),
    ("never emergency > 3", 7, "is a level: it stands only at the right"),
    # Windows and constants.
    ("whenever true_speed > 1 m/s, within 10 ms notch_command <= 0", 37, "than the period of NOTCH_CMD, 20 ms"),
    ("never true_speed > 1 m/s for longer than 10 ms", 42, "is shorter than the period of SIM_TRUTH, 20 ms"),
    ("never rate(true_accel, 10 ms) > 1 m/s3", 24, "is shorter than the period of SIM_TRUTH, 20 ms"),
    ("never mean(measured_speed, 5 ms) > 1 m/s", 28, "is shorter than the period of TRN_SPEED, 10 ms"),
    ("whenever 1 m < 2 m, at once notch_command <= 0", 10, "compares two constants"),
    ("never mean(5 m/s, 1 s) > true_speed", 12, "is a constant, which does not change over time"),
    ("whenever true_speed > 1 m/s, from 25 ms to 29 ms notch_command <= 0", 44, "no tick lies"),
]  # fmt: skip


@pytest.mark.parametrize(("says", "column", "words"), BAD, ids=[says[:60] for says, _, _ in BAD])
def test_a_wrong_sentence_is_refused_in_a_line_with_the_column(says: str, column: int, words: str) -> None:
    with pytest.raises(InputError) as refused:
        Requirement("ATO-12", says, file="some.toml").bind(names())
    line = str(refused.value)
    assert line.startswith("some.toml: requirement ATO-12: ")
    assert "\n" not in line
    assert words in line
    assert line.endswith(f"(column {column})")


GOOD = [
    "always true_speed >= 0 km/h",
    "never true_position > board + 5 m",
    "never abs(rate(mean(true_accel, 500 ms), 20 ms)) > 0.75 m/s3 for longer than 500 ms",
    "whenever age(TRN_SPEED) > 64 ms, within 20 ms notch_command <= 0, until good(TRN_SPEED) >= 5",
    "whenever begin of train_level = emergency, at once train_level = emergency, until end",
    "whenever fault, from 20 ms to 1 s controller_level in (hold, traction_cut) for 40 ms",
    "at stopped abs(stop_error) <= 0.3 m and abs(time_error) <= 5 s",
    "at end energy < 20000 kJ",
    "from 10 s to end, never true_speed < 1 km/h and not (since(departed) < 2 s or fault)",
    "between departed and stopped, eventually within 60 s -2 * true_speed < -10 m/s for 100 ms",
    "after emergency, never NOTCH_CMD.CtlCause != none and before(traction, 1 s) / 2 > 1 kN",
]


@pytest.mark.parametrize("says", GOOD)
def test_spaces_between_the_words_do_not_matter(says: str) -> None:
    spread = re.sub(r"([(),])", r" \1 ", says).replace(" ", "   ")
    parsed, again = (repr(parse_sentence(text).body) for text in (says, spread))
    assert re.sub(r"(column|after)=\d+", "", parsed) == re.sub(r"(column|after)=\d+", "", again)


@pytest.mark.parametrize("says", GOOD)
def test_each_part_has_the_columns_of_its_text(says: str) -> None:
    sentence = parse_sentence(says)
    body = sentence.body
    assert says[body.column : body.after] == says[says.index(says[body.column :].split()[0]) :]
    assert parse_sentence(f"never {says[body.condition.column : body.condition.after]}")
    Requirement("T-1", says).bind(names())


@pytest.mark.parametrize("says", GOOD)
def test_a_sentence_without_one_of_its_words_is_read_or_refused_in_a_line(says: str) -> None:
    words, refusals = says.split(), []
    for place in range(len(words)):
        shorter = " ".join(words[:place] + words[place + 1 :])
        try:
            Requirement("T-1", shorter).bind(names())
        except InputError as error:
            refusals.append(str(error))
    assert all(re.search(r"\(column \d+\)$", line) for line in refusals)
    assert refusals


@pytest.mark.parametrize(
    ("text", "factor", "quantity"),
    [("km/h", 1 / 3.6, "a speed"), ("m/s3", 1, "a jerk"), ("kN", 1000, "a force"), ("permil", 0.001, "a share"),
     ("kWh", 3.6e6, "an energy"), ("min", 60, "a time"), ("notch/s", 1, "a rate"), ("t", 1000, "a mass")],
)  # fmt: skip
def test_units_are_factors_of_si_units(text: str, factor: float, quantity: str) -> None:
    unit = given_unit(text)
    assert (float(unit.factor), unit.quantity, unit.text) == (pytest.approx(factor), quantity, text)


def test_every_unit_of_the_shipped_port_tables_is_known() -> None:
    units = {signal.unit for port in names().contract.ports for signal in port.signals}
    assert all(unit_of(unit) == given_unit(unit) for unit in units if unit)


FILE = """\
[define]
over = "true_speed - limit_at_train"
is_cut = "train_level >= traction_cut"

[[requirement]]
id = "A-1"
says = "never over > 5 km/h"
title = "speed"
source = "chosen"

[[requirement]]
id = "A-2"
says = "whenever is_cut, within 200 ms traction <= 0.01 kN"
when = { faults = "none" }
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "requirements.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_has_requirements_and_names(tmp_path: Path) -> None:
    found = read_requirements(written(tmp_path, FILE))
    assert [(one.id, one.title, one.when) for one in found] == [("A-1", "speed", "any"), ("A-2", "", "none")]
    check_requirements(found, scenario())


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('id = "A-2"', 'id = "A-1"', "requirement.id: found 'A-1', allowed an id that no other requirement has"),
        ('title = "speed"', 'titel = "speed"', "did you mean title?"),
        ("says = \"never over > 5 km/h\"\n", "", "requirement[0].says"),
        ('faults = "none"', 'faults = "some"', "'any' or 'none'"),
        ("never over > 5 km/h", "never over > 5 km/h and", 'requirement A-1: "never over > 5 km/h and" a value'),
        ('over = "true_speed - ', 'over = "true_speed - * ', "define.over"),
        ('is_cut = "', 'within = "', "define.within: found 'within', allowed a name that is no word"),
        ("[[requirement]]", "[[requirements]]", "did you mean requirement?"),
        (FILE, "", "at least one [[requirement]]"),
        (FILE, "[", "a TOML file of requirements"),
    ],
)  # fmt: skip
def test_a_wrong_file_is_refused_in_a_line(tmp_path: Path, old: str, new: str, words: str) -> None:
    path = written(tmp_path, FILE.replace(old, new))
    with pytest.raises(InputError) as refused:
        read_requirements(path)
    assert str(refused.value).startswith(f"{path}: ")
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("define", "words"),
    [
        ({"a": "b + 1 m", "b": "a"}, "is defined by itself"),
        ({"a": "true_speed * 2"}, "a speed is compared with a length"),
        ({"a": "true_sped"}, 'in which "true_sped" is no signal and no name, did you mean true_speed?'),
        ({"a": "true_speed > 1 m/s"}, "is a condition, and a value is needed"),
    ],
)
def test_a_wrong_name_is_refused_where_it_is_used(define: dict[str, str], words: str) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        Requirement("T-1", "never a > 1 m", define=tuple(define.items())).bind(names())


def test_a_name_that_a_run_has_already_is_refused() -> None:
    for name in ("true_speed", "stopped", "emergency", "stop_error"):
        with pytest.raises(InputError, match=f"define.{name}: found '1 m', allowed a name that no signal"):
            Requirement("T-1", "never fault", define=((name, "1 m"),)).bind(names())


#: Pieces of which sentences are made, and some that no sentence has.
PIECES = (
    *KEYWORDS, *FUNCTIONS, *"()<>=+-*/.,%?'", "<=", "!=", "20 ms", "5", "1e9", "7 m/s2", "true_speed", "TRN_SPEED",
    "TrainSpeed", "train_level", "emergency", "stopped", "fault", "3 km/h/h", "µ", "", "__import__",
)  # fmt: skip


@given(st.lists(st.sampled_from(sorted(PIECES)), max_size=25), st.sampled_from([*GOOD, ""]), st.integers(0, 12))
def test_any_words_are_a_sentence_or_refused_with_a_column_inside(pieces: list[str], good: str, place: int) -> None:
    words = good.split()
    says = " ".join([*words[:place], *pieces, *words[place:]])
    try:
        BoundSentence(says, names(), {})
    except SentenceError as error:
        column = error.column
    else:
        column = 0
    assert 0 <= column <= len(says)


def test_a_sentence_of_excessive_length_is_refused() -> None:
    with pytest.raises(InputError, match=r"has more than 1000 characters \(column 1001\)"):
        Requirement("T-1", "never " + "1 + " * 300 + "1 > 0").bind(names())


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist, expected a file of requirements, or the name of a system"):
        read_requirements(tmp_path / "none.toml")
