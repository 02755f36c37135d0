"""A law's memory from run to run: passed to its constructor, read from it after the run."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.controller_node.laws.fault import place
from railhil.scenarios.memory import Memory


@dataclass(frozen=True, slots=True)
class Remembered:
    """What a law with a memory is constructed with.

    ``values``: what :meth:`memory` of the law returned at the end of its last run; None: nothing that can be used.
    ``source``: where they come from, 0 nothing or the default of the line, 1 slot A, 2 slot B. ``fault``: why a slot
    could not be used, that of slot A in bits 0 to 3, of slot B in bits 4 to 7; 0: none. A law that reports the two
    sends them as they are.
    """

    values: Mapping[str, Any] | None = None
    source: int = 0
    fault: int = 0


#: Before the first run.
NOTHING = Remembered()


def memory_key(kind: type[Any], scenario: Any) -> str:
    """Key of the law's memory; empty: it keeps none.

    :raises TypeError: the law's key is not a string.
    """
    key = kind.memory_key(scenario)
    if not isinstance(key, str):
        raise TypeError(f"memory_key answers {key!r}, allowed a text")
    return key


def memory_arguments(name: str, kind: type[Any], scenario: Any, given: Memory | None) -> tuple[Any, ...]:
    """Arguments of a law's constructor after the parameters: none if it keeps no memory, else a :class:`Remembered`.

    :param name: by which the law was requested.
    :raises InputError: the memory belongs to another law or another key, or the law refuses its values.
    """
    key = memory_key(kind, scenario)
    if given is None:
        return (NOTHING,) if key else ()
    if given.law != name:
        raise InputError(given.source, "law", given.law, f"{name}, the controller asked for")
    if not key:
        raise InputError(given.source, "law", name, "a law that keeps a memory from run to run")
    if given.runs and given.key != key:
        raise InputError(given.source, "key", given.key, f"{key}, what {name} keeps on this scenario")
    if not given.runs:
        return (NOTHING,)
    if problem := refused_values(kind, scenario, given.values):
        raise InputError(given.source, "values", Words(problem), f"values that {name} can begin with")
    return (Remembered(given.values),)


def refused_values(kind: type[Any], scenario: Any, values: Mapping[str, Any]) -> str:
    """Why the law cannot begin with these values; empty if it can."""
    try:
        kind.check_memory(scenario, values)
    except Exception as error:
        # Damaged values may make plug-in code raise anything.
        return f"{type(error).__name__}: {error}"
    return ""


def kept(name: str, law: Any, scenario: Any, state: Any) -> dict[str, Any] | None:
    """Key and values of the memory that a law keeps after a run; None if it has no memory or has taken no step.

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
        # In the form in which it will be read: tuples become lists, and numbers that JSON lacks are refused here.
        return {"key": key, "values": json.loads(json.dumps(values, allow_nan=False))}
    except Exception as error:
        # Plug-in code may raise anything.
        cause = f"{type(error).__name__}: {error}"
        at = place(kind, error) or kind.__qualname__
        found = Words("values that cannot be kept")
        raise InputError(at, f"law {name}, memory", found, "a dict that JSON can hold", cause) from error
