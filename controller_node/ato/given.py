"""The law of the system ``ato`` whose notch is computed by code of the user, and its readings."""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.given.computing import NoParameters, Quantity, SkeletonLaw, Terms
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, Law, LawInputs, LawOutputs
from railhil.systems.ato.scenario.model import Scenario

_MPS_PER_KMH = 1 / 3.6
#: 1 of a word in 0.1 mm, or in 0.1 mm/s.
M_PER_01MM = 1e-4


class Sent(NamedTuple):
    """State: the notch that was really sent last."""

    notch: Any


class GivenNotchLaw(SkeletonLaw, Law[T, Sent]):
    """See :class:`~railhil.controller_node.given.computing.SkeletonLaw`."""

    name: ClassVar[str] = "given"
    track: ClassVar[bool] = True
    floating: ClassVar[bool] = True
    parameters_type: ClassVar[type[Any]] = NoParameters
    parameters_origin: ClassVar[str] = "those of a given controller"

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: Any = None) -> None:
        self._arithmetic = arithmetic
        period_s = scenario.timing.control_period_ns / 1e9
        limit = scenario.train.notch_max
        self.terms = Terms(
            (
                Quantity("time_s", "s", "in.track.k", period_s),
                Quantity("speed_mps", "m/s", "in.speed", _MPS_PER_KMH),
                Quantity("set_point_mps", "m/s", "in.set_point", _MPS_PER_KMH),
                Quantity("position_m", "m", "in.track.position_01mm", M_PER_01MM),
                Quantity("balise", "", "in.track.balise.number"),
                Quantity("balise_m", "m", "in.track.balise.position_01mm", M_PER_01MM),
                Quantity("balise_odometer_m", "m", "in.track.balise.odometer_01mm", M_PER_01MM),
                Quantity("sent_notch", "notch", "state.notch"),
            ),
            (Quantity("notch", "notch", "out.notch", largest=limit, step=2.0**-NOTCH_Q),),
            period_s,
        )
        self._zero = arithmetic.const(Constant("zero", 0.0, NOTCH_Q, "skeleton"))
        self._limits = [
            arithmetic.const(Constant(f"notch_{sign}", sign * limit, NOTCH_RAW_Q, "train")) for sign in (1, -1)
        ]

    @property
    def constants(self) -> tuple[Constant, ...]:
        return ()

    @property
    def horizon(self) -> int:
        return 0

    def start(self, inputs: LawInputs[T]) -> Sent:
        return Sent(self._zero)

    def step(self, state: Sent, inputs: LawInputs[T]) -> tuple[Sent, LawOutputs[T]]:
        ar = self._arithmetic
        raw: Any = self.ask(ar, self.terms, state, inputs)[0]
        notch = ar.quantise(ar.clip(raw, *self._limits), NOTCH_RAW_Q, NOTCH_Q)
        return Sent(notch), LawOutputs(raw, notch)

    def with_sent(self, state: Sent, notch: T) -> Sent:
        return Sent(notch)
