"""Answers of a user's controller: any value, and any octets of its process, are commands or one line."""

from __future__ import annotations

import math
import struct
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from railhil.common.errors import InputError
from railhil.controller_node.given.computing import Quantity, Terms, checked_answer
from railhil.controller_node.given.python import PythonFile

ONE = Terms((Quantity("speed_mps", "m/s"),), (Quantity("notch", "notch"),), 0.5)
TWO = Terms(ONE.readings, (Quantity("u", "mm/s2"), Quantity("valid", "")), 0.016)
#: Code that writes to the socket of its process, in its control period or at its start.
CODE = """
import os, sys

def step(reading):
    os.write(int(sys.argv[1]), bytes.fromhex("{octets}"))
    os._exit(0)
"""

scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary() | st.complex_numbers()
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner) | st.dictionaries(st.sampled_from(["notch", "u", "valid"]) | st.text(), inner),
)


@given(answer=values, terms=st.sampled_from([ONE, TWO]))
@example(answer=10**400, terms=ONE)
@example(answer={"notch": 10**400}, terms=ONE)
@example(answer="3", terms=ONE)
@example(answer=[b"3", "4"], terms=TWO)
@example(answer=[math.inf, 1], terms=TWO)
def test_any_answer_is_a_finite_number_for_each_command_or_one_line(answer: Any, terms: Terms) -> None:
    line, found = "", [0.0] * len(terms.commands)
    try:
        found = checked_answer("mine.py:step", terms, answer)
    except InputError as error:
        line = str(error)
    assert not line or ("mine.py:step" in line and "\n" not in line)
    assert len(found) == len(terms.commands)
    assert all(type(one) is float and math.isfinite(one) for one in found)


@pytest.mark.parametrize("answer", [2, 2.0, True + 1, {"notch": 2}, [2], (2.0,)])
def test_a_number_for_the_command_is_its_answer(answer: Any) -> None:
    assert checked_answer("mine.py:step", ONE, answer) == [2.0]


def frame(kind: bytes, content: bytes) -> bytes:
    return struct.pack("<cI", kind, len(content)) + content


@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(octets=st.binary(max_size=40))
@example(octets=b"")
@example(octets=struct.pack("<cI", b"v", 2**32 - 1))
@example(octets=frame(b"v", b"short"))
@example(octets=frame(b"v", struct.pack("<d", math.nan)))
@example(octets=frame(b"x", struct.pack("<d", 1.0)))
@example(octets=frame(b"e", b"no JSON"))
@example(octets=frame(b"e", b"\xff\xfe"))
@example(octets=frame(b"e", b'["a", "b"]'))
@example(octets=frame(b"e", b"7"))
@example(octets=b"v\x08")
def test_octets_that_are_no_answer_are_one_line(octets: bytes, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(CODE.format(octets=octets.hex()), encoding="utf-8")
    computer = PythonFile(f"{tmp_path / 'mine.py'}:step").start(ONE, 10.0)
    try:
        with pytest.raises(InputError) as raised:
            computer.compute([1.0])
    finally:
        computer.close()
    assert "control period 1" in str(raised.value)
    assert "\n" not in str(raised.value)
