"""IPFC+: its limits over 200 perturbed runs, the contribution of each element, faults, fixed point, invalid
parameters."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from benchmarks.ablation import LAW, Figures, without
from railhil.batch import Case
from railhil.bench import Result, coupled_run, direct_run
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.ato.ipfc_plus_constants import IpfcPlusParameters, compute_constants
from railhil.controller_node.laws.base import BaliseReading
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.standstill import standstill

WORN = load("lvshun_tieshan_worn_wheels")
TABLE = compute_constants(IpfcPlusParameters(), WORN)


# -- the bars ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
def test_bars_over_200_runs(arithmetic: str) -> None:
    result = run_batch(Case(WORN, LawSpec(LAW, arithmetic)), range(1000, 1200))
    assert set(result.ended) == {"ended_complete"}
    assert result.passed.all()
    assert not result.wraps.any()
    assert not result.zero_divisions.any()
    figures = Figures.of(result)
    assert figures.stop_error_m[0] <= 0.027
    assert figures.stop_error_m[1] <= 0.050
    assert figures.punctuality_s[0] <= 0.045
    assert figures.punctuality_s[1] <= 0.10
    assert figures.comfort[0] <= 1.5
    assert figures.itae <= 1139


@cache
def sixty(element: str) -> Figures:
    return without(WORN, element, 60, 1000)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("element", "figure", "times"),
    [
        ("no balises", "stop_error_m", 100),
        ("no position error", "stop_error_m", 30),
        ("no feed-forward of the drag", "itae", 2),
        ("no disturbance", "stop_error_m", 3),
        ("no force gain", "stop_error_m", 2),
        ("no lag", "punctuality_s", 1.5),
        ("no re-planning at the end", "stop_error_m", 1.8),
        ("no loop delay", "punctuality_s", 1.5),
        ("step alone", "stop_error_m", 1.3),
    ],
)
def test_without_an_element_a_figure_gets_worse(element: str, figure: str, times: float) -> None:
    def upper(name: str) -> float:
        value = getattr(sixty(name), figure)
        return value if isinstance(value, float) else value[1]

    assert upper(element) > times * upper("IPFC+")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["yizhuang_01_songjiazhuang_xiaocun", "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan"])
def test_another_line_with_all_balises_before_the_stop(name: str) -> None:
    figures = without(load(name), "IPFC+", 40, 1000, "iq")
    assert figures.passed == 40
    assert figures.stop_error_m[1] <= 0.05


@pytest.mark.slow
@pytest.mark.parametrize("period_s", [0.2, 1.0])
def test_other_control_periods(period_s: float) -> None:
    timing = replace(WORN.timing, control_period_ns=round(period_s * 1e9))
    figures = without(replace(WORN, timing=timing), "IPFC+", 20, 1000)
    assert figures.passed == 20
    assert figures.stop_error_m[0] <= 0.027


# -- faults -----------------------------------------------------------------------------------------------------------


def faulty(fault: str, seed: int, law: str = LAW) -> Result:
    controller = Controller(WORN, LawSpec(law))
    known, speed_before = BaliseReading(0, 0, 0), 0
    missing = {"the last two balises are missing": (5, 6), "three balises under way are missing": (2, 3, 4)}

    def step(k: int, speed_01mmps: int, position_01mm: int, balise: BaliseReading[int]) -> int:
        nonlocal known, speed_before
        if balise.number not in missing.get(fault, ()):
            known = balise
        if fault == "speed reads 0 now and then" and k in (100, 250, 350, 384):
            speed_01mmps = 0
        if fault == "speed is frozen for 3 s" and 200 <= k < 206:
            speed_01mmps = speed_before
        speed_before = speed_01mmps
        code = controller.step(k, speed_01mmps, position_01mm, known).notch_code
        if fault == "held for 5 s" and k < 10:
            code = 0
        if fault == "traction is cut for 5 s" and 40 <= k < 50:
            code = min(code, 0)
        if fault == "the brake is stuck for 2 s before the stop" and 378 <= k < 382:
            code = -2 * 256
        controller.sent(code)
        return code

    run = coupled_run(WORN, step, RunSpec(seed=seed, perturbed=True))
    assert controller.counters.wraps == 0
    return run


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "seed", "stop_error_m", "punctuality_s"),
    [
        ("the last two balises are missing", 2, 0.05, 0.1),
        ("three balises under way are missing", 5, 0.1, 0.3),
        ("speed reads 0 now and then", 4, 0.05, 0.1),
        ("speed is frozen for 3 s", 4, 0.05, 0.1),
        ("held for 5 s", 3, 0.1, 0.1),
        ("traction is cut for 5 s", 4, 0.05, 0.1),
    ],
)
def test_arrives_in_spite_of(fault: str, seed: int, stop_error_m: float, punctuality_s: float) -> None:
    score = faulty(fault, seed).score
    assert score.values["stop_error_m"] is not None
    assert score.values["stop_error_m"] < stop_error_m
    assert score.values["punctuality_s"] is not None
    assert score.values["punctuality_s"] < punctuality_s
    assert score.values["comfort"] is not None
    assert score.values["comfort"] < 2.0


# -- fixed point, many trains, bad input ------------------------------------------------------------------------------


def test_fixed_point_and_float64_share_every_constant() -> None:
    assert all(constant.rounding_error == 0.0 for constant in TABLE.entries())


@pytest.mark.long
@pytest.mark.slow
def test_batch_with_balises_is_the_bench() -> None:
    batch = run_batch(Case(WORN, LawSpec(LAW, "iq")), [7])
    score = direct_run(WORN, RunSpec(law=LawSpec(LAW, "iq"), seed=7, perturbed=True)).score
    assert batch.scores[0] == score


def test_a_long_run_fits_the_formats() -> None:
    """50 km of line: the weight of the nominal wheel is still there, so nothing is divided by 0."""
    plan = replace(WORN.plan, distance_m=50_000.0)
    table = compute_constants(IpfcPlusParameters(), replace(WORN, plan=plan))
    assert table.prior.raw > 0


def test_held_train_at_the_end_of_the_timetable() -> None:
    still = standstill(WORN, LAW, make("iq"), make("iq"))
    assert (still.changes, still.kicked_difference) == (0, 0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"loop_delay_s": 0.5}, "a loop delay of 0.5 s is not inside the control period of 0.5 s"),
        ({"fit_points_s": (1.0,)}, "2 basis functions need as many fitting points, there are 1"),
        ({"position_error_max_m": 1e6}, "does not fit into int32"),
        ({"replan_min_s": 12.0}, "replan_min_s 12 is above replan_max_s 10"),
    ],
)
def test_parameters_that_do_not_fit(change: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        compute_constants(replace(IpfcPlusParameters(), **change), WORN)


def test_a_run_that_is_too_long() -> None:
    with pytest.raises(ValueError, match="longer than 100000 m"):
        compute_constants(IpfcPlusParameters(), replace(WORN, plan=replace(WORN.plan, distance_m=100_001.0)))


def test_only_by_time() -> None:
    with pytest.raises(InputError, match="time with this law"):
        ControlLoop(WORN, LawSpec(LAW, indexing="distance"), make("iq"))
