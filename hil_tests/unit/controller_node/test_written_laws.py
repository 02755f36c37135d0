"""The laws written out as straight-line functions: they are in the tree as generated, and compute what the laws do."""

from __future__ import annotations

import runpy
from array import array
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import railhil
from hil_tests.support.paths import ROOT
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN
from railhil.controller_node.controller import Controller
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.laws.ipfc import Ipfc
from railhil.controller_node.program.leaves import leaves
from railhil.controller_node.program.model import Program, Value
from railhil.controller_node.program.ranges import analyse_law
from railhil.controller_node.program.record import record
from railhil.controller_node.program.shape import shape_of
from railhil.controller_node.program.tracer import Tracer
from railhil.controller_node.program.writer import FIXED, FLOAT32, FLOAT64, written
from railhil.controller_node.straight import straight
from railhil.controller_node.vector.controller import VectorController, VectorLoop
from railhil.controller_node.written.generate import LAWS, STOP_LAW, texts
from railhil.controller_node.written.parts import Parts
from railhil.scenarios.load import load, load_any
from railhil.scenarios.run_spec import LawSpec

SCENARIO = load("lvshun_tieshan")
CASES = [(law, indexing) for law in LAWS for indexing in load_law(law).indexings]
ARITHMETICS = ["iq", "iq-portable", "float64", "float32"]
#: Control period, speed in 0.1 mm/s, odometer in 0.1 mm; the speeds go beyond what a wire can bring.
STEP = st.tuples(st.integers(0, 420), st.integers(-10, 1_500_000), st.integers(-(2**31), 2**31 - 1))
#: A notch sent instead of the law's, or none.
SENT = st.one_of(st.none(), st.integers(-1792, 1792))


@pytest.mark.slow
def test_written_functions_are_what_the_laws_compute() -> None:
    """Else: make tables."""
    folder = ROOT / "controller_node" / "written"
    found = dict(texts())
    assert {path.name for path in folder.glob("*.py")} == {*found, "__init__.py", "generate.py", "parts.py"}
    for name, text in found.items():
        assert (folder / name).read_text(encoding="utf-8") == text, name


@cache
def _pair(law: str, indexing: str, arithmetic: str) -> tuple[Controller, Controller]:
    """A controller as the node has it, and one that always computes the law itself."""
    controllers = [Controller(SCENARIO, LawSpec(law, arithmetic, indexing)) for _ in range(2)]
    assert controllers[0]._loop.straight is not None
    controllers[1]._loop.straight = None
    return controllers[0], controllers[1]


def _began_anew(controller: Controller) -> Controller:
    controller._loop.state = None
    return controller


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize(("law", "indexing"), CASES)
@settings(max_examples=12, deadline=None)
@given(steps=st.lists(st.tuples(STEP, SENT), min_size=2, max_size=6))
def test_outputs_state_telemetry_and_counters_are_those_of_the_law(
    law: str, indexing: str, arithmetic: str, steps: list[tuple[tuple[int, int, int], int | None]]
) -> None:
    fast, slow = map(_began_anew, _pair(law, indexing, arithmetic))
    for (k, speed, position), sent in steps:
        balise = BaliseReading(k % 5, position // 3, position // 2)
        assert fast.step(k, speed, position, balise) == slow.step(k, speed, position, balise)
        if sent is not None:
            fast.sent(sent)
            slow.sent(sent)
        # As text: 0.0 and -0.0 are equal.
        assert repr(list(leaves(fast._loop.state))) == repr(list(leaves(slow._loop.state)))
    assert fast.telemetry.rows == slow.telemetry.rows
    assert fast.counters == slow.counters


@cache
def _stopping(arithmetic: str) -> tuple[VectorController, VectorController]:
    """As :func:`_pair`, for the law of the system ``stop`` that learns."""
    scenario = load_any("yizhuang_stop_closed")
    controllers = [VectorController(scenario, LawSpec(STOP_LAW, arithmetic)) for _ in range(2)]
    assert controllers[0]._loop.straight is not None
    controllers[1]._loop.straight = None
    return controllers[0], controllers[1]


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_law_of_several_readings_gives_what_it_computes_itself(arithmetic: str, data: st.DataObject) -> None:
    fast, slow = _stopping(arithmetic)
    for controller in (fast, slow):
        controller._loop.state = None
    ranges = list(fast.wire.values())
    # Anything that the bus can bring, and what a train does: small steps from one period to the next.
    raws = [data.draw(st.integers(low, high)) for low, high in ranges]
    for _ in range(data.draw(st.integers(2, 8))):
        assert fast.step(raws) == slow.step(raws)
        assert repr(list(leaves(fast.state))) == repr(list(leaves(slow.state)))
        if data.draw(st.booleans()):
            told = [data.draw(st.integers(-50, 50)) for _ in fast.commands]
            fast.sent(*told)
            slow.sent(*told)
        moved = data.draw(st.integers(-2000, 2000))
        raws = [min(max(raw + moved, low), high) for raw, (low, high) in zip(raws, ranges, strict=True)]
    assert fast.telemetry.rows == slow.telemetry.rows
    assert fast.counters == slow.counters
    assert repr(fast.kept()) == repr(slow.kept())


@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["iq", "float64", "float32"])
def test_a_whole_stop_is_computed_by_the_functions(
    arithmetic: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not only that they are bound: nearly every period is theirs, and the record is that of the law."""
    taken: list[bool] = []
    original = VectorLoop.written_out

    def counted(loop: VectorLoop[Any], wire: Any) -> Any:
        done = original(loop, wire)
        taken.append(done is not None)
        return done

    def run(folder: str) -> str:
        outcome = railhil.run(
            "yizhuang_stop_closed", controller=STOP_LAW, arithmetic=arithmetic, bus="local", out=tmp_path / folder
        )
        return outcome.frames_sha256

    monkeypatch.setattr(VectorLoop, "written_out", counted)
    fast = run("fast")
    assert len(taken) > 1000
    assert sum(taken) > 0.99 * len(taken)
    monkeypatch.setattr("railhil.controller_node.vector.controller.straight", lambda *_: None)
    assert run("slow") == fast


@pytest.mark.parametrize("arithmetic", ["iq", "iq-portable"])
def test_a_step_with_an_event_is_computed_by_the_law(arithmetic: str) -> None:
    """A saturation is counted once, for the quantity in which it occurred, and the functions go on after it."""
    fast, slow = map(_began_anew, _pair("ipfc", "time", arithmetic))
    before = fast.counters.saturations
    taken = []
    for k in range(6):
        speed = 250_000 if k == 3 else 1000 * k
        assert fast.step(k, speed, 0) == slow.step(k, speed, 0)
        taken.append(fast._loop._leaves is not None)
    assert fast.counters.saturations > before
    # The first step makes the state; from the jump on, the limits of the errors' rise are at work.
    assert taken[:4] == [False, True, True, False]
    assert fast.telemetry.rows == slow.telemetry.rows


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("arithmetic", ["iq", "float64", "float32"])
def test_a_law_has_its_function_on_other_lines(law: str, arithmetic: str) -> None:
    for name in ("yizhuang_01_songjiazhuang_xiaocun", "yizhuang_11_jinghai_lu_ciqu_nan", "lvshun_tieshan_worn_wheels"):
        assert Controller(load(name), LawSpec(law, arithmetic))._loop.straight is not None, name


class Careful(Ipfc[Any]):
    """A law of somebody else, with the operations of ours."""

    name = "careful"


def _straight(law: Any, arithmetic: str) -> Any:
    number = make(arithmetic)
    program = record(SCENARIO, LawSpec(), wide=number.wide)
    ranges = None if number.wide else analyse_law(program, law.state_bounds())
    return straight(program, law, number, ranges)


def test_only_shipped_laws_have_functions_and_not_where_single_precision_truncates() -> None:
    number = make("float64")
    assert _straight(Ipfc(number, SCENARIO), "float64") is not None
    assert _straight(Careful(number, SCENARIO), "float64") is None
    assert _straight(Ipfc(number, SCENARIO), "float32") is not None
    assert _straight(Ipfc(number, SCENARIO), "float32-truncated") is None


@cache
def _single_precision() -> Any:
    """A written function of every operation that single precision rounds: two operands to their results."""
    tracer = Tracer(wide=True)
    program = tracer.begin("part")
    x, y = tracer.input("x", None), tracer.input("y", None)
    results = [
        tracer.add(x, y), tracer.sub(x, y), tracer.mpy(x, y, 0), tracer.rmpy(x, y, 0), tracer.rsmpy(x, y, 0),
        tracer.mpy_iqx(x, 0, y, 0, 0), tracer.dot([x, y], [y, y], 0), tracer.neg(x), tracer.abs(x),
        tracer.minimum(x, y), tracer.maximum(x, y), tracer.clip(x, y, x), tracer.div(x, y, 0),
    ]  # fmt: skip
    program.outputs = [(f"out{number}", result) for number, result in enumerate(results)]
    _, text = written(program, FLOAT32, "part")
    with TemporaryDirectory() as folder:
        module = Path(folder, "part.py")
        module.write_text(f"from __future__ import annotations\n{text}", encoding="utf-8")
        names = runpy.run_path(str(module), {"FLT_MIN": FLT_MIN, "FLT_MAX": FLT_MAX, "array": array})
    return names["part"](Parts(make("float32"), (), (), (), (), ()))


def _of_single_precision(x: float, y: float) -> list[float]:
    """The same by the arithmetic."""
    ar = make("float32")
    return [
        ar.add(x, y), ar.sub(x, y), ar.mpy(x, y, 0), ar.rmpy(x, y, 0), ar.rsmpy(x, y, 0), ar.mpy_iqx(x, 0, y, 0, 0),
        ar.dot([x, y], [y, y], 0), ar.neg(x), ar.abs(x), ar.minimum(x, y), ar.maximum(x, y), ar.clip(x, y, x),
        ar.div(x, y, 0),
    ]  # fmt: skip


#: What single precision can hold, with many numbers near its limits.
SINGLE = st.one_of(
    st.floats(width=32, allow_nan=False, allow_infinity=False, allow_subnormal=False),
    st.sampled_from([0.0, FLT_MIN, -FLT_MIN, 1.5 * FLT_MIN, FLT_MAX, -FLT_MAX, 1.0, -1.0]),
).map(lambda value: value + 0.0)


@given(x=SINGLE, y=SINGLE)
@example(x=0.0, y=-1.0)
@example(x=1.0, y=1.0)
def test_single_precision_gives_the_same_bits_or_leaves_the_step_to_the_law(x: float, y: float) -> None:
    found, expected = _single_precision()((), (x, y)), _of_single_precision(x, y)
    if found is None:
        # Something would be a denormal or infinite: a result, or a product of the sum of products.
        exact = [x + y, x - y, x * y, y * y, x * y + y * y]
        assert any(0.0 < abs(value) < 2 * FLT_MIN or abs(value) > FLT_MAX / 2 for value in exact)
    else:
        assert list(map(repr, found[1])) == list(map(repr, expected))


def test_usual_numbers_are_not_left_to_the_law() -> None:
    assert all(_single_precision()((), (x, y)) is not None for x in (0.0, 1.5, -2e6) for y in (0.0, -0.25, 3e5))


def test_fixed_point_needs_the_proof_that_nothing_wraps() -> None:
    number = make("iq")
    program = record(SCENARIO, LawSpec())
    assert straight(program, Ipfc(number, SCENARIO), number, None) is None
    assert Controller(SCENARIO, LawSpec(), may_wrap=True)._loop.straight is None


def _program(constants: list[Constant]) -> Program:
    tracer = Tracer()
    program = tracer.begin("part")
    x = tracer.input("x", 20)
    limited = tracer.clip(x, *(tracer.const(constant) for constant in constants))
    program.outputs = [("out", tracer.rmpy(limited, tracer.const(constants[0]), 4))]
    return program


def test_numbers_are_not_in_the_shape() -> None:
    one, other = Constant("high", 2.0, 20), Constant("low", 1.0, 20)
    shape = shape_of(_program([one, other]), FIXED, formats=True)
    assert shape.constants == [one, other]
    more = shape_of(_program([Constant("high", 7.0, 20), Constant("low", 7.0, 20)]), FIXED, formats=True)
    assert shape.digest == more.digest
    assert shape.digest != shape_of(_program([one, other]), FLOAT64, formats=True).digest


def test_an_operation_of_a_library_is_not_written_out() -> None:
    tracer = Tracer(wide=True)
    program = tracer.begin("part")
    root: Value = tracer._emit("unheard", [tracer.input("x", None)], None)
    program.outputs = [("out", root)]
    with pytest.raises(KeyError, match="unheard"):
        written(program, FLOAT64, "part")
