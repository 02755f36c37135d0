"""A law for two carts: moves each cart to its target independently; speeds are computed from positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.vector.law import Answer, VectorLaw
from two_carts.wire import FORCE_Q

#: Positions are limited to this (0.1 mm, 50 m), so that they and their products fit into 32 bits.
FAR_01MM = 500_000
_GAIN_Q = 20


@dataclass(frozen=True)
class ApartParameters:
    """Gains on the error and on the speed."""

    stiffness_n_per_m: Annotated[float, Field(ge=0, le=50)] = 6.0
    damping_n_per_mps: Annotated[float, Field(ge=0, le=50)] = 5.0


class State(NamedTuple):
    """Positions one control period earlier, 0.1 mm."""

    position: tuple[Any, ...]


class Apart(VectorLaw[T, State]):
    """A spring and a damper in software, for each cart."""

    name = "apart"
    parameters_type = ApartParameters
    parameters_origin = "chosen by hand"

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: ApartParameters | None = None) -> None:
        given = parameters or ApartParameters()
        period_s = scenario.timing.control_period_ns / 1e9
        self._ar = ar = arithmetic
        # 0.01 N per 0.1 mm.
        names = ("stiffness", "damping")
        values = (given.stiffness_n_per_m * 0.01, given.damping_n_per_mps * 0.01 / period_s)
        gains = [Constant(name, value, _GAIN_Q, "parameters") for name, value in zip(names, values, strict=True)]
        targets = [
            Constant(f"target[{unit}]", at_m * 1e4, 0, "scenario") for unit, at_m in enumerate(scenario.task.target_m)
        ]
        far = [Constant("far", FAR_01MM, 0, "law"), Constant("near", -FAR_01MM, 0, "law")]
        # Limit of the computed force: far beyond the command's own range, and within 32 bits.
        most = [Constant("most", 40_000, FORCE_Q, "law"), Constant("least", -40_000, FORCE_Q, "law")]
        # 0.1 mm per period: largest motion of a cart.
        fast = [Constant("fast", 20_000, 0, "law"), Constant("slow", -20_000, 0, "law")]
        self._constants = (*gains, *targets, *far, *most, *fast)
        self._stiffness, self._damping = ar.load(gains)
        self._targets, self._far, self._most, self._fast = (ar.load(some) for some in (targets, far, most, fast))

    @property
    def constants(self) -> tuple[Constant, ...]:
        return self._constants

    def start(self, readings: Sequence[T]) -> State:
        return State(tuple(self._ar.clip(reading, *self._far) for reading in readings))

    def step(self, state: State, readings: Sequence[T]) -> tuple[State, Answer[T]]:
        ar = self._ar
        position = tuple(ar.clip(reading, *self._far) for reading in readings)
        forces = []
        for unit, (now, before) in enumerate(zip(position, state.position, strict=True)):
            error = ar.note(f"error[{unit}]", ar.clip(ar.sub(self._targets[unit], now), *self._fast), 0, "0.1 mm")
            moved = ar.note(f"moved[{unit}]", ar.clip(ar.sub(now, before), *self._fast), 0, "0.1 mm")
            spring = ar.mpy(self._stiffness, error, _GAIN_Q - FORCE_Q)
            damper = ar.mpy(self._damping, moved, _GAIN_Q - FORCE_Q)
            force = ar.clip(ar.sub(spring, damper), *self._most)
            forces.append(ar.note(f"wanted[{unit}]", force, FORCE_Q, "0.01 N"))
        return State(position), Answer(tuple(forces), (ar.sub(position[1], position[0]),))
