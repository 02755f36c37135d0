"""``railhil new c-controller --fmu``: the function of the user as an FMU, and what its build refuses."""

from __future__ import annotations

import os
import re
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy import validation

from hil_tests.cli.test_c_controller import make, notches, run, words
from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.cli.new_controller import controller_files
from railhil.common.errors import InputError

pytestmark = [pytest.mark.needs_compiler, pytest.mark.slow, pytest.mark.loop]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With a C controller ``mine`` and its FMU, and a short scenario."""
    made = tmp_path_factory.mktemp("fmu")
    (made / "short.toml").write_text(RUN_72M_TOML, encoding="utf-8")
    done = railhil("new", "c-controller", "mine", "--fmu", cwd=made)
    assert (done.exit_code, "make -C mine/ fmu" in done.out) == (0, True), done.err
    assert make(made / "mine", "fmu", "check").returncode == 0
    return made


def test_an_input_that_nobody_would_set_is_refused(folder: Path, tmp_path: Path) -> None:
    """Without a file of names; with one, the user has said what each input is."""
    other = tmp_path / "other.fmu"
    with zipfile.ZipFile(folder / "mine/build/mine.fmu") as given, zipfile.ZipFile(other, "w") as made:
        for name in given.namelist():
            made.writestr(name, given.read(name).replace(b'name="set_point_mps"', b'name="set_point"'))
    refused = run(folder, str(other), "no_input")
    assert refused.exit_code == 2
    assert "inputs: found 'set_point'" in refused.one_line()
    assert "did you mean set_point_mps?" in refused.one_line()


def test_the_fmu_is_valid_and_has_the_readings_and_commands_of_the_header(folder: Path) -> None:
    file = folder / "mine/build/mine.fmu"
    assert validation.validate_fmu(str(file)) == []
    variables = fmpy.read_model_description(str(file)).modelVariables
    header = (folder / "mine/railhil/mine.h").read_text()
    members = re.findall(r"^    float (\w+);(?: /\* (.*) \*/)?$", header, re.MULTILINE)
    assert [(one.name, one.unit or "", one.type) for one in variables] == [(*member, "Real") for member in members]
    assert [one.name for one in variables if one.causality == "output"] == ["notch"]


@pytest.mark.long
def test_the_same_files_give_the_same_bytes(folder: Path) -> None:
    file = folder / "mine/build/mine.fmu"
    before = file.read_bytes()
    assert make(folder / "mine", "clean").returncode == 0
    # A copy of the folder, or a checkout, has other times.
    for source in (folder / "mine").rglob("*"):
        os.utime(source, (1e9, 1e9))
    assert make(folder / "mine", "fmu").returncode == 0
    assert file.read_bytes() == before


def test_the_fmu_sends_the_notches_of_the_folder(folder: Path) -> None:
    for controller, out in (("./mine", "as_c"), ("mine/build/mine.fmu", "as_fmu")):
        done = run(folder, controller, out)
        assert done.exit_code in (0, 1), done.err
    assert len(notches(folder / "as_c")) > 1000
    assert notches(folder / "as_fmu") == notches(folder / "as_c")


@pytest.mark.long
def test_another_importer_gets_the_commands_and_a_run_begins_anew_after_a_reset(folder: Path, tmp_path: Path) -> None:
    file = folder / "mine/build/mine.fmu"
    description = fmpy.read_model_description(str(file))
    references = {one.name: one.valueReference for one in description.modelVariables}
    fmu = fmpy.fmi2.FMU2Slave(
        guid=description.guid, unzipDirectory=fmpy.extract(str(file), str(tmp_path)), instanceName="one",
        modelIdentifier=description.coSimulation.modelIdentifier,
    )  # fmt: skip

    def notch_of_two_periods() -> list[float]:
        fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        found = []
        for period in range(2):
            fmu.setReal([references["speed_mps"], references["set_point_mps"]], [9.75, 10.0])
            fmu.doStep(currentCommunicationPoint=0.5 * period, communicationStepSize=0.5)
            found += fmu.getReal([references["notch"]])
            fmu.setReal([references["sent_notch"]], found[-1:])
        return found

    fmu.instantiate()
    try:
        first, second = notch_of_two_periods()
        assert (first, second > first) == (pytest.approx(10.8 * 0.25), True)
        fmu.reset()
        assert notch_of_two_periods() == [first, second]
    finally:
        fmu.freeInstance()


def test_a_command_that_is_not_finite_is_one_line(folder: Path) -> None:
    wrong = folder / "wrong"
    assert railhil("new", "c-controller", "wrong", "--fmu", cwd=folder).exit_code == 0
    source = wrong / "wrong.c"
    source.write_text(source.read_text().replace("out->notch = notch;", ""))
    assert make(wrong, "fmu").returncode == 0
    done = run(folder, "wrong/build/wrong.fmu", "no1")
    assert (done.exit_code, "notch" in done.one_line(), "a finite number" in done.one_line()) == (2, True, True)


def test_a_missing_compiler_is_one_line(folder: Path) -> None:
    done = make(folder / "mine", "fmu", "CC=no_such_compiler")
    assert done.returncode != 0
    (line,) = done.stderr.splitlines()
    assert "no_such_compiler is not installed" in line


def test_without_fmpy_there_is_no_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(InputError, match="fmi"):
        controller_files("mine", "lvshun_tieshan", fmu=True)


@pytest.mark.long
def test_the_fmu_of_another_system_sends_the_commands_of_its_folder(tmp_path: Path) -> None:
    assert railhil("new", "c-controller", "mine", "--fmu", "--scenario", "hst_short", cwd=tmp_path).exit_code == 0
    source = tmp_path / "mine/mine.c"
    body = "out->u = 0.9f * (in->ref1 - in->speed) + 0.3f"
    source.write_text(source.read_text().replace("(void)in;", "").replace("out->u = 0.0f", body))
    assert make(tmp_path / "mine", "fmu").returncode == 0
    logs = []
    for controller in ("./mine", "mine/build/mine.fmu"):
        out = f"{Path(controller).name}_run"
        done = railhil("run", "hst_short", *words(controller, out)[2:], cwd=tmp_path)
        assert done.exit_code in (0, 1), done.err
        lines = (tmp_path / out / "frames.log").read_text().splitlines()
        logs.append([line for line in lines if not re.search(r" 1(6[89C]|7[01489C])#", line)])
    assert len(logs[0]) > 1000
    assert logs[0] == logs[1]
