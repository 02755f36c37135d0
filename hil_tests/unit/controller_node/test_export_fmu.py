"""``railhil export-c --fmu``: the law in FMPy's loop computes the words of the C and the commands of the node."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import railhil
from hil_tests.support.fmu_loop import Loop, members
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.controller_node.export.bundle import make_bundle
from railhil.controller_node.export.control import FLAG_BEGIN, FLAG_SENT
from railhil.controller_node.export.fmu import write_fmu
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec

pytestmark = pytest.mark.needs_compiler

VERSIONS = ("2.0", "3.0")
#: A law with balises, one of a system with an interface, for which periods have no number, and one without formats.
LAWS = (
    ("ipfc_plus_stop", "lvshun_tieshan", "iq"),
    ("pid", "hst_short", "iq"),
    ("elm_ngpc", "hst_short", "float32"),
)


class Export(NamedTuple):
    """An FMU of each version, and the reference log beside them."""

    fmus: Mapping[str, Path]
    log: str


@pytest.fixture(scope="module", params=LAWS, ids=lambda param: f"{param[0]}-{param[2]}")
def export(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Export:
    name, scenario, arithmetic = request.param
    folder = tmp_path_factory.mktemp(name)
    loaded, law = load_any(scenario), LawSpec(name, arithmetic)
    bundle = make_bundle(loaded, law)
    fmus = {version: folder / f"{version}.fmu" for version in VERSIONS}
    for version, path in fmus.items():
        write_fmu(bundle, loaded, law, path, version)
    return Export(fmus, bundle.files[f"{name}_log.txt"])


def _log(export: Export) -> Iterator[list[dict[str, int]]]:
    """The runs of the reference log, a dictionary for each control period."""
    lines = export.log.splitlines()
    columns = next(line for line in lines if line.startswith("# flags ")).split()[1:]
    run: list[dict[str, int]] = []
    for line in lines:
        if line.startswith("#"):
            continue
        words = np.array([int(word, 16) for word in line.split()], dtype=np.uint32).astype(np.int32).tolist()
        period = dict(zip(columns, words, strict=True))
        if period["flags"] & FLAG_BEGIN and run:
            yield run
            run = []
        run.append(period)
    yield run


def _periods(loop: Loop, run: list[dict[str, int]]) -> list[dict[str, int]]:
    """The outputs after each control period of a run of the log."""
    loop.slave.reset()
    before: dict[str, int] = {}
    found = []
    told = [name for name in loop.inputs if name.startswith("sent")]
    given = [name for name in loop.inputs if name not in (*told, "other_sent")]
    for number, period in enumerate(run):
        # What was sent in a period is known at the next.
        loop.set({name: period[name] for name in given} | {name: before.get(name, 0) for name in told})
        loop.set({"other_sent": int(bool(before.get("flags", 0) & FLAG_SENT))})
        loop.slave.doStep(period.get("k", number) * loop.period_s, loop.period_s)
        found.append(loop.get())
        before = period
    return found


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_words_are_those_of_the_reference_log(export: Export, version: str, tmp_path: Path) -> None:
    """The log is what the law computes in Python, and what the compiled C is checked against."""
    loop = Loop(export.fmus[version], tmp_path)
    compared = 0
    for run in _log(export):
        # Only periods that follow one another in time.
        if all(period.get("k", at) == at for at, period in enumerate(run)):
            assert _periods(loop, run) == [{name: period[name] for name in loop.outputs} for period in run]
            compared += len(run)
    assert compared >= 80


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_fmpy_finds_nothing_wrong_and_the_sources_are_there(export: Export, version: str) -> None:
    fmu = export.fmus[version]
    assert validate_fmu(str(fmu)) == []
    description = fmpy.read_model_description(str(fmu))
    with zipfile.ZipFile(fmu) as archive:
        names = set(archive.namelist())
    law = description.modelName
    frame = {"2.0": "railhil_fmi2.c", "3.0": "railhil_fmi3.c"}[version]
    assert {f"sources/{law}.c", "sources/railhil_fmu.c", f"sources/{frame}", "modelDescription.xml"} <= names
    units = [one.name for one in description.modelVariables if one.unit]
    assert units == ([] if version == "2.0" else ["time"])


@pytest.mark.slow
@pytest.mark.parametrize("export", [LAWS[0]], ids=["ipfc_plus_stop"], indirect=True)
@pytest.mark.parametrize("version", VERSIONS)
def test_a_step_longer_than_a_period_and_a_step_back_are_refused(export: Export, version: str, tmp_path: Path) -> None:
    loop = Loop(export.fmus[version], tmp_path)
    with pytest.raises(fmpy.fmi1.FMICallException):
        loop.slave.doStep(0.0, 1.1 * loop.period_s)
    loop.slave.doStep(3 * loop.period_s, loop.period_s)
    with pytest.raises(fmpy.fmi1.FMICallException):
        loop.slave.doStep(loop.period_s, loop.period_s)


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_steps_repeated_from_a_kept_state_give_the_same_words(export: Export, version: str, tmp_path: Path) -> None:
    """Kept in memory, or as bytes over a reset, and not from the bytes of another FMU."""
    loop = Loop(export.fmus[version], tmp_path)
    simulation = loop.description.coSimulation
    assert (simulation.canGetAndSetFMUstate, simulation.canSerializeFMUstate) == (True, True)
    given = [name for name in loop.inputs if "sent" not in name]

    def steps(first: int, last: int) -> list[dict[str, int]]:
        found = []
        for k in range(first, last):
            loop.set({name: 100 * k + at for at, name in enumerate(given)})
            loop.slave.doStep(k * loop.period_s, loop.period_s)
            found.append(loop.get())
        return found

    before = steps(0, 3)
    state = loop.slave.getFMUState()
    kept = loop.slave.serializeFMUState(state)
    after = steps(3, 8)
    assert before + after != [before[0]] * 8
    loop.slave.setFMUState(state)
    assert loop.get() == before[-1]
    assert steps(3, 8) == after
    loop.slave.freeFMUState(state)
    loop.slave.reset()
    loop.slave.setFMUState(again := loop.slave.deserializeFMUState(kept))
    assert steps(3, 8) == after
    loop.slave.freeFMUState(again)
    for refused in (kept[:-1], b"\1" + kept[1:]):
        with pytest.raises(fmpy.fmi1.FMICallException):
            loop.slave.deserializeFMUState(refused)


@pytest.mark.slow
@pytest.mark.parametrize("export", [LAWS[0]], ids=["ipfc_plus_stop"], indirect=True)
def test_other_variables_than_those_of_the_description_are_refused(export: Export, tmp_path: Path) -> None:
    loop = Loop(export.fmus["3.0"], tmp_path)
    assert loop.slave.doStep(0.0, loop.period_s) == (False, False, False, loop.period_s)
    assert loop.slave.getFloat64([loop.references["time"]]) == [loop.period_s]
    assert loop.slave.getFloat64([]) == loop.slave.getBoolean([]) == []
    for refused in (
        lambda: loop.slave.getFloat64([0]),
        lambda: loop.slave.getBoolean([0]),
        lambda: loop.slave.setInt32([1000], [1]),
        lambda: loop.slave.getInt32([100_000]),
        loop.slave.enterEventMode,
    ):
        with pytest.raises(fmpy.fmi1.FMICallException):
            refused()


def _export(folder: Path, law: str, scenario: str, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "railhil.cli.export_c", law, scenario, "--out", str(folder), *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.long
@pytest.mark.slow
def test_notches_are_those_of_the_node_and_two_exports_are_equal(tmp_path: Path) -> None:
    scenario = tmp_path / "short.toml"
    scenario.write_text(RUN_72M_TOML)
    third = ("--fmi-version", "3.0")
    for name, version in (("two", ()), ("three", third), ("again", third)):
        assert _export(tmp_path / name, "ipfc", str(scenario), "--fmu", *version).returncode == 0
    assert (tmp_path / "three/ipfc.fmu").read_bytes() == (tmp_path / "again/ipfc.fmu").read_bytes()
    run = railhil.run(str(scenario), out=tmp_path / "run")
    for name in ("two", "three"):
        loop = Loop(tmp_path / name / "ipfc.fmu", tmp_path / f"fmu_{name}")
        found, seen = [], []
        for k in range(int(run.trace.end_s / loop.period_s)):
            at_ns = round(k * loop.period_s * 1e9)
            # The node runs the law at the first poll in a control period, with the speed of that instant.
            loop.set({"speed_01mmps": _newest(run, "TRN_SPEED", "TrainSpeed", at_ns)})
            loop.slave.doStep(k * loop.period_s, loop.period_s)
            found.append(loop.get()["out.notch"])
            seen.append(_newest(run, "NOTCH_CMD", "NotchCmd", at_ns))
        assert len(set(seen)) > 20
        assert found == seen


@pytest.mark.slow
@pytest.mark.parametrize("export", [LAWS[2]], ids=["elm_ngpc"], indirect=True)
def test_commands_in_single_precision_are_those_of_the_node(export: Export, tmp_path: Path) -> None:
    """The terminals of the FMU say which signal of the bus each of its variables is."""
    name, scenario, arithmetic = LAWS[2]
    shorter = ["task.duration_s=40"]
    run = railhil.run(scenario, controller=name, arithmetic=arithmetic, settings=shorter, out=tmp_path / "run")
    wired = members(export.fmus["3.0"])
    for version, fmu in export.fmus.items():
        loop = Loop(fmu, tmp_path / f"fmu_{version}")
        assert {name for name in loop.inputs if "sent" not in name} <= wired.keys()
        found, seen = [], []
        for k in range(int(run.trace.end_s / loop.period_s)):
            at_ns = round(k * loop.period_s * 1e9)
            loop.set({name: _newest(run, *wired[name], at_ns) for name in loop.inputs if name in wired})
            loop.slave.doStep(k * loop.period_s, loop.period_s)
            answer = loop.get()
            found.append([answer[name] for name in loop.outputs if name in wired])
            seen.append([_newest(run, *wired[name], at_ns) for name in loop.outputs if name in wired])
        assert len({row[0] for row in seen}) > 20
        assert found == seen


def _newest(run: railhil.Outcome, port: str, signal: str, at_ns: int) -> int:
    """Raw value of the last telegram up to an instant."""
    return int(run.trace.raw(port, signal)[np.searchsorted(run.trace.times_ns(port), at_ns, side="right") - 1])


@pytest.mark.slow
def test_what_cannot_be_an_fmu_is_refused(tmp_path: Path) -> None:
    done = _export(tmp_path / "a", "ipfc", "lvshun_tieshan", "--fmi-version", "3.0")
    assert done.returncode == 2
    assert "--fmi-version: used only with --fmu" in done.stderr
