"""IPFC+ with its end phase: gains, handover, bounds of the wheel, and its runs against those of IPFC+ alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from benchmarks import stopping
from hil_tests.unit.controller_node.ato.test_ipfc_plus import faulty
from railhil.batch import Batch, Case
from railhil.bench import direct_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.balise_odometer import BaliseOdometer
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import WIRE
from railhil.controller_node.ato.ipfc_plus_constants import WHEEL_Q
from railhil.controller_node.ato.ipfc_plus_design import StopWeights, stop_gains
from railhil.controller_node.ato.ipfc_plus_stop_constants import IpfcPlusStopParameters, stop_constants
from railhil.controller_node.ato.laws.ipfc_plus_stop import SurveyOdometer
from railhil.controller_node.laws.base import BaliseReading, TrackInputs
from railhil.controller_node.program.ranges import analyse_law
from railhil.controller_node.program.tracer import record
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.scenario.target import Target

LAW = stopping.LAW
WORN = load("lvshun_tieshan_worn_wheels")
GIVEN = IpfcPlusStopParameters()
TABLE = stop_constants(GIVEN, WORN)
POLE = WORN.train.actuator_pole_per_s


# -- gains ------------------------------------------------------------------------------------------------------------


def test_gains_are_those_of_the_cheapest_demands_to_the_stop() -> None:
    """Against a least squares problem over all demands at once, whose responses are integrated in small steps."""
    left_s, weights = np.array([2.4, 1.9, 1.4, 0.9, 0.4]), StopWeights(0.001, 0.002, 0.05)
    lengths_s = -np.diff(np.append(left_s, 0.0))

    def at_the_stop(x: float, v: float, f: float, demands: Any) -> tuple[float, float]:
        for length_s, demand in zip(lengths_s, demands, strict=True):
            step_s = length_s / 4000
            for _ in range(4000):
                before, v_before = f, v
                f = demand + (f - demand) * np.exp(-POLE * step_s)
                v += (before + f) / 2 * step_s
                x += (v_before + v) / 2 * step_s
        return x / weights.position_m, v / weights.speed_mps

    nothing = np.zeros(5)
    responses = np.array([at_the_stop(0.0, 0.0, 0.0, np.eye(5)[i]) for i in range(5)]).T
    cost = np.vstack((responses, np.diag(np.sqrt(lengths_s) / weights.demand_mps2)))
    for i, start in enumerate(np.eye(3)):
        wanted = np.concatenate((-np.array(at_the_stop(*start, nothing)), nothing))
        best = np.linalg.lstsq(cost, wanted, rcond=None)[0]
        assert -best[0] == pytest.approx(stop_gains(POLE, left_s, weights)[0, i], rel=1e-4)


def test_the_end_phase_lasts_from_the_handover_to_the_planned_stop() -> None:
    ending = np.array([constant.value for constant in TABLE.ending])
    speed_kmh = np.array([constant.value for constant in TABLE.target_speed])
    inside = np.flatnonzero(ending)
    assert inside.tolist() == list(range(inside[0], inside[-1] + 1))
    assert speed_kmh[inside[0]] <= GIVEN.handover_kmh < speed_kmh[inside[0] - 1]
    stop_s = Target(WORN.target).stop_time_s
    assert inside[-1] * 0.5 + GIVEN.loop_delay_s < stop_s <= (inside[-1] + 1) * 0.5 + GIVEN.loop_delay_s
    gains = np.array([[row.value for row in getattr(TABLE, f"stop_by_{of}")] for of in ("position", "speed", "force")])
    assert (gains[:, inside] > 0).all()
    assert not gains[:, ending == 0].any()


def test_no_handover_no_end_phase() -> None:
    assert not any(constant.raw for constant in stop_constants(replace(GIVEN, handover_kmh=0.0), WORN).ending)


# -- bounds of the wheel ----------------------------------------------------------------------------------------------

#: Relative error of the wheel; surveyed positions, and how far the balises are from them, m.
WHEEL = 0.004
PLACES_M = (0.0, 600.0, 1500.0, 2400.0, 2800.0, 2915.0)
ERRORS_M = (0.01, 0.03, -0.04, 0.05, 0.03, 0.045)


def found_wheel(arithmetic: str, errors_m: tuple[float, ...]) -> tuple[float, float]:
    """Wheel error by the bounds and by the fit after all balises, each told twice."""
    ar = make(arithmetic)
    fit: BaliseOdometer[Any] = BaliseOdometer(ar, TABLE, WORN.plan.distance_m)
    survey: SurveyOdometer[Any] = SurveyOdometer(ar, TABLE, fit)
    fitted, bounds = fit.start(), survey.start()
    place = by_fit = None
    for number, (at_m, error_m) in enumerate(zip(PLACES_M, errors_m, strict=True), start=1):
        raws = (number, round(at_m * 1e4), round((at_m + error_m) * (1 + WHEEL) * 1e4))
        for _ in range(2):
            balise = BaliseReading(*(ar.from_raw(raw, 0) for raw in raws))
            track = TrackInputs(0, ar.from_raw(raws[2], 0), balise)
            after, by_fit = fit.step(fitted, track)
            bounds, place = survey.step(bounds, (fitted, after), track, by_fit)
            fitted = after
    assert place is not None
    assert by_fit is not None
    return ar.raw(place.wheel, WHEEL_Q) / 2**WHEEL_Q, ar.raw(by_fit.wheel, WHEEL_Q) / 2**WHEEL_Q


@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
def test_the_middle_of_what_all_balises_leave(arithmetic: str) -> None:
    odometer_m = [(at_m + error_m) * (1 + WHEEL) for at_m, error_m in zip(PLACES_M, ERRORS_M, strict=True)]
    bounds = [
        ((at_m - 0.05) / o_m - 1, (at_m + 0.05) / o_m - 1) for at_m, o_m in zip(PLACES_M, odometer_m, strict=True)
    ]
    low, high = max(bound[0] for bound in bounds[1:]), min(bound[1] for bound in bounds[1:])
    assert low < high
    assert low <= 1 / (1 + WHEEL) - 1 <= high
    assert found_wheel(arithmetic, ERRORS_M)[0] == pytest.approx((low + high) / 2, abs=2e-8)


@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
def test_balises_that_contradict_the_tolerance_leave_the_fit(arithmetic: str) -> None:
    """The fifth balise is 0.4 m off: no wheel agrees with all of them."""
    bounded, fitted = found_wheel(arithmetic, (*ERRORS_M[:4], 0.4, ERRORS_M[5]))
    assert bounded == fitted


# -- runs -------------------------------------------------------------------------------------------------------------


@cache
def forty(law: str, **changed: float) -> Batch:
    return stopping.batch(WORN, law, "iq", range(1000, 1040), changed)


@pytest.mark.long
@pytest.mark.slow
def test_better_than_ipfc_plus_in_fixed_point() -> None:
    """At the median and the 95th percentile; without the share of the survey the stop is three times as exact."""
    plus, stop = (stopping.batch(WORN, law, "iq", range(1000, 1300), {}) for law in ("ipfc_plus", LAW))
    assert stop.passed.all()
    assert not stop.wraps.any()
    assert not stop.zero_divisions.any()
    times = {"stop_error_m": 0.92, "punctuality_s": 0.8, "comfort": 0.97, "itae": 1.0, "energy_kj": 1.0}
    for key, share in times.items():
        for percentile in (50, 95):
            usual, mine = (np.percentile(result.values[key], percentile) for result in (plus, stop))
            assert mine <= share * usual, (key, percentile)
    _, bounded = stopping.floors_m(WORN, range(1000, 1300))
    usual, mine = (np.std(result.signed["stop_error_m"] - bounded) for result in (plus, stop))
    assert mine < usual / 3
    assert mine < 0.0038


@pytest.mark.long
@pytest.mark.slow
def test_what_is_left_over_is_the_survey() -> None:
    """Stop error without that of the best estimate of the position, rms."""
    _, bounded = stopping.floors_m(WORN, range(1000, 1040))
    assert np.std(forty(LAW).signed["stop_error_m"] - bounded) < 0.0042


def test_handover_without_a_bump() -> None:
    """Until the handover the notches are those without an end phase; at it they differ by less than a tenth."""
    with_it, without = forty(LAW), forty(LAW, handover_kmh=0.0)
    assert with_it.commands is not None
    assert without.commands is not None
    first = next(k for k, constant in enumerate(TABLE.ending) if constant.raw)
    for mine, usual in zip(with_it.commands, without.commands, strict=True):
        assert np.array_equal(mine[:first], usual[:first])
        assert abs(int(mine[first]) - int(usual[first])) < 0.1 * 256


def test_batch_is_the_bench() -> None:
    score = direct_run(WORN, RunSpec(law=LawSpec(LAW, "iq"), seed=1007, perturbed=True)).score
    assert run_batch(Case(WORN, LawSpec(LAW, "iq")), [1007]).scores[0] == score


@pytest.mark.long_after(1)
@pytest.mark.parametrize(
    ("fault", "seed", "punctuality_s"),
    [
        ("the last two balises are missing", 2, 0.1),
        ("speed reads 0 now and then", 4, 0.1),
        ("held for 5 s", 3, 0.1),
        ("the brake is stuck for 2 s before the stop", 4, 0.5),
    ],
)
def test_arrives_in_spite_of(fault: str, seed: int, punctuality_s: float) -> None:
    values: Mapping[str, Any] = faulty(fault, seed, LAW).score.values
    assert values["stop_error_m"] < 0.05
    assert values["punctuality_s"] < punctuality_s


@pytest.mark.parametrize("period_s", [0.2, 1.0])
def test_other_control_periods(period_s: float) -> None:
    timing = replace(WORN.timing, control_period_ns=round(period_s * 1e9))
    result = stopping.batch(replace(WORN, timing=timing), LAW, "iq", range(1000, 1010), {})
    assert result.passed.all()
    assert not result.wraps.any()


@pytest.mark.parametrize("period_s", [0.2, 1.0])
def test_nothing_can_wrap_on_a_train_with_many_notches(period_s: float) -> None:
    timing = replace(WORN.timing, control_period_ns=round(period_s * 1e9))
    scenario = replace(WORN, timing=timing, train=replace(WORN.train, notch_max=40.0))
    law = ControlLoop(scenario, LawSpec(LAW, "iq"), make("iq")).law
    assert not analyse_law(record(scenario, LawSpec(LAW, "iq")), law.state_bounds(), WIRE).may_wrap
