"""The memory of learning laws on a line: one entry for each section.

::

    {"key": KEY, "values": {"sections": {"1": {"key": ..., "values": ...}, ...}}, "used": SLOT, "refused": [...]}

``KEY`` names the line; the entry of a section holds the key and the values that its law has left.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from railhil.scenarios.memory import Memory, MemoryPlace
from railhil.systems.line.scenario.model import LineScenario

_SECTIONS = "sections"


def section_memory(memory: Memory, index: int) -> Memory:
    """The memory of one section, from that of the line.

    :param index: number of the section, from 0.
    """
    return replace(memory, stored=tuple(_section_place(one, str(index + 1)) for one in memory.stored))


def _section_place(place: MemoryPlace, number: str) -> MemoryPlace:
    if place.record is None:
        return place
    entries = place.record.values.get(_SECTIONS)
    entry = entries.get(number) if isinstance(entries, dict) else None
    if not isinstance(entry, dict) or not isinstance(entry.get("values"), dict):
        return place.refuse("values", f"values: found no section {number}, allowed an entry for each section")
    return replace(place, record=replace(place.record, key=str(entry.get("key", "")), values=entry["values"]))


def join_memories(line: LineScenario, kept: Mapping[int, dict[str, Any] | None]) -> dict[str, Any] | None:
    """The memory of a line from what the laws of its sections keep, by number from 0; None: they keep none."""
    found = {str(index + 1): one for index, one in sorted(kept.items()) if one is not None}
    if not found:
        return None
    entries = {number: {"key": one["key"], "values": one["values"]} for number, one in found.items()}
    first = next(iter(found.values()))
    return {
        "key": f"line {line.name}",
        "values": {_SECTIONS: entries},
        "used": first["used"],
        "refused": first["refused"],
    }
