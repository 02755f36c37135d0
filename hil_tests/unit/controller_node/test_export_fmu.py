"""``railhil export-c --fmu``: the law in FMPy's loop computes the words of the C and the notches of the node."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

import railhil
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.controller_node.export.control import FLAG_BEGIN, FLAG_SENT

pytestmark = pytest.mark.needs_compiler

#: A law with balises, and one of a system with an interface, for which periods have no number.
LAWS = (("ipfc_plus_stop", "lvshun_tieshan"), ("pid", "hst_short"))


def _export(folder: Path, law: str, scenario: str, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "railhil.cli.export_c", law, scenario, "--out", str(folder), *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module", params=LAWS, ids=lambda param: param[0])
def exported(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    law, scenario = request.param
    folder = tmp_path_factory.mktemp(law)
    done = _export(folder, law, scenario, "--fmu", "--arithmetic", "iq")
    assert done.returncode == 0, done.stderr
    return folder / f"{law}.fmu"


def _in_order(fmu: Path) -> list[list[dict[str, int]]]:
    """The runs of the reference log whose periods follow one another in time."""
    return [run for run in _log(fmu) if all(period.get("k", at) == at for at, period in enumerate(run))]


def _log(fmu: Path) -> Iterator[list[dict[str, int]]]:
    """The runs of the reference log, a dictionary for each control period."""
    lines = (fmu.parent / f"{fmu.stem}_log.txt").read_text().splitlines()
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


class Loop:
    """The FMU in FMPy's hands."""

    def __init__(self, fmu: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(str(fmu))
        self.references = {one.name: one.valueReference for one in self.description.modelVariables}
        self.inputs = [one.name for one in self.description.modelVariables if one.causality == "input"]
        self.outputs = [one.name for one in self.description.modelVariables if one.causality == "output"]
        self.period_s = float(self.description.defaultExperiment.stepSize)
        self.slave = FMU2Slave(
            guid=self.description.guid, unzipDirectory=fmpy.extract(str(fmu), str(folder)),
            modelIdentifier=self.description.coSimulation.modelIdentifier, instanceName="law",
        )  # fmt: skip
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, values: dict[str, int]) -> None:
        self.slave.setInteger([self.references[name] for name in values], list(values.values()))

    def get(self) -> dict[str, int]:
        found = self.slave.getInteger([self.references[name] for name in self.outputs])
        return dict(zip(self.outputs, found, strict=True))

    def periods(self, run: list[dict[str, int]]) -> list[dict[str, int]]:
        """The outputs after each control period of a run of the log."""
        self.slave.reset()
        before: dict[str, int] = {}
        found = []
        told = [name for name in self.inputs if name not in _given(run[0], self.inputs)]
        for number, period in enumerate(run):
            # What was sent in a period is known at the next.
            sent = {name: before.get(name, 0) for name in told if name != "other_sent"}
            self.set({name: period[name] for name in self.inputs if name not in told} | sent)
            self.set({"other_sent": int(bool(before.get("flags", 0) & FLAG_SENT))})
            self.slave.doStep(period.get("k", number) * self.period_s, self.period_s)
            found.append(self.get())
            before = period
        return found


def _given(period: dict[str, int], inputs: list[str]) -> list[str]:
    """The inputs that are not commands sent."""
    return [name for name in inputs if name in period and not name.startswith("sent")]


@pytest.mark.slow
def test_words_are_those_of_the_reference_log(exported: Path, tmp_path: Path) -> None:
    """The log is what the law computes in Python, and what the compiled C is checked against."""
    loop = Loop(exported, tmp_path)
    compared = 0
    for run in _in_order(exported):
        found = loop.periods(run)
        assert found == [{name: period[name] for name in loop.outputs} for period in run]
        compared += len(run)
    assert compared >= 80


def test_fmpy_finds_nothing_wrong_and_the_sources_are_there(exported: Path) -> None:
    assert validate_fmu(str(exported)) == []
    with zipfile.ZipFile(exported) as archive:
        names = set(archive.namelist())
    law = exported.stem
    assert {f"sources/{law}.c", "sources/railhil_fmi2.c", "sources/fmi2Functions.h", "modelDescription.xml"} <= names


def test_a_step_longer_than_a_period_and_a_step_back_are_refused(exported: Path, tmp_path: Path) -> None:
    loop = Loop(exported, tmp_path)
    with pytest.raises(fmpy.fmi1.FMICallException):
        loop.slave.doStep(0.0, 1.1 * loop.period_s)
    loop.slave.doStep(3 * loop.period_s, loop.period_s)
    with pytest.raises(fmpy.fmi1.FMICallException):
        loop.slave.doStep(loop.period_s, loop.period_s)


@pytest.mark.slow
def test_notches_are_those_of_the_node_and_two_exports_are_equal(tmp_path: Path) -> None:
    scenario = tmp_path / "short.toml"
    scenario.write_text(RUN_72M_TOML)
    for name in ("one", "two"):
        assert _export(tmp_path / name, "ipfc", str(scenario), "--fmu").returncode == 0
    fmus = [tmp_path / name / "ipfc.fmu" for name in ("one", "two")]
    assert fmus[0].read_bytes() == fmus[1].read_bytes()
    run = railhil.run(str(scenario), out=tmp_path / "run")
    loop = Loop(fmus[0], tmp_path / "fmu")
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


def _newest(run: railhil.Outcome, port: str, signal: str, at_ns: int) -> int:
    """Raw value of the last telegram up to an instant."""
    return int(run.trace.raw(port, signal)[np.searchsorted(run.trace.times_ns(port), at_ns, side="right") - 1])


def test_what_cannot_be_an_fmu_is_refused(tmp_path: Path) -> None:
    done = _export(tmp_path / "a", "one_shot", "yizhuang_stop", "--fmu")
    assert done.returncode == 2
    assert "--fmu: found a law in float32, allowed a law in fixed point" in done.stderr
