"""The sweeps of the safety gate must detect each mutant of it."""

from __future__ import annotations

import inspect
from types import ModuleType

import pytest

from hil_tests.mutation.in_memory import survivors
from hil_tests.mutation.operators import mutants
from hil_tests.mutation.targets import explained
from hil_tests.support.gate_sweeps import SWEEPS
from hil_tests.support.store_sweeps import STORE_SWEEPS
from railhil.bus import lifesign, store
from railhil.controller_node.ato import guard

ALL_SWEEPS = {**STORE_SWEEPS, **SWEEPS}


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    "module",
    [pytest.param(module, marks=[pytest.mark.long] if module in (guard, store) else []) for module in ALL_SWEEPS],
    ids=lambda module: module.__name__,
)
def test_every_mutant_is_noticed(module: ModuleType) -> None:
    known = set(explained(module.__name__))
    count, alive = survivors(module, ALL_SWEEPS[module], known)
    # Compared in both directions: a stale entry of survivors.toml would hide a mutant that is now detected.
    assert {mutant.key for mutant in alive} == known
    assert count >= 20


def test_the_mutator_itself() -> None:
    source = '"""Doc."""\n\ndef f(a: int = 1) -> bool:\n    """Doc."""\n    b = not a\n    return a < 2 and b or True\n'
    assert sorted(mutant.key for mutant in mutants(source)) == sorted(
        [
            "def f(a: int=2) -> bool:",
            "def f(a: int=0) -> bool:",
            "f: without b = not a",
            "f: b = a",
            "f: return a <= 2 and b or True",
            "f: return a >= 2 and b or True",
            "f: return a < 3 and b or True",
            "f: return a < 1 and b or True",
            "f: return (a < 2 or b) or True",
            "f: return (a < 2 and b) and True",
            "f: return a < 2 and b or False",
            "f: return True",
            "f: return False",
        ]
    )


def test_the_key_of_a_mutant_lasts_when_the_file_is_laid_out_anew() -> None:
    one = "def f(a):\n    return g(a, 1)\n\ndef h(a):\n    if a:\n        return 2\n    return 1 + 1\n"
    other = "def f(a):  # F\n    return g(\n        a,\n        1)\ndef h(a):\n    if a: return 2\n    return (1 + 1)\n"
    keys = [mutant.key for mutant in mutants(one)]
    assert keys == [mutant.key for mutant in mutants(other)]
    assert len(set(keys)) == len(keys)


def test_a_check_that_sees_nothing_leaves_mutants_alive() -> None:
    count, alive = survivors(lifesign, [lambda module: None])
    # Those that do not even load (the enum's own machinery) are the only ones noticed.
    assert len(alive) >= count - 3


def test_the_time_limit_of_the_test_is_no_notice_of_a_mutant() -> None:
    def check(module: ModuleType) -> None:
        pytest.fail("Timeout (>120.0s) from pytest-timeout.")

    with pytest.raises(pytest.fail.Exception, match="Timeout"):
        survivors(lifesign, [check])


def test_what_notices_an_explained_mutant_is_shown() -> None:
    mutant = next(iter(mutants(inspect.getsource(lifesign))))

    def check(module: ModuleType) -> None:
        raise KeyError("the reason")

    with pytest.raises(AssertionError, match="noticed, though it is explained") as raised:
        survivors(lifesign, [check], {mutant.key})
    assert isinstance(raised.value.__cause__, KeyError)
