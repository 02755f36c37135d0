"""The law hold: a spring and a damper in software move the cart to its target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.vector.law import Answer, VectorLaw

from old_system.wire import FORCE_Q

_GAIN_Q = 16
#: Limits of positions (0.1 mm: 50 m), of distances and steps (2 m) and of the force (400 N). Every value from the wire
#: is clipped to them, so that no sum and no product exceeds 32 bits.
_BOUNDS = {"far": (500_000, 0), "near": (20_000, 0), "most": (40_000, FORCE_Q)}


@dataclass(frozen=True)
class Parameters:
    """Parameters that a file may set, with their ranges."""

    stiffness_n_per_m: Annotated[float, Field(ge=0, le=50)] = 6.0
    damping_n_per_mps: Annotated[float, Field(ge=0, le=50)] = 6.0


class State(NamedTuple):
    """Memory of the law: the position one control period earlier, 0.1 mm."""

    position: Any


class Hold(VectorLaw[T, State]):
    """force = stiffness (target - position) - damping speed; the speed is computed from two positions."""

    name = "hold"
    parameters_type = Parameters
    parameters_origin = "chosen by hand"

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Parameters | None = None) -> None:
        given = parameters or Parameters()
        period_s = scenario.timing.control_period_ns / 1e9
        self._ar = ar = arithmetic
        # In 0.01 N per 0.1 mm.
        gains = (
            Constant("stiffness", given.stiffness_n_per_m * 0.01, _GAIN_Q, "parameter"),
            Constant("damping", given.damping_n_per_mps * 0.01 / period_s, _GAIN_Q, "parameter"),
        )
        target = Constant("target", scenario.task.target_m * 1e4, 0, "scenario")
        pairs = {
            name: (Constant(name, size, q, "law"), Constant(f"minus_{name}", -size, q, "law"))
            for name, (size, q) in _BOUNDS.items()
        }
        self._constants = (*gains, target, *(constant for pair in pairs.values() for constant in pair))
        self._stiffness, self._damping = ar.load(gains)
        self._target = ar.const(target)
        self._far, self._near, self._most = (ar.load(pair) for pair in pairs.values())

    @property
    def constants(self) -> tuple[Constant, ...]:
        """Every constant of the law."""
        return self._constants

    def start(self, readings: Sequence[T]) -> State:
        """The initial state is that of a cart at rest."""
        return State(self._ar.clip(readings[0], *self._far))

    def step(self, state: State, readings: Sequence[T]) -> tuple[State, Answer[T]]:
        """One control period: returns one number for each command of the interface, and one for each of its notes."""
        ar = self._ar
        position = ar.clip(readings[0], *self._far)
        error = ar.note("distance", ar.clip(ar.sub(self._target, position), *self._near), 0, "0.1 mm")
        moved = ar.note("moved", ar.clip(ar.sub(position, state.position), *self._near), 0, "0.1 mm")
        # Q16 times Q0, shifted so that the product is in Q8.
        spring = ar.mpy(self._stiffness, error, _GAIN_Q - FORCE_Q)
        damper = ar.mpy(self._damping, moved, _GAIN_Q - FORCE_Q)
        force = ar.note("wanted", ar.clip(ar.sub(spring, damper), *self._most), FORCE_Q, "0.01 N")
        return State(position), Answer((force,), (error,))
