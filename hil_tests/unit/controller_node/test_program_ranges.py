"""Interval analysis of a law: its bounds are valid, and no operation of the shipped laws can wrap on any wire input."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support import shipped
from hil_tests.support.batch_controller import BatchController
from hil_tests.support.cli import railhil
from hil_tests.support.plug import plug_in
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.telegrams import TimeSync
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant, Curve
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import WIRE, Controller
from railhil.controller_node.ato.laws.ipfc import Ipfc
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.laws import load as load_law
from railhil.controller_node.laws import names
from railhil.controller_node.program.model import Program, name_leaves
from railhil.controller_node.program.ranges import analyse, analyse_law
from railhil.controller_node.program.tracer import Tracer, record
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, TrnPos, TrnSpeed

SCENARIO = load("lvshun_tieshan")
CURVE = Curve.sampled("fall", lambda x: 1 - x * x, 24, 24)


def every_operation(ar: Any, a: Any, b: Any) -> list[Any]:
    """One of each operation, on two Q20 operands."""
    small, half = ar.const(Constant("small", 0.25, 20)), ar.const(Constant("half", 0.5, 20))
    upper, lower = ar.const(Constant("upper", 1.0, 20)), ar.const(Constant("lower", -0.5, 20))
    clipped = ar.clip(a, upper, lower)
    share = ar.convert(ar.clip(a, half, ar.const(Constant("zero", 0.0, 20))), 20, 24)
    return [
        ar.add(a, b),
        ar.sub(a, b),
        ar.neg(a),
        ar.abs(b),
        ar.mpy(a, b, 20),
        ar.rmpy(a, b, 20),
        ar.rsmpy(a, b, 10),
        ar.mpy_iqx(a, 20, b, 20, 22),
        ar.mpy_iqx(a, 20, b, 20, 18),
        ar.dot([small, half], [a, b], 20),
        ar.div(a, b, 20),
        ar.div(small, ar.maximum(ar.abs(b), half), 20),
        ar.sqrt(ar.abs(a), 20),
        clipped,
        ar.sat(b, upper, lower),
        ar.minimum(a, b),
        ar.maximum(a, b),
        ar.where(ar.gt(a, b), a, small),
        ar.convert(a, 20, 16),
        ar.convert(clipped, 20, 24),
        ar.quantise(a, 20, 8),
        ar.curve(CURVE, share),
    ]


def traced(low_a: int, high_a: int, low_b: int, high_b: int) -> tuple[Program, list[Any], Any]:
    tracer = Tracer()
    program = tracer.begin("all")
    results = every_operation(tracer, tracer.input("a", 20), tracer.input("b", 20))
    return program, results, analyse(program, {"a": (low_a, high_a), "b": (low_b, high_b)})


BOUND = st.integers(-(2**31), 2**31 - 1)


@settings(max_examples=150)
@given(st.lists(BOUND, min_size=2, max_size=2), st.lists(BOUND, min_size=2, max_size=2), st.integers(0, 2**32))
def test_every_result_lies_in_its_interval(first: list[int], second: list[int], seed: int) -> None:
    (low_a, high_a), (low_b, high_b) = sorted(first), sorted(second)
    _, results, ranges = traced(low_a, high_a, low_b, high_b)
    draw, number = random.Random(seed), make("iq")
    pairs = [(a, b) for a in (low_a, high_a) for b in (low_b, high_b)]
    pairs += [(draw.randint(low_a, high_a), draw.randint(low_b, high_b)) for _ in range(5)]
    for a, b in pairs:
        for value, got in zip(results, every_operation(number, a, b), strict=True):
            low, high = ranges.of(value)
            assert low <= got <= high, (value, a, b)
    if number.counters.wraps:
        assert ranges.may_wrap, "a wrap happened that the analysis holds to be impossible"


def test_bounds_of_monotone_operations_are_reached() -> None:
    _, results, ranges = traced(-1000, 3000, 50, 70)
    assert [ranges.of(value) for value in results[:4]] == [(-950, 3070), (-1070, 2950), (-3000, 1000), (50, 70)]
    assert not ranges.may_wrap


def test_a_possible_wrap_is_found() -> None:
    program, _, ranges = traced(0, 2**30, 0, 2**30)
    found = {operation.op for operation, _ in ranges.may_wrap}
    assert "add" in found
    assert "sub" not in found
    assert all(operation in program.operations for operation, _ in ranges.may_wrap)


def at_period(scenario: Scenario, period_s: float) -> Scenario:
    return replace(scenario, timing=replace(scenario.timing, control_period_ns=round(period_s * 1e9)))


@pytest.mark.parametrize(
    ("name", "indexing"), [(name, indexing) for name in names() for indexing in load_law(name).indexings]
)
@pytest.mark.parametrize("period_s", [0.2, 0.25, 0.3, 0.5, 1.0])
def test_no_operation_of_a_law_can_wrap(name: str, period_s: float, indexing: str) -> None:
    scenario = at_period(SCENARIO, period_s)
    law = load_law(name)(make("float64"), scenario)
    ranges = analyse_law(record(scenario, LawSpec(name, indexing=indexing)), law.state_bounds(), WIRE)
    assert [(operation.op, interval) for operation, interval in ranges.may_wrap] == []


@pytest.mark.parametrize("indexing", ["time", "distance"])
@pytest.mark.parametrize("name", shipped.ATO)
def test_no_operation_can_wrap_on_any_shipped_scenario_and_a_long_overtime(name: str, indexing: str) -> None:
    scenario = load(name)
    scenario = replace(scenario, plan=replace(scenario.plan, overtime_max_s=600.0))
    law = load_law("ipfc")(make("float64"), scenario)
    assert not analyse_law(record(scenario, LawSpec(indexing=indexing)), law.state_bounds(), WIRE).may_wrap


def test_a_notch_range_beyond_the_formats_is_found() -> None:
    scenario = replace(SCENARIO, train=replace(SCENARIO.train, notch_max=20.0))
    law = load_law("ipfc")(make("float64"), scenario)
    assert "dot" in {
        operation.op for operation, _ in analyse_law(record(scenario, LawSpec()), law.state_bounds(), WIRE).may_wrap
    }


@pytest.mark.parametrize(
    ("name", "notch_max", "period_s", "found"),
    [
        ("ipfc", 40.0, 0.5, "dot before model[0] that may reach 333.29 in Q24, which ends at 128"),
        ("tpfc1", 40.0, 0.5, "dot before model[0] "),
        ("tpfc2", 40.0, 0.5, "dot before model[0] "),
        ("tdmc", 12.0, 0.2, "add before y_m that may reach 256.255 in Q23, which ends at 256"),
        ("ipfc_plus", 127.0, 0.5, ""),
    ],
)
def test_no_law_starts_in_fixed_point_that_may_wrap(name: str, notch_max: float, period_s: float, found: str) -> None:
    scenario = at_period(replace(SCENARIO, train=replace(SCENARIO.train, notch_max=notch_max)), period_s)
    allowed = f"expected a law whose fixed point cannot wrap at {period_s:g} s and {notch_max:g} notches"
    starts: list[Callable[[], Any]] = [
        lambda: Controller(scenario, LawSpec(name)),
        lambda: BatchController(scenario, 2, LawSpec(name)),
    ]
    for start in starts:
        with pytest.raises(InputError) as caught:
            start()
        assert f"controller: {name}: {found}" in str(caught.value)
        assert allowed in str(caught.value)
    Controller(scenario, LawSpec(name, "float64"))
    Controller(scenario, LawSpec(name, "float32"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "command", [("run", "--controller", "tpfc2", "--bus", "local", "--out", "out"), ("export-c", "tpfc2")]
)
def test_commands_say_so_with_exit_code_2(command: tuple[str, ...], tmp_path: Path) -> None:
    text = 'extends = "lvshun_tieshan"\nname = "seldom"\ntitle = "seldom"\n[timing]\ncontrol_period_ms = 5000\n'
    (tmp_path / "seldom.toml").write_text(text, encoding="utf-8")
    program, *options = command
    given = [program, "seldom.toml", *options] if program == "run" else [*command, "seldom.toml", "--out", "out"]
    done = railhil(*given, cwd=tmp_path)
    assert done.exit_code == 2
    assert "dot before notch_raw that may reach 4196.6 in Q19, which ends at 4096" in done.one_line()
    assert not (tmp_path / "out").exists()


class Growing(Ipfc[Any]):
    """A sum that feeds back into itself, without a limit."""

    def step(self, state: Any, inputs: Any) -> Any:
        after, outputs = super().step(state, inputs)
        return after._replace(tracking_error=self._ar.add(state.tracking_error, after.tracking_error)), outputs


def test_a_plugged_in_law_that_may_wrap_does_not_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever wrote it."""
    plug_in(tmp_path, monkeypatch, growing=Growing)
    with pytest.raises(InputError, match=r"which ends at 2048, .*operations that may wrap: \d"):
        Controller(SCENARIO, LawSpec("growing"))
    Controller(SCENARIO, LawSpec("growing", "float64"))


def test_crossed_limits_and_a_curve_beyond_its_table() -> None:
    tracer = Tracer()
    program = tracer.begin("limits")
    a, upper, lower = (tracer.input(name, 24) for name in ("a", "upper", "lower"))
    clipped, bent = tracer.clip(a, upper, lower), tracer.curve(CURVE, a)
    ranges = analyse(program, {"a": (0, 2**24), "upper": (-7, 5), "lower": (-5, 3)})
    low, high = ranges.of(clipped)
    assert low <= make("iq").clip(0, -7, 3) <= high
    assert not ranges.may_wrap
    ranges = analyse(program, {"a": (0, 2**24 + 1), "upper": (0, 0), "lower": (0, 0)})
    assert [operation.op for operation, _ in ranges.may_wrap] == ["curve"]
    assert ranges.of(bent) == (-(2**31), 2**31 - 1)


def test_a_law_without_known_state_bounds_has_none() -> None:
    assert analyse_law(record(SCENARIO, LawSpec()), {}, WIRE).may_wrap


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("indexing", ["time", "distance"])
def test_a_law_under_wild_inputs_stays_inside_its_bounds(indexing: str) -> None:
    program = record(SCENARIO, LawSpec(indexing=indexing))
    number = make("iq")
    loop: ControlLoop[int] = ControlLoop(SCENARIO, LawSpec(indexing=indexing), number)
    ranges = analyse_law(program, loop.law.state_bounds(), WIRE)
    noted = number.noted = []
    draw = random.Random(7)
    outputs = dict(program.step.outputs)
    for k in range(3000):
        wild = draw.random() < 0.3
        speed = draw.choice(WIRE["speed_01mmps"]) if wild else draw.randint(*WIRE["speed_01mmps"])
        position = draw.choice(WIRE["position_01mm"]) if wild else draw.randint(0, 29_500_000)
        loop.step(k % 420, speed, position)
        loop.sent(draw.choice((-7 * 256, 0, 7 * 256, draw.randint(-7 * 256, 7 * 256))))
        for name, value in name_leaves(loop.state, "state"):
            low, high = ranges.step.of(outputs[name]) if name != "state.notch" else (-7 << 24, 7 << 24)
            assert low <= value <= high, name
        for quantity, value in zip(program.quantities, noted, strict=True):
            within = ranges.inputs if quantity in program.inputs.quantities else ranges.step
            low, high = within.of(quantity.value)
            assert low <= value <= high, quantity.name
        noted.clear()
    assert number.counters.wraps == 0
    assert number.counters.saturations > 0


@pytest.mark.parametrize("odometer_mm", [-(2**31), -200_000_001, 200_000_000, 2**31 - 1])
def test_the_node_hands_no_position_beyond_the_bounds_to_the_law(odometer_mm: int) -> None:
    seen: list[int] = []

    class RunIdentity(Controller):
        def step(self, k: int, speed_01mmps: int, position_01mm: int, *balise: Any) -> Any:
            seen.append(position_01mm)
            return super().step(k, speed_01mmps, position_01mm, *balise)

    controller = RunIdentity(SCENARIO, LawSpec(indexing="distance"))
    node = ControllerNode(SCENARIO, LawSpec(indexing="distance"), controller)
    for telegram in (TrnSpeed(10_000, life=1), TimeSync(), TrnPos(odometer_mm, life=1)):
        for frame in TelegramSource(telegram.port()).frames(telegram.encode()):
            node.handle(frame)
    node.handle(master_frame(NotchCmd.port().f_code, NotchCmd.port().address))
    low, high = WIRE["position_01mm"]
    assert seen == [min(max(odometer_mm * 10, low), high)]
