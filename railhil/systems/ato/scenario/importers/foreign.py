"""Tables of other tools' files, and the keys in them that are not read."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

from pydantic import AliasChoices, BaseModel, ConfigDict
from pydantic.fields import FieldInfo

from railhil.common.errors import InputError, Words
from railhil.scenarios.validation import Keys, join_keys

#: Similarity (0 to 1) from which an unknown key is taken for a mistyped one.
_MISTYPED = 0.8


class Foreign(BaseModel):
    """A table of another tool's file. Keys that are not read are kept for :func:`find_unknown`."""

    model_config = ConfigDict(defer_build=True, extra="allow", strict=True, frozen=True, allow_inf_nan=False)
    #: Keys of the format that only name or describe.
    DESCRIBING: ClassVar[tuple[str, ...]] = ()


def find_unknown(file: str | Path, table: Foreign, above: Keys = ()) -> list[str]:
    """Keys of a table and of the tables in it that are not read and may mean something, each once, without indices.

    :param above: place of the table, for messages.
    :raises InputError: a key is nearly one that is read, so that its value was meant for that one.
    """
    found: dict[str, None] = {}
    for keys, inner in _tables(table):
        known = _known(inner)
        for key in inner.model_extra or {}:
            if key in known or key in inner.DESCRIBING:
                continue
            near = difflib.get_close_matches(str(key).lower(), known, 1, _MISTYPED)
            if near:
                allowed = f"one of {', '.join(known)}"
                hint = f"did you mean {near[0]}?"
                raise InputError(file, join_keys((*above, *keys, str(key))), Words("unknown key"), allowed, hint)
            found[join_keys((*(word for word in keys if isinstance(word, str)), str(key)))] = None
    return list(found)


def _tables(table: Foreign) -> Iterator[tuple[Keys, Foreign]]:
    """A table and those in it, with their places."""
    yield (), table
    for name in type(table).model_fields:
        value = getattr(table, name)
        items = enumerate(value) if isinstance(value, list) else [(None, value)]
        for place, item in items:
            if isinstance(item, Foreign):
                at: Keys = (_spell(name, type(table).model_fields[name])[0],)
                at += () if place is None else (place,)
                yield from ((at + keys, inner) for keys, inner in _tables(item))


def _known(table: Foreign) -> list[str]:
    """The keys that are read, as the file spells them."""
    return [word for name, field in type(table).model_fields.items() for word in _spell(name, field)]


def _spell(name: str, field: FieldInfo) -> list[str]:
    alias = field.validation_alias or name
    return [str(choice) for choice in alias.choices] if isinstance(alias, AliasChoices) else [str(alias)]
