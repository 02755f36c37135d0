"""The controller class: one train and many, fixed point against float64 on the same inputs, the closed loop."""

from __future__ import annotations

import pytest

from hil_tests.support.closed_loop import SCENARIO, closed_loop
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import Controller
from railhil.scenarios.run_spec import LawSpec


def test_softening_is_that_of_the_worst_satisfaction_in_a_run() -> None:
    _, answers, _ = closed_loop(0, [Controller(SCENARIO)], ticks=5000)
    for answer, *_ in answers[1:]:
        assert answer.notes[1:] == (int(0.85 * 2**14), 0)


def test_sent_notch_changes_the_next_answer() -> None:
    told, silent, same = Controller(SCENARIO), Controller(SCENARIO), Controller(SCENARIO)
    told.sent(100)
    for controller in (told, silent, same):
        first = controller.step(100, 180_339, 0)
    told.sent(-256)
    same.sent(first.notch_code)
    after = [controller.step(101, 180_340, 0).notch_code for controller in (told, silent, same)]
    assert after[0] != after[1] == after[2]


def test_overflow_flags_stay_once_set() -> None:
    controller = Controller(SCENARIO)
    assert controller.step(100, 180_000, 0).overflow_flags == 0
    assert controller.step(101, 0, 0).overflow_flags == 2
    assert controller.step(102, 0, 0).overflow_flags == 2


def test_cycles_are_counted_for_fixed_point_only() -> None:
    time, distance = (Controller(SCENARIO, LawSpec(indexing=i)).step(0, 0, 0) for i in ("time", "distance"))
    assert 2000 < time.cycles < distance.cycles < 5000
    double = Controller(SCENARIO, LawSpec("ipfc", "float64")).step(0, 0, 0)
    assert (double.cycles, double.overflow_flags) == (0, 0)


def test_wire_speed_is_converted_by_one_product() -> None:
    loop: ControlLoop[int] = ControlLoop(SCENARIO, LawSpec(), make("iq"))
    for speed_01mmps in (0, 1, 27, 180_339, 216_667, 833_333, -1):
        exact = speed_01mmps * 3.6e-4 * 2**20
        assert exact - 1.001 <= loop.inputs(0, speed_01mmps, 0).speed <= exact + 1e-3


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("ipcf", "iq", "time"), "controller: name: found 'ipcf'"),
        (("ipfc", "fixed", "time"), "arithmetic: name: found 'fixed'"),
        (("ipfc", "iq", "place"), "indexing: name: found 'place'"),
    ],
)
def test_unknown_names_are_one_line(names: tuple[str, str, str], words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        Controller(SCENARIO, LawSpec(*names))
    assert "\n" not in str(caught.value)
