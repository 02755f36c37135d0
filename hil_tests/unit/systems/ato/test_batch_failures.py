"""Batches of runs that go wrong or have faults are the runs of the bench, too."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.batch import same_as_the_bench
from railhil.batch import Case
from railhil.batch.nodes import batch_of
from railhil.bench import direct_run, local_run, unrecorded_run
from railhil.common.errors import InputError
from railhil.scenarios.load import load, load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.study.perturbed_runs import FIRST_SEED, run_seeds
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.batch.replay import trace_digest
from railhil.systems.ato.scenario.model import Effort, Scenario, Uniform


def braked() -> Scenario:
    """A limit in the middle of the line that the target curve does not know: the train's watch brakes."""
    scenario = load("lvshun_tieshan")
    line = replace(scenario.line, speed_limit_mps=((0.0, 65 / 3.6), (300.0, 30 / 3.6), (900.0, 65 / 3.6)))
    return replace(scenario, line=line)


def unstopped() -> Scenario:
    """The timetable is over while the train is under way."""
    scenario = load("lvshun_tieshan")
    return replace(scenario, plan=replace(scenario.plan, running_time_s=100.0, overtime_max_s=3.5))


def late() -> Scenario:
    """A grade that takes most of the traction, under a train whose commands act after more than a control period."""
    scenario = load("lvshun_tieshan")
    line = replace(scenario.line, grade_permil=((-200.0, 70.0), (400.0, -10.0)))
    timing = replace(scenario.timing, loop_delay_s=1.3)
    disturbed = replace(scenario.perturbations, loop_delay_s=Uniform(0.6, 1.4))
    return replace(scenario, line=line, timing=timing, perturbations=disturbed)


def weak() -> Scenario:
    """The train never moves at all."""
    scenario = load("lvshun_tieshan")
    plan = replace(scenario.plan, running_time_s=30.0, overtime_max_s=0.0)
    traction = Effort(2000.0, None, ((0.0, 2000.0), (5.0, 1000.0)))
    return replace(scenario, plan=plan, train=replace(scenario.train, traction=traction))


def rolling() -> Scenario:
    """A brake that fades at low speed and at high power: the train stops late."""
    scenario = load("yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan")
    brake = Effort(240_000.0, 3e6, ((0.0, 60_000.0), (3.0, 240_000.0)))
    return replace(scenario, train=replace(scenario.train, brake=brake))


def other_periods() -> Scenario:
    """Ports and control at other periods, the position rarely; a watch that is tight against the polls."""
    scenario = load("yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan")
    timing = replace(
        scenario.timing,
        control_period_ns=300_000_000,
        port_period_ns={"SIM_TRUTH": 40_000_000, "TRN_POS": 160_000_000, "NOTCH_CMD": 80_000_000},
    )
    return replace(scenario, timing=timing, watch=replace(scenario.watch, hold_ms=20, traction_cut_ms=100))


def starved() -> Scenario:
    """Commands that come too seldom for the train's watch: traction cut and service brake until the next one."""
    scenario = load("yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan")
    timing = replace(scenario.timing, port_period_ns={"NOTCH_CMD": 640_000_000})
    plan = replace(scenario.plan, running_time_s=20.0, overtime_max_s=0.0)
    watch = replace(scenario.watch, traction_cut_ms=300, service_brake_ms=400)
    return replace(scenario, timing=timing, plan=plan, watch=watch)


def ended() -> Scenario:
    """An end of authority with so flat a curve that the train passes it."""
    scenario = load("lvshun_tieshan")
    watch = replace(scenario.watch, end_of_authority=True, end_of_authority_braking_mps2=0.3)
    return replace(scenario, watch=watch)


def unanswered() -> Scenario:
    """A watch that wants all of the demanded deceleration, on a line that takes some of it."""
    scenario = load("lvshun_tieshan")
    line = replace(scenario.line, grade_permil=((0.0, -15.0),))
    watch = replace(scenario.watch, brake_share_min_percent=100.0, grade_allowance_permil=0.0)
    return replace(scenario, line=line, watch=watch)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (unstopped, "not stopped 3.5 s after the timetable"),
        (late, "time error"),
        (weak, "not stopped 0 s after the timetable"),
        (rolling, "stop error"),
        (other_periods, ""),
        (starved, ""),
        (ended, "emergency brake at"),
        (unanswered, "emergency brake at"),
    ],
)
def test_runs_that_go_wrong_are_the_same_too(make, expected):
    scenario = make()
    scores = same_as_the_bench(Case(scenario), (21, 22))
    assert all(any(expected in text for text in score.failures) for score in scores) or not expected
    same_as_the_bench(Case(scenario, LawSpec(arithmetic="float64", indexing="distance")), (21,))


@pytest.mark.slow
def test_runs_with_an_emergency_brake_are_those_of_the_nodes(tmp_path):
    """Behind the brake the controller's watch answers, not its law."""
    case = Case(braked(), LawSpec(arithmetic="iq"))
    batch = run_batch(case, (21, 22), keep_notches=True)
    nodes = local_run(case.scenario, tmp_path, RunSpec(law=LawSpec(arithmetic="iq"), seed=21, perturbed=True))
    assert any("emergency brake at" in text for text in batch.failures[0])
    assert batch.scores[0] == nodes.score
    assert batch.digest[0] == trace_digest(case.scenario, nodes.trace)
    assert -1792 in batch.commands[0]


CONSTANT_FAULTS = (
    "mass scale uniform(0.8,1.2) @0s",
    "gradient scale 1.5 @0s combine",
    "gradient offset normal(0,2) @0s combine",
    "resistance scale 1.3 @0s",
)


def with_faults(folder: Path, *faults: str) -> Scenario:
    path = folder / "short.toml"
    path.write_text(QUICK_TOML)
    return load_any(str(path), (), faults)


@pytest.mark.slow
def test_a_mismatch_from_the_start_is_computed_like_in_the_nodes(tmp_path):
    """Mass, gradient and resistance with values drawn for each seed."""
    case = Case(with_faults(tmp_path, *CONSTANT_FAULTS), LawSpec(arithmetic="float64"))
    healthy = run_batch(replace(case, scenario=with_faults(tmp_path)), (1, 2))
    batch = run_batch(case, (1, 2))
    assert set(batch.digest).isdisjoint(healthy.digest)
    for i, seed in enumerate((1, 2)):
        nodes = unrecorded_run(case.scenario, case.run(seed))
        assert batch.digest[i] == trace_digest(case.scenario, nodes.trace)
        assert batch.scores[i] == nodes.score
    assert len(same_as_the_bench(replace(case, perturbed=False), (3,))) == 1


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    "fault",
    ["speed offset 0.2 @2s", "brake weak 60% @0s", "mass scale 1.3 @3s", "mass scale 1.3 @0s for 2s"],
)
def test_runs_with_other_faults_go_through_the_nodes(tmp_path, fault):
    case = Case(with_faults(tmp_path, fault), LawSpec(arithmetic="float64"), perturbed=False)
    assert batch_of(case.scenario) is None
    assert batch_of(with_faults(tmp_path, *CONSTANT_FAULTS)) is not None
    for run in (lambda: run_batch(case, (4,)), lambda: direct_run(case.scenario)):
        with pytest.raises(InputError, match="other faults need the nodes"):
            run()
    found, healthy = (
        run_seeds(scenario, case.law, [FIRST_SEED]).scores[0] for scenario in (case.scenario, with_faults(tmp_path))
    )
    assert found == unrecorded_run(case.scenario, Case(case.scenario, case.law).run(FIRST_SEED)).score
    assert found != healthy
