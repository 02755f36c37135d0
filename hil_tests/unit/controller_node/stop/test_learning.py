"""Learning from run to run: exact updates, clamps, gates, the memory it leaves."""

from __future__ import annotations

import json
from typing import Any

import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.stop.learning import Learning, LearningRule, OffsetMemory, Report, stored_records
from railhil.controller_node.stop.numbers import Numbers


def ran(
    values: Any = None,
    error_m: float = 1.0,
    *,
    run: int = 1,
    own: int | None = None,
    load: float = 0.0,
    wet: float = 0.0,
    spoiled: float = 0.0,
    ready: float = 1.0,
    gamma: float = 0.5,
    **options: Any,
) -> dict[str, Any]:
    """Memory after one run, as it comes back from its file.

    :param run: of the report. :param own: number of the run; None: the same.
    """
    numbers = Numbers(make("float64"))
    offsets = OffsetMemory(numbers, values)
    learning = Learning(numbers, offsets, LearningRule(gamma, **options))
    learned = learning.start(load, wet)
    number = float(run if own is None else own)
    learned = learning.step(learned, 0.0, spoiled, number, Report(0.0, 0.0), 190.0)
    for _ in range(3):
        learned = learning.step(learned, ready, 0.0, number, Report(float(run), error_m), 190.0)
    return json.loads(json.dumps(offsets.after(learned)))


def record(values: dict[str, Any]) -> dict[str, Any]:
    (found,) = values["records"]
    return found


def test_one_update_and_the_next():
    after = ran(error_m=4.0)
    assert record(after)["offset_m"] == 2.0
    assert record(after)["runs"] == 1
    after = ran(after, 1.5, run=2)
    assert record(after)["offset_m"] == 2.75
    assert record(after)["last_errors_m"] == [4.0, 1.5]
    assert (record(after)["last_run"], record(after)["gamma"]) == (2, 0.5)


def test_a_step_and_the_offset_are_limited():
    after = ran(error_m=30.0)
    assert record(after)["offset_m"] == 8.0
    after = ran(after, 30.0, run=2)
    assert record(after)["offset_m"] == 12.0
    assert record(ran(error_m=-30.0))["offset_m"] == -8.0


def test_the_rule_without_a_fixed_gain():
    values, gammas = None, []
    for run in range(1, 6):
        values = ran(values, 0.1, run=run, gamma=0.0)
        gammas.append(record(values)["gamma"])
    assert gammas == pytest.approx([1.0, 1 / 2, 1 / 3, 0.3, 0.3])


@pytest.mark.parametrize(
    "gate", [{"spoiled": 1.0}, {"ready": 0.0}, {"run": 0}, {"error_m": 1e6}, {"error_m": float("nan")}]
)
def test_runs_that_are_not_learned(gate):
    first = ran()
    assert ran(first, **{"run": 2, "error_m": 1.0, **gate}) == first


def test_a_run_is_learned_once_even_after_a_restart():
    first = ran(run=7)
    assert ran(first, run=7) == first


@pytest.mark.parametrize(("own", "report"), [(5, 9), (5, 6), (5, 4), (5, 0), (0, 5), (0, 0)])
def test_a_report_of_another_run_than_its_own_is_not_learned(own, report):
    first = ran(run=3)
    assert ran(first, 2.0, run=report, own=own) == first


def test_runs_may_be_missing_but_none_is_learned_after_a_later_one():
    values = ran(ran(run=3), run=7, load=90.0)
    assert [one["last_run"] for one in values["records"]] == [3, 7]
    # Run 5 would be new for its own load class.
    assert ran(values, run=5) == values
    assert [one["last_run"] for one in ran(values, run=9)["records"]] == [9, 7]


def test_learning_can_be_switched_off():
    first = ran()
    assert ran(first, run=2, active=False) == first


def test_each_load_class_and_rail_has_its_record():
    values = ran(error_m=1.0)
    values = ran(values, 2.0, load=50.0, run=2)
    values = ran(values, 3.0, load=90.0, run=3)
    values = ran(values, 4.0, load=90.0, wet=1.0, run=4)
    found = {(one["load_class"], one["wet"]): one["offset_m"] for one in values["records"]}
    assert found == {(0, 0): 0.5, (1, 0): 1.0, (2, 0): 1.5, (2, 1): 2.0}


def test_an_unlikely_stop_only_widens_what_is_expected():
    values = None
    for run in range(1, 8):
        values = ran(values, 0.05, run=run, sigmas=3.0)
    known = record(values)
    after = record(ran(values, 5.0, run=8, sigmas=3.0))
    assert (after["offset_m"], after["runs"]) == (known["offset_m"], 7)
    assert after["variance_m2"] > known["variance_m2"]
    # Beyond 9 % of the braking distance not even a first stop is believed.
    assert ran(error_m=0.1 * 190.0, sigmas=3.0)["records"] == []
    # A change that stays is learned in the end.
    for run in range(8, 16):
        values = ran(values, 5.0, run=run, sigmas=3.0)
    assert record(values)["offset_m"] > known["offset_m"] + 1.0


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"offset_m": 13.0}, "offset_m"),
        ({"offset_m": float("nan")}, "offset_m"),
        ({"variance_m2": 1e-9}, "variance_m2"),
        ({"variance_m2": "1"}, "variance_m2"),
        ({"runs": -1}, "runs"),
        ({"last_run": 65536}, "last_run"),
        ({"load_class": 3}, "load class"),
    ],
)
def test_stored_values_out_of_range_are_refused(change, word):
    values = ran()
    values["records"][0].update(change)
    with pytest.raises(ValueError, match=word):
        stored_records(values)


def test_another_version_and_two_records_of_one_kind_are_refused():
    values = ran()
    with pytest.raises(ValueError, match="version 2"):
        stored_records({**values, "version": 2})
    with pytest.raises(ValueError, match="each once"):
        stored_records({**values, "records": values["records"] * 2})


def test_where_only_scatter_is_left_little_is_learned():
    values = None
    for run in range(1, 9):
        values = ran(values, 0.03 * (-1) ** run, run=run, report_sigma_m=0.035)
    settled = record(values)
    assert settled["gamma"] == 0.0
    # An error that comes again is beyond the scatter, and is learned.
    for run in range(9, 12):
        values = ran(values, 0.3, run=run, report_sigma_m=0.035)
    assert record(values)["gamma"] > 0.45
    assert record(values)["offset_m"] > settled["offset_m"] + 0.3


def test_a_gain_that_cannot_converge_can_be_tried():
    assert record(ran(error_m=1.0, gamma=2.0))["offset_m"] == 2.0
    numbers = Numbers(make("iq"))
    offsets = OffsetMemory(numbers, None)
    learning = Learning(numbers, offsets, LearningRule(gamma=3.0))
    assert offsets.after(learning.start(0, 0)) == {"version": 1, "records": []}
