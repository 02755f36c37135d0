"""The controller class: one train and many, fixed point against float64 on the same inputs, the closed loop."""

from __future__ import annotations

import numpy as np
import pytest

from hil_tests.support.closed_loop import SCENARIO, closed_loop
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make, names
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import BatchController, Controller
from railhil.scenarios.run_spec import LawSpec


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", names())
def test_softening_adapts_equally_for_many_and_for_one(arithmetic: str) -> None:
    """Errors that shrink to next to nothing within one period, the notch held at 0 meanwhile."""
    trains = 20
    batch = BatchController(SCENARIO, trains, LawSpec("ipfc", arithmetic))
    target = 180_341 - 3 * np.arange(trains)
    apart, close = target - 2000, target
    batch.step(100, apart, apart)
    batch.sent(np.zeros(trains, dtype=np.int64))
    together = batch.step(101, close, close)
    for train in range(trains):
        controller = Controller(SCENARIO, LawSpec("ipfc", arithmetic))
        controller.step(100, int(apart[train]), 0)
        controller.sent(0)
        single = controller.step(101, int(close[train]), 0)
        assert single.notes == tuple(values[train] for values in together.notes)
        assert single.notch_code == together.notch_code[train]
    _, softening, satisfaction = together.notes
    assert len(set(satisfaction.tolist())) > 10
    assert satisfaction.max() == 2**14
    assert softening.min() == int(0.77 * 2**14)


@pytest.mark.long_after(2)
@pytest.mark.parametrize("arithmetic", ["iq", "iq-portable"])
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_fixed_point_follows_float64_on_the_same_inputs(seed: int, arithmetic: str) -> None:
    pair = [Controller(SCENARIO, LawSpec("ipfc", arithmetic)), Controller(SCENARIO, LawSpec("ipfc", "float64"))]
    _, answers, stopped = closed_loop(seed, pair)
    assert stopped is not None
    differences = [abs(iq.notch_code - double.notch_code) for iq, double in answers]
    assert max(differences) <= 1
    assert sum(difference > 0 for difference in differences) <= len(differences) / 100
    assert all(iq.notes[0] == double.notes[0] for iq, double in answers)
    assert answers[-1][0].overflow_flags == 0
    assert max(abs(iq.error_raw - double.error_raw) for iq, double in answers) <= 2


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", names())
def test_closed_loop_stops_where_and_when_the_law_does(arithmetic: str) -> None:
    """Nominal and five perturbed runs; the medians over 200 runs in the reading are 0.26 m and 0.078 s."""
    time_errors_s, stop_errors_m = [], []
    for seed in range(6):
        _, answers, stopped = closed_loop(seed, [Controller(SCENARIO, LawSpec("ipfc", arithmetic))])
        assert stopped is not None
        assert {answer[0].notes[0] for answer in answers} == {1, 2}
        time_errors_s.append(abs(stopped.instant_01ms / 1e4 - 195))
        stop_errors_m.append(abs(stopped.position_01mm / 1e4 - 2940))
    assert 0.04 < np.median(time_errors_s) < 0.12
    assert 0.16 < np.median(stop_errors_m) < 0.36
    assert max(stop_errors_m) < 0.8


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
