"""No float between sensor and notch: fixed-point law, controller and node on operands that refuse floats."""

from __future__ import annotations

import math
import operator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hil_tests.support.closed_loop import SCENARIO, closed_loop, flat
from railhil.bus.responder import Reading
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.arithmetic.iq import C28, Portable
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.ato.node import ControllerNode
from railhil.scenarios.run_spec import LawSpec
from railhil.wire.ato import NotchCmd, TrnPos, TrnSpeed, WatchLevel


class NoFloat:
    """A whole number that is no ``int``: its operators take int and each other, on either side, and nothing else.

    What would make it a float, or an ``int`` that could become one unseen, raises ``TypeError``. ``__index__`` is the
    one way out, for places in a table; what is made of that is no ``NoFloat`` any more.
    """

    __slots__ = ("_whole",)
    # Numpy's numbers and arrays leave an operation to the methods below.
    __array_ufunc__ = None

    def __init__(self, whole: Any) -> None:
        self._whole = operator.index(whole)

    def __index__(self) -> int:
        return self._whole

    def __bool__(self) -> bool:
        return self._whole != 0

    def __repr__(self) -> str:
        return f"NoFloat({self._whole})"

    def bit_length(self) -> NoFloat:
        return NoFloat(self._whole.bit_length())


def _taking_whole_numbers(name: str) -> Any:
    plain = getattr(int, name)

    def operation(self: NoFloat, *others: Any) -> Any:
        if not all(isinstance(other, int | NoFloat) for other in others):
            raise TypeError(f"{name} of a fixed-point quantity with {others}")
        result = plain(self._whole, *map(operator.index, others))
        return result if isinstance(result, bool) else NoFloat(result)

    return operation


def _refused(name: str) -> Any:
    def operation(self: NoFloat, *others: Any) -> Any:
        raise TypeError(f"{name} of a fixed-point quantity")

    return operation


def _both_sides(*names: str) -> list[str]:
    return [*names, *(f"r{name}" for name in names)]


COMPARISONS = ("lt", "le", "gt", "ge", "eq", "ne")
UNARY = ("neg", "pos", "abs", "invert")
TAKEN = ("add", "sub", "mul", "floordiv", "mod", "lshift", "rshift", "and", "or", "xor")
REFUSED = ("truediv", "pow", "divmod", "matmul")
CONVERSIONS = ("float", "int", "complex", "round", "trunc", "floor", "ceil")
for _name in (*COMPARISONS, *UNARY, *_both_sides(*TAKEN)):
    setattr(NoFloat, f"__{_name}__", _taking_whole_numbers(f"__{_name}__"))
for _name in (*CONVERSIONS, *_both_sides(*REFUSED)):
    setattr(NoFloat, f"__{_name}__", _refused(f"__{_name}__"))


def test_the_poison_has_no_other_way_out() -> None:
    for convert in (float, int, complex, round, math.trunc, math.floor, math.ceil, math.sqrt, np.float64, np.float32):
        with pytest.raises(TypeError):
            convert(NoFloat(3))
    for spoil in (
        lambda x: math.ldexp(x, -20),
        lambda x: round(x, 1),
        lambda x: np.asarray(x, dtype=np.float64),
        lambda x: np.asarray(x) * 0.5,
        lambda x: sum([0.5, x]),
        lambda x: min(0.5, x),
        lambda x: f"{x:.2f}",
    ):
        with pytest.raises(TypeError):
            spoil(NoFloat(3))
    for name in UNARY:
        found = getattr(operator, f"__{name}__")(NoFloat(-7))
        assert type(found) is NoFloat
        assert operator.index(found) == getattr(operator, f"__{name}__")(-7)
    assert not isinstance(NoFloat(3), int | float)
    assert (bool(NoFloat(0)), bool(NoFloat(-1))) == (False, True)
    assert (10, 11, 12)[NoFloat(1)] == 11
    # Nothing that int has is left to a default.
    harmless = {"new", "getnewargs", "getattribute", "hash", "sizeof", "format", "doc"}
    operators = {name for name in vars(int) if name.startswith("__")} - {f"__{name}__" for name in harmless}
    assert operators <= set(vars(NoFloat))


def poisoned(profile: type) -> type:
    """The profile with constants and tables that refuse floats."""

    def const(self: Any, constant: Constant) -> Any:
        return NoFloat(constant.raw)

    def table(self: Any, name: str, constants: Any) -> Any:
        return tuple(NoFloat(constant.raw) for constant in constants)

    return type("Poisoned", (profile,), {"const": const, "table": table})


PROFILES = {"iq": poisoned(C28), "iq-portable": poisoned(Portable)}


class Recorder:
    """A controller that keeps what it was given."""

    def __init__(self, arithmetic: str, indexing: str) -> None:
        self._controller = Controller(SCENARIO, LawSpec("ipfc", arithmetic, indexing=indexing))
        self.given: list[tuple[int, int, int]] = []

    def step(self, k: int, speed_01mmps: int, position_01mm: int) -> Any:
        self.given.append((k, speed_01mmps, position_01mm))
        return self._controller.step(k, speed_01mmps, position_01mm)


@pytest.fixture(params=[(profile, indexing) for profile in PROFILES for indexing in ("time", "distance")])
def run(request: pytest.FixtureRequest) -> Any:
    """A whole run on plain numbers: arithmetic, indexing, wire values, notch codes; and a controller on poison."""
    arithmetic, indexing = request.param
    recorder: Any = Recorder(arithmetic, indexing)
    _, answers, stopped = closed_loop(0, [recorder])
    assert stopped is not None
    assert len(recorder.given) > 380
    plain = Controller(SCENARIO, LawSpec("ipfc", arithmetic, indexing=indexing))
    poisoned = Controller(SCENARIO, LawSpec(indexing=indexing), PROFILES[arithmetic]())
    codes = [answer.notch_code for answer, *_ in answers]
    return SimpleNamespace(
        arithmetic=arithmetic, indexing=indexing, given=recorder.given, codes=codes, plain=plain, poisoned=poisoned
    )


@pytest.mark.long
def test_no_float_in_the_law(run: Any) -> None:
    controller = run.poisoned
    loop = controller._loop
    for k, speed, position in run.given:
        output = controller.step(k, NoFloat(speed), NoFloat(position))  # type: ignore[arg-type]
        assert output == run.plain.step(k, speed, position)
        results = (output.notch_code, output.error_raw, *output.notes)
        quantities = (controller.telemetry._lows, controller.telemetry._highs)
        assert {type(leaf) for leaf in flat((results, loop.state, quantities))} == {NoFloat}
        if k % 5 == 0:
            # Another notch was sent than the law's.
            controller.sent(output.notch_code - 3)
            run.plain.sent(operator.index(output.notch_code) - 3)


@pytest.mark.long
def test_no_float_in_the_node(run: Any) -> None:
    """From the telegrams' signals through watch and law to the notch of NOTCH_CMD."""
    # Here telegrams and polls come once per control period.
    period_ns = SCENARIO.timing.control_period_ns
    periods = dict.fromkeys((TrnPos.PORT, TrnSpeed.PORT, NotchCmd.PORT), period_ns)
    scenario = replace(SCENARIO, timing=replace(SCENARIO.timing, port_period_ns=periods))
    node: Any = ControllerNode(scenario, LawSpec("ipfc", run.arithmetic, indexing=run.indexing), run.poisoned)
    for (k, speed, position), code in zip(run.given, run.codes, strict=True):
        now_ns = k * period_ns
        telegram = TrnPos(NoFloat(position // 10), life=k & 0xF)  # type: ignore[arg-type]
        node._clock = SimpleNamespace(now_ns=now_ns, own_ns=now_ns, is_set=True)
        node.guard.speed(TrnSpeed(NoFloat(speed), life=k & 0xF), now_ns)  # type: ignore[arg-type]
        node._position(Reading(telegram, now_ns, None))
        notch = node._notch().notch_256th
        assert node.guard.level is WatchLevel.NORMAL
        assert type(notch) is NoFloat
        assert operator.index(notch) == code
