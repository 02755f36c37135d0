"""Exports of laws that the project does not ship: one of every operation, and some that cannot be exported."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import pytest

from hil_tests.support.exported import SANITIZED, STRICT, checked, compiled, written
from hil_tests.support.plug import plug_in
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import INT32_MIN, Arithmetic, Constant, Curve
from railhil.controller_node.laws.base import Law, LawInputs, LawOutputs
from railhil.controller_node.laws.note import Note
from railhil.controller_node.laws.note import flags as told_flags
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario

SCENARIO = load("lvshun_tieshan")


class ToyState(NamedTuple):
    """Two numbers that change places, and one more."""

    first: Any
    second: Any
    default: Any


class Toy(Law[Any, ToyState]):
    """Uses every operation, in formats at the edge of the library's, with names that C does not like."""

    name: ClassVar[str] = "toy"
    horizon: ClassVar[int] = 2  # type: ignore[assignment]
    notes: ClassVar[tuple[Note, ...]] = (
        told_flags("flags", "*/ flags", ("one",)),
        Note("product", "product of two", 30, wire_q=2, signed=True),
        Note("zero", "zero", 20),
    )
    constants: ClassVar[tuple[Constant, ...]] = ()

    def __init__(self, arithmetic: Arithmetic[Any], scenario: Scenario, parameters: Any = None) -> None:
        self.ar = ar = arithmetic
        self.low = ar.const(Constant("case", INT32_MIN / 2**20, 20, "ends */ a comment"))
        self.half = ar.const(Constant("Case", 0.5, 20))
        self.tie = ar.neg(ar.const(Constant("tie", 2.5, 0)))
        self.zero = ar.const(Constant("zero", 0.0, 20))
        self.knots = ar.table("knots", [Constant(f"k{i}", float(i * i), 20) for i in range(8)])
        self.square = Curve.sampled("square", lambda x: x * x, 20, 20)

    def start(self, inputs: LawInputs[Any]) -> ToyState:
        return ToyState(inputs.speed, inputs.set_point, self.zero)

    def with_sent(self, state: ToyState, notch: Any) -> ToyState:
        return ToyState(state.second, state.first, self.ar.convert(notch, 8, 20))

    def step(self, state: ToyState, inputs: LawInputs[Any]) -> tuple[ToyState, LawOutputs[Any]]:
        ar = self.ar
        error = ar.note("in", ar.sub(inputs.set_point, inputs.speed), 20, "km/h")
        product = ar.note("out", ar.rsmpy(error, ar.abs(error), 3), 37)
        wide = ar.rmpy(error, self.half, 31)
        narrow = ar.mpy(error, self.half, 20)
        moved = ar.mpy_iqx(error, 20, narrow, 20, 24)
        above = ar.mpy_iqx(error, 20, narrow, 20, 45)
        root = ar.note("int", ar.sqrt(ar.abs(narrow), 20), 20)
        ratio = ar.div(error, narrow, 20)
        inside = ar.clip(ar.abs(narrow), ar.const(Constant("one", 1.0, 20)), self.zero)
        curve = ar.curve(self.square, inside)
        at = ar.at(self.knots, ar.locate(self.knots, root), 1)
        unused = ar.note("unused", ar.neg(at), 20)
        total = ar.dot([self.half, self.low], [unused, state.default], 20)
        flags = ar.where(ar.gt(error, self.low), ar.neg(self.tie), self.tie)
        limited = ar.sat(ar.add(ratio, curve), self.half, ar.maximum(self.low, root))
        notch = ar.quantise(ar.minimum(limited, total), 20, 8)
        far = ar.convert(ar.convert(root, 20, -20), -20, 5)
        ar.note("far", ar.convert(far, 5, 5), 5)
        moved_down = ar.convert(ar.convert(moved, 24, 30), 30, 20)
        state = ToyState(state.second, state.first, ar.add(moved_down, ar.convert(above, 45, 20)))
        return state, LawOutputs(ar.convert(wide, 9, 19), notch, (flags, ar.convert(product, 37, 30), self.zero))


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.needs_compiler
@pytest.mark.parametrize(
    ("indexing", "arithmetic"), [("time", "iq"), ("distance", "float32"), ("distance", "iq"), ("time", "float32")]
)
def test_law_of_every_operation_is_exported(
    indexing: str, arithmetic: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also what the shipped law does not use: swapped state, formats beyond the library, awkward names."""
    plug_in(tmp_path, monkeypatch, toy=Toy)
    tmp_path /= "export"
    written(SCENARIO, tmp_path, indexing, "toy", arithmetic)
    for compiler, flags in (("gcc", SANITIZED), ("clang", STRICT)):
        program = compiled(tmp_path, compiler, flags, "toy_run", "toy")
        done = checked(program, tmp_path / "toy_log.txt")
        assert done.returncode == 0, done.stdout
    text = (tmp_path / "toy.c").read_text()
    for function in ("iq_rmpy(", "_IQ24mpyIQX(", "iq_mpy_iqx("):
        assert (function in text) == (arithmetic == "iq")


class Branching(Toy):
    """A law that asks a value of its own."""

    def step(self, state: ToyState, inputs: LawInputs[Any]) -> tuple[ToyState, LawOutputs[Any]]:
        if self.ar.gt(inputs.speed, self.zero):
            return super().step(state, inputs)
        return super().step(state, inputs._replace(speed=inputs.set_point))


class Mixed(Toy):
    """Adds two formats."""

    def step(self, state: ToyState, inputs: LawInputs[Any]) -> tuple[ToyState, LawOutputs[Any]]:
        self.ar.add(inputs.speed, self.tie)
        return super().step(state, inputs)


class Counting(Toy):
    """Other operations each time."""

    count = 0

    def step(self, state: ToyState, inputs: LawInputs[Any]) -> tuple[ToyState, LawOutputs[Any]]:
        self.count += 1
        state, outputs = super().step(state, inputs)
        return (state, outputs) if self.count < 5 else (state, outputs._replace(notes=(self.tie, *outputs.notes[1:])))


class Deep(Toy):
    """A quotient in a format that no library has."""

    def step(self, state: ToyState, inputs: LawInputs[Any]) -> tuple[ToyState, LawOutputs[Any]]:
        self.ar.div(inputs.speed, self.half, 31)
        return super().step(state, inputs)


class Lost(Toy):
    """A shift that leaves nothing."""

    def step(self, state: ToyState, inputs: LawInputs[Any]) -> tuple[ToyState, LawOutputs[Any]]:
        self.ar.convert(inputs.speed, 20, 52)
        return super().step(state, inputs)


class CountingStart(Toy):
    """A counted limit where the C function has no counters."""

    def start(self, inputs: LawInputs[Any]) -> ToyState:
        return ToyState(self.ar.sat(inputs.speed, self.half, self.zero), inputs.set_point, self.zero)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (CountingStart, "start of the law counts saturations"),
        (Deep, "div with 31 fraction bits"),
        (Lost, "convert from Q20 to Q52"),
        (Branching, "a branch in Python"),
        (Mixed, "add of Q0 and Q20"),
        (Counting, "from its recorded operations"),
    ],
)
def test_law_that_is_no_straight_line_is_refused(
    law: type[Toy], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plug_in(tmp_path, monkeypatch, toy=law)
    with pytest.raises(InputError, match=words):
        written(SCENARIO, tmp_path / "export", "time", "toy")
    assert [path.name for path in tmp_path.iterdir()] == ["plug"]
