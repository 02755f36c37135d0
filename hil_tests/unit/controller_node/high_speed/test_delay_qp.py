"""The law that is computed by a solver: what it refuses, its model of a coupled train, its constraints."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.bench import direct_run
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Problem
from railhil.controller_node.high_speed.train_model import (
    SUBSTEPS,
    CouplerModel,
    Prediction,
    TrainModel,
    UnitModel,
)
from railhil.controller_node.program.model import Evaluator
from railhil.controller_node.vector.controller import VectorController
from railhil.plant_sim.high_speed.train import HighSpeedTrain
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

pytest.importorskip("daqp", reason="MISSING CAPABILITY daqp")

PERIOD_S = 0.2


def spec(law: str = "delay_qp", arithmetic: str = "float64", **values: Any) -> LawSpec:
    return LawSpec(law, arithmetic, parameters=ParameterSet(law, values, Path("test.toml")) if values else None)


def ran(name: str, duration_s: int, *settings: str, **values: Any) -> Any:
    scenario = load_any(name, [f"task.duration_s={duration_s}", "task.rmse_max_kmh=9", *settings])
    return direct_run(scenario, RunSpec(law=spec(**values), seed=3))


def commands(run: Any) -> Any:
    """Command of the first unit in each control period, mm/s^2."""
    port = run.trace.contract.port("UNIT1_CMD")
    return run.trace.raw(port.name, port.signals[0].name)[::5]


@pytest.mark.parametrize("arithmetic", ["iq", "float32"])
def test_an_arithmetic_that_solves_nothing_is_refused_in_one_line(arithmetic: str) -> None:
    with pytest.raises(InputError, match=f"found '{arithmetic}', allowed float64: this law is computed by a solver"):
        VectorController(load_any("hst_short"), spec(arithmetic=arithmetic))


def test_without_the_solver_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "daqp", None)
    with pytest.raises(InputError, match=r"delay_qp: daqp is not installed.*daqp.*the extra \[qp\]"):
        VectorController(load_any("hst_short"), spec())


def test_one_loop_for_a_train_needs_couplers_and_a_law_that_has_it() -> None:
    with pytest.raises(InputError, match="loop: train on units that nothing connects, expected couplers"):
        VectorController(load_any("jinan_xuzhou_emu3"), spec(loop="train"))
    with pytest.raises(InputError, match="loop: found 'train', allowed one of unit, mean with pid"):
        VectorController(load_any("emu3_short"), spec("pid", loop="train"))


def test_a_horizon_within_the_delay_is_refused() -> None:
    with pytest.raises(InputError, match=r"horizon 5 \* sample_period_s 0.2 = 1 s, expected more than the longest"):
        VectorController(load_any("hst_short"), spec(horizon=5, control_horizon=2))


def test_the_recorded_program_contains_the_solution_as_one_operation() -> None:
    controller = VectorController(load_any("hst_short"), spec())
    assert controller.program.step_counts()["solve"] == 1
    problem = Problem("sums", 2, 2, lambda values: (values[0] + values[1], values[0] - values[1]))
    one, many = make("float64"), make("float64", batch=True)
    assert one.solve(problem, (3.0, 1.0)) == (4.0, 2.0)
    assert [row.tolist() for row in many.solve(problem, (np.array([3.0, 5.0]), 1.0))] == [[4.0, 6.0], [2.0, 4.0]]


def test_the_recorded_program_computes_what_the_law_computes() -> None:
    controller = VectorController(load_any("hst_short"), spec())
    raws = [1000, *range(1010, 1150, 10), 1000, 0]
    names = [name for name, _ in controller.program.inputs.inputs]
    evaluated = Evaluator(controller.program.inputs, controller.arithmetic)
    given = evaluated.run(dict(zip(names, raws, strict=True)))
    state = Evaluator(controller.program.start, controller.arithmetic).run(given)
    after = Evaluator(controller.program.step, controller.arithmetic).run(state | given)
    output = controller.step(raws)
    assert after["out.commands[0]"] == output.commands[0] != 0


def test_the_model_predicts_speed_and_coupler_forces_of_the_plant() -> None:
    """A rolling train without resistance, three different commands, and a delay that is no whole number of steps.

    The plant integrates in steps of 10 ms, so forces differ by some percent."""
    task: Any = load_any("emu3_short", ["task.davis_n_per_t=[0, 0, 0]", "task.gradient_permil=0",
                                        "task.wind_sigma_mps2=0"]).task  # fmt: skip
    units = list(task.unit)
    units[1] = units[1].model_copy(update={"traction_delay_s": 1.13})
    task = task.model_copy(update={"unit": tuple(units)})
    train = HighSpeedTrain(task, 1, 0.04)
    for unit in train.units:
        unit.motion = unit.motion._replace(speed_mps=10.0)
    masses_t = [mass_kg / 1000.0 for mass_kg in train.mass_kg]
    models = [
        UnitModel((unit.traction_delay_s, unit.braking_delay_s), unit.lag_s, mass_t)
        for unit, mass_t in zip(units, masses_t, strict=True)
    ]
    coupler = CouplerModel(task.coupler.stiffness_kn_per_m, task.coupler.damping_kn_per_mps)
    horizon = 15
    prediction = Prediction(TrainModel(models, coupler, PERIOD_S), horizon, 8)
    told = np.random.default_rng(5).uniform(0.1, 0.4, (3, horizon))
    weights = np.zeros((3, 2, 8 + horizon))
    weights[:, 0, 8:] = told
    flat = [part.reshape(weights.size, -1) for part in prediction.commands]
    speeds = weights.reshape(-1) @ flat[0]
    forces = (weights.reshape(-1) @ flat[1]).reshape(2, horizon * SUBSTEPS)
    for sample in range(horizon):
        train.commands_mps2 = told[:, sample].tolist()
        for _ in range(5):
            train.advance()
        mean = sum(unit.motion.speed_mps * mass_t for unit, mass_t in zip(train.units, masses_t, strict=True))
        assert mean / sum(masses_t) == pytest.approx(10.0 + speeds[sample], abs=2e-4), sample
        found_kn = [force_n / 1000.0 for force_n in train.couplers_n]
        assert found_kn == pytest.approx(forces[:, SUBSTEPS * sample + SUBSTEPS - 1], abs=0.6), sample
    assert np.abs(forces).max() > 10.0


@pytest.mark.slow
def test_the_jerk_limit_holds_in_every_command_but_not_in_an_emergency() -> None:
    # The first sample is free.
    steps = np.abs(np.diff(commands(ran("hst_short", 40, jerk_max_mps3=0.05))))[1:]
    assert steps.max() <= 11
    assert np.abs(np.diff(commands(ran("hst_short", 40))))[1:].max() > 11
    settings = ("task.emergency.at_km=204.2",)
    steps = np.diff(commands(ran("jinan_xuzhou_emergency", 20, *settings, jerk_max_mps3=0.05)))[1:]
    assert steps.min() < -100


@pytest.mark.long
@pytest.mark.slow
def test_the_limit_of_the_coupler_force_holds_without_losing_the_target() -> None:
    """Traction and braking that act against each other in the program would make it believe in forces that the train
    does not have: the error was 2.3 km/h then."""
    found = {most: ran("emu3_short", 40, loop="train", force_max_kn=most, force_weight=0).score.values
             for most in (1000, 2)}  # fmt: skip
    assert found[2]["coupler_peak_kn"] < 0.6 * found[1000]["coupler_peak_kn"]
    assert found[2]["rmse_kmh"] < 1.1 * found[1000]["rmse_kmh"]


def test_the_last_digits_of_a_constant_target_do_not_matter() -> None:
    """A plan of 0 is positive or negative by rounding, which differs between machines."""
    program = VectorController(load_any("hst_short"), spec()).law._programs[0]
    random = np.random.default_rng(1)
    found = []
    for _ in range(8):
        reference = 83.36 + random.uniform(-1e-13, 1e-13, 17)
        rest = np.zeros(program.problem.inputs - 17)
        # Speed, disturbance, gain.
        rest[:3] = 83.364, 0.0, 1.0
        found.append(program.problem.function([*reference, *rest])[0])
    assert np.ptp(found) < 1e-9


@pytest.mark.long
@pytest.mark.slow
def test_work_of_the_traction_can_cost() -> None:
    free, dear = (ran("hst_short", 40, energy_weight=weight).score.values for weight in (0.0, 0.005))
    assert dear["energy_kwh"] < free["energy_kwh"]
    assert dear["rmse_kmh"] > free["rmse_kmh"]


def test_what_was_really_sent_is_what_the_program_knows() -> None:
    controller = VectorController(load_any("emu3_short"), spec(loop="train"))
    raws = [1000, 1000, 1000, *range(1010, 1150, 10), 1000, 0]
    controller.step(raws)
    controller.sent(100, 1, 200, 1, 300, 1)
    assert [own[0] for own in controller.state.loops[0].commands] == pytest.approx([0.1, 0.2, 0.3])


@pytest.mark.slow
def test_runs_together_are_the_runs_alone() -> None:
    pytest.importorskip("numba", reason="MISSING CAPABILITY numba")
    from railhil.batch.case import Case
    from railhil.batch.coupled import run_coupled
    from railhil.systems.high_speed.batch import run_high_speed

    case = Case(load_any("emu3_short", ["task.start_s=3440", "task.duration_s=12"]), spec(loop="train"))
    together, alone = run_high_speed(case, [3, 4]), run_coupled(case, [3, 4])
    assert together.digest == alone.digest
    assert [one.values for one in together.scores] == [one.values for one in alone.scores]
