"""Control law pi: proportional-integral, with set-point feed-forward.

    notch = Kf (slope of the set-point) + Kp e + I,   I = previous I + Ki Ts e, limited to the notch range

While a notch other than the law's is sent (hold, traction cut), I is frozen, because it would otherwise wind up on an
error that the law cannot influence. Written by ``railhil new law``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, SPEED_Q, Law, LawInputs, LawOutputs
from railhil.controller_node.laws.constant_table import build, flatten, held
from railhil.systems.ato.scenario.model import Scenario

#: Gains, notch per km/h.
GAIN_Q = 24
#: Format of gain times speed, which is that of the notch before clipping.
_SPEED_TO_NOTCH = GAIN_Q + SPEED_Q - NOTCH_RAW_Q
#: Control periods over which the slope of the set-point is computed.
_AHEAD = 2


@dataclass(frozen=True, slots=True)
class Parameters:
    """Parameters that a file may set, with their ranges; the defaults are chosen by hand."""

    #: Notch per km/h, and notch per km/h and second.
    proportional: Annotated[float, Field(ge=0, le=20)] = 3.0
    integral_per_s: Annotated[float, Field(ge=0, le=5)] = 0.1
    #: Notch per (km/h per s) of slope: one notch gives 0.75 km/h per s for the train of lvshun_tieshan.
    lead_s: Annotated[float, Field(ge=0, le=10)] = 1.15


@dataclass(frozen=True)
class Constants:
    """All numbers needed in a run, each with its format and its origin."""

    proportional: Constant = field(metadata=held(GAIN_Q, "Kp"))
    integral: Constant = field(metadata=held(GAIN_Q, "Ki times the control period"))
    lead: Constant = field(metadata=held(GAIN_Q, "Kf over the periods ahead"))
    speed_max: Constant = field(metadata=held(SPEED_Q, "fixed-point limit of errors, km/h"))
    notch_max: Constant = field(metadata=held(NOTCH_RAW_Q, "notch range of the train"))
    zero: Constant = field(metadata=held(0, "0"))


class State(NamedTuple, Generic[T]):
    """Memory of the law: the integral now and one control period earlier (notches, Q19), the notch sent (Q8)."""

    integral: T
    before: T
    notch: T


class Pi(Law[T, State[T]]):
    """The law in one arithmetic. Raises ``ValueError`` for gains that do not fit their format."""

    name: ClassVar[str] = "pi"
    parameters_type: ClassVar[type[Any]] = Parameters
    parameters_origin: ClassVar[str] = "chosen by hand"
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {
        "proportional": (0.5, 5.0),
        "integral_per_s": (0.0, 0.5),
        "lead_s": (0.5, 2.0),
    }

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: Parameters | None = None) -> None:
        p = parameters or Parameters()
        period_s = scenario.timing.control_period_ns / 1e9
        values = {
            "proportional": p.proportional,
            "integral": p.integral_per_s * period_s,
            "lead": p.lead_s / (_AHEAD * period_s),
            "speed_max": 100.0,
            "notch_max": scenario.train.notch_max,
            "zero": 0.0,
        }
        self.table = table = build(Constants, values)
        self._ar = ar = arithmetic
        self._gains = ar.load((table.proportional, table.lead))
        self._integral = ar.const(table.integral)
        self._speed_max = ar.const(table.speed_max)
        self._speed_min = ar.neg(self._speed_max)
        self._notch_max = ar.const(table.notch_max)
        self._notch_min = ar.neg(self._notch_max)
        self._zero = ar.const(table.zero)

    @property
    def horizon(self) -> int:
        return _AHEAD

    @property
    def constants(self) -> tuple[Constant, ...]:
        return flatten(self.table)

    def start(self, inputs: LawInputs[T]) -> State[T]:
        return State(self._zero, self._zero, self._zero)

    def with_sent(self, state: State[T], notch: T) -> State[T]:
        """A notch other than the law's was sent: undo this control period's change of the integral."""
        ar = self._ar
        overridden = ar.gt(ar.abs(ar.sub(notch, state.notch)), self._zero)
        return State(ar.where(overridden, state.before, state.integral), state.before, notch)

    def step(self, state: State[T], inputs: LawInputs[T]) -> tuple[State[T], LawOutputs[T]]:
        ar = self._ar
        error = ar.note("error", self._limited(ar.sub(inputs.set_point, inputs.speed)), SPEED_Q, "km/h")
        rise = ar.note("rise", self._limited(ar.sub(inputs.preview[-1], inputs.set_point)), SPEED_Q, "km/h")
        # One factor is in Q24, the other in Q20, the sum in Q19.
        grown = ar.add(state.integral, ar.rmpy(error, self._integral, _SPEED_TO_NOTCH))
        integral = ar.note("integral", ar.clip(grown, self._notch_max, self._notch_min), NOTCH_RAW_Q, "notch")
        led = ar.dot(self._gains, (error, rise), _SPEED_TO_NOTCH)
        notch_raw = ar.note("notch_raw", ar.add(led, integral), NOTCH_RAW_Q, "notch")
        clipped = ar.clip(notch_raw, self._notch_max, self._notch_min)
        notch = ar.note("notch", ar.quantise(clipped, NOTCH_RAW_Q, NOTCH_Q), NOTCH_Q, "notch")
        outputs = LawOutputs(notch_raw, notch)
        return State(integral, state.integral, notch), outputs

    def _limited(self, speed: T) -> T:
        """The value limited to the range of its format. ``wide`` is fixed before the run: no branch on data."""
        return speed if self._ar.wide else self._ar.sat(speed, self._speed_max, self._speed_min)
