"""Laws without fixed-point formats as C in single precision: every word of state, commands and notes is Python's."""

from __future__ import annotations

import ctypes
import struct
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from railhil.bench import coupled_run
from railhil.controller_node.export import make_bundle, write_bundle
from railhil.controller_node.program.model import name_leaves
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


def words(values: Sequence[float]) -> list[int]:
    """Singles as integers."""
    return [struct.unpack("<I", struct.pack("<f", value))[0] for value in values]


class Compiled:
    """The exported law, called like :class:`VectorController`."""

    def __init__(self, folder: Path, name: str, compiler: str, states: int, commands: int, notes: int) -> None:
        library = folder / f"{compiler}.so"
        flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-fPIC", "-shared"]
        subprocess.run([compiler, *flags, "-o", library, f"{name}.c", "-lm"], cwd=folder, check=True)
        loaded = ctypes.CDLL(str(library))
        self._start, self._step, self._sent = (getattr(loaded, f"{name}_{word}") for word in ("start", "step", "sent"))
        self.state = (ctypes.c_float * states)()
        self._commands, self._notes = (ctypes.c_int32 * commands)(), (ctypes.c_int32 * notes)()
        self._begun = False

    def step(self, raws: Sequence[int]) -> tuple[list[int], list[int]]:
        given = (ctypes.c_int32 * len(raws))(*raws)
        if not self._begun:
            self._start(given, self.state)
            self._begun = True
        self._step(self.state, given, self._commands, self._notes)
        return list(self._commands), list(self._notes)

    def sent(self, *raws: int) -> None:
        self._sent(self.state, (ctypes.c_int32 * len(raws))(*raws))


@pytest.mark.long
@pytest.mark.parametrize(("name", "compiler"), [("elm_ngpc", "gcc"), ("os_elm_ngpc", "clang")])
def test_every_word_is_that_of_float32(
    scenario: AnyScenario, readings: list[tuple[int, ...]], tmp_path: Path, name: str, compiler: str
) -> None:
    law = LawSpec(name, "float32")
    bundle = make_bundle(scenario, law)
    write_bundle(bundle, tmp_path)
    controller = VectorController(scenario, law)
    interface = controller.interface
    c = Compiled(tmp_path, name, compiler, len(bundle.source.columns), len(interface.commands), len(interface.notes))
    identified = set()
    for k, raws in enumerate(readings):
        output = controller.step(raws)
        commands, notes = c.step(raws)
        assert (commands, notes) == (list(output.commands), list(output.notes))
        if k % 97 == 60:
            # The node has sent safe commands.
            controller.sent(0, 4)
            c.sent(0, 4)
        state = [value for _, value in name_leaves(controller.state)]
        assert list(words(c.state)) == words(state), k
        identified.add(notes[2])
    # The projection has changed the model, or there is none in this law.
    assert (len(identified) > 10) == (name == "elm_ngpc")


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
    done = subprocess.run(["make", "-s", "check"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    log = tmp_path / "elm_ngpc_log.txt"
    lines = log.read_text().splitlines()
    lines[-1] = lines[-1][:-1] + ("0" if lines[-1][-1] != "0" else "1")
    log.write_text("\n".join(lines) + "\n")
    assert subprocess.run(["make", "-s", "check"], cwd=tmp_path, capture_output=True, check=False).returncode != 0


def test_parameters_are_in_the_export(scenario: AnyScenario) -> None:
    off = ParameterSet("elm_ngpc", {"ident": "off"}, Path("off.toml"))
    with_, without = (
        make_bundle(scenario, LawSpec("elm_ngpc", "float32", parameters=given)).source for given in (None, off)
    )
    assert len(without.columns) < len(with_.columns)
