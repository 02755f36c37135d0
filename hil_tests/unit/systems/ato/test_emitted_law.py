"""The law as machine code computes what the law on arrays does, and counts the same events train by train."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP, Constant, Curve
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.program.model import Program
from railhil.controller_node.program.ranges import analyse
from railhil.controller_node.program.tracer import Tracer
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import system_named
from railhil.systems.ato.batch.emitted_law import EmittedLoop, EmittedProgram, loop_of

SCENARIO = load("lvshun_tieshan")
ARITHMETICS = ("iq", "float64", "float32")
CASES = [(law, indexing) for law in system_named("ato").law_names() for indexing in load_law(law).indexings]
KINDS = (WRAP, SATURATION, DIVISION_BY_ZERO)
TRAINS = 70


def _watched(loop: Any) -> Any:
    loop.arithmetic.per_train = {kind: np.zeros(TRAINS, dtype=np.int64) for kind in KINDS}
    return loop


def _same(spec: LawSpec) -> None:
    """Speeds and places in no order, so that the limits of the formats are met too."""
    emitted = _watched(loop_of(SCENARIO, spec))
    assert isinstance(emitted, EmittedLoop)
    arrays = _watched(ControlLoop(SCENARIO, spec, make(spec.arithmetic, batch=True)))
    random = np.random.Generator(np.random.PCG64(16))
    for k in (*range(4), 100, 101, 330, 390, 391, 600):
        speed, position = random.integers(0, 1_500_000, TRAINS), random.integers(-(2 * 10**9), 2 * 10**9, TRAINS)
        speed[: TRAINS // 2] //= 8
        balise = BaliseReading(
            random.integers(0, 9, TRAINS),
            random.integers(0, 30_000_000, TRAINS),
            random.integers(0, 30_000_000, TRAINS),
        )
        found = emitted.step(k, speed, position, balise)[1].notch
        wanted = arrays.step(k, speed, position, balise)[1].notch
        assert np.array_equal(found, np.broadcast_to(wanted, TRAINS)), k
        assert emitted.arithmetic.counters == arrays.arithmetic.counters
        for kind in KINDS:
            assert np.array_equal(emitted.arithmetic.per_train[kind], arrays.arithmetic.per_train[kind])
    # Begun anew, with other trains.
    emitted.state = arrays.state = None
    for k in (5, 6):
        given = (k, np.full(TRAINS, 40_000), np.full(TRAINS, 70_000), BaliseReading(*[np.zeros(TRAINS, int)] * 3))
        wanted = np.broadcast_to(arrays.step(*given)[1].notch, TRAINS)
        assert np.array_equal(emitted.step(*given)[1].notch, wanted)


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_a_law_is_the_same(arithmetic: str) -> None:
    _same(LawSpec("tpfc2", arithmetic))


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize(("law", "indexing"), CASES)
def test_every_law_is_the_same(law: str, indexing: str, arithmetic: str) -> None:
    _same(LawSpec(law, arithmetic, indexing))


def test_another_arithmetic_has_the_law_on_arrays() -> None:
    for arithmetic in ("iq-portable", "float32-truncated"):
        assert isinstance(loop_of(SCENARIO, LawSpec(arithmetic=arithmetic)), ControlLoop)


def test_a_law_is_made_once_for_all_chunks() -> None:
    loops = [loop_of(SCENARIO, LawSpec("tpfc2")) for _ in range(2)]
    assert loops[0]._step is loops[1]._step
    assert loops[0].arithmetic is not loops[1].arithmetic


@cache
def _samples() -> Curve:
    return Curve.sampled("square", lambda x: x * x, 24, 20)


def _all_operations(ar: Any, x: Any, y: Any, half: Any) -> list[Any]:
    """Every operation that can be emitted, on two numbers in Q20 and a constant."""
    table = ar.table("steps", [Constant(f"step{i}", i - 3.0, 20) for i in range(7)])
    place = ar.locate(table, x)
    return [
        ar.add(x, y),
        ar.sub(x, y),
        ar.neg(x),
        ar.abs(y),
        ar.mpy(x, y, 20),
        ar.rmpy(x, y, 20),
        ar.rsmpy(x, y, 12),
        ar.mpy_iqx(x, 20, y, 20, 20),
        ar.dot((half, x, half), (x, y, y), 20),
        ar.div(x, y, 20),
        ar.sat(x, half, ar.neg(half)),
        ar.clip(x, half, y),
        ar.minimum(x, y),
        ar.maximum(x, y),
        ar.where(ar.gt(x, y), x, half),
        ar.convert(x, 20, 24),
        ar.convert(x, 20, 8),
        ar.convert(ar.quantise(x, 20, 8), 8, 20),
        ar.add(ar.at(table, place), ar.at(table, place, 1)),
    ]


def _program(wide: bool) -> Program:
    tracer = Tracer(wide)
    step = tracer.begin("step")
    x, y = tracer.input("in.x", 20), tracer.input("in.y", 20)
    half = tracer.const(Constant("half", 0.5, 20))
    results = _all_operations(tracer, x, y, half)
    if not wide:
        limited = tracer.clip(x, half, tracer.const(Constant("zero", 0.0, 20)))
        results.append(tracer.curve(_samples(), tracer.convert(limited, 20, 24)))
    step.outputs = [(f"out[{i}]", result) for i, result in enumerate(results)]
    return step


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_each_operation_at_the_ends_of_its_range(arithmetic: str) -> None:
    """Compared with one train: the same numbers, or it is left because one train counts something or has limits in the
    wrong order."""
    most = 1 << 23
    random = np.random.Generator(np.random.PCG64(20))
    edges = [-most, -most + 1, -(1 << 20), -1, 0, 1, 1 << 19, 1 << 20, most]
    pairs = [(a, b) for a in edges for b in edges]
    pairs += [tuple(pair) for pair in random.integers(-most, most + 1, (147, 2)).tolist()]
    one = make(arithmetic)
    program = _program(one.wide)
    ranges = None if one.wide else analyse(program, {"in.x": (-most, most), "in.y": (-most, most)})
    assert ranges is None or not ranges.may_wrap
    given = np.array([[one.from_raw(a, 20), one.from_raw(b, 20)] for a, b in pairs])
    left = np.zeros(len(pairs), dtype=np.bool_)
    found = EmittedProgram(program, "a law", arithmetic, ranges).run(given[:, :0].copy(), given, left)
    half = one.const(Constant("half", 0.5, 20))
    counted = []
    for i, (a, b) in enumerate(pairs):
        one = make(arithmetic)
        x, y = one.from_raw(a, 20), one.from_raw(b, 20)
        wanted = _all_operations(one, x, y, half)
        if not one.wide:
            limited = one.clip(x, half, one.const(Constant("zero", 0.0, 20)))
            wanted.append(one.curve(_samples(), one.convert(limited, 20, 24)))
        counted.append(one.counters.flags != 0 or (not one.wide and b > half))
        if not left[i]:
            assert [repr(number) for number in found[i].tolist()] == [repr(number) for number in wanted], (a, b)
    assert left.tolist() == counted
    assert any(counted) is not one.wide


def test_what_cannot_be_emitted_is_left_to_the_law() -> None:
    tracer = Tracer()
    step = tracer.begin("step")
    step.outputs = [("out.notch", tracer.sqrt(tracer.input("in.x", 20), 20))]
    with pytest.raises(KeyError, match="sqrt"):
        EmittedProgram(step, "a law", "iq", None)


#: A law's function in a process of its own: the value that it computes.
_MORE = """
from railhil.batch import compiled
compiled._SAID_AFTER_S = 0.0
print(compiled.cached_text("def more(a):\\n    return a + 1\\n", "more", "a law in iq")(2))
"""


@pytest.mark.slow
def test_a_law_is_compiled_once_for_all_processes_and_says_so(tmp_path: Path) -> None:
    def ran() -> tuple[str, str, list[tuple[str, int]]]:
        done = subprocess.run(
            [sys.executable, "-c", _MORE],
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
            capture_output=True,
            text=True,
            timeout=100,
            check=True,
        )
        kept = [(path.name, path.stat().st_mtime_ns) for path in tmp_path.rglob("*.nb?")]
        return done.stdout, done.stderr, sorted(kept)

    first, second = ran(), ran()
    assert first[0] == second[0] == "3\n"
    assert first[1] == "compiling a law in iq for the batch (once for this machine; up to half a minute) ...\n"
    assert second[1] == ""
    assert len(first[2]) == 2
    assert first[2] == second[2]
