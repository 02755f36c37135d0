"""Exported control laws for tests: compiled on the host, compared with the Python law, and used instead of it."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION
from railhil.controller_node.ato.control_loop import NO_BALISE, ControlLoop
from railhil.controller_node.ato.controller import Controller, ControlOutput
from railhil.controller_node.export import Bundle, make_bundle, write_bundle
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.laws.note import on_wire
from railhil.controller_node.program.model import name_leaves
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

#: Required warning flags, used with each compiler.
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-fwrapv")
#: Without -fwrapv, with which the sanitizer would ignore overflows.
SANITIZED = ("-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=undefined", "-fno-sanitize-recover=all")
FLAG_BEGIN, FLAG_SENT = 1, 2

Ints: TypeAlias = NDArray[np.int64]


def compiled(folder: Path, compiler: str, flags: Sequence[str], name: str, law: str = "ipfc") -> Path:
    """The host program of an export; warnings are errors."""
    program = folder / name
    command = [compiler, *flags, "-ffp-contract=off", "-o", str(program), f"{law}.c", "railhil_run.c", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stderr}"
    return program


def checked(program: Path, log: Path) -> subprocess.CompletedProcess[str]:
    """Result of the program's own comparison with a log."""
    with log.open("rb") as lines:
        return subprocess.run([program, "check"], stdin=lines, capture_output=True, text=True, check=False)


def written(
    scenario: Scenario, folder: Path, indexing: str = "time", law: str = "ipfc", arithmetic: str = "iq"
) -> Bundle:
    """An export in a folder."""
    bundle = make_bundle(scenario, LawSpec(law, arithmetic, indexing=indexing))
    write_bundle(bundle, folder)
    return bundle


@dataclass(frozen=True, slots=True)
class Wire:
    """Inputs of the law from N trains over S control periods: arrays of shape (S, N), raw wire integers.

    ``told``: whether a notch other than the law's was sent, ``sent``.
    """

    k: Ints
    speed_01mmps: Ints
    position_01mm: Ints
    told: NDArray[np.bool_]
    sent: Ints
    #: For a law that uses it.
    balise: BaliseReading[Ints] | None = None

    def records(self) -> bytes:
        """Records of the host program, one train after the other."""
        begin = np.zeros_like(self.k)
        begin[0] = FLAG_BEGIN
        words = (begin | np.where(self.told, FLAG_SENT, 0), self.k, self.speed_01mmps, self.position_01mm, self.sent)
        words = words if self.balise is None else (*words, *self.balise)
        return np.stack(words, axis=-1).swapaxes(0, 1).astype("<i4").tobytes()


@dataclass(frozen=True, slots=True)
class Results:
    """Result words of shape (N, S, words) without the events, and the events at the end of all runs together."""

    words: NDArray[np.int32]
    saturations: int
    zero_divisions: int


def from_python(scenario: Scenario, wire: Wire, indexing: str = "time", law: str = "ipfc") -> Results:
    """The law itself in batch arithmetic."""
    number = make("iq", batch=True)
    loop: ControlLoop[Any] = ControlLoop(scenario, LawSpec(law, indexing=indexing), number)
    periods, trains = wire.k.shape
    rows = []
    for s in range(periods):
        balise = NO_BALISE if wire.balise is None else BaliseReading(*(part[s] for part in wire.balise))
        inputs, outputs = loop.step(wire.k[s], wire.speed_01mmps[s], wire.position_01mm[s], balise)
        loop.sent(np.where(wire.told[s], wire.sent[s], outputs.notch))
        parts = [*name_leaves(inputs, "in"), *name_leaves(loop.state, "state"), *name_leaves(outputs, "out")]
        rows.append([np.broadcast_to(value, (trains,)) for _, value in parts])
    words = np.array(rows, dtype=np.int32).transpose(2, 0, 1)
    return Results(words, number.counters.saturations, number.counters.zero_divisions)


def from_c(program: Path, wire: Wire) -> Results:
    """The compiled program on the same records."""
    done = subprocess.run([program], input=wire.records(), capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    periods, trains = wire.k.shape
    words = np.frombuffer(done.stdout, dtype="<i4").reshape(trains, periods, -1)
    saturations, zero_divisions = (int(total) for total in words[:, -1, -2:].sum(axis=0))
    return Results(words[:, :, :-2], saturations, zero_divisions)


def _structures(bundle: Bundle) -> Mapping[str, type[ctypes.Structure]]:
    groups: dict[str, list[tuple[str, Any]]] = {}
    for column in bundle.source.columns:
        group, _, member = column.partition(".")
        groups.setdefault(group, []).append((member, ctypes.c_int32))
    return {group: type(group, (ctypes.Structure,), {"_fields_": members}) for group, members in groups.items()}


class CompiledController(Controller):
    """The compiled law instead of :class:`Controller`, for a complete run; all results come from the C.

    The Python controller is made only for static data (cost and names of telemetry) and never stepped.
    """

    def __init__(self, scenario: Scenario, folder: Path, bundle: Bundle, indexing: str) -> None:
        super().__init__(scenario, LawSpec(indexing=indexing))
        self.library = ctypes.CDLL(str(folder / "libipfc.so"))
        structures = _structures(bundle)
        self._in, self._state, self._out, self._events = (
            structures[group]() for group in ("in", "state", "out", "events")
        )
        self._answered: int | None = None
        self.steps = 0

    def step(
        self, k: int, speed_01mmps: int, position_01mm: int, balise: BaliseReading[int] = NO_BALISE
    ) -> ControlOutput:
        given, state, out, events = map(ctypes.byref, (self._in, self._state, self._out, self._events))
        self.library.ipfc_inputs(k, speed_01mmps, position_01mm, given, events)
        if self._answered is None:
            self.library.ipfc_start(given, state)
        self.library.ipfc_step(state, given, out, events)
        self.steps += 1
        self._answered = self._out.notch
        return ControlOutput(
            notch_code=self._out.notch,
            notes=tuple(on_wire(note, getattr(self._out, f"notes_{i}")) for i, note in enumerate(self.notes)),
            overflow_flags=(SATURATION if self._events.saturations else 0)
            | (DIVISION_BY_ZERO if self._events.zero_divisions else 0),
            cycles=self.cost.cycles,
            error_raw=self._in.set_point - self._in.speed,
        )

    def sent(self, notch_code: int) -> None:
        if self._answered is not None and notch_code != self._answered:
            self._answered = notch_code
            self.library.ipfc_sent(ctypes.byref(self._state), notch_code)
