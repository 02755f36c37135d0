"""Laws compiled when a run binds them: they compute what the laws do, and a debugger finds their text."""

from __future__ import annotations

import io
import linecache
import pdb
import traceback
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import railhil
from railhil.common.generated_source import compile_source
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.arithmetic.float32 import FLT_MAX, FLT_MIN
from railhil.controller_node.ato.controller import WIRE, Controller
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.compiled_law import compile_law
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.program.emit_python import FIXED, FLOAT32, FLOAT64, emit_python
from railhil.controller_node.program.model import Value, name_leaves
from railhil.controller_node.program.ranges import analyse_law
from railhil.controller_node.program.tracer import Tracer, record
from railhil.controller_node.vector.controller import VectorController, VectorLoop
from railhil.scenarios.load import load, load_any
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import system_named

SCENARIO = load("lvshun_tieshan")
LAWS = [(law, indexing) for law in system_named("ato").law_names() for indexing in load_law(law).indexings]
ARITHMETICS = ["iq", "iq-portable", "float64", "float32"]
#: Each law in one arithmetic, each arithmetic with several laws; the other pairs are long.
CASES = [
    pytest.param(*law, arithmetic, marks=() if i % len(ARITHMETICS) == k else pytest.mark.long)
    for i, law in enumerate(LAWS)
    for k, arithmetic in enumerate(ARITHMETICS)
]
#: Control period, speed in 0.1 mm/s, odometer in 0.1 mm; the speeds go beyond what a wire can bring.
STEP = st.tuples(st.integers(0, 420), st.integers(-10, 1_500_000), st.integers(-(2**31), 2**31 - 1))
#: A notch sent instead of the law's, or none.
SENT = st.one_of(st.none(), st.integers(-1792, 1792))


@cache
def _pair(law: str, indexing: str, arithmetic: str) -> tuple[Controller, Controller]:
    """A controller as the node has it, and one that always computes the law itself."""
    controllers = [Controller(SCENARIO, LawSpec(law, arithmetic, indexing)) for _ in range(2)]
    assert controllers[0]._loop.compiled is not None
    controllers[1]._loop.compiled = None
    return controllers[0], controllers[1]


def _began_anew(controller: Controller) -> Controller:
    controller._loop.state = None
    return controller


@pytest.mark.long_after(4)
@pytest.mark.parametrize(("law", "indexing", "arithmetic"), CASES)
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
        assert repr(list(name_leaves(fast._loop.state))) == repr(list(name_leaves(slow._loop.state)))
    assert fast.telemetry.rows == slow.telemetry.rows
    assert fast.counters == slow.counters


#: Laws of several readings: scenario, law, arithmetic.
OTHERS = [
    *(("yizhuang_stop_closed", "ilc_stop", arithmetic) for arithmetic in ARITHMETICS),
    ("yizhuang_stop", "reaim", "iq"),
    ("hst_short", "mm_gpc", "float32"),
    ("emu3_short", "os_elm_ngpc", "float64"),
]


@cache
def _pair_of(scenario: str, law: str, arithmetic: str) -> tuple[VectorController, VectorController]:
    """As :func:`_pair`."""
    controllers = [VectorController(load_any(scenario), LawSpec(law, arithmetic)) for _ in range(2)]
    assert controllers[0]._loop.compiled is not None
    controllers[1]._loop.compiled = None
    return controllers[0], controllers[1]


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "law", "arithmetic"), OTHERS)
@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_a_law_of_several_readings_gives_what_it_computes_itself(
    scenario: str, law: str, arithmetic: str, data: st.DataObject
) -> None:
    fast, slow = _pair_of(scenario, law, arithmetic)
    for controller in (fast, slow):
        controller._loop.state = None
    ranges = list(fast.wire.values())
    # Anything that the bus can bring, and what a train does: small steps from one period to the next.
    raws = [data.draw(st.integers(low, high)) for low, high in ranges]
    for _ in range(data.draw(st.integers(2, 8))):
        assert fast.step(raws) == slow.step(raws)
        assert repr(list(name_leaves(fast.state))) == repr(list(name_leaves(slow.state)))
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
@pytest.mark.parametrize(
    ("scenario", "law", "arithmetic"),
    [
        ("yizhuang_stop_closed", "ilc_stop", "iq"),
        pytest.param("yizhuang_stop_closed", "ilc_stop", "float32", marks=pytest.mark.long),
        pytest.param("hst_short", "os_elm_ngpc", "float64", marks=pytest.mark.long),
    ],
)  # fmt: skip
def test_a_whole_run_is_computed_by_the_functions(
    scenario: str, law: str, arithmetic: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not only that they are bound: nearly every period is theirs, and the record is that of the law."""
    taken: list[bool] = []
    original = VectorLoop.step_compiled

    def counted(loop: VectorLoop[Any], wire: Any) -> Any:
        done = original(loop, wire)
        taken.append(done is not None)
        return done

    def run(folder: str) -> str:
        outcome = railhil.run(scenario, controller=law, arithmetic=arithmetic, bus="local", out=tmp_path / folder)
        return outcome.frames_sha256

    monkeypatch.setattr(VectorLoop, "step_compiled", counted)
    fast = run("fast")
    assert len(taken) > 100
    assert sum(taken) > 0.99 * len(taken)
    monkeypatch.setattr("railhil.controller_node.law_controller.compile_law", lambda *_: None)
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


class Careful(Ipfc[Any]):
    """A law of somebody else, with the operations of ours."""

    name = "careful"


def _compiled(law: Any, arithmetic: str) -> Any:
    number = make(arithmetic)
    program = record(SCENARIO, LawSpec(), wide=number.wide)
    ranges = None if number.wide else analyse_law(program, law.state_bounds(), WIRE)
    return compile_law(program, law, number, ranges)


def test_only_shipped_laws_are_compiled_and_not_where_single_precision_truncates() -> None:
    number = make("float64")
    assert _compiled(Ipfc(number, SCENARIO), "float64") is not None
    assert _compiled(Careful(number, SCENARIO), "float64") is None
    assert _compiled(Ipfc(number, SCENARIO), "float32") is not None
    assert _compiled(Ipfc(number, SCENARIO), "float32-truncated") is None


@cache
def _single_precision() -> Any:
    """A function of every operation that single precision rounds: two operands to their results."""
    tracer = Tracer(wide=True)
    program = tracer.begin("part")
    x, y = tracer.input("x", None), tracer.input("y", None)
    results = [
        tracer.add(x, y), tracer.sub(x, y), tracer.mpy(x, y, 0), tracer.rmpy(x, y, 0), tracer.rsmpy(x, y, 0),
        tracer.mpy_iqx(x, 0, y, 0, 0), tracer.dot([x, y], [y, y], 0), tracer.neg(x), tracer.abs(x),
        tracer.minimum(x, y), tracer.maximum(x, y), tracer.clip(x, y, x), tracer.div(x, y, 0),
    ]  # fmt: skip
    program.outputs = [(f"out{number}", result) for number, result in enumerate(results)]
    text, names = emit_python(program, FLOAT32, make("float32"), None)
    return compile_source("single precision of a test", text, names)["part"]


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
    assert compile_law(program, Ipfc(number, SCENARIO), number, None) is None
    assert Controller(SCENARIO, LawSpec(), may_wrap=True)._loop.compiled is None


@pytest.mark.parametrize(("upper", "lower", "limited"), [(2.0, 1.0, True), (1.0, 2.0, False)])
def test_a_step_with_swapped_limits_is_left_to_the_law(upper: float, lower: float, limited: bool) -> None:
    """The profiles of fixed point differ there."""
    tracer = Tracer()
    program = tracer.begin("part")
    x = tracer.input("x", 20)
    limits = [tracer.const(Constant(name, value, 20)) for name, value in (("upper", upper), ("lower", lower))]
    program.outputs = [("out", tracer.clip(x, *limits))]
    text, names = emit_python(program, FIXED, make("iq"), None)
    found = compile_source("limits of a test", text, names)["part"]((), (0,))
    assert found == (((), (1 << 20,), ()) if limited else None)


def test_a_quantity_may_have_any_name() -> None:
    tracer = Tracer(wide=True)
    program = tracer.begin("part")
    x = tracer.input("given", None)
    for name in ("state", "lambda", "min", "2nd", "-x", "x_2", "x '"):
        x = tracer.note(name, tracer.minimum(x, tracer.const(Constant("max", 3.0, 20))), 20)
    program.outputs = [("out", x)]
    text, names = emit_python(program, FLOAT64, make("float64"), None)
    assert compile_source("names of a test", text, names)["part"]((), (5.0,))[1] == (3.0,)


def test_an_operation_that_is_not_known_is_not_emitted() -> None:
    tracer = Tracer(wide=True)
    program = tracer.begin("part")
    root: Value = tracer._emit("unheard", [tracer.input("x", None)], None)
    program.outputs = [("out", root)]
    with pytest.raises(KeyError, match="unheard"):
        emit_python(program, FLOAT64, make("float64"), None)


def test_a_law_that_a_library_solves_runs_as_it_is() -> None:
    assert VectorController(load_any("hst_short"), LawSpec("delay_qp", "float64"))._loop.compiled is None


def test_a_traceback_through_a_law_shows_its_line() -> None:
    compiled = Controller(SCENARIO, LawSpec())._loop.compiled
    assert compiled is not None
    with pytest.raises(TypeError) as error:
        compiled.step((), (0, "fast", 0))
    text = "".join(traceback.format_exception(error.value))
    assert '"<railhil law ipfc iq inputs' in text
    assert "if not low_speed_01mmps <= speed_01mmps <= high_speed_01mmps:" in text


def test_a_debugger_stops_in_a_law_and_shows_its_line() -> None:
    controller = Controller(SCENARIO, LawSpec())
    controller.step(0, 0, 0)
    compiled = controller._loop.compiled
    assert compiled is not None
    code = compiled._inputs.__code__  # type: ignore[attr-defined]
    out = io.StringIO()
    debugger = pdb.Pdb(stdin=io.StringIO("c\np speed_01mmps\nn\np speed\nc\n"), stdout=out, nosigint=True, readrc=False)
    debugger.use_rawinput = False
    (line,) = [number for number, text in enumerate(linecache.getlines(code.co_filename), 1) if " speed = " in text]
    assert debugger.set_break(code.co_filename, line, temporary=True) is None
    debugger.runcall(controller.step, 1, 2000, 0)
    assert "-> speed = speed_01mmps * c_kmh_per_01mmps >> 20" in out.getvalue()
    assert "\n(Pdb) 2000\n" in out.getvalue()
