"""Control law mylaw: set-point feed-forward, and control of the distance.

    notch = (slope of the set-point, led by the actuator's lag, + resistance at the set-point) / b
            + K0 change of e + K1 e + K2 x + K3 sum of x,   x = sum of e

where e is the speed error, x the distance by which the train is behind, and b the acceleration by one notch. All gains
follow from the train of the scenario: with them the distance has three equal poles at -1/T, and the lag of the actuator
is cancelled. The only choice is T, in control periods. A law that answers the distance, and not only the speed, stops
where it should on any grade.

While a notch other than the law's is sent (hold, traction cut), both sums are frozen: they would otherwise wind up on
an error that the law cannot influence. Written by ``railhil new law``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, SPEED_Q, Law, LawInputs, LawOutputs
from railhil.controller_node.laws.constant_table import build, flatten, held
from railhil.systems.ato.scenario.model import Scenario

#: Notch per km/h.
GAIN_Q = 20
#: Sums of errors, exact on a grid of 1/64 km/h, so that rounding errors cannot add up.
SUM_Q = 6
#: Notch per km/h of a sum.
SUM_GAIN_Q = 26
#: Resistance: notch per km/h, and per (km/h)^2.
RESISTANCE_Q = 28
#: The sum of all parts of the notch stays below 4096, the end of its format.
_PART_MAX = 500.0


@dataclass(frozen=True, slots=True)
class Parameters:
    """Parameters that a file may set, with their ranges; the defaults suit any train."""

    #: T, the time constant of the controlled distance, in control periods.
    response_periods: Annotated[float, Field(ge=3, le=50)] = 5.0
    #: Share of the feed-forward; 1 is that for the train of the scenario.
    lead: Annotated[float, Field(ge=0, le=2)] = 1.0


@dataclass(frozen=True)
class Constants:
    """All numbers needed in a run, each with its format and its origin."""

    gains: tuple[Constant, ...] = field(metadata=held(GAIN_Q, "K0, K1, of the next slope and of this one"))
    limits: tuple[Constant, ...] = field(metadata=held(SPEED_Q, "of what the gains are for"))
    sum_gains: tuple[Constant, ...] = field(metadata=held(SUM_GAIN_Q, "K2, K3"))
    sum_limits: tuple[Constant, ...] = field(metadata=held(SUM_Q, "of the sums"))
    resistance: tuple[Constant, ...] = field(metadata=held(RESISTANCE_Q, "Davis b and c in notches"))
    standing: Constant = field(metadata=held(NOTCH_RAW_Q, "Davis a in notches"))
    notch_max: Constant = field(metadata=held(NOTCH_RAW_Q, "notch range of the train"))
    other: Constant = field(metadata=held(NOTCH_Q, "a notch that differs by more is not the law's"))
    zero: Constant = field(metadata=held(0, "0"))


class State(NamedTuple, Generic[T]):
    """Memory of the law: both sums, now and one control period earlier (km/h, Q6), the error (Q20), the notch (Q8)."""

    sums: tuple[T, T]
    before: tuple[T, T]
    error: T
    notch: T


class Mylaw(Law[T, State[T]]):
    """The law in one arithmetic. Raises ``ValueError`` for gains that do not fit their format."""

    name: ClassVar[str] = "mylaw"
    parameters_type: ClassVar[type[Any]] = Parameters
    parameters_origin: ClassVar[str] = "gains computed from the train of the scenario"
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {"response_periods": (4.0, 12.0), "lead": (0.8, 1.2)}

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: Parameters | None = None) -> None:
        p, train = parameters or Parameters(), scenario.train
        period_s = scenario.timing.control_period_ns / 1e9
        lag_s, response_s = 1 / train.actuator_pole_per_s, p.response_periods * period_s
        accel_kmh_per_s = 3.6 * train.force_per_notch_n / train.inertial_mass_kg
        # (s + 1/T)^3 = s^3 + k0 s^2 + k1 s + k2 for the distance, times 1 + lag s for the actuator.
        k0, k1, k2 = 3 / response_s, 3 / response_s**2, 1 / response_s**3
        # What is left of the actuator's last notch after a control period.
        left = math.exp(-period_s / lag_s)
        lead = p.lead / (accel_kmh_per_s * period_s * (1 - left))
        gains = (k0 * lag_s / period_s / accel_kmh_per_s, (k0 + k1 * lag_s) / accel_kmh_per_s, lead, -left * lead)
        sum_gains = ((k1 + k2 * lag_s) * period_s / accel_kmh_per_s, k2 * period_s**2 / accel_kmh_per_s)
        notch_per_n_per_kn = p.lead * train.mass_kg * train.gravity_mps2 / 1000 / train.force_per_notch_n
        values = {
            "gains": gains,
            "limits": [min(100.0, _PART_MAX / max(abs(gain), 1e-9)) for gain in gains],
            "sum_gains": sum_gains,
            "sum_limits": (100.0 / period_s, train.notch_max / sum_gains[1]),
            "resistance": (
                train.davis_b_n_per_kn_kmh * notch_per_n_per_kn,
                train.davis_c_n_per_kn_kmh2 * notch_per_n_per_kn,
            ),
            "standing": train.davis_a_n_per_kn * notch_per_n_per_kn,
            "notch_max": train.notch_max,
            "other": 1 / 64,
            "zero": 0.0,
        }
        self.table = table = build(Constants, values)
        self._ar = ar = arithmetic
        self._gains, self._limits = ar.load(table.gains), ar.load(table.limits)
        self._sum_gains, self._sum_limits = ar.load(table.sum_gains), ar.load(table.sum_limits)
        self._linear, self._square = ar.load(table.resistance)
        self._standing, self._notch_max = ar.load((table.standing, table.notch_max))
        self._other, self._zero = ar.load((table.other, table.zero))

    @property
    def horizon(self) -> int:
        return 2

    @property
    def constants(self) -> tuple[Constant, ...]:
        return flatten(self.table)

    def start(self, inputs: LawInputs[T]) -> State[T]:
        nothing = (self._zero, self._zero)
        return State(nothing, nothing, self._ar.sub(inputs.set_point, inputs.speed), self._zero)

    def with_sent(self, state: State[T], notch: T) -> State[T]:
        """A notch other than the law's was sent: undo this control period's change of the sums."""
        ar = self._ar
        overridden = ar.gt(ar.abs(ar.sub(notch, state.notch)), self._other)
        behind, total = (ar.where(overridden, *pair) for pair in zip(state.before, state.sums, strict=True))
        return State((behind, total), state.before, state.error, notch)

    def step(self, state: State[T], inputs: LawInputs[T]) -> tuple[State[T], LawOutputs[T]]:
        ar = self._ar
        (now, after), set_point = inputs.preview, inputs.set_point
        error = ar.sub(set_point, inputs.speed)
        read = (ar.sub(error, state.error), error, ar.sub(after, now), ar.sub(now, set_point))
        limited = [self._clip(*pair) for pair in zip(read, self._limits, strict=True)]
        parts = ar.note_all("part", limited, SPEED_Q, "km/h")
        behind = self._clip(ar.add(state.sums[0], ar.quantise(parts[1], SPEED_Q, SUM_Q)), self._sum_limits[0])
        total = self._clip(ar.add(state.sums[1], behind), self._sum_limits[1])
        sums = ar.note_all("sum", (behind, total), SUM_Q, "km/h")
        led = ar.dot(self._gains, parts, GAIN_Q + SPEED_Q - NOTCH_RAW_Q)
        answer = ar.dot(self._sum_gains, sums, SUM_GAIN_Q + SUM_Q - NOTCH_RAW_Q)
        wanted = ar.add(ar.add(led, answer), self._resistance(now))
        notch_raw = ar.note("notch_raw", wanted, NOTCH_RAW_Q, "notch")
        notch = ar.quantise(self._clip(notch_raw, self._notch_max), NOTCH_RAW_Q, NOTCH_Q)
        notch = ar.note("notch", notch, NOTCH_Q, "notch")
        return State((behind, total), state.sums, error, notch), LawOutputs(notch_raw, notch)

    def _resistance(self, set_point: T) -> T:
        """The notch that holds a speed on the level, a + V (b + c V)."""
        ar = self._ar
        speed = ar.maximum(set_point, self._zero)
        slope = ar.add(self._linear, ar.rmpy(speed, self._square, SPEED_Q))
        return ar.add(self._standing, ar.rmpy(speed, slope, RESISTANCE_Q + SPEED_Q - NOTCH_RAW_Q))

    def _clip(self, value: T, limit: T) -> T:
        """The value within -limit to limit."""
        return self._ar.clip(value, limit, self._ar.neg(limit))
