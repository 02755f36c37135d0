"""A law as C28x instructions: every operation and every word of a law, and the machine's own rules."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.cli import railhil
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, Constant, Curve
from railhil.controller_node.cost import C28X_CYCLES, estimated_cycles
from railhil.controller_node.export.bundle import control_of
from railhil.controller_node.export.c28x import Function, LawStream
from railhil.controller_node.export.c28x_machine import INSTRUCTIONS, Instruction, Loc, Machine, Mode, signed
from railhil.controller_node.export.c28x_writer import Layout
from railhil.controller_node.export.reference import count_equal_periods
from railhil.controller_node.program.model import Evaluator
from railhil.controller_node.program.tracer import Tracer
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec

SCENARIO = load("lvshun_tieshan")

EDGES = st.sampled_from((INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX - 1, INT32_MAX))
INT32 = st.one_of(EDGES, st.integers(INT32_MIN, INT32_MAX), st.integers(-100, 100))
WORD = INT32.map(lambda a: a & 0xFFFF_FFFF)
CURVE = Curve.sampled("square", lambda x: 2 * x * x - 1, 20, 28)
CELL = Loc(Mode.STACK, 2)

Make = Callable[[Tracer, Any, Any, Any], Any]


def _sum_of_products(ar: Tracer, a: Any, b: Any, c: Any) -> Any:
    factor = ar.const(Constant("factor", -0.7, 24))
    return ar.dot([factor, factor, b], [a, b, c], 24)


def _choice(ar: Tracer, a: Any, b: Any, c: Any) -> Any:
    return ar.where(ar.gt(a, b), ar.sub(c, a), b)


def _entry(ar: Tracer, a: Any, b: Any, c: Any) -> Any:
    """Entries by two indices, before and after a curve, which needs the register of the index too."""
    table = ar.table("table", [Constant(f"t{i}", i * i - 9.0, 20) for i in range(12)])
    index = ar.index(a, 9)
    first = ar.convert(ar.add(ar.at(table, index), ar.at(table, ar.index(b, 5))), 20, 24)
    curved = ar.curve(CURVE, ar.const(Constant("half", 0.5, 20)))
    return ar.add(first, ar.add(ar.convert(curved, 28, 24), ar.convert(ar.at(table, index, 2), 20, 24)))


OPERATIONS: dict[str, Make] = {
    "add": lambda ar, a, b, c: ar.add(a, ar.add(b, c)),
    "sub": lambda ar, a, b, c: ar.sub(a, ar.sub(b, c)),
    "neg": lambda ar, a, b, c: ar.neg(a),
    "abs": lambda ar, a, b, c: ar.abs(a),
    "minimum": lambda ar, a, b, c: ar.minimum(a, ar.minimum(b, c)),
    "maximum": lambda ar, a, b, c: ar.maximum(ar.maximum(b, c), a),
    "clip": lambda ar, a, b, c: ar.clip(a, b, c),
    "sat": lambda ar, a, b, c: ar.sat(ar.neg(a), b, c),
    "where": _choice,
    "dot": _sum_of_products,
    "at": _entry,
    "square": lambda ar, a, b, c: ar.mpy(a, a, 24),
    "up": lambda ar, a, b, c: ar.convert(a, 24, 45),
    "down": lambda ar, a, b, c: ar.convert(a, 24, 3),
    "quantise": lambda ar, a, b, c: ar.quantise(a, 24, 5),
}


def _compare(program_of: Make, values: Sequence[int]) -> None:
    """Run one function as recorded, and as instructions."""
    tracer = Tracer()
    program = tracer.begin("part")
    inputs = [tracer.input(name, 24) for name in "abc"]
    program.outputs = [("a", program_of(tracer, *inputs)), ("b", inputs[0])]
    layout, machine = Layout(), Machine()
    function = Function(program, layout, machine)
    machine.memory |= layout.words
    given_values = dict(zip("abc", values, strict=True))
    assert function.run(given_values) == Evaluator(program, make("iq")).run(given_values)


@pytest.mark.slow
@pytest.mark.parametrize("name", OPERATIONS)
@settings(deadline=None, max_examples=60)
@given(values=st.tuples(INT32, INT32, INT32))
def test_an_operation_gives_the_same_word(name: str, values: tuple[int, int, int]) -> None:
    """Also where it wraps, and where an output replaces an input that another output needs."""
    _compare(OPERATIONS[name], values)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mpy", "rmpy", "rsmpy", "div"])
@settings(deadline=None, max_examples=150)
@given(values=st.tuples(INT32, INT32, INT32), q=st.integers(1, 30))
def test_a_product_or_quotient_gives_the_same_word_in_each_format(
    name: str, values: tuple[int, int, int], q: int
) -> None:
    """Rounded with ties upward, saturated, divided by zero."""
    _compare(lambda ar, a, b, c: getattr(ar, name)(a, b, q), values)


@settings(deadline=None, max_examples=60)
@given(a=st.integers(-200, 200), q=st.integers(1, 28), sign=st.sampled_from((-1, 1)))
def test_half_a_unit_of_a_quotient_is_rounded_upward(a: int, q: int, sign: int) -> None:
    _compare(lambda ar, a, b, c: ar.div(a, b, q), (a, sign << (q + 1), 0))


@settings(deadline=None, max_examples=60)
@given(values=st.tuples(INT32, INT32, INT32), q=st.integers(31, 62))
def test_a_product_keeps_its_sign_when_more_than_its_lower_half_is_shifted_out(
    values: tuple[int, int, int], q: int
) -> None:
    _compare(lambda ar, a, b, c: ar.rmpy(a, b, q), values)


@settings(deadline=None, max_examples=60)
@given(a=st.integers(0, 2**20))
def test_a_curve_gives_the_same_word(a: int) -> None:
    def of_curve(ar: Tracer, a: Any, b: Any, c: Any) -> Any:
        return ar.curve(CURVE, ar.convert(a, 24, 20))

    _compare(of_curve, (a << 4, 0, 0))


def test_values_that_the_stack_does_not_reach_are_in_data_memory() -> None:
    def many(ar: Tracer, a: Any, b: Any, c: Any) -> Any:
        values = [ar.mpy(a, ar.const(Constant(f"f{i}", i / 8, 24)), 24) for i in range(40)]
        total = b
        for value in values:
            total = ar.sub(value, total)
        return total

    _compare(many, (123456, -5, 0))


@pytest.mark.slow
@pytest.mark.long_after(2)
@pytest.mark.parametrize("law", ["ipfc", "ipfc_plus", "tpfc1", "tpfc2", "fuzzy_pid", "tdmc", "ipfc_plus_stop"])
def test_the_instructions_of_a_law_compute_its_words(law: str) -> None:
    control = control_of(SCENARIO, LawSpec(controller=law))
    stream = LawStream(control.programs)
    assert count_equal_periods(control, stream.function, "its instructions") == 480
    # Inline instructions take fewer cycles than calls of TI's library, and every operation takes some.
    counts = control.programs.step_counts()
    assert 0.4 * estimated_cycles(counts) < stream.cycles.total() < estimated_cycles(counts)
    assert set(counts) <= set(stream.cycles)
    assert set(stream.cycles) - set(C28X_CYCLES) == {"outputs", "call, return, modes"}


def test_a_law_that_differs_from_its_instructions_is_named() -> None:
    control = control_of(SCENARIO, LawSpec(controller="ipfc_plus"))
    stream = LawStream(control.programs)
    instructions = stream.function(control.programs.step).stream
    place = next(i for i, of in enumerate(instructions) if of.syntax == "SUBL ACC,loc32")
    instructions[place] = instructions[place]._replace(syntax="ADDL ACC,loc32")
    with pytest.raises(InputError, match=r"from its instructions, .* from the law"):
        count_equal_periods(control, stream.function, "its instructions")


def _machine(acc: int = 0, p: int = 0, xt: int = 0, operand: int = 0) -> Machine:
    machine = Machine()
    machine.acc, machine.p, machine.xt, machine.sp = acc, p, xt, 2
    machine.memory[0] = operand
    return machine


def _run(machine: Machine, *syntaxes: str, number: int = 0) -> Machine:
    machine.execute([Instruction(syntax, CELL if "loc" in syntax else None, number) for syntax in syntaxes])
    return machine


@given(numerator=WORD, divisor=WORD.filter(bool))
def test_32_conditional_subtractions_divide(numerator: int, divisor: int) -> None:
    machine = _machine(p=numerator, operand=divisor)
    _run(machine, "RPT #8bit", "SUBCUL ACC,loc32", number=31)
    assert (machine.p, machine.acc) == divmod(numerator, divisor)


@given(acc=WORD, p=WORD, high=WORD, low=WORD)
def test_64_bits_are_added_with_the_carry_and_compared_by_halves(acc: int, p: int, high: int, low: int) -> None:
    def run(*halves: str) -> int:
        machine = _machine(acc, p)
        for syntax in halves:
            machine.memory[0] = low if " P," in syntax else high
            _run(machine, syntax)
        return signed(machine.acc) << 32 | machine.p

    a, b = (signed(x) << 32 | y for x, y in ((acc, p), (high, low)))
    assert (run("ADDUL P,loc32", "ADDCL ACC,loc32") - a - b) % 2**64 == 0
    assert run("MINL ACC,loc32", "MINCUL P,loc32") == min(a, b)
    assert run("MAXL ACC,loc32", "MAXCUL P,loc32") == max(a, b)


@given(a=WORD, b=WORD)
def test_conditions_follow_the_exact_difference(a: int, b: int) -> None:
    machine = _run(_machine(a, operand=b), "CMPL ACC,loc32")
    for condition, expected in (("GT", signed(a) > signed(b)), ("LT", signed(a) < signed(b)), ("HIS", a >= b)):
        machine.memory[0] = 0xABCD_0000
        machine.execute([Instruction("MOVB loc16,#8bit,COND", CELL, 1, condition=condition)])
        assert machine.memory[0] == 0xABCD_0000 + expected


@pytest.mark.parametrize(("ovm", "results"), [(False, [0x8000_0000, -1]), (True, [0x7FFF_FFFF, 0])])
def test_the_overflow_mode_saturates_or_counts(ovm: bool, results: list[int]) -> None:
    machine = _machine(acc=0x8000_0000, operand=1)
    machine.ovm = ovm
    assert _run(machine, "NEG ACC").acc == results[0]
    machine.acc = 0x8000_0000
    assert _run(machine, "SUBL ACC,loc32").ovc == results[1]
    assert machine.acc == (0x8000_0000 if ovm else 0x7FFF_FFFF)


@given(a=WORD, b=WORD)
def test_signs_are_taken_off_and_put_on_again(a: int, b: int) -> None:
    """TC is the sign of a product or quotient; the smallest number stays."""
    machine = _machine()
    for value in (a, b):
        machine.acc = value
        assert _run(machine, "ABSTC ACC").acc == abs(signed(value))
    assert machine.tc == ((signed(a) < 0) != (signed(b) < 0))
    assert _run(machine, "NEGTC ACC").acc == (-abs(signed(b)) if machine.tc else abs(signed(b))) & 0xFFFF_FFFF


@pytest.mark.parametrize(("p", "carry"), [(0xFFFF_FFFE, False), (0xFFFF_FFFF, True)])
def test_an_unsigned_sum_counts_its_carry(p: int, carry: bool) -> None:
    machine = _run(_machine(p=p, operand=1), "ADDUL P,loc32")
    assert (machine.c, machine.z, machine.ovc) == (carry, carry, carry)


def test_the_pipeline_waits_for_what_has_just_been_written() -> None:
    """Section 4.4 of the guide: a read of a location that the instruction before it writes is held for three cycles."""
    store, read = Instruction("MOVL loc32,ACC", CELL), Instruction("MOVL XT,loc32", CELL)
    other, entry = Instruction("NEG ACC"), Instruction("MOVL ACC,loc32", Loc(Mode.INDEXED, 4))
    assert _machine().measure([store, read]) == [1, 4]
    assert _machine().measure([store, other, read]) == [1, 1, 3]
    assert _machine().measure([store, other, other, other, read]) == [1, 1, 1, 1, 1]
    assert _machine().measure([read, store]) == [1, 1]
    to_ar0 = Instruction("MOVL XARn,loc32", Loc(Mode.ACC))
    assert _machine().measure([to_ar0, Instruction("MOVL XARn,#22bit", register=4), entry]) == [1, 1, 3]
    assert _machine(operand=1).measure(
        [Instruction("RPT #8bit", number=31), Instruction("SUBCUL ACC,loc32", CELL)]
    ) == [
        1,
        32,
    ]


def test_a_product_takes_the_cycles_that_ti_states_for_its_functions() -> None:
    """In Q16 and more, with call and return: 13, 16 rounded, 20 saturated; the last two load the address of a table."""
    product = ["LCR #22bit", "MOVL XT,loc32", "IMPYL P,XT,loc32", "QMPYL ACC,XT,loc32", "LSL64 ACC:P,#1..16", "LRETR"]
    rounding = ["MOVL XARn,#22bit", "ADDUL P,loc32", "ADDCL ACC,loc32"]
    limits = ["MINL ACC,loc32", "MINCUL P,loc32", "MAXL ACC,loc32", "MAXCUL P,loc32"]
    taken = [sum(INSTRUCTIONS[of].cycles for of in part) for part in (product, rounding, limits)]
    assert list(accumulate(taken)) == [13, 16, 20]


def test_instructions_are_written_as_in_the_guide() -> None:
    listed = [
        Instruction("MOVB loc16,#8bit,COND", CELL, 1, condition="GT"),
        Instruction("LSL64 ACC:P,#1..16", number=4),
        Instruction("MOVL XARn,#22bit", number=49152, register=5),
        Instruction("MOVL ACC,loc32", Loc(Mode.INDEXED, 5)),
    ]
    assert [str(of) for of in listed] == [
        "MOVB *-SP[2],#1,GT",
        "LSL64 ACC:P,#4",
        "MOVL XAR5,#49152",
        "MOVL ACC,*+XAR5[AR0]",
    ]


def test_a_second_word_has_a_long_constant_or_the_operand_of_an_opcode_that_fills_the_first() -> None:
    """Opcodes in chapter 6 of the guide: those of the operations listed here begin with 56h."""
    fill_first = {"ADDUL", "ADDCL", "IMPYL", "QMPYL", "MINL", "MAXL", "MINCUL", "MAXCUL", "SUBCUL"}
    for syntax, cost in INSTRUCTIONS.items():
        has_long_constant = "#16bit" in syntax or "#22bit" in syntax
        has_condition = syntax.endswith(",COND")
        assert cost.words == 1 + (has_long_constant or has_condition or syntax.split()[0] in fill_first), syntax
        assert cost.cycles >= 1


@pytest.mark.slow
def test_the_export_lists_the_instructions_and_their_cycles(tmp_path: Path) -> None:
    done = railhil("export-c", "ipfc_plus", "--out", tmp_path / "out", "--c28x")
    assert done.exit_code == 0
    assert "every word of 480 control periods is the law's, no chip has run it" in done.out
    listing = (tmp_path / "out" / "ipfc_plus_c28x.txt").read_text(encoding="ascii")
    assert all(f"\n{name}:\n" in listing for name in ("inputs", "start", "step", "sent"))
    # The instructions of an earlier export are not those of this one.
    assert railhil("export-c", "ipfc_plus", "--out", tmp_path / "out", "--force").exit_code == 0
    assert not (tmp_path / "out" / "ipfc_plus_c28x.txt").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "found"),
    [(("--indexing", "distance"), "has locate"), (("--arithmetic", "float32"), "used only with the arithmetic iq")],
)
def test_a_law_without_straight_lines_is_refused_before_anything_is_written(
    tmp_path: Path, options: tuple[str, str], found: str
) -> None:
    done = railhil("export-c", "ipfc", "--out", tmp_path / "out", "--c28x", *options)
    assert done.exit_code == 2
    assert found in done.err
    assert len(done.said) == 1
    assert not (tmp_path / "out").exists()
