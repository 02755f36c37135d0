"""The texts of new scenario files: a complete one with a line and a train, and one that is based on another."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import Any

from pydantic import TypeAdapter, ValidationError

from railhil.common.errors import InputError
from railhil.scenarios.layers import Layers
from railhil.scenarios.load import RUNS, find, load_any, names, short_names
from railhil.scenarios.reference import Key
from railhil.scenarios.schema import Name
from railhil.scenarios.system import DEFAULT, system_named
from railhil.scenarios.tomlfile import parse_toml

_TEMPLATES = Path(__file__).with_name("templates")
#: Longer values (tables of rows) are left out; they can be found in the base scenario.
_LETTERS_MAX = 80
#: Example of a line with stops: names before the last one, distances between stops, grade of each section; repeated.
_STOPS = ("North Street", "Market", "University", "Park", "Hospital")
_SPACES_M = (1100, 900, 1400, 1000)
_GRADES_PERMIL = (8, -6, 10, -8)


def line_file(name: str) -> str:
    """The text of a complete scenario with a line and a train of its own."""
    return _fill(
        "line.toml.in",
        name=name,
        head="A line and a train of your own",
        title=json.dumps(f"{name}, from North Street to Harbour"),
        values="all values",
        train=_fill("own_train.toml.in"),
        line=_fill("own_line.toml.in"),
        distance_m="1400",
    )


def stops_file(name: str, count: int) -> str:
    """The text of a complete scenario on a line with stops and a timetable, and with a train of its own.

    Between two stops the line climbs and falls, and its limit changes.

    :param count: number of stops, at least 2.
    """
    names = [*_STOPS[: count - 1], *(f"Stop {number}" for number in range(len(_STOPS) + 1, count)), "Harbour"]
    places_m = [sum(_SPACES_M[number % len(_SPACES_M)] for number in range(order)) for order in range(count)]
    grades, limits = [[0, 0]], [[0, 50]]
    for order, place_m in enumerate(places_m[:-1]):
        permil = _GRADES_PERMIL[order % len(_GRADES_PERMIL)]
        grades += [[place_m + 300, permil], [place_m + 600, 0]]
        limits += [[place_m + 200, 70], [places_m[order + 1] - 300, 50]]
    rows = [
        f'    {{ name = {json.dumps(stop)}, position_m = {place_m}, platform = "left", psd = true }},'
        for stop, place_m in zip(names, places_m, strict=True)
    ]
    return _fill(
        "stops.toml.in",
        name=name,
        count=str(count),
        title=json.dumps(f"{name}, from {names[0]} to {names[-1]}"),
        train=_fill("own_train.toml.in"),
        grades=json.dumps(grades),
        limits=json.dumps(limits),
        stops="\n".join(rows),
    )


def imported_line_file(name: str, source: Path, track_ids: Sequence[str], folder: Path) -> str:
    """The text of a complete scenario on a line of another tool's file.

    :param source: the file; :func:`railhil.systems.ato.scenario.importers.new_line.read_new_line` has its formats.
    :param track_ids: its tracks in the order of running, or its path; none for its only one.
    :param folder: folder of the new file; the path to the source is relative to it.
    :raises InputError: the file is wrong.
    """
    train = parse_toml(line_file(name))["train"]
    new = system_named(DEFAULT).part("new_line")(source, track_ids, folder, train)
    keys = [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in new.keys.items()]
    notes = [f"# {' '.join(remark.split())}" for remark in new.remarks]
    return _fill(
        "line.toml.in",
        name=name,
        head="A line of another tool's file and a train of your own",
        title=json.dumps(f"{name}, on a line of {source.name}", ensure_ascii=False),
        values="the values of the train",
        train=_fill("own_train.toml.in"),
        line="\n".join(["[line]", *keys, *notes, ""]),
        distance_m=repr(new.distance_m),
    )


def scenario_file(name: str, base: str, folder: Path) -> str:
    """The text of a new scenario file.

    :param base: the scenario on which it is based, shipped name or file.
    :param folder: folder of the new file; a path to the base is relative to it.
    :raises InputError: the base scenario cannot be loaded.
    """
    path, scenario = find(base), load_any(base)
    shipped = path.parent == RUNS
    reference = path.stem if shipped else Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    extends = json.dumps(reference, ensure_ascii=False)
    text = _fill("scenario.toml.in", name=name, base=scenario.name, extends=extends)
    kind = scenario.installed_system.scenario_kind
    return text + _keys(kind.usual_keys(), Layers(path).merge())


def check_scenario_name(name: str) -> None:
    """Refuse what a scenario cannot have as its name, and the name of a shipped scenario. Raises InputError."""
    try:
        TypeAdapter(Name).validate_python(name)
    except ValidationError:
        allowed = "at most 80 small letters, digits, _ and -, a letter or a digit first"
        raise InputError("command line", "NAME", name, allowed) from None
    if name in {*names(), *short_names().values()}:
        raise InputError("command line", "NAME", name, "a name that no shipped scenario has")


def _fill(template: str, **words: str) -> str:
    return Template((_TEMPLATES / template).read_text("utf-8")).substitute(words)


def _keys(usual: list[Key], given: dict[str, Any]) -> str:
    """The keys as comments, section by section."""
    sections: dict[str, list[str]] = {}
    for key in usual:
        section, _, last = key.name.rpartition(".")
        value = _value(given, key)
        if value:
            sections.setdefault(section, []).append(f"# {_explained(key)}\n#{last} = {value}\n")
    # An empty table would lack its required keys where the base has no such table.
    marks = {section: "" if _has(given, section) else "#" for section in sections}
    return "".join(f"\n{marks[section]}[{section}]\n{''.join(lines)}" for section, lines in sections.items())


def _has(given: dict[str, Any], section: str) -> bool:
    """Whether a table has a section; those of the top level may always be begun."""
    found: Any = given
    for word in section.split("."):
        found = found.get(word) if isinstance(found, dict) else None
    return found is not None or "." not in section


def _value(given: dict[str, Any], key: Key) -> str:
    """The value of a key in the base scenario, or its default, as TOML; empty if there is neither, and for a table."""
    found: Any = given
    for word in key.name.split("."):
        found = found.get(word) if isinstance(found, dict) else None
    found = key.initial if found is None else found
    if found is None or isinstance(found, dict) or "[]" in key.name:
        return ""
    text = json.dumps(found, ensure_ascii=False)
    return text if len(text) <= _LETTERS_MAX else ""


def _explained(key: Key) -> str:
    """The meaning of a key, with unit, default and allowed values."""
    unit = "" if key.unit == "-" else f"in {key.unit}; "
    default = "no default" if key.default in ("-", "required") else f"default {key.default}"
    return f"{key.meaning or key.name} ({unit}{default}; {key.allowed})"
