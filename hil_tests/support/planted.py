"""Planted defects in this process: functions of a module get the code that they have in a changed source."""

from __future__ import annotations

import inspect
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from types import CodeType, FunctionType
from typing import Any

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.common.held_code import place_of
from railhil.hunt.defects import Defect


@cache
def planted_rows(name: str = "planted") -> dict[str, tuple[Defect, tuple[str, ...], str]]:
    """By id: a defect, the faults of a run that shows it, and the id of the sentence that this run violates.

    :param name: of the file.
    """
    tables = tomllib.loads((TEST_DATA / f"{name}.toml").read_text("utf-8"))["defect"]
    return {row["id"]: (Defect(**row), tuple(faults), by) for faults, by, row in map(_parts, tables)}


def _parts(row: dict[str, Any]) -> tuple[list[str], str, dict[str, Any]]:
    """The faults of a row, its sentence, and the defect."""
    return row["faults"], row["by"], {key: text for key, text in row.items() if key not in ("faults", "by")}


def plant_here(defect: Defect, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the functions of the defect's module its code, until the test ends."""
    module = import_module(f"railhil.{defect.file.removesuffix('.py').replace('/', '.')}")
    codes = dict(_codes(compile(defect.planted, str(place_of(defect.file)), "exec", dont_inherit=True)))
    for function in _functions(module):
        if function.__module__ == module.__name__:
            monkeypatch.setattr(function, "__code__", codes[function.__qualname__])


def _codes(code: CodeType) -> Iterator[tuple[str, CodeType]]:
    """The codes in a code, by their qualified names."""
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield one.co_qualname, one
            yield from _codes(one)


def _functions(holder: Any) -> Iterator[FunctionType]:
    """Functions, methods and properties of a module or class that were written there."""
    for one in list(vars(holder).values()):
        if inspect.isclass(one):
            if inspect.ismodule(holder) and one.__module__ == holder.__name__:
                yield from _functions(one)
            continue
        found = inspect.unwrap(getattr(one, "fget", None) or getattr(one, "__func__", one))
        # A dataclass has methods that no file has.
        if isinstance(found, FunctionType) and not found.__code__.co_filename.startswith("<"):
            yield found
