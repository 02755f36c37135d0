"""What a law with a memory begins with: the record it is given, the slot, and the faults of the others."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.remembering import Learning
from railhil.common.errors import InputError
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.laws.memory import NOTHING, Remembered, choice, memory_arguments
from railhil.scenarios.load import load
from railhil.scenarios.memory import Memory, MemoryRecord, Stored, no_memory

_SCENARIO = load("lvshun_tieshan")
_KEY = Learning.memory_key(_SCENARIO)


def record(offset: float, key: str = _KEY) -> MemoryRecord:
    return MemoryRecord("learning", key, 3, 3, {"runs": 3, "offset": offset})


def memory(*stored: Stored) -> Memory:
    return Memory("learning", stored, Path("store"))


def begun(*stored: Stored) -> Remembered:
    (found,) = memory_arguments("learning", Learning, _SCENARIO, memory(*stored))
    assert isinstance(found, Remembered)
    return found


def test_a_law_with_a_key_is_told_what_it_kept() -> None:
    assert memory_arguments("ipfc", Ipfc, _SCENARIO, None) == ()
    for given in (None, no_memory("learning", Path("store"))):
        assert memory_arguments("learning", Learning, _SCENARIO, given) == (NOTHING,)
    values = {"runs": 3, "offset": 0.5}
    assert begun(Stored("A", record(0.5)), Stored("B", record(0.1))) == Remembered(values, 1, 0)
    assert begun(Stored("B", record(0.5)), Stored("A", record(0.1))) == Remembered(values, 2, 0)
    assert begun(Stored("file", record(0.5))) == Remembered(values, 0, 0)


#: The newest record, and what is wrong with it: fault number on the bus.
_BAD = [
    (Stored("A", None, "crc", "found other"), 4),
    (Stored("A", None, "json", "torn"), 2),
    (Stored("A", record(0.5, "another platform")), 7),
    (Stored("A", record(99.0)), 8),
    (Stored("A", MemoryRecord("learning", _KEY, 3, 3, {"runs": 3})), 8),
    (Stored("A", MemoryRecord("learning", _KEY, 3, 3, {"runs": 3, "offset": "sixty"})), 8),
]


@pytest.mark.parametrize(("bad", "fault"), _BAD)
def test_each_fault_falls_back_to_the_other_slot_then_the_default_then_nothing(bad: Stored, fault: int) -> None:
    good = {"runs": 3, "offset": 0.1}
    assert begun(bad, Stored("B", record(0.1))) == Remembered(good, 2, fault)
    assert begun(bad, Stored("default", record(0.1))) == Remembered(good, 0, fault)
    assert begun(bad, Stored("default", record(0.1, "any platform"))) == Remembered(good, 0, fault)
    assert begun(bad) == Remembered(None, 0, fault)
    assert begun(bad, Stored("B", None, "version", "")) == Remembered(None, 0, fault), "of two slots that of A"
    assert begun(bad, Stored("default", None, "json", "")) == Remembered(None, 0, fault)


def test_what_is_wrong_is_said() -> None:
    found = choice("learning", Learning, _SCENARIO, memory(Stored("A", record(99.0)), Stored("B", record(0.1))))
    assert found.used == "B"
    (refused,) = found.refused
    assert (refused["slot"], refused["fault"]) == ("A", "values")
    assert refused["detail"].startswith("ValueError: offset 99.0, allowed +-")
    # A slot that was not needed is looked at all the same.
    found = choice("learning", Learning, _SCENARIO, memory(Stored("A", record(0.1)), Stored("B", record(0.1, "x"))))
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
        begun(Stored("file", given))
    assert len(str(refused.value).splitlines()) == 1


def test_a_memory_of_another_law_is_refused() -> None:
    with pytest.raises(InputError, match="store: law: found 'other', allowed learning, the controller asked for"):
        memory_arguments("learning", Learning, _SCENARIO, no_memory("other", Path("store")))
    with pytest.raises(InputError, match="store: law: found 'ipfc', allowed a law that keeps a memory"):
        memory_arguments("ipfc", Ipfc, _SCENARIO, no_memory("ipfc", Path("store")))
