"""``--plant-fmu`` in the other systems, and runs with an FMU made again, replayed, and found not to be repeatable."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support import fmus
from hil_tests.support.cli import Railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.errors import InputError
from railhil.plant_sim.faults.plants import make_plant
from railhil.plant_sim.fmu import plant_twice
from railhil.scenarios.plant_fmu import PlantFmu
from railhil.scenarios.run_spec import RunSpec

pytestmark = pytest.mark.needs_compiler


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmus.compiled_train(tmp_path_factory.mktemp("library"))


@pytest.fixture(scope="module")
def unit(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The motion of a unit of a high-speed train."""
    return _packed(tmp_path_factory.mktemp("unit") / "unit.fmu", library, fmus.MAP_OF_A_UNIT)


def _packed(fmu: Path, library: Path, names: str, **options: Any) -> Path:
    return fmus.packed(fmu, fmus.description(changes=fmus.ACCELERATIONS, **options), library, names)


def _plant(scenario: str, fmu: Path | None = None, seed: int = 1) -> Any:
    named = None if fmu is None else PlantFmu(str(fmu), str(fmu.with_suffix(".toml")))
    run = RunSpec(scenario, seed=seed, plant_fmu=named)
    return make_plant(run.load(), run)[0]


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["hst_short", "jinan_xuzhou_emergency", "jinan_xuzhou_emu3_coupled"])
def test_units_move_like_those_of_the_bench(unit: Path, scenario: str) -> None:
    """With equal commands, wind, grades and couplers: from rest, from 250 km/h, and three units apart."""
    both = [_plant(scenario).train, _plant(scenario, unit).train]
    # Below the limit of power, which the FMU has after the lag.
    shares = (0.4, -0.3, 0.1, 0.3) if both[0].speed_mps == 0.0 else (0.1, -0.3, 0.05, 0.1)
    for tick in range(1000):
        for train in both:
            train.commands_mps2 = [shares[tick // 250] * (1 - 0.1 * number) for number in range(len(train.units))]
            train.advance()
        for native, found in zip(both[0].units, both[1].units, strict=True):
            assert found.motion.position_m == pytest.approx(native.motion.position_m, abs=0.05)
            assert found.motion.speed_mps == pytest.approx(native.motion.speed_mps, abs=0.005)
            assert found.motion.drive_mps2 == pytest.approx(native.motion.drive_mps2, abs=0.005)
    assert both[0].position_m - _plant(scenario).train.position_m > 50
    if len(both[0].units) > 1:
        assert max(map(abs, both[0].couplers_n)) > 1000


def test_a_stopping_train_moves_like_that_of_the_bench(library: Path, tmp_path: Path) -> None:
    fmu = _packed(tmp_path / "stop.fmu", library, fmus.MAP_OF_A_STOP)
    both = [_plant("yizhuang_stop_closed").train, _plant("yizhuang_stop_closed", fmu).train]
    for tick in range(3000):
        for train in both:
            if tick % 100 == 0 and tick >= 1000:
                # Also commands that begin to act within a cycle.
                train.command((-0.8, -1.1, -0.6)[tick // 100 % 3], 0.0007 * (tick // 100 % 5))
            train.advance()
        assert both[1].motion.position_m == pytest.approx(both[0].motion.position_m, abs=0.005)
        assert both[1].passed.balise == both[0].passed.balise
    assert both[0].passed.balise > 0
    assert both[0].stopped_s == pytest.approx(both[1].stopped_s, abs=0.005)
    assert both[0].motion.speed_mps == both[1].motion.speed_mps == 0.0


def test_fmus_that_cannot_be_these_trains_are_refused(unit: Path, library: Path, tmp_path: Path) -> None:
    def refused(scenario: str, names: str, **options: Any) -> str:
        with pytest.raises(InputError) as caught:
            _plant(scenario, _packed(tmp_path / "t.fmu", library, names, **options))
        return str(caught.value)

    still = fmus.MAP_OF_A_UNIT.replace('start_speed = "start_speed_mps"\n', "")
    assert "v: start: found 0.0, allowed" in refused("jinan_xuzhou_emergency", still)
    uncoupled = fmus.MAP_OF_A_UNIT.replace('outside_mps2 = "outside"\n', "")
    assert "inputs.outside_mps2: missing" in refused("emu3_short", uncoupled)
    _plant("hst_short", _packed(tmp_path / "one.fmu", library, uncoupled))
    assert "canHandleVariableCommunicationStepSize is false" in refused(
        "yizhuang_stop", fmus.MAP_OF_A_STOP, variable_step=False
    )
    once = tmp_path / "once.fmu"
    with zipfile.ZipFile(unit) as archive:
        text = archive.read("modelDescription.xml").decode()
    text = text.replace("<CoSimulation ", '<CoSimulation canBeInstantiatedOnlyOncePerProcess="true" ')
    fmus.packed(once, text, library, fmus.MAP_OF_A_UNIT)
    with pytest.raises(InputError, match="an instance for each unit of the train"):
        _plant("emu3_short", once)
    run = RunSpec("hst_short", plant_fmu=PlantFmu(str(once), str(once.with_suffix(".toml"))))
    assert plant_twice(run.load(), run) == (None, "not checked: a process can have only one instance of it")


@pytest.mark.long
@pytest.mark.slow
def test_a_run_is_made_again_and_replayed_with_the_fmu_on_the_command_line(
    here: Railhil, unit: Path, library: Path, tmp_path: Path
) -> None:
    quiet = ("--no-report", "--quiet", "--bus", "local")
    made = here("run", "hst_short", "--set", "task.duration_s=20", "--plant-fmu", unit, *quiet, "--out", "run")
    assert made.exit_code in (0, 1), made.err
    certificate = json.loads(Path("run/certificate.json").read_text())
    assert certificate["plant_fmu"]["deterministic"] is True

    assert "same bytes" in here("rerun", "run", "--plant-fmu", unit).out
    assert here("replay", "run", "--node", "plant", "--plant-fmu", unit).exit_code == 0
    assert here("replay", "run", "--node", "controller").exit_code == 0
    again = here("run", "--spec", "run/certificate.json", "--plant-fmu", unit, *quiet, "--out", "again")
    assert "the same bytes as in run/certificate.json" in again.out

    other = _packed(tmp_path / "other.fmu", library, fmus.MAP_OF_A_UNIT, variable_step=False)
    for words, message in (
        (("rerun", "run"), f"found '{unit}', allowed --plant-fmu on the command line: an FMU is native code"),
        (("replay", "run", "--node", "plant"), "allowed --plant-fmu on the command line"),
        (("rerun", "run", "--plant-fmu", other), "as in run/certificate.json"),
        (("replay", "run", "--node", "controller", "--plant-fmu", unit), "only with --node plant"),
    ):
        refused = here(*words)
        assert (refused.exit_code, refused.err.count("\n")) == (2, 1)
        assert message in refused.err


@pytest.mark.long
@pytest.mark.slow
def test_an_fmu_that_differs_from_time_to_time_is_in_the_certificate(here: Railhil, tmp_path: Path) -> None:
    fmu = fmus.packed(tmp_path / "train.fmu", fmus.description(), fmus.compiled_train(tmp_path, "-DDRIFT"))
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    words = ("--bus", "local", "--no-report", "--quiet", "--out", "run")
    done = here("run", "short.toml", "--plant-fmu", fmu, *words)
    assert done.exit_code in (0, 1), done.err
    assert f"note: the run may not be repeatable: {fmu}: two equal runs differ" in done.out
    named = json.loads(Path("run/certificate.json").read_text())["plant_fmu"]
    assert named["deterministic"] is False
    assert named["deterministic_why"].startswith("two equal runs differ")
