"""``--controller-fmu``: an FMU as the controller of a run, its names and units, and what cannot be one."""

from __future__ import annotations

import json
import os
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import railhil
from hil_tests.support import fmus
from hil_tests.support.cli import Done, railhil_process
from hil_tests.support.cli import railhil as command
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.fmu import FmuComputer, Word, quantities_of, words_of
from railhil.controller_node.given.computing import Terms
from railhil.scenarios.load import load, load_any

pytestmark = [pytest.mark.needs_compiler, pytest.mark.slow]

VERSIONS = ("2.0", "3.0")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("controller")
    (made / "short.toml").write_text(RUN_72M_TOML, encoding="utf-8")
    (made / "temporary").mkdir()
    return made


@pytest.fixture(scope="module")
def mine(folder: Path) -> Path:
    """A P controller in Python."""
    return fmus.python_fmu(folder, "2.0", fmus.PYTHON_CONTROLLER, "Controller", fmus.CONTROLLER_MAP.format(fault=0))


def run(folder: Path, out: str, *words: str | Path, scenario: str = "") -> Done:
    """A run whose temporary folders are in a folder of its own, which is empty after it."""
    temporary = folder / f"temporary_{out}"
    temporary.mkdir()
    words = ("run", scenario or folder / "short.toml", *words, "--quiet", "--no-report", "--out", folder / out)
    done = railhil_process(*words, environment={**os.environ, "TMPDIR": str(temporary)})
    assert list(temporary.glob("railhil-fmu-*")) == []
    return Done(done.returncode, done.stdout, done.stderr)


def certificate(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    return found


def frames(folder: Path, port: str) -> list[str]:
    """The frames of a port, with their times."""
    identifier = f"{railhil.open_run(folder).system.contract.port(port).can_ids[0]:03X}#"
    lines = (folder / "frames.log").read_text(encoding="ascii").splitlines()
    return [line for line in lines if f" {identifier}" in line]


@pytest.mark.long_after(1)
@pytest.mark.parametrize("version", VERSIONS)
def test_an_fmu_of_another_tool_is_the_controller(folder: Path, version: str) -> None:
    (folder / version).mkdir()
    names = fmus.CONTROLLER_MAP.format(fault=0)
    fmu = fmus.python_fmu(folder / version, version, fmus.PYTHON_CONTROLLER, "Controller", names)
    done = run(folder, f"run{version}", "--controller-fmu", fmu, "--bus", "local")
    assert done.exit_code in (0, 1), done.err
    found = certificate(folder / f"run{version}")
    assert found["given_controller"]["deterministic"] is True
    assert set(found["given_controller"]["files"]) == {str(fmu), str(fmu.with_suffix(".toml"))}
    # The same law in Python, from readings in m/s.
    code = folder / "same.py"
    code.write_text("def law(reading):\n    return 3.6 * reading.set_point_mps - 3.6 * reading.speed_mps\n")
    assert run(folder, f"py{version}", "--controller", f"{code}:law", "--bus", "local").exit_code in (0, 1)
    notches = [
        railhil.open_run(folder / f"{name}{version}").trace.raw("NOTCH_CMD", "NotchCmd") for name in ("run", "py")
    ]
    assert len(set(notches[0].tolist())) > 20
    assert abs(notches[0] - notches[1]).max() <= 1


@pytest.mark.long_after(1)
@pytest.mark.parametrize("options", [(), ("-i", "railhil")])
def test_the_bytes_are_the_same_on_every_bus(folder: Path, mine: Path, options: tuple[str, ...]) -> None:
    out = f"bus{len(options)}"
    assert run(folder, out, "--controller", mine, *options).exit_code in (0, 1)
    assert run(folder, f"{out}_local", "--controller", mine, "--bus", "local").exit_code in (0, 1)
    assert certificate(folder / out)["frames_sha256"] == certificate(folder / f"{out}_local")["frames_sha256"]


@pytest.mark.long_after(1)
@pytest.mark.parametrize(
    ("law", "scenario", "ports", "version"),
    [
        ("ipfc", "", ("NOTCH_CMD",), "2.0"),
        ("ipfc", "yizhuang_05", ("NOTCH_CMD",), "3.0"),
        ("ipfc_plus_stop", "", ("NOTCH_CMD",), "3.0"),
        ("pid", "hst_short", ("UNIT1_CMD",), "2.0"),
    ],
)
def test_an_exported_law_sends_the_commands_of_the_node(
    folder: Path, tmp_path: Path, law: str, scenario: str, ports: tuple[str, ...], version: str
) -> None:
    """Its variables have the names of the words of the wire, so that it needs no map."""
    name = scenario or folder / "short.toml"
    assert command("export-c", law, name, "--out", tmp_path / law, "--fmu", "--fmi-version", version).exit_code == 0
    out = f"{law}{version}{scenario}"
    fmu = tmp_path / law / f"{law}.fmu"
    options = ("--bus", "local")
    assert run(folder, f"fmu_{out}", "--controller-fmu", fmu, *options, scenario=scenario).exit_code in (0, 1)
    options = (*options, "--arithmetic", "iq")
    assert run(folder, f"law_{out}", "--controller", law, *options, scenario=scenario).exit_code in (0, 1)
    for port in ports:
        found = frames(folder / f"fmu_{out}", port)
        assert len(set(found)) > 20
        assert found == frames(folder / f"law_{out}", port)


def test_the_words_of_the_wire_stand_for_readings_and_commands() -> None:
    words = words_of(load("lvshun_tieshan"))
    assert words["speed_01mmps"] == ("speed_mps", 1e-4)
    assert words["out.notch"] == ("notch", 1 / 256)
    assert words["k"] == ("time_s", 0.5)


def _terms(name: str) -> tuple[Terms, dict[str, Word]]:
    """Readings and commands of a scenario, and its words of the wire."""
    scenario = load_any(name)
    terms: Terms = scenario.installed_system.part("given")(make("float64"), scenario).terms
    return terms, words_of(scenario)


@pytest.mark.parametrize("name", ["lvshun_tieshan", "yizhuang_stop", "hst_short"])
def test_each_word_of_the_wire_is_that_of_a_reading_or_command(name: str) -> None:
    terms, words = _terms(name)
    quantities = quantities_of(terms, words)
    assert words.keys() <= {*quantities.inputs, *quantities.outputs}
    words["out.misspelt"] = Word("notches", 1.0)
    with pytest.raises(KeyError, match="no reading or command notches"):
        quantities_of(terms, words)


FAULTY = [
    (1, "answer, notch: found nan, allowed a finite number"),
    (2, "refuses the step of 0.5 s at 0 s"),
    (4, "control period 1: no answer within 1 s"),
    (3, "control period 1: its process was killed by SIGSEGV"),
]
#: In one process, and on a bus, where one of them is enough for most days.
FAULTY_RUNS = [
    *((*one, ("--bus", "local")) for one in FAULTY),
    *(pytest.param(*one, (), marks=pytest.mark.long) for one in FAULTY[:-1]),
    (*FAULTY[-1], ()),
]


@pytest.mark.parametrize(("fault", "said", "bus"), FAULTY_RUNS)
def test_a_faulty_fmu_is_one_line(folder: Path, mine: Path, fault: int, said: str, bus: tuple[str, ...]) -> None:
    names = folder / f"fault{fault}.toml"
    names.write_text(fmus.CONTROLLER_MAP.format(fault=fault), encoding="utf-8")
    words = ("--controller-fmu", mine, "--controller-fmu-map", names, *bus)
    words = (*words, "--patience", "2") if fault == 4 else words
    done = run(folder, f"fault{fault}{len(bus)}", *words)
    assert done.exit_code == 2
    assert said in done.err
    assert "Traceback" not in done.err


def test_an_fmu_that_is_not_deterministic_is_said_to_be_so(folder: Path, mine: Path) -> None:
    names = folder / "random.toml"
    names.write_text(fmus.CONTROLLER_MAP.format(fault=5), encoding="utf-8")
    done = run(folder, "random", "--controller", f"{mine}:{names}", "--bus", "local")
    assert "note: the run may not be repeatable: " in done.out
    found = certificate(folder / "random")["given_controller"]
    assert (found["deterministic"], "two equal runs differ" in found["deterministic_why"]) == (False, True)


@pytest.mark.long
def test_a_rerun_needs_the_same_files(folder: Path, mine: Path) -> None:
    assert run(folder, "again", "--controller-fmu", mine, "--bus", "local").exit_code in (0, 1)
    assert command("rerun", folder / "again").exit_code == 2
    done = command("rerun", folder / "again", "--controller-fmu", mine, "--out", folder / "repeated")
    assert done.exit_code == 0, done.err
    assert certificate(folder / "repeated")["given_controller"] == certificate(folder / "again")["given_controller"]
    names = folder / "other.toml"
    names.write_text(fmus.CONTROLLER_MAP.format(fault=0) + "# other\n", encoding="utf-8")
    refused = command("rerun", folder / "again", "--controller-fmu", mine, "--controller-fmu-map", names)
    assert refused.exit_code == 2
    assert f"{names}: sha256: found" in refused.err
    assert command("replay", folder / "again", "--node", "controller", "--controller", mine).exit_code == 0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("notch =", "notches ="), "outputs.notches: unknown key, expected notch, out.notch (did you mean"),
        (('notch = "command"', ""), "outputs.notch: missing, expected the name of an output of Controller.fmu"),
        (('notch = "command"', 'notch = "command"\n"out.notch" = "command"'), "outputs.out.notch: beside notch"),
        (('"speed", unit = "km/h"', '"sped"'), "inputs.speed_mps: found 'sped', allowed a variable of Controller.fmu"),
        (('"speed", unit = "km/h"', '"speed", unit = "N"'), "inputs.speed_mps.unit: found 'N', allowed m/s, km/h"),
        (("fault = 0", 'fault = "mass"'), "parameters.fault: found 'mass', allowed period_s"),
    ],
)
def test_names_that_do_not_fit_are_refused(
    folder: Path, mine: Path, tmp_path: Path, change: tuple[str, str], said: str
) -> None:
    names = tmp_path / "names.toml"
    names.write_text(fmus.CONTROLLER_MAP.format(fault=0).replace(*change), encoding="utf-8")
    done = run(folder, f"names-{tmp_path.name}", "--controller", f"{mine}:{names}", "--bus", "local")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert said in done.err


@pytest.mark.long
def test_a_step_that_does_not_divide_the_control_period_is_refused(folder: Path, tmp_path: Path) -> None:
    assert command("export-c", "ipfc", "--out", tmp_path / "e", "--fmu", "--fmi-version", "3.0").exit_code == 0
    fmu = tmp_path / "coarse.fmu"
    with zipfile.ZipFile(tmp_path / "e/ipfc.fmu") as given, zipfile.ZipFile(fmu, "w") as made:
        for name in given.namelist():
            text = given.read(name)
            if name == "modelDescription.xml":
                text = text.replace(b"<CoSimulation ", b'<CoSimulation fixedInternalStepSize="0.3" ')
            made.writestr(name, text)
    done = run(folder, "coarse", "--controller-fmu", fmu, "--bus", "local")
    assert done.exit_code == 2
    assert "step: found '0.3 s', allowed one of which 0.5 s is a multiple" in done.err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--controller-fmu-map", "a.toml"), "--controller-fmu-map: used only with --controller-fmu"),
        (("--controller-fmu", "a.fmu", "--controller", "ipfc"), "--controller-fmu: used only without --controller"),
        (("--controller-fmu", "gone.fmu"), "gone.fmu: does not exist, expected FILE.fmu"),
        (("--controller-fmu", "model.zip"), "--controller: found 'model.zip', allowed a law, or"),
        (("--controller-fmu", "a.fmu", "--arithmetic", "iq"), "--arithmetic: cannot be given with --controller"),
    ],
)
def test_options_that_do_not_fit_are_refused(folder: Path, tmp_path: Path, words: tuple[str, ...], said: str) -> None:
    (folder / "a.fmu").touch()
    placed = [folder / word if word == "a.fmu" else word for word in words]
    done = run(folder, f"options-{tmp_path.name}", *placed, "--bus", "local")
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert said in done.err


def test_without_its_library_the_extra_is_named(mine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(InputError, match=r"not installed.*\[fmi\]"):
        FmuComputer(mine, None, tmp_path, Terms((), (), 0.5), {})


@pytest.mark.parametrize("version", VERSIONS)
def test_integers_and_booleans_are_passed_on_and_a_missed_period_is_a_step_with_the_last_inputs(
    tmp_path: Path, version: str
) -> None:
    fmu = fmus.python_fmu(tmp_path, version, fmus.PYTHON_PASSING, "Passing", "")
    inputs = '[inputs]\nspeed_01mmps = "whole"\nset_point_mps = "boolean"\n'
    for output, answers in (
        ('"out.notch" = "whole_out"', [0.0, 32500 / 256, -100 / 256]),
        ('notch = "boolean_out"', [0.0, 1.0, 0.0]),
        ('notch = "steps"', [1.0, 2.0, 5.0]),
        ('notch = "true_steps"', [0.0, 1.0, 3.0]),
    ):
        names = tmp_path / "names.toml"
        names.write_text(f"{inputs}[outputs]\n{output}\n", encoding="utf-8")
        compute = _computing(fmu, names, tmp_path / output.partition(" = ")[2].strip('"'))
        found = [compute(0, 0.0, 0.0), compute(1, 3.25, 1.0), compute(4, -0.01, 0.0)]
        assert found == pytest.approx(answers), output


def _computing(fmu: Path, names: Path, content: Path) -> Callable[[int, float, float], float]:
    """The notch of an FMU for control period, speed and set-point (m/s)."""
    terms, words = _terms("lvshun_tieshan")
    content.mkdir()
    computer = FmuComputer(fmu, names, content, terms, words)

    def compute(period: int, speed_mps: float, set_point_mps: float) -> float:
        given = {"time_s": period * 0.5, "speed_mps": speed_mps, "set_point_mps": set_point_mps}
        (notch,) = computer.compute([given.get(one.name, 0.0) for one in terms.readings])
        return notch

    return compute


@pytest.mark.needs_reference_fmus
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(
    ("inputs", "outputs", "answer"),
    [
        ('speed_mps = "Float64_continuous_input"', 'notch = "Float64_continuous_output"', 3.25),
        (
            'speed_mps = { variable = "Float64_discrete_input", unit = "km/h" }',
            'notch = "Float64_discrete_output"',
            11.7,
        ),
        ('speed_01mmps = "Int32_input"', '"out.notch" = "Int32_output"', 32500 / 256),
        ('speed_mps = "Boolean_input"', 'notch = "Boolean_output"', 1.0),
    ],
)
def test_a_reference_fmu_passes_readings_on(
    tmp_path: Path, version: str, inputs: str, outputs: str, answer: float
) -> None:
    fmu = fmus.reference_fmu(Path(os.environ["REFERENCE_FMUS"]), tmp_path, version)
    names = tmp_path / "names.toml"
    names.write_text(f"[inputs]\n{inputs}\n[outputs]\n{outputs}\n", encoding="utf-8")
    compute = _computing(fmu, names, tmp_path / "content")
    for k in (0, 2, 7):
        assert compute(k, 0.0, 1.0) == pytest.approx(0.0)
        assert compute(k + 1, 3.25, 1.0) == pytest.approx(answer)


@pytest.mark.needs_reference_fmus
@pytest.mark.parametrize("version", VERSIONS)
def test_a_reference_fmu_makes_a_run(folder: Path, tmp_path: Path, version: str) -> None:
    fmu = fmus.reference_fmu(Path(os.environ["REFERENCE_FMUS"]), tmp_path, version)
    fmu.with_suffix(".toml").write_text(
        '[inputs]\nset_point_mps = "Float64_continuous_input"\n[outputs]\nnotch = "Float64_continuous_output"\n'
    )
    done = run(folder, f"reference{version}", "--controller-fmu", fmu, "--bus", "local")
    assert done.exit_code == 1, done.err
    assert certificate(folder / f"reference{version}")["given_controller"]["deterministic"] is True
