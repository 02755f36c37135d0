"""The sweeps of the safety gate must detect each mutant of it."""

from __future__ import annotations

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
@pytest.mark.parametrize("module", ALL_SWEEPS, ids=lambda module: module.__name__)
def test_every_mutant_is_noticed(module: ModuleType) -> None:
    count, alive = survivors(module, ALL_SWEEPS[module])
    # Compared in both directions: a stale entry of survivors.toml would hide a mutant that is now detected.
    assert {mutant.key for mutant in alive} == set(explained(module.__name__))
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
