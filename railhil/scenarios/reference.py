"""``docs/reference/scenario_keys.md``: every key of a scenario file with unit, default and range, from the schema.

``python -m railhil.scenarios.reference`` writes it; a test compares the file with the generated text.
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from railhil.scenarios.schema import SMALLEST
from railhil.scenarios.system import DEFAULT, system_named

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "scenario_keys.md"
_HEAD = """\
# Every key of a scenario file

Written by `python -m railhil.scenarios.reference` from the schema that checks the files. Keys are written as for
`--set` ([scenarios](../howto/scenarios.md)); `[]` stands for the rows of an array, which is set as a whole. In
addition, a file may contain `extends` and `without`, and `[train]`, `[line]` and `[target]` may contain `file`
([rules](scenario_files.md)). A `required` key must be given by the file or by a file that it is based on.
"""
_NUMBERS = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true or false"}

#: Meaning of the keys of every system, by dotted key; ``[]`` stands for the rows of an array of tables.
_MEANING = {
    "schema_version": "version of this format",
    "system": "kind of train and task, an installed one (railhil.systems)",
    "name": "name of the run in folders, logs and tables",
    "title": "title of the run in tables and reports",
    "assumptions": "sentences about values that are chosen rather than published or measured",
    "timing.base_tick_ms": "tick of plant and bus",
    "timing.control_period_ms": "period of the law",
    "timing.loop_delay_s": "delay from the command to the actuator's response; at most 0.3 s and one control period",
    "timing.port_period_ms": "periods of ports by name, replacing those of the port table: whole multiples of the tick",
    "fault": "[faults](faults.md) to inject: tables [[fault]] or texts",
    "requirement[].id": "of a [sentence](requirements.md) that judges the run; changes an inherited one of this id",
    "requirement[].says": "the sentence; requirements change nothing of the run",
    "requirement[].title": "what it demands, for readers",
    "requirement[].note": "for readers",
    "requirement[].source": "where it comes from, or chosen",
    "requirement[].when.faults": "none: only runs without faults have to keep it",
    "define": "names that the sentences of the scenario may use, with their texts",
    "hunt.faults_max": "most faults of a case of [railhil hunt](../howto/hunt.md); the keys of hunt change no run",
    "hunt.longest_s": "longest fault of a case (default: as random faults, also to the end of the run)",
    "hunt.left_out": "levels, places and words of which a hunt makes no faults, such as bus, TRN_SPEED, speed stuck",
    "hunt.largest": "largest values of a hunt's faults: faults without their beginning, such as speed offset 5km/h",
    "published[].controller": "law of a published row, by its name in railhil",
}
#: Ending of a key and its unit, longer endings first.
_UNITS = {
    "n_per_kn_kmh2": "N/kN/(km/h)²",
    "n_per_kn_kmh": "N/kN/(km/h)",
    "kmh_kn": "km/h, kN",
    "s_mps2": "s, m/s²",
    "mps3": "m/s³",
    "mps2": "m/s²",
    "mps": "m/s",
    "kmh": "km/h",
    "permil": "‰",
    "percent": "%",
    "kg": "kg",
    "kw": "kW",
    "kj": "kJ",
    "kn": "kN",
    "ms": "ms",
    "km": "km",
    "mm": "mm",
    "n": "N",
    "t": "t",
    "m": "m",
    "s": "s",
}


Schema = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Key:
    """One row of the page; ``initial`` is the default as a value, None if there is none."""

    name: str
    unit: str
    default: str
    allowed: str
    meaning: str
    initial: object = None


def keys(
    file_type: type[BaseModel], meaning: Mapping[str, str] | None = None, unitless: Collection[str] = ()
) -> list[Key]:
    """All keys in the order of the schema, each once.

    :param file_type: schema of a system's files; the meaning of its own keys is their ``Field(description=...)``.
    :param meaning: of its keys without a description.
    :param unitless: keys whose last letters are those of a unit, but without one.
    """
    schema, meanings = file_type.model_json_schema(), _MEANING | dict(meaning or {})
    found: dict[str, Key] = {}
    for key in _table(schema, schema, ""):
        unit = "-" if key.name in unitless else key.unit
        found.setdefault(key.name, replace(key, unit=unit, meaning=key.meaning or meanings.get(key.name, "")))
    return list(found.values())


def file_type() -> type[BaseModel]:
    """The schema of the files of the default system."""
    return system_named(DEFAULT).scenario_kind.file_type


def page() -> str:
    """The whole page."""
    return _HEAD + tables(DEFAULT)


def tables(system: str) -> str:
    """The keys of the files of a system, by the tables in which they stand."""
    sections: dict[str, list[Key]] = {}
    for key in system_named(system).scenario_kind.list_keys():
        section = key.name.partition(".")[0] if "." in key.name else ""
        sections.setdefault(section, []).append(key)
    text = ""
    for section, rows in sections.items():
        title = section.removesuffix("[]")
        text += f"\n## [{title}]\n\n" if title else "\n## The scenario\n\n"
        text += "| key | unit | default | allowed | what |\n|---|---|---|---|---|\n"
        for row in rows:
            text += f"| `{row.name}` | {row.unit} | {row.default} | {row.allowed} | {row.meaning} |\n"
    return text


def _table(root: Schema, table: Schema, above: str) -> Iterator[Key]:
    required = table.get("required", ())
    for name, node in table["properties"].items():
        key = f"{above}{name}"
        below = list(_tables(root, node))
        if below:
            rows = "[]" if "$ref" in node.get("items", {}) else ""
            for kind, inner in enumerate(below):
                # A key that only another variant of the table has is not required.
                yield from _table(root, {**inner, "required": ()} if kind else inner, f"{key}{rows}.")
            continue
        default = "required" if name in required else _format_default(node.get("default"))
        allowed, meaning = _describe_allowed(node), node.get("description", "")
        yield Key(key, _unit(key), default, allowed, meaning, node.get("default"))


def _tables(root: Schema, node: Schema) -> Iterator[Schema]:
    """The tables that a key may hold; none for a value."""
    choices = [node, *node.get("anyOf", ()), *node.get("oneOf", ()), node.get("items", {})]
    for choice in choices:
        if "$ref" in choice:
            yield root["$defs"][choice["$ref"].rsplit("/", 1)[1]]


def _unit(key: str) -> str:
    """Unit at the end of a key, or both units as in ``force_n_per_mps``; ``-`` for none."""
    ending = _find_ending(key)
    if not ending:
        return "-"
    unit, stem = _UNITS[ending], key.removesuffix(f"_{ending}")
    if not stem.endswith("_per"):
        return unit
    over = _find_ending(stem.removesuffix("_per"))
    return f"{_UNITS[over] if over else 1}/{f'({unit})' if '/' in unit else unit}"


def _find_ending(key: str) -> str:
    return next((ending for ending in _UNITS if key.endswith(f"_{ending}")), "")


def _format_default(value: object) -> str:
    if value is None:
        return "-"
    return "empty" if value in ([], {}) else f"{value:g}" if isinstance(value, float) else f"{value}"


def _describe_allowed(node: Schema) -> str:
    several = [choice for name in ("anyOf", "oneOf") for choice in node.get(name, ())]
    if several:
        return " or ".join(_describe_allowed(choice) for choice in several if choice.get("type") != "null")
    return _describe_choice(node)


def _describe_choice(node: Schema) -> str:
    if "const" in node:
        return f"{node['const']}"
    kind = node.get("type")
    if kind == "object":
        # Names with a form stand under it.
        values = {"": node.get("additionalProperties"), **node.get("patternProperties", {})}
        return f"table of {_describe_allowed([*values.values()][-1])}"
    if kind == "array" and "prefixItems" in node:
        return f"[{', '.join('number' for _ in node['prefixItems'])}]"
    if kind == "array":
        return f"array of {_describe_choice(node['items'])}"
    if node.get("minimum") == SMALLEST:
        node = {**node, "exclusiveMinimum": 0}
        del node["minimum"]
    bounds = [
        f"{word} {node[name]:g}".replace("e+0", "e")
        for name, word in (
            ("minimum", "from"),
            ("exclusiveMinimum", "above"),
            ("maximum", "to"),
            ("exclusiveMaximum", "below"),
        )
        if name in node
    ]
    length = [f"at most {node['maxLength']} letters"] if "maxLength" in node else []
    return " ".join([_NUMBERS.get(str(kind), "value"), *bounds, *length])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    sys.stdout.write(f"{PAGE}\n")
