"""A law's memory from run to run: passed to its constructor, read from it after the run."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.controller_node.laws.failure import find_source_line
from railhil.scenarios.memory import FAULTS, LINE_DEFAULT, NAMED_FILE, SLOT_A, SLOT_B, Memory, MemoryPlace


@dataclass(frozen=True, slots=True)
class Remembered:
    """What a law with a memory is constructed with.

    ``values``: what :meth:`memory` of the law returned at the end of its last run; None: nothing that can be used.
    ``source``: where they come from, 0 nothing or the default of the line, 1 slot A, 2 slot B. ``fault``: why a slot
    could not be used, a number of :data:`railhil.scenarios.memory.FAULTS` (four bits), of two slots that of A; 0: none.
    A law that reports the two sends them as they are.
    """

    values: Mapping[str, Any] | None = None
    source: int = 0
    fault: int = 0


#: Before the first run.
NOTHING = Remembered()
#: Slot -> its number in ``source``.
_SLOTS = {SLOT_A: 1, SLOT_B: 2}


@dataclass(frozen=True, slots=True)
class Choice:
    """The places of a memory as a law has found them, and the one that it uses (empty: none)."""

    stored: tuple[MemoryPlace, ...]
    used: str = ""

    @property
    def refused(self) -> list[dict[str, str]]:
        """The places that cannot be used."""
        return [
            {"slot": one.slot, "fault": one.fault, "detail": one.detail} for one in self.stored if one.record is None
        ]

    @property
    def remembered(self) -> Remembered:
        """The memory passed to the law."""
        faults = {one.slot: FAULTS[one.fault] for one in self.stored if one.record is None}
        fault = next((faults[slot] for slot in _SLOTS if slot in faults), 0)
        record = next((one.record for one in self.stored if one.slot == self.used), None)
        return Remembered(None if record is None else record.values, _SLOTS.get(self.used, 0), fault)


def memory_key(kind: type[Any], scenario: Any) -> str:
    """Key of the law's memory; empty: it keeps none.

    :raises TypeError: the law's key is not a string.
    """
    key = kind.memory_key(scenario)
    if not isinstance(key, str):
        raise TypeError(f"memory_key answers {key!r}, allowed a text")
    return key


def require_memory(name: str, laws: Mapping[str, type[Any]], scenario: Any) -> None:
    """Refuse a law that keeps no memory.

    :param name: a name in ``laws``, the laws of the scenario's system.
    :raises InputError: it keeps none on this scenario.
    """
    if memory_key(laws[name], scenario):
        return
    others = ", ".join(law for law, kind in laws.items() if memory_key(kind, scenario))
    allowed = f"a law that keeps a memory from run to run: {others or 'none is installed for this system'}"
    raise InputError("command line", "--controller", name, allowed)


def choice(name: str, kind: type[Any], scenario: Any, given: Memory | None) -> Choice:
    """The record that a law with a memory begins with: the first of its key that it does not refuse.

    A record of a store that cannot be used is passed over; a file that was named is used or refused.

    :param name: by which the law was requested.
    :raises InputError: the memory belongs to another law, the law keeps none, or a named file cannot be used.
    """
    key = memory_key(kind, scenario)
    if given is None:
        return Choice(())
    if given.law != name:
        raise InputError(given.source, "law", given.law, f"{name}, the controller asked for")
    if not key:
        raise InputError(given.source, "law", name, "a law that keeps a memory from run to run")
    stored, used = [], ""
    for one in given.stored:
        looked = one if one.record is None else _looked_at(one, key, name, kind, scenario, given.source)
        used = used or (looked.slot if looked.record is not None else "")
        stored.append(looked)
    return Choice(tuple(stored), used)


def _looked_at(one: MemoryPlace, key: str, name: str, kind: type[Any], scenario: Any, source: Path) -> MemoryPlace:
    """The place of a record, with the fault that the law finds in it.

    :raises InputError: the record is a named file and cannot be used.
    """
    assert one.record is not None
    fault, error = "", None
    # A person has put the default of a line there, for this key.
    if one.record.key != key and one.slot != LINE_DEFAULT:
        fault, error = "key", InputError(source, "key", one.record.key, f"{key}, what {name} keeps on this scenario")
    elif problem := _refused_values(kind, scenario, one.record.values):
        fault, error = "values", InputError(source, "values", Words(problem), f"values that {name} can begin with")
    if error is None:
        return one
    if one.slot == NAMED_FILE:
        raise error
    return one.refuse(fault, error.difference)


def _refused_values(kind: type[Any], scenario: Any, values: Mapping[str, Any]) -> str:
    """Reason for which the law cannot begin with these values; empty if it can."""
    try:
        kind.check_memory(scenario, values)
    except Exception as error:
        # Damaged values may make plug-in code raise anything.
        return f"{type(error).__name__}: {error}"
    return ""


def memory_arguments(name: str, kind: type[Any], scenario: Any, given: Memory | None) -> tuple[Any, ...]:
    """Arguments of a law's constructor after the parameters: none if it keeps no memory, else a :class:`Remembered`.

    :param name: by which the law was requested.
    :raises InputError: as :func:`choice`.
    """
    found = choice(name, kind, scenario, given)
    return (found.remembered,) if memory_key(kind, scenario) else ()


def kept(name: str, law: Any, scenario: Any, state: Any, given: Memory | None) -> dict[str, Any] | None:
    """The memory that a law keeps after a run: its key and values, the place of the record that it has used (``used``;
    empty: none), and the places that it could not use (``refused``: slot, fault and detail of each); None if it has no
    memory or has taken no step.

    :param name: by which the law was requested.
    :raises InputError: the law has raised, or its memory cannot be stored in a file.
    """
    kind = type(law)
    try:
        key = memory_key(kind, scenario)
        if not key or state is None:
            return None
        values = law.memory(state)
        if not isinstance(values, dict):
            raise TypeError(f"found {values!r}")
        # Converted to the form in which it will be read: tuples become lists, and numbers that JSON lacks are refused
        # here.
        values = json.loads(json.dumps(values, allow_nan=False))
    except Exception as error:
        # Plug-in code may raise anything.
        cause = f"{type(error).__name__}: {error}"
        at = find_source_line(kind, error) or kind.__qualname__
        found = Words("values that cannot be kept")
        raise InputError(at, f"law {name}, memory", found, "a dict that JSON can hold", cause) from error
    chosen = choice(name, kind, scenario, given)
    return {"key": key, "values": values, "used": chosen.used, "refused": chosen.refused}
