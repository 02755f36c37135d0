"""Dataclasses that are made faster, while a command loads.

Python before 3.13 writes each of their methods as text and compiles it: half a millisecond for a class, and a command
has hundreds. Here three kinds of methods are closures, which do the same: tests compare both.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from operator import attrgetter
from typing import Any

Fields = Sequence["dataclasses.Field[Any]"]


@contextmanager
def quick_dataclasses() -> Iterator[None]:
    """Inside ``with``, ``__repr__``, ``__hash__`` and what keeps a frozen object as it is are not compiled."""
    known: Mapping[str, Callable[..., Any]] = vars(dataclasses)
    # Later versions compile all methods of a class together, and call other functions for it.
    names = _METHODS if sys.version_info < (3, 13) else {}
    before = {name: known[name] for name in names if name in known}
    for name in before:
        setattr(dataclasses, name, names[name])
    try:
        yield
    finally:
        for name, original in before.items():
            setattr(dataclasses, name, original)


def _representation(fields: Fields, _: object) -> Callable[[Any], str]:
    names = [field.name for field in fields]

    def __repr__(self: Any) -> str:
        values = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
        return f"{self.__class__.__qualname__}({values})"

    guarded: Callable[[Any], str] = vars(dataclasses)["_recursive_repr"](__repr__)
    return guarded


def _hash(fields: Fields, _: object) -> Callable[[Any], int]:
    names = [field.name for field in fields]
    # Of one name it gives the value, not a tuple.
    values: Callable[[Any], tuple[Any, ...]] | None = attrgetter(*names) if len(names) > 1 else None

    def __hash__(self: Any) -> int:
        return hash(tuple(getattr(self, name) for name in names) if values is None else values(self))

    return __hash__


def _frozen(cls: Any, fields: Fields, _: object) -> tuple[Callable[..., None], Callable[..., None]]:
    names = frozenset(field.name for field in fields)

    def __setattr__(self: Any, name: str, value: Any) -> None:
        if type(self) is cls or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        super(cls, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is cls or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        super(cls, self).__delattr__(name)

    return __setattr__, __delattr__


#: Function of :mod:`dataclasses` that makes methods -> what makes them here.
_METHODS: Mapping[str, Callable[..., Any]] = {
    "_repr_fn": _representation,
    "_hash_fn": _hash,
    "_frozen_get_del_attr": _frozen,
}
