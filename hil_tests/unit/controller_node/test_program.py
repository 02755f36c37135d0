"""A law recorded as operations: formats are checked, and the recording computes the same as the law."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import INT32_MIN, Constant, Curve
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.cost import C28X_CYCLES, FPU_CYCLES, estimated_cycles
from railhil.controller_node.laws.base import NOTCH_Q
from railhil.controller_node.program.model import BranchError, Evaluator, Kind, Value, map_leaves, name_leaves
from railhil.controller_node.program.tracer import FormatError, Tracer, record
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec

SCENARIO = load("lvshun_tieshan")


def _tracer() -> Tracer:
    tracer = Tracer()
    tracer.begin("part")
    return tracer


def _constant(name: str, value: float, q: int) -> Constant:
    return Constant(name, value, q)


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["iq", "iq-portable", "float64", "float32"])
@pytest.mark.parametrize("indexing", ["time", "distance"])
def test_recorded_program_computes_what_the_law_computes(arithmetic: str, indexing: str) -> None:
    """On arrays of trains with speeds in no order, states and outputs, with other notches sent; bit for bit."""
    number, other = make(arithmetic, batch=True), make(arithmetic, batch=True)
    loop: ControlLoop[Any] = ControlLoop(SCENARIO, LawSpec(indexing=indexing), number)
    programs = record(SCENARIO, LawSpec(indexing=indexing), wide=number.wide)
    inputs, start, step, sent = (
        Evaluator(part, other) for part in (programs.inputs, programs.start, programs.step, programs.sent)
    )
    random = np.random.default_rng(3)
    state: dict[str, Any] | None = None
    for k in range(60):
        speed, position = random.integers(-1000, 250_000, 50), random.integers(0, 30_000_000, 50)
        given, outputs = loop.step(k, speed, position)
        wire = {"speed_01mmps": other.from_raw(speed, 0), "position_01mm": other.from_raw(position, 0)}
        found = inputs.run({"k": k, **wire})
        state = start.run(found) if state is None else state
        after = step.run(state | found)
        notch = random.integers(-1792, 1793, 50)
        loop.sent(number.from_raw(notch, NOTCH_Q))
        law_state, law_outputs = dict(name_leaves(loop.state, "state")), dict(name_leaves(outputs, "out"))
        state = sent.run({name: after[name] for name in law_state} | {"notch": other.from_raw(notch, NOTCH_Q)})
        for name, value in (dict(name_leaves(given, "in")) | law_outputs | law_state).items():
            assert np.array_equal(value, {**found, **after, **state}[name]), f"{name} in period {k}"
    assert number.counters == other.counters


def test_quantities_are_noted_in_the_order_of_the_record() -> None:
    """Telemetry pairs the notes of a step with the names of the record by their place."""
    number = make("iq")
    loop: ControlLoop[int] = ControlLoop(SCENARIO, LawSpec(), number)
    loop.step(0, 0, 0)
    number.noted = []
    loop.step(40, 31_000, 400_000)
    programs = record(SCENARIO, LawSpec())
    names = [quantity.name for quantity in programs.quantities]
    assert len(names) == len(set(names)) == len(number.noted)
    noted = dict(zip(names, number.noted, strict=True))
    assert noted["speed"] == (31_000 * round(3.6e-4 * 2**40)) >> 20
    assert noted["tracking_error"] == noted["set_point"] - noted["speed"]


def test_formats_of_the_state_are_found_where_it_starts_at_zero() -> None:
    formats = {name: value.q for name, value in record(SCENARIO, LawSpec()).sent.inputs}
    assert (formats["state.model[0]"], formats["state.model[1]"], formats["state.notch"]) == (24, 24, 24)
    assert formats["state.tracking_error"] == 20


def test_set_points_are_part_of_the_counted_operations() -> None:
    """One look-up for the set-point and one for each of its ten successors; by distance two more tables."""
    by_time, by_distance = (
        record(SCENARIO, LawSpec(indexing=indexing)).step_counts() for indexing in ("time", "distance")
    )
    assert by_time["at"] == 11
    assert by_distance["at"] == 11 + 2 + 2 * 11
    assert by_distance["locate_step"] == 13
    assert by_distance["rmpy"] == by_time["rmpy"] + 11
    assert by_distance["div"] == by_time["div"] + 1


def test_dot_counts_as_its_products_and_sums() -> None:
    tracer = _tracer()
    assert tracer.program is not None
    values = [tracer.input(name, 20) for name in "abcd"]
    tracer.dot(values[:2], values[2:], 20)
    tracer.abs(values[0])
    assert tracer.program.counts() == Counter({"rmpy": 2, "add": 1, "abs": 1})


def test_every_operation_of_a_law_has_its_cycles() -> None:
    """An operation without a figure is refused, not free."""
    assert set(C28X_CYCLES) == set(FPU_CYCLES)
    assert estimated_cycles(Counter({"rmpy": 2, "add": 1})) == 2 * (17 + 2) + (2 + 2)
    assert estimated_cycles(Counter({"div": 1}), FPU_CYCLES) == 25 + 2
    with pytest.raises(KeyError, match="teleport"):
        estimated_cycles(Counter({"teleport": 1}))


def test_result_formats_follow_from_the_operands() -> None:
    tracer = _tracer()
    a, b = tracer.input("a", 20), tracer.input("b", 24)
    small = tracer.input("small", 24)
    assert tracer.mpy(a, b, 25).q == 19
    assert tracer.rmpy(a, b, 21).q == 23
    assert tracer.rsmpy(a, b, 24).q == 20
    assert tracer.mpy_iqx(a, 20, b, 24, 16).q == 16
    assert tracer.dot([a, a], [b, b], 25).q == 19
    assert tracer.div(b, small, 20).q == 20
    assert tracer.sqrt(a, 20).q == 20
    assert tracer.convert(a, 20, 8).q == 8
    assert tracer.quantise(a, 20, 8).q == 8
    condition = tracer.gt(a, a)
    assert (condition.q, condition.kind) == (None, Kind.CONDITION)
    assert tracer.where(condition, b, b).q == 24
    zero = tracer.const(_constant("zero", 0.0, 5))
    assert tracer.add(zero, a).q == 20, "0 is 0 in every format"


def test_mixed_formats_are_refused() -> None:
    """Each operation that compares or joins its operands, and each place where a law states a format."""
    tracer = _tracer()
    a, b = tracer.input("a", 20), tracer.input("b", 24)
    condition = tracer.gt(a, a)
    curve = Curve.sampled("line", float, 24, 20)
    table = tracer.table("t", [_constant("t0", 1.0, 24), _constant("t1", 2.0, 24)])
    wrong = {
        "add of Q20 and Q24": lambda: tracer.add(a, b),
        "sub of Q20 and Q24": lambda: tracer.sub(b, a),
        "gt of Q20 and Q24": lambda: tracer.gt(a, b),
        "div of Q20 and Q24": lambda: tracer.div(a, b, 20),
        "where of Q20 and Q24": lambda: tracer.where(condition, a, b),
        "sat of Q20 and Q24": lambda: tracer.sat(a, b, a),
        "clip of Q20 and Q24": lambda: tracer.clip(a, a, b),
        "minimum of Q20 and Q24": lambda: tracer.minimum(a, b),
        "maximum of Q20 and Q24": lambda: tracer.maximum(a, b),
        "dot of Q20 and Q24": lambda: tracer.dot([a, b], [a, a], 20),
        "dot of 2 coefficients and 1 values": lambda: tracer.dot([a, a], [a], 20),
        "convert of a Q20 as if it were Q24": lambda: tracer.convert(a, 24, 20),
        "quantise of a Q20 as if it were Q24": lambda: tracer.quantise(a, 24, 20),
        "sqrt of a Q20 as if it were Q24": lambda: tracer.sqrt(a, 24),
        "mpy_iqx of a Q24 as if it were Q20": lambda: tracer.mpy_iqx(a, 20, b, 20, 20),
        "note speed of a Q20 as if it were Q19": lambda: tracer.note("speed", a, 19),
        "raw of a Q20 as if it were Q8": lambda: tracer.raw(a, 8),
        "curve line of a Q20 as if it were Q24": lambda: tracer.curve(curve, a),
        "locate in t of a Q20 as if it were Q24": lambda: tracer.locate(table, a),
        "table mixed of Q20 and Q24": lambda: tracer.table("mixed", [_constant("x", 1, 20), _constant("y", 1, 24)]),
    }
    for words, operation in wrong.items():
        with pytest.raises(FormatError, match=words):
            operation()


def test_wide_arithmetic_has_no_formats_to_check() -> None:
    tracer = Tracer(wide=True)
    tracer.begin("part")
    tracer.add(tracer.input("a", 20), tracer.input("b", 24))


def test_two_quantities_of_one_name_are_refused() -> None:
    tracer = _tracer()
    a = tracer.input("a", 20)
    tracer.note("speed", a, 20)
    with pytest.raises(FormatError, match="two quantities are called speed"):
        tracer.note("speed", a, 20)


def test_operation_outside_of_a_function_is_refused() -> None:
    """A law that computes in its constructor would do so in Python only."""
    with pytest.raises(FormatError, match="outside of a law's functions"):
        Tracer().add(Value(0, 20), Value(1, 20))


def test_branch_on_a_value_is_refused() -> None:
    tracer = _tracer()
    a = tracer.input("a", 20)
    with pytest.raises(BranchError, match=r"Arithmetic\.where"):
        assert tracer.gt(a, a)


@pytest.mark.parametrize("value", [2.5, -2.5, 3.0, float(INT32_MIN)])
def test_negative_constant_is_that_of_the_integer(value: float) -> None:
    """A constant between two integers is rounded once, as the fixed point does it; INT32_MIN has no negative."""
    constant = _constant("x", value, 0)
    number: Any = make("iq")
    negative = Tracer().neg(Tracer().const(constant))
    assert negative.constant is not None
    assert negative.constant.raw == number.neg(constant.raw)
    assert negative.constant.name == "-x"


def test_leaves_and_like_are_each_other_s_inverse() -> None:
    state = record(SCENARIO, LawSpec()).step
    names = [name for name, _ in state.inputs]
    assert names[:4] == ["state.model[0]", "state.model[1]", "state.notch", "state.model_errors[0]"]
    nested = ((1, [2, 3]), 4)
    assert list(name_leaves(nested)) == [("[0][0]", 1), ("[0][1][0]", 2), ("[0][1][1]", 3), ("[1]", 4)]
    assert map_leaves(nested, lambda name, old: (name, old))[0][1] == (("[0][1][0]", 2), ("[0][1][1]", 3))
