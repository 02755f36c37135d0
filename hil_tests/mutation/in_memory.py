"""Mutants against checks that take the module as their argument: dense sweeps of a small module."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Sequence
from types import ModuleType

from hil_tests.mutation.operators import Mutant, mutants


def load(mutant: Mutant, original: ModuleType) -> ModuleType:
    """Execute a mutant as a separate module; other modules still import the original."""
    module = ModuleType(original.__name__)
    module.__file__ = original.__file__
    exec(compile(mutant.tree(), f"mutant of {original.__name__}", "exec"), module.__dict__)  # noqa: S102
    return module


def survivors(
    original: ModuleType, checks: Sequence[Callable[[ModuleType], None]], unseen: Collection[str] = ()
) -> tuple[int, list[Mutant]]:
    """Number of mutants of a module, and those that no check detects.

    A failed check raises an ``Exception``. ``pytest.fail`` is none, and ends the whole test: the time limit of pytest
    calls it, in whatever check is running, and that says nothing about the mutant.

    :param unseen: keys of the mutants that no check can detect.
    :raises AssertionError: a check detects one of these; its failure is the cause.
    """
    alive = []
    count = 0
    for mutant in mutants(inspect.getsource(original)):
        count += 1
        try:
            module = load(mutant, original)
            for check in checks:
                check(module)
        except Exception as error:
            # Detected: by a failed check, or because the module does not even load.
            if mutant.key in unseen:
                raise AssertionError(f"line {mutant.line}: {mutant.key}: noticed, though it is explained") from error
            continue
        alive.append(mutant)
    return count, alive
