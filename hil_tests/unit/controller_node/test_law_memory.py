"""What a law with a memory is constructed with, and which stored values it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.remembering import Learning
from railhil.common.errors import InputError
from railhil.controller_node.laws.ipfc import Ipfc
from railhil.controller_node.laws.memory import NOTHING, Remembered, memory_arguments
from railhil.scenarios.load import load
from railhil.scenarios.memory import Memory, no_memory

_SCENARIO = load("lvshun_tieshan")


def kept(**values: float) -> Memory:
    return Memory("learning", Learning.memory_key(_SCENARIO), 3, values, Path("memory.json"))


def test_a_law_with_a_key_is_told_what_it_kept() -> None:
    assert memory_arguments("ipfc", Ipfc, _SCENARIO, None) == ()
    for given in (None, no_memory("learning", Path("memory.json"))):
        assert memory_arguments("learning", Learning, _SCENARIO, given) == (NOTHING,)
    found = memory_arguments("learning", Learning, _SCENARIO, kept(runs=3, offset=0.5))
    assert found == (Remembered({"runs": 3, "offset": 0.5}),)


@pytest.mark.parametrize(("values", "why"), [({"offset": 99.0}, "ValueError: offset 99.0"), ({}, "KeyError: 'offset'")])
def test_values_that_the_law_refuses_are_one_line(values: dict[str, float], why: str) -> None:
    with pytest.raises(
        InputError, match=rf"memory\.json: values: found {why}.*allowed values that learning"
    ) as refused:
        memory_arguments("learning", Learning, _SCENARIO, kept(**values))
    assert len(str(refused.value).splitlines()) == 1
