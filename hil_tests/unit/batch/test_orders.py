"""Laws as orders in machine code: they compute what the laws compute on arrays, and count what they count."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from railhil.batch.lanes import LANES
from railhil.batch.ordered import OrderedLoop, loop_of
from railhil.batch.orders import Assembly, NotInOrdersError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, INT32_MIN, SATURATION, WRAP, Constant, Curve
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.loop import ControlLoop
from railhil.controller_node.program.model import LawProgram, Program
from railhil.controller_node.program.tracer import Tracer
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import system_named

SCENARIO = load("lvshun_tieshan")
CASES = [(law, indexing) for law in system_named("ato").law_names() for indexing in load_law(law).indexings]
KINDS = (WRAP, SATURATION, DIVISION_BY_ZERO)
#: More than one block, the last of them not full.
TRAINS = 70


def _watched(loop: Any) -> Any:
    loop.arithmetic.per_train = {kind: np.zeros(TRAINS, dtype=np.int64) for kind in KINDS}
    return loop


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
@pytest.mark.parametrize(("law", "indexing"), CASES)
def test_orders_compute_and_count_what_the_law_does(law: str, indexing: str, arithmetic: str) -> None:
    """Speeds and places in no order, so that the limits of the formats are met too."""
    spec = LawSpec(law, arithmetic, indexing)
    ordered = _watched(loop_of(SCENARIO, spec))
    assert isinstance(ordered, OrderedLoop)
    arrays = _watched(ControlLoop(SCENARIO, spec, make(arithmetic, batch=True)))
    random = np.random.Generator(np.random.PCG64(16))
    for k in (*range(4), 100, 101, 330, 390, 391, 600):
        speed, position = random.integers(0, 1_500_000, TRAINS), random.integers(-(2**31), 2**31 - 1, TRAINS)
        speed[: TRAINS // 2] //= 8
        balise = BaliseReading(
            random.integers(0, 9, TRAINS),
            random.integers(0, 30_000_000, TRAINS),
            random.integers(0, 30_000_000, TRAINS),
        )
        found = ordered.step(k, speed, position, balise)[1].notch
        wanted = arrays.step(k, speed, position, balise)[1].notch
        assert np.array_equal(found, wanted), k
        assert ordered.arithmetic.counters == arrays.arithmetic.counters
        for kind in KINDS:
            assert np.array_equal(ordered.arithmetic.per_train[kind], arrays.arithmetic.per_train[kind])
    # Begun anew, with other trains.
    ordered.state = arrays.state = None
    given = (5, np.full(TRAINS, 40_000), np.full(TRAINS, 70_000), BaliseReading(*[np.zeros(TRAINS, int)] * 3))
    assert np.array_equal(ordered.step(*given)[1].notch, np.broadcast_to(arrays.step(*given)[1].notch, TRAINS))


def test_another_arithmetic_has_the_law_on_arrays() -> None:
    for arithmetic in ("iq-portable", "float32"):
        assert isinstance(loop_of(SCENARIO, LawSpec(arithmetic=arithmetic)), ControlLoop)


@cache
def _samples() -> Curve:
    return Curve.sampled("square", lambda x: x * x, 24, 20)


def _all_operations(ar: Any, x: Any, y: Any, half: Any) -> list[Any]:
    """Every operation that has an order, on two numbers in Q20 and a constant."""
    table = ar.table("steps", [Constant(f"step{i}", i - 3.0, 20) for i in range(7)])
    place = ar.locate(table, x)
    return [
        ar.add(x, y),
        ar.sub(x, y),
        ar.neg(x),
        ar.abs(y),
        ar.mpy(x, y, 20),
        ar.rmpy(x, y, 20),
        ar.rsmpy(x, y, 20),
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
        ar.curve(_samples(), ar.convert(ar.clip(x, half, ar.const(Constant("zero", 0.0, 20))), 20, 24)),
    ]


def _law(output: int, wide: bool) -> LawProgram:
    """One of the operations as a law without a state."""
    tracer = Tracer(wide)
    inputs = tracer.begin("inputs")
    x, y = tracer.input("x", 20), tracer.input("y", 20)
    inputs.outputs = [("in.x", x), ("in.y", y)]
    step = tracer.begin("step")
    x, y = tracer.input("in.x", 20), tracer.input("in.y", 20)
    half = tracer.const(Constant("half", 0.5, 20))
    # Twice, so that rows of one are used again for the other.
    _all_operations(tracer, x, y, half)
    step.outputs = [("out.notch", _all_operations(tracer, x, y, half)[output])]
    return LawProgram("all", inputs, Program("start"), step, Program("sent"))


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
@pytest.mark.parametrize("output", range(20))
def test_each_operation_at_the_ends_of_its_range(arithmetic: str, output: int) -> None:
    """Compared with one train; wraps, saturations and divisions by zero are all met."""
    random = np.random.Generator(np.random.PCG64(20))
    edges = [INT32_MIN, INT32_MIN + 1, -(1 << 20), -1, 0, 1, 1 << 19, 1 << 20, 2**31 - 1]
    pairs = [(a, b) for a in edges for b in edges]
    pairs += [tuple(pair) for pair in random.integers(INT32_MIN, 2**31, (47, 2)).tolist()]
    raws = np.array(pairs, dtype=np.int64).T
    one = make(arithmetic)
    loop = OrderedLoop(Assembly(_law(output, one.wide), one), arithmetic)
    loop.arithmetic.per_train = {kind: np.zeros(len(pairs), dtype=np.int64) for kind in KINDS}
    x, y = (loop.arithmetic.from_raw(row, 20) for row in raws)
    found = _carried_out(loop, x, y)
    half = one.const(Constant("half", 0.5, 20))
    counts = []
    for i, (a, b) in enumerate(pairs):
        one = make(arithmetic)
        for _ in range(2):
            wanted = _all_operations(one, one.from_raw(a, 20), one.from_raw(b, 20), half)[output]
        assert repr(found[i].item()) == repr(wanted), (a, b)
        counts.append((one.counters.wraps, one.counters.saturations, one.counters.zero_divisions))
    for kind, row in zip(KINDS, np.array(counts).T, strict=True):
        assert loop.arithmetic.per_train[kind].tolist() == row.tolist()


def _carried_out(loop: OrderedLoop, x: Any, y: Any) -> Any:
    """One period of a law that has no control period and no position."""
    blocks = -(-len(x) // LANES)
    wire = np.zeros((2, blocks * LANES), dtype=loop._dtype)
    wire[:, : len(x)] = x, y
    loop._begin(blocks)
    for orders in (loop._assembly.inputs, loop._assembly.start, loop._assembly.step):
        loop._carry_out(orders, wire)
    loop._count(len(x))
    return loop._row(loop._assembly.notch * LANES)[: len(x)]


def test_what_has_no_order_is_left_to_the_law() -> None:
    tracer = Tracer()
    step = tracer.begin("step")
    step.outputs = [("out.notch", tracer.sqrt(tracer.input("in.x", 20), 20))]
    with pytest.raises(NotInOrdersError, match="sqrt"):
        Assembly(LawProgram("root", Program("inputs"), Program("start"), step, Program("sent")), make("iq"))


def test_a_place_beyond_a_table_is_left_to_the_law() -> None:
    tracer = Tracer()
    step = tracer.begin("step")
    table = tracer.table("two", [Constant("a", 0.0, 20), Constant("b", 1.0, 20)])
    step.outputs = [("out.notch", tracer.at(table, tracer.locate(table, tracer.input("in.x", 20)), 2))]
    with pytest.raises(NotInOrdersError, match="table"):
        Assembly(LawProgram("far", Program("inputs"), Program("start"), step, Program("sent")), make("iq"))
