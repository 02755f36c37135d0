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
from railhil.bus import lifesign

ALL_SWEEPS = {**STORE_SWEEPS, **SWEEPS}


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("module", ALL_SWEEPS, ids=lambda module: module.__name__)
def test_every_mutant_is_noticed(module: ModuleType) -> None:
    known = set(explained(module.__name__))
    count, alive = survivors(module, ALL_SWEEPS[module], known)
    # Compared in both directions: a stale entry of survivors.toml would hide a mutant that is now detected.
    assert {mutant.key for mutant in alive} == known
    assert count >= 20


def test_the_mutator_itself() -> None:
    source = '"""Doc."""\n\ndef f(a: int = 1) -> bool:\n    """Doc."""\n    b = not a\n    return a < 2 and b or True\n'
    texts = [mutant.text for mutant in mutants(source)]
    assert sorted(texts) == sorted(
        [
            "1 -> 2",
            "1 -> 0",
            "b = not a -> pass",
            "not a -> a",
            "a < 2 -> a <= 2",
            "a < 2 -> a >= 2",
            "2 -> 3",
            "2 -> 1",
            "a < 2 and b -> a < 2 or b",
            "a < 2 and b or True -> (a < 2 and b) and True",
            "True -> False",
            "return a < 2 and b or True -> return True",
            "return a < 2 and b or True -> return False",
        ]
    )


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
