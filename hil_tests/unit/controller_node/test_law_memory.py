"""What a law with a memory begins with: the record it is given, the slot, and the faults of the others."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.remembering import Learning
from railhil.common.errors import InputError
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.laws.memory import NOTHING, Remembered, choice, memory_arguments
from railhil.scenarios.load import load
from railhil.scenarios.memory import Memory, MemoryPlace, MemoryRecord, no_memory

_SCENARIO = load("lvshun_tieshan")
_KEY = Learning.memory_key(_SCENARIO)


def record(offset: float, key: str = _KEY) -> MemoryRecord:
    return MemoryRecord("learning", key, 3, 3, {"runs": 3, "offset": offset})


def memory(*stored: MemoryPlace) -> Memory:
    return Memory("learning", stored, Path("store"))


def begun(*stored: MemoryPlace) -> Remembered:
    (found,) = memory_arguments("learning", Learning, _SCENARIO, memory(*stored))
    assert isinstance(found, Remembered)
    return found


def test_a_law_with_a_key_is_told_what_it_kept() -> None:
    assert memory_arguments("ipfc", Ipfc, _SCENARIO, None) == ()
    for given in (None, no_memory("learning", Path("store"))):
        assert memory_arguments("learning", Learning, _SCENARIO, given) == (NOTHING,)
    values = {"runs": 3, "offset": 0.5}
    assert begun(MemoryPlace("A", record(0.5)), MemoryPlace("B", record(0.1))) == Remembered(values, 1, 0)
    assert begun(MemoryPlace("B", record(0.5)), MemoryPlace("A", record(0.1))) == Remembered(values, 2, 0)
    assert begun(MemoryPlace("file", record(0.5))) == Remembered(values, 0, 0)


#: The newest record, and what is wrong with it: fault number on the bus.
_BAD = [
    (MemoryPlace("A", None, "crc", "found other"), 4),
    (MemoryPlace("A", None, "json", "torn"), 2),
    (MemoryPlace("A", record(0.5, "another platform")), 7),
    (MemoryPlace("A", record(99.0)), 8),
    (MemoryPlace("A", MemoryRecord("learning", _KEY, 3, 3, {"runs": 3})), 8),
    (MemoryPlace("A", MemoryRecord("learning", _KEY, 3, 3, {"runs": 3, "offset": "sixty"})), 8),
]


@pytest.mark.parametrize(("bad", "fault"), _BAD)
def test_each_fault_falls_back_to_the_other_slot_then_the_default_then_nothing(bad: MemoryPlace, fault: int) -> None:
    good = {"runs": 3, "offset": 0.1}
    assert begun(bad, MemoryPlace("B", record(0.1))) == Remembered(good, 2, fault)
    assert begun(bad, MemoryPlace("default", record(0.1))) == Remembered(good, 0, fault)
    assert begun(bad, MemoryPlace("default", record(0.1, "any platform"))) == Remembered(good, 0, fault)
    assert begun(bad) == Remembered(None, 0, fault)
    assert begun(bad, MemoryPlace("B", None, "version", "")) == Remembered(None, 0, fault), "of two slots that of A"
    assert begun(bad, MemoryPlace("default", None, "json", "")) == Remembered(None, 0, fault)


def test_what_is_wrong_is_said() -> None:
    found = choice(
        "learning", Learning, _SCENARIO, memory(MemoryPlace("A", record(99.0)), MemoryPlace("B", record(0.1)))
    )
    assert found.used == "B"
    (refused,) = found.refused
    assert (refused["slot"], refused["fault"]) == ("A", "values")
    assert refused["detail"].startswith("ValueError: offset 99.0, allowed +-")
    # A slot that was not needed is looked at all the same.
    found = choice(
        "learning", Learning, _SCENARIO, memory(MemoryPlace("A", record(0.1)), MemoryPlace("B", record(0.1, "x")))
    )
    assert (found.used, found.remembered.fault) == ("A", 7)


@pytest.mark.parametrize(
    ("given", "line"),
    [
        (record(99.0), r"store: values: ValueError: offset 99\.0.*expected values that learning can begin with"),
        (record(0.1, "x"), "store: key: found 'x', allowed .*, what learning keeps on this scenario"),
    ],
)
def test_a_named_file_is_used_or_refused(given: MemoryRecord, line: str) -> None:
    with pytest.raises(InputError, match=line) as refused:
        begun(MemoryPlace("file", given))
    assert len(str(refused.value).splitlines()) == 1


def test_a_memory_of_another_law_is_refused() -> None:
    with pytest.raises(InputError, match="store: law: found 'other', allowed learning, the controller asked for"):
        memory_arguments("learning", Learning, _SCENARIO, no_memory("other", Path("store")))
    with pytest.raises(InputError, match="store: law: found 'ipfc', allowed a law that keeps a memory"):
        memory_arguments("ipfc", Ipfc, _SCENARIO, no_memory("ipfc", Path("store")))
