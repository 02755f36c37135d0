"""A law's memory from run to run: handed to it when it is made, asked of it when the run is over."""

from __future__ import annotations

import json
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.controller_node.laws.fault import place
from railhil.scenarios.memory import Memory


def memory_key(kind: type[Any], scenario: Any) -> str:
    """Under what the law keeps its memory; empty: it keeps none.

    :raises TypeError: the law says something that is no text.
    """
    key = kind.memory_key(scenario)
    if not isinstance(key, str):
        raise TypeError(f"memory_key answers {key!r}, allowed a text")
    return key


def memory_arguments(name: str, kind: type[Any], scenario: Any, given: Memory | None) -> tuple[Any, ...]:
    """What a law is made with behind its parameters: nothing when it keeps no memory; else the values, None before its
    first run.

    :param name: under which the law was asked for.
    :raises InputError: the memory is another law's, or of another key.
    """
    key = memory_key(kind, scenario)
    if given is None:
        return (None,) if key else ()
    if given.law != name:
        raise InputError(given.source, "law", given.law, f"{name}, the controller asked for")
    if not key:
        raise InputError(given.source, "law", name, "a law that keeps a memory from run to run")
    if given.runs and given.key != key:
        raise InputError(given.source, "key", given.key, f"{key}, what {name} keeps on this scenario")
    return (given.values if given.runs else None,)


def kept(name: str, law: Any, scenario: Any, state: Any) -> dict[str, Any] | None:
    """Key and values that a law wants kept; None for one without memory, or that has taken no step.

    :param name: under which the law was asked for.
    :raises InputError: the law has raised, or answers what no file can hold.
    """
    kind = type(law)
    try:
        key = memory_key(kind, scenario)
        if not key or state is None:
            return None
        values = law.memory(state)
        if not isinstance(values, dict):
            raise TypeError(f"found {values!r}")
        # As it will be read again: tuples are lists, and what is no number of JSON is refused here.
        return {"key": key, "values": json.loads(json.dumps(values, allow_nan=False))}
    except Exception as error:
        # Code that somebody plugs in may raise anything.
        cause = f"{type(error).__name__}: {error}"
        at = place(kind, error) or kind.__qualname__
        found = Words("what cannot be kept")
        raise InputError(at, f"law {name}, memory", found, "a dict that JSON can hold", cause) from error
