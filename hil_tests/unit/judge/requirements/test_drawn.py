"""What a page shows of a sentence: the part that fails, its values with their limits, its margin."""

from __future__ import annotations

import numpy as np
import pytest

from hil_tests.unit.judge.requirements.records import names, record_of
from railhil.judge.requirements.drawn import FAILS, GIVEN, DrawnSentence
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.requirement import Requirement
from railhil.wire.ato import CtlMode

#: 1 m/s for ten ticks, then 2 m/s; the notch is 1.
RECORD = record_of([1000] * 10 + [2000] * 10, [(256, int(CtlMode.RUNNING))] * 10)


def drawn(says: str, **define: str) -> DrawnSentence:
    return DrawnSentence(Requirement("R", says, define=tuple(define.items())), names())


@pytest.mark.parametrize(
    ("says", "fails"),
    [
        ("always measured_speed < 1.5 m/s", ["measured_speed < 1.5 m/s"]),
        ("always measured_speed < 1.5 m/s and notch_command > 0", ["measured_speed < 1.5 m/s"]),
        ("always measured_speed < 1.5 m/s or notch_command < 0", ["measured_speed < 1.5 m/s", "notch_command < 0"]),
        ("never measured_speed > 1.5 m/s and notch_command > 0", ["measured_speed > 1.5 m/s", "notch_command > 0"]),
        ("never measured_speed > 1.5 m/s or notch_command < 0", ["measured_speed > 1.5 m/s"]),
        ("always not (measured_speed > 1.5 m/s) and notch_command > 0", ["not (measured_speed > 1.5 m/s)"]),
        ("always not (measured_speed > 1.5 m/s or notch_command < 0)", ["measured_speed > 1.5 m/s"]),
        ("always slow and notch_command > 0", ["slow"]),
    ],
)
def test_the_comparisons_that_are_not_as_they_should_be_are_marked(says: str, fails: list[str]) -> None:
    parts = drawn(says, slow="measured_speed < 1.5 m/s").parts(Grid(RECORD), 15)
    assert "".join(text for text, _ in parts) == says
    assert [text for text, kind in parts if kind == FAILS] == fails


def test_the_antecedent_is_marked_as_what_was_given() -> None:
    parts = drawn("whenever measured_speed > 1.5 m/s, within 20 ms notch_command <= 0").parts(Grid(RECORD), 12)
    assert [part for part in parts if part[1]] == [("measured_speed > 1.5 m/s", GIVEN), ("notch_command <= 0", FAILS)]


def test_each_value_comes_once_in_one_unit_with_all_its_limits() -> None:
    found = drawn(
        "whenever measured_speed > 1 km/h, within 20 ms notch_command <= 0 or controller_level >= hold, "
        "until measured_speed > 7.2 km/h"
    ).series()
    assert [(one.text, one.unit) for one in found] == [
        ("measured_speed", "m/s"), ("notch_command", "notch"), ("controller_level", ""),
    ]  # fmt: skip
    speed, notch, level = found
    assert list(speed.limits) == pytest.approx([1 / 3.6, 2.0])
    assert list(speed.limits.values()) == ["1 km/h", "7.2 km/h"]
    assert notch.limits == {0.0: "0"}
    assert [level.words[value] for value in level.limits] == ["hold"]
    assert speed.values(Grid(RECORD)).tolist() == [1.0] * 10 + [2.0] * 10


def test_the_margin_is_below_0_where_the_condition_is_not_as_it_should_be() -> None:
    grid = Grid(RECORD)
    for says in ("always measured_speed < 1.5 m/s", "never measured_speed >= 1.5 m/s"):
        found = drawn(says)
        assert found.unit == "m/s"
        np.testing.assert_allclose(found.margin(grid), [0.5] * 10 + [-0.5] * 10)
    assert drawn("always measured_speed >= 1 m/s").margin(grid)[0] == 0.0
