"""Laws without fixed-point formats as C in single precision: every word of inputs, state and outputs is Python's."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from railhil.bench import coupled_run
from railhil.controller_node.export import make_bundle, write_bundle
from railhil.controller_node.export.control import FLAG_BEGIN
from railhil.controller_node.vector.controller import VectorController
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

pytestmark = [pytest.mark.needs_compiler, pytest.mark.slow]

#: An emergency braking from 270 km/h: traction, cruise and braking to a standstill.
EMERGENCY = (
    "task.start_s=2735",
    "task.duration_s=120",
    "task.emergency.at_km=210",
    "task.emergency.high_kmh=300",
    "task.emergency.low_kmh=120",
    "task.emergency.at_high_mps2=0.62",
    "task.emergency.at_low_mps2=1.0",
)
#: Largest difference of a command between float32 and float64, m/s2 (specification, section 5).
COMMAND_MPS2 = 1e-4


@pytest.fixture(scope="module")
def scenario() -> AnyScenario:
    return load_any("jinan_xuzhou", EMERGENCY)


@pytest.fixture(scope="module")
def readings(scenario: AnyScenario) -> list[tuple[int, ...]]:
    """What a law reads in its run, one tuple for each control period."""
    law = LawSpec("elm_ngpc", "float32")
    controller = VectorController(scenario, law)
    read: list[tuple[int, ...]] = []

    def step(raws: Sequence[int]) -> Any:
        read.append(tuple(raws))
        return controller.step(raws)

    coupled_run(scenario, step, RunSpec(law=law, seed=4))
    return read


def make_check(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """The host program recomputes the log."""
    return subprocess.run(["make", "-s", "check", *words], cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.long
@pytest.mark.parametrize(("name", "compiler"), [("elm_ngpc", "gcc"), ("os_elm_ngpc", "clang")])
def test_every_word_of_a_run_is_that_of_float32(
    scenario: AnyScenario, tmp_path: Path, name: str, compiler: str
) -> None:
    law = LawSpec(name, "float32")
    spec = RunSpec(law=law, seed=4)
    bundle = make_bundle(scenario, law, lambda controller: coupled_run(scenario, controller.step, spec))
    write_bundle(bundle, tmp_path)
    lines = bundle.files[f"{name}_log.txt"].splitlines()
    rows = [line.split() for line in lines if not line.startswith("#")]
    _, end, *_ = [at for at, row in enumerate(rows) if int(row[0], 16) & FLAG_BEGIN]
    done = make_check(tmp_path, f"CC={compiler}")
    assert done.stdout.startswith(f"{len(rows)} control periods identical"), done.stdout + done.stderr
    gain = next(line for line in lines if line.startswith("# flags ")).split()[1:].index("out.gain")
    # The projection has changed the model, or there is none in this law.
    assert (len({row[gain] for row in rows[:end]}) > 5) == (name == "elm_ngpc")


def test_commands_in_single_precision_are_those_of_double_precision(
    scenario: AnyScenario, readings: list[tuple[int, ...]]
) -> None:
    single = VectorController(scenario, LawSpec("elm_ngpc", "float32"))
    double = VectorController(scenario, LawSpec("elm_ngpc", "float64"))
    largest = 0.0
    for raws in readings:
        single.step(raws)
        double.step(raws)
        ours, theirs = (one.state.held[0].accel for one in (single, double))
        largest = max(largest, abs(ours - theirs))
    assert 0.0 < largest <= COMMAND_MPS2


def test_the_shipped_log_is_recomputed(scenario: AnyScenario, tmp_path: Path) -> None:
    write_bundle(make_bundle(scenario, LawSpec("elm_ngpc", "float32")), tmp_path)
    done = make_check(tmp_path)
    assert done.returncode == 0, done.stderr
    log = tmp_path / "elm_ngpc_log.txt"
    lines = log.read_text().splitlines()
    lines[-1] = lines[-1][:-1] + ("0" if lines[-1][-1] != "0" else "1")
    log.write_text("\n".join(lines) + "\n")
    assert make_check(tmp_path).returncode != 0


def test_parameters_are_in_the_export(scenario: AnyScenario) -> None:
    off = ParameterSet("elm_ngpc", {"ident": "off"}, Path("off.toml"))
    with_, without = (
        make_bundle(scenario, LawSpec("elm_ngpc", "float32", parameters=given)).source for given in (None, off)
    )
    assert len(without.columns) < len(with_.columns)
