"""The tables of words and of what can be injected where, and the page made from them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.faults.capability import REFUSALS, TRANSPORTS, check_injectable, why_not
from railhil.faults.language import parse
from railhil.faults.model import LEVELS
from railhil.faults.page import PAGE, lines, page, row
from railhil.faults.words import CLEAR, PLACES, WORDS, levels_of, words_at
from railhil.scenarios.fault_list import fault_texts
from railhil.scenarios.system import system_named


def test_the_page_is_current() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "python -m railhil.faults.page writes it"


def test_the_page_gives_an_example_of_each_value_that_is_required() -> None:
    parts = {"counter": "TRN_SPEED.counter", "checksum": "TRN_SPEED.checksum", "signal": "TRN_SPEED.TrainSpeed"}
    for word in WORDS:
        for text in re.findall(r"required, such as ([^)]*)", row(word)[1]):
            name = word.names[0] if word.names else next(iter(PLACES.get(word.level, ())), "TRN_SPEED")
            place = parts.get(word.part) or f"{word.level}.{name}".removeprefix("telegram.")
            (required,) = [one for one in word.parameters if one.usual is None]
            assert parse(f"{place} {word.name} {text} @manual").values[required.name] is not None


def test_a_meaning_does_not_begin_with_the_name_again() -> None:
    values = [cell for word in WORDS for cell in row(word)[1].split("; ")]
    assert not [cell for cell in values if re.match(r"`(\w+?)(_\w+)?` \1\b", cell) and "`gemodel`" not in cell]


def test_every_level_has_words_and_each_place_one() -> None:
    assert set(levels_of()) == set(LEVELS)
    for level, names in PLACES.items():
        for name in names:
            assert [word for word in words_at(level, name, "") if word.name != CLEAR], f"{level}.{name}"
    for word in WORDS:
        assert set(word.names) <= set(PLACES.get(word.level, word.names)), word.name


def test_no_word_stands_twice_at_a_place() -> None:
    for level, names in [*PLACES.items(), ("telegram", {"TRN_SPEED": ""})]:
        for name in names:
            for part in (
                ("", "counter", "checksum", "TrainSpeed") if level == "telegram" else ("", "a")[: 1 + (level == "bus")]
            ):
                found = [word.name for word in words_at(level, name, part)]
                assert len(found) == len(set(found)), f"{level}.{name}.{part}"


def test_every_word_is_on_the_console() -> None:
    text = "\n".join(lines())
    for word in WORDS:
        assert word.name == CLEAR or f"  {word.name}" in text


@pytest.mark.parametrize(
    ("text", "transport", "pace", "sources", "said"),
    [
        ("TRN_SPEED loss @1s", "local", "lockstep", ["plant"], ""),
        ("TRN_SPEED loss @1s", "board", "realtime", ["plant"], ""),
        ("NOTCH_CMD loss @1s", "board", "lockstep", ["controller"], "not railhil's"),
        ("bus off @1s", "board", "lockstep", ["controller", "plant"], "not railhil's"),
        ("TRN_SPEED loss @1s", "batch", "lockstep", ["plant"], "no injectors"),
        ("plant stop @1s for 1s", "hub", "lockstep", ["plant"], "stand still"),
        ("plant stop @1s for 1s", "hub", "realtime", ["plant"], ""),
        ("plant kill @1s", "hub", "lockstep", ["plant"], ""),
        ("plant restart @1s for 1s", "hub", "lockstep", ["plant"], "only a controller"),
        ("supervisor kill @1s", "hub", "lockstep", ["supervisor"], "by hand"),
        ("wall pause 1s @1s", "kernel", "realtime", ["plant"], ""),
        ("wall pause 1s @1s", "kernel", "lockstep", ["plant"], "no wall clock"),
        ("bus.b open @1s", "hub", "lockstep", [], ""),
        ("bus.b open @1s", "kernel", "lockstep", [], "two lines"),
        ("bus error_frames @1s", "local", "lockstep", [], "only railhil's hub takes orders"),
        ("bus passive @1s", "hub", "realtime", [], ""),
        ("bus ok @1s", "hub", "lockstep", [], ""),
    ],
)
def test_what_cannot_be_injected_says_why(text: str, transport: str, pace: str, sources: list[str], said: str) -> None:
    fault = parse(text)
    why = why_not(fault, transport, pace, sources)
    assert (said in why) if said else not why
    if why:
        with pytest.raises(InputError, match="cannot be injected in a run") as caught:
            check_injectable(fault, [transport], pace, sources)
        assert "\n" not in str(caught.value)


def test_each_refusal_is_about_something() -> None:
    for entry in REFUSALS:
        assert set(entry.transports) <= set(TRANSPORTS)
        assert any(entry.fits(word, name) for word in WORDS for name in ("", *entry.names)), entry.why


def test_an_unknown_port_has_the_name_that_the_user_wrote() -> None:
    """Not that of the port of the first unit, which railhil looks for."""
    with pytest.raises(InputError, match=r"found 'U2_SPEED', allowed a port: .*UNIT2_FB"):
        fault_texts(["U2_SPEED loss @1s"], system_named("emu3"), lambda row: Path("file"))
