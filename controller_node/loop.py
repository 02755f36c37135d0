"""A law with its set-points and its state on one arithmetic: wire values in, the law's answer out."""

from __future__ import annotations

from typing import Any, Generic

from controller_node.arithmetic.base import Arithmetic, Constant, T
from controller_node.laws import load
from controller_node.laws.base import SPEED_Q, Law, LawInputs, LawOutputs
from controller_node.setpoint import SetPoints
from scenarios.errors import InputError, Words
from scenarios.model import Scenario

#: km/h per 0.1 mm/s, scaled by 2^40: the one product that turns the wire's speed into Q20 is exact to 1e-9.
_KMH_PER_01MMPS = Constant("kmh_per_01mmps", 3.6e-4, 40, "unit conversion")

#: Positions are limited to this before the law sees them (0.1 mm, 200 km: the wire's own limit), so that they and
#: their differences fit into 32 bits.
POSITION_MAX_01MM = 2_000_000_000


def _made(
    kind: type[Law[T, Any]], name: str, arithmetic: Arithmetic[T], period_s: float, notch_max: float
) -> Law[T, Any]:
    """The law; whatever its constructor raises is one line about a law that does not fit."""
    try:
        return kind(arithmetic, period_s, notch_max)
    except InputError:
        raise
    except Exception as error:
        allowed = f"a law that can be made for {period_s:g} s and {notch_max:g} notches"
        cause = f"{type(error).__name__}: {error}"
        raise InputError("controller", name, Words("a law that fails at its start"), allowed, cause) from error


class ControlLoop(Generic[T]):
    """Law, set-points and state on one arithmetic; operands are those of the arithmetic, wire values whole numbers.

    :raises scenarios.errors.InputError: an unknown law or indexing, or a law that cannot be made for this scenario.
    """

    def __init__(self, scenario: Scenario, law: str, arithmetic: Arithmetic[T], indexing: str) -> None:
        period_s = scenario.timing.control_period_ns / 1e9
        self.arithmetic = arithmetic
        self.law: Law[T, Any] = _made(load(law), law, arithmetic, period_s, scenario.train.notch_max)
        self.set_points = SetPoints(arithmetic, scenario, indexing, self.law.horizon)
        self._kmh = arithmetic.const(_KMH_PER_01MMPS)
        self.state: Any = None

    def inputs(self, k: Any, speed_01mmps: Any, position_01mm: Any) -> LawInputs[T]:
        """Wire values (whole numbers) and set-points as the law takes them."""
        ar = self.arithmetic
        product = ar.mpy(ar.from_raw(speed_01mmps, 0), self._kmh, _KMH_PER_01MMPS.q - SPEED_Q)
        speed = ar.note("speed", product, SPEED_Q, "km/h")
        set_point, preview = self.set_points.at(k, ar.from_raw(position_01mm, 0))
        return LawInputs(speed, ar.note("set_point", set_point, SPEED_Q, "km/h"), preview)

    def step(self, k: Any, speed_01mmps: Any, position_01mm: Any) -> tuple[LawInputs[T], LawOutputs[T]]:
        """One control period; the first one also makes the law's state."""
        inputs = self.inputs(k, speed_01mmps, position_01mm)
        if self.state is None:
            self.state = self.law.start(inputs)
        self.state, outputs = self.law.step(self.state, inputs)
        return inputs, outputs

    def sent(self, notch: T) -> None:
        """Tell the law which notch (Q ``NOTCH_Q``) was really sent since its last step."""
        self.state = self.law.with_sent(self.state, notch)
