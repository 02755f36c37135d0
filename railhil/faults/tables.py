"""A fault as a table of a scenario file: ``[[fault]]`` with where, what, when, for, ..., and as a text in its place."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from railhil.faults.language import check_fault, parse
from railhil.faults.model import LENGTH, NAME, SPEED, TIME, Expect, Fault, Trigger, Value
from railhil.faults.notation import (
    ALLOWED,
    allowed_places,
    allowed_text,
    number_of,
    place_hint,
    place_of,
    trigger_of,
    value_of,
)
from railhil.faults.span import Complain
from railhil.faults.words import word_of

#: Units of the conditions that a table ``when`` may name.
_CONDITIONS = {"time": TIME, "position": LENGTH, "speed": SPEED, "event": NAME, "telegram": "", "manual": ""}


def fault_of(row: Mapping[str, Any] | str, complain: Complain, source: Any) -> Fault:
    """The fault of a row: a table whose keys have been checked for their types, or a text.

    :param complain: makes the error for a table.
    :param source: source of the row, for the error about a text.
    :raises InputError: it is not in the language.
    """
    if isinstance(row, str):
        return parse(row, source)
    place = place_of(row["where"])
    if place is None:
        raise complain(row["where"], allowed_places(), place_hint(row["where"]))
    what = row["what"]
    word = word_of(place.level, place.name, place.part, what)
    units = {one.name: one.unit for one in word.parameters} if word is not None else {}
    values: dict[str, Value] = {}
    for name, given in (row.get("with") or {}).items():
        unit = units.get(name, NAME)
        found = value_of(given, unit) if isinstance(given, str) else float(given)
        if found is None:
            raise complain(str(given), f"{name} such as {allowed_text(unit)}")
        values[name] = found
    number, several = row.get("unit"), row.get("units") or ()
    if number is not None and several:
        raise complain("unit beside units", "one of the two")
    made = Fault(
        place,
        what,
        _trigger(row["when"], complain),
        values,
        duration_s=_time(row.get("for"), "for", complain),
        count=row.get("count"),
        until=row.get("until") or "",
        after=row.get("after") or "",
        seed=row.get("seed"),
        units=tuple(sorted({*several, *(() if number is None else (number,))})),
        combine=bool(row.get("combine")),
        expect=_expect(row.get("expect"), complain),
        id=row.get("id") or "",
    )
    return check_fault(made, complain)


def _time(given: str | float | None, key: str, complain: Complain) -> float | None:
    """A time as text with a unit, or as a number of seconds."""
    if given is None:
        return None
    found = number_of(given, TIME) if isinstance(given, str) else float(given)
    if found is None or found < 0 or (key == "for" and found == 0):
        raise complain(str(given), f"{key}: a time such as 2 s or 300 ms")
    return found


def _trigger(given: str | float | Mapping[str, Any], complain: Complain) -> Trigger:
    if isinstance(given, int | float):
        given = f"{float(given)!r}s"
    if isinstance(given, str):
        found = trigger_of(given.strip().removeprefix("@").strip())
        if found is None:
            raise complain(given, ALLOWED)
        return found
    kinds = [kind for kind in _CONDITIONS if given.get(kind) is not None]
    if len(kinds) != 1:
        raise complain(", ".join(kinds), f"when with one of {', '.join(_CONDITIONS)}")
    kind, value = kinds[0], given[kinds[0]]
    delay_s = _time(given.get("delay"), "delay", complain) or 0.0
    if given.get("edge") is not None and kind != "speed":
        raise complain("edge", "edge only with speed")
    if kind == "telegram":
        if not isinstance(value, int) or value < 1:
            raise complain(str(value), "the number of a telegram, from 1")
        return Trigger("telegram", float(value), delay_s=delay_s)
    if kind == "manual":
        return Trigger("manual")
    if kind == "event":
        return Trigger("event", str(value), delay_s=delay_s)
    number = number_of(value, _CONDITIONS[kind]) if isinstance(value, str) else float(value)
    if number is None or (kind == "time" and number < 0):
        raise complain(str(value), f"{kind} such as {allowed_text(_CONDITIONS[kind])}")
    if kind == "time":
        return Trigger("time", number, delay_s=delay_s)
    if kind == "position":
        return Trigger("position", number, delay_s=delay_s)
    return Trigger("speed", number, "falling" if given.get("edge") == "falling" else "rising", delay_s)


def _expect(given: Mapping[str, Any] | None, complain: Complain) -> Expect | None:
    if given is None:
        return None
    within_s = _time(given.get("within"), "within", complain)
    level = (given.get("level") or "").replace("_", " ").upper()
    return Expect(level, within_s, given.get("detected_by") or "", given.get("verdict") or "")
