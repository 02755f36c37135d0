"""The fault language: one line of text <-> :class:`railhil.faults.model.Fault`.

``WHERE WHAT [values] @WHEN [for HOWLONG | xCOUNT] [until EVENT] [after WORD] [seed N] [units 1,3] [combine] [id NAME]
[expect LEVEL within TIME by CAUSE verdict VERDICT]``, such as ``speed stuck @60s for 2s`` or ``TRN_SPEED loss 30% @20s
for 5s``. Places, words and values are in :mod:`railhil.faults.words`. A name with an underscore may be written as two
words, and that of a place also with a dot. A share directly behind a place with one word means that word.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.faults import FAULT
from railhil.faults.model import (
    NAME,
    SHARE,
    TIME,
    WATCH_LEVELS,
    Draw,
    Expect,
    Fault,
    Parameter,
    Place,
    Trigger,
    Value,
    Word,
)
from railhil.faults.notation import (
    ALLOWED,
    UNITS,
    allowed_places,
    allowed_text,
    is_short,
    number_of,
    number_text,
    place_hint,
    place_of,
    place_text,
    trigger_of,
    trigger_text,
    value_of,
    value_text,
)
from railhil.faults.span import Complain, end_s, with_span
from railhil.faults.words import CLEAR, ONLY, word_of, words_at

#: Faults of one run; SUP_CMD numbers them in 8 bits.
FAULTS_MAX = 255
_SEED_MAX = 0xFFFF_FFFF
_TAIL = ("for", "until", "after", "seed", "unit", "units", "combine", "id", "expect")
_FIRST_OF_TAIL = re.compile(rf"\s(?:x\d+|{'|'.join(_TAIL)})(?=\s|$)")
_VERDICTS = ("PASS", "FAIL", "INVALID")
_EVENT = re.compile(r"[a-z][a-z0-9_]*")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.\-]*")
_BARE = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)")
_UNIT_WORDS = {unit for units in UNITS.values() for unit in units if unit} | {"km/h"}
_SHOWN_MAX = 60


class _Reader:
    """The words of one text, from left to right."""

    def __init__(self, text: str, source: str | Path) -> None:
        flat = re.sub(r"\(([^()]*)\)", lambda match: "(" + "".join(match.group(1).split()) + ")", text)
        # Brackets belong to the word before them.
        words = re.sub(r"\s+\(", "(", flat).replace("@", " @ ").split()
        self._words: list[str] = []
        for word in words:
            if word in _UNIT_WORDS and self._words and _BARE.fullmatch(self._words[-1]):
                self._words[-1] += word
            else:
                self._words.append(word)
        self._source = source
        flat = " ".join(text.split())
        self._key = flat if len(flat) <= _SHOWN_MAX else f"{flat[: _SHOWN_MAX - 3]}..."

    @property
    def next(self) -> str:
        """The next word; empty at the end."""
        return self._words[0] if self._words else ""

    def take(self) -> str:
        """Read the next word."""
        return self._words.pop(0) if self._words else ""

    def take_joined(self, is_known: Callable[[str], bool]) -> str:
        """Read the next word, and the one after it if both are one name: ``door left`` is ``door_left``."""
        word = self.take()
        joined = f"{word}_{self.next}"
        if not is_known(joined):
            return word
        self.take()
        return joined

    def refused(self, found: str, allowed: str, hint: str | None = None) -> InputError:
        """The error for a word."""
        return InputError(self._source, self._key, found or Words(), allowed, hint)


def parse(text: str, source: str | Path = FAULT, trigger: Trigger | None = None) -> Fault:
    """The fault of a text.

    :param source: source named in errors.
    :param trigger: used if the text has no ``@WHEN``; None: it must have one.
    :raises InputError: it is not in the language: what was found, what is allowed.
    """
    reader = _Reader(text, source)
    where = reader.take_joined(is_short)
    place = place_of(where)
    if place is None:
        raise reader.refused(where, allowed_places(), place_hint(where))
    which = reader.take() if reader.next.isascii() and reader.next.isdigit() else ""
    what = _only_word(reader, place) or reader.take_joined(
        lambda name: word_of(place.level, place.name, place.part, name) is not None
    )
    word = _word(reader, place, what)
    values = _values(reader, word)
    if which:
        _choose(reader, word, values, which)
    count = int(reader.take()[1:]) if _is_count(reader.next) else None
    if reader.next == "@":
        reader.take()
        trigger = _when(reader)
    elif reader.next or trigger is None:
        raise reader.refused(reader.next, _expected(word, values))
    return check_fault(_tail(reader, Fault(place, what, trigger, values, count=count)), reader.refused)


def _only_word(reader: _Reader, place: Place) -> str:
    """The word that a share behind a place means, if the place has one word with a share: ``emergency_brake 70%`` is
    ``emergency_brake weak 70%``. Empty: no share comes next, or it could mean several words."""
    known = [one for one in words_at(place.level, place.name, place.part) if one.name != CLEAR]
    if len(known) != 1 or [one.unit for one in known[0].parameters] != [SHARE]:
        return ""
    return known[0].name if reader.next.endswith("%") and value_of(reader.next, SHARE) is not None else ""


def _word(reader: _Reader, place: Place, what: str) -> Word:
    word = word_of(place.level, place.name, place.part, what)
    if word is not None:
        return word
    known = [one.name for one in words_at(place.level, place.name, place.part)]
    raise reader.refused(what, f"{place_text(place)} with one of {', '.join(known)}", did_you_mean(what, known))


def _expected(word: Word, values: dict[str, Value]) -> str:
    missing = [one for one in word.parameters if one.name not in values]
    left = [f"{one.keyword} " * bool(one.keyword) + allowed_text(one.unit) for one in missing]
    return " or ".join([*left, "@WHEN"])


def _values(reader: _Reader, word: Word) -> dict[str, Value]:
    """Parameters by name: parameters without a keyword by their place, then the others in any order."""
    values: dict[str, Value] = {}
    for one in word.parameters:
        if not one.keyword and not _ends(reader, word):
            values[one.name] = _value(reader, one)
    while reader.next not in ("@", "", *_TAIL) and not _is_count(reader.next):
        keyword = reader.next
        group = [one for one in word.parameters if keyword and one.keyword == keyword]
        if not group or any(one.name in values for one in group):
            raise reader.refused(keyword, _expected(word, values))
        reader.take()
        for one in group:
            values[one.name] = _value(reader, one)
    return values


def _choose(reader: _Reader, word: Word, values: dict[str, Value], which: str) -> None:
    """Take the number behind the place: ``balise 12 missed`` is ``balise missed only 12``."""
    if ONLY.name in values or ONLY not in word.parameters:
        raise reader.refused(which, f"{word.name}, without a number before it")
    values[ONLY.name] = float(which)


def _ends(reader: _Reader, word: Word) -> bool:
    """Whether no value by place comes next."""
    keywords = (one.keyword for one in word.parameters if one.keyword)
    return reader.next in ("@", "", *_TAIL, *keywords) or _is_count(reader.next)


def _value(reader: _Reader, parameter: Parameter) -> Value:
    text = reader.take()
    found = value_of(text, parameter.unit)
    if found is None:
        raise reader.refused(text, f"{parameter.meaning}, such as {allowed_text(parameter.unit)}")
    return found


def _when(reader: _Reader) -> Trigger:
    words = []
    while reader.next and reader.next not in _TAIL and not _is_count(reader.next):
        words.append(reader.take())
    found = trigger_of(" ".join(words))
    if found is None:
        raise reader.refused(f"@{''.join(words)}", f"@ and {ALLOWED}")
    return found


def _is_count(word: str) -> bool:
    return word[:1] == "x" and word[1:].isascii() and word[1:].isdigit()


def _tail(reader: _Reader, fault: Fault) -> Fault:
    said = {"count"} if fault.count is not None else set()
    while reader.next:
        word = reader.take()
        kind = "count" if _is_count(word) else "units" if word == "unit" else word
        if kind in said:
            raise reader.refused(word, f"{word} only once")
        said.add(kind)
        if kind == "count":
            fault = replace(fault, count=int(word[1:]))
        elif word == "combine":
            fault = replace(fault, combine=True)
        elif word == "expect":
            fault = replace(fault, expect=_expect(reader))
        elif word in _TAIL:
            fault = _with(reader, fault, word, reader.take())
        else:
            raise reader.refused(word, f"x5, {', '.join(_TAIL)}", did_you_mean(word, _TAIL))
    return fault


def _with(reader: _Reader, fault: Fault, word: str, text: str) -> Fault:
    if word == "for":
        duration_s = number_of(text, TIME)
        if duration_s is None or duration_s <= 0 or text[-1:].isdigit():
            raise reader.refused(text, "a duration above 0, such as for 500ms or for 2s")
        return replace(fault, duration_s=duration_s)
    if word == "until":
        if not _EVENT.fullmatch(text) and end_s(text) is None:
            raise reader.refused(text, "an event, such as until standstill, or a time of the run, such as until 400s")
        return replace(fault, until=text)
    if word == "after":
        return replace(fault, after=text)
    if word == "seed":
        if not (text.isascii() and text.isdigit() and len(text) <= 10 and int(text) <= _SEED_MAX):
            raise reader.refused(text, f"a seed from 0 to {_SEED_MAX}")
        return replace(fault, seed=int(text))
    if word == "id":
        if not _NAME.fullmatch(text):
            raise reader.refused(text, "a name of letters and digits, such as T3")
        return replace(fault, id=text)
    numbers = text.split(",")
    if not all(one.isascii() and one.isdigit() and 1 <= int(one[:4]) <= 255 and len(one) <= 3 for one in numbers):
        raise reader.refused(text, "units from 1, such as units 1,3")
    return replace(fault, units=tuple(sorted({int(one) for one in numbers})))


def _expect(reader: _Reader) -> Expect:
    level, within_s, by, verdict = "", None, "", ""
    if reader.next not in ("within", "by", "verdict", ""):
        level = reader.take().replace("_", " ").upper()
        if any(known.startswith(f"{level} ") for known in WATCH_LEVELS):
            level = f"{level} {reader.take().upper()}"
    while reader.next in ("within", "by", "verdict"):
        word, text = reader.take(), reader.take()
        if word == "within":
            within_s = number_of(text, TIME)
            if within_s is None or within_s < 0:
                raise reader.refused(text, "a time, such as within 500ms")
        elif word == "by":
            by = text
        else:
            verdict = text
    return Expect(level, within_s, by, verdict)


def check_fault(fault: Fault, complain: Complain) -> Fault:
    """The fault with the usual values of all parameters that are not given.

    :param complain: makes the error from what was found, what is allowed and a hint.
    :raises InputError: word, value or combination is not allowed.
    """
    place = fault.place
    word = word_of(place.level, place.name, place.part, fault.what)
    if word is None:
        known = [one.name for one in words_at(place.level, place.name, place.part)]
        raise complain(
            fault.what, f"{place_text(place)} with one of {', '.join(known)}", did_you_mean(fault.what, known)
        )
    values = dict(_complete(fault, word, complain))
    ends = [name for name, on in (("for", fault.duration_s), ("x", fault.count), ("until", fault.until)) if on]
    if len(ends) > 1:
        raise complain(" and ".join(ends), "one of for, xCOUNT and until")
    if fault.count is not None and fault.count < 1:
        raise complain(f"x{fault.count}", "a count from x1")
    if ends and not word.lasts:
        raise complain(ends[0], f"{fault.what} without a duration")
    if word.name == "restart" and fault.duration_s is None:
        raise complain("", "restart for some time, such as for 500ms")
    fault = with_span(fault, complain)
    if fault.after and fault.after not in word.after:
        allowed = f"after {' or '.join(word.after)}" if word.after else f"{fault.what} without after"
        raise complain(fault.after, allowed, did_you_mean(fault.after, word.after))
    if fault.trigger.kind == "telegram" and place.level not in ("telegram", "command"):
        raise complain(f"@{trigger_text(fault.trigger)}", "the number of a telegram only for a port")
    if fault.expect is not None:
        _check_expect(fault.expect, complain)
    return replace(fault, values=MappingProxyType(values))


def _complete(fault: Fault, word: Word, complain: Complain) -> Iterator[tuple[str, Value]]:
    known = {one.name: one for one in word.parameters}
    for name in fault.values:
        if name not in known:
            raise complain(name, f"{fault.what} with {', '.join(known) or 'no values'}", did_you_mean(name, known))
    for name, one in known.items():
        value = fault.values.get(name, one.usual)
        if value is None:
            raise complain("", f"{fault.what} with {one.meaning}, such as {allowed_text(one.unit)}")
        if isinstance(value, str) != (one.unit == NAME):
            raise complain(str(value), f"{one.meaning}, such as {allowed_text(one.unit)}")
        numbers = () if isinstance(value, str) else (value.a, value.b) if isinstance(value, Draw) else (value,)
        if isinstance(value, Draw) and value.kind == "normal":
            numbers = (value.a,)
        for number in numbers:
            if not one.low <= number <= one.high:
                span = f"{number_text(one.low, one.unit)} to {number_text(one.high, one.unit)}"
                raise complain(number_text(number, one.unit), f"{one.meaning}: {span}")
        yield name, value


def _check_expect(expect: Expect, complain: Complain) -> None:
    if expect == Expect():
        raise complain("", "expect with a level, within, by or verdict")
    if expect.verdict and expect.verdict not in _VERDICTS:
        raise complain(expect.verdict, f"verdict {', '.join(_VERDICTS)}", did_you_mean(expect.verdict, _VERDICTS))
    if expect.level and expect.level not in WATCH_LEVELS:
        raise complain(expect.level, ", ".join(WATCH_LEVELS), did_you_mean(expect.level, WATCH_LEVELS))
    if expect.detected_by and not _NAME.fullmatch(expect.detected_by):
        raise complain(expect.detected_by, "a cause of the watches")


def with_condition(text: str, condition: str) -> str:
    """The text with ``@condition`` at the place of the trigger if it has none: before ``for``, ``until``, ..."""
    if "@" in text or not text.strip():
        return text
    found = _FIRST_OF_TAIL.search(text)
    at = found.start() if found else len(text)
    return f"{text[:at]} @{condition}{text[at:]}"


def sameness(fault: Fault) -> tuple[object, ...]:
    """Identity of a fault apart from its beginning and end."""
    return fault.place, fault.what, tuple(sorted(fault.values.items())), fault.count, fault.after, fault.units


def fault_text(fault: Fault, *, judging: bool = True) -> str:
    """The canonical text of a fault: :func:`parse` reads it back.

    :param judging: with ``id`` and ``expect``, which do not change the run.
    """
    place = fault.place
    word = word_of(place.level, place.name, place.part, fault.what)
    assert word is not None
    words = [place_text(place), fault.what, *_value_words(fault, word), f"@{trigger_text(fault.trigger)}"]
    words += [f"for {number_text(fault.duration_s, TIME)}"] if fault.duration_s is not None else []
    words += [f"x{fault.count}"] if fault.count is not None else []
    words += [f"until {fault.until}"] if fault.until else []
    words += [f"after {fault.after}"] if fault.after else []
    words += [f"seed {fault.seed}"] if fault.seed is not None else []
    words += [f"units {','.join(map(str, fault.units))}"] if fault.units else []
    words += ["combine"] * fault.combine
    if judging:
        words += [f"id {fault.id}"] if fault.id else []
        words += _expect_words(fault.expect)
    return " ".join(words)


def _value_words(fault: Fault, word: Word) -> Iterator[str]:
    """Values up to the last unusual one; a keyword and its values only if one of these is unusual."""
    placed = [one for one in word.parameters if not one.keyword]
    given = [index for index, one in enumerate(placed) if fault.values.get(one.name, one.usual) != one.usual]
    for one in placed[: max(given, default=-1) + 1]:
        yield value_text(fault.values[one.name], one.unit)
    for keyword in dict.fromkeys(one.keyword for one in word.parameters if one.keyword):
        group = [one for one in word.parameters if one.keyword == keyword]
        if any(fault.values.get(one.name, one.usual) != one.usual for one in group):
            yield keyword
            for one in group:
                usual = "" if one.usual is None else one.usual
                yield value_text(fault.values.get(one.name, usual), one.unit)


def _expect_words(expect: Expect | None) -> list[str]:
    if expect is None:
        return []
    words = ["expect"] + ([expect.level.replace(" ", "_")] if expect.level else [])
    words += [f"within {number_text(expect.within_s, TIME)}"] if expect.within_s is not None else []
    words += [f"by {expect.detected_by}"] if expect.detected_by else []
    return words + ([f"verdict {expect.verdict}"] if expect.verdict else [])
