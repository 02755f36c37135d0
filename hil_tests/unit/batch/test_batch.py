"""The batch gives the runs of the bench: notch codes, readings, scores and failures to the last digit."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.plug import plug_in
from railhil.batch import Case, run_batch, say_compiling, trace_digest
from railhil.batch.compiled import FUNCTIONS, Kept
from railhil.batch.engine import Engine
from railhil.batch.nodes import batch_of
from railhil.batch.noise import standard_noise
from railhil.batch.perturbed_runs import FIRST_SEED, outcomes
from railhil.bench import coupled_run, direct_run, local_run, unrecorded_run
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.controller import Controller
from railhil.controller_node.laws.ipfc import Ipfc
from railhil.controller_node.loop import ControlLoop
from railhil.controller_node.program.tracer import Tracer
from railhil.plant_sim.sensors import AxleSensors
from railhil.scenarios.load import load, load_any
from railhil.scenarios.model import Balise, Effort, Scenario, Uniform
from railhil.scenarios.run_spec import LawSpec, RunSpec

SCENARIOS = (
    "lvshun_tieshan",
    "lvshun_tieshan_worn_wheels",
    "yizhuang_01_songjiazhuang_xiaocun",
    "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan",
)
#: Arithmetic, indexing and the seeds that are run with them: each scenario meets eight seeds.
WAYS = (
    ("float64", "time", (0, 1)),
    ("float64", "distance", (3,)),
    ("iq", "time", (5, 6)),
    ("iq", "distance", (7,)),
    ("float32", "time", (9,)),
    ("float32", "distance", (11,)),
)


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return load(str(path))


def same_as_the_bench(case: Case, seeds: tuple[int, ...]) -> list[Any]:
    """Assert that a batch is what single runs are; returns their scores."""
    batch = run_batch(case, seeds)
    for i, seed in enumerate(seeds):
        run = direct_run(case.scenario, case.run(seed))
        assert batch.notch_digest[i] == trace_digest(case.scenario, run.trace), f"seed {seed}: notch codes"
        assert batch.scores[i] == run.score, f"seed {seed}"
        assert batch.wraps[i] == run.arithmetic.wraps
        assert batch.saturations[i] == run.arithmetic.saturations
        assert batch.zero_divisions[i] == run.arithmetic.zero_divisions
    return list(batch.scores)


@pytest.mark.slow
@pytest.mark.parametrize(("arithmetic", "indexing", "seeds"), WAYS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_a_batch_is_what_single_runs_are(name, arithmetic, indexing, seeds):
    same_as_the_bench(Case(load(name), LawSpec(arithmetic=arithmetic, indexing=indexing)), seeds)


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


def test_runs_with_an_emergency_brake_are_those_of_the_nodes(tmp_path):
    """Behind the brake the controller's watch answers, not its law."""
    case = Case(braked(), LawSpec(arithmetic="iq"))
    batch = run_batch(case, (21, 22), keep_notches=True)
    nodes = local_run(case.scenario, tmp_path, RunSpec(law=LawSpec(arithmetic="iq"), seed=21, perturbed=True))
    assert any("emergency brake at" in text for text in batch.failures[0])
    assert batch.scores[0] == nodes.score
    assert batch.notch_digest[0] == trace_digest(case.scenario, nodes.trace)
    assert -1792 in batch.notch_codes[0]


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


def test_a_mismatch_from_the_start_is_computed_like_in_the_nodes(tmp_path):
    """Mass, gradient and resistance with values drawn for each seed."""
    case = Case(with_faults(tmp_path, *CONSTANT_FAULTS), LawSpec(arithmetic="float64"))
    healthy = run_batch(replace(case, scenario=with_faults(tmp_path)), (1, 2))
    batch = run_batch(case, (1, 2))
    assert set(batch.notch_digest).isdisjoint(healthy.notch_digest)
    for i, seed in enumerate((1, 2)):
        nodes = unrecorded_run(case.scenario, case.run(seed))
        assert batch.notch_digest[i] == trace_digest(case.scenario, nodes.trace)
        assert batch.scores[i] == nodes.score
    assert len(same_as_the_bench(replace(case, perturbed=False), (3,))) == 1


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
    found, healthy = (outcomes(scenario, 1, case.law).scores[0] for scenario in (case.scenario, with_faults(tmp_path)))
    assert found == unrecorded_run(case.scenario, Case(case.scenario, case.law).run(FIRST_SEED)).score
    assert found != healthy


def test_speed_that_is_sent_less_often_than_notches_are_asked_for_is_refused():
    scenario = load("yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan")
    slow = replace(scenario, timing=replace(scenario.timing, port_period_ns={"TRN_SPEED": 40_000_000}))
    for run in (lambda: run_batch(Case(slow), [1]), lambda: direct_run(slow)):
        with pytest.raises(InputError, match="TRN_SPEED every 4 ticks, NOTCH_CMD polled every 2"):
            run()


@pytest.mark.slow
def test_a_damaged_cache_is_no_harm(short, tmp_path):
    """A process was killed while it wrote machine code: the next one compiles anew and says nothing."""
    here = run_batch(Case(short), [3])
    home = Path(os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    for folder in (home / "railhil").glob("batch-*"):
        shutil.copytree(folder, tmp_path / "railhil" / folder.name)
    files = list((tmp_path / "railhil").rglob("*.nb?"))
    assert files
    for i, path in enumerate(files):
        path.write_bytes(path.read_bytes()[: 40 * (i % 2)])
    (tmp_path / "quick.toml").write_text(QUICK_TOML)
    code = (
        "from railhil.batch import Case, run_batch; from railhil.scenarios.load import load;"
        f"print(run_batch(Case(load({str(tmp_path / 'quick.toml')!r})), [3]).notch_digest[0])"
    )
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_DIR": ""}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    assert (done.stdout.strip(), done.stderr) == (here.notch_digest[0], "")


def test_the_compiled_loop_is_what_the_interpreter_makes_of_it(short, tmp_path):
    """So that a debugger can step through it."""
    here = [
        run_batch(Case(short, LawSpec(arithmetic="float64", indexing=indexing)), [3])
        for indexing in ("time", "distance")
    ]
    (tmp_path / "quick.toml").write_text(QUICK_TOML)
    code = (
        "from railhil.batch import Case, run_batch; from railhil.scenarios.load import load;"
        "from railhil.scenarios.run_spec import LawSpec;"
        f"short = load({str(tmp_path / 'quick.toml')!r});"
        "laws = [LawSpec('ipfc', 'float64', indexing) for indexing in ('time', 'distance')];"
        "runs = [run_batch(Case(short, law), [3]) for law in laws];"
        "print([(run.notch_digest, run.scores) for run in runs])"
    )
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    assert done.stdout.strip() == str([(run.notch_digest, run.scores) for run in here])


def test_an_unperturbed_batch_differs_in_its_noise_only(short):
    scores = same_as_the_bench(Case(short, LawSpec(arithmetic="iq"), perturbed=False), (1, 2))
    assert abs(scores[0].values["energy_kj"] - scores[1].values["energy_kj"]) < 0.05 * scores[0].values["energy_kj"]


def test_the_law_is_given_what_the_bench_gives_it():
    """Speed, odometer and last balise of each period, with worn wheels and balises that lie beside their survey."""
    scenario = load("lvshun_tieshan_worn_wheels")
    balises = tuple(Balise(i + 1, 100.0 * i, 100.0 * i) for i in range(30))
    close = (Balise(40, 600.02, 600.02), Balise(41, 600.03, 600.03))
    scenario = replace(scenario, line=replace(scenario.line, balises=(*close, *balises)))
    seeds = (1, 2, 3)
    alone: dict[int, list[tuple[Any, ...]]] = {}
    for seed in seeds:
        law, given = Controller(scenario, LawSpec("ipfc", "float64")), []

        def step(*values, law=law, given=given):
            given.append((*values[:3], *values[3]))
            return law.step(*values).notch_code

        coupled_run(scenario, step, RunSpec(seed=seed, perturbed=True))
        alone[seed] = given
    together: list[tuple[Any, ...]] = []

    class Noting(ControlLoop):
        def step(self, k, speed, position, balise):
            together.append((np.full(len(seeds), k), speed.copy(), position.copy(), *(part.copy() for part in balise)))
            return super().step(k, speed, position, balise)

    Engine(Case(scenario), Noting(scenario, LawSpec(), make("float64", batch=True))).run(seeds)
    for i, seed in enumerate(seeds):
        assert len(alone[seed]) > 380
        assert [tuple(int(part[i]) for part in row) for row in together[: len(alone[seed])]] == alone[seed]
        assert len({row[3] for row in alone[seed]}) > 25


@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
def test_a_batch_is_what_a_run_through_the_telegrams_is(short, tmp_path, arithmetic):
    batch = run_batch(Case(short, LawSpec(arithmetic=arithmetic, indexing="distance")), [5], keep_notches=True)
    run = local_run(
        short, tmp_path, RunSpec(law=LawSpec(arithmetic=arithmetic, indexing="distance"), seed=5, perturbed=True)
    )
    assert batch.notch_digest[0] == trace_digest(short, run.trace)
    assert batch.scores[0] == run.score
    assert np.array_equal(np.repeat(batch.notch_codes[0], 25)[: len(run.notches)], run.notches)


def test_runs_do_not_depend_on_their_company(short):
    """Any order, any chunk; the result is in the order of the seeds."""
    case = Case(short, LawSpec(arithmetic="iq"))
    seeds = [3, 70, 5, 11, 4, 70, 8]
    whole = run_batch(case, seeds)
    parts = run_batch(case, seeds, chunk=2)
    assert whole.scores == parts.scores
    assert whole.notch_digest == parts.notch_digest
    assert whole.seed.tolist() == seeds
    assert whole.scores[1] == whole.scores[5]
    assert len(set(whole.notch_digest)) == 6
    single = run_batch(case, [11])
    assert single.scores[0] == whole.scores[3]


def test_no_seeds_give_an_empty_result(short):
    result = run_batch(Case(short), [])
    assert result.values["itae"].shape == result.wraps.shape == (0,)
    assert result.scores == ()


def test_arrays_say_what_the_scores_say(short):
    never = replace(short, plan=replace(short.plan, running_time_s=3.0, overtime_max_s=0.0))
    for scenario in (short, never):
        result = run_batch(Case(scenario), [1, 2])
        for part in ("values", "signed"):
            for name, found in getattr(result, part).items():
                values = [getattr(score, part)[name] for score in result.scores]
                expected = [np.nan if value is None else value for value in values]
                assert np.array_equal(found, expected, equal_nan=True)
        assert result.extras["overspeed_mps"].tolist() == [score.extras["overspeed_mps"] for score in result.scores]
        assert result.passed.tolist() == [score.verdict == "PASS" for score in result.scores]
        assert result.failures == tuple(score.failures for score in result.scores)
    assert np.isnan(result.values["stop_error_m"]).all()
    assert result.ended == ("ended_not_stopped",) * 2


class Wrapping(Ipfc):
    """The law, with a product that wraps above 3 km/h; its record does not show it, else it would not start."""

    def step(self, state, inputs):
        ar = self._ar
        if not isinstance(ar, Tracer):
            fast = ar.gt(inputs.speed, ar.const(Constant("limit", 3.0, 20)))
            big = ar.where(fast, ar.const(Constant("x", 1.5, 30)), ar.const(Constant("y", 0.5, 30)))
            ar.mpy(big, big, 30)
        return super().step(state, inputs)


def test_a_wrap_belongs_to_the_run_in_which_it_was(short, tmp_path, monkeypatch):
    """Late in a run, and not after its end, though the batch goes on."""
    plug_in(tmp_path, monkeypatch, wrapping=Wrapping)
    batch = run_batch(Case(short, LawSpec("wrapping", "iq")), range(4))
    for seed in range(4):
        alone = direct_run(short, RunSpec(law=LawSpec("wrapping"), seed=seed, perturbed=True))
        assert batch.wraps[seed] == alone.arithmetic.wraps > 0
    run = local_run(short, tmp_path, RunSpec(law=LawSpec("wrapping"), seed=2, perturbed=True))
    assert batch.scores[2] == run.score
    assert "fixed-point wrap in the controller, reported at" in batch.failures[2][-1]


def test_noise_is_that_of_the_sensors():
    """Across several blocks of the sensor's own drawing, and again from what was kept."""
    ticks = np.array([0, 1, 4095, 4096, 9000, 12_289])
    for _ in range(2):
        found = standard_noise([4, 9], ticks)
        for column, seed in enumerate((4, 9)):
            sensors = AxleSensors(replace(load("lvshun_tieshan").sensors, speed_noise_sigma_mps=1.0), seed)
            noise = [sensors.noise_mps]
            for tick in range(1, 12_290):
                sensors.begin_tick(tick)
                noise.append(sensors.noise_mps)
            assert found[:, column].tolist() == [noise[tick] for tick in ticks]


def test_without_numba_one_line_says_what_to_install(short, monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    for name in ("compiled", "kernel", "engine"):
        monkeypatch.delitem(sys.modules, f"railhil.batch.{name}", raising=False)
        monkeypatch.delattr(f"railhil.batch.{name}", raising=False)
    with pytest.raises(InputError, match=r"^batch: module numba.*: found not installed, allowed .* -m pip install "):
        run_batch(Case(short), [1])


#: Runs in which the train creeps so slowly before it stands that its position, thousands of metres from 0, no longer
#: grows in the last step.
CREEPING = (
    ("lvshun_tieshan", "ipfc", "float64", 1416),
    ("lvshun_tieshan", "ipfc_plus", "float64", 2173),
    ("lvshun_tieshan_worn_wheels", "ipfc_plus", "iq", 69739),
    ("lvshun_tieshan", "tpfc1", "float64", 1125),
)


@pytest.mark.parametrize(("name", "law", "arithmetic", "seed"), CREEPING)
def test_a_train_that_creeps_to_a_stand_has_stopped(name, law, arithmetic, seed):
    (found,) = same_as_the_bench(Case(load(name), LawSpec(law, arithmetic)), (seed,))
    assert found.ended == "ended_complete"
    assert found.values["stop_error_m"] is not None
    assert not any("not stopped" in text for text in found.failures)


def test_compiling_is_said_before_it_begins_and_only_then(tmp_path, monkeypatch):
    said: list[str] = []
    functions = [Kept("run_period", tmp_path, True)]
    monkeypatch.setattr("railhil.batch.compiled.FUNCTIONS", functions)
    say_compiling(said.append)
    assert said == ["compiling the batch of trains (once for this machine; up to a minute) ..."]
    (tmp_path / "batch_x").mkdir()
    (tmp_path / "batch_x" / "kernel.run_period-236.py311.nbi").touch()
    say_compiling(said.append)
    assert len(said) == 1
    functions.append(Kept("stand_to_the_end", Path("/proc/none"), False))
    say_compiling(said.append)
    assert "in every process, as /proc/none cannot be written" in said[1]


def test_what_was_compiled_is_found_again(short):
    run_batch(Case(short), [1])
    assert all(function.is_there for function in FUNCTIONS if function.kept)
