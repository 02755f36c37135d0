"""``--plant-fmu``: a train that is an FMU drives the bench; what cannot be one is refused in one line."""

from __future__ import annotations

import json
import os
import struct
import zipfile
from pathlib import Path

import pytest

from hil_tests.support import fmus
from hil_tests.support.cli import Done, Railhil, railhil_process
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.plant_sim.ato.fmu import FmuTrain
from railhil.plant_sim.ato.train import TrainOnBus
from railhil.scenarios.load import load
from railhil.scenarios.plant_fmu import PlantFmu

pytestmark = pytest.mark.needs_compiler


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmus.compiled_train(tmp_path_factory.mktemp("library"))


@pytest.fixture(scope="module")
def train(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmus.packed(tmp_path_factory.mktemp("fmu") / "train.fmu", fmus.description(), library)


def _run(here: Railhil, fmu: Path | None, out: str, *words: str) -> dict[str, object]:
    chosen = [] if fmu is None else ["--plant-fmu", fmu]
    done = here("run", *words, *chosen, "--bus", "local", "--no-report", "--quiet", "--out", out)
    assert done.exit_code in (0, 1), done.err
    found: dict[str, object] = json.loads((Path(out) / "certificate.json").read_text())
    return found | {"scores": json.loads((Path(out) / "score.json").read_text())["scores"]}


@pytest.mark.long
@pytest.mark.slow
def test_the_whole_scenario_has_the_scores_of_the_native_train(here: Railhil, train: Path) -> None:
    native, found = _run(here, None, "native"), _run(here, train, "fmu")
    assert found["verdict"] == native["verdict"] == "PASS"
    assert found["frames"] == pytest.approx(native["frames"], abs=20)
    for name, within in {"itae": 20, "energy_kj": 75, "punctuality_s": 0.01, "stop_error_m": 0.1}.items():
        assert found["scores"][name] == pytest.approx(native["scores"][name], abs=within), name
    assert found["frames_sha256"] != native["frames_sha256"]
    named = found["plant_fmu"]
    assert named == PlantFmu(str(train), str(train.with_suffix(".toml")), same_twice=True).as_json()
    assert f"--plant-fmu {train} --fmu-map {train.with_suffix('.toml')}" in str(found["command"])


def test_with_equal_notches_it_moves_like_the_native_train(train: Path) -> None:
    """One step in which the grade is that of its beginning: millimetres in 20 s."""
    scenario = load("yizhuang_05")
    both = (
        TrainOnBus(scenario, 0),
        FmuTrain(scenario, 0, False, 0.0, PlantFmu(str(train), str(train.with_suffix(".toml")))),
    )
    for tick in range(2500):
        for plant in both:
            plant.command((1792, 1792, 600, -1500, -1792)[tick // 500], False)
            plant.advance()
        assert both[1].position_01mm == pytest.approx(both[0].position_01mm, abs=50)
        assert both[1].true_speed_01mmps == pytest.approx(both[0].true_speed_01mmps, abs=50)
    assert both[0].position_01mm > 1_000_000


@pytest.mark.slow
def test_processes_have_the_bytes_of_one_process(here: Railhil, train: Path, tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(RUN_72M_TOML)
    one = _run(here, train, "one", "short.toml")
    words = ("run", "short.toml", "--plant-fmu", train, "--no-report", "--quiet", "--out", "three")
    # Its temporary folder.
    (tmp_path / "t").mkdir()
    environment = {**os.environ, "TMPDIR": str(tmp_path / "t")}
    done = railhil_process(*words, environment=environment, cwd=Path.cwd(), anew=True)
    assert done.returncode in (0, 1), done.stderr
    assert not list((tmp_path / "t").glob("railhil-fmu-*"))
    assert json.loads(Path("three/certificate.json").read_text())["frames_sha256"] == one["frames_sha256"]


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_trains_in_python_run_and_do_the_same_twice(here: Railhil, version: str, tmp_path: Path) -> None:
    fmu = fmus.python_train(tmp_path, version)
    done = here("doctor", "--plant-fmu", fmu, "--json")
    assert done.exit_code == 0, done.err
    assert json.loads(done.out)["deterministic"]
    (tmp_path / "short.toml").write_text(RUN_72M_TOML)
    assert _run(here, fmu, "run", "short.toml")["frames"] > 5000


def test_no_file_can_make_a_command_load_it(here: Railhil, train: Path) -> None:
    Path("again.json").write_text(
        json.dumps({"scenario": "yizhuang_05", "plant_fmu": {"file": "train.fmu"}, "bus": "local"})
    )
    done = here("run", "--spec", "again.json", "--no-report")
    assert done.exit_code == 2
    assert "plant_fmu: found 'train.fmu', allowed --plant-fmu on the command line" in done.err
    Path("again.toml").write_text('plant_fmu = "train.fmu"\n')
    assert here("run", "--spec", "again.toml").exit_code == 2
    assert here("run", "--set", f"plant_fmu={train}").exit_code == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--fmu-map", "a.toml"), "--fmu-map: used only with --plant-fmu"),
        (("--plant-fmu", "no.fmu"), "no.fmu: does not exist"),
        (("hst_short", "--plant-fmu", "TRAIN"), "inputs.force_n: unknown key, expected command_mps2"),
        (("--plant-fmu", "TRAIN", "--fault", "sensor.speed stuck @1s for 1s"), "faults in the plant"),
        (("--plant-fmu", "TRAIN", "--attach", "-i", "socketcan", "-c", "can0"), "--plant-fmu: cannot be given"),
        (("--set", "timing.loop_delay_s=0.043", "--plant-fmu", "FIXED"), "step: steps of 0.01 s only"),
    ],
)  # fmt: skip
def test_runs_that_take_no_fmu(
    here: Railhil, train: Path, library: Path, tmp_path: Path, words: tuple[str, ...], message: str
) -> None:
    fixed = fmus.packed(tmp_path / "fixed.fmu", fmus.description(variable_step=False), library)
    places = {"TRAIN": str(train), "FIXED": str(fixed)}
    done = here("run", *(places.get(word, word) for word in words), *([] if "-i" in words else ["--bus", "local"]))
    assert done.exit_code == 2
    assert message in done.err
    assert done.err.count("\n") == 1


@pytest.mark.parametrize(
    ("changes", "names", "message"),
    [
        ({}, ('speed_mps = "v"', 'speed_mps = "speed"'), "outputs.speed_mps: found 'speed', allowed a variable"),
        ({}, ('speed_mps = "v"', ""), "outputs.speed_mps: missing"),
        ({}, ('speed_mps = "v"', 'sped_mps = "v"'), "outputs.sped_mps: unknown key"),
        ({}, ('speed_mps = "v"', 'speed_mps = { variable = "v", unit = "N" }'), "speed_mps.unit: found 'N', allowed"),
        ({}, ('speed_mps = "v"', "speed_mps = 3"), "outputs.speed_mps: found 3, allowed the name of a variable"),
        ({}, ('mass = "inertial_mass_kg"', 'mass = "weight"'), "parameters.mass: found 'weight', allowed"),
        ({}, ('mass = "inertial_mass_kg"', 'force = "pole_per_s"'), "force: causality: found 'input Real', allowed"),
        ({"v": ("output", "km/h")}, None, "v: unit: found 'km/h', allowed m/s"),
        ({"v": ("local", "m/s")}, None, "v: causality: found 'local', allowed output"),
        ({"force": ("output", "N")}, None, "force: causality: found 'output', allowed input"),
    ],
)  # fmt: skip
def test_variables_that_do_not_fit_are_refused(
    here: Railhil, library: Path, changes: dict[str, tuple[str, str]], names: tuple[str, str] | None, message: str
) -> None:
    text = fmus.MAP.replace(*names) if names else fmus.MAP
    fmus.packed(Path("t.fmu"), fmus.description(changes=changes), library, text)
    done = here("run", "--bus", "local", "--plant-fmu", "t.fmu", "--out", "run")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert message in done.err
    assert not Path("run").exists()


def test_units_of_the_map_are_converted(here: Railhil, library: Path, train: Path) -> None:
    """As if the FMU's newtons were kilonewtons and its mass a thousandth: the same motion."""
    text = fmus.MAP.replace('force_n = "force"', 'force_n = { variable = "force", unit = "kN" }')
    text = text.replace('effort_n = "effort"', 'effort_n = { variable = "effort", unit = "kN" }')
    text = text.replace('brake_min_n = "brake_min"', 'brake_min_n = { variable = "brake_min", unit = "kN" }')
    changes = {"force": ("input", "kN"), "effort": ("output", "kN"), "brake_min": ("input", "kN")}
    parameters = ("mass = 223.66", "a = 0", "b = 0", "c = 0", "per_permil = 0", "traction_max = 215", "brake_max = 270")
    for one in parameters:
        name = one.split()[0]
        text = "\n".join(one if line.startswith(f"{name} =") else line for line in text.splitlines())
    text = text.replace('traction_power = "traction_power_max_w"', "traction_power = 2550")
    text = text.replace('brake_power = "brake_power_max_w"', "brake_power = 1e9")
    fmu = fmus.packed(
        Path("kilo.fmu"),
        fmus.description(changes=changes).replace('<Unit name="N"/>', '<Unit name="N"/><Unit name="kN"/>'),
        library,
        text,
    )
    scenario = load("lvshun_tieshan")
    plant = FmuTrain(scenario, 0, False, 0.0, PlantFmu(str(fmu), str(fmu.with_suffix(".toml"))))
    for _ in range(1000):
        plant.command(256, False)
        plant.advance()
    # One notch after its lag: 46.7 kN on 223.66 t.
    assert plant.accel_mps2 == pytest.approx(46698.5 / 223660, rel=0.05)
    assert plant.traction_n == pytest.approx(46698.5, rel=0.05)


_FMI_1 = (
    '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="1.0" modelName="train" '
    'modelIdentifier="train" guid="{train}" numberOfContinuousStates="0" numberOfEventIndicators="0">'
    "<ModelVariables/></fmiModelDescription>"
)


@pytest.mark.parametrize(
    ("description", "message"),
    [
        (_FMI_1, "fmiVersion: found '1.0', allowed 2.0, 3.0"),
        ("<fmiModelDescription", "modelDescription.xml: cannot be read as that of an FMU"),
        (fmus.description().replace("CoSimulation modelIdentifier", "ModelExchange modelIdentifier").replace(
            ' canHandleVariableCommunicationStepSize="true"', ""), "CoSimulation: missing"),
        (fmus.description().replace('modelIdentifier="train"', 'modelIdentifier="tram"'), "start: cannot be"),
    ],
)  # fmt: skip
def test_files_that_are_no_fmu_of_a_train_are_refused(
    here: Railhil, library: Path, description: str, message: str
) -> None:
    fmus.packed(Path("t.fmu"), description, library)
    done = here("run", "--bus", "local", "--plant-fmu", "t.fmu", "--out", "run")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert message in done.err


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("/etc/absolute", "archive: cannot be unpacked"),
        ("resources\\back", "archive: cannot be unpacked"),
    ],
)
def test_names_that_no_archive_of_an_fmu_may_have_are_refused(
    here: Railhil, library: Path, name: str, message: str
) -> None:
    fmus.packed(Path("t.fmu"), fmus.description(), library)
    with zipfile.ZipFile("t.fmu", "a") as archive:
        archive.writestr(name, "x")
    done = here("run", "--bus", "local", "--plant-fmu", "t.fmu", "--out", "run")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert message in done.err


def test_an_archive_that_would_fill_the_disk_is_refused(here: Railhil, library: Path) -> None:
    fmus.packed(Path("t.fmu"), fmus.description(), library)
    with zipfile.ZipFile("t.fmu", "a") as archive:
        archive.writestr("resources/big", "x")
    # The directory of the archive comes last: its size of that member.
    content = Path("t.fmu").read_bytes()
    entry = content.rindex(b"PK\x01\x02")
    Path("t.fmu").write_bytes(content[: entry + 24] + struct.pack("<L", 3_000_000_000) + content[entry + 28 :])
    done = here("run", "--bus", "local", "--plant-fmu", "t.fmu", "--out", "run")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert "archive: 3 GB when unpacked, expected an FMU of at most 2 GB" in done.err


def test_an_fmu_for_another_machine_is_refused(here: Railhil) -> None:
    fmus.packed(Path("t.fmu"), fmus.description(), None)
    done = here("run", "--bus", "local", "--plant-fmu", "t.fmu", "--out", "run")
    assert done.exit_code == 2
    assert "binaries: only for no platform, expected one for" in done.err


def test_doctor_says_whether_it_does_the_same_twice(here: Railhil, train: Path, tmp_path: Path) -> None:
    done = here("doctor", "--plant-fmu", train)
    assert done == Done(0, done.out, "")
    assert "two runs of 4000 steps are equal" in done.out
    for option in ("--fmu-map", "--scenario"):
        refused = here("doctor", option, "a.toml")
        assert refused.exit_code == 2
        assert f"{option}: used only with --plant-fmu" in refused.err
