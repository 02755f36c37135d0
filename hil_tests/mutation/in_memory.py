"""Mutants against checks that take the module as their argument: dense sweeps of a small module."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from types import ModuleType

import pytest

from hil_tests.mutation.operators import Mutant, mutants


def load(mutant: Mutant, original: ModuleType) -> ModuleType:
    """Execute a mutant as a separate module; other modules still import the original."""
    module = ModuleType(original.__name__)
    module.__file__ = original.__file__
    exec(compile(mutant.tree(), f"mutant of {original.__name__}", "exec"), module.__dict__)  # noqa: S102
    return module


def survivors(original: ModuleType, checks: Sequence[Callable[[ModuleType], None]]) -> tuple[int, list[Mutant]]:
    """Number of mutants of a module, and those that no check detects."""
    alive = []
    count = 0
    for mutant in mutants(inspect.getsource(original)):
        count += 1
        try:
            module = load(mutant, original)
            for check in checks:
                check(module)
        except (Exception, pytest.fail.Exception):
            # Detected: by a failed check, or because the module does not even load.
            continue
        alive.append(mutant)
    return count, alive
