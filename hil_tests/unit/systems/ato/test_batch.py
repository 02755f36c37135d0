"""The batch gives the runs of the bench: notch codes, readings, scores and failures to the last digit."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.batch import same_as_the_bench
from hil_tests.support.plug import plug_in
from railhil.batch import Case, say_compiling
from railhil.batch.compiled import FUNCTIONS, Kept
from railhil.bench import coupled_run, direct_run, local_run
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.program.tracer import Tracer
from railhil.plant_sim.ato.plant_readings import AxleSensors
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.streams import chain_of
from railhil.systems.ato.batch import kernel, run_batch
from railhil.systems.ato.batch.engine import Engine
from railhil.systems.ato.batch.lanes import LANES
from railhil.systems.ato.batch.noise import standard_noise
from railhil.systems.ato.batch.replay import trace_digest
from railhil.systems.ato.scenario.model import Balise

SCENARIOS = (
    "lvshun_tieshan",
    "lvshun_tieshan_worn_wheels",
    "yizhuang_02_xiaocun_xiaohongmen",
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


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(("arithmetic", "indexing", "seeds"), WAYS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_a_batch_is_what_single_runs_are(name, arithmetic, indexing, seeds):
    same_as_the_bench(Case(load(name), LawSpec(arithmetic=arithmetic, indexing=indexing)), seeds)


def test_speed_that_is_sent_less_often_than_notches_are_asked_for_is_refused():
    scenario = load("yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan")
    slow = replace(scenario, timing=replace(scenario.timing, port_period_ns={"TRN_SPEED": 40_000_000}))
    for run in (lambda: run_batch(Case(slow), [1]), lambda: direct_run(slow)):
        with pytest.raises(InputError, match="TRN_SPEED every 4 ticks, NOTCH_CMD polled every 2"):
            run()


#: A program whose one function keeps its machine code as the loops of the batch do; they take longer to compile.
_KEPT = """
from railhil.batch.compiled import cached


@cached(__file__)
def tripled(number):
    return 3 * number


print(tripled(14))
"""


@pytest.mark.long
@pytest.mark.slow
def test_a_damaged_cache_is_no_harm(tmp_path):
    """A process was killed while it wrote machine code: the next one compiles anew and says nothing."""
    program = tmp_path / "program.py"
    program.write_text(_KEPT)
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_DIR": ""}

    def said() -> tuple[str, str]:
        words = [sys.executable, str(program)]
        done = subprocess.run(words, capture_output=True, text=True, env=environment, check=True)
        return done.stdout, done.stderr

    for kept in (0, 40):
        assert said() == ("42\n", "")
        files = sorted((tmp_path / "railhil").rglob("*.nb?"))
        assert [path.suffix for path in files] == [".nbc", ".nbi"]
        damaged = files[kept > 0]
        damaged.write_bytes(damaged.read_bytes()[:kept])
        assert said() == ("42\n", ""), damaged


_COMPILED = """
import sys
from pathlib import Path

from numba.core.event import install_recorder

from railhil.batch.compiled import cached


@cached(__file__)
def tripled(number):
    return 3 * number


Path(sys.argv[1]).touch()
while not Path(sys.argv[2]).exists():
    pass
with install_recorder("numba:compile") as seen:
    assert tripled(14) == 42
print(sum(event.is_start and event.data["dispatcher"].__name__ == "tripled" for _, event in seen.buffer))
"""


@pytest.mark.slow
def test_of_processes_that_need_a_function_one_compiles_it(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(_COMPILED)
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_DIR": ""}
    processes = [
        subprocess.Popen(
            [sys.executable, program, tmp_path / me, tmp_path / other], stdout=subprocess.PIPE, env=environment
        )
        for me, other in (("a", "b"), ("b", "a"))
    ]
    said = sorted(process.communicate(timeout=100)[0] for process in processes)
    assert [process.returncode for process in processes] == [0, 0]
    assert said == [b"0\n", b"1\n"]


@pytest.mark.long
@pytest.mark.slow
def test_the_compiled_loop_is_what_the_interpreter_makes_of_it(short, tmp_path):
    """So that a debugger can step through it."""
    here = [
        run_batch(Case(short, LawSpec(arithmetic="float64", indexing=indexing)), [3])
        for indexing in ("time", "distance")
    ]
    (tmp_path / "quick.toml").write_text(QUICK_TOML)
    code = (
        "from railhil.batch import Case; from railhil.systems.ato.batch import run_batch;"
        "from railhil.scenarios.load import load;"
        "from railhil.scenarios.run_spec import LawSpec;"
        f"short = load({str(tmp_path / 'quick.toml')!r});"
        "laws = [LawSpec('ipfc', 'float64', indexing) for indexing in ('time', 'distance')];"
        "runs = [run_batch(Case(short, law), [3]) for law in laws];"
        "print([(run.digest, run.scores) for run in runs])"
    )
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    assert done.stdout.strip() == str([(run.digest, run.scores) for run in here])


@pytest.mark.slow
def test_an_unperturbed_batch_differs_in_its_noise_only(short):
    scores = same_as_the_bench(Case(short, LawSpec(arithmetic="iq"), perturbed=False), (1, 2))
    assert abs(scores[0].values["energy_kj"] - scores[1].values["energy_kj"]) < 0.05 * scores[0].values["energy_kj"]


@pytest.mark.slow
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


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
def test_a_batch_is_what_a_run_through_the_telegrams_is(short, tmp_path, arithmetic):
    batch = run_batch(Case(short, LawSpec(arithmetic=arithmetic, indexing="distance")), [5], keep_notches=True)
    run = local_run(
        short, tmp_path, RunSpec(law=LawSpec(arithmetic=arithmetic, indexing="distance"), seed=5, perturbed=True)
    )
    assert batch.digest[0] == trace_digest(short, run.trace)
    assert batch.scores[0] == run.score
    assert np.array_equal(np.repeat(batch.commands[0], 25)[: len(run.commands("notch"))], run.commands("notch"))


def test_runs_do_not_depend_on_their_company(short):
    """Any order, any chunk; the result is in the order of the seeds."""
    case = Case(short, LawSpec(arithmetic="iq"))
    seeds = [3, 70, 5, 11, 4, 70, 8]
    whole = run_batch(case, seeds)
    parts = run_batch(case, seeds, chunk=2)
    assert whole.scores == parts.scores
    assert whole.digest == parts.digest
    assert whole.seed.tolist() == seeds
    assert whole.scores[1] == whole.scores[5]
    assert len(set(whole.digest)) == 6
    single = run_batch(case, [11])
    assert single.scores[0] == whole.scores[3]


def test_trains_of_two_blocks_are_what_they_are_alone(short):
    """A block has 64 lanes; the last one of this batch is nearly empty."""
    case = Case(short, LawSpec(arithmetic="float64"))
    seeds = range(LANES + 2)
    whole = run_batch(case, seeds)
    for seed in (0, LANES - 1, LANES, LANES + 1):
        single = run_batch(case, [seed])
        assert (single.scores[0], single.digest[0]) == (whole.scores[seed], whole.digest[seed])


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
    """Bit by bit, in every order, across several blocks of the sensor's own drawing."""
    sensors = replace(load("lvshun_tieshan").sensors, speed_noise_sigma_mps=1.0)
    ticks = np.array([0, 1, 4095, 4096, 9000, 12_289, *range(20_000, 21_000)])
    found = standard_noise([chain_of(4), chain_of(9)], ticks)
    assert abs(found).max() > 2.0
    for column, seed in enumerate((4, 9)):
        forth, back = AxleSensors(sensors, seed), AxleSensors(sensors, seed)
        assert found[:, column].tolist() == [forth.noise_mps(tick) for tick in ticks.tolist()]
        assert found[::-1, column].tolist() == [back.noise_mps(tick) for tick in ticks[::-1].tolist()]


def test_without_numba_one_line_says_what_to_install(short, monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    for name in ("batch.compiled", "systems.ato.batch.kernel", "systems.ato.batch.engine"):
        monkeypatch.delitem(sys.modules, f"railhil.{name}", raising=False)
        monkeypatch.delattr(f"railhil.{name}", raising=False)
    with pytest.raises(InputError, match=r"^railhil.batch: numba is not installed; install it with .* -m pip install "):
        run_batch(Case(short), [1])


#: Runs in which the train creeps so slowly before it stands that its position, thousands of metres from 0, no longer
#: grows in the last step.
CREEPING = (
    ("lvshun_tieshan", "ipfc", "float64", 1416),
    ("lvshun_tieshan", "ipfc_plus", "float64", 2173),
    ("lvshun_tieshan_worn_wheels", "ipfc_plus", "iq", 69739),
    ("lvshun_tieshan", "tpfc1", "float64", 1125),
)


@pytest.mark.long_after(1)
@pytest.mark.slow
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
    say_compiling(said.append, kernel.__name__)
    assert said == ["compiling the batch of trains (once for this machine; up to a minute) ..."]
    (tmp_path / "batch_x").mkdir()
    (tmp_path / "batch_x" / "kernel.run_period-236.py311.nbi").touch()
    say_compiling(said.append, kernel.__name__)
    assert len(said) == 1
    functions.append(Kept("stand_to_the_end", Path("/proc/none"), False))
    say_compiling(said.append, kernel.__name__)
    assert "in every process, as /proc/none cannot be written" in said[1]


def test_what_was_compiled_is_found_again(short):
    run_batch(Case(short), [1])
    # Other systems' loops may be registered in this process too.
    own = [function for function in FUNCTIONS if hasattr(kernel, function.name) and function.kept]
    assert own
    assert all(function.is_there for function in own)
