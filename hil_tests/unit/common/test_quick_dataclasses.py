"""Dataclasses that are made faster do what Python's own do."""

from __future__ import annotations

import dataclasses
import pickle
from typing import Any

import pytest

from railhil.common.quick_dataclasses import _METHODS, quick_dataclasses

FLAGS = [
    {},
    {"frozen": True},
    {"frozen": True, "slots": True},
    {"slots": True, "eq": False},
    {"unsafe_hash": True},
    {"frozen": True, "order": True},
]


def made(flags: dict[str, bool], count: int) -> Any:
    annotations: dict[str, Any] = {f"f{k}": Any for k in range(count)}
    shown = dataclasses.field(repr=False, hash=False, default=7)
    members = {"__annotations__": {**annotations, "other": int}, "other": shown, "__module__": __name__}
    return dataclasses.dataclass(**flags)(type("Made", (), members))  # type: ignore[call-overload]


def outcome(call: Any) -> str:
    try:
        return repr(call())
    except Exception as error:
        return f"{type(error).__name__}: {error}"


@pytest.mark.parametrize("flags", FLAGS, ids=str)
@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_each_method_does_the_same(flags: dict[str, bool], count: int) -> None:
    found = []
    for quick in (False, True):
        if quick:
            with quick_dataclasses():
                kind = made(flags, count)
        else:
            kind = made(flags, count)
        derived = type("Derived", (kind,), {"__module__": __name__})
        for cls in (kind, derived):
            one, same, other = (cls(*values) for values in (range(count), range(count), range(1, count + 1)))
            found.append(
                [
                    outcome(lambda one=one: one),
                    outcome(lambda one=one, same=same: one == same),
                    outcome(lambda one=one, other=other: one == other),
                    # An object that has its hash from its place has another one each time.
                    outcome(lambda cls=cls: cls.__hash__ is object.__hash__),
                    "" if cls.__hash__ is object.__hash__ else outcome(lambda one=one: hash(one)),
                    outcome(lambda one=one: setattr(one, "other", 3)),
                    outcome(lambda one=one: setattr(one, "unknown", 3)),
                    outcome(lambda one=one: delattr(one, "other")),
                    outcome(lambda one=one: delattr(one, "unknown")),
                    [getattr(cls, name).__qualname__ for name in ("__repr__", "__setattr__", "__delattr__")],
                ]
            )
    assert found[:2] == found[2:]


def test_an_object_within_itself_is_shown_as_dots() -> None:
    with quick_dataclasses():
        one = made({}, 1)([])
    one.f0.append(one)
    assert repr(one) == "Made(f0=[...])"


with quick_dataclasses():

    @dataclasses.dataclass(frozen=True, slots=True)
    class Kept:
        """For pickle."""

        a: int
        b: str = "b"


def test_an_object_can_be_pickled_replaced_and_kept_in_a_set() -> None:
    one = Kept(1)
    assert pickle.loads(pickle.dumps(one)) == one
    assert dataclasses.replace(one, a=2) == Kept(2)
    assert {one, Kept(1), Kept(2)} == {Kept(1), Kept(2)}


def test_afterwards_python_makes_them_itself() -> None:
    before = {name: vars(dataclasses).get(name) for name in _METHODS}
    with pytest.raises(ZeroDivisionError), quick_dataclasses():
        raise ZeroDivisionError
    assert {name: vars(dataclasses).get(name) for name in _METHODS} == before
